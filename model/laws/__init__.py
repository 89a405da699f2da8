"""The library of force laws: one law a file, found by its name."""

from __future__ import annotations

import difflib

from ...errors import BadInput
from ..law import Law
from . import (
    cubic_damping,
    cubic_stiffness,
    dry_friction,
    linear_stiffness,
    preload,
    quadratic_drag,
    quadratic_stiffness,
    quintic_stiffness,
    viscous_damping,
)

#: The Eq. 17 family, in the order of the model file.
BASE: tuple[Law, ...] = (
    linear_stiffness.LAW,
    cubic_stiffness.LAW,
    preload.LAW,
    viscous_damping.LAW,
    dry_friction.LAW,
)

#: Further physics that `terms` of the model file may name.
LIBRARY: dict[str, Law] = {
    law.LAW.name: law.LAW for law in (quadratic_stiffness, quintic_stiffness, quadratic_drag, cubic_damping)
}


def find(effect: str) -> Law:
    """The law of that name; raises BadInput with the closest known names."""
    if effect in LIBRARY:
        return LIBRARY[effect]
    close = difflib.get_close_matches(effect, LIBRARY, n=3, cutoff=0.4)
    known = f"did you mean {', '.join(close)}?" if close else f"known: {', '.join(sorted(LIBRARY)) or 'none yet'}"
    raise BadInput(f"effect {effect!r} is not in the library of force laws; {known}")
