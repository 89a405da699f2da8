"""One value of the equations for one structure, and another for any other."""

from __future__ import annotations

from dataclasses import replace

import pytest
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
