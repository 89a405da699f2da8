"""Free decays found by themselves."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.virtual_recording import recording_of
from dashpot.identify import identify
from dashpot.identify.motion.decay import Decay
from dashpot.identify.motion.decays import _explains, find_decays, find_free_motion
from dashpot.identify.motion.free_motion import off_behind
from dashpot.identify.motion.shared_modes import SharedModes
from dashpot.identify.signals.signals import Signal
from dashpot.recording.recording import Recording
from scipy.integrate import solve_ivp

DATA = Path(os.environ.get("DASHPOT_DATA", Path(__file__).parents[4] / "shared" / "data"))


def real(name):
    path = DATA / name
    if not path.exists():
        pytest.skip(f"{name} is not here; set DASHPOT_DATA to the folder that has it")
    table = np.genfromtxt(path, delimiter=",", skip_header=1)
    return Recording(name, (len(table) - 1) / (table[-1, 0] - table[0, 0]), table[:, 1])


@pytest.fixture(scope="module")
def burst(rigs):
    return rigs.case(rigs.reference, rigs.bursts(1.0, 13.0, 1.0, 3.0), 1000.0, 12.0)


@pytest.mark.parametrize("noise", [0.0, 1.0, 10.0])
@pytest.mark.parametrize("offset", [0.0, 0.05])
def test_switch_off_is_found_in_the_force(burst, noise, offset):
    case = burst.noisy(noise * 1e-6, noise * 1e-3, 3)
    decays = find_decays(Recording("burst", 1000.0, case.x, case.force + (offset if not noise else 0)))
    assert [d.start // 1000 for d in decays] == [1, 5, 9]
    for d in decays:
        assert d.start % 1000 <= 2
        # down to the noise, and not into the next burst
        assert 1400 < d.stop - d.start < 2300


@pytest.mark.parametrize("noise", [0.0, 1.0, 10.0])
def test_the_corner_is_found_without_the_force(burst, rigs, noise):
    """Within two cycles after the switch-off, or before it where what the force does by then is twice the noise.

    It comes down to zero along a straight line: F' t³ / 6 m.
    """
    case = burst.noisy(noise * 1e-6, 0, 3)
    decays = find_decays(Recording("burst", 1000.0, case.x))
    hidden = 1000.0 * (6 * 2 * noise * 1e-6 * rigs.reference.mass / (2 * np.pi * 13.0)) ** (1 / 3)
    for d, off in zip(decays, (1000, 5000, 9000), strict=True):
        assert -max(hidden, 2.0) <= d.start - off < 160


def test_driven_steady_state_is_left_out(rigs):
    case = rigs.case(rigs.reference, rigs.bursts(0.5, 11.0, 6.0, 4.0), 1000.0, 9.9)
    (decay,) = find_decays(Recording("steady", 1000.0, case.noisy(1e-6, 0, 1).x))
    assert 6000 <= decay.start < 6200


def test_a_zero_or_merely_noisy_force_column_is_a_free_decay(reference_decay):
    x = reference_decay.noisy(1e-6, 0, 1).x
    noise = 1e-3 * np.random.default_rng(5).standard_normal(x.size)
    for force in (None, np.zeros_like(x), np.full_like(x, 0.2), noise):
        (decay,) = find_decays(Recording("ringdown", 1000.0, x, force))
        assert decay.start == 0
        assert 1700 < decay.stop < 2300


def test_rest_before_a_release_is_left_out(reference_decay):
    x = np.concatenate([np.zeros(2000), reference_decay.x])
    (decay,) = find_decays(Recording("rest", 1000.0, x + 1e-6 * np.random.default_rng(1).standard_normal(x.size)))
    assert 2000 <= decay.start < 2200


def test_sweeps_and_multisines_hold_no_decay(rigs, reference_sweeps):
    multisine = rigs.case(rigs.reference, rigs.multisine(0.5, 5, 20, 4, 2), 1000.0, 12.0)
    for case in (*reference_sweeps, multisine):
        case = case.noisy(1e-6, 1e-3, 4)
        assert find_decays(Recording("forced", 1000.0, case.x, case.force)) == ()


@pytest.mark.parametrize("x", [np.zeros(1000), np.arange(1000.0), np.array([0.0, 1.0]), np.sin(0.3 * np.arange(3000))])
def test_nothing_to_find_is_no_error(x):
    assert find_decays(Recording("odd", 1000.0, x)) == ()


def test_ship_roll():
    r = real("kvlcc2_roll_21338.csv.gz")
    (decay,) = find_decays(r)
    largest = int(np.argmax(np.abs(r.response)))
    assert largest - 100 < decay.start < largest + 600
    assert decay.stop > 0.95 * r.n


def test_beam_between_magnets_after_its_shaker():
    r = real("frid_magmech_decay.csv.gz")
    (decay,) = find_decays(r)
    driven = np.max(np.abs(r.response[:10000]))
    before, after = (np.max(np.abs(r.response[i : i + 50])) for i in (decay.start - 100, decay.start + 50))
    assert before > 0.9 * driven > after


@pytest.mark.parametrize("noise", [1e-4, 1e-2])
@pytest.mark.parametrize(("ratio", "cycles"), [(1e-3, 20), (2e-4, 100), (3e-4, 100), (1e-4, 400), (2.5e-3, 100)])
def test_a_lightly_damped_decay_is_found_whole_that_falls_by_a_tenth_or_more(ratio, cycles, noise):
    """Its last cycles are as good as level, and are no rest after it."""
    t = np.arange(40 * cycles) / 40
    x = np.exp(-2 * np.pi * ratio * t) * np.cos(2 * np.pi * t)
    seen = x + noise * np.random.default_rng(cycles).standard_normal(t.size)
    assert [(d.start, d.stop) for d in find_decays(Recording("fork", 40.0, seen))] == [(0, t.size)]


@pytest.mark.parametrize("noise", [1e-4, 1e-2])
def test_a_tone_that_does_not_fall_is_no_decay(noise):
    t = np.arange(4000) / 40
    seen = np.cos(2 * np.pi * t) + noise * np.random.default_rng(1).standard_normal(t.size)
    assert find_decays(Recording("tone", 40.0, seen)) == ()


@pytest.mark.parametrize("noise", [1e-4, 1e-2])
def test_a_fall_by_six_per_cent_is_a_decay_where_it_is_known(noise):
    t = np.arange(4000) / 40
    x = np.exp(-2 * np.pi * 1e-4 * t) * np.cos(2 * np.pi * t)
    seen = x + noise * np.random.default_rng(1).standard_normal(t.size)
    (decay,) = find_decays(Recording("fork", 40.0, seen))
    assert decay.rate == pytest.approx(2 * np.pi * 1e-4, rel=0.1)


@pytest.mark.parametrize(
    ("pieces", "believed"),
    [
        ([(0, 900, 900)], True),
        ([(0, 800, 800)], False),  # the frequency glides: the loud part is another mode
        ([(0, 200, 200), (300, 600, 600), (700, 800, 800), (1200, 1600, 1600)], True),  # the hand's ways are left out
    ],
)
def test_modes_are_believed_that_take_about_what_an_envelope_does(pieces, believed):
    mode = {"share": np.ones(1), "errors": np.zeros((3, 1))}
    shared = SharedModes(tuple(pieces), np.array([1.0]), np.array([0.01]), 0, 0.01, 1e-4, 100.0, **mode)
    swings = np.cos(np.arange(2000) / 8.0)  # 1 rad/s
    for _, stop, _ in pieces if believed else ():
        swings[stop:] *= -1  # let go again
    assert _explains(shared, Signal(swings, 8.0), [Decay(0, 1000)]) is believed


@pytest.mark.parametrize("quantity", ["displacement", "velocity", "acceleration"])
@pytest.mark.parametrize("drift", [0.0, 0.01])
def test_a_hand_that_stops_a_motion_ends_its_decay(quantity, drift):
    """Seven swings, brought to rest within a tenth of a cycle, then held for a cycle and a half."""
    fs, per, zeta, level = 400.0, 400, 0.036, ("displacement", "velocity", "acceleration").index(quantity)
    omega = 2 * np.pi * fs / per
    pole = omega * (1j * np.sqrt(1 - zeta**2) - zeta)
    t = np.arange(round(7.3 * per)) / fs
    swings = [(pole**k * np.exp(pole * t)).real for k in range(3)]
    length = 0.1 * per / fs
    begun = [swings[k][-1] * length**k for k in range(2)] + [swings[2][-1] * length**2 / 2]
    powers = np.arange(6)
    ends = np.array([powers**0.0, powers, powers * (powers - 1.0)])
    way = np.polynomial.Polynomial([*begun, *np.linalg.solve(ends[:, 3:], -ends[:, :3] @ begun)])
    hand = (way.deriv(level) if level else way)(np.arange(1, per // 10 + 1) / (per // 10)) / length**level
    shown = np.concatenate([swings[level], hand, np.zeros(3 * per // 2)])
    size = np.ptp(shown)
    shown = shown + size * (
        5e-4 * np.random.default_rng(0).standard_normal(shown.size) + drift * np.arange(shown.size) / fs
    )
    (decay,) = find_decays(Recording("stopped", fs, shown, quantity=quantity))
    assert decay.start == 0
    assert t.size - 0.1 * per < decay.stop <= t.size + 0.02 * per


@pytest.mark.parametrize("force", [None, 0.0, 0.37])
@pytest.mark.parametrize(("quantity", "level"), [("displacement", 1.0), ("displacement", 0.4), ("velocity", 1.0)])
def test_a_sweep_whose_force_is_not_there_has_no_free_motion(force, quantity, level):
    """One or two of its cycles fall as a decay does, and many a rig explains them."""
    run = recording_of(sweep=(level, 6.3, 20.2), fs=300.0, seconds=3.2, quantity=quantity, name="run")
    run = replace(run, force=None if force is None else np.full(run.n, force))
    motion = find_free_motion(run)
    assert motion.decays == ()
    assert motion.swell is not None
    begin, end = motion.swell
    assert 0 < begin < end < run.n
    assert end - begin > 5 * 300 / 20.2
    says = "there is no force" if force is None else f"the force is {force:g} N throughout"
    (note,) = motion.notes
    assert note.startswith(f"run: {says} while the response grows swing by swing from {begin / 300:.4g} to")
    with pytest.raises(BadInput, match=r"^run: .* while the response grows .* was the force recorded\?"):
        identify([run])


def test_what_is_let_go_after_a_drive_is_free_all_the_same():
    """The drive ends before the record does, and twenty cycles ring."""
    run = recording_of(sweep=(1.0, 6.3, 20.2), fs=300.0, seconds=3.2)
    freely = recording_of(begin=(5e-3, 0.0), fs=300.0, seconds=3.2, seed=1)
    both = replace(run, force=None, response=np.concatenate([run.response, np.zeros(90), freely.response]))
    decays = find_free_motion(both).decays
    assert decays
    assert all(decay.start >= run.n for decay in decays)


def pulled_and_let_go(resists, seed):
    """A rig of 3 Hz, pulled aside four times, held for about a second and let go; samples of the releases."""
    random, omega, size, fs = np.random.default_rng(seed), 2 * np.pi * 3.0, 3e-3, 120.0
    times, parts, edges = np.arange(0.0, 9.0, 1 / fs), [np.zeros(1)], []

    def rates(_, z):
        return [z[1], -(omega**2) * z[0] - 0.04 * omega * z[1] - resists(z[0] / size, z[1] / omega / size) * size]

    for pulled in size * np.array([1.0, -0.8, 0.6, -0.9]):
        free = solve_ivp(rates, (0, times[-1]), [pulled, 0.0], "DOP853", times, rtol=1e-8, atol=1e-12, max_step=0.01)
        held = np.full(round(fs * random.uniform(0.7, 1.2)), pulled)
        parts += [np.linspace(parts[-1][-1], pulled, round(0.4 * fs)), held, free.y[0]]
        end = sum(map(len, parts))
        edges.append((end - times.size, end))
    x = np.concatenate(parts)
    return Recording("pulled", fs, x + 1e-3 * size * random.standard_normal(x.size)), edges


@pytest.mark.parametrize(
    ("resists", "seed"),
    [
        pytest.param(lambda x, v: 0.06 * (6 * np.pi) ** 2 * v**3, 3, id="damping"),
        pytest.param(lambda x, v: -0.3 * (6 * np.pi) ** 2 * np.clip(x, -0.1, 0.1), 11, id="clearance"),
        pytest.param(lambda x, v: 2.0 * (6 * np.pi) ** 2 * max(x - 0.7, 0.0), 3, id="stop"),
    ],
)
def test_releases_of_a_rig_that_eq_17_does_not_hold_are_whole(resists, seed):
    """Parts of them that Eq. 17 explains are no releases, and that a hand comes again is not the rig's frequency."""
    recording, edges = pulled_and_let_go(resists, seed)
    found = find_decays(recording)
    assert len(found) == 4
    for decay, (start, stop) in zip(found, edges, strict=True):
        assert abs(decay.start - start) < 40  # a cycle
        assert decay.stop - decay.start > 0.8 * (stop - start)


