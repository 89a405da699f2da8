"""Laws that act alike: who stands in whose place, and where it begins there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.search.likeness import alike, moves_along
from dashpot.examples.force import chirp
from dashpot.examples.oscillator import integrate, integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import Data, data_of
from dashpot.identify.problem.offset import Offset
from dashpot.identify.problem.settle import settled
from dashpot.identify.problem.structure import Fitted, Structure
from dashpot.model import Oscillator, Response
from dashpot.model.library import find
from dashpot.model.terms import with_term
from dashpot.recording import Recording
from dashpot.simulate.core import Core
from dashpot.simulate.force import force_between

FS, SECONDS, NOISE = 500.0, 3.0, 1e-6
DELAY, LIMIT = 2e-3, 0.8
BEGIN = (4e-3, 0.0)
QUINTIC = 4e10


def driven(begin: tuple[float, float] = (0.0, 0.0)) -> tuple[np.ndarray, np.ndarray]:
    """Displacement and recorded force (n,) of a sweep that reaches the mass late."""
    t = np.arange(round(FS * SECONDS)) / FS
    recorded, pushing = (chirp(1.0, 6.0, 4.0, times, 1 / FS) for times in (t, t - DELAY))
    return integrate_pieces(TRUTH, pushing[:-1], 1 / FS, *begin)[0], recorded[:, 0]


def shown(x: np.ndarray, force: np.ndarray, left: np.ndarray, zero: float, *laws: str, **values: float):
    """The true model with laws, on a recording of the motion beside which it leaves something.

    Args:
        x, force: (n,) the motion.
        left: (n,) what the model leaves beside it, besides some noise.
        zero: what the sensor shows at zero.
        laws: beside Eq. 17.
        values: of their parameters, LAW__NAME.
    """
    model = Oscillator.from_values(TRUTH)
    for law in laws:
        own = {p.name: values.get(f"{law}__{p.name}".replace("-", "_"), 0.0) for p in find(law).parameters}
        model = with_term(model, law, own)
    left = left + NOISE * np.random.default_rng(0).standard_normal(x.size)
    data = data_of([Recording("sweep", FS, x + left + zero, force, hold="smooth")], model)
    assert data.points == x.size
    data = replace(data, offsets=(Offset(0, "response", data.scales.length / 100),))
    states = Structure(model, data).problem.core.states
    fit = Fitted(model, np.zeros((1, states)), (left,), 0.0, tuple(model.parameters()), np.array([zero]))
    return fit, data


def like_a_delay(left: float = 0.0, zero: float = 0.0, *others: str):
    """What acts like the delay of a fitted model that leaves a part of its own motion beside a sensor's zero."""
    x, force = driven()
    fit, data = shown(x, force, left * x, zero, "time-delay", time_delay__delay=DELAY)
    return alike(fit, data, ["time-delay"], [find(name) for name in others or ("actuator-lag",)]), fit


@pytest.mark.parametrize(("left", "zero"), [(0.5, 0.0), (0.0, 3e-3), (-0.3, -3e-3)])
def test_a_lag_takes_the_place_of_a_delay_on_the_motion_that_the_model_makes(left, zero):
    """Whatever it leaves beside that, and wherever the sensor's zero is: those are no motion of the model's."""
    ((lag,), _), ((plain,), _) = like_a_delay(left, zero), like_a_delay()
    values = lag.model.values()
    assert lag.law == "actuator-lag"
    assert not any(name.startswith("time-delay") for name in values)
    # a first-order lag is late by its time as long as that is short
    assert values["actuator-lag.time"] == pytest.approx(DELAY, rel=0.15)
    assert values["mass"] == pytest.approx(TRUTH["mass"], rel=0.02)
    assert values["omega0"] == pytest.approx(TRUTH["omega0"], rel=0.01)
    assert values == pytest.approx(plain.model.values(), rel=1e-4)


