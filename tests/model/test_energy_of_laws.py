"""What each law stores and dissipates, against closed forms; the units; and what a law may say of it."""

from __future__ import annotations

from dataclasses import replace

import casadi
import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.model import Oscillator, Response, oscillator_with, units
from dashpot.model.equations import equations, signed
from dashpot.model.law import Law, LawParameter
from dashpot.model.law_trial import problems
from dashpot.model.library import KNOWN

PLAIN = {"omega0": 0.0, "cubic": 0.0, "preload": 0.0, "viscous": 0.0, "dry": 0.0}
X = np.linspace(-6e-3, 6e-3, 24)  # on none of the corners


def beyond(depth):
    return np.maximum(depth, 0.0)


def energy_of(values, x, v=0.0, effects=()):
    """Energy and dissipated power at displacements (N,) and a velocity, of what is named and nothing else."""
    eq = equations(model := oscillator_with({"mass": 0.27, **PLAIN, **values}, effects=effects))
    plain = casadi.substitute(signed(eq, casadi.vertcat(eq.energy, eq.dissipated)), eq.p, list(model.values().values()))
    z = np.stack([x, np.full_like(x, v)])
    return np.array(casadi.Function("f", [eq.z, eq.t, eq.u], [plain])(z, 0.0, 0.0))


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"omega0": 80.0}, 80.0**2 * X**2 / 2),
        ({"cubic": 4.6e5}, 4.6e5 * X**4 / 4),
        ({"preload": 0.07}, 0.07 * np.abs(X)),
        ({"quadratic-stiffness.coefficient": 3e4}, 1e4 * X**3),
        ({"quintic-stiffness.coefficient": 6e9}, 1e9 * X**6),
        ({"constant-force.load": 9.81}, -9.81 * X),
        ({"clearance.stiffness": 3e3, "clearance.gap": 2e-3}, 1.5e3 * beyond(np.abs(X) - 2e-3) ** 2),
        (
            {"one-sided-stop.stiffness": 3e4, "one-sided-stop.position": -2e-3, "one-sided-stop.damping": 9.0},
            1.5e4 * beyond(-X - 2e-3) ** 2,
        ),
        (
            {
                "two-sided-stop.stiffness": 3e4,
                "two-sided-stop.position": 2e-3,
                "two-sided-stop.damping": 9.0,
                "two-sided-stop.offset": 1e-3,
            },
            1.5e4 * (beyond(X - 3e-3) ** 2 + beyond(-X - 1e-3) ** 2),
        ),
        (
            {"softening-stiffness.stiffness": 2e3, "softening-stiffness.width": 2e-3},
            2e3 * 2e-3**2 * np.log(np.cosh(X / 2e-3)),
        ),
        (
            {"softening-stiffness/sine.stiffness": 2e3, "softening-stiffness/sine.width": 2e-3},
            2e3 * 2e-3**2 * (1 - np.cos(X / 2e-3)),
        ),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_springs_store_the_integral_of_their_force(values, expected):
    effects = tuple(dict.fromkeys(name.rpartition(".")[0] for name in values if "." in name))
    energy, _ = energy_of(values, X, 0.3, effects)
    assert energy == pytest.approx(0.27 * (0.3**2 / 2 + expected), rel=1e-12)
    assert energy_of(values, X, 0.0, effects)[0] == pytest.approx(0.27 * expected, rel=1e-9, abs=1e-16)


def test_a_spring_that_gives_way_stores_exactly_far_out_and_close_in():
    width, stiffness = 1e-6, 2e3
    values = {"softening-stiffness.stiffness": stiffness, "softening-stiffness.width": width}
    far, _ = energy_of(values, X, effects=("softening-stiffness",))
    assert far == pytest.approx(0.27 * stiffness * width * (np.abs(X) - width * np.log(2.0)), rel=1e-12)
    for effect in ("softening-stiffness", "softening-stiffness/sine"):
        near = energy_of({f"{effect}.stiffness": stiffness, f"{effect}.width": 1e3}, X, effects=(effect,))[0]
        assert near == pytest.approx(0.27 * stiffness * X**2 / 2, rel=1e-9)