def test_what_is_behind_a_piece_goes_on_or_is_another_motion():
    """Two modes go on as they would; what a hand stops is off by as much as it swung, and what bends by little."""
    t = np.arange(1000) / 100.0
    omega, rate = np.array([6.0, 9.0]), np.array([0.3, 0.2])
    turn = np.sqrt(omega**2 - rate**2)
    x = (np.exp(-rate * t[:, None]) * np.cos(turn * t[:, None])) @ [1.0, 0.3] + 0.2
    noise = 1e-4 * np.random.default_rng(6).standard_normal(t.size)

    def behind(x, stop):
        return off_behind(Signal(x + noise, 100.0), (100, stop), omega, rate)

    off, whole = behind(x, 500)
    assert off < 0.01
    assert whole
    held = np.where(t < 5.0, x, x[499])
    assert behind(held, 500)[0] > 1.0
    slower = np.where(t < 5.0, x, np.interp(5.0 + 0.97 * (t - 5.0), t, x))
    assert 0.01 < behind(slower, 500)[0] < 1 / 3
    assert behind(x, 999) is None
    assert not behind(x, 980)[1]


def plucked(seed):
    """Two modes of 3.7 and 5.8 Hz, plucked eight times within a few cycles, never loud before a pluck for long; SI."""
    random, fs = np.random.default_rng(seed), 400.0
    poles = 2 * np.pi * np.array([3.733, 5.779]) * (-5e-4 + 1j)
    state, parts = np.zeros(2, complex), []
    for strength in (0.05, 0.03, 0.06, 0.1, 0.15, 0.17, 0.16, 0.15):
        state = state + strength * random.standard_normal(2) * np.array([1.0, 0.4])
        t = np.arange(round(random.uniform(1.4, 2.2) * fs)) / fs
        parts.append(np.real(np.exp(np.outer(t, poles)) @ (state * poles)))
        state = state * np.exp(poles * (t[-1] + 1 / fs))
    shown = np.concatenate(parts)
    return shown + 1e-3 * np.std(shown) * random.standard_normal(shown.size), fs


