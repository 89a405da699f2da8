"""Whatever a program or a file holds as an array, as plain numbers: what is masked or not available is NaN.

Times and durations are numbers too, of seconds. What cannot be a channel is told by the kind of its values.
"""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from ..errors import BadInput
from .content import MOST_MB

_KINDS = {
    "c": "complex numbers",
    "b": "yes or no",
    "V": "records of several values",
    "U": "text",
    "S": "text",
    "T": "text",
    "O": "objects that are no numbers",
}


class Numbers(NamedTuple):
    """``values`` are real numbers, None where they are of the ``kind`` named; ``unit`` where one follows."""

    values: np.ndarray | None
    unit: str = ""
    kind: str = ""


def numbers_of(given: Any) -> Numbers:
    """The numbers of an array, a list, or a column of pandas, polars or Arrow.

    Whole numbers stay such where none is missing; times (also with a zone) become seconds since the first, durations
    seconds. Decimal numbers and fractions become floats.

    Raises:
        BadInput: it stands for more numbers than lie in memory, and more than a file may hold.
    """
    _bounded(given)
    missing = _missing(given)
    array = _array(given)
    kind = array.dtype.kind
    if kind in "mM":
        return Numbers(_seconds(array, missing), "s")
    if kind == "O":
        made = _of_objects(array)
        if made is None:
            is_text = array.size > 0 and all(isinstance(value, str) for value in array.flat)
            return Numbers(None, kind=_KINDS["U" if is_text else "O"])
        array = made
    elif kind not in "iuf":
        return Numbers(None, kind=_KINDS.get(kind, "no numbers"))
    if missing is not None and missing.shape == array.shape and missing.any():
        array = np.where(missing, np.nan, array.astype(float))
    return Numbers(np.ma.getdata(array))


def vector_of(given: Any, what: str) -> np.ndarray:
    """Numbers as floats of any shape, NaN where one is masked.

    Raises:
        BadInput: there are none, or more than fit in memory; ``what`` begins the message.
    """
    numbers = numbers_of(given)
    if numbers.values is None:
        raise BadInput(f"{what} is not an array of numbers, but of {numbers.kind}")
    try:
        return np.array(numbers.values, float)
    except MemoryError:
        raise BadInput(f"{what} has {numbers.values.size} numbers, more than fit in memory; give less") from None


def _bounded(given: Any) -> None:
    """Refuse a range, or a view of few numbers that repeats them, of more than MOST_MB."""
    size = 0
    if isinstance(given, range):
        size = 8 * max(0, -(-(given.stop - given.start) // given.step))  # whose len may not fit
    elif isinstance(given, np.ndarray) and given.nbytes > MOST_MB * 1e6:
        low, high = np.lib.array_utils.byte_bounds(given)
        size = given.nbytes if given.nbytes > high - low else 0
    if size > MOST_MB * 1e6:
        raise BadInput(
            f"a {type(given).__name__} of {size // 8} numbers stands for more than {MOST_MB:g} MB; give less at once"
        )


def _missing(given: Any) -> np.ndarray | None:
    """Where a value is masked or not available; None where nothing can be."""
    if isinstance(given, np.ma.MaskedArray):
        return None if given.dtype.names else np.ma.getmaskarray(given)
    if hasattr(given, "isna"):  # of pandas
        return np.asarray(given.isna(), bool)
    return None


def _array(given: Any) -> np.ndarray:
    zone = getattr(getattr(given, "dtype", None), "tz", None)
    if zone is not None:  # numpy has none: in UTC
        return np.asarray(given, "datetime64[ns]")
    kind = getattr(getattr(given, "dtype", None), "kind", "")
    if hasattr(given, "to_numpy") and kind in "iuf" and not isinstance(given, np.ndarray):
        missing = _missing(given)
        if missing is not None and missing.any():
            return np.asarray(given.to_numpy(dtype=float, na_value=np.nan))
    try:
        return np.ma.getdata(given) if isinstance(given, np.ma.MaskedArray) else np.asarray(given)
    except MemoryError:
        raise BadInput(f"a {type(given).__name__} of more numbers than fit in memory; give less at once") from None
    except (TypeError, ValueError, OverflowError):  # lists of several lengths, whole numbers beyond any
        return np.array([None, given], object)[1:]


def _seconds(array: np.ndarray, missing: np.ndarray | None) -> np.ndarray:
    """(n,) s: durations as they are, times since the first."""
    absent = np.isnat(array) if missing is None or missing.shape != array.shape else np.isnat(array) | missing
    spans = array
    if array.dtype.kind == "M":
        spans = array - (array[~absent].flat[0] if (~absent).any() else np.datetime64(0, "s"))
    return np.where(absent, np.nan, spans / np.timedelta64(1, "s"))


def _of_objects(array: np.ndarray) -> np.ndarray | None:
    """Floats, where each object is a number or stands for none that is there; else None."""
    flat = np.empty(array.size)
    for i, value in enumerate(array.flat):
        if value is None or type(value).__name__ in ("NAType", "NaTType") or value is np.ma.masked:
            flat[i] = np.nan
        elif isinstance(value, int | float | Decimal | Fraction | np.integer | np.floating) and not isinstance(
            value, bool
        ):
            try:
                flat[i] = float(value)
            except (OverflowError, ValueError):  # whole numbers beyond any, signalling NaN
                return None
        else:
            return None
    return None if array.size and np.isnan(flat).all() else flat.reshape(array.shape)