def test_friction_takes_force_times_speed():
    for v in (0.3, -0.3):
        assert energy_of({"viscous": 5.0}, X, v)[1] == pytest.approx(0.27 * 5.0 * v**2)
        assert energy_of({"dry": 0.4}, X, v)[1] == pytest.approx(0.27 * 0.4 * abs(v))


def test_a_stop_takes_in_its_damper_and_what_is_left_in_a_spring_that_is_not_followed():
    stop = {"stiffness": 3e4, "position": 2e-3, "damping": 90.0}
    values = {f"one-sided-stop.{name}": value for name, value in stop.items()}
    depth = beyond(X - 2e-3)
    for v in (0.5, -0.05, -2.0):
        pushes = 3e4 * depth + 90.0 * v > 0.0
        expected = np.where(depth > 0.0, np.where(pushes, 90.0 * v**2, -3e4 * depth * v), 0.0)
        _, dissipated = energy_of(values, X, v, ("one-sided-stop",))
        assert dissipated == pytest.approx(0.27 * expected, rel=1e-12, abs=1e-14)
    assert not np.any(pushes & (depth > 0.0))  # the last velocity was one that the contact cannot follow


@pytest.mark.parametrize(
    ("effect", "changed", "energy", "power"),
    [
        (
            "viscoelastic",
            {},
            lambda p, x, v, q: p["stiffness"] * (x - q[0]) ** 2 / 2,
            lambda p, x, v, q: p["stiffness"] * p["rate"] * (x - q[0]) ** 2,
        ),
        (
            "attached-resonator",
            {},
            lambda p, x, v, q: p["mass-ratio"] * (q[1] ** 2 + p["frequency"] ** 2 * (x - q[0]) ** 2) / 2,
            lambda p, x, v, q: p["mass-ratio"] * p["damping"] * (v - q[1]) ** 2,
        ),
        (
            "hysteresis",
            {"hysteresis.exponent": 1.0, "hysteresis.loading": 1.0},  # Dahl: it slides both ways
            lambda p, x, v, q: p["stiffness"] * q[0] ** 2 / 2,
            lambda p, x, v, q: p["stiffness"] * q[0] ** 2 * np.abs(v) / p["limit"],
        ),
        (
            "hysteresis",
            {"hysteresis.exponent": 2.0, "hysteresis.loading": 0.5},  # Bouc and Wen: it unloads as a spring
            lambda p, x, v, q: p["stiffness"] * q[0] ** 2 / 2,
            lambda p, x, v, q: p["stiffness"] * (q[0] / p["limit"]) ** 2 * beyond(q[0] * v),
        ),
    ],
    ids=["viscoelastic", "attached-resonator", "dahl", "bouc-wen"],
)
def test_laws_with_a_memory_store_in_their_springs(effect, changed, energy, power, with_law, at_random, share):
    model = with_law(effect, **changed)
    here, (stored, dissipated, size) = at_random(model), share(model)
    p = {name.rpartition(".")[2]: value for name, value in model.values().items() if "." in name}
    x, v, *q = here.z
    assert stored == pytest.approx(0.27 * energy(p, x, v, q), rel=1e-9, abs=1e-14)
    assert dissipated == pytest.approx(0.27 * power(p, x, v, q), rel=1e-9, abs=1e-12 * size)


