"""What an FMU of either back-end says about itself: its GUID and its documentation page."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

from .description import Description
from .render import plain_text, render

if TYPE_CHECKING:
    from ..model import Oscillator


def guid_of(texts: list[str]) -> str:
    """A GUID that is the same for the same texts."""
    digest = hashlib.sha256("\0".join(texts).encode()).hexdigest()
    return f"{{{digest[:8]}-{digest[8:12]}-{digest[12:16]}-{digest[16:20]}-{digest[20:32]}}}"


def documentation(oscillator: Oscillator, description: Description, hold: str) -> str:
    """The FMU's documentation/index.html: equation, parameters with their errors, validity, variables."""
    ranges = {"amplitude": oscillator.amplitude, "frequency": oscillator.frequency}
    return render(
        "fmu_documentation.html.j2",
        description=description,
        massless=oscillator.mass is None,
        hold=hold,
        parameters=oscillator.parameters(),
        descriptions={name: plain_text(text) for name, text in oscillator.descriptions().items()},
        ranges={name: covered for name, covered in ranges.items() if covered is not None},
    )
