"""The hold of a force is found from the records where it matters, and only there; by the independent integrator."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import chain, repeat
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.examples.concealed.engine import Drive, simulate
from dashpot.examples.force import chirp, multisine
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.identify import identify
from dashpot.identify.fit import hold as module
from dashpot.identify.fit.hold import HoldFound, _Trial, find_hold, held_as, hold_of_recordings
from dashpot.identify.signals.odds import DECISIVE
from dashpot.model.file import dumps, loads
from dashpot.recording import Recording

FREQUENCY = TRUTH["omega0"] / (2 * np.pi)


def driven(force, hold):
    """Polynomials over the steps for a force (n, terms) whose samples are its first column."""
    samples = force[:, 0]
    if hold == "zero":
        return samples[:, None].copy()
    return np.column_stack([samples, np.append(np.diff(samples), 0.0)]) if hold == "linear" else force


@cache
def rig(hold, per_cycle=40, kind="sweep", seed=0, lag=0.0, band=(5.0, 20.0), noise=2e-6):
    """Two levels of a sweep or a random force, 200 cycles each; ``lag`` in samples delays what the mass feels."""
    random = np.random.default_rng(seed)
    fs = float(round(per_cycle * FREQUENCY))
    n = int(200 * per_cycle)
    recordings = []
    for level in (0.3, 1.0):
        t = np.arange(n) / fs
        low, high = band
        if kind == "sweep":
            made = [chirp(level, low, (high - low) * fs / n, when, 1 / fs) for when in (t, t - lag / fs)]
        else:
            lines = np.arange(np.ceil(low * n / fs), high * n / fs) * fs / n
            phases = random.uniform(0, 2 * np.pi, lines.size)
            size = 2 * level / np.sqrt(lines.size)
            made = [multisine(size, lines, phases, when, 1 / fs) for when in (t, t - lag / fs)]
        x = integrate_pieces(TRUTH, driven(made[1], hold)[:-1], 1 / fs)[0]
        y = x + noise * random.standard_normal(n)
        force = made[0][:, 0] + 1e-3 * level * random.standard_normal(n)
        recordings.append(Recording(name=f"{kind} {level}", fs=fs, response=y, force=force))
    return tuple(recordings)


def scores(oscillator):
    return np.array([(p.value - TRUTH[name]) / (p.std or np.nan) for name, p in oscillator.parameters().items()])


@pytest.mark.parametrize(
    ("hold", "per_cycle", "kind"),
    [
        pytest.param("zero", 77, "sweep", marks=pytest.mark.long),
        ("zero", 25, "random"),
        pytest.param("linear", 40, "random", marks=pytest.mark.long),
    ],
)
def test_a_hold_is_found_told_and_kept(hold, per_cycle, kind):
    identification = identify(rig(hold, per_cycle, kind))
    assert identification.oscillator.hold == hold
    assert any("between samples" in note or "sample to sample" in note for note in identification.notes)
    assert np.all(np.abs(scores(identification.oscillator)) < 3.5)
    assert hold_of_recordings(identification.recordings) == hold
    assert loads(dumps(identification.oscillator)).hold == hold


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in (1, 2))])
def test_a_smooth_force_stays_smooth(seed):
    identification = identify(rig("smooth", 40, "random", seed))
    assert identification.oscillator.hold == "smooth"
    assert not any("fitted so" in note for note in identification.notes)
    assert np.all(np.abs(scores(identification.oscillator)) < 3.5)


def test_a_hold_is_found_where_under_a_smooth_force_the_search_ends_in_another_valley():
    """A chirp through the jump of a spring that hardens, a smooth force leaves 19 times the noise."""
    rig = {"mass": 0.13, "omega0": 33.0, "cubic": 1e8, "preload": 0.02, "viscous": 0.4, "dry": 0.0}
    fs, n = 160.0, 800
    force = chirp(0.06, 2.0, (12.0 - 2.0) * fs / n, np.arange(n) / fs, 1 / fs)[:, :1]
    x = integrate_pieces(rig, force[:-1], 1 / fs)[0]
    response = x + 2e-3 * np.std(x) * np.random.default_rng(0).standard_normal(n)
    found = identify([Recording(name="chirp", fs=fs, response=response, force=force[:, 0])])
    assert found.oscillator.hold == "zero"
    for name, p in found.oscillator.parameters().items():
        assert abs(p.value - rig[name]) < 3.5 * (p.std or 1e-9)


def test_where_no_hold_shows_over_a_cycle_none_is_tried_in_full(monkeypatch):
    """Drag leaves so much of a sweep that its simulations end in one valley or another, whatever the hold."""
    omega, fs = 2 * np.pi * 8.0, 100.0
    values = {"omega": omega, "omega2": omega**2, "viscous": 0.02 * omega, "mass": 0.5, "force": 2.0, "drag": 20.0}
    drive = Drive("linear", 1.0, 4.0, 14.0, 27.0)
    made = simulate(values | {"amplitude": 3e-3}, drive, 0.0, fs, 2700)
    response = made.x + 2e-6 * np.random.default_rng(0).standard_normal(2700)
    recordings = [Recording(name="sweep", fs=fs, response=response, force=made.force)]
    fit = identify(held_as(recordings, "smooth")).fit
    assert max(part.over_noise for part in fit.segments) > 10

    def never(*_, **__):
        raise AssertionError("fitted again")

    assert module.with_hold(fit, recordings, never, doubted=False)[2] == []
    monkeypatch.setattr(module, "_over_a_cycle", lambda *_, **__: "zero")
    with pytest.raises(AssertionError, match="fitted again"):
        module.with_hold(fit, recordings, never, doubted=False)


@pytest.mark.parametrize("hold", ["zero", "linear"])
def test_a_white_force_is_never_smooth_beside_what_is_missing(hold):
    """Drag leaves much under any hold, and asks for a lag of its own; no chain makes such a force smooth."""
    random, n, fs = np.random.default_rng(8), 1600, 150.0
    force = 8.0 * random.standard_normal(n)
    after = force if hold == "zero" else np.append(force[1:], force[-1])
    omega, viscous, drag, mass, fine = 2 * np.pi * 3.0, 0.6, 2.0, 0.8, 8
    z, x, h = np.zeros(2), np.zeros(n), 1 / fs / fine

    def rates(z, f):
        return np.array([z[1], f / mass - viscous * z[1] - drag * abs(z[1]) * z[1] - omega**2 * z[0]])

    for i in range(n):
        x[i] = z[0]
        for k in range(fine):
            start, middle, end = (force[i] + (after[i] - force[i]) * (k + part) / fine for part in (0.0, 0.5, 1.0))
            a = rates(z, start)
            b = rates(z + h / 2 * a, middle)
            c = rates(z + h / 2 * b, middle)
            z = z + h / 6 * (a + 2 * b + 2 * c + rates(z + h * c, end))
    response = x + 1e-4 * np.std(x) * random.standard_normal(n)
    found = identify([Recording(name="white", fs=fs, response=response, force=force)], doubted=False)
    assert max(part.over_noise for part in found.fit.segments) > 1.5
    assert found.oscillator.hold == hold


def test_a_converter_that_is_early_by_a_sixteenth_of_a_sample_holds_its_force():
    identification = identify(rig("zero", 25, "random", lag=-1 / 16))
    assert identification.oscillator.hold == "zero"
    assert np.all(np.abs(scores(identification.oscillator)) < 3.5)  # the lead is more than noise, and in the errors


def test_what_is_said_is_not_questioned():
    identification = identify(held_as(rig("zero", 25, "random"), "smooth"))
    assert identification.oscillator.hold == "smooth"
    assert np.max(np.abs(scores(identification.oscillator))) > 5  # half a sample of lag has to go somewhere


@pytest.mark.long
def test_a_lag_that_is_not_half_a_sample_is_no_hold():
    assert identify(rig("smooth", 40, "random", lag=1.5)).oscillator.hold == "smooth"


def test_where_the_hold_cannot_be_known_it_is_in_the_errors():
    """Near the resonance alone a loss that grows with frequency looks like mass."""
    recordings = rig("linear", 40, band=(11.5, 14.5), noise=2e-5)
    oscillator = identify(recordings).oscillator
    said = identify(held_as(recordings, "smooth")).oscillator
    assert oscillator.hold == "smooth"
    assert abs(scores(said)[0]) > 3
    assert abs(scores(oscillator)[0]) < 2
    assert oscillator.mass.std > 3 * said.mass.std
    assert np.sqrt(oscillator.identified.covariance[0][0]) == pytest.approx(oscillator.mass.std)


def test_a_hold_that_moves_a_steep_resonance_is_not_given_up_beforehand():
    """A loss of 0.1 % taken for mass moves a hardening peak by more than a linear step from afar puts back.

    Seen by that alone lines were e^37 less likely than a smooth force; fitted they are as likely, and right.
    """
    truth = {
        "mass": 4.535407463327687,
        "omega0": 3.5758504852153138,
        "cubic": 105991.70688866421,
        "preload": 0.00016839785364882256,
        "viscous": 0.06984439853185558,
        "dry": 0.0,
    }
    fs, n, random = 30.981131427941786, 6344, np.random.default_rng([4011, 1])
    frequency, top = truth["omega0"] / (2 * np.pi), 0.0058134676907467394
    recordings = []
    for level in (top, 0.35 * top):
        force = chirp(level, 0.5 * frequency, 1.1 * frequency * fs / n, np.arange(n) / fs, 1 / fs)
        x = integrate_pieces(truth, driven(force, "linear")[:-1], 1 / fs)[0]
        seen = force[:, 0] + 1e-3 * level * random.standard_normal(n)
        y = x + 6.1e-6 * random.standard_normal(n)
        recordings.append(Recording(name=f"sweep {level}", fs=fs, response=y, force=seen))
    oscillator = identify(recordings).oscillator
    assert abs(oscillator.mass.value - truth["mass"]) < 3 * oscillator.mass.std


def test_a_hold_that_lets_a_held_mass_go_is_not_given_up_beforehand():
    """A step along the derivatives under a smooth force makes lines e^159 less likely, the next two e^99 likelier.

    Over the low sweep the preload holds the mass again and again; with a smooth force mass was off by 47 of its errors.
    """
    truth = {
        "mass": 0.0398167,
        "omega0": 9.99186,
        "cubic": -290234.7,
        "preload": 0.003175397,
        "viscous": 0.3062075,
        "dry": 0.0,
    }
    fs, n, random = 44.96343782963697, 4434, np.random.default_rng([9309, 1])
    frequency, top, recordings = truth["omega0"] / (2 * np.pi), 8.428930090342287e-4, []
    for level in (top, 0.35 * top):
        force = chirp(level, 0.5 * frequency, 1.1 * frequency * fs / n, np.arange(n) / fs, 1 / fs)
        x = integrate_pieces(truth, driven(force, "linear")[:-1], 1 / fs)[0]
        seen = force[:, 0] + 1e-3 * level * random.standard_normal(n)
        y = x + 1.858e-6 * random.standard_normal(n)
        recordings.append(Recording(name=f"sweep {level}", fs=fs, response=y, force=seen))
    oscillator = identify(recordings).oscillator
    assert oscillator.hold == "linear"
    assert abs(oscillator.mass.value - truth["mass"]) < 3 * oscillator.mass.std


@pytest.mark.parametrize(
    ("promised", "found", "least"),
    [
        ((100.0,), (20.0,), 20.0),  # within reach: one step tells
        ((500.0, 30.0), (90.0, 35.0), 25.0),
        ((500.0, 95.0, 30.0), (200.0, 100.0, 40.0), 20.0),
        ((500.0, 95.0), (100.0, 101.0), 89.0),  # leads no further
    ],
)
def test_a_hold_is_followed_as_long_as_each_step_leads_further(monkeypatch, promised, found, least):
    steps, costs = iter(promised), iter(found)
    monkeypatch.setattr(module, "_reached", lambda *_: (next(steps), "there"))
    monkeypatch.setattr(module, "cost_of", lambda *_: next(costs))
    problem = SimpleNamespace(residuals=lambda _: ())
    assert module._promised(problem, (), "here", (), (), 26.0) == (promised[-1], least)  # pyright: ignore[reportArgumentType]
    assert list(steps) == list(costs) == []


def test_holds_are_compared_alike_from_wherever_the_search_begins():
    """A fit that is not quite at its maximum, or is weighed by what it left before, is no reason for another hold."""
    recordings = rig("smooth", 20, band=(11.5, 14.5), noise=2e-5)
    fit = identify(held_as(recordings, "smooth"), doubted=False).fit
    problem, state = module._point(fit, recordings)
    values = state.values.copy()
    values[list(fit.oscillator.parameters()).index("mass")] *= 1.02
    odds = [
        find_hold(problem, point, fit.oscillator, recordings).log_odds["linear"]
        for point in (state, replace(state, values=values))
    ]
    assert odds[0] == pytest.approx(odds[1], abs=0.5)  # a step of one standard error
    assert odds[1] < DECISIVE


def test_a_hold_is_believed_where_no_other_is_nearer():
    held = HoldFound("zero", {"smooth": 0.0, "zero": 30.0}, {}, gain=400.0 * DECISIVE, further=0.0)
    assert held.believed(99.0 * DECISIVE)
    assert not held.believed(101.0 * DECISIVE)
    little = replace(held, gain=10.0)
    assert little.believed(0.99 * DECISIVE)
    assert not little.believed(1.01 * DECISIVE)


def test_holds_are_told_apart_at_odds_of_a_thousand():
    """A further lag shows by chance once in as many right holds."""
    little = HoldFound("zero", {"smooth": 0.0, "zero": 10.0}, {}, gain=10.0)
    assert little.believed(float(np.log(999.0)))
    assert not little.believed(float(np.log(1001.0)))


def compared(
    monkeypatch,
    *,
    apart=9.0,
    moved=(9.0, 9.0),
    likelier=(0.0, 0.0),
    further=0.5,
    times_the_noise=1.0,
    told=0.0,
    ahead=0.0,
    astray=0.0,
):
    """What is found where the two holds move parameters and are likelier than a smooth force by so much.

    They leave so many ``times_the_noise``, of which a mismatch would have ``told`` so much; beforehand they seem
    likelier by ``ahead``, of which the step there leads ``astray`` by so much.
    """
    moved_by, gained = (dict(zip(("zero", "linear"), pair, strict=True)) for pair in (moved, likelier))

    class Trial:
        def __init__(self, hold, problem, outcome, oscillator):
            self.hold, self.problem, self.outcome, self.noise = hold, problem, outcome, []
            self.values, self.likelihood = np.array([gained.get(hold, 0.0)]), gained.get(hold, 0.0)

        def moved(self, other):
            assert other.hold == "smooth"
            return moved_by[self.hold]

    point = SimpleNamespace(residuals=(), state=None, cost=0.0)
    problem = SimpleNamespace(
        forget=lambda: None,
        residuals=lambda _: (),
        segments=(),
    )
    monkeypatch.setattr(module, "search", lambda *_, **__: point)
    linearised = chain([0.0], repeat(-ahead))
    monkeypatch.setattr(module, "Linearised", SimpleNamespace(of=lambda *_: None))
    monkeypatch.setattr(module, "_reached", lambda *_: (next(linearised), point))
    monkeypatch.setattr(module, "cost_of", lambda *_: astray - ahead)
    monkeypatch.setattr(module, "over_noise", lambda *_: [1.0, times_the_noise])
    monkeypatch.setattr(module, "gain_of_mismatch", lambda *_: (np.array([told]), 1.0))
    monkeypatch.setattr(module, "_Trial", Trial)
    monkeypatch.setattr(module, "_noise", lambda *_: [])
    monkeypatch.setattr(module, "_under", lambda *_: problem)
    monkeypatch.setattr(module, "_distance", lambda *_: apart)
    monkeypatch.setattr(module, "_further", lambda *_: further)
    return find_hold(problem, None, None, ())  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize(("apart", "compares"), [(0.99, False), (1.01, True)])
def test_a_hold_that_no_response_shows_is_not_asked_for(monkeypatch, apart, compares):
    """All that it does to the motion is less than one standard deviation of the noise: no parameter can tell it."""
    assert bool(compared(monkeypatch, apart=apart).log_odds) is compares


@pytest.mark.parametrize(("moved", "matters"), [(0.99, False), (1.01, True)])
def test_a_hold_matters_where_it_moves_a_parameter_by_its_error(monkeypatch, moved, matters):
    found = compared(monkeypatch, moved=(moved, 0.0), likelier=(50.0, 99.0))
    assert found.hold == ("zero" if matters else "smooth")
    assert found.log_odds == ({"smooth": 0.0, "zero": 50.0, "linear": 99.0} if matters else {})


@pytest.mark.parametrize(
    ("ahead", "astray", "times_the_noise", "fitted"),
    [
        (-20.6, 0.0, 1.0, True),
        (-20.8, 0.0, 1.0, False),
        (-20.8, 0.0, 1.11, True),
        (-40.0, 19.2, 1.0, False),
        (-40.0, 19.4, 1.0, True),
        (-40.0, -19.4, 1.0, True),
    ],
)
def test_what_is_hopeless_beforehand_is_not_fitted(monkeypatch, ahead, astray, times_the_noise, fitted):
    """Of a weight of one in a thousand million; where more than noise is left, nobody knows beforehand.

    Nor where the linearised step does not lead where it says.
    """
    found = compared(
        monkeypatch, ahead=ahead, astray=astray, times_the_noise=times_the_noise, likelier=(1.0, 1.0), told=1.0
    )
    assert bool(found.values) is fitted
    assert found.log_odds["zero"] == pytest.approx(1.0 if fitted else ahead)


@pytest.mark.parametrize(("odds", "hold"), [(999.0, "smooth"), (1001.0, "linear")])
def test_a_hold_is_found_at_odds_of_a_thousand(monkeypatch, odds, hold):
    found = compared(monkeypatch, likelier=(1.0, float(np.log(odds))))
    assert found.hold == hold
    assert found.further == (0.5 if hold == "linear" else 0.0)
    assert set(found.values) == {"smooth", "zero", "linear"}


@pytest.mark.parametrize(
    ("times_the_noise", "told", "hold"),
    [
        (1.09, 0.0, "linear"),
        (1.11, 0.0, "smooth"),
        (1.11, 6.8, "smooth"),
        (1.11, 7.0, "linear"),
        (1.11, -7.0, "smooth"),
    ],
)
def test_beside_a_mismatch_a_hold_is_as_likely_as_that_tells(monkeypatch, times_the_noise, told, hold):
    """Every sample speaks for it where what is left is noise, and a few numbers a stretch where it is not."""
    found = compared(monkeypatch, likelier=(1.0, 50.0), times_the_noise=times_the_noise, told=told)
    assert found.hold == hold
    assert found.log_odds["linear"] == pytest.approx(50.0 if times_the_noise < 1.1 else max(told, 0.0))


def test_a_distance_is_in_standard_errors_of_what_is_known():
    """Of three parameters one is not known at all."""
    trial, other = object.__new__(_Trial), object.__new__(_Trial)
    trial.values, trial.errors = np.array([1.0, 5.0, 3.0]), np.array([0.5, 0.0, 2.0])
    other.values = np.array([2.5, -9.0, 2.0])
    assert trial.moved(other) == pytest.approx(3.0)


def test_what_is_not_known_is_spread_by_its_probability():
    values = {"smooth": np.array([1.0, 0.0]), "linear": np.array([1.2, 0.1])}
    even = HoldFound("smooth", {"smooth": 0.0, "linear": 0.0}, values)
    assert even.spread("smooth") == pytest.approx(np.array([[0.02, 0.01], [0.01, 0.005]]))
    for odds, std in ((999.0, 0.2 / np.sqrt(2.0)), (1001.0, 0.2 / np.sqrt(1002.0))):  # as long as it is not ruled out
        unlikely = HoldFound("smooth", {"smooth": 0.0, "linear": -np.log(odds)}, values).spread("smooth")
        assert np.sqrt(np.asarray(unlikely)[0, 0]) == pytest.approx(std)
    assert HoldFound("smooth", {"smooth": 0.0, "linear": -800.0}, values).spread("smooth") == pytest.approx(0.0)
    assert HoldFound("smooth", {}, {}).spread("smooth") == 0.0
    three = HoldFound(
        "smooth", {"smooth": 0.0, "linear": -5.0, "zero": -6.0}, {**values, "zero": np.array([0.9, 0.0])}
    ).spread("smooth")
    assert np.asarray(three)[0, 0] == pytest.approx((0.2**2 + 0.1**2) / 3)


def test_only_recordings_that_say_nothing_are_given_a_hold():
    first, second = rig("smooth", 40, "random")
    mixed = held_as([replace(first, hold="linear"), second], "zero")
    assert [r.hold for r in mixed] == ["linear", "zero"]
    assert hold_of_recordings(mixed) == "smooth"
    assert hold_of_recordings(held_as([first, second], "zero")) == "zero"