@pytest.mark.parametrize("seed", range(4))
def test_plucks_that_come_before_anything_has_fallen_are_pieces_of_the_modes_that_they_share(seed):
    """Each goes on nearly as the one before it, and no envelope falls."""
    shown, fs = plucked(seed)
    motion = find_free_motion(Recording("plucks", fs, shown, quantity="acceleration"))
    assert len(motion.modes) == 2
    assert sorted(mode.frequency for mode in motion.modes) == pytest.approx([3.733, 5.779], rel=1e-3)
    assert sum(decay.stop - decay.start for decay in motion.decays) > 0.9 * shown.size


def test_a_small_sway_before_each_release_drives_nothing():
    """A hand sways a rig of 16 % over fourteen growing swings, to a tenth of what is let go: four are above noise."""
    random, fs, omega, zeta = np.random.default_rng(3), 52.0, 7.58, 0.16
    t = np.arange(0.0, 12.0, 1 / fs)
    turn = omega * np.sqrt(1 - zeta**2)
    fall = np.exp(-zeta * omega * t) * (np.cos(turn * t) - zeta / np.sqrt(1 - zeta**2) * np.sin(turn * t))
    sway = 0.1 * np.linspace(0.0, 1.0, t.size) * np.sin(omega * t)
    shown = np.concatenate([np.concatenate([0.0 * t, sway, size * fall]) for size in (1.0, 0.8, 1.2)])
    shown += 1e-2 * random.standard_normal(shown.size)
    motion = find_free_motion(Recording("releases", fs, shown, quantity="acceleration"))
    assert motion.swell is None
    assert [decay.start for decay in motion.decays] == pytest.approx([2 * t.size, 5 * t.size, 8 * t.size], abs=4)


