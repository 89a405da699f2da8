"""One mode of several, from rigs that scipy integrates in physical coordinates; single modes stay untouched."""

from __future__ import annotations

import math

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.identify import identify
from dashpot.identify.motion.mode_lines import modes_of
from dashpot.identify.motion.modes import in_band_of, isolated, mode_of
from dashpot.model import Oscillator
from dashpot.model.file import dumps, loads
from dashpot.model.oscillator import Band
from dashpot.recording.recording import Recording
from scipy.integrate import solve_ivp

FS = 1000.0
PLAIN = Oscillator.from_values(dict.fromkeys(("omega0", "cubic", "preload", "viscous", "dry"), 1.0))
DAMPING = (0.004, 0.006, 0.005)


def rig(hertz, seconds, start, *, cubic=0.0, noise=2e-6, force=None, fs=FS):
    """Response of the first mass of a chain of masses, in m, and what its first mode alone does there.

    The modes of the frequencies have shapes that are not orthogonal to the masses' axes; the cubic force acts along the
    first one's. ``start`` are modal velocities in m/s at the first mass.
    """
    n = len(hertz)
    turned = np.linalg.qr(np.vander(np.linspace(1.0, 2.0, n), increasing=True) + np.eye(n))[0]
    mass = np.diag(np.linspace(0.4, 0.9, n))
    shapes = np.linalg.solve(np.sqrt(mass), turned)  # mass-normalised, in columns
    shapes = shapes * np.sign(shapes[0])
    omega = 2 * np.pi * np.array(hertz)
    modal = mass @ shapes
    stiffness = modal @ np.diag(omega**2) @ modal.T
    damping = modal @ np.diag(2 * np.array(DAMPING[:n]) * omega) @ modal.T
    inverse = np.linalg.inv(mass)
    scale = cubic / shapes[0, 0] ** -2  # in the displacement of the first mass

    def slope(t, state):
        x, v = state[:n], state[n:]
        push = -stiffness @ x - damping @ v - modal[:, 0] * scale * (modal[:, 0] @ x) ** 3
        if force is not None:
            push = push + np.eye(n)[0] * force(t)
        return np.concatenate([v, inverse @ push])

    begin = np.concatenate([np.zeros(n), shapes @ (np.array(start) / shapes[0])])
    time = np.arange(round(seconds * fs)) / fs
    longest = np.inf if force is None else 1e-3  # no step over a blow
    states = solve_ivp(slope, (0, time[-1]), begin, "DOP853", time, rtol=1e-10, atol=1e-13, max_step=longest).y[:n]
    alone = shapes[0, 0] * (modal[:, 0] @ states)
    measured = states[0] + noise * np.random.default_rng(5).standard_normal(time.size)
    pushed = None if force is None else np.array([force(t) for t in time])
    return Recording("chain.csv", fs, measured, pushed), alone, shapes[0, 0] ** -2


def within(identification, truth, errors=3.0):
    for name, value in truth.items():
        parameter = getattr(identification.oscillator, name)
        assert abs(parameter.value - value) < errors * parameter.std, (name, parameter, value)