def test_what_acts_most_alike_comes_first():
    laws = ("quadratic-drag", "attached-resonator", "actuator-lag", "cubic-damping", "softening-stiffness")
    (first, *rest), _ = like_a_delay(0.0, 0.0, *laws)
    assert first.law == "actuator-lag"
    assert rest
    gains = [first.gain, *(other.gain for other in rest)]
    assert gains == sorted(gains, reverse=True)
    assert gains[0] > gains[1]


def test_a_motion_that_had_no_states_of_the_laws_own_begins_as_it_did():
    """As it was fitted, and not as the first samples show it."""
    force = driven()[1]
    x, _ = integrate(TRUTH, np.clip(force, -LIMIT, LIMIT), 1 / FS)
    fit, data = shown(x, force, 0.0 * x, 0.0, "actuator-saturation", actuator_saturation__limit=LIMIT)
    begun = replace(fit, initial=np.array([[1e-3, 2e-3]]))
    (soft,) = alike(begun, data, ["actuator-saturation"], [find("actuator-saturation/soft")])
    assert "actuator-saturation/soft.limit" in soft.model.values()
    assert np.array_equal(soft.initial, begun.initial)


@pytest.mark.parametrize("zero", [0.0, 3e-3])
def test_where_a_laws_own_states_go_the_motion_begins_as_it_was_recorded(zero):
    """They were a part of where it began; what the sensor shows at zero was none. States of other laws stay."""
    x, force = driven(BEGIN)
    laws = ("actuator-lag", "sensor-lag")
    fit, data = shown(x, force, np.zeros_like(x), zero, *laws, actuator_lag__time=DELAY, sensor_lag__time=1e-4)
    assert fit.initial.shape == (1, 4)
    (delay,) = alike(replace(fit, initial=fit.initial + 0.7), data, ["actuator-lag"], [find("time-delay")])
    assert delay.initial.shape == (1, 3)
    assert delay.initial[0] == pytest.approx([*BEGIN, 0.7], abs=0.05)
    assert delay.initial[0, 0] == pytest.approx(BEGIN[0], abs=1e-4)
    assert delay.model.values()["time-delay.delay"] == pytest.approx(DELAY, rel=0.1)


def test_one_law_takes_the_place_of_two_that_act_like_it_together():
    """Two lags of half its time each make a delay; each of them by itself makes half of one."""
    x, force = driven(BEGIN)
    laws = ("actuator-lag", "sensor-lag")
    fit, data = shown(x, force, np.zeros_like(x), 0.0, *laws, actuator_lag__time=DELAY / 2, sensor_lag__time=DELAY / 2)
    (delay,) = alike(fit, data, laws, [find("time-delay")])
    assert set(delay.model.values()) == set(TRUTH) | {"time-delay.delay"}
    assert delay.model.values()["time-delay.delay"] == pytest.approx(DELAY, rel=0.1)
    assert delay.initial.shape == (1, 2)
    assert delay.initial[0, 0] == pytest.approx(BEGIN[0], abs=1e-4)


@pytest.mark.parametrize(
    ("law", "like_another"),
    [
        ("quadratic-drag", True),
        ("time-delay", True),
        ("hysteresis", True),
        ("tonal-disturbance", False),  # a phase of its own
        ("actuator-backlash", False),  # many valleys
    ],
)
def test_what_has_a_phase_of_its_own_or_many_valleys_acts_like_no_other(law, like_another):
    assert moves_along(find(law)) is like_another


# --- with laws that Eq. 17 does not have


def fitted(case, law: str, values: dict[str, float]) -> tuple[Fitted, Data]:
    """A rig's own law, fitted from the true values, and the data."""
    data = data_of(case.training, case.model)
    truth = case.truth["parameters"]
    names = {"omega0": "omega"} | {name: name for name in ("mass", "cubic", "preload", "viscous", "dry")}
    known = case.model.parameters()
    model = case.model.with_parameters(
        {name: replace(known[name], value=truth[theirs]) for name, theirs in names.items()}
    )
    return Structure(with_term(model, law, values), data).fit(settle=True), data


