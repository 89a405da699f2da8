"""What a caller means by a model where a force law by itself will do too."""

from __future__ import annotations

from pathlib import Path

from ..files.arguments import path_of
from ..model.element import Element
from ..model.identified import Identified, load_identified
from .element import ForceElement
from .model import Model, oscillator_of


def identified_of(model: Model | ForceElement | Identified | str | Path) -> Identified:
    """The oscillator or force law: that of an object, one itself, or that of a file; raises BadInput for others."""
    if isinstance(model, ForceElement):
        return model.element
    if isinstance(model, Element):
        return model
    if isinstance(model, str | Path):
        return load_identified(Path(path_of(model, "a model file")))
    return oscillator_of(model)
