"""What an FMU of either back-end holds beside its binary: its model file, icon, terminal, and a reference result."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ..model.file import dumps
from .description import Description
from .facts import Facts
from .reference import reference_result
from .render import plain_text
from .terminals import terminals_and_icons

if TYPE_CHECKING:
    from ..model import Oscillator

#: Longest name that a model file takes.
_LONGEST_NAME = 255


def further_contents(facts: Facts, description: Description, version: int = 2) -> dict[str, bytes]:
    """Model file, reference result, icon and terminal by their names in the archive of an FMU of that version of FMI.

    Raises BadInput where the model has no motion to integrate.
    """
    own = model_file(facts.oscillator) | terminals_and_icons(description, version)
    return own | reference_result(facts, description)


def model_file(oscillator: Oscillator) -> dict[str, bytes]:
    """``resources/model.yaml``: the text of the model file, from which ``dashpot`` makes the same model again.

    A name that no model file can have (none, or one without end) is mended, so that the file loads.
    """
    name = plain_text(oscillator.name)[:_LONGEST_NAME].strip() or "oscillator"
    return {"resources/model.yaml": dumps(replace(oscillator, name=name)).encode()}