@pytest.mark.long
def test_the_other_stop_takes_the_place_of_one_and_begins_where_it_is(rig):
    case = rig("single", "one-sided-stop")
    truth = case.truth["parameters"]
    side, sign = ("up", 1.0) if "up_at" in truth else ("down", -1.0)
    contact = {"stiffness": truth[f"{side}_stiffness"], "position": sign * truth[f"{side}_at"]}
    fit, data = fitted(case, "one-sided-stop", contact | {"damping": truth[f"{side}_damping"]})
    others = ["two-sided-stop", "quintic-stiffness", "actuator-lag", "attached-resonator"]
    first, *rest = alike(fit, data, ["one-sided-stop"], [find(name) for name in others])
    assert first.law == "two-sided-stop"
    assert all(other.gain < first.gain for other in rest)
    values = first.model.values()
    assert "one-sided-stop.position" not in values
    assert values["omega0"] == pytest.approx(truth["omega"], rel=0.1)
    assert values["two-sided-stop.position"] == pytest.approx(truth[f"{side}_at"], rel=0.2)


@pytest.mark.long
def test_a_delay_takes_the_place_of_a_lag_and_the_motion_begins_as_it_did(rig):
    case = rig("single", "actuator-lag")
    truth = case.truth["parameters"]
    fit, data = fitted(case, "actuator-lag", {"time": truth["actuator_lag"]})
    (delay,) = alike(fit, data, ["actuator-lag"], [find("time-delay")])
    assert delay.model.values()["time-delay.delay"] == pytest.approx(truth["actuator_lag"], rel=0.05)
    amplitude = float(np.max(np.abs(data.segments[-1].response)))
    assert delay.initial[-1, :2] == pytest.approx(fit.initial[-1, :2], abs=0.05 * amplitude * truth["omega"])
    assert delay.initial[-1, 0] == pytest.approx(fit.initial[-1, 0], abs=0.02 * amplitude)


def struck(**values: float) -> tuple[Fitted, Data]:
    """An accelerometer on a rig with a spring of the fifth power that is struck, and the truth fitted to it."""
    rig = Oscillator.from_values(TRUTH | {"dry": 1.0} | values, response=Response("acceleration", "m/s2"))
    rig = with_term(rig, "quintic-stiffness", {"coefficient": QUINTIC})
    t, core = np.arange(round(6 * FS)) / FS, Core(rig)
    force = np.zeros(t.size)
    for at, peak in ((0.3, 26.0), (3.1, 38.0)):
        inside = (t >= at) & (t < at + 5e-3)
        force[inside] += peak * np.sin(np.pi * (t[inside] - at) / 5e-3)
    how = np.array(list(rig.values().values())), np.zeros(2), force_between(force, 1 / FS, "linear", 5000.0)
    shown = core.record(*how, t.size, 1 / FS, 1e-3, quantity="acceleration")
    shown = shown + 0.05 * np.random.default_rng(2).standard_normal(t.size)
    data = data_of([Recording("hits", FS, shown, force, "acceleration", "m/s2", hold="linear")], rig)
    return Structure(rig, data).fit(most=5, settle=True), data


def test_an_accelerometer_says_what_acts_alike_along_the_models_own_displacement():
    """Blows and the jumps of friction are most of what it shows."""
    fit, data = struck(viscous=2.0)
    others = [find(name) for name in ("softening-stiffness", "hysteresis", "viscoelastic", "quadratic-drag")]
    first, *rest = alike(fit, data, ["quintic-stiffness"], others)
    assert first.law == "softening-stiffness"
    assert first.gain > 3 * max(proposal.gain for proposal in rest)
    # there it follows, from the first step on
    structure = Structure(first.model, data)
    left = structure.problem.residuals(settled(structure.problem, structure.state(first.initial)))
    motion = [np.std(segment.response) for segment in data.segments]
    assert max(np.std(r) / size for r, size in zip(left, motion, strict=True)) < 0.1
