"""Pictures of the size of a word, for tables (Tufte 2006): a motion with what is left of it, a value over a fleet."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

from .style import GRID, LIGHT, MEASURED, MODEL, ROLES

_WIDTH, _HEIGHT = 120.0, 26.0


def motion_sparkline(sizes: Sequence[float], left: Sequence[float], title: str) -> str:
    """The size of a motion over time, grey, and of what the model leaves of it, orange; both 0 to 1."""
    if not sizes:
        return ""
    bands = _band(sizes, LIGHT) + (_band(left, MODEL) if left else "")
    return _svg(bands, title)


def _band(sizes: Sequence[float], color: str) -> str:
    """The area between plus and minus the sizes."""
    step, middle = _WIDTH / len(sizes), _HEIGHT / 2
    # what is too thin to see is drawn as one
    heights = [max(0.3, min(size, 1.0) * (middle - 1)) for size in sizes]
    upper = [f"{(i + 0.5) * step:.1f},{middle - h:.1f}" for i, h in enumerate(heights)]
    lower = [f"{(i + 0.5) * step:.1f},{middle + h:.1f}" for i, h in reversed(list(enumerate(heights)))]
    return f'<polygon points="{" ".join(upper + lower)}" style="fill:var(--{ROLES[color]})"/>'


def value_sparkline(values: Sequence[float | None], title: str) -> str:
    """A value in each place of a row, as a line of dots; None where there is none."""
    known = [value for value in values if value is not None and math.isfinite(value)]
    if not known:
        return ""
    low, span = min(known), (max(known) - min(known)) or 1.0
    step = _WIDTH / len(values)
    dots = [
        f'<circle cx="{(i + 0.5) * step:.1f}" cy="{_HEIGHT - 3 - (value - low) / span * (_HEIGHT - 6):.1f}" r="1.6"/>'
        for i, value in enumerate(values)
        if value is not None and math.isfinite(value)
    ]
    base = f'<path d="M0 {_HEIGHT - 1}H{_WIDTH}" style="stroke:var(--{ROLES[GRID]})"/>'
    return _svg(f'{base}<g style="fill:var(--{ROLES[MEASURED]})">{"".join(dots)}</g>', title)


def _svg(inner: str, title: str) -> str:
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH:g} {_HEIGHT:g}" width="{_WIDTH:g}" '
        f'height="{_HEIGHT:g}" role="img"><title>{escape(title)}</title>{inner}</svg>'
    )
