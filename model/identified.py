"""What an identification gives, and its file: an oscillator, or a force law by itself."""

from __future__ import annotations

from pathlib import Path
from typing import TypeAlias

from .element import Element
from .element_file import is_element, load_element
from .file import load, text_at
from .oscillator import Oscillator

Identified: TypeAlias = Oscillator | Element


def load_identified(path: Path) -> Identified:
    """Whichever of the two a file holds; raises BadInput where it cannot be read or is neither."""
    return load_element(path) if is_element(text_at(path)) else load(path)
