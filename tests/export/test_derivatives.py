"""Directional and adjoint derivatives are what differences of the FMU's own values come to, for every law."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from dashpot.model.laws import LIBRARY

CO_SIMULATION = "CoSimulation"
START = 0.3  # s, so that laws in time show
EFFECTS = ["", *LIBRARY]
SOME = ["", "attached-resonator", "hysteresis", "stiffness-drift", "tonal-disturbance"]
STUCK = ["", "asymmetric-friction/dry", "stribeck", "hysteresis", "viscoelastic", "actuator-saturation", "time-delay"]
OUTPUTS = ("x", "displacement", "velocity", "acceleration", "energy", "dissipated_power")
#: Of the largest in the row of an unknown, each derivative times the size of what it is taken by.
CLOSE = 1e-7
#: How far a known variable moves for a difference, in its size.
MOVE = 1e-5
#: Rounding of a value over that.
GRAIN = 1e-10


def laws(effect: str) -> tuple[str, ...]:
    return (effect,) if effect else ()


def knowns_of(caller: Any) -> list[str]:
    """What may move between events; smoothing has no derivative at zero."""
    states = caller.known.states if caller.exchange else ()
    time = ["time"] if caller.exchange and caller.known.version == 3 else []  # FMI 2 has no reference for it here
    return ["F", *time, *states, *(name for name in caller.known.tunable if name != "smoothing")]


def unknowns(caller: Any) -> list[str]:
    rates = [f"der({name})" for name in caller.known.states] if caller.exchange else []
    seen = caller.exchange and caller.known.version == 3  # FMI 2 has no references for event indicators
    return [*OUTPUTS, *rates, *(f"event({i + 1})" for i in range(caller.known.indicators if seen else 0))]


def sizes(caller: Any, knowns: Sequence[str]) -> np.ndarray:
    """Typical size of each known variable."""
    nominal = caller.nominals() if caller.exchange else [0.01, 1.0] + [1.0] * len(caller.known.states[2:])
    known = caller.known
    states = dict(zip(known.states, nominal, strict=True)) | dict(zip(known.starts, nominal, strict=True))
    return np.array([states.get(name) or abs(caller.get(name)[0]) or 0.01 for name in knowns])


def differences(caller: Any, names: list[str], known: str, step: float) -> np.ndarray:
    """Difference of fourth order of the values of ``names`` as ``known`` moves, central but at a bound."""
    (at,) = caller.get(known)
    parts, weights = (-2, -1, 1, 2), [1.0, -8.0, 8.0, -1.0]
    if at in caller.known.bounds.get(known, ()):
        parts, weights = (0, 1, 2, 3, 4), [-25.0, 48.0, -36.0, 16.0, -3.0]
        step = -step if at == caller.known.bounds[known][1] else step
    move = caller.fmu.setTime if known == "time" else lambda value: caller.set(**{known: value})
    values = []
    for part in parts:
        move(at + part * step)
        values.append(caller.get(*names))
    move(at)
    return np.array(weights) @ np.array(values) / (12.0 * step)


def check(caller: Any, knowns: Sequence[str]) -> None:
    """Every derivative against a difference, which has the rounding of the values in it."""
    names, size = unknowns(caller), sizes(caller, knowns)
    rounding = (
        GRAIN * np.maximum(np.abs(caller.get(*names)), [1.0 * (n in ("x", "acceleration")) for n in names])[:, None]
    )
    told = np.array([caller.derivative(names, [name], [1.0]) for name in knowns]).T * size
    numeric = np.array([differences(caller, names, n, MOVE * s) for n, s in zip(knowns, size, strict=True)]).T * size
    largest = np.maximum(np.abs(numeric), np.abs(told)).max(axis=1)[:, None]
    error = np.maximum(np.abs(told - numeric) - rounding, 0.0) / np.where(largest > 0, largest, 1.0)
    i, k = np.unravel_index(np.argmax(error), error.shape)
    assert error[i, k] <= CLOSE, f"{names[i]} by {knowns[k]}: {told[i, k]:.9g} told, {numeric[i, k]:.9g} found"


def place(caller: Any, seed: int, part: float = 1.0, **further: float) -> Any:
    """The FMU at a state that meets no surface but by chance, that part of its motion's size."""
    random = np.random.default_rng(seed)
    starts = caller.known.starts
    nominal = sizes(caller.initialise(at=START), starts) * random.uniform(0.2, 0.7, len(starts))
    caller.fmu.reset()
    state = dict(zip(starts, (part * nominal * random.choice([-1, 1], len(starts))).tolist(), strict=True))
    return caller.start(at=START, F=float(random.uniform(0.2, 0.9)), **{**state, **further})


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect or "base")
def test_every_law(law_fmu, callers, effect):
    caller = callers(law_fmu(3, *laws(effect)))
    for seed in range(3):
        place(caller, seed)
        check(caller, knowns_of(caller))
        caller.fmu.reset()


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect or "base")
def test_every_smooth_law(law_fmu, callers, effect):
    """Far from the surfaces and within the width of the smoothed signs."""
    caller = callers(law_fmu(3, *laws(effect)))
    for seed, part in ((0, 1.0), (1, 0.01), (2, 0.03)):
        place(caller, seed, part, smoothing=0.02)
        check(caller, [*knowns_of(caller), "smoothing"])
        caller.fmu.reset()


