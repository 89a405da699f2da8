"""Backbone and damping curve of a model as small SVG pictures that need nothing but the text itself.

Drawn by hand and not by matplotlib: two lines and their axes take a few kB of SVG, and an FMU made with any version of
anything then holds the same bytes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from html import escape

import numpy as np

from ..errors import BadInput
from ..model.display import Scale, number, scale_of, tick_text, typeset
from .facts import Facts

#: Points within the range; fewer with a law that has a memory, for each of them is then an integration.
_POINTS, _MEMORY_POINTS = 57, 33
#: How far beyond the range of validity the curves go on, as a factor.
_BEYOND = 1.8
#: Where a range begins at zero, or none is stated, the curves begin at this part of its end.
_FLOOR = 0.01
_WIDTH, _HEIGHT = 420, 290
_LEFT, _RIGHT, _TOP, _BOTTOM = 58, 12, 30, 46
_INK, _LINE, _SHADE, _GRID = "#333", "#0072b2", "#e3eff7", "#ddd"


@dataclass(frozen=True, eq=False)
class Curves:
    """Mean natural frequency and damping of a model over the amplitude of its motion.

    Attributes:
        amplitude: (n,) in the displacement's unit.
        frequency: (n,) Hz, NaN where the model does not swing.
        damping: (n,) h in 1/s, half the equivalent viscous damping per unit mass.
        low, high: range of validity, in the displacement's unit; what is drawn lies within too.
        stated: whether the model states that range.
    """

    amplitude: np.ndarray
    frequency: np.ndarray
    damping: np.ndarray
    low: float
    high: float
    stated: bool


def curves(facts: Facts) -> Curves | None:
    """The curves that the Hilbert transform measures (FREEVIB), from the model's describing functions.

    Returns None where the model has no periodic motion at any of the amplitudes.
    """
    valid = facts.oscillator.amplitude
    high = facts.amplitude
    if not (math.isfinite(high) and high > 0):
        return None
    low = valid.min if valid is not None and 0 < valid.min < high else _FLOOR * high
    beyond = _BEYOND if valid is not None else 1.0
    points = _MEMORY_POINTS if facts.harmonic.remembers else _POINTS
    inside = np.geomspace(low, high, points)
    more = min(math.ceil(math.log(beyond) / math.log(inside[1] / low)), points // 6)
    tail = np.geomspace(1.0, beyond, more + 1)[1:]
    amplitude = np.concatenate([low / tail[::-1], inside, high * tail])
    try:
        with np.errstate(all="ignore"):
            omega, damping = facts.harmonic.natural(amplitude)
    except BadInput:
        return None
    if not np.any(np.isfinite(omega) & np.isfinite(damping)):
        return None
    return Curves(amplitude, omega / (2 * np.pi), damping, low, high, valid is not None)


def pictures(drawn: Curves, unit: str) -> tuple[str, str]:
    """SVG elements of the backbone and of the damping curve; ``unit`` is the displacement's."""
    across = scale_of(unit, drawn.high)
    return (
        _picture("backbone", "Natural frequency [Hz]", drawn, drawn.frequency, across, from_zero=False),
        _picture("damping", "Damping h [1/s]", drawn, drawn.damping, across, from_zero=True),
    )


