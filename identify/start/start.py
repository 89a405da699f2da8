"""Start values of Eq. 17 from recordings of any kind: by regression, else from Hilbert curves, else from the spectrum.

One regression over all recordings (`regression`), the Hilbert transform in a windowed form, needs no detour over an
amplitude. Where it works its values are the start, because it loses nothing at the ends of a decay, where the cubic and
the preload show themselves. Every decay also gives a FREEVIB backbone and damping curve, every forced record
mass and curves by a regression over its amplitude (`forced_regression`); Eq. 17 fitted to all curves together is the
start where the regression fails, and the largest line of the spectrum where there is no curve either.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...errors import BadInput
from ...model import Oscillator, Response
from ...recording.continuity import is_switched
from ...recording.recording import WHOLE
from ..hilbert.curves import BackboneFit, DampingFit, backbone_omega0, fit_backbone, fit_damping
from ..hilbert.forced_regression import forced_regression
from ..hilbert.freevib import freevib
from ..motion.decays import Decay, find_free_motion
from ..motion.displacement import displacement
from ..motion.envelope import motion_frequency
from ..signals.odds import SIGNIFICANT
from ..signals.registry import numerics
from ..signals.signals import Signal, drive_of, response_of
from .limits import SAME_SPRING
from .regression import RegressionStart, Rows, Segment, regress_rows, segment_rows

_REACH = numerics(0.999, "of the samples", why="the largest displacement, but for single samples")
_LEAST_DAMPING = numerics(1e-3, "of the frequency", why="a start that is not undamped")
_LEAST_ERROR = numerics(1e-9, "of the mass", why="rounding")

if TYPE_CHECKING:
    from ...recording.recording import Recording

_PLAIN_DAMPING = numerics(
    0.02, "of the frequency", why="a hundredth of the critical damping, where nothing is known of it"
)


@dataclass(frozen=True)
class Curve:
    """Backbone and damping curve from one decay (`freevib`) or forced record (`forced_regression`); arrays are (n,)."""

    recording: str
    method: str  # "freevib" | "regression"
    start: int  # the samples it comes from
    stop: int
    amplitude: np.ndarray
    omega0: np.ndarray  # rad/s
    damping: np.ndarray  # h0, 1/s
    omega0_std: np.ndarray
    damping_std: np.ndarray
    per_point: float  # independent values per point
    mass: float | None = None  # the regression's
    mass_std: float = float("inf")


@dataclass(frozen=True)
class HilbertEstimate:
    """Parameters of Eq. 17 (SI, per unit mass) with standard deviations, and what they come from.

    A standard deviation of infinity means that nothing in the recordings says anything about the parameter.
    """

    mass: float | None  # kg; None when no record has a force
    omega0: float  # rad/s
    cubic: float  # 1/(m2 s2)
    preload: float  # m/s2
    viscous: float  # 1/s
    dry: float  # m/s2
    mass_std: float
    omega0_std: float
    cubic_std: float
    preload_std: float
    viscous_std: float
    dry_std: float
    source: str  # "regression" | "curves" | "spectrum"
    curves: tuple[Curve, ...]
    decays: tuple[tuple[Decay, ...], ...]  # of each recording
    backbone: BackboneFit | None  # Eq. 6 family on all curves
    damping: DampingFit | None  # Eq. 7 family on all curves
    regression: RegressionStart | None
    linear: RegressionStart | None  # the same of a linear rig
    notes: tuple[str, ...]


def hilbert_start(recordings: Sequence[Recording], *, curves_too: bool = True) -> HilbertEstimate:
    """Estimate Eq. 17 from `recordings` (displacement, velocity or acceleration, free or forced, in any mixture).

    Without ``curves_too`` none are made where the regression works: they take most of the time. Whatever cannot be used
    is passed over with a note. Raises BadInput only when there is no recording, or none of them oscillates.
    """
    if not recordings:
        raise BadInput("No recording given; give at least one free decay or forced record.")
    notes: list[str] = []
    curves: list[Curve] = []
    segments: list[Segment] = []
    decays: list[tuple[Decay, ...]] = []
    motions: list[Segment] = []
    lines: list[float] = []
    ringing: list[float] = []  # between the steps of a switched force
    for r in recordings:
        motion = find_free_motion(r)
        free_decays = motion.decays
        notes += motion.notes
        decays.append(free_decays)
        try:
            x = displacement(r)
        except BadInput as problem:
            notes.append(f"{r.name}: {problem}")
            continue
        drive = drive_of(r)
        unknown = motion.blows and not any(blow.is_known for blow in motion.blows)
        if drive is not None and (np.ptp(drive.samples) == 0 or (free_decays and drive.is_silent) or unknown):
            drive = None
        motions.append(Segment(x, drive))
        longest = max(free_decays, key=lambda d: d.stop - d.start) if drive is None and free_decays else None
        lines.append(_line(r, x if longest is None else x.part(longest.start, longest.stop)))
        if _is_switched(r):
            ringing.append(2 * np.pi * lines[-1])
        if drive is None and not free_decays:
            notes.append(f"{r.name}: no force and no free decay found in it; it was not used for the start values.")
        for d in free_decays if curves_too else ():
            curves += _freevib_curve(r, x, d, notes)
        if drive is not None:
            segments.append(motions[-1])
            # with much free ringing in it the force says little, and the decays have told their part
            if curves_too and sum(d.stop - d.start for d in free_decays) < r.n / 2:
                curves += _regressed_curve(r, x, drive, notes)
        else:
            segments += [Segment(x.part(d.start, d.stop), None) for d in free_decays]
    if not motions:
        raise BadInput("No recording oscillates; " + " ".join(notes))
    backbone, damping = _fit_curves(curves, notes)
    regression, linear = _regression(segments, notes)
    if regression is not None and ringing and abs(np.log2(regression.omega0 / np.median(ringing))) > 1:
        regression = linear = None  # no force in steps drives a line: what rings there is the rig
    if not curves_too and (regression is None or (segments and regression.mass is None)):
        return hilbert_start(recordings)
    return _combine(motions, lines, curves, tuple(decays), backbone, damping, regression, linear, notes)


def estimated(hilbert: HilbertEstimate, recordings: Sequence[Recording], name: str) -> Oscillator:
    """Eq. 17 with the values estimated from the recordings."""
    first = recordings[0]
    known = {key: getattr(hilbert, key) for key in ("mass", "omega0", "cubic", "preload", "viscous", "dry")}
    return Oscillator.from_values(
        known | ({"mass": 1.0} if any(recording.base == WHOLE for recording in recordings) else {}),
        name=name,
        response=Response(first.quantity, first.unit),
        force_unit=next((r.force_unit for r in recordings if r.force is not None), "N"),
    )


def plain_starts(estimate: HilbertEstimate, recordings: Sequence[Recording]) -> list[dict[str, float]]:
    """Linear rigs to start from where the estimate leads nowhere: what is known of them, the most likely first.

    By regression; at the backbone's frequency; at that of the largest line.
    """
    lines = [_line(r, response_of(r)) for r in recordings]
    omegas = [2 * np.pi * float(np.median(lines))]
    if estimate.backbone is not None:
        omegas.insert(0, float(estimate.backbone.omega0))
    starts = [{"omega0": omega, "viscous": _PLAIN_DAMPING * omega} for omega in omegas]
    if (decaying := _of_decays(estimate.decays)) is not None:
        starts.insert(0, decaying)
    linear = estimate.linear
    if linear is not None:
        known = {"omega0": linear.omega0, "viscous": max(linear.viscous, _LEAST_DAMPING * linear.omega0)}
        starts.insert(0, known | ({} if linear.mass is None else {"mass": linear.mass}))
    return starts


def _freevib_curve(r: Recording, x: Signal, d: Decay, notes: list[str]) -> list[Curve]:
    try:
        f = freevib(x.part(d.start, d.stop))
    except BadInput as problem:
        notes.append(f"{r.name}, decay at {d.start / r.fs:.4g} s: {problem}")
        return []
    shape = (f.amplitude, f.omega0, f.damping, f.omega0_std, f.damping_std, f.per_point)
    return [Curve(r.name, "freevib", d.start, d.stop, *shape)]


def _regressed_curve(r: Recording, x: Signal, drive: Signal, notes: list[str]) -> list[Curve]:
    try:
        f = forced_regression(x, drive)
    except BadInput as problem:
        notes.append(f"{r.name}: {problem}")
        return []
    shape = (f.amplitude, f.omega0, f.damping, f.omega0_std, f.damping_std, f.per_point)
    return [Curve(r.name, "regression", 0, r.n, *shape, f.mass, f.mass_std)]


def _fit_curves(curves: list[Curve], notes: list[str]) -> tuple[BackboneFit | None, DampingFit | None]:
    """The Eq. 17 family on all curves together, every point weighed by what it says that its neighbours do not."""
    if not curves:
        return None, None
    a, w, h = (np.concatenate([getattr(c, k) for c in curves]) for k in ("amplitude", "omega0", "damping"))
    part = np.concatenate([np.full(c.amplitude.size, c.per_point) for c in curves])
    w_weight = part / np.concatenate([c.omega0_std for c in curves]) ** 2
    h_weight = part / np.concatenate([c.damping_std for c in curves]) ** 2
    independent = float(np.sum(part))
    try:
        return fit_backbone(a, w, w_weight, independent), fit_damping(a, w, h, h_weight, independent)
    except BadInput as problem:
        notes.append(str(problem))
        return None, None


def _regression(segments: list[Segment], notes: list[str]) -> tuple[RegressionStart | None, RegressionStart | None]:
    """Eq. 17 and a linear rig regressed on all segments; None where that cannot be."""
    rows: list[Rows] = []
    for s in segments:
        try:
            rows.append(segment_rows(s))
        except BadInput as problem:
            notes.append(
                f"A stretch of {s.displacement.n / s.displacement.fs:.4g} s was left out of the regression: {problem}"
            )
    regressions: list[RegressionStart | None] = [None, None]
    for place, linear in enumerate((False, True)):
        try:
            regressions[place] = regress_rows(rows, linear=linear) if rows else None
        except BadInput as problem:
            if not linear:
                notes.append(str(problem))
    return regressions[0], regressions[1]


def _of_decays(decays: Sequence[Sequence[Decay]]) -> dict[str, float] | None:
    """A linear rig by the frequencies and the falls of the decays of which they are known: of the longest."""
    known = [d for some in decays for d in some if d.omega is not None and d.rate is not None]
    if not known:
        return None
    longest = max(known, key=lambda d: d.stop - d.start)
    return {"omega0": float(longest.omega or 0.0), "viscous": max(2 * float(longest.rate or 0.0), 0.0)}


def _line(recording: Recording, signal: Signal) -> float:
    """Frequency in Hz of the largest line of a recording's motion, whatever rests elsewhere or drifts beneath it.

    Args:
        recording: where its force is switched the rig goes from one rest to the next, which is a larger line than the
            ringing around it, but not in the velocity.
        signal: its response, or the displacement that this makes.
    """
    if _is_switched(recording):
        signal = response_of(recording)
        moved = np.diff(signal.samples) if recording.quantity == "displacement" else signal.samples
        return motion_frequency(moved, signal.fs) or signal.frequency
    return motion_frequency(signal.samples, signal.fs) or signal.frequency


def _is_switched(recording: Recording) -> bool:
    return recording.force is not None and is_switched(np.asarray(recording.force, float))


def _combine(
    motions: list[Segment],
    lines: list[float],
    curves: list[Curve],
    decays: tuple[tuple[Decay, ...], ...],
    backbone: BackboneFit | None,
    damping: DampingFit | None,
    regression: RegressionStart | None,
    linear: RegressionStart | None,
    notes: list[str],
) -> HilbertEstimate:
    inf = float("inf")
    value: dict[str, float] = dict.fromkeys(("omega0", "cubic", "preload", "viscous", "dry"), 0.0)
    std: dict[str, float] = dict.fromkeys(value, inf)
    mass, mass_std = _curve_mass(curves)
    with_rig = [d for some in decays for d in some if d.rig is not None]
    if regression is None and with_rig and all(m.force is None for m in motions):
        source = "pieces"
        value |= max(with_rig, key=lambda d: d.stop - d.start).rig or {}
    elif regression is not None:
        source = "regression"
        value = {k: float(getattr(regression, k)) for k in value}
        std = {k: float(getattr(regression, k + "_std")) for k in value}
        if regression.mass is not None and 2 * regression.mass_std < regression.mass:
            mass, mass_std = regression.mass, regression.mass_std
    elif backbone is not None and damping is not None:
        source = "curves"
        fits = {**vars(backbone), **vars(damping)}
        value = {k: fits[k] for k in value}
        std = {k: fits[k + "_std"] for k in value}
    else:
        source = "spectrum"
        if (known := _of_decays(decays)) is not None:
            value |= known
        else:
            value["omega0"] = 2 * np.pi * float(np.median(lines))
            value["viscous"] = _PLAIN_DAMPING * value["omega0"]
            notes.append(
                "No decay and no forced record could be evaluated: omega0 is the largest line of the spectrum."
            )
    moved = [m.displacement.samples for m in motions]
    reach = max(float(np.quantile(np.abs(x - np.median(x)), _REACH)) for x in moved)
    _make_safe(value, reach, backbone, damping, notes)
    if mass is None and any(m.force is not None for m in motions):
        mass = _static_mass(motions, value["omega0"])
        notes.append(
            "No mass came out of the forced records; "
            + (
                "the start is force over response in size."
                if mass
                else "the response moves no further than its noise in them."
            )
        )
    apart = _apart(curves, value)
    if apart > SAME_SPRING:
        notes.append(
            f"Backbone curves and regression differ by {100 * apart:.2g} % over most of the amplitudes: this may not "
            "be one oscillator of the Eq. 17 family."
        )
    return HilbertEstimate(
        mass=mass,
        mass_std=mass_std,
        **value,
        **{f"{k}_std": s for k, s in std.items()},
        source=source,
        curves=tuple(curves),
        decays=decays,
        backbone=backbone,
        damping=damping,
        regression=regression,
        linear=linear,
        notes=tuple(notes),
    )


def _apart(curves: Sequence[Curve], value: Mapping[str, float]) -> float:
    """By which part of itself the natural frequency at an amplitude differs, as a median over what the curves cover.

    Not by that at no amplitude at all, which curves and regression extrapolate to each in its own way; nor at the
    smallest amplitudes, where a curve of an integrated acceleration shows what the integration drifts by.
    """
    if not curves:
        return 0.0
    amplitude, measured = (
        np.concatenate([getattr(curve, name) for curve in curves]) for name in ("amplitude", "omega0")
    )
    expected = backbone_omega0(amplitude, value["omega0"], value["cubic"], value["preload"])
    ratio = np.abs(measured / expected - 1.0)
    ratio = ratio[np.isfinite(ratio)]
    return float(np.median(ratio)) if ratio.size else 0.0


def _curve_mass(curves: list[Curve]) -> tuple[float | None, float]:
    masses = [(c.mass, c.mass_std) for c in curves if c.mass is not None and np.isfinite(c.mass_std)]
    if not masses:
        return None, float("inf")
    mass, std = np.array(masses).T
    weight = 1 / np.maximum(std, _LEAST_ERROR * mass) ** 2
    return float(np.sum(weight * mass) / np.sum(weight)), float(1 / np.sqrt(np.sum(weight)))


def _static_mass(motions: list[Segment], omega0: float) -> float | None:
    """Mass from the size of force and response, for want of better: rms(F) / (omega0^2 rms(x)), within its gain."""
    ratios = [
        float(np.std(m.force.samples) / (omega0**2 * np.std(m.displacement.samples)))
        for m in motions
        if m.force is not None and np.std(m.displacement.samples) > SIGNIFICANT * m.displacement.noise
    ]
    return float(np.median(ratios)) if ratios else None


def _make_safe(
    value: dict[str, float],
    reach: float,
    backbone: BackboneFit | None,
    damping: DampingFit | None,
    notes: list[str],
) -> None:
    """Keep the start simulable over the recorded amplitudes, and say what looks like another model family."""
    for k in ("preload", "dry"):  # a start that pushes the mass away from rest, or feeds it, leads astray
        value[k] = max(value[k], 0.0)
    if value["omega0"] ** 2 + value["cubic"] * reach**2 <= 0:
        notes.append(
            "The softening cubic would make the spring pull outward within the recorded amplitudes; start at 0."
        )
        value["cubic"] = 0.0
        if backbone is not None:
            value["omega0"] = float(backbone.omega0)
    if not value["viscous"] > 0:
        fallback = damping.viscous if damping is not None and damping.viscous > 0 else 1e-3 * value["omega0"]
        notes.append(f"The viscous damping came out as {value['viscous']:.3g} 1/s; start at {fallback:.3g} 1/s.")
        value["viscous"] = float(fallback)
