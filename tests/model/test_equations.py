"""One value of the equations for one structure, and another for any other."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.model.equations import Structure, equations, equations_of, structure_of
from dashpot.model.library import find


def test_oscillators_of_one_structure_share_their_equations(with_law):
    assert equations(with_law("quadratic-drag")) is equations(with_law("quadratic-drag", dry=0.3))


@pytest.mark.parametrize(
    "changed",
    [{"effects": ()}, {"effects": ("cubic-damping",)}, {"quantity": "velocity"}, {"mass": None}],
    ids=str,
)
def test_what_the_equations_follow_from_tells_structures_apart(with_law, changed):
    effects = changed.get("effects", ("quadratic-drag",))
    model = with_law(*effects, quantity=changed.get("quantity", "displacement"))
    model = replace(model, mass=None) if "mass" in changed else model
    assert structure_of(model) != structure_of(with_law("quadratic-drag"))
    assert equations(model) is not equations(with_law("quadratic-drag"))


def test_a_law_read_again_from_a_changed_file_is_another_one(with_law):
    drag = find("quadratic-drag")
    changed = replace(drag, force=lambda motion, p: p["coefficient"] * motion.v**3)
    first = structure_of(with_law("quadratic-drag"))
    second = Structure(first.parameters, (changed,), first.recorded)
    assert str(equations_of(first).zdot) != str(equations_of(second).zdot)
    assert "sq" in str(equations_of(second).zdot) or "pow" in str(equations_of(second).zdot)


def heavier(law, with_law, *, payload: bool = False):
    """Equations of the stand with a force of that form, and its acceleration at one point."""
    plain = structure_of(with_law("quadratic-drag"), payload=payload)
    eq = equations_of(Structure(plain.parameters, (law,), plain.recorded, payload))
    values = [*with_law("quadratic-drag").values().values(), *([0.2] if payload else [])]
    made = ca.Function("a", [eq.z, eq.u, eq.t, eq.s, eq.p], [eq.zdot[1]])
    return float(made([2e-3, 0.1], 1.5, 0.0, np.ones(eq.s.numel()), values))


@pytest.mark.parametrize("payload", [False, True])
def test_a_force_in_proportion_to_the_acceleration_is_a_mass(with_law, payload):
    """With 0.4 of the mass more the same force makes so much less acceleration, whatever rides along."""
    drag = find("quadratic-drag")
    nothing = heavier(replace(drag, force=lambda motion, p: 0.0 * motion.v), with_law, payload=payload)
    more = heavier(replace(drag, force=lambda motion, p: 0.4 * motion.a), with_law, payload=payload)
    mass = with_law("quadratic-drag").mass.value
    whole = mass + (0.2 if payload else 0.0)
    assert more == pytest.approx(nothing * whole / (whole + 0.4 * mass), rel=1e-12)


def test_a_force_that_is_not_in_proportion_to_the_acceleration_is_refused(with_law):
    law = replace(find("quadratic-drag"), force=lambda motion, p: p["coefficient"] * motion.a**2)
    with pytest.raises(BadInput, match=r"not in proportion to motion\.a; write motion\.a times"):
        heavier(law, with_law)
