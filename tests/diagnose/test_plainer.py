"""A pair of stops of which one is touched is a stop on one side; one that is touched on both sides stays a pair."""

from __future__ import annotations

import dashpot
import numpy as np
import pytest
from dashpot.diagnose.plainer import with_plainer_laws
from dashpot.diagnose.search.candidate import Candidate
from dashpot.diagnose.search.search import Search
from dashpot.examples.force import chirp
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import Data, data_of
from dashpot.identify.problem.structure import Fitted, Structure
from dashpot.model import Oscillator, Response
from dashpot.model.laws import LIBRARY
from dashpot.model.library import find
from dashpot.model.terms import with_term
from dashpot.recording import Recording

FS, SECONDS, NOISE = 500.0, 4.0, 2e-6
STIFFNESS, DAMPING = 4.0 * TRUTH["omega0"] ** 2, 20.0
PAIR, SINE = ("two-sided-stop",), ("softening-stiffness/sine",)


def stopped(beside: dict[str, dict[str, float]] | None = None, /, **stops: float) -> tuple[Fitted, Data]:
    """A sweep between stops, and the pair fitted to it from where they are, beside other laws."""
    model = Oscillator.from_values({name: value for name, value in TRUTH.items() if name != "cubic"} | {"cubic": 0.0})
    pair = with_term(model, PAIR[0], {"stiffness": STIFFNESS, "damping": DAMPING} | stops)
    for name, values in (beside or {}).items():
        pair = with_term(pair, name, values)
    force = chirp(1.0, 8.0, 18.0, np.arange(round(FS * SECONDS)) / FS, 1 / FS)[:, 0]
    response = dashpot.simulate(pair, force=force, fs=FS, hold="linear").response
    response = response + NOISE * np.random.default_rng(0).standard_normal(force.size)
    data = data_of([Recording("sweep", FS, response, force, hold="linear")], pair)
    return Structure(pair, data).fit(most=3), data


def searched(fitted: Fitted, data: Data, laws: tuple[str, ...] = PAIR) -> tuple[Candidate, Search]:
    search = Search(data, None)
    selected = search.candidates[laws] = search.weigh(laws, fitted)
    return selected, search


@pytest.mark.parametrize("side", [1, -1])
def test_of_two_stops_the_one_that_is_touched_is_named(side):
    place = side * 1.2e-3
    fitted, data = stopped(position=4e-3, offset=place - side * 4e-3)
    selected, search = searched(fitted, data)
    plainer = with_plainer_laws(selected, search)
    assert plainer.laws == ("one-sided-stop",)
    assert plainer.fit is not None
    found = plainer.fit.model.values()
    assert found["one-sided-stop.position"] == pytest.approx(place, rel=0.01)
    assert found["one-sided-stop.stiffness"] == pytest.approx(STIFFNESS, rel=0.02)
    assert search.candidates[plainer.laws] is plainer
    assert "as one-sided-stop does" in search.candidates[PAIR].why


@pytest.mark.parametrize("offset", [0.0, 2e-4])
def test_stops_that_are_both_touched_stay_a_pair(offset):
    selected, search = searched(*stopped(position=1.2e-3, offset=offset))
    assert with_plainer_laws(selected, search) is selected
    assert list(search.candidates) == [PAIR]


@pytest.mark.parametrize("laws", [("one-sided-stop", *PAIR), PAIR])
def test_of_two_stops_beside_a_third_neither_takes_its_name(laws):
    """Whether that was found with them or is the given family's: a model has no law twice."""
    third = {"one-sided-stop": {"stiffness": STIFFNESS, "damping": DAMPING, "position": 1.8e-3}}
    selected, search = searched(*stopped(third, position=4e-3, offset=-2.8e-3), laws)
    assert with_plainer_laws(selected, search).laws == laws


def test_a_law_without_cases_stays():
    assert [law.name for law in LIBRARY.values() if law.cases is not None] == list(PAIR)
    candidate = Candidate(("quadratic-drag",), stage="judged")
    assert with_plainer_laws(candidate, Search(None, None)) is candidate  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("position", "offset", "cases"),
    [(2.0, 0.5, [2.5, -1.5]), (2.0, 3.0, [5.0]), (2.0, -3.0, [-5.0])],
)
def test_each_case_has_the_stop_on_its_own_side(position, offset, cases):
    """Two stops on one side of the middle: the nearer one pushes away from it, which no single stop does."""
    made = find(PAIR[0]).cases
    assert made is not None
    given = {"stiffness": 7.0, "damping": 3.0, "position": position, "offset": offset}
    single = [("one-sided-stop", {"stiffness": 7.0, "damping": 3.0, "position": place}) for place in cases]
    assert made(given) == [*single, ("clearance", {"stiffness": 7.0, "gap": position})]


@pytest.mark.parametrize(("damping", "laws"), [(2e-4, ("clearance",)), (2.0, PAIR)])
def test_stops_about_the_middle_that_damp_nothing_are_a_gap(damping, laws):
    selected, search = searched(*stopped(stiffness=0.3 * STIFFNESS, damping=damping, position=1.2e-3, offset=0.0))
    plainer = with_plainer_laws(selected, search)
    assert plainer.laws == laws
    if laws != PAIR:
        assert plainer.fit is not None
        assert plainer.fit.model.values()["clearance.gap"] == pytest.approx(1.2e-3, rel=0.01)


def swinging(width: float, unit: str = "rad") -> tuple[Candidate, Search]:
    """A pendulum's decay, or that of a detent's other sine, fitted with a width of its own from 2 % beside it."""
    response = Response("displacement", unit)
    values = {"omega0": 0.3, "cubic": 0.0, "preload": 0.0, "viscous": 0.02, "dry": 0.05}
    truth = with_term(Oscillator.from_values(values, response=response), SINE[0], {"stiffness": 32.0, "width": width})
    decay = dashpot.simulate(truth, initial=(2.0 * width, 0.0), seconds=20.0, fs=60.0).response
    decay = decay + 1e-3 * np.random.default_rng(3).standard_normal(decay.size)
    data = data_of([Recording("decay", 60.0, decay, unit=unit, free=True)], truth)
    near = with_term(
        Oscillator.from_values(values | {"omega0": 1.6, "cubic": -0.2 / width**2}, response=response),
        SINE[0],
        {"stiffness": 29.5, "width": 0.98 * width},
    )
    search = Search(data, None)
    selected = search.candidates[SINE] = search.weigh(SINE, Structure(near, data).fit(most=8))
    return selected, search


@pytest.mark.parametrize(("width", "unit", "told"), [(1.0, "rad", True), (0.5, "rad", False), (1.0, "m", False)])
def test_the_sine_of_a_pendulums_own_angle_has_no_width_to_be_fitted(width, unit, told):
    selected, search = swinging(width, unit)
    assert selected.fit is not None
    assert f"{SINE[0]}.width" in selected.fit.free
    plainer = with_plainer_laws(selected, search)
    assert plainer.fit is not None
    assert (f"{SINE[0]}.width" not in plainer.fit.free) is told
    if told:
        found = plainer.fit.model.values()
        assert found[f"{SINE[0]}.width"] == 1.0
        assert found[f"{SINE[0]}.stiffness"] + found["omega0"] ** 2 == pytest.approx(32.09, rel=5e-3)
        assert found[f"{SINE[0]}.stiffness"] == pytest.approx(32.0, rel=0.02)
        assert search.candidates[SINE] is plainer
