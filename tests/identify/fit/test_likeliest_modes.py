"""How many modes ring: against damped cosines in closed form, and rigs that scipy integrates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.identify import identify
from dashpot.identify.fit.likeliest_modes import _is_a_tone, modes_of_fit
from dashpot.identify.start.further_modes import with_modes
from dashpot.model import Oscillator
from dashpot.recording.recording import Recording
from scipy.integrate import solve_ivp
from scipy.signal import cont2discrete, lfilter, lsim

FIRST, ZETA = 2 * np.pi * 5.0, 0.006


def ringing(times, *modes):
    """Damped cosines of natural frequencies in rad/s, damping ratios and amplitudes."""
    return sum(a * np.exp(-z * w * times) * np.cos(w * np.sqrt(1 - z**2) * times + 0.4) for w, z, a in modes)


def bent_ringing(times, cubic):
    """The first mode with a cubic spring, let go at 1 mm, by scipy."""

    def rates(_, z):
        return [z[1], -2 * ZETA * FIRST * z[1] - FIRST**2 * z[0] - cubic * z[0] ** 3]

    return solve_ivp(rates, (0, times[-1]), [1e-3, 0.0], "DOP853", times, rtol=1e-10, atol=1e-14).y[0]


def answers(recording, *modes):
    """That frequency and damping ratio of each mode are within 3.5 errors; the first is the model's."""
    found = identify([recording], doubted=False).oscillator
    known = found.parameters()
    names = [("omega0", "viscous"), ("further-mode.frequency", "further-mode.viscous")]
    assert len(modes_of_fit(found)) == len(modes)
    for (frequency, viscous), (omega, zeta, *_) in zip(names, modes, strict=False):
        for name, truth in ((frequency, omega), (viscous, 2 * zeta * omega)):
            assert abs(known[name].value - truth) < 3.5 * known[name].std, (name, known[name], truth)
    return found


@pytest.mark.parametrize(("ratio", "share"), [(1.02, 0.3), (1.07, 0.01), (2.7, 0.01), (0.98, 0.05)])
def test_two_free_modes(ratio, share):
    times = np.arange(2400) / 60.0
    modes = (FIRST, ZETA, 1e-3), (ratio * FIRST, 1.4 * ZETA, 1e-3 * np.sqrt(share))
    x = ringing(times, *modes) + 1e-6 * np.random.default_rng(1).standard_normal(times.size)
    found = answers(Recording("free", 60.0, x), *modes)
    assert (found.values()["cubic"], found.values()["dry"]) == (0.0, 0.0)


def test_a_nonlinear_mode_beside_another():
    """Seven per cent away: the cubic of the one is found, and nothing of it goes into the other."""
    cubic = 0.2 * FIRST**2 / 1e-3**2
    times = np.arange(2400) / 60.0
    own = bent_ringing(times, cubic)
    other = (1.07 * FIRST, ZETA, 3e-4)
    x = own + ringing(times, other) + 1e-6 * np.random.default_rng(2).standard_normal(times.size)
    found = answers(Recording("beside", 60.0, x), (FIRST, ZETA), other)
    p = found.parameters()["cubic"]
    assert abs(p.value - cubic) < 3.5 * p.std < 0.05 * cubic


def test_one_nonlinear_mode_is_not_two():
    cubic = 0.3 * FIRST**2 / 1e-3**2
    times = np.arange(1500) / 60.0
    own = bent_ringing(times, cubic)
    x = own + 1e-6 * np.random.default_rng(3).standard_normal(times.size)
    assert len(modes_of_fit(identify([Recording("one", 60.0, x)], doubted=False).oscillator)) == 1