@pytest.mark.parametrize("effect", STUCK)
def test_a_mass_that_sticks(law_fmu, callers, effect):
    """What holds it gives way to whatever pushes, so that it stays, until the indicator is used up."""
    caller = callers(law_fmu(3, *laws(effect), dry=6.0))
    place(caller, 0, v0=0.0, x0=1e-4)
    assert caller.rates()[:2] == [0.0, 0.0]
    check(caller, [name for name in knowns_of(caller) if name != "velocity"])  # it has none
    i = next(i for i in range(caller.known.indicators) if caller.derivative([f"event({i + 1})"], ["F"], [1.0]) != [0.0])
    assert caller.indicators()[i] > 0


@pytest.mark.parametrize("start", [{}, {"v0": 0.0, "x0": 1e-4, "dry": 6.0}, {"smoothing": 0.02}])
@pytest.mark.parametrize("effects", [(), ("sensor-lag",), ("sensor-nonlinearity", "attached-resonator")])
@pytest.mark.parametrize("quantity", ["velocity", "acceleration"])
def test_another_response(law_fmu, callers, effects, quantity, start):
    """An accelerometer feels what holds the mass; its lag goes on while the mass is held."""
    caller = place(callers(law_fmu(3, *effects, quantity=quantity)), 1, **start)
    check(caller, [name for name in knowns_of(caller) if not (name == "velocity" and "dry" in start)])


@pytest.mark.parametrize("version", [2, 3])
def test_a_mass_at_rest_on_its_seat(law_fmu, callers, version):
    """There the preload holds it too."""
    caller = callers(law_fmu(version)).start(F=0.3, dry=1.0, preload=1.0)
    assert caller.rates() == [0.0, 0.0]
    check(caller, [name for name in knowns_of(caller) if name not in ("displacement", "velocity")])


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("effect", ["", "viscoelastic", "actuator-saturation"])
def test_a_jump_of_the_force_between_steps(law_fmu, callers, effect, version):
    """A mass that stuck is free at once, and held again when the force goes back."""
    caller = callers(law_fmu(version, *laws(effect)), CO_SIMULATION).start(x0=1e-4, dry=1.0, F=0.1)
    caller.step(0.0, 1e-3, 0.1)
    caller.set(F=0.65)
    assert caller.get("acceleration", "der(velocity)")[0] > 0.1
    for force in (0.65, 0.1, 0.65):
        caller.set(F=force)
        check(caller, knowns_of(caller))
        assert caller.get("acceleration") == pytest.approx(caller.get("der(velocity)"), abs=1e-14)


