"""Natural frequency and damping ratio of a model over the amplitude."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import BadInput
from ..recording.plain_numbers import vector_of

if TYPE_CHECKING:
    from ..identify.hilbert.hilbert_result import HilbertAnalysis
    from ..identify.identification import Identification
    from ..model import Oscillator

_POINTS = 120
#: Range of amplitudes that is drawn where the model does not say for which it holds.
_DECADES = 100.0


@dataclass(frozen=True, eq=False, repr=False)
class Backbone:
    """A backbone.

    Attributes:
        name: of the rig.
        amplitude: of the displacement (n,), in ``unit``.
        frequency: of the undamped free vibration (n,), Hz; the mean one where a law has a memory; NaN where the spring
            does not pull back.
        damping_ratio: (n,), the equivalent viscous one: damping h over the natural frequency (Eq. 7).
        unit: of the amplitude.
        measured: FREEVIB's and FORCEVIB's curves, where the model was identified here.
    """

    name: str
    amplitude: np.ndarray
    frequency: np.ndarray
    damping_ratio: np.ndarray
    unit: str
    measured: HilbertAnalysis | None = None

    def __repr__(self) -> str:
        return (
            f"{self.name}: {self._at(0)}, {self._at(-1)} ({self.amplitude.size} amplitudes)"
            if self.amplitude.size > 1
            else f"{self.name}: {self._at(0)}"
        )

    def _at(self, i: int) -> str:
        from ..model.display import scale_of

        ratio, scale = 100 * self.damping_ratio[i], scale_of(self.unit, float(self.amplitude[i]))
        size = f"{self.amplitude[i] * scale.factor:.3g} {scale.unit}"
        return f"{self.frequency[i]:.6g} Hz with {ratio:.3g} % damping at {size}"

    def _repr_html_(self) -> str:
        from .words import paragraph

        return paragraph(repr(self)) + self.plot()._repr_svg_()

    def plot(self) -> Any:
        """Amplitude over frequency, and damping ratio over amplitude; a matplotlib Figure."""
        from ..model.display import scale_of
        from ..report.style import EXACT, FORCED, FREE, log_ticks
        from .plot import new_plot

        scale = scale_of(self.unit, self.amplitude)
        with new_plot(2, beside=True, height=3.6) as (figure, (left, right)):
            said = set()
            for curve in self.measured.curves if self.measured is not None else ():
                free = curve.method == "freevib"
                label = "decays, FREEVIB" if free else "driven, FORCEVIB"
                style = {
                    "color": FREE if free else FORCED,
                    "linestyle": "-." if free else ":",
                    "label": None if label in said else label,
                }
                said.add(label)
                a = curve.amplitude * scale.factor
                left.plot(curve.omega0 / (2 * np.pi), a, **style)
                right.plot(a, 100 * curve.damping / curve.omega0, **style)
            left.plot(self.frequency, self.amplitude * scale.factor, color=EXACT, linewidth=1.1, label="model")
            right.plot(self.amplitude * scale.factor, 100 * self.damping_ratio, color=EXACT, linewidth=1.1)
            left.set_yscale("log")
            right.set_xscale("log")
            log_ticks(left.yaxis)
            log_ticks(right.xaxis)
            left.set_title("Backbone")
            left.set_xlabel("Frequency [Hz]")
            left.set_ylabel(scale.label("Amplitude"))
            left.legend(loc="best")
            right.set_title("Damping")
            right.set_xlabel(scale.label("Amplitude"))
            right.set_ylabel("Damping ratio [%]")
            right.set_ylim(0, None)
        return figure


def backbone_of(o: Oscillator, identification: Identification | None, amplitude: Any = None) -> Backbone:
    """See ``Model.backbone``."""
    from ..model.backbone import exact_backbone
    from ..model.describing import natural_motion
    from ..model.inner_force import without_memory

    a = np.atleast_1d(_range(o) if amplitude is None else vector_of(amplitude, "amplitudes"))
    if a.ndim != 1 or not a.size or not np.all(np.isfinite(a) & (a > 0)):
        raise BadInput(f"amplitudes must be positive numbers (n,), in {o.response.displacement_unit}")
    mean, h = natural_motion(o, a)
    omega = mean
    if without_memory(o)[1] is None:
        try:
            omega = exact_backbone(o, a)
        except BadInput:  # some amplitudes have no free vibration
            omega = np.array([_frequency(o, float(one)) for one in a])
    measured = None if identification is None or amplitude is not None else identification.measured
    unit = o.response.displacement_unit
    return Backbone(o.name, a, omega / (2 * np.pi), h / mean, unit, measured)


def _frequency(o: Oscillator, amplitude: float) -> float:
    """Of the free vibration of one amplitude, rad/s; NaN where there is none."""
    from ..model.backbone import exact_backbone

    try:
        return float(exact_backbone(o, amplitude)[0])
    except BadInput:
        return float("nan")


def _range(o: Oscillator) -> np.ndarray:
    if o.amplitude is not None and o.amplitude.max > 0:
        top = o.amplitude.max
        low = o.amplitude.min if 0 < o.amplitude.min < top else top / _DECADES
        return np.geomspace(low, top, _POINTS)
    raise BadInput(
        f"{o.name} does not say which amplitudes it holds for; give them: backbone(amplitudes in "
        f"{o.response.displacement_unit})"
    )