def test_a_rest_behind_a_decay_of_friction_is_not_its_frequency():
    """Five swings and a minute of rest off an accelerometer's zero: twice integrated, the rest is the largest line."""
    omega, zeta, level, fs = 2.3576, 0.1, 2.9e-3, 88.68
    x, begin, parts = -2.5e-3, 0.0, []
    friction, rig = 1.33e-4 / omega**2, omega * np.sqrt(1 - zeta**2)
    half = np.pi / rig
    while abs(x) > friction and len(parts) < 40:  # from turn to turn about the place that friction shifts rest to
        rest = friction * np.sign(x)
        parts.append((begin, x, rest))
        x, begin = rest - (x - rest) * np.exp(-zeta * omega * half), begin + half
    t = np.arange(0.0, 57.6, 1 / fs)
    shown = np.zeros(t.size)
    for begin, size, rest in parts:
        now = (t >= begin) & (t < begin + half)
        u = t[now] - begin
        wave = np.cos(rig * u) - zeta / np.sqrt(1 - zeta**2) * np.sin(rig * u)
        shown[now] = -(omega**2) * (size - rest) * np.exp(-zeta * omega * u) * wave
    shown += level * -1.24 + 1.9e-5 * np.random.default_rng(2).standard_normal(t.size)
    found = identify([Recording("let go", fs, shown, quantity="acceleration")]).oscillator.parameters()
    assert found["omega0"].value == pytest.approx(omega, abs=4 * found["omega0"].std)
    assert found["viscous"].value == pytest.approx(2 * zeta * omega, abs=4 * found["viscous"].std)
    assert found["dry"].value == pytest.approx(1.33e-4, abs=4 * found["dry"].std)
