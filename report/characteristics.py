"""Static force characteristics and damping curve, like Figs. 5 and 7 of the paper."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..errors import BadInput
from ..identify.hilbert.static_force import Characteristic, static_force
from ..model import units
from ..model.describing import equivalent_damping, natural_motion
from ..model.display import Scale, scale_of
from ..model.inner_force import InnerForce, without_memory
from .chart import Chart, Panel
from .covered import covered, spans_of
from .style import FORCED, FREE, MODEL

if TYPE_CHECKING:
    from ..identify.hilbert.modal_result import ModalCurve
    from ..identify.identification import Identification
    from ..model import Oscillator

_MARKS: dict[str, tuple[str, Literal["o", "s"], str]] = {
    "freevib": (FREE, "s", "from FREEVIB"),
    "forcevib": (FORCED, "o", "from FORCEVIB"),
}
#: A measured damping whose standard error exceeds this part of it says nothing in a picture.
_UNSURE = 0.3
#: Amplitudes at which the curves of a model with a memory are computed.
_CURVE = 48
_NONE = "at most of these amplitudes no periodic motion of the model was found; simulate it instead"


def stiffness_figure(identification: Identification) -> Chart:
    """Chart of the restoring force per unit mass over displacement (Fig. 5), whole and without its linear part.

    Points: the measured backbones, describing function inverted. With a law that has a memory there is no static force,
    and the line is the model's own backbone inverted in the same way.
    """
    model = identification.oscillator
    unit = model.response.displacement_unit
    top = _reach(identification)
    points = {method: _measured(identification, method, lambda c: c.omega0**2 * c.amplitude) for method in _MARKS}
    grid, force = _spring(model, top)
    linear = model.omega0.value**2
    across = scale_of(unit, top)
    per_mass = units.compose("X/s2", unit)
    chart = Chart("stiffness", f"Restoring force per unit mass over displacement in {across.unit}")
    whole, bent = chart.row(1, 1, height=290)
    for panel, slope, title in ((whole, 0.0, "Restoring force"), (bent, linear, "… without its linear part ω₀² x")):
        _characteristic(panel, grid, force - slope * grid, points, slope, across, per_mass)
        panel.x.set(label=across.label("Displacement"))
        panel.title = title
    return chart


def friction_figure(identification: Identification) -> Chart:
    """Chart of the damping curve h(A) and of the friction force per unit mass over velocity (Fig. 7).

    With a law that has a memory the line of the latter is the model's own damping curve, inverted as the points are.
    """
    model = identification.oscillator
    unit = model.response.displacement_unit
    top = _reach(identification)
    across = scale_of(unit, top)
    speed = top * model.omega0.value
    along = scale_of(units.compose("X/s", unit), speed)
    grid, force = _friction(model, top)
    points = {
        method: _measured(identification, method, lambda c: 2 * c.damping * c.amplitude * c.omega0, by_speed=True)
        for method in _MARKS
    }
    title = f"Damping in 1/s over amplitude in {across.unit}, and friction force over velocity in {along.unit}"
    chart = Chart("friction", title)
    curve, whole, bent = chart.row(1, 1, 1)
    _damping_curve(curve, identification, top)
    for panel, slope, words in (
        (whole, 0.0, "Friction force"),
        (bent, model.viscous.value, "… without viscous part"),
    ):
        _characteristic(panel, grid, force - slope * grid, points, slope, along, units.compose("X/s2", unit))
        panel.x.set(label=along.label("Velocity"))
        panel.title = words
    return chart


def _spring(model: Oscillator, top: float) -> tuple[np.ndarray, np.ndarray]:
    """Displacements (n,) and the restoring force per unit mass there (n,)."""
    if without_memory(model)[1] is None:
        grid = _through_zero(top)
        return grid, InnerForce(model).static(grid)
    a = np.linspace(0, top, _CURVE)[1:]
    omega, _ = natural_motion(model, a)
    return _odd(static_force(a, omega**2 * a))


def _friction(model: Oscillator, top: float) -> tuple[np.ndarray, np.ndarray]:
    """Velocities (n,) and the friction force per unit mass there (n,)."""
    if without_memory(model)[1] is None:
        grid = _through_zero(top * model.omega0.value)
        inner = InnerForce(model)
        return grid, inner(np.zeros_like(grid), grid) - inner.static(np.zeros_like(grid))
    a = np.linspace(0, top, _CURVE)[1:]
    omega, h = natural_motion(model, a)
    return _odd(static_force(omega * a, 2 * h * omega * a))


def _odd(measured: Characteristic) -> tuple[np.ndarray, np.ndarray]:
    if not measured.at.size:
        raise BadInput(_NONE)
    return np.concatenate([-measured.at[::-1], measured.at]), np.concatenate([-measured.force[::-1], measured.force])


def _characteristic(
    panel: Panel,
    grid: np.ndarray,
    line: np.ndarray,
    points: dict[str, Characteristic],
    slope: float,
    across: Scale,
    unit: str,
) -> None:
    """The model's force as a line, the measured points on it; the model sets the view, as far points may scatter."""
    up = scale_of(unit, line)
    panel.line(grid * across.factor, line * up.factor, MODEL, "model", width=1.6)
    for method, measured in points.items():
        _draw(panel, measured, slope, method, across.factor, up.factor)
    panel.y.set(label=up.label("Force per unit mass"))
    reach = 1.4 * float(np.max(np.abs(line))) * up.factor
    if reach > 0:
        panel.y.set(low=-reach, high=reach)


