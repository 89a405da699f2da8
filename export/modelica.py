"""An oscillator as one Modelica model: ``OUT.mo``, of Modelica 3.4 and without a library.

Signs are relations, whose changes a tool locates. Friction is a state machine as in Modelica's own components (Otter,
Elmqvist, Mattsson 1999): forward, backward, or at rest, where it holds the mass as long as the other forces stay
within it. A preloaded spring can hold the mass on its seat as well; bounces on it that grow ever shorter end there,
by the rule of the engine (docs/engine.md).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import BadInput
from ..files.writing import write
from ..model.equations import SurfaceKind
from ..model.law import Expression
from ..simulate.casadi_step import REST
from .assignments import assignments
from .facts import Facts
from .languages import MODELICA
from .program import Program, filled, named_after_file, program


@dataclass(frozen=True)
class Sign:
    """One switching surface as the model has it: the name of its sign, what it is the sign of, and which kind it is."""

    name: str
    text: str
    surface: str
    friction: bool = False
    seat: bool = False


def export_modelica(facts: Facts, path: Path) -> Path:
    """Write the file; the same model gives the same bytes.

    Raises BadInput where the file's name is none that a model can have, and see ``program``.
    """
    name = named_after_file(path, "Modelica")
    write(path, modelica_model(program(facts), name))
    return path


def modelica_model(of: Program, name: str) -> str:
    """Text of the file, whose model is called ``name``.

    Raises BadInput where friction acts on more than the velocity of the mass, which the equations do not have.
    """
    import casadi as ca

    eq = of.eq
    kinds = list(eq.kinds)
    moving = [i for i, kind in enumerate(kinds) if kind is SurfaceKind.VELOCITY]
    if len(moving) > 1:
        raise BadInput(f"{of.name}: two frictions of one velocity cannot be written in Modelica; write them as one law")
    seats = [i for i, kind in enumerate(kinds) if kind is SurfaceKind.POSITION and ca.is_equal(eq.surfaces[i], eq.z[0])]
    holding = _holding(eq, moving, seats)
    function = ca.Function(
        "model",
        [eq.z, eq.u, eq.p, eq.t, eq.s],
        [ca.densify(part) for part in (eq.zdot, eq.y[0], eq.surfaces, *holding)],
    )
    names = [f"s{i + 1}" for i in range(len(kinds))]
    inputs = [*of.inputs[:3], ["time"], names]
    lines, (rates, (shown,), surfaces, *forces) = assignments(function, inputs, MODELICA)
    signs = [
        Sign(name, surface.text.replace('"', "'"), text, i in moving, i in seats)
        for i, (name, surface, text) in enumerate(zip(names, of.surfaces, surfaces, strict=True))
    ]
    return filled(
        "rig.mo.j2",
        of=of,
        name=name,
        lines=lines,
        auxiliary=[line.partition(" = ")[0] for line in lines],
        rates=rates,
        shown=shown,
        signs=signs,
        friction=bool(moving),
        seat=bool(seats),
        **dict(zip(("push", "hold", "push_on_seat", "step"), (text for (text,) in forces), strict=True)),
        shortest=repr(REST * of.longest / 2),
        experiment=of.description.experiment,
        repr=repr,
        text=lambda words: words.replace("\\", "/").replace('"', "'"),
    )


def _holding(eq: Any, moving: list[int], seats: list[int]) -> tuple[Expression, Expression, Expression, Expression]:
    """What decides at rest, in the unit of the acceleration.

    The acceleration without friction, and how much of it friction can hold; the same on the seat, and how much more
    the step of the force there can hold.
    """
    import casadi as ca

    def at(expression: Expression, *zeros: Expression) -> Expression:
        places = ca.vertcat(*zeros)
        return ca.substitute(expression, places, ca.SX.zeros(places.shape))

    acceleration = at(eq.zdot[1], eq.z[1])
    friction, seat = [eq.s[i] for i in moving], [eq.s[i] for i in seats]
    push = at(acceleration, *friction) if friction else acceleration
    hold = at(-ca.jacobian(acceleration, friction[0]), *friction) if friction else ca.SX(0)
    on_seat = at(push, eq.z[0], *seat) if seat else push
    step = ca.fmax(at(-ca.jacobian(push, seat[0]), eq.z[0], *seat), 0) if seat else ca.SX(0)
    return push, hold, on_seat, step
