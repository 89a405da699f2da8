"""The laws that were learnt before there were curves: what they do, and that nothing turns over beyond."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from dashpot.model.law import Motion
from dashpot.model.laws import EARLIER
from dashpot.model.library import find

LEARNT = list(EARLIER.values())


def force_of(name: str, **values: float) -> ca.Function:
    law = find(name)
    x, v = ca.SX.sym("x"), ca.SX.sym("v")
    numbers = {p.name: values.get(p.name, 0.0 if p.strength else 2.0) for p in law.parameters}
    assert law.force is not None
    return ca.Function("force", [x, v], [law.force(Motion(x, v, ca.SX.sym("t")), numbers)])


def test_each_is_an_effect_of_its_own_that_begins_at_nothing():
    assert [law.effect for law in LEARNT] == ["free/spring", "free/damping"]
    for law in LEARNT:
        assert float(force_of(law.name)(0.3, -0.7)) == 0.0
        assert all(p.strength or p.scale for p in law.parameters)


@pytest.mark.parametrize(("name", "place"), [("near", 0.1), ("middle", 0.5), ("far", 2.5)])
def test_stiffness_and_damping_set_in_at_their_places(name, place):
    """Half of it at the place itself, the square of the motion far within, all of it far beyond."""
    spring, damping = force_of("free/spring", **{name: 3.0}), force_of("free/damping", **{name: 3.0})
    x = 2.0 * place  # the reach is 2
    assert float(spring(x, 0.0)) / x == pytest.approx(1.5)
    assert float(damping(x, 1e-9)) / 1e-9 == pytest.approx(1.5)
    assert float(damping(0.0, x)) / x == pytest.approx(1.5)
    assert float(spring(1e-3 * x, 0.0)) / (1e-3 * x) == pytest.approx(3e-6, rel=1e-5)
    assert float(spring(1e3 * x, 0.0)) / (1e3 * x) == pytest.approx(3.0, rel=1e-5)


def test_one_side_is_stiffer_by_what_the_other_is_softer():
    spring = force_of("free/spring", **{"side-near": 3.0})
    assert float(spring(20.0, 0.0)) / 20.0 == pytest.approx(3.0, rel=1e-3)
    assert float(spring(-20.0, 0.0)) / -20.0 == pytest.approx(-3.0, rel=1e-3)


def test_the_damping_follows_the_amplitude_of_a_swing():
    """Along a harmonic motion displacement and speed make one size at every instant."""
    values = {"near": 0.3, "far": 2.0, "reach": 2.0, "speed": 2.0 * 5.0}
    damping, phase = force_of("free/damping", **values), np.linspace(0.1, 6.1, 40)
    x, v = 0.8 * np.cos(phase), -0.8 * 5.0 * np.sin(phase)
    ratio = np.array([float(damping(*pair)) for pair in zip(x, v, strict=True)]) / v
    size = 0.4**2
    assert ratio == pytest.approx(0.3 * size / (size + 0.01) + 2.0 * size / (size + 6.25))


def test_what_the_spring_stores_is_the_work_done_on_it():
    law = find("free/spring")
    rng = np.random.default_rng(3)
    values = {p.name: float(rng.uniform(-2, 2)) if p.strength else 1.3 for p in law.parameters}
    x, v = ca.SX.sym("x"), ca.SX.sym("v")
    motion = Motion(x, v, ca.SX.sym("t"))
    assert law.force is not None
    assert law.stored is not None
    gap = ca.Function("gap", [x], [ca.gradient(law.stored(motion, values), x) - law.force(motion, values)])
    assert max(abs(float(gap(place))) for place in (-3.0, -0.2, 0.01, 0.5, 4.0)) < 1e-12
