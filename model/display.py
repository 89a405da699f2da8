"""Numbers and units as they are shown: millimetres rather than 0.001 m, 4.60·10⁵ rather than 4.60e+05."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np

from .fit_state import percent_words, times_words
from .parameter import Parameter
from .show import value_and_error

_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M"}
#: Units that take a prefix; a count, a radian or a strain does not.
_PREFIXED = ("m", "N", "V", "g", "Pa", "A", "s", "W", "J")
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Scale:
    """How a quantity is shown: shown value = ``factor`` × value, in ``unit``."""

    factor: float
    unit: str

    def label(self, what: str) -> str:
        """Text of an axis, such as ``Amplitude [mm]``."""
        return f"{what} [{self.unit}]"


def scale_of(unit: str, values: np.ndarray | float) -> Scale:
    """The scale that brings the largest of ``values`` (any shape, in ``unit``) to between 0.1 and 100.

    Angles are shown in degrees. Units that take no prefix (counts, strain) are shown as they are.
    """
    finite = np.abs(np.asarray(values, float))
    finite = finite[np.isfinite(finite)]
    largest = float(np.max(finite)) if finite.size else 0.0
    if re.match(r"rad(?![A-Za-z0-9])", unit):
        return Scale(180.0 / math.pi, pretty_unit("deg" + unit[3:]))
    symbol = re.match(r"([A-Za-z]+)(?![A-Za-z0-9])", unit)
    if symbol is None or symbol.group(1) not in _PREFIXED or not largest > 0:
        return Scale(1.0, pretty_unit(unit))
    # from 0.1 on: an axis to 0.3 N reads better than one to 300 mN
    power = 3 * math.floor(math.log10(largest / 0.1) / 3)
    power = min(max(power, min(_PREFIXES)), 0 if unit.startswith("m/") else max(_PREFIXES))  # nobody reads km/s2
    return Scale(10.0**-power, _PREFIXES[power] + pretty_unit(unit))


def pretty_unit(unit: str) -> str:
    """The model file's ``1/(m2.s2)`` as ``1/(m²·s²)``."""
    return re.sub(r"(?<=[A-Za-z])-?\d+", lambda m: m.group().translate(_SUPERSCRIPTS), unit).replace(".", "·")


def number(value: float, digits: int = 3) -> str:
    """``value`` to so many significant digits, typeset."""
    if not math.isfinite(value):
        return "∞" if value > 0 else "−∞" if value < 0 else "unknown"
    return typeset(f"{value:.{digits}g}")


def typeset(text: str) -> str:
    """A printed number with a true minus and powers of ten."""
    mantissa, e, exponent = text.partition("e")
    if e:
        mantissa += "·10" + str(int(exponent)).translate(_SUPERSCRIPTS)
    return mantissa.replace("-", "−")


def value_text(parameter: Parameter) -> tuple[str, str]:
    """Value and standard error of a parameter, both to the error's second digit; empty where there is no error."""
    if not math.isfinite(parameter.value):
        return number(parameter.value), ""
    value, error = value_and_error(parameter)
    return typeset(value), "∞" if error == "inf" else "" if error == "nan" else typeset(error)


def quantity_text(parameter: Parameter) -> str:
    """Value, standard error and unit: ``0.1500 ± 0.0021 N·s²/m²``."""
    value, error = value_text(parameter)
    unit = "" if parameter.unit == "1" else f" {pretty_unit(parameter.unit)}"
    return f"{value}{f' ± {error}' if error else ''}{unit}"


def full_stop(text: str) -> str:
    """``text`` as a sentence with its full stop; the first letter stays, as it may be a parameter's name."""
    text = text.strip()
    return text if not text or text.endswith((".", "!", "?")) else text + "."


def percent_text(share: float | None) -> str:
    """A share in percent (already times 100) to two digits; empty for None."""
    if share is None or not math.isfinite(share):
        return ""
    return f"{typeset(percent_words(share))} %"


def times_text(ratio: float) -> str:
    """How many times as large, for sentences: 1.02, 12, 190."""
    return typeset(times_words(ratio)) if math.isfinite(ratio) else times_words(ratio)


def tick_text(value: float, _position: int | None = None) -> str:
    """Tick of a logarithmic axis: plain where that is short, else a power of ten."""
    if value <= 0 or not math.isfinite(value):
        return ""
    if 1e-3 <= value < 1e4:
        return f"{value:g}"
    return typeset(f"{value:.0e}").replace("1·10", "10")
