"""The two screens: the score near the truth, the regression far from it."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose.search.score_test import Screen, Start, _Step
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import data_of, likelihood, noise_spectra
from dashpot.identify.problem.linearised import Linearised
from dashpot.identify.problem.structure import Structure
from dashpot.identify.problem.unknowns import Unknown, Unknowns
from dashpot.identify.signals.noise_spectrum import NoiseSpectrum
from dashpot.identify.start.measured_motion import Regression, probes
from dashpot.model import Oscillator, Response
from dashpot.model.law import Scales
from dashpot.model.laws import LIBRARY
from dashpot.model.library import find
from dashpot.model.terms import with_term
from dashpot.recording import Recording
from dashpot.simulate.core import Core


@pytest.mark.long
def test_the_regression_finds_the_gap_that_the_base_model_bent_itself_around(rig):
    case = rig("single", "clearance")
    data = data_of(case.training, case.model)
    regression = Regression(data, case.model)
    best = regression.guesses(list(LIBRARY.values()))[0]
    # the two have one equation; the place of the onset is what the base model could not have told
    assert best.effect in ("clearance", "two-sided-stop")
    gap = best.values.get("clearance.gap") or best.values["two-sided-stop.position"]
    assert gap == pytest.approx(case.truth["parameters"]["clearance_gap"], rel=0.1)


def test_the_score_promises_what_a_small_effect_then_gains(rig):
    case = rig("none")
    data = data_of(case.training, case.model)
    fitted = Structure(case.model, data).fit(settle=True)
    # a drag so small that the response is linear in it
    drag = 0.01 * case.model.viscous.value / (data.scales.length * data.scales.omega)
    disturbed = with_term(fitted.model, "quadratic-drag", {"coefficient": drag})
    structure = Structure(disturbed, data)
    moved = structure.problem.residuals(structure.state(fitted.initial))
    shifted = tuple(r - (m - r) for r, m in zip(fitted.residuals, moved, strict=True))
    segments = tuple(
        replace(s, response=s.response - r + n)
        for s, r, n in zip(data.segments, fitted.residuals, shifted, strict=True)
    )
    changed = replace(data, segments=segments)
    base = Structure(fitted.model, changed).fit(
        fitted.initial, noise=noise_spectra(fitted.residuals, fitted.model, data)
    )
    start = {s.effect: s for s in Screen(base, changed).starts([find("quadratic-drag")])}["quadratic-drag"]
    best = Structure(start.model, changed).fit(
        start.initial, noise=noise_spectra(base.residuals, base.model, changed), tolerance=1e-3
    )
    assert best.model.values()["quadratic-drag.coefficient"] == pytest.approx(drag, rel=0.5)
    assert start.promise == pytest.approx(best.likelihood - base.likelihood, rel=0.25, abs=3.0)


def test_probes_are_natural_sizes_times_what_the_law_says():
    scales = Scales(length=2e-3, omega=100.0, force=5.0, response=2e-3, duration=10.0, mass=1.0, lines=(60.0,))
    gaps = [probe["gap"] for probe in probes(find("clearance"), scales)]
    assert gaps == pytest.approx([2e-3 * p for p in find("clearance").parameters[1].probes])
    assert [probe["frequency"] for probe in probes(find("tonal-disturbance"), scales)] == [60.0]


def test_a_law_that_cannot_be_seen_is_not_tried(rig):
    case = rig("none")
    decays = [replace(r, force=None) for r in case.training if r.name == "ringdown"]
    model = replace(case.model, mass=None)
    data = data_of(decays, model)
    screen = Screen(Structure(model, data).fit(settle=True), data)
    assert not screen.applies(find("actuator-lag"))
    assert screen.applies(find("quadratic-drag"))


def test_the_likelihood_of_a_model_that_does_not_simulate_is_none(rig):
    case = rig("none")
    data = data_of(case.training, case.model)
    residuals = tuple(np.full(s.n, np.nan) for s in data.segments)
    assert likelihood(residuals, case.model, data) == -np.inf


# --- a step, where everything is linear and can be told by hand


def screen(residual: np.ndarray, *own: np.ndarray) -> Screen:
    """A screen whose residual has white noise of unit size, beside a model of these derivatives."""
    made = object.__new__(Screen)
    rows = np.array(own).reshape(-1, residual.size)
    parameters = tuple(Unknown("parameter", f"parameter {k}") for k in range(len(rows)))
    made.base = made.white = Linearised(Unknowns(parameters, (), ((),)), (rows,), (residual,))
    made.own = [np.zeros((0, residual.size))]
    made.noise = [NoiseSpectrum(np.ones(residual.size // 2 + 1), residual.size)]
    made.places, made._linear = (0,), []
    scales = Scales(length=1e-3, omega=80.0, force=0.0, response=1e-3, duration=1.0)
    made.data = SimpleNamespace(scales=scales, segments=(None,))
    made.fitted = SimpleNamespace(model=Oscillator.from_values(TRUTH), initial=np.zeros((1, 2)), offsets=np.zeros(0))
    return made


#: No shift of the initial states.
STILL = np.zeros((1, 2))


#: A derivative of the model, and a law's change that it imitates in part; of the rest the square is 16.
KNOWN, CHANGE = np.array([1.0, 0.0, 0.0, 0.0]), np.array([3.0, 4.0, 0.0, 0.0])


def law_of(*names: str):
    return SimpleNamespace(name="law", parameters=[SimpleNamespace(name=name, strength=False) for name in names])


def test_a_strength_is_found_beside_what_the_model_takes_up_itself():
    step = screen(2.0 * CHANGE + 5.0 * KNOWN, KNOWN)._step(law_of("strength"), {"gap": 1.0}, ["strength"], [[CHANGE]])
    assert step is not None
    assert step.values == {"gap": 1.0, "strength": pytest.approx(2.0)}
    assert step.promise == pytest.approx(0.5 * 16.0 * 2.0**2)
    assert step.shift == pytest.approx([5.0])
    assert step.left[0] == pytest.approx(np.zeros(4))


def test_a_law_without_a_strength_is_there_or_not():
    """It is put in as it is: twice of it would be right, so half of what it would take away stays."""
    made = screen(2.0 * CHANGE + 5.0 * KNOWN, KNOWN)
    step = made._step(law_of("gap", "other"), {"gap": 1.0, "other": 2.0}, [], [[CHANGE]])
    assert step is not None
    assert step.values == {"gap": 1.0, "other": 2.0}
    assert step.promise == pytest.approx(0.5 * 16.0 * (2.0**2 - 1.0**2))
    assert step.left[0] == pytest.approx([0.0, 4.0, 0.0, 0.0])
    assert step.shift == pytest.approx([8.0])  # three more, for what the law lacks


@pytest.mark.parametrize(("right", "scaled"), [(0.04, False), (0.06, True), (2.0, True), (19.0, True), (21.0, False)])
def test_a_single_parameter_is_scaled_up_to_twenty_times(right, scaled):
    step = screen(right * CHANGE, KNOWN)._step(law_of("lag"), {"lag": 3.0}, [], [[CHANGE]])
    assert step is not None
    assert step.values["lag"] == pytest.approx(3.0 * right if scaled else 3.0)
    gained = 0.5 * 16.0 * right**2
    assert step.promise == pytest.approx(gained if scaled else gained - 0.5 * 16.0 * (right - 1.0) ** 2)


def test_what_does_not_simulate_promises_nothing():
    assert screen(CHANGE, KNOWN)._step(law_of("lag"), {"lag": 3.0}, [], [[np.full(4, np.nan)]]) is None


def test_a_promise_is_counted_in_the_noise_that_it_leaves():
    """Half of the size everywhere is a gain of log 2 for each sample."""
    noise = np.random.default_rng(0).standard_normal(400)
    step = _Step(law_of(), {}, np.zeros(0), 1.0, STILL, left=(0.5 * noise,))
    assert screen(noise)._concentrated(step).promise == pytest.approx(400 * np.log(2.0))


@pytest.mark.parametrize(
    ("gains", "kept", "tried"),
    [
        ((26.0, 99.0, 99.0), 26.0, [1.0]),  # a quarter of what was promised is kept
        ((24.0, 40.0, 99.0), 40.0, [1.0, 0.3]),
        ((24.0, 20.0, 10.0), 24.0, [1.0, 0.3, 0.0]),
        ((None, None, 5.0), 5.0, [1.0, 0.3, 0.0]),
        ((None, None, None), None, [1.0, 0.3, 0.0]),
    ],
)
def test_a_shorter_step_is_tried_where_the_whole_keeps_little(monkeypatch, gains, kept, tried):
    made = screen(CHANGE, KNOWN)
    moved = []

    def simulated(law, numbers, here, promise, initial, offsets):
        moved.append(here[0] - TRUTH["mass"])
        gain = gains[len(moved) - 1]
        return None if gain is None else Start("law", made.fitted.model, initial, offsets, promise, gain)

    monkeypatch.setattr(made, "_simulated", simulated)
    start = made._kept(_Step(law_of(), {}, np.array([0.1]), 100.0, STILL))
    assert (start.gain if start else None) == kept
    assert moved == pytest.approx([0.1 * part for part in tried])


def test_of_a_step_that_is_shortened_a_strength_stays_in_its_bounds(monkeypatch):
    made = screen(CHANGE, KNOWN)
    strength = SimpleNamespace(name="drag", strength=True, lower=0.0, upper=15.0)
    law = SimpleNamespace(name="law", parameters=[strength])
    put_in = []
    monkeypatch.setattr(made, "_simulated", lambda law, numbers, *_: put_in.append(numbers["drag"]))
    made._kept(_Step(law, {"drag": 20.0}, np.zeros(1), 100.0, STILL))
    assert put_in == pytest.approx([15.0, 6.0, 1.0])


@pytest.mark.parametrize("phase", [0.5, 2.5, -2.0])
def test_a_tone_is_found_with_its_phase(monkeypatch, phase):
    angle = 2 * np.pi * np.arange(100) / 20  # five whole cycles
    made = screen(3.0 * np.cos(angle + phase))
    made.places = ()

    def slopes(law, values, strengths, initial):
        assert initial.shape == (1, 3)
        assert [p.name for p in strengths] == ["amplitude"]
        return [[np.cos(angle + initial[0, 2])]]

    monkeypatch.setattr(made, "_carried", slopes)
    step = made._phases(find("tonal-disturbance"), {"frequency": 60.0})
    assert step is not None
    assert step.values == {"frequency": 60.0, "amplitude": pytest.approx(3.0)}
    assert step.initial == pytest.approx(np.array([[0.0, 0.0, phase]]))
    assert step.promise == pytest.approx(0.5 * 3.0**2 * 50)
    assert step.left[0] == pytest.approx(np.zeros(100), abs=1e-9)
    # one that the recordings do not show has no step
    monkeypatch.setattr(made, "_carried", lambda *_: [[np.zeros(100)]])
    assert made._phases(find("tonal-disturbance"), {"frequency": 60.0}) is None


# --- the whole screen, on free motions in closed form

LINEAR = TRUTH | {"cubic": 0.0, "preload": 0.0, "dry": 0.0}
FREE = Oscillator.from_values({name: value for name, value in LINEAR.items() if name != "mass"})
FS, NOISE, LINE, TONE = 500.0, 1e-5, 2 * np.pi * 9.0, 2.0
PHASES = (0.8, -2.0)


def decays(sizes=(8e-3, 5e-3), drag: float = 0.0, tone: float = 0.0):
    """Decays of a linear rig: with a faint drag (Krylov and Bogoliubov 1937), or under a tone of another phase in each.

    The amplitude A of a lightly damped motion falls as A' = -h A - b A², b = 4 drag omega / (3 pi).
    """
    omega, h = LINEAR["omega0"], 0.5 * LINEAR["viscous"]
    t, pace = np.arange(1000) / FS, np.sqrt(LINEAR["omega0"] ** 2 - h**2)
    runs = []
    for i, (size, phase) in enumerate(zip(sizes, PHASES, strict=True)):
        b = 4 * drag * omega / (3 * np.pi)
        amplitude = size * np.exp(-h * t) / (1 + b * size / h * (1 - np.exp(-h * t)))
        steady = tone / (omega**2 - LINE**2 + 2j * h * LINE) * np.exp(1j * (LINE * t + phase))
        x = amplitude * np.cos(pace * t) + steady.real + NOISE * np.random.default_rng(i).standard_normal(t.size)
        runs.append(Recording(f"run {i}", FS, x))
    data = data_of(runs, FREE, lines=(LINE,))
    fixed = ("cubic", "preload", "dry")
    return Structure(FREE, data, fixed).fit(settle=True, tolerance=0.01), data


def test_a_drag_is_found_on_decays_and_gains_what_it_promises():
    fitted, data = decays(drag=0.5)
    laws = [find(name) for name in ("quadratic-drag", "quadratic-stiffness")]
    drag, other = Screen(fitted, data).starts(laws)
    assert (drag.effect, other.effect) == ("quadratic-drag", "quadratic-stiffness")
    assert drag.model.values()["quadratic-drag.coefficient"] == pytest.approx(0.5, rel=0.15)
    assert drag.model.values()["viscous"] == pytest.approx(LINEAR["viscous"], rel=0.02)
    assert drag.gain > 50.0 > 25.0 > other.gain > 10.0 > other.promise
    assert drag.promise == pytest.approx(drag.gain, rel=0.5)
    # the gain is that of the whole likelihood, over the model that left something over
    structure = Structure(drag.model, data)
    residuals = structure.problem.residuals(structure.state(drag.initial))
    assert drag.gain == pytest.approx(likelihood(residuals, drag.model, data) - fitted.likelihood, abs=1e-6)


def test_a_tone_is_found_on_decays_with_its_phase_in_each():
    fitted, data = decays(tone=TONE)
    (start,) = Screen(fitted, data).starts([find("tonal-disturbance")])
    values = start.model.values()
    assert abs(values["tonal-disturbance.amplitude"]) == pytest.approx(TONE, rel=0.15)
    assert start.gain > 100.0
    turned = start.initial[:, 2] + (np.pi if values["tonal-disturbance.amplitude"] > 0 else 0.0)
    begins = np.array([segment.time for segment in data.segments]) * LINE
    off = np.angle(np.exp(1j * (turned - begins - PHASES)))
    assert min(np.max(np.abs(off)), np.max(np.abs(np.abs(off) - np.pi))) < 0.2


@pytest.mark.parametrize("name", ["quadratic-drag", "two-sided-stop", "hysteresis", "attached-resonator"])
def test_what_a_force_does_follows_from_the_linearised_motion(name):
    """As derivatives that go along in a run with the law at next to nothing have it."""
    fitted, data = decays()
    made, law = Screen(fitted, data), find(name)
    strengths, probe = [p for p in law.parameters if p.strength], probes(law, data.scales)[0]
    first = strengths[0]
    present = probe | {first.name: 1e-9 * first.natural(data.scales)}
    told, run = made._slopes(law, probe, strengths), made._carried(law, present, strengths, fitted.initial)
    for slopes, carried in zip(told, run, strict=True):
        for slope, other in zip(slopes, carried, strict=True):
            assert np.linalg.norm(slope - other) < 0.02 * np.linalg.norm(other)


def test_a_law_that_promises_less_than_half_of_its_cost_is_not_simulated(monkeypatch):
    fitted, data = decays(drag=0.5)
    laws = [find(name) for name in ("quadratic-drag", "quadratic-stiffness")]
    made, simulated = Screen(fitted, data), []
    kept = made._kept
    monkeypatch.setattr(made, "_kept", lambda step: (simulated.append(step.law.name), kept(step))[1])
    drag, other = made.starts(laws, lambda _: 10.0)
    assert simulated == ["quadratic-drag"]
    assert drag.gain > 50.0
    assert other.gain == other.promise < 5.0


def test_a_law_that_is_there_is_not_asked_for_again(monkeypatch):
    """Nor is its twin under the same name; without laws the whole library is asked."""
    fitted, data = decays()
    grown = with_term(fitted.model, "quadratic-drag", {"coefficient": 1e-3})
    screened = Screen(replace(fitted, model=grown, free=(*fitted.free, "quadratic-drag.coefficient")), data)
    two = {name: LIBRARY[name] for name in ("quadratic-drag", "cubic-damping")}
    monkeypatch.setattr("dashpot.diagnose.search.score_test.KNOWN", two)
    assert [start.effect for start in screened.starts()] == ["cubic-damping"]
    assert screened.starts([]) == []


@pytest.mark.parametrize(("force", "seen"), [(None, False), (np.ones(3), True)])
def test_an_actuator_is_asked_for_where_there_is_a_force(force, seen):
    made = screen(CHANGE, KNOWN)
    made.data.segments = (SimpleNamespace(force=None), SimpleNamespace(force=force))
    assert made.applies(find("actuator-lag")) is seen
    assert made.applies(find("quadratic-drag"))


def test_of_each_law_the_two_places_that_promise_most_are_simulated(monkeypatch):
    made = screen(CHANGE, KNOWN)
    made.fitted.model = FREE
    promises = iter((3.0, 9.0, None, 1.0, 7.0, 5.0, 0.0, 2.0, 4.0))
    simulated = []

    def promised(law, probe):
        promise = next(promises, None)
        return None if promise is None else _Step(law, {}, np.zeros(1), promise, STILL)

    def kept(step):
        simulated.append(step.promise)
        return Start(step.law.effect, FREE, STILL, np.zeros(0), step.promise, -step.promise)

    monkeypatch.setattr(made, "_promised", promised)
    monkeypatch.setattr(made, "_concentrated", lambda step: step)
    monkeypatch.setattr(made, "_kept", kept)
    (start,) = made.starts([find("one-sided-stop")])
    assert simulated == [9.0, 7.0]
    assert start.promise == 7.0  # the better once simulated


def test_what_cannot_be_simulated_promises_nothing_and_gains_nothing(monkeypatch):
    fitted, data = decays()
    made = Screen(fitted, data)
    law = find("quadratic-drag")
    here = np.array(list(FREE.values().values()))
    begun = fitted.initial, fitted.offsets
    assert made._simulated(law, {"coefficient": 1.0}, here, 1.0, *begun) is not None
    assert made._simulated(law, {"coefficient": -1e6}, here, 1.0, *begun) is None  # pushed beyond all numbers

    def fails(*_):
        raise np.linalg.LinAlgError

    monkeypatch.setattr(made, "_slopes", fails)
    assert made._promised(law, {"coefficient": 0.0}) is None


def test_what_the_base_can_do_is_no_news_where_friction_jumps():
    """A spring that gives way only far beyond the motion is a spring: an accelerometer shows it as such."""
    rig = Oscillator.from_values(TRUTH | {"dry": 2.0}, response=Response("acceleration", "m/s2"))
    core, t = Core(rig), np.arange(1500) / FS
    how = np.array(list(rig.values().values())), np.array([8e-3, 0.0]), None, t.size, 1 / FS, 1e-3
    shown = core.record(*how, quantity="acceleration") + 0.05 * np.random.default_rng(3).standard_normal(t.size)
    massless = replace(rig, mass=None)
    data = data_of([Recording("decay", FS, shown, None, "acceleration", "m/s2", free=True)], massless)
    made = Screen(Structure(massless, data).fit(settle=True), data)
    law = find("softening-stiffness")
    (slope,) = made._slopes(law, {"stiffness": 0.0, "width": 1.0}, law.parameters[:1])
    told = made._beyond_own(made._weigh(slope))
    _, _, information = made.base.gain({i: change[None] for i, change in enumerate(told)})
    assert information < 1e-4 * sum(float(change @ change) for change in told)