def table(drawn: Curves, unit: str) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Head and rows of the same in numbers, at amplitudes spread over the range."""
    across = scale_of(unit, drawn.high)
    wanted = np.geomspace(drawn.low, drawn.high, 5)
    places = [int(np.argmin(np.abs(np.log(drawn.amplitude / a)))) for a in wanted]
    rows = []
    for i in dict.fromkeys(places):
        f, h = drawn.frequency[i], drawn.damping[i]
        if not (np.isfinite(f) and np.isfinite(h)):
            continue
        ratio = 100 * h / (2 * np.pi * f)
        rows.append((number(drawn.amplitude[i] * across.factor), _digits(f, 5), _digits(h, 4), _digits(ratio, 3)))
    return (across.label("Amplitude"), "Natural frequency [Hz]", "Damping h [1/s]", "Damping ratio [%]"), rows


def _digits(value: float, digits: int) -> str:
    """So many significant digits, zeros at the end too: a column reads better with them."""
    return typeset(f"{value:#.{digits}g}".rstrip("."))


def _picture(key: str, label: str, drawn: Curves, y: np.ndarray, across: Scale, *, from_zero: bool) -> str:
    """One curve over a logarithmic amplitude, full within the range of validity and dashed beyond."""
    left, right = drawn.amplitude[0], drawn.amplitude[-1]
    bottom, top, ticks = _axis(y[np.isfinite(y)], from_zero=from_zero)

    def px(a: float) -> float:
        return _LEFT + (_WIDTH - _LEFT - _RIGHT) * math.log(a / left) / math.log(right / left)

    def py(v: float) -> float:
        return _HEIGHT - _BOTTOM - (_HEIGHT - _TOP - _BOTTOM) * (v - bottom) / (top - bottom)

    def text(x: float, v: float, words: str, anchor: str = "middle", more: str = "") -> str:
        return f'<text x="{x:.1f}" y="{v:.1f}" text-anchor="{anchor}"{more}>{escape(words)}</text>'

    floor = _HEIGHT - _BOTTOM
    parts = []
    if drawn.stated:
        x = px(drawn.low)
        parts.append(
            f'<rect x="{x:.1f}" y="{_TOP}" width="{px(drawn.high) - x:.1f}" height="{floor - _TOP}" fill="{_SHADE}"/>'
        )
    for v in ticks:
        parts.append(f'<path d="M{_LEFT} {py(v):.1f}H{_WIDTH - _RIGHT}" stroke="{_GRID}"/>')
        parts.append(text(_LEFT - 7, py(v) + 4, _tick(v, ticks), "end"))
    for a in _decades(left * across.factor, right * across.factor):
        x = px(a / across.factor)
        parts.append(f'<path d="M{x:.1f} {_TOP}V{floor}" stroke="{_GRID}"/>')
        parts.append(text(x, floor + 17, tick_text(a)))
    parts.append(f'<path d="M{_LEFT} {_TOP}V{floor}H{_WIDTH - _RIGHT}" stroke="{_INK}" fill="none"/>')
    inside = (drawn.amplitude >= drawn.low * (1 - 1e-9)) & (drawn.amplitude <= drawn.high * (1 + 1e-9))
    first, last = np.flatnonzero(inside)[[0, -1]]
    for part, style in (
        (slice(0, first + 1), ' stroke-width="1.5" stroke-dasharray="4 4"'),
        (slice(last, None), ' stroke-width="1.5" stroke-dasharray="4 4"'),
        (slice(first, last + 1), ' stroke-width="2.5"'),
    ):
        line = _line([(px(a), py(v)) for a, v in zip(drawn.amplitude[part], y[part], strict=True)])
        if line:
            parts.append(f'<path d="{line}" stroke="{_LINE}" fill="none" stroke-linejoin="round"{style}/>')
    parts.append(text((_LEFT + _WIDTH - _RIGHT) / 2, _HEIGHT - 8, across.label("Amplitude")))
    parts.append(text(8, 16, label, "start", ' font-weight="600"'))
    title = f"{label} over {across.label('amplitude')}"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" '
        f'aria-labelledby="{key}-title" font-family="system-ui, sans-serif" font-size="12.5" fill="{_INK}">\n'
        f'<title id="{key}-title">{escape(title)}</title>\n' + "\n".join(parts) + "\n</svg>"
    )


def _line(points: list[tuple[float, float]]) -> str:
    """Path through the points; where one is not there the line stops."""
    strokes, pen = [], "M"
    for x, y in points:
        if math.isfinite(y):
            strokes.append(f"{pen}{x:.1f} {y:.1f}")
        pen = "L" if math.isfinite(y) else "M"
    return "".join(strokes) if any(stroke[0] == "L" for stroke in strokes) else ""


def _axis(values: np.ndarray, *, from_zero: bool) -> tuple[float, float, list[float]]:
    """Bottom, top and ticks of a linear axis that shows the values, (n,); a flat curve gets room about it."""
    low, high = float(values.min()), float(values.max())
    room = max(0.08 * (high - low), 0.01 * max(abs(low), abs(high)), 1e-300)
    low, high = low - room, high + room
    if from_zero:
        low, high = min(low, 0.0) if values.min() < 0 else 0.0, max(high, 0.0)
    step = 10.0 ** math.floor(math.log10((high - low) / 4))
    step *= next(factor for factor in (1, 2, 5, 10) if (high - low) / (factor * step) <= 6)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return low, high, [k * step for k in range(first, last + 1)]


def _tick(value: float, ticks: list[float]) -> str:
    """Text of a tick, with the decimals that tell it from its neighbours."""
    step = ticks[1] - ticks[0] if len(ticks) > 1 else 1.0
    if not 1e-4 <= step < 1e5:
        return number(value if abs(value) > 1e-9 * step else 0.0, 4)
    return typeset(f"{value:.{max(0, -math.floor(math.log10(step) + 1e-9))}f}")


def _decades(low: float, high: float) -> list[float]:
    """Ticks of a logarithmic axis: 1, 2 and 5 where there is room, else decades alone."""
    steps = (1, 2, 5) if high < 200 * low else (1,)
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    return [tick for p in powers for s in steps if low <= (tick := s * 10.0**p) <= high]