def _damping_curve(panel: Panel, identification: Identification, top: float) -> None:
    model = identification.oscillator
    across = scale_of(model.response.displacement_unit, top)
    low = min((float(c.amplitude.min()) for c in identification.measured.curves), default=top / 100)
    a = np.geomspace(min(low, top / 3), top, 160 if without_memory(model)[1] is None else _CURVE)
    h = damping(model, a)
    for curve in identification.measured.curves:
        color, _, label = _MARKS[curve.method]
        order = np.argsort(curve.amplitude)
        shown = np.where(_sure(curve), curve.damping, np.nan)[order]
        dash = "-." if curve.method == "freevib" else ":"
        words = label.replace("from", "curve by")
        panel.line(curve.amplitude[order] * across.factor, shown, color, words, dash=dash, width=1.8)
    panel.line(a * across.factor, h, MODEL, "model", width=1.6)
    panel.x.set(log=True, label=across.label("Amplitude"))
    panel.y.set(label="Damping h [1/s]")
    panel.title = "Damping curve"
    _around(panel, h)


def damping(model: Oscillator, amplitude: np.ndarray) -> np.ndarray:
    """The model's h (n,), 1/s, at its natural frequency of each amplitude (n,): half the equivalent viscous damping."""
    omega, h = natural_motion(model, amplitude)
    lost = ~np.isfinite(omega)
    if np.any(lost) and without_memory(model)[1] is None:
        h[lost] = equivalent_damping(model, amplitude[lost], model.omega0.value) / 2
    if not np.any(np.isfinite(h)):
        raise BadInput(_NONE)
    return h


def _reach(identification: Identification) -> float:
    model = identification.oscillator
    tops = [float(c.amplitude.max()) for c in identification.measured.curves if c.amplitude.size]
    if model.amplitude is not None:
        tops.append(model.amplitude.max)
    return max(tops, default=1.0) or 1.0


def _through_zero(top: float) -> np.ndarray:
    """A grid that shows a step at zero as a step."""
    half = np.append(1e-9, np.linspace(0, 1, 101)[1:]) * top
    return np.concatenate([-half[::-1], [0.0], half])


def _measured(
    identification: Identification, method: str, fundamental: Any, *, by_speed: bool = False
) -> Characteristic:
    """The force from all curves of one method, where they pass; over the speed, of what is known of the damping."""
    curves = [c for c in identification.measured.curves if c.method == method]
    at = [c.amplitude * c.omega0 if by_speed else c.amplitude for c in curves]
    force = [fundamental(c) for c in curves]
    if by_speed:
        force = [np.where(_sure(c), f, np.nan) for c, f in zip(curves, force, strict=True)]
    places, forces = (np.concatenate([np.empty(0), *parts]) for parts in (at, force))
    found = static_force(places, forces)
    seen = covered(found.at, spans_of(np.where(np.isfinite(f), a, np.nan) for a, f in zip(at, force, strict=True)))
    return Characteristic(found.at[seen], found.force[seen], found.std[seen])


def _sure(curve: ModalCurve) -> np.ndarray:
    return curve.damping_std < _UNSURE * np.abs(curve.damping)


def _draw(panel: Panel, measured: Characteristic, slope: float, method: str, across: float, up: float) -> None:
    color, marker, label = _MARKS[method]
    if not measured.at.size:
        return
    y = (measured.force - slope * measured.at) * up
    x = np.concatenate([-measured.at[::-1], measured.at]) * across
    panel.dots(x, np.concatenate([-y[::-1], y]), color, label, marker=marker, size=3.6, hollow=True)


def _around(panel: Panel, h: np.ndarray) -> None:
    """The view that the model's curve asks for, zero in it where the damping is positive."""
    if not np.any(np.isfinite(h)):
        return
    low, high = float(np.nanmin(h)), float(np.nanmax(h))
    margin = 0.25 * max(high - low, 0.2 * abs(high))
    panel.y.set(low=min(0.0, low - margin) if low < 0 else 0.0, high=high + margin)
