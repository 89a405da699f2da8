"""Whether a motion goes further than what a model was identified in, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .as_recorded import as_recorded

if TYPE_CHECKING:
    from .element import Element
    from .oscillator import Oscillator, Range

#: How far beyond what was covered a motion is clearly outside, as a factor: the ends of a range are known no better.
CLEARLY = 1.01


def further(model: Oscillator | Element, covered: Range | None, reached: float) -> tuple[str, str] | None:
    """How far a motion goes and how far the model was identified, in the unit as recorded; None where not further.

    ``reached`` is in the unit of ``covered``: an amplitude or a speed.
    """
    if covered is None or not reached > CLEARLY * covered.max:
        return None
    (far, unit), (known, _) = (as_recorded(model, value, covered.unit) for value in (reached, covered.max))
    return f"{far:.3g} {unit}", f"{known:.3g} {unit}"


def element_beyond(element: Element, amplitude: float, speed: float) -> list[str]:
    """Sentences on a motion that goes further from the origin, or faster, than what an element was identified in."""
    said = []
    for what, covered, reached in (
        ("the motion goes to", element.amplitude, amplitude),
        ("the speed goes to", element.speed, speed),
    ):
        if (both := further(element, covered, reached)) is not None:
            said.append(
                f"{what} {both[0]}, and {element.name} was identified up to {both[1]}: beyond that it is an "
                "extrapolation"
            )
    return said