@pytest.mark.parametrize(
    ("hertz", "start", "wanted"),
    [
        pytest.param((12.0, 41.0), (0.3, 0.35), "1", id="two"),
        pytest.param((12.0, 41.0, 77.0), (0.3, 0.35, 0.5), None, id="three", marks=pytest.mark.long),
    ],
)
def test_the_first_of_several_modes(hertz, start, wanted):
    recording, alone, _ = rig(hertz, 12.0, start, cubic=2.0e7)
    (only,), band, note = isolated([recording], wanted)
    assert band is not None
    share = float(np.sum(alone**2) / np.sum(np.asarray(recording.response) ** 2))
    (first,) = [mode for mode in modes_of([recording]) if mode.strongest]
    assert first.share == pytest.approx(share, abs=0.01)
    assert f"holds {100 * first.share:.3g} % of the motion" in note
    assert "isolated below" in note
    # what the band leaves is that mode, to the noise that was there before and to its own third harmonic
    inside = slice(only.n // 4, -only.n // 8)
    residual = np.asarray(only.response) - alone[round(only.start * FS) :][: only.n]
    assert float(np.std(residual[inside])) < 1.5 * 2e-6
    identification = identify([only], band=band)
    omega = 2 * np.pi * hertz[0]
    within(identification, {"omega0": omega, "viscous": 2 * DAMPING[0] * omega, "cubic": 2.0e7})
    assert identification.oscillator.identified.band == band


def test_a_mode_that_is_asked_for():
    recording, _, _ = rig((12.0, 41.0), 12.0, (0.3, 0.35))
    for wanted in ("2", "41", "41.2 Hz"):
        (only,), band, note = isolated([recording], wanted)
        assert band is not None
        assert "above" in note
        assert 2 * np.pi * 41.0 == pytest.approx(2 * np.pi * modes_of([only])[0].frequency, rel=1e-3)
    with pytest.raises(BadInput, match=r"there is no such mode .* 1 at 12 Hz, 2 at 41 Hz"):
        isolated([recording], "60")
    with pytest.raises(BadInput, match="number of a mode"):
        mode_of([], "low")


@pytest.mark.long
def test_modes_that_the_model_does_not_hold_are_named():
    recording, _, _ = rig((12.0, 41.0, 77.0), 8.0, (0.3, 0.35, 0.5), cubic=2.0e7)
    found = identify([recording], doubted=False)
    assert max(s.over_noise for s in found.fit.segments) > 2.0
    assert found.modes_left is not None
    assert "41" in found.modes_left


def test_one_further_mode_is_left_for_the_fit():
    recording, _, _ = rig((12.0, 19.0), 12.0, (0.3, 0.2))
    (same,), band, note = isolated([recording])
    assert same is recording
    assert band is None
    assert "both are fitted together, --mode 1 isolates it" in note
    (only,), band, _ = isolated([recording], "1")
    assert band is not None
    assert len(modes_of([only])) == 1


def test_one_strongly_nonlinear_mode_is_untouched():
    """Its harmonics reach far above the noise, and its frequency moves by half."""
    recording, alone, _ = rig((12.0,), 15.0, (1.5,), cubic=2.0e7, noise=1e-7)
    power = np.abs(np.fft.rfft(alone[:4096] * np.hanning(4096)))
    lines = np.fft.rfftfreq(4096, 1 / FS)
    base = lines[np.argmax(power)]
    third = np.max(power[np.abs(lines - 3 * base) < 5])
    assert third > 1e-3 * np.max(power)  # a harmonic that would be taken for a mode
    (same,), band, note = isolated([recording])
    assert same is recording
    assert band is None
    assert note == ""


def test_a_steady_hum_is_no_mode():
    recording, _, _ = rig((12.0,), 12.0, (0.3,))
    hum = 2e-5 * np.sin(2 * np.pi * 50.0 * np.arange(recording.n) / FS)
    (same,), band, _ = isolated([Recording("hum.csv", FS, np.asarray(recording.response) + hum)])
    assert band is None
    assert np.array_equal(same.response, np.asarray(recording.response) + hum)


def test_a_band_is_flat_about_its_mode_and_closed_at_the_next():
    band = Band(100.0, 50.0, 200.0)
    frequency = np.array([1.0, 50.0, 70.0, 100.0, 150.0, 200.0, 260.0])
    assert band.gain(frequency) == pytest.approx([0.0, 0.5, 1.0, 1.0, 1.0, 0.5, 0.0], abs=1e-12)
    low, high = band.flat
    assert low < 70.0 < 150.0 < high


@pytest.mark.parametrize("band", [Band(100.0, 50.0, 200.0), Band(100.0), Band(80.5, 37.1, None)])
def test_the_model_file_keeps_the_band(band):
    model = in_band_of(
        Oscillator.from_values(dict.fromkeys(("omega0", "cubic", "preload", "viscous", "dry"), 1.0)), band
    )
    assert loads(dumps(model)).identified.band == band


def test_a_band_beside_its_mode_is_refused():
    text = dumps(in_band_of(PLAIN, Band(100.0, 50.0, 200.0))).replace("mode: 100.0", "mode: 300.0")
    with pytest.raises(BadInput, match="must lie between low and high"):
        loads(text)


def test_a_part_of_a_struck_recording_knows_its_blows():
    whole = Recording("hit", FS, np.arange(100.0), np.ones(100), struck=((10, 20, False), (60, 70, True)))
    assert whole.slice(15, 65).struck == ((0, 5, False), (45, 50, True))
    assert whole.slice(25, 50).struck == ()


@pytest.mark.long
def test_a_blow_of_a_hammer_goes_through_the_same_band():
    """The mass is in the blow: force and response stay those of one equation."""

    def blow(t):
        return 40.0 * math.sin(math.pi * (t - 1.0) / 0.01) ** 2 if 1.0 < t < 1.01 else 0.0

    recording, _, mass = rig((12.0, 41.0), 13.0, (0.0, 0.0), force=blow)
    (only,), band, _ = isolated([recording], "1")
    assert band is not None
    assert only.struck
    identification = identify([only], band=band)
    assert identification.oscillator.mass is not None
    within(identification, {"mass": mass, "omega0": 2 * np.pi * 12.0, "viscous": 2 * DAMPING[0] * 2 * np.pi * 12.0})
