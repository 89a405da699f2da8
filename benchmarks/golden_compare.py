"""What comparing two results of the golden set finds: numbers, words, and what is in one of them only.

A difference of two numbers is relative to the larger of them. A parameter is measured by the larger of value and
standard error, and an entry of a covariance by the standard errors of its row and column, since both may be zero but
for rounding.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

_NUMBER = re.compile(r"-?(0x[01]\.[0-9a-f]+p[+-]\d+|inf|nan)")
_ABSENT = "(absent)"


def plain(value: Any) -> Any:
    """A value as JSON keeps it to the last bit: floats as hexadecimal words, arrays as lists."""
    if isinstance(value, dict):
        return {str(key): plain(inner) for key, inner in value.items()}
    if hasattr(value, "tolist"):  # of numpy
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [plain(inner) for inner in value]
    return value.hex() if isinstance(value, float) else value


def number(value: Any) -> float | None:
    """The number that `plain` has made a word of, or that is an integer; None of anything else."""
    if isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    return float.fromhex(value) if isinstance(value, str) and _NUMBER.fullmatch(value) else None


@dataclass(frozen=True)
class Difference:
    """Two values that are not the same.

    Attributes:
        path: of the value in the case.
        size: the relative difference of two numbers; infinite where something else differs.
        before, after: the values.
    """

    path: str
    size: float
    before: Any
    after: Any

    def __str__(self) -> str:
        if math.isfinite(self.size):
            return f"{self.path}: {number(self.before)!r} -> {number(self.after)!r}"
        return f"{self.path}: {_words(self.before)} -> {_words(self.after)}"


def _words(value: Any) -> str:
    known = number(value)
    return str(value) if known is None else repr(known)


def differences(
    before: Any, after: Any, path: str = "", scale: float = 0.0, numbers: bool = False
) -> Iterator[Difference]:
    """Everything in which two results differ; differences of numbers of any size.

    `scale`: what a number's difference is measured by, at least. `numbers`: whether sentences are left out.
    """
    if isinstance(before, dict) and isinstance(after, dict):
        for key in {**before, **after}:
            one, other = before.get(key, _ABSENT), after.get(key, _ABSENT)
            std = number(before.get("std")) if key == "value" else None
            usual = std if std is not None and math.isfinite(std) else 0.0
            inner = f"{path}.{key}".lstrip(".")
            if key == "covariance" and isinstance(one, list) and isinstance(other, list):
                yield from _of_covariances(one, other, inner)
            else:
                yield from differences(one, other, inner, usual, numbers)
    elif isinstance(before, list) and isinstance(after, list):
        for i in range(max(len(before), len(after))):
            one, other = (values[i] if i < len(values) else _ABSENT for values in (before, after))
            yield from differences(one, other, f"{path}[{i}]", 0.0, numbers)
    elif before != after:
        one, other = number(before), number(after)
        if one is not None and other is not None:
            yield Difference(path, _relative(one, other, scale), before, after)
        elif not (numbers and _is_sentence(before) and _is_sentence(after)):
            yield Difference(path, math.inf, before, after)


def _relative(one: float, other: float, scale: float) -> float:
    """The difference of two unequal numbers over the largest of both and the scale; infinite where one is no number."""
    size = abs(one - other) / max(abs(one), abs(other), scale)
    return size if math.isfinite(size) else math.inf


def _of_covariances(before: list[Any], after: list[Any], path: str) -> Iterator[Difference]:
    errors = [math.sqrt(abs(number(row[i]) or 0.0)) if i < len(row) else 0.0 for i, row in enumerate(before)]
    for i in range(max(len(before), len(after))):
        one, other = (rows[i] if i < len(rows) else [] for rows in (before, after))
        for j in range(max(len(one), len(other))):
            old, new = (row[j] if j < len(row) else _ABSENT for row in (one, other))
            scale = errors[i] * errors[j] if max(i, j) < len(errors) else 0.0
            yield from differences(old, new, f"{path}[{i}][{j}]", scale if math.isfinite(scale) else 0.0)


def _is_sentence(value: Any) -> bool:
    """Whether it is said to a person: names have no blanks. What is absent counts, for a sentence may go."""
    return value is None or (isinstance(value, str) and (" " in value or not value))


@dataclass(frozen=True)
class Compared:
    """A case at two commits: its name, whether it passes, and what to say of it."""

    name: str
    same: bool
    line: str
    details: tuple[str, ...] = ()


def compare_case(name: str, before: Any, after: Any, tolerance: float, numbers: bool = False) -> Compared:
    """Compare one case; a case that ends in an error that is no refusal never passes."""
    for result in (before, after):
        if result is not None and "error" in result:
            return Compared(name, False, "ERROR", (result["error"],))
    if before is None or after is None:
        return Compared(name, False, "MISSING", (f"only in the {'second' if before is None else 'first'}",))
    found = sorted(differences(before, after, numbers=numbers), key=lambda d: -d.size)
    if not found:
        return Compared(name, True, "equal")
    if found[0].size <= tolerance:
        return Compared(name, True, f"{found[0].size:.1e} at {found[0].path}")
    too_large = [difference for difference in found if difference.size > tolerance]
    sized = [difference for difference in too_large if math.isfinite(difference.size)]
    words = len(too_large) - len(sized)
    largest = f"largest {sized[0].size:.1e} at {sized[0].path}" if sized else "no number"
    head = f"DIFFERS: {len(sized)} numbers, {words} other values, {largest}"
    return Compared(name, False, head, tuple(str(d) for d in [*too_large[:words][:3], *sized[:3]]))


def compare(before: dict[str, Any], after: dict[str, Any], tolerance: float, numbers: bool = False) -> bool:
    """Print the table of two recorded files; whether all cases agree."""
    first, second = before["cases"], after["cases"]
    rows = [compare_case(n, first.get(n), second.get(n), tolerance, numbers) for n in {**first, **second}]
    width = max((len(row.name) for row in rows), default=0)
    for row in rows:
        print(f"{row.name:{width}}  {row.line}")
        for detail in row.details:
            print(f"{'':{width}}    {detail}")
    worse = [row.name for row in rows if not row.same]
    equal = sum(row.line == "equal" for row in rows)
    allowed = f", {len(rows) - equal - len(worse)} within {tolerance:g}" if tolerance else ""
    print(f"\n{len(rows)} cases: {equal} equal{allowed}, {len(worse)} differ")
    return not worse
