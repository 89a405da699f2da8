"""What an FMU measures of its own motion: energy and dissipated power, amplitude, and whether that is one it knows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from dashpot.export.fmu import export_fmu
from dashpot.export.platforms import own_platform
from dashpot.model.laws import LIBRARY
from dashpot.model.oscillator import Range

CO_SIMULATION = "CoSimulation"
#: Not those through which not all of F comes to the mass.
EFFECTS = ["", *(name for name, law in LIBRARY.items() if not law.drive)]
VERSIONS = [2, 3]
WARNING = 1


def laws(effect: str) -> tuple[str, ...]:
    return (effect,) if effect else ()


# energy


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect or "base")
def test_what_is_put_in_is_stored_or_dissipated(law_fmu, callers, effect):
    """At any point of the motion, to rounding: the rate of the energy is F v less the dissipated power."""
    caller = callers(law_fmu(3, *laws(effect)))
    for seed in range(6):
        random = np.random.default_rng(seed)
        size = caller.initialise().nominals()
        caller.fmu.reset()
        state = random.uniform(0.1, 0.8, len(size)) * random.choice([-1, 1], len(size)) * size
        caller.start(F=float(random.uniform(-1, 1)), **dict(zip(caller.known.starts, state.tolist(), strict=True)))
        force, speed, power = caller.get("F", "velocity", "dissipated_power")
        (rate,) = caller.derivative(["energy"], ["time", *caller.known.states], [1.0, *caller.rates()])
        assert rate == pytest.approx(force * speed - power, rel=1e-10, abs=1e-12)
        caller.fmu.reset()


def balance(caller: Any, dt: float) -> tuple[float, float]:
    """What is missing in the balance of a run with a held force, and the energy that was dissipated in it."""
    n = round(0.6 / dt)
    caller.start(x0=5e-3, dry=1.0, F=0.0)
    rows = [caller.get("displacement", "energy", "dissipated_power")]
    work = 0.0
    for k in range(n):
        force = 2.0 * float(np.sin(80.0 * (k * dt // 0.02) * 0.02)) * (k * dt < 0.3)
        caller.step(k * dt, dt, force)
        rows.append(caller.get("displacement", "energy", "dissipated_power"))
        work += force * (rows[-1][0] - rows[-2][0])
    energy, power = np.array(rows).T[1:]
    lost = float(np.trapezoid(power, dx=dt))
    return abs(energy[-1] - energy[0] - work + lost), lost


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("effect", ["", "quadratic-drag", "two-sided-stop", "hysteresis", "attached-resonator"])
def test_energy_balances_over_a_run(law_fmu, callers, effect, version):
    """But for the trapezoidal rule for the dissipated power, whose error falls with the square of the step."""
    fmu = law_fmu(version, *laws(effect))
    for dt, allowed in ((1e-3, 3e-4), (1e-4, 5e-6)):
        missing, lost = balance(callers(fmu, CO_SIMULATION), dt)
        assert missing <= allowed * lost


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("interface", [CO_SIMULATION, "ModelExchange"])
def test_energy_and_power_of_the_plain_model(law_fmu, callers, with_law, interface, version):
    caller = callers(law_fmu(version), interface).start(x0=2e-3, v0=-0.3)
    m, w, c, b, h, d = (with_law().values()[n] for n in ("mass", "omega0", "cubic", "preload", "viscous", "dry"))
    energy = m * (0.3**2 / 2 + w**2 * 4e-6 / 2 + c * 16e-12 / 4 + b * 2e-3)
    assert caller.get("energy", "dissipated_power") == pytest.approx([energy, m * (h * 0.09 + d * 0.3)], rel=1e-12)


@pytest.mark.parametrize("version", VERSIONS)
def test_a_mass_that_sticks_dissipates_nothing(law_fmu, callers, version):
    caller = callers(law_fmu(version), CO_SIMULATION).start(x0=1e-4, dry=3.0)
    first = caller.get("energy", "dissipated_power")
    caller.step(0.0, 0.1, 0.5)
    assert caller.get("energy", "dissipated_power") == first
    assert first[0] > 0
    assert first[1] == 0.0


@pytest.mark.parametrize("version", VERSIONS)
def test_an_actuator_puts_in_what_it_gives(law_fmu, callers, version):
    caller = callers(law_fmu(version, "actuator-saturation")).start(F=0.1, x0=1e-3, v0=0.2)
    (limit,) = caller.get("actuator-saturation.limit")
    caller.set(F=3 * limit)
    caller.event()
    (rate,) = caller.derivative(["energy"], caller.known.states, caller.rates())
    assert rate + caller.get("dissipated_power")[0] == pytest.approx(limit * 0.2)


# amplitude

#: A spring and a damper, nothing else.
LINEAR = {"cubic": 0.0, "preload": 0.0, "dry": 0.0}


def run(caller: Any, n: int, dt: float, force: Callable[[float], float], *names: str) -> np.ndarray:
    """(n, names) outputs under a force in straight lines."""
    rows = []
    for k in range(n):
        caller.step(k * dt, dt, force(k * dt), force((k + 1) * dt))
        rows.append(caller.get(*names))
    return np.array(rows)


@pytest.mark.parametrize("version", VERSIONS)
def test_amplitude_of_a_steady_motion(law_fmu, callers, with_law, version):
    caller = callers(law_fmu(version), CO_SIMULATION).start(**LINEAR, viscous=20.0)
    m, w0 = (with_law().values()[name] for name in ("mass", "omega0"))
    w, strength = 70.0, 0.8
    amplitude = run(caller, 6000, 2e-4, lambda t: strength * float(np.sin(w * t)), "amplitude")[-1, 0]
    assert amplitude == pytest.approx(strength / m / np.hypot(w0**2 - w**2, 20.0 * w), rel=1e-4)


@pytest.mark.parametrize("version", VERSIONS)
def test_amplitude_of_a_decay_is_half_the_way_between_turning_points(law_fmu, callers, with_law, version):
    caller = callers(law_fmu(version), CO_SIMULATION).start(**LINEAR, x0=4e-3)
    w0, h = (with_law().values()[name] for name in ("omega0", "viscous"))
    damped = np.sqrt(w0**2 - h**2 / 4)
    t = np.arange(1, 801) * 1e-3
    turns = 4e-3 * (-1.0) ** np.arange(40) * np.exp(-h / 2 * np.pi / damped * np.arange(40))
    swings = np.append(0.0, np.abs(np.diff(turns)) / 2)
    amplitude = run(caller, 800, 1e-3, lambda t: 0.0, "amplitude")[:, 0]
    assert np.allclose(amplitude, swings[(t * damped / np.pi).astype(int)], rtol=1e-6, atol=0)


@pytest.mark.parametrize("interface", [CO_SIMULATION, "ModelExchange"])
@pytest.mark.parametrize("version", VERSIONS)
def test_a_motion_under_way_has_no_amplitude_before_it_turned_twice(law_fmu, callers, interface, version):
    """The way from where it happens to start says nothing."""
    caller = callers(law_fmu(version), interface).start(x0=1e-4, v0=0.3)
    assert caller.get("amplitude") == [0.0]
    if caller.exchange:
        amplitudes = [0.0, *(turn(caller, x) for x in (4e-3, -3.8e-3, 3.6e-3))]
        assert amplitudes == pytest.approx([0.0, 0.0, 3.9e-3, 3.7e-3])
        return
    rows = run(caller, 150, 1e-3, lambda t: 0.0, "amplitude", "x")
    turned = np.flatnonzero(np.diff(rows[:, 0]))
    assert turned.size >= 2
    assert 0.5 * np.ptp(rows[:, 1]) == pytest.approx(rows[turned[0] + 1, 0], rel=1e-2)


def turn(caller: Any, x: float) -> float:
    """Lets the motion turn at that place; the amplitude then."""
    v = caller.states()[1]
    caller.set_states([x, -1e-9 if v > 0 else 1e-9])
    caller.event()
    caller.set_states([x, -0.1 if v > 0 else 0.1])
    return caller.get("amplitude")[0]


# range


@pytest.fixture(scope="module")
def ranged(with_law, tmp_path_factory) -> Callable[[int], Path]:
    """FMU of a model identified between 1 and 3 mm."""
    folder = tmp_path_factory.mktemp("ranged")

    def get(version: int) -> Path:
        path = folder / f"{version}.fmu"
        model = replace(with_law(), amplitude=Range(1e-3, 3e-3, "m"))
        return path if path.exists() else export_fmu(model, path, version=version, platforms=(own_platform(),))

    return get


def swell(t: float) -> float:
    """A force near the resonance that rises and falls, twice."""
    return 4.0 * float(np.sin(80.0 * t) * np.sin(np.pi * t) ** 2)


def told(caller: Any) -> list[tuple[int, str]]:
    return [(status, "above" if "above" in text else "below") for status, text in caller.messages]


@pytest.mark.parametrize("version", VERSIONS)
def test_outside_the_range_is_told_once_a_run_and_side(ranged, callers, version):
    caller = callers(ranged(version), CO_SIMULATION)
    for _ in range(2):
        swings, flags = run(caller.start(viscous=40.0), 2000, 1e-3, swell, "amplitude", "outside_range").T
        expected = np.where(swings > 1.01 * 3e-3, 1, np.where((swings > 0) & (1.01 * swings < 1e-3), -1, 0))
        assert np.array_equal(flags, expected)
        assert np.count_nonzero(np.diff(flags)) >= 7  # in and out again, twice
        assert sorted(told(caller)) == [(WARNING, "above"), (WARNING, "below")]
        assert all("that the model was identified in" in text for text in caller.texts)
        assert any("0.001 to 0.003 m that" in text for text in caller.texts)
        caller.messages.clear()
        caller.fmu.reset()


@pytest.mark.parametrize("version", VERSIONS)
def test_a_long_step_that_leaves_the_range_and_comes_back_is_told(ranged, callers, version):
    caller = callers(ranged(version), CO_SIMULATION).start(x0=4.5e-3, viscous=20.0)
    caller.fmu.doStep(0.0, 0.1)
    assert caller.get("outside_range") == [0.0]
    assert told(caller) == [(WARNING, "above")]


@pytest.mark.parametrize("version", VERSIONS)
def test_an_importer_that_wants_to_hear_little_is_told_of_too_large_a_motion_alone(ranged, callers, version):
    caller = callers(ranged(version), CO_SIMULATION).start()
    caller.fmu.setDebugLogging(False, ["logStatusWarning"])
    run(caller, 1000, 1e-3, swell, "amplitude")
    assert told(caller) == [(WARNING, "above")]


@pytest.mark.parametrize("version", VERSIONS)
def test_model_exchange_tells_of_it_at_events(ranged, callers, version):
    caller = callers(ranged(version)).start(v0=0.1)
    flags = []
    for x in (2e-3, -2e-3, 4e-3, -4e-3, 5e-4, 0.0):
        turn(caller, x)
        flags += caller.get("outside_range")
    assert flags == [0.0, 0.0, 0.0, 1.0, 0.0, -1.0]
    assert told(caller) == [(WARNING, "above"), (WARNING, "below")]


@pytest.mark.parametrize("version", VERSIONS)
def test_without_a_range_nothing_is_outside(law_fmu, callers, version):
    caller = callers(law_fmu(version), CO_SIMULATION).start()
    rows = run(caller, 500, 1e-3, lambda t: 20 * swell(t), "amplitude", "outside_range")
    assert rows[:, 0].max() > 5e-3
    assert not rows[:, 1].any()
    assert caller.messages == []
