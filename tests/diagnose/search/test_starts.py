"""Where laws are put in: by their scores, by the measured motion, and from how many places."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.search.starts import by_motion, by_score, by_zeros, unseen_in_motion, without, without_anew
from dashpot.examples.force import chirp
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import Data, data_of
from dashpot.identify.problem.offset import Offset
from dashpot.identify.problem.structure import Fitted, Structure
from dashpot.identify.start.measured_motion import Guess, Regression
from dashpot.model import Oscillator
from dashpot.model.law import Law
from dashpot.model.library import find
from dashpot.model.terms import with_term
from dashpot.recording import Recording

FS, SECONDS, NOISE = 500.0, 3.0, 2e-6
DELAY = 2e-3
LOAD = 0.02
MODEL = Oscillator.from_values(TRUTH)


def driven(delay: float = 0.0, load: float = 0.0, seed: int = 0) -> Recording:
    """A sweep that moves the mass later than was recorded, with a load besides (both unrecorded)."""
    t = np.arange(round(FS * SECONDS)) / FS
    recorded, pushing = (chirp(1.0, 6.0, 4.0, times, 1 / FS) for times in (t, t - delay))
    pushing[:, 0] += TRUTH["mass"] * load
    x, _ = integrate_pieces(TRUTH, pushing[:-1], 1 / FS)
    x = x + NOISE * np.random.default_rng(seed).standard_normal(t.size)
    return Recording("sweep", FS, x, recorded[:, 0], hold="smooth")


@pytest.fixture(scope="module")
def delayed() -> tuple[Fitted, Data]:
    """The family as it is, on a force that comes late."""
    data = data_of([driven(delay=DELAY)], MODEL)
    return Structure(MODEL, data).fit(most=1), data


@pytest.fixture(scope="module")
def loaded() -> tuple[Fitted, Data]:
    """The family at its best beside a small load."""
    data = data_of([driven(load=LOAD)], MODEL)
    return Structure(MODEL, data).fit(), data


# --- by the score


def test_the_score_tells_the_law_that_is_missing_and_how_strong_it_is(loaded):
    fitted, data = loaded
    proposals = {
        p.law: p for p in by_score(fitted, data, [find("constant-force"), find("quadratic-stiffness")], lambda _: 0.0)
    }
    load = proposals["constant-force"]
    assert load.gain > 20.0
    assert load.gain > max(p.gain for law, p in proposals.items() if law != "constant-force")
    assert load.model.values()["constant-force.load"] == pytest.approx(LOAD, rel=0.2)
    assert load.initial.shape == fitted.initial.shape


def test_a_law_of_many_valleys_has_no_score(loaded):
    assert by_score(*loaded, [find("actuator-backlash")], lambda _: 0.0) == []


def test_a_load_is_begun_where_free_zeros_have_taken_its_place():
    """To first order it moves the rest as a zero does: what a hardening spring tells of it takes the whole step."""
    data = data_of([driven(load=4.0)], MODEL)
    data = replace(data, offsets=(Offset.of(data.recordings, 0, "response"),))
    fitted = Structure(MODEL, data).fit()
    (load,) = by_zeros(fitted, data, [find("constant-force"), find("quadratic-drag"), find("sensor-lag")])
    assert load.law == "constant-force"
    assert load.model.values()["constant-force.load"] == pytest.approx(4.0, rel=0.5)
    assert load.initial - fitted.initial == pytest.approx(np.array([[fitted.offsets[0], 0.0]]))
    structure = Structure(load.model, data)
    found = structure.fit(load.initial)
    assert found.model.values()["constant-force.load"] == pytest.approx(4.0, rel=0.1)
    assert found.likelihood > fitted.likelihood + 100.0
    assert by_zeros(fitted, replace(data, offsets=()), [find("constant-force")]) == []


# --- by the measured motion


def test_the_measured_motion_tells_a_delay_however_the_model_bent_itself(delayed):
    fitted, data = delayed
    proposals = by_motion(fitted, data, [find("time-delay"), find("cubic-damping")])
    assert proposals[0].law == "time-delay"
    values = proposals[0].model.values()
    assert values["time-delay.delay"] == pytest.approx(DELAY, rel=0.05)
    assert values["mass"] == pytest.approx(TRUTH["mass"], rel=0.01)
    assert values["omega0"] == pytest.approx(TRUTH["omega0"], rel=0.01)
    assert proposals[0].gain > 10.0 * max([1.0, *(p.gain for p in proposals[1:])])
    assert proposals[0].initial.shape == fitted.initial.shape


def test_what_the_measured_motion_does_not_speak_for_is_not_proposed(delayed, monkeypatch):
    fitted, data = delayed
    guesses = [Guess("quadratic-drag", {"quadratic-drag.coefficient": 1.0}, misfit) for misfit in (0.99, 1.0, 1.01)]
    monkeypatch.setattr(Regression, "plain", lambda self: 1.0)
    monkeypatch.setattr(Regression, "guesses", lambda self, laws: guesses)
    (proposal,) = by_motion(fitted, data, [find("quadratic-drag")])
    assert proposal.gain > 0.0
    assert proposal.model.values()["quadratic-drag.coefficient"] == 1.0


# --- what it is blind for


@pytest.mark.parametrize(
    ("law", "unseen"),
    [
        ("sensor-lag", True),
        ("sensor-offset", True),
        ("constant-force", True),
        ("quadratic-drag", False),
        ("hysteresis", False),
        ("tonal-disturbance", False),
        ("time-delay", False),
        ("actuator-backlash", False),
    ],
)
def test_the_motion_says_nothing_of_the_record_and_of_a_constant(law, unseen):
    assert unseen_in_motion(find(law)) is unseen


def test_a_constant_drive_is_no_constant_force():
    """Only a force per unit mass shows as a constant beside the motion."""
    law = Law("flat", "excitation", (), "", "", "", drive=lambda motion, p, force: 0.0 * force + 1.0)
    assert not unseen_in_motion(law)


# --- one law less


def test_a_law_that_is_taken_out_leaves_the_rest_as_it_was_and_as_the_motion_asks(delayed):
    """The fit had bent itself around the law."""
    _, data = delayed
    bent = with_term(MODEL, "time-delay", {"delay": DELAY}).with_parameters(
        {"mass": replace(MODEL.parameters()["mass"], value=0.5)}
    )
    fitted = Fitted(bent, np.zeros((1, 2)), (np.zeros(data.points),), 0.0, tuple(bent.parameters()))
    (same, initial), (asked, again) = without(fitted, data, "time-delay")
    assert not same.terms
    assert not asked.terms
    assert same.values() == MODEL.values() | {"mass": 0.5}
    # late by 2 ms the force seems to push against a little more damping, and the mass is what it is
    assert asked.values()["mass"] == pytest.approx(TRUTH["mass"], rel=0.1)
    assert np.array_equal(initial, fitted.initial)
    assert np.array_equal(again, fitted.initial)


def test_afresh_it_is_where_a_fit_without_the_law_ends():
    """A law that is not there, beside a mass that is far off; the model without it comes back to the truth."""
    recording = driven()
    data = data_of([recording], MODEL)
    far = with_term(MODEL, "sensor-offset", {"offset": 0.0}).with_parameters(
        {"omega0": replace(MODEL.parameters()["omega0"], value=1.3 * TRUTH["omega0"])}
    )
    fitted = Fitted(far, np.zeros((1, 2)), (np.zeros(data.points),), 0.0, tuple(far.parameters()))
    ((found, initial),) = without_anew(fitted, data, "sensor-offset")
    assert not found.terms
    assert initial is None
    for name, within in (("mass", 1e-3), ("omega0", 1e-3), ("viscous", 1e-2), ("cubic", 5e-2)):
        assert found.values()[name] == pytest.approx(TRUTH[name], rel=within), name


def test_afresh_the_shape_of_a_law_is_kept_as_it_was():
    data = data_of([driven()], MODEL)
    shape = "softening-stiffness.width"
    model = with_term(MODEL, "softening-stiffness", {"stiffness": 1.0, "width": 7e-3})
    model = with_term(model, "sensor-offset", {"offset": 0.0})
    free = tuple(name for name in model.parameters() if name != shape)
    fitted = Fitted(model, np.zeros((1, 2)), (np.zeros(data.points),), 0.0, free)
    ((found, _),) = without_anew(fitted, data, "sensor-offset")
    assert found.values()[shape] == 7e-3
    assert found.values()["softening-stiffness.stiffness"] != 1.0


def test_its_own_states_go_with_a_law(delayed):
    _, data = delayed
    model = with_term(MODEL, "actuator-lag", {"time": DELAY})
    fitted = Fitted(model, np.array([[1e-3, 2e-3, 0.5]]), (np.zeros(data.points),), 0.0, ())
    for smaller, initial in without(fitted, data, "actuator-lag"):
        assert not smaller.terms
        assert initial.tolist() == [[1e-3, 2e-3]]


def test_where_the_motion_is_too_short_to_say_anything_it_asks_for_nothing(delayed):
    _, data = delayed
    model = with_term(MODEL, "time-delay", {"delay": DELAY})
    short = replace(data, segments=(data.segments[0].part(0, 40),))
    fitted = Fitted(model, np.zeros((1, 2)), (np.zeros(40),), 0.0, ())
    ((smaller, _),) = without(fitted, short, "time-delay")
    assert smaller.values() == MODEL.values()


def test_what_does_without_a_law_that_took_the_spring_over_has_the_spring_again(loaded):
    """A learnt spring that sets in far beyond the motion is a cubic one; dropped, Eq. 17 has its stiffness."""
    _, data = loaded
    reach, far = 20e-3, -0.3 * TRUTH["cubic"] * 6.25 * 20e-3**2
    law = {"near": 0.0, "middle": 0.0, "far": far, "side-near": 0.0, "side-far": 0.0, "reach": reach}
    bent = with_term(Oscillator.from_values(TRUTH | {"cubic": 1.3 * TRUTH["cubic"]}), "free/spring", law)
    whole = Structure(bent, data, [n for n in bent.parameters() if n.startswith("free/spring")]).fit(most=1)
    whole = replace(whole, model=bent)
    model, initial = without(whole, data, "free/spring")[0]
    assert model.terms == ()
    assert model.cubic.value == pytest.approx(TRUTH["cubic"], rel=0.02)
    assert model.omega0.value == pytest.approx(TRUTH["omega0"], rel=1e-4)
    assert model.dry.value == pytest.approx(TRUTH["dry"], rel=0.01)
    assert initial is not None
    kept = replace(whole, free=tuple(n for n in whole.free if n != "cubic"))
    assert without(kept, data, "free/spring")[0][0].cubic.value == bent.cubic.value
