"""Whether a motion looks imposed, though nobody said so: a test machine's recording taken for a driven rig's.

One equation is read in two directions. A force that drives a rig is what mass, spring and damper take between them,
each many times the force near resonance, and the motion that comes of it is what an oscillator foretells. A machine
imposes a motion on a specimen whose own mass takes a small part of the force or none. So it is said where all of this
holds:

- as an oscillator the recordings leave more than their noise;
- along the motion the members of Eq. 17 leave decisively less of every force than the oscillator does of the motion;
- inertia takes less than the whole force there, and a mass whose inertia did would leave decisively more of it.

A sine of one frequency does not tell a mass from a spring. There, as wherever mass or frequency may be none, a
condition is stated in place of a finding: nothing in the recordings says that there is an oscillator at all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput
from ..identify.identification import Identification
from ..identify.signals.odds import SIGNIFICANT
from ..model.element import INERTIA
from ..model.fit_state import LACKING
from ..model.parameter import Parameter
from ..recording.fact import changed
from ..recording.recording import Recording
from .columns import of_members
from .fit import FITTED, basis_of
from .motion import Imposed, imposed, origin_of


@dataclass(frozen=True)
class Along:
    """What the members of Eq. 17 make of the forces along the recorded motions, as parts of their standard deviations.

    Attributes:
        left: the largest that is left.
        inertia: the largest that inertia takes.
        heavy: what is left where inertia has to take the whole force, of the recording where that is least.
    """

    left: float
    inertia: float
    heavy: float


def looks_imposed(found: Identification) -> str | None:
    """A sentence where the motion of an identification's recordings looks imposed, or may well be; else None."""
    left = max((part.nrmse for part in found.fit.segments), default=0.0)
    noise = all(part.over_noise <= LACKING for part in found.fit.segments)
    if noise or found.oscillator.terms:
        return None
    along = along_motions(found.recordings)
    if along is None:
        return None
    takes, how = f"inertia takes {100 * along.inertia:.2g} %", "--prescribed with the column of the motion"
    if told(along, left):
        return (
            f"the motion looks imposed, as a test machine does: as an oscillator {100 * left:.2g} % of it is left; "
            f"along it, springs, dampers and friction leave {100 * along.left:.2g} % of the force, and {takes}; {how} "
            "finds the force law by itself"
        )
    untold = [name for name in ("mass", "omega0") if _is_untold(found.oscillator.parameters().get(name))]
    if untold and along.inertia < 1.0:
        return (
            f"nothing tells an oscillator: {' and '.join(untold)} may be none, and along the motion {takes} of the "
            f"force; where a test machine imposed the motion, {how} finds the force law by itself"
        )
    return None


def _is_untold(parameter: Parameter | None) -> bool:
    return parameter is not None and parameter.std is not None and parameter.value < SIGNIFICANT * parameter.std


def told(along: Along, left: float) -> bool:
    """Whether recordings of which an oscillator leaves that part of the motion tell that it was imposed."""
    return LACKING * along.left < left and along.inertia < 1.0 and LACKING * along.left < along.heavy


def along_motions(recordings: Sequence[Recording]) -> Along | None:
    """What is left along the motions; None where they are not such that a machine may have imposed them."""
    if any(r.force is None or r.base or r.quantity == "acceleration" for r in recordings):
        return None
    try:
        motions = [imposed(changed(recording, prescribed=True)) for recording in recordings]
    except BadInput:
        return None
    origin = origin_of(motions)
    columns = [_columns(motion, origin) for motion in motions]
    forces = [motion.force[motion.told] - float(np.mean(motion.force[motion.told])) for motion in motions]
    sizes = [float(np.std(force)) for force in forces]
    whole = np.concatenate([c / s for c, s in zip(columns, sizes, strict=True)], axis=1)
    wanted = np.concatenate([f / s for f, s in zip(forces, sizes, strict=True)])
    parts = np.cumsum([force.size for force in forces])[:-1]
    inertia, others = whole[0], basis_of(whole[1:])
    beside = inertia - others @ (inertia @ others)
    rest = wanted - others @ (wanted @ others)
    mass = max(float(beside @ rest) / max(float(beside @ beside), np.finfo(float).tiny), 0.0)
    taken = [float(np.std(part)) for part in np.split(inertia, parts)]
    return Along(
        max(_rms(np.split(rest - mass * beside, parts))),
        mass * max(taken),
        min(_rms(np.split(rest - beside / max(taken), parts))),
    )


def _columns(motion: Imposed, origin: float) -> np.ndarray:
    """(members, told) of every member, less their means; inertia first."""
    assert FITTED[0] == INERTIA
    rows = of_members(motion, FITTED, origin)[:, motion.told]
    return rows - np.mean(rows, axis=1, keepdims=True)


def _rms(parts: Sequence[np.ndarray]) -> list[float]:
    return [float(np.sqrt(np.mean(part**2))) for part in parts]
