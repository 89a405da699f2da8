"""What a row of a batch shows of its result: its numbers, the size of its motion, and its page or why there is none."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import BadInput
from ..files.exit_codes import sentence
from ..fleet.outcome import CURVE

if TYPE_CHECKING:
    from ..model import Oscillator
    from ..model.element import Element

#: Parts of a picture of the motion.
_PARTS = 60
#: Points of a curve over the amplitude, and from which part of the largest on.
_POINTS, _DECADES = 24, 100.0


def page_or_why(wanted: bool, make: Callable[[], str]) -> tuple[str | None, list[str]]:
    """A page, and what is to be said where there is none: a model is worth more than its picture."""
    if not wanted:
        return None, []
    try:
        return make(), []
    except Exception as problem:
        return None, [f"there is no page: {sentence(problem)}"]


def parameters_of(model: Oscillator | Element) -> dict[str, dict[str, Any]]:
    """Value, standard error and unit of each parameter; what is not finite is not known."""
    return {
        name: {
            "value": p.value if math.isfinite(p.value) else None,
            "std": p.std if p.std is not None and math.isfinite(p.std) else None,
            "unit": p.unit,
        }
        for name, p in model.parameters().items()
    }


def curve_of(model: Oscillator | Element) -> dict[str, Any]:
    """Damping ratio over the amplitudes that the recordings covered, for an entry's result; nothing where unknown."""
    from ..model.describing import natural_motion
    from ..model.oscillator import Oscillator

    if not isinstance(model, Oscillator) or model.amplitude is None:
        return {}
    top = model.amplitude.max
    low = max(model.amplitude.min, top / _DECADES)
    if not 0.0 < low < top < math.inf:
        return {}
    amplitude = np.geomspace(low, top, _POINTS)
    try:
        omega, h = natural_motion(model, amplitude)
    except BadInput:
        return {}
    ratio = h / omega
    known = np.isfinite(ratio)
    columns = dict(zip(CURVE, (amplitude, ratio), strict=True))
    rounded = {name: [float(f"{value:.6g}") for value in column[known]] for name, column in columns.items()}
    return {"unit": model.amplitude.unit, **rounded} if known.any() else {}


def picture_of(signal: np.ndarray, left: np.ndarray) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The size of a signal (n,) in each part of its time, 0 to 1, and of what is left of it (n,)."""
    sizes = _sizes(signal)
    scale = float(sizes.max()) or 1.0
    return _shown(sizes / scale), _shown(_sizes(left) / scale)


def _sizes(signal: np.ndarray) -> np.ndarray:
    return np.array([np.abs(part).max() for part in np.array_split(signal, min(_PARTS, signal.size))])


def _shown(sizes: np.ndarray) -> tuple[float, ...]:
    return tuple(round(float(size), 3) for size in np.clip(np.nan_to_num(sizes, posinf=1.0), 0.0, 1.0))
