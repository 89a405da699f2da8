"""A model as a MuJoCo model, a URDF robot, or the additional matrices of a HydroDyn platform: text files."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from .. import __version__
from ..errors import BadInput
from ..files.writing import write
from .description import identifier_of
from .joint import Joint, joint_of, left_out
from .render import plain_text, render

if TYPE_CHECKING:
    from ..model import Oscillator

#: A platform's degrees of freedom in the order of HydroDyn's rows, and whether each is a rotation.
DOFS = {"surge": False, "sway": False, "heave": False, "roll": True, "pitch": True, "yaw": True}

#: Time steps a period in MuJoCo.
_STEPS = 200


@dataclass(frozen=True)
class Target:
    """A program: its template, and the terms that it has."""

    program: str
    template: str
    has: frozenset[str]


#: By the suffix of the file.
TARGETS = {
    ".mjcf": Target(
        "MuJoCo",
        "joint.mjcf.j2",
        frozenset({"inertia", "stiffness", "square", "cubic", "damping", "quadratic", "cubic_damping", "friction"}),
    ),
    ".urdf": Target("URDF", "joint.urdf.j2", frozenset({"inertia", "damping", "friction"})),
    ".hydrodyn": Target(
        "HydroDyn", "joint.hydrodyn.j2", frozenset({"inertia", "stiffness", "damping", "quadratic", "load"})
    ),
}
#: By the name that ``--as`` takes.
SUFFIX_OF = {target.program.lower(): suffix for suffix, target in TARGETS.items()}


def export_joint(
    oscillator: Oscillator,
    path: Path,
    suffix: str,
    *,
    dof: str | None = None,
    progress: Callable[[str], None] | None = None,
) -> Path:
    """Write the model for one of TARGETS; what that cannot express stands in the file and goes to ``progress``.

    Args:
        oscillator: the model; its mass known, in m and N or rad and N·m.
        path: where to.
        suffix: of TARGETS.
        dof: of a platform, one of DOFS; HydroDyn needs it, the others take no notice.
        progress: called with a line for each thing left out.

    Raises:
        BadInput: where the model is in other units or without a mass, or ``dof`` is missing or of the other kind.
    """
    target, joint = TARGETS[suffix], joint_of(oscillator)
    row = _row(joint, target, dof, path)
    missing = left_out(joint, _terms(target, joint), target.program)
    period = 2 * math.pi * math.sqrt(joint.inertia / joint.stiffness) if joint.stiffness > 0 else 1.0
    text = render(
        target.template,
        joint=joint,
        title=plain_text(joint.name).replace("--", "- -"),
        identifier=identifier_of(joint.name),
        software=f"dashpot {__version__}",
        missing=[plain_text(sentence).replace("--", "- -") for sentence in missing],
        number=lambda value: repr(float(value)),
        timestep=float(f"{period / _STEPS:.1g}"),
        row=row,
        dof=dof,
        matrices={"AddBLin": joint.damping, "AddBQuad": joint.quadratic},
    )
    write(path, text)
    if progress is not None:
        for sentence in missing:
            progress(f"{path}: {sentence}")
    return path


def _terms(target: Target, joint: Joint) -> frozenset[str]:
    """The terms that the program has for this model: a shifted spring is a constant force only where it is linear."""
    shifted = target.program == "MuJoCo" and joint.stiffness and not (joint.cubic or joint.square)
    return target.has | {"load"} if shifted else target.has


def _row(joint: Joint, target: Target, dof: str | None, path: Path) -> int | None:
    """Place of the degree of freedom; None for a program that has none."""
    if target.program != "HydroDyn":
        return None
    fitting = [name for name, rotates in DOFS.items() if rotates == joint.rotates]
    if dof not in fitting:
        said = "say which motion of the platform the model is of" if dof is None else f"the model is no {dof}"
        known = f"{', '.join(fitting[:-1])} or {fitting[-1]}"
        raise BadInput(f"{path}: {said}; its displacement is in {joint.length_unit}: --dof {known}")
    return list(DOFS).index(dof)