# Units, and what a law may say ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("response", "force", "mass", "expected"),
    [
        (Response("displacement", "m"), "N", 0.3, ("J", "W")),
        (Response("acceleration", "m/s2"), "N", 0.3, ("J", "W")),
        (Response("displacement", "rad"), "N.m", 0.3, ("J", "W")),
        (Response("displacement", "mm"), "N", 0.3, ("N.mm", "N.mm/s")),
        (Response("displacement", "m"), "V", 0.3, ("V.m", "V.m/s")),
        (Response("displacement", "m"), "N", None, ("m2/s2", "m2/s3")),
        (Response("velocity", "rad/s"), "N.m", None, ("rad2/s2", "rad2/s3")),
    ],
)
def test_units_of_energy_and_power(response, force, mass, expected):
    model = Oscillator.from_values({"mass": mass, **PLAIN}, response=response, force_unit=force)
    assert model.energy_units == expected


def test_a_moment_stays_a_moment():
    assert units.compose("Q", "rad", "N.m") == "N.m"
    assert units.compose("Q.s", "rad", "N.m") == "N.m.s"


def half(motion, p):
    return p["stiffness"] * motion.x**2 / 2


def a_law(**changed):
    parameters = (LawParameter("stiffness", "1/s2", "stiffness", strength=True),)
    words = {"equation": "{stiffness} x", "sentence": "A spring.", "source": "test"}
    made = {"force": lambda motion, p: p["stiffness"] * motion.x, "stored": half, **words, **changed}
    return Law(name="spring", path="restoring", parameters=parameters, **made)


def test_a_law_may_leave_out_what_it_stores(monkeypatch, at_random):
    for stored in (half, None):
        monkeypatch.setitem(KNOWN, "spring", a_law(stored=stored))
        model = oscillator_with({"mass": 0.27, **PLAIN, "spring.stiffness": 4e3}, effects=("spring",))
        at = at_random(model)
        x, v = at.z
        kinetic, power = 0.27 * v**2 / 2, 0.27 * 4e3 * x * v
        assert at(at.eq.energy) == pytest.approx(kinetic + (0.27 * 2e3 * x**2 if stored else 0.0))
        assert at(at.eq.dissipated) == pytest.approx(0.0 if stored else power, abs=1e-12)


def two_states(motion, p):
    q = motion.state("q", "X")
    motion.rate(q, motion.v - q)
    return p["stiffness"] * q


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"stored": lambda motion, p: motion.x * motion.sign(motion.x - 1e-3)}, "a sign or state that its force does"),
        ({"stored": lambda motion, p: motion.state("q", "X") ** 2}, "a sign or state that its force does not have"),
        ({"stored": lambda motion, p: motion.inner("q") ** 2}, "looks for a state 'q'; ask for it in force"),
    ],
)
def test_what_is_stored_adds_nothing_to_the_motion(changed, said, monkeypatch):
    monkeypatch.setitem(KNOWN, "spring", a_law(**changed))
    model = oscillator_with({"mass": 0.27, **PLAIN, "spring.stiffness": 4e3}, effects=("spring",))
    with pytest.raises(BadInput, match=said):
        equations(model)


def test_a_law_finds_its_own_states_among_others_of_the_same_name(monkeypatch):
    mine = a_law(force=two_states, stored=lambda motion, p: p["stiffness"] * motion.inner("q") ** 2 / 2)
    for name in ("spring", "second"):
        monkeypatch.setitem(KNOWN, name, replace(mine, name=name))
    values = {"mass": 2.0, **PLAIN, "spring.stiffness": 10.0, "second.stiffness": 1000.0}
    eq = equations(model := oscillator_with(values, effects=("second", "spring")))
    assert eq.state_names[2:] == ("second.q", "spring.q")
    energy = casadi.substitute(signed(eq, eq.energy), eq.p, list(model.values().values()))
    value = casadi.Function("f", [eq.z], [energy])([0.0, 0.0, 3.0, 5.0])
    assert float(value) == pytest.approx(1000.0 * 3.0**2 + 10.0 * 5.0**2)


def test_only_a_force_stores():
    law = a_law(force=None, drive=lambda motion, p, force: force)
    assert "stored is the energy of a force, which it has none of; leave it out" in list(problems(law))