@pytest.mark.parametrize(
    ("hertz", "zeta", "more", "power", "cycles"),
    [(0.25, 0.008, 0.5, 2.0, 25), (2.0, 0.005, 0.3, 2.0, 60), (12.5, 0.03, 1.0, 2.0, 40), (15.0, 0.004, 3.0, 3.0, 80)],
)
def test_one_mode_with_drag_is_not_two(hertz, zeta, more, power, cycles):
    """Its damping falls as it swings less; two modes within their bandwidth imitate it, with far too little damping.

    The drag is a power of the speed, of the size of ``more`` times the viscous damping where it begins.
    """
    omega, peak = 2 * np.pi * hertz, 3e-3
    drag = more * zeta * 0.75 * np.pi * omega * (omega * peak) ** (1.0 - power)
    times = np.arange(0.0, cycles / hertz, 0.01 / hertz)

    def rates(_, z):
        return [z[1], -2 * zeta * omega * z[1] - omega**2 * z[0] - drag * abs(z[1]) ** (power - 1) * z[1]]

    x = solve_ivp(rates, (0, times[-1]), [-peak, 0.0], "DOP853", times, rtol=1e-9, atol=1e-12).y[0]
    noisy = x + 1e-3 * peak * np.random.default_rng(45).standard_normal(times.size)
    found = identify([Recording("drag", 100 * hertz, noisy)])
    assert len(modes_of_fit(found.oscillator)) == 1
    assert any("may be off by more than their errors" in note for note in found.notes)


def test_two_driven_modes():
    """Both answer the recorded force, each with a modal mass of its own."""
    fs, random = 200.0, np.random.default_rng(4)
    times = np.arange(3000) / fs
    force = np.sin(2 * np.pi * (3.0 * times + 0.15 * times**2))
    modes, masses = ((FIRST, 0.02), (1.3 * FIRST, 0.02)), (2.0, 5.0)
    x = sum(lsim(([1 / m], [1.0, 2 * z * w, w**2]), force, times)[1] for (w, z), m in zip(modes, masses, strict=True))
    x = x + 1e-3 * np.std(x) * random.standard_normal(times.size)
    found = answers(Recording("driven", fs, x, force, hold="linear"), *modes).parameters()
    for name, truth in (("mass", masses[0]), ("further-mode.participation", 1 / masses[1])):
        assert abs(found[name].value - truth) < 3.5 * found[name].std < 0.1 * truth


def test_hum_is_no_mode():
    """A line that no force drives and no damping ends, in the band of the sweep."""
    fs, random = 200.0, np.random.default_rng(5)
    times = np.arange(3000) / fs
    force = np.sin(2 * np.pi * (3.0 * times + 0.15 * times**2))
    x = lsim(([0.5], [1.0, 2 * 0.02 * FIRST, FIRST**2]), force, times)[1]
    hum = 0.02 * np.std(x) * np.sin(1.17 * FIRST * times + 0.3)
    x = x + hum + 1e-3 * np.std(x) * random.standard_normal(times.size)
    found = identify([Recording("driven", fs, x, force, hold="linear")], faults=True)
    assert len(modes_of_fit(found.oscillator)) == 1
    assert ["a line of 5.85 Hz" in sentence for sentence in found.faults] == [True]


