"""Dry friction that came out below zero: what no rig has says that its model lacks something."""

from __future__ import annotations

from ...model import Oscillator
from ..signals.odds import SIGNIFICANT


def friction_that_pushes(oscillator: Oscillator) -> str | None:
    """A sentence on dry friction below zero by more than its error; None where it may be none, or takes energy.

    A viscous damping below zero is that of a rig that excites itself, and such a preload makes two wells.
    """
    dry = oscillator.dry
    if dry.std is None or not dry.value < -SIGNIFICANT * dry.std:
        return None
    family = "model" if oscillator.terms else "Eq. 17 family"
    return (
        f"its dry friction is below zero, where it would give energy: the {family} lacks something that these "
        "recordings show, and the parameters may be off by more than their errors"
    )
