"""Starts from the measured motion: forces of unknown phase, and an actuator that plays."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot import examples
from dashpot.examples.truth import ACTUATOR, TRUTH
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.limits import SLACK
from dashpot.identify.signals.weakform import windows
from dashpot.identify.start.measured_motion import Guess, Regression, _project, _soft_sign, probes
from dashpot.model import Oscillator
from dashpot.model.law import Scales
from dashpot.model.library import find
from dashpot.model.terms import with_term
from dashpot.recording import Recording, read


@pytest.mark.long
def test_a_periodic_force_is_found_with_its_amplitude_whatever_its_phases(rig):
    case = rig("single", "tonal-disturbance")
    data = data_of(case.training, case.model)
    data = replace(data, scales=replace(data.scales, lines=(1.0005 * case.truth["parameters"]["tone_omega"],)))
    regression = Regression(data, case.model)
    guess = regression.best(find("tonal-disturbance"))
    assert guess is not None
    assert guess.values["tonal-disturbance.amplitude"] == pytest.approx(case.truth["parameters"]["tone"], rel=0.1)
    assert guess.misfit < 0.5 * regression.plain()
    assert len(set(guess.phases.values())) == len(regression.rows)


@pytest.mark.long
def test_play_in_the_papers_stand_is_seen_in_the_measured_motion():
    folder = Path(examples.__file__).parent / "recordings" / "paper-stand-backlash"
    recordings = [read(folder / f"{name}.csv.gz") for name in ("bursts", "sweep_low")]
    model = Oscillator.from_values(TRUTH)
    regression = Regression(data_of(recordings, model), model)
    assert (guess := regression.best(find("actuator-backlash"))) is not None
    assert guess.misfit < 0.3 * regression.plain()
    assert guess.values["actuator-backlash.gap"] == pytest.approx(ACTUATOR["half_gap"], rel=0.2)
    assert guess.values["actuator-backlash.mass"] == pytest.approx(ACTUATOR["moving_mass"], rel=0.3)
    assert guess.values["mass"] == pytest.approx(TRUTH["mass"] - ACTUATOR["moving_mass"], rel=0.07)


@pytest.mark.long
def test_a_contact_is_found_where_it_is_and_as_stiff_as_it_is(rig):
    """Its place moves between the probes, the contact without damping there as at all of them."""
    case = rig("single", "one-sided-stop")
    regression = Regression(data_of(case.training, case.model), case.model)
    guess = regression.best(find("one-sided-stop"))
    assert guess is not None
    side = "up" if guess.values["one-sided-stop.position"] > 0 else "down"
    truth = case.truth["parameters"]
    assert abs(guess.values["one-sided-stop.position"]) == pytest.approx(truth[f"{side}_at"], rel=0.03)
    assert guess.values["one-sided-stop.stiffness"] == pytest.approx(truth[f"{side}_stiffness"], rel=0.15)


@pytest.mark.parametrize(("gained", "tries"), [(0.49, 10), (0.51, 40)])
def test_only_where_a_law_gains_half_of_the_best_its_place_is_searched_to_the_end(monkeypatch, gained, tries):
    """Ten solutions a parameter tell which laws are worth the other thirty."""
    gains = {"quadratic-drag": 100.0, "stribeck": 100.0 * gained}
    solved = dict.fromkeys(gains, 0)

    def refined(self, law, guess, most):
        solved[law.name] += most
        return guess

    monkeypatch.setattr(Regression, "__init__", lambda self: None)
    monkeypatch.setattr(Regression, "plain", lambda self: 1.0)
    monkeypatch.setattr(Regression, "gain", lambda self, plain, guess: gains[guess.effect])
    monkeypatch.setattr(Regression, "_refined", refined)
    # what cannot be put on the motion at all is left out
    monkeypatch.setattr(
        Regression, "_probed", lambda self, law: [Guess(law.name, {}, 1 / gains[law.name])] if law.name in gains else []
    )
    laws = [find(name) for name in ("stribeck", "sensor-lag", "quadratic-drag")]
    guesses = Regression().guesses(laws)  # pyright: ignore[reportCallIssue]
    assert [guess.effect for guess in guesses] == ["quadratic-drag", "stribeck"]
    assert solved == {"quadratic-drag": 40, "stribeck": tries}


# --- motions by Runge and Kutta's rule, with a force along them that the test chooses

#: Linear but for what a test adds.
LINEAR = TRUTH | {"cubic": 0.0, "preload": 0.0, "dry": 0.0}
PLAIN = Oscillator.from_values(LINEAR)
FS, SECONDS = 500.0, 6.0
DRAG, STIFFNESS, PLACE, TONE, LINE = 20.0, 6000.0, 2e-3, 0.6, 2 * np.pi * 9.0
CUBIC, PRELOAD, DRY, CONTACT, RATE = 5e6, 1.5, 0.8, 15.0, 60.0

FORCES = {
    "nothing": lambda t, x, v: 0.0,
    "drag": lambda t, x, v: DRAG * v * abs(v),
    "push": lambda t, x, v: -0.1 * DRAG * v * abs(v),
    "family": lambda t, x, v: CUBIC * x**3 + PRELOAD * np.sign(x) + DRY * np.sign(v),
    "stop": lambda t, x, v: STIFFNESS * max(x - PLACE, 0.0),
    "damped stop": lambda t, x, v: max(STIFFNESS * (x - PLACE) + CONTACT * v, 0.0) if x > PLACE else 0.0,
    "stiffening": lambda t, x, v: RATE * t * x,
    "slack": lambda t, x, v: -1.00002 * LINEAR["omega0"] ** 2 * x,
    "tone": lambda t, x, v: -TONE * np.cos(LINE * t + 0.8),
    "late tone": lambda t, x, v: -TONE * np.cos(LINE * t - 2.0),
}


@cache
def run(missing: str, begin: float | None = None, arrives: float = np.inf) -> Recording:
    """Under a sweep from 5 to 20 Hz or let go at ``begin``; of the force no more than ``arrives`` arrives."""
    force, h, parts = FORCES[missing], 1 / FS / 4, 4
    stiffness, damping, mass = LINEAR["omega0"] ** 2, LINEAR["viscous"], LINEAR["mass"]

    def drive(t):
        return 0.0 if begin is not None else 2.0 * np.sin(2 * np.pi * (5.0 * t + 1.25 * t**2))

    def rate(t, x, v):
        u = min(max(drive(t), -arrives), arrives)
        return v, u / mass - damping * v - stiffness * x - force(t, x, v)

    n = round(SECONDS * FS)
    x, v, xs = begin or 0.0, 0.0, np.zeros(n)
    for i in range(n):
        xs[i] = x
        for k in range(parts):
            t = i / FS + k * h
            x1, v1 = rate(t, x, v)
            x2, v2 = rate(t + h / 2, x + h / 2 * x1, v + h / 2 * v1)
            x3, v3 = rate(t + h / 2, x + h / 2 * x2, v + h / 2 * v2)
            x4, v4 = rate(t + h, x + h * x3, v + h * v3)
            x, v = x + h * (x1 + 2 * x2 + 2 * x3 + x4) / 6, v + h * (v1 + 2 * v2 + 2 * v3 + v4) / 6
    xs += 2e-7 * np.random.default_rng(0).standard_normal(n)
    shown = None if begin is not None else np.array([drive(t) for t in np.arange(n) / FS])
    return Recording(f"{missing} {begin}", FS, xs, shown)


def of(*runs: Recording, model: Oscillator = PLAIN, lines: tuple[float, ...] = ()) -> Regression:
    data = data_of(runs, model)
    return Regression(replace(data, scales=replace(data.scales, lines=lines)), model)


def test_the_familys_own_values_are_found_on_the_motion():
    regression = of(run("family"))
    family = regression.family()
    assert family is not None
    assert family.phases == {}
    expected = LINEAR | {"cubic": CUBIC, "preload": PRELOAD, "dry": DRY}
    rel = {"mass": 0.01, "omega0": 0.01, "viscous": 0.03, "cubic": 0.03, "preload": 0.1, "dry": 0.1}
    assert family.values == {n: pytest.approx(expected[n], rel=r) for n, r in rel.items()}
    assert regression.plain() == family.misfit


def test_free_motion_has_no_mass():
    family = of(run("nothing", 8e-3)).family()
    assert family is not None
    assert "mass" not in family.values
    assert family.values["omega0"] == pytest.approx(LINEAR["omega0"], rel=1e-3)
    assert family.values["viscous"] == pytest.approx(LINEAR["viscous"], rel=0.01)


@pytest.mark.parametrize("begin", [None, 8e-3])
def test_a_drag_is_found_with_its_size(begin):
    regression = of(run("drag", begin))
    guess = regression.best(find("quadratic-drag"))
    assert guess is not None
    assert guess.values["quadratic-drag.coefficient"] == pytest.approx(DRAG, rel=0.03)
    assert guess.values["viscous"] == pytest.approx(LINEAR["viscous"], rel=0.03)
    assert guess.misfit < 0.2 * regression.plain()


def test_a_law_that_would_do_the_opposite_is_none():
    """A drag resists; what pushes in step with the speed is another law."""
    assert of(run("push")).best(find("quadratic-drag")) is None


def test_a_stop_between_two_probes_is_found_where_it_is():
    regression = of(run("stop"))
    law = find("one-sided-stop")
    probed, guess = regression._probed(law)[0], regression.best(law)
    assert guess is not None
    assert min(abs(PLACE / regression.data.scales.length - probe) for probe in law.parameters[1].probes) > 0.02
    assert guess.values["one-sided-stop.position"] == pytest.approx(PLACE, rel=0.02)
    assert guess.values["one-sided-stop.stiffness"] == pytest.approx(STIFFNESS, rel=0.05)
    assert guess.values["one-sided-stop.damping"] == pytest.approx(0.0, abs=1.0)
    assert guess.misfit < 0.5 * probed.misfit < 0.5 * regression.plain()


@pytest.mark.parametrize("there", [False, True])
def test_a_contact_is_found_with_its_damping(there):
    stop = {"stiffness": 1.5 * STIFFNESS, "position": PLACE, "damping": 1.5 * CONTACT}
    regression = of(run("damped stop"), model=with_term(PLAIN, "one-sided-stop", stop) if there else PLAIN)
    guess = regression.family() if there else regression.best(find("one-sided-stop"))
    assert guess is not None
    assert guess.values["one-sided-stop.damping"] == pytest.approx(CONTACT, rel=0.15)
    assert guess.values["one-sided-stop.stiffness"] == pytest.approx(STIFFNESS, rel=0.05)


def test_a_spring_that_changes_is_told_by_the_time_of_the_record():
    guess = of(run("stiffening")).best(find("stiffness-drift"))
    assert guess is not None
    assert guess.values["stiffness-drift.rate"] == pytest.approx(RATE, rel=0.03)
    assert guess.values["omega0"] == pytest.approx(LINEAR["omega0"], rel=2e-3)


def test_a_slide_has_no_stiffness_and_windows_of_half_a_cycle():
    """A spring that seems to push is one that is slack where the rig may have none, and no rig where it has one."""
    regression, other = of(run("nothing")), run("slack")
    regression.slack = True
    sprung = regression.family()  # a spring that is there is found all the same
    assert sprung is not None
    assert sprung.values["omega0"] == pytest.approx(LINEAR["omega0"], rel=0.01)
    regression.data = replace(regression.data, recordings=(other,))
    for slack in (False, True):
        regression.slack = slack
        rows = regression._prepare(0, other.response, other.force, FS, 0.0, 2e-7, 0.0)
        assert rows is not None
        regression.rows = [rows]
        guess = regression.family()
        assert (guess is not None) is slack
        if guess is not None:
            assert guess.values["omega0"] == pytest.approx(SLACK / regression.data.scales.duration)
            assert guess.values["mass"] == pytest.approx(LINEAR["mass"], rel=0.02)
    for cycles in (1.9, 2.1):
        x = other.response[: round(cycles * 2 * np.pi / regression.data.scales.omega * FS)]
        assert (regression._prepare(0, x, None, FS, 0.0, 2e-7, 0.0) is not None) is (cycles > 2)


@pytest.mark.parametrize("source", ["sensor", "force"])
def test_each_row_is_weighed_by_what_noise_makes_of_it(source):
    """White noise of the sensor through the equation of motion, or of the force over the mass: as large as it says."""
    random = np.random.default_rng(1)
    regression, n = of(run("nothing", 8e-3)), 40000
    sensor, force = (1e-5, 0.0) if source == "sensor" else (0.0, 0.3)
    x = 1e-5 * random.standard_normal(n)
    rows = regression._prepare(0, x, None, FS, 0.0, sensor, force)
    assert rows is not None
    if source == "sensor":
        left = rows.target - rows.columns[:, 2] * LINEAR["omega0"] ** 2 - rows.columns[:, 1] * LINEAR["viscous"]
    else:
        view = windows(n, FS, rows.view.length / rows.view.fs, 0.0, 0.4 * FS, 2)
        bins = np.searchsorted(view.omega, rows.view.omega - 1e-9)
        left = view.project(force / LINEAR["mass"] * random.standard_normal(n))[:, bins].ravel()
    ratios = np.sqrt(np.mean(np.abs((left / rows.std).reshape(-1, rows.view.omega.size)) ** 2, axis=0))
    assert ratios == pytest.approx(np.ones(ratios.size), abs=0.35)
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.1)


def test_a_contact_that_would_pull_has_no_damping():
    """A damping below its bound stays at it, and the rest is solved for again without it."""
    law = find("one-sided-stop")
    guess = of(run("stop")).at(law, {"position": 1.1 * PLACE})
    assert guess is not None
    assert guess.values["one-sided-stop.damping"] >= 0.0
    assert guess.values["one-sided-stop.stiffness"] > 0.5 * STIFFNESS


def test_a_tone_is_found_with_one_amplitude_and_a_phase_in_each_recording():
    regression = of(run("tone"), run("late tone"), lines=(LINE,))
    guess = regression.best(find("tonal-disturbance"))
    assert guess is not None
    assert guess.values["tonal-disturbance.amplitude"] == pytest.approx(TONE, rel=0.02)
    begins = [rows.motion[0, 2] for rows in regression.rows]
    expected = [np.exp(1j * phase) for phase in (0.8, -2.0)]
    found = [np.exp(1j * (guess.phases[i] - LINE * t)) for i, t in zip(sorted(guess.phases), begins, strict=True)]
    assert begins == [0.0, 0.0]
    assert np.array(found) == pytest.approx(np.array(expected), abs=0.03)
    assert guess.misfit < 0.2 * regression.plain()
    assert guess.begun(np.zeros((2, 2))) == pytest.approx(np.array([[0.0, 0.0, guess.phases[i]] for i in (0, 1)]))
    # what is there already, a tone with its own phase in each, is solved for beside everything else
    grown = with_term(PLAIN, "tonal-disturbance", {"amplitude": TONE, "frequency": LINE})
    assert of(run("tone"), run("late tone"), model=grown).plain() == pytest.approx(guess.misfit, rel=0.01)


def test_an_actuator_at_its_limit_is_found_where_it_is():
    regression = of(run("nothing", arrives=1.3))
    guess = regression.best(find("actuator-saturation"))
    assert guess is not None
    assert guess.values["actuator-saturation.limit"] == pytest.approx(1.3, rel=0.02)
    assert guess.values["mass"] == pytest.approx(LINEAR["mass"], rel=0.01)
    # where it is there already, the family is told with what arrives
    grown = with_term(PLAIN, "actuator-saturation", {"limit": 1.3})
    family = of(run("nothing", arrives=1.3), model=grown).family()
    assert family is not None
    assert family.values["actuator-saturation.limit"] == 1.3
    assert family.misfit < 1.1 * guess.misfit < 0.3 * regression.plain()


def test_a_law_that_is_there_is_solved_for_anew_and_keeps_its_place():
    grown = with_term(PLAIN, "one-sided-stop", {"stiffness": 100.0, "position": PLACE, "damping": 0.0})
    family = of(run("stop"), model=grown).family()
    assert family is not None
    assert family.values["one-sided-stop.stiffness"] == pytest.approx(STIFFNESS, rel=0.03)
    assert family.values["one-sided-stop.position"] == PLACE


@pytest.mark.parametrize("effect", ["sensor-lag", "actuator-lag"])
def test_what_no_regression_can_carry_has_no_guess(effect):
    """What sits in the sensor is not in the motion; an actuator is nowhere in free motion."""
    assert of(run("nothing", 8e-3)).best(find(effect)) is None


@pytest.mark.parametrize(("cycles", "windowed"), [(2.9, False), (3.1, True)])
def test_the_shortest_window_is_of_one_and_a_half_cycles_and_half_the_segment(cycles, windowed):
    regression = of(run("nothing", 8e-3))
    n = round(cycles * 2 * np.pi / regression.data.scales.omega * FS)
    x = run("nothing", 8e-3).response[:n]
    assert (regression._prepare(0, x, None, FS, 0.0, 2e-7, 0.0) is not None) is windowed


@pytest.mark.parametrize(("rate", "factor"), [(31.0, 1), (10.1, 3), (4.0, 4)])
def test_a_cycle_has_thirty_points_or_four_times_those_recorded(rate, factor):
    regression, x = of(run("nothing", 8e-3)), run("nothing", 8e-3).response
    rows = regression._prepare(0, x, None, rate * regression.data.scales.omega / (2 * np.pi), 0.0, 2e-7, 0.0)
    assert rows is not None
    assert len(rows.motion) == factor * x.size


def test_where_no_segment_has_a_window_nothing_is_found():
    regression = of(run("nothing", 8e-3))
    regression.rows.clear()
    assert regression.family() is None
    assert regression.plain() == np.inf
    assert regression.best(find("quadratic-drag")) is None


def test_a_gain_counts_each_window_once_though_two_lie_on_each_other():
    """Half of the misfit in 60 complex rows, every second of them new: 60 real numbers, each worth half of log 2."""
    made = object.__new__(Regression)
    made.rows = [SimpleNamespace(target=np.zeros(count)) for count in (20, 40)]  # type: ignore[assignment]
    assert made.gain(3.0, Guess("law", {}, 1.5)) == pytest.approx(0.5 * 60 * np.log(2.0))
    assert made.gain(3.0, Guess("law", {}, 0.0)) == 0.0


def test_a_guess_is_put_into_the_model():
    values = {name: 2.0 * value for name, value in LINEAR.items()} | {"quadratic-drag.coefficient": 3.0}
    grown = Guess("quadratic-drag", values, 1.0).put_into(PLAIN)
    assert grown.values() == values
    assert Guess("nothing", LINEAR | {"dry": 0.5}, 1.0).put_into(PLAIN).values() == LINEAR | {"dry": 0.5}
    assert np.array_equal(Guess("nothing", {}, 1.0).begun(np.ones((2, 2))), np.ones((2, 2)))


def test_a_law_is_looked_for_at_every_combination_of_its_places():
    scales = Scales(length=2e-3, omega=100.0, force=5.0, response=2e-3, duration=10.0, lines=(50.0, 60.0))
    stop = find("one-sided-stop")
    assert probes(stop, scales) == [
        {"stiffness": 0.0, "position": pytest.approx(2e-3 * probe), "damping": 0.0}
        for probe in stop.parameters[1].probes
    ]
    assert [probe["frequency"] for probe in probes(find("tonal-disturbance"), scales)] == [50.0, 60.0]
    counts = [len(p.probes) for p in find("hysteresis").parameters if not p.strength]
    assert len(probes(find("hysteresis"), scales)) == np.prod(counts)


def test_a_constant_force_leaves_nothing_in_the_windows():
    """They let none pass; a remainder of roundings would be solved for as if it were one."""
    view = windows(2000, 500.0, 1.0, 3.0, 20.0)
    assert not np.any(_project(view, np.full(2000, 7.0)))
    wave = np.cos(2 * np.pi * 8.0 * np.arange(2000) / 500.0)
    assert _project(view, 7.0 + 1e-3 * wave) == pytest.approx(view.project(1e-3 * wave), abs=1e-12)
    for part, passes in ((4e-7, False), (1e-4, True)):
        assert np.any(_project(view, 1.0 - np.eye(1, 2000, 0)[0] + part * wave)) == passes


def test_a_sign_that_changes_within_a_sample_counts_by_the_part_before_and_behind():
    """x = slope (t - t0) over an interval of 0.1 s about each sample."""
    values, slope = np.array([-1.0, -0.025, 0.0, 0.05, 0.2]), np.full(5, 2.0)
    assert _soft_sign(values, slope, 0.1) == pytest.approx([-1.0, -0.25, 0.0, 0.5, 1.0])
    assert _soft_sign(values, -slope, 0.1) == pytest.approx([-1.0, -0.25, 0.0, 0.5, 1.0])
    assert _soft_sign(np.array([-3.0, 0.0, 3.0]), np.zeros(3), 0.1) == pytest.approx([-1.0, 0.0, 1.0])