@pytest.mark.parametrize("effect", SOME)
def test_fmi2_gives_what_fmi3_does(law_fmu, callers, effect):
    second, third = (place(callers(law_fmu(version, *laws(effect))), 1) for version in (2, 3))
    knowns = knowns_of(second)
    check(second, knowns)
    names = unknowns(second)
    seed = np.linspace(0.5, 1.5, len(knowns)) * sizes(second, knowns)
    assert second.derivative(names, knowns, seed) == third.derivative(names, knowns, seed)


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("effect", SOME)
def test_co_simulation(law_fmu, callers, effect, version):
    """Between steps the force and the parameters may move; at a turning point too, where a mass sticks."""
    caller = place(callers(law_fmu(version, *laws(effect)), CO_SIMULATION), 2)
    check(caller, knowns_of(caller))
    for k in range(30):
        caller.step(START + k * 1e-3, 1e-3, 0.5)
    check(caller, knowns_of(caller))


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("interface", [CO_SIMULATION, "ModelExchange"])
@pytest.mark.parametrize("effect", SOME)
def test_start_values_while_initialising(law_fmu, callers, effect, interface, version):
    """What rides along starts with what it rides on."""
    caller = callers(law_fmu(version, *laws(effect)), interface).initialise(at=START)
    starts = caller.known.starts
    caller.set(**dict(zip(starts, (0.4 * sizes(caller, starts)).tolist(), strict=True)), F=0.3)
    check(caller, ["F", *starts, *(name for name in caller.known.tunable if name != "smoothing")])


@pytest.mark.parametrize("interface", [CO_SIMULATION, "ModelExchange"])
@pytest.mark.parametrize("effect", SOME)
def test_adjoint_is_the_transpose(law_fmu, callers, effect, interface):
    caller = place(callers(law_fmu(3, *laws(effect)), interface), 1)
    names, knowns = unknowns(caller), knowns_of(caller)
    matrix = np.array([caller.derivative(names, [name], [1.0]) for name in knowns])
    seed = np.linspace(-1.0, 1.0, len(names))
    expected = matrix @ seed
    assert np.allclose(caller.adjoint(names, knowns, seed), expected, rtol=1e-12, atol=1e-12 * np.abs(matrix).max())


@pytest.mark.parametrize("version", [2, 3])
def test_a_direction_is_the_sum_of_its_parts(law_fmu, callers, version):
    caller = place(callers(law_fmu(version)), 1)
    names, knowns = unknowns(caller), ["F", "displacement", "velocity", "mass"]
    seed = [2.0, -1e-3, 0.5, 0.1]
    parts = [caller.derivative(names, [name], [s]) for name, s in zip(knowns, seed, strict=True)]
    assert np.allclose(caller.derivative(names, knowns, seed), np.sum(parts, axis=0), rtol=1e-13, atol=0)
    assert caller.derivative([], knowns, seed) == []
    assert caller.derivative(names, [], []) == [0.0] * len(names)


@pytest.mark.parametrize("version", [2, 3])
def test_what_is_known_and_what_is_not(law_fmu, callers, version):
    from fmpy.fmi1 import FMICallException

    caller = place(callers(law_fmu(version)), 1)
    for unknown, known, seed, words in (
        ("x", "acceleration", 1.0, "is not known now"),
        ("x", "x0", 1.0, "is not known now"),
        ("mass", "F", 1.0, "is not unknown"),
        ("x", "F", float("nan"), "not a finite number"),
    ):
        with pytest.raises(FMICallException):
            caller.derivative([unknown], [known], [seed])
        assert words in caller.texts[-1]


@pytest.mark.parametrize("version", [2, 3])
def test_the_first_call_while_initialising_knows_the_time(law_fmu, callers, version):
    """A spring that drifts is another one at a late start."""
    fmu, late = law_fmu(version, "stiffness-drift"), 40.0
    first = callers(fmu).initialise(at=late, x0=1e-3).derivative(["acceleration"], ["x0"], [1.0])
    rates = callers(fmu).initialise(at=late, x0=1e-3).rates()
    running = callers(fmu).start(at=late, x0=1e-3)
    assert first == running.derivative(["acceleration"], ["displacement"], [1.0])
    assert rates == running.rates()
    early = callers(fmu).start(x0=1e-3)
    assert first != early.derivative(["acceleration"], ["displacement"], [1.0])
