"""FREEVIB's and FORCEVIB's results as files: the curves as CSV, the fitted laws as JSON."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import __version__
from ...model import units
from ...model.fit_state import times_words
from ...model.parameter import Parameter
from ...model.show import columns_text, finite, value_and_error
from ..signals.registry import shown
from .hilbert_result import HilbertAnalysis
from .modal_result import LawFit, ModalCurve, ModalFit

if TYPE_CHECKING:
    from ...recording.as_recorded import InUnit
    from ...recording.recording import Recording


#: Units of Eq. 17 per unit mass, with X for that of the displacement and Q of the force, and of what follows from them.
UNITS = {
    "mass": "Q.s2/X",
    "omega0": "rad/s",
    "cubic": "1/(X2.s2)",
    "preload": "X/s2",
    "viscous": "1/s",
    "dry": "X/s2",
    "k": "Q/X",
    "F0": "Q",
    "F0/k": "X",
}
_A_CYCLE = shown(8, "rows a cycle", why="of the CSV file: the curves are smooth over several")
_HEAD = (
    "recording,method,stretch,time_s,amplitude_{x},frequency_Hz,phase_rad,omega0_rad_s,omega0_std_rad_s,"
    "damping_1_s,damping_std_1_s,decrement,force_{f},omega0_within_rad_s,hysteresis_1_s2,congruent_amplitude_{x},"
    "congruent_restoring_{x}_s2,congruent_restoring_std_{x}_s2,peak_above_{x},peak_below_{x},frequency_above_Hz,"
    "frequency_below_Hz\n"
)


def curves_csv(analysis: HilbertAnalysis, recordings: Sequence[Recording]) -> str:
    """All curves over time, eight rows a cycle, as CSV with a header that names columns and units."""
    from ...model import Response

    unit = Response(recordings[0].quantity, recordings[0].unit).displacement_unit
    out = io.StringIO()
    out.write(_HEAD.format(x=unit, f=force_unit_of(recordings)))
    for i, curve in enumerate(analysis.curves):
        step = _step(curve)
        numbers = np.column_stack(
            [
                curve.time,
                curve.amplitude,
                curve.omega / (2 * np.pi),
                curve.phase,
                curve.omega0,
                curve.omega0_std,
                curve.damping,
                curve.damping_std,
                curve.decrement,
                curve.force,
                *_within(curve),
            ]
        )[::step]
        name = '"' + curve.recording.replace('"', '""') + '"'
        for row in numbers:
            cells = ",".join(f"{value:.9g}" if math.isfinite(value) else "" for value in row)
            out.write(f"{name},{curve.method},{i + 1},{cells}\n")
    return out.getvalue()


def force_unit_of(recordings: Sequence[Recording]) -> str:
    """Unit of what drives; N where nothing does."""
    return next((r.force_unit for r in recordings if r.force is not None), "N")


def _within(curve: ModalCurve) -> list[np.ndarray]:
    """Eq. 5, congruent curve and half-waves of a decay, as the header has them; not a number under a force."""
    cycle = curve.within
    if cycle is None:
        return [np.full(curve.time.size, np.nan)] * 9
    halves = (*cycle.peaks, *(cycle.omega / (2 * np.pi)))
    return [cycle.omega0, cycle.hysteresis, cycle.amplitude, cycle.restoring, cycle.restoring_std, *halves]


def _step(curve: ModalCurve) -> int:
    if curve.time.size < 2:
        return 1
    sample = float(np.median(np.diff(curve.time)))
    return max(1, int(2 * np.pi / (float(np.median(curve.omega)) * sample * _A_CYCLE)))


def as_json(analysis: HilbertAnalysis, recordings: Sequence[Recording]) -> dict[str, Any]:
    """The laws, their errors and what they come from, for a strict JSON file: what is not known is null."""
    from ...model import Response

    unit = Response(recordings[0].quantity, recordings[0].unit).displacement_unit
    compose = partial(units.compose, force=force_unit_of(recordings))
    curves = []
    for i, curve in enumerate(analysis.curves):
        low, high = int(np.argmin(curve.amplitude)), int(np.argmax(curve.amplitude))
        curves.append(
            {
                "stretch": i + 1,
                "recording": curve.recording,
                "method": curve.method,
                "samples": [curve.start, curve.stop],
                "time_s": [float(curve.time[0]), float(curve.time[-1])],
                "amplitude": {"min": float(curve.amplitude[low]), "max": float(curve.amplitude[high]), "unit": unit},
                "decrement": {
                    "at_min_amplitude": finite(curve.decrement[low]),
                    "at_max_amplitude": finite(curve.decrement[high]),
                },
                "within_the_cycle": _largest(curve, unit, high),
                "fit": None if curve.fit is None else _fit(curve.fit, unit, compose),
            }
        )
    result: dict[str, Any] = {
        "format": "dashpot-hilbert/1",
        "software": f"dashpot {__version__}",
        "recordings": [{"file": r.name, "sha256": r.sha256} for r in recordings],
        "stretches": curves,
    }
    for method in ("freevib", "forcevib"):
        fit = getattr(analysis, method)
        result[method] = None if fit is None else _fit(fit, unit, compose) | {"spread": analysis.spread(method)}
    return result | {"notes": list(analysis.notes)}


def _largest(curve: ModalCurve, unit: str, at: int) -> dict[str, Any] | None:
    """What is within a cycle where the amplitude is largest; the CSV file has it at every instant."""
    cycle = curve.within
    if cycle is None:
        return None
    sizes = np.abs(cycle.harmonics[:, at])
    return {
        "at_amplitude": float(curve.amplitude[at]),
        "harmonics": {str(n): float(size) for n, size in zip(cycle.orders, sizes, strict=True)},
        "harmonics_std": float(cycle.harmonics_std[at]),
        "congruent": {
            "amplitude": {"value": float(cycle.amplitude[at]), "unit": unit},
            "restoring": {
                "value": float(cycle.restoring[at]),
                "std": float(cycle.restoring_std[at]),
                "unit": f"{unit}/s2",
            },
        },
        "half_waves": {
            side: {"peak": float(peak[at]), "frequency_hz": float(omega[at] / (2 * np.pi))}
            for side, peak, omega in zip(("above", "below"), cycle.peaks, cycle.omega, strict=True)
        },
    }


def _fit(fit: ModalFit, unit: str, compose: Any) -> dict[str, Any]:
    laws = [law for law in (fit.preload, fit.polynomial, fit.both, fit.damping) if law is not None]
    mass = {} if fit.mass is None else _values({"mass": fit.mass}, {"mass": fit.mass_std}, unit, compose)
    return {
        **mass,
        **_values(fit.derived, fit.derived_std, unit, compose),
        "laws": [_law(law, unit, compose) for law in laws],
    }


def _law(law: LawFit, unit: str, compose: Any) -> dict[str, Any]:
    return {
        "law": law.law,
        "parameters": _values(law.values, law.stds, unit, compose),
        "misfit": finite(law.misfit),
        "over_noise": finite(law.over_noise),
    }


def _values(values: Mapping[str, float], stds: Mapping[str, float], unit: str, compose: Any) -> dict[str, Any]:
    return {
        name: {"value": finite(value), "std": finite(stds[name]), "unit": compose(UNITS[name], unit)}
        for name, value in values.items()
    }


def shown_value(
    name: str, value: float, std: float | None, unit: str, force: str, length: InUnit | None = None
) -> Parameter:
    """A value of ``UNITS`` for a person, without an error where that is not known.

    Args:
        name, value, std: in SI.
        unit, force: of the displacement, and of what drives.
        length: factor and unit in which lengths are shown, where that is another.
    """
    factor, shown_in = (
        (1.0, units.compose(UNITS[name], unit, force)) if length is None or UNITS[name] != "X" else length
    )
    return Parameter(factor * value, None if std is None or not math.isfinite(std) else factor * std, shown_in)


def of_errors(fit: ModalFit) -> str:
    """Why a fit states no errors, as the end of a sentence; empty where it states them."""
    return "" if fit.has_errors else ": other physics moves the rig, no error would hold, and none is stated"


def describe(analysis: HilbertAnalysis, recordings: Sequence[Recording]) -> str:
    """The parameters of both methods as text, one line each, lengths in the unit that was recorded."""
    from ...model import Response
    from ...recording.as_recorded import of_length

    unit, force = Response(recordings[0].quantity, recordings[0].unit).displacement_unit, force_unit_of(recordings)
    length = of_length(recordings, unit)
    lines = []
    for method, what in (("freevib", "free decay"), ("forcevib", "driven stretch")):
        fit = getattr(analysis, method)
        if fit is None:
            continue
        lines.append(f"{method.upper()}, {so_many(len(analysis.of(method)), what)}")
        values, stds = {**fit.values, **fit.derived}, {**fit.stds, **fit.derived_std}
        cells = []
        for name, value in values.items():
            p = shown_value(name, value, stds[name], unit, force, length)
            number, error = value_and_error(p) if p.std else (f"{p.value:.4g}", "")
            cells.append((name, number, f"± {error}" if error else "", p.unit))
        lines += columns_text(cells)
        lines.append(f"  Eqs. 1, 6 and 7 leave {times_words(fit.over_noise)} times the noise{of_errors(fit)}.")
    return "\n".join(lines)


def so_many(count: int, what: str) -> str:
    """``1 free decay``, ``3 driven stretches``."""
    plural = f"{what}{'es' if what.endswith('ch') else 's'}"
    return f"{count} {what if count == 1 else plural}"
