"""Calibration factors: what a recorded volt, count or number stands for."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fnmatch import fnmatchcase

from ..errors import BadInput
from .columns import parse_column
from .units import Unit, find_unit, parse_unit

_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)", re.DOTALL)


@dataclass(frozen=True)
class Calibration:
    """The factor that brings a recorded number to a value, and the units of both, None where nothing was said.

    ``22.4 N/V`` has factor 22.4, value N and recorded V; ``10.2 mV/g``, a sensitivity, 1/10.2, g and mV.
    """

    factor: float
    value: Unit | None = None
    recorded: Unit | None = None


def parse_calibration(text: str, where: str) -> Calibration:
    """A calibration of the form NUMBER, NUMBER UNIT (of one recorded unit), NUMBER UNIT/V or, as on data sheets,
    NUMBER mV/UNIT.

    Raises:
        BadInput: the text is none of these; `where` begins the message.
    """
    match = _NUMBER.fullmatch(text)
    factor = float(match[1]) if match else 0.0
    if match is None or not 0 < abs(factor) < float("inf"):
        raise BadInput(f"{where}: calibration '{text}' is not understood; write 22.4 N/V, 10.2 mV/g, 2.5 N or 2.5")
    units = match[2].strip()
    if not units:
        return Calibration(factor)
    if (unit := find_unit(units)) is not None:
        return Calibration(factor, unit)
    for slash in (i for i, sign in enumerate(units) if sign == "/"):
        above, below = (find_unit(part.strip(" ()")) for part in (units[:slash], units[slash + 1 :]))
        if above is not None and below is not None and (above.quantity == "any") != (below.quantity == "any"):
            if below.quantity == "any":
                return Calibration(factor, above, below)
            return Calibration(1.0 / factor, below, above)
    if "/" in units:
        raise BadInput(
            f"{where}: calibration '{text}' is not understood; one of its units must be what was recorded (V, mV, A, "
            "counts) and the other what it stands for: 22.4 N/V, 10.2 mV/g"
        )
    return Calibration(factor, parse_unit(units, where))  # which says what units there are


def of_column(calibrations: dict[str, str], role: str, name: str, unit: str, where: str) -> Calibration | None:
    """The calibration of a column: that of its name or of a pattern that it fits, else that of its role.

    Args:
        calibrations: texts by role (force, response, time), name or pattern.
        role: of the column.
        name: of the column, as the file has it.
        unit: of the column, where the file says it apart from the name.
        where: begins messages.

    Raises:
        BadInput: a text is not understood.
    """
    base = parse_column(name, unit).base
    for key, text in calibrations.items():
        pattern = key.strip().lower()
        if name and any(fnmatchcase(candidate.lower(), pattern) for candidate in (name, base)):
            return parse_calibration(text, f"{where}, column '{name}'")
    text = calibrations.get(role)
    return None if text is None else parse_calibration(text, f"{where}, {role}")


def applied(calibration: Calibration, column: Unit | None, where: str) -> tuple[float, Unit | None]:
    """What the numbers of a column are multiplied by, and the unit of the result.

    Args:
        calibration: of that column.
        column: its unit in the file; None where it says none.
        where: begins messages.

    Raises:
        BadInput: the file says another unit than what the calibration is for.
    """
    recorded = calibration.recorded
    if calibration.value is None:
        return calibration.factor, column
    if recorded is None or column is None:
        return calibration.factor, calibration.value
    if column.si != recorded.si:
        raise BadInput(
            f"{where}: the calibration is for {recorded.text}, the file has {column.text}; leave --calibration out "
            "where the file is calibrated already"
        )
    return calibration.factor * column.factor / recorded.factor, calibration.value