@pytest.mark.parametrize("seed", [0, 2])
def test_two_modes_under_a_held_force(seed):
    """Under a smooth force two modes leave more than noise, and one mode under any: each tells beside the other."""
    fs, n, random = 125.0, 1500, np.random.default_rng(seed)
    modes = ((2 * np.pi * 5.0, 0.08, 1.0), (2 * np.pi * 9.0, 0.05, 4.0))
    force = np.repeat(random.choice([-1.0, 1.0], n // 6 + 1), 6)[:n]
    x = np.zeros(n)
    for omega, zeta, mass in modes:
        b, a, _ = cont2discrete(([1 / mass], [1, 2 * zeta * omega, omega**2]), 1 / fs, method="zoh")
        x += lfilter(np.ravel(b), a, force)
    x += 1e-3 * np.std(x) * random.standard_normal(n)
    assert answers(Recording("two-level", fs, x, force), *modes).hold == "zero"


def test_a_held_force_is_no_further_mode():
    """Ten samples a cycle: far from resonance what a hold does to the response is what a mode above it would do."""
    fs, n, random = 100.0, 2000, np.random.default_rng(3)
    omega, zeta, times = 2 * np.pi * 5.0, 0.02, np.arange(2000) / 100.0
    force = np.sin(2 * np.pi * 5.4 * times) * (times % 5.0 < 2.0)
    b, a, _ = cont2discrete(([1.0], [1, 2 * zeta * omega, omega**2]), 1 / fs, method="zoh")
    x = lfilter(np.ravel(b), a, force)
    x += 1e-3 * np.std(x) * random.standard_normal(n)
    found = identify([Recording("bursts", fs, x, force)])
    assert (len(modes_of_fit(found.oscillator)), found.oscillator.hold) == (1, "zero")
    mass = found.oscillator.mass
    assert abs(mass.value - 1.0) < 4 * mass.std < 0.01


@pytest.mark.parametrize(
    ("participation", "viscous", "tone"),
    [((0.7, 0.1), (-4e-3, 4e-5), False), ((-0.14, 0.1), (-4e-3, 4e-5), True), ((0.14, 0.1), (4e-3, 4e-5), False)],
)
def test_damping_below_zero_ends_no_mode(participation, viscous, tone):
    """What is begun at a line of hum and has not come to its end is negative there by many of its errors."""
    model = Oscillator.from_values(
        {"mass": 2.0, "omega0": FIRST, "cubic": 0.0, "preload": 0.0, "viscous": 0.4, "dry": 0.0}
    )
    (term,) = with_modes(model, [(FIRST, 0.01, 0.5), (3 * FIRST, 0.01, 0.5)]).terms
    known = {"participation": participation, "viscous": viscous}
    told = {name: replace(term.parameters[name], value=v, std=e) for name, (v, e) in known.items()}
    assert _is_a_tone(replace(term, parameters={**term.parameters, **told})) is tone


def struck(seed: int, *modes: tuple[float, float, float], cubic: float = 0.0) -> Recording:
    """An accelerometer that shows two blows upon modes (rad/s, damping ratio, part of the force), the third unknown."""
    fs, n, random = 500.0, 4000, np.random.default_rng(seed)
    force = np.zeros(n)
    for start in (100, 2100):
        force[start : start + 8] = 30.0 * np.sin(np.pi * (np.arange(8) + 0.5) / 8)
    x = np.zeros(n)
    for omega, zeta, part in modes:
        b, a, _ = cont2discrete(([part, 0.0, 0.0], [1, 2 * zeta * omega, omega**2]), 1 / fs, method="foh")
        x += lfilter(np.ravel(b), a, force)
    x += cubic * np.sign(x) * np.abs(x) ** 1.5
    return Recording("struck", fs, x + 1e-3 * np.std(x) * random.standard_normal(n), force, quantity="acceleration")


@pytest.mark.parametrize("bent", [0.0, 0.02])
def test_two_struck_modes_seven_per_cent_apart(bent):
    """The sensor shows one of them against the blows; a sensor that is a little bent leaves more than noise."""
    modes = (2 * np.pi * 19.0, 0.003, -0.15), (2 * np.pi * 20.5, 0.002, 0.16)
    found = identify([struck(6, *modes, cubic=bent)], doubted=False)
    known = sorted(modes_of_fit(found.oscillator))
    assert len(known) == 2
    assert found.fit.segments[0].over_noise > (3.0 if bent else 0.0)
    for (omega, zeta, gain), (w, z, part) in zip(known, sorted(modes), strict=True):
        assert (omega, zeta, gain) == (
            pytest.approx(w, rel=1e-3),
            pytest.approx(z, rel=0.05),
            pytest.approx(part, rel=0.1),
        )
