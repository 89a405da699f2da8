"""FREEVIB and FORCEVIB as results: curves over time, laws fitted to them, errors; one call for a rig's recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import BadInput
from ...model.fit_state import LACKING, times_words
from ...recording.given import recordings_of
from ...simulate.threads import pool
from ..motion.decays import find_free_motion
from ..motion.displacement import displacement
from ..motion.excitation import kind_of
from ..motion.force_off import zero_of
from ..signals.limits import CLEAR_OF_NOISE, SEVERAL
from ..signals.registry import numerics
from ..signals.signals import Signal, drive_of
from .instantaneous import modal_parameters
from .limits import KERNELS_A_VALUE
from .mass_by_laws import driven_mass
from .modal_fit import modal_fit
from .modal_mass import MassFit, agreed
from .modal_result import ModalCurve, ModalFit
from .modal_stretch import Stretch, decay_stretch, forced_stretch
from .run_out import before_stop, held
from .within_the_cycle import within_the_cycle

if TYPE_CHECKING:
    from ...recording.recording import Recording

_RESOLVED = numerics(1e-6, "part of the largest reading", why="that a sensor of force resolves")


@dataclass(frozen=True, eq=False, repr=False)
class HilbertAnalysis:
    """What the Hilbert transform alone says of a rig.

    Attributes:
        curves: one of each decay (FREEVIB) and of each driven stretch (FORCEVIB), in order of the recordings.
        freevib: Eqs. 1, 6, 7 fitted to all decays together; None without one.
        forcevib: the same of all driven stretches, with the mass; None without one.
        notes: one sentence each on what was left out and why.
    """

    curves: tuple[ModalCurve, ...]
    freevib: ModalFit | None
    forcevib: ModalFit | None
    notes: tuple[str, ...]

    def __repr__(self) -> str:
        counts = f"{len(self.of('freevib'))} decays, {len(self.of('forcevib'))} driven stretches"
        return f"<HilbertAnalysis of {counts}>"

    def of(self, method: str) -> tuple[ModalCurve, ...]:
        """The curves of ``freevib`` or ``forcevib``."""
        return tuple(curve for curve in self.curves if curve.method == method)

    def of_one_mode(self, of_modes: Sequence[str], isolated: bool) -> HilbertAnalysis:
        """The same with what was said of the recordings' modes; a band that isolated one left no harmonics of it."""
        curves = tuple(replace(curve, within=None) for curve in self.curves) if isolated else self.curves
        return replace(self, curves=curves, notes=(*of_modes, *self.notes))

    def spread(self, method: str) -> dict[str, float]:
        """Standard deviation of each parameter from stretch to stretch; empty below three of them.

        It owes nothing to what is known of the noise: beside the standard error of a single stretch it shows whether
        that error is right, and whether the rig stays the same.
        """
        fits = [curve.fit.values for curve in self.of(method) if curve.fit is not None]
        if len(fits) < SEVERAL:
            return {}
        return {name: float(np.std([fit[name] for fit in fits], ddof=1)) for name in fits[0]}


def hilbert_analysis(recordings: Sequence[Recording] | Any) -> HilbertAnalysis:
    """FREEVIB on every free decay and FORCEVIB on every driven stretch of recordings of one rig.

    Feldman, Bucher, Rotberg 2009: Eqs. 9-12 for the curves, Eqs. 1, 6, 7 for the laws; with a force Feldman 1994.
    Arrays make a recording: ``hilbert_analysis([Recording("decay", 1000.0, x)])`` with x (n,) in m, sampled at 1000 Hz.

    Args:
        recordings: displacement, velocity or acceleration, free or forced, in any mixture; or what
            ``recordings_of`` reads.

    Returns:
        Curves with arrays of shape (n,) in SI, and the laws fitted to them with standard errors.

    Raises:
        BadInput: no recording is given, or none holds a decay or a driven stretch that can be evaluated.
    """
    recordings = recordings_of(recordings)
    if not recordings:
        raise BadInput("No recording given; give at least one free decay or forced record.")
    asked: list[_Asked | str] = []
    for r in recordings:
        try:
            x = displacement(r)
        except BadInput as problem:
            asked.append(f"{r.name}: {problem}")
            continue
        motion = find_free_motion(r)
        asked += motion.notes
        asked += [_Asked(r, _alone(r, x, d.start, d.stop), None, (d.start, d.stop)) for d in motion.decays]
        drive = drive_of(r)
        if drive is None or np.ptp(drive.samples) == 0 or drive.is_silent:
            if not motion.decays:
                asked.append(f"{r.name}: no force and no free decay found in it; it was left aside.")
        elif motion.blows:
            asked.append(f"{r.name}: the blows are too short for FORCEVIB; what rings after them is evaluated.")
        elif kind_of(r, motion.decays, drive.noise) == "broadband":
            asked.append(f"{r.name}: no single frequency drives it, which FORCEVIB needs; record a slow sweep.")
        else:
            asked += [_Asked(r, x.part(*samples), drive, samples) for samples in _between(motion.decays, r.n)]
    results = list(pool().map(lambda one: (None, [one]) if isinstance(one, str) else _evaluated(one), asked))
    found = [evaluated for evaluated, _ in results if evaluated is not None]
    free, forced = ([e for e in found if (e.mass is None) == is_free] for is_free in (True, False))
    notes = [note for _, words in results for note in words]
    if not free and not forced:
        raise BadInput("Nothing can be evaluated by the Hilbert transform. " + " ".join(notes))
    (freevib, of_free), (forcevib, of_forced) = pool().map(_together, (free, forced))
    return HilbertAnalysis(
        curves=tuple(stretch.curve for stretch in (*free, *forced)),
        freevib=freevib,
        forcevib=forcevib,
        notes=tuple(dict.fromkeys((*notes, *of_free, *of_forced))),
    )


def analysis_or_none(recordings: Sequence[Recording]) -> HilbertAnalysis:
    """The same; empty, with a note, where nothing can be evaluated."""
    try:
        return hilbert_analysis(recordings)
    except BadInput as problem:
        return HilbertAnalysis((), None, None, (str(problem),))


@dataclass(frozen=True, eq=False)
class _Asked:
    """A stretch of a recording, by its first and last sample but one: its displacement, and what drives the whole."""

    recording: Recording
    displacement: Signal
    drive: Signal | None
    samples: tuple[int, int]


@dataclass(frozen=True, eq=False)
class _Evaluated:
    """A stretch with its curve; with its mass where it is driven."""

    stretch: Stretch
    curve: ModalCurve
    mass: MassFit | None


def _alone(recording: Recording, whole: Signal, start: int, stop: int) -> Signal:
    """Displacement of a decay, integrated from its own beginning: a pluck before it is a jump to any integral."""
    if recording.quantity == "displacement":
        return whole.part(start, stop)
    try:
        return displacement(recording.slice(start, stop))
    except BadInput:  # too short to find its own frequency
        return whole.part(start, stop)


def _between(decays: Sequence, n: int) -> list[tuple[int, int]]:
    """What lies between the decays: start and stop of each driven stretch."""
    edges = [0, *(edge for d in decays for edge in (d.start, d.stop)), n]
    return [(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if b > a]


def _pushed(drive: Signal, start: int, stop: int) -> tuple[int, int]:
    """Of these samples those from the first to the last at which the force is not its zero; none: both the same."""
    zero, _ = zero_of(drive.samples, max(2, round(drive.fs / drive.frequency)))
    beyond = max(CLEAR_OF_NOISE * drive.noise, _RESOLVED * float(np.max(np.abs(drive.samples - zero))))
    loud = np.flatnonzero(np.abs(drive.samples[start:stop] - zero) > beyond)
    return (start + int(loud[0]), start + int(loud[-1]) + 1) if loud.size else (start, start)


def _evaluated(asked: _Asked) -> tuple[_Evaluated | None, list[str]]:
    """The curve of a stretch, None where it has none, and what a user should know."""
    r, drive, samples = asked.recording, asked.drive, asked.samples
    notes: list[str] = []
    begin = r.start + samples[0] / r.fs
    try:
        if drive is not None:
            samples = _pushed(drive, *samples)
            if samples[0] == samples[1]:
                return None, []
            begin = r.start + samples[0] / r.fs
        part = asked.displacement.part(samples[0] - asked.samples[0], samples[1] - asked.samples[0])
        mass = driven = None
        if drive is None:
            stretch = before_stop(decay_stretch(part))
        else:
            driven = driven_mass(forced_stretch(part, drive.part(*samples)))
            stretch, mass = driven.stretch, driven.mass
            if driven.by_laws:
                notes.append(
                    f"{r.name}, driven stretch at {begin:.4g} s: it meets no amplitude at two frequencies, so that its "
                    "mass leans on Eqs. 1, 6 and 7; drive it through its resonance for one that does not."
                )
        curve = modal_curve(stretch, mass, r.name, samples, begin, part.samples)
        if driven is not None and not driven.hold:
            notes.append(f"{r.name}, driven stretch at {begin:.4g} s: {_why_not(curve, driven.misfit)}")
    except BadInput as problem:
        what = "decay" if drive is None else "driven stretch"
        return None, [*notes, f"{r.name}, {what} at {begin:.4g} s: {problem}"]
    return _Evaluated(stretch, curve, mass), notes


def _why_not(curve: ModalCurve, misfit: float) -> str:
    """Why the laws miss a driven motion: it is swept so fast that the rig rings beside the drive, or other physics.

    What rings at a frequency that is passed dies as exp(-h t): the half-power width, h/pi, is to take longer than 1/h.
    """
    rate = float(np.ptp(curve.omega)) / (2 * np.pi) / float(np.ptp(curve.time))
    slow = float(np.median(curve.damping)) ** 2 / np.pi
    left = float(np.sqrt(misfit))
    errors = "no errors of its parameters are stated" if left > LACKING else "the errors of its parameters are wider"
    how = f"Eqs. 1, 6 and 7 leave {times_words(left)} times its noise, so that {errors}; "
    if slow > 0 and rate > slow:
        return (
            f"{how}it is swept at {rate:.2g} Hz/s, so that the rig rings beside its drive: sweep no faster than "
            f"{slow:.2g} Hz/s"
        )
    return f"{how}other physics moves it: see dashpot diagnose"


def _together(found: Sequence[_Evaluated]) -> tuple[ModalFit | None, list[str]]:
    """One fit to all stretches of a method, None without one, and why there is none."""
    if len(found) < 2 and all(f.curve.fit is not None for f in found):
        return (found[0].curve.fit if found else None), []  # one alone is all
    masses = [f.mass for f in found if f.mass is not None]
    try:
        return modal_fit([f.stretch for f in found], agreed(masses) if masses else None), []
    except BadInput as problem:
        return None, [str(problem)]


# FORCEVIB: mass, natural frequency and damping of a driven motion, instant by instant.


def modal_curve(
    stretch: Stretch,
    mass: MassFit | None,
    recording: str,
    samples: tuple[int, int],
    begin: float,
    displacement: np.ndarray | None = None,
) -> ModalCurve:
    """The curves of one stretch: by FREEVIB where nothing drives it, else by FORCEVIB with the mass given.

    Args:
        stretch: displacement, and force where it is driven.
        mass: of this stretch alone, from ``mass_fit``; None for a decay.
        recording: name.
        samples: start and stop of the stretch in it.
        begin: time of the stretch's first sample, s.
        displacement: the samples (m,) that a decay was made from, for what happens within its cycles; None: not asked.

    Raises:
        BadInput: nothing in it stands clear of its noise.
    """
    inverse = 0.0 if mass is None else mass.inverse
    s = stretch.signal
    squared, damping = modal_parameters(s, stretch.ratio, inverse)
    low = stretch.low_pass(np.stack([squared, damping, s.omega]))
    variance = stretch.point_variance(squared, damping, inverse)
    of_damping = variance / s.omega[stretch.keep] ** 2
    force = np.zeros(s.time.size)
    if mass is not None and stretch.ratio is not None:  # an error of the mass moves all points together
        of_mass = stretch.low_pass(np.real(stretch.ratio)), stretch.low_pass(np.imag(stretch.ratio) / s.omega)
        variance = variance + (of_mass[0] * mass.std) ** 2
        of_damping = of_damping + (of_mass[1] * mass.std) ** 2
        force = np.abs(stretch.ratio) * s.amplitude
    good = stretch.clear & (low[0] > 0) & (low[2] > 0)
    if not np.any(good):
        raise BadInput(
            "nothing in it stands clear of its noise with an amplitude that changes slowly; record a larger motion"
        )
    try:
        fit = modal_fit([stretch], mass)
    except BadInput:
        fit = None
    keep = stretch.keep
    if fit is not None:
        low[:2] += _bent_off(stretch, fit)
        good &= low[0] > 0
    omega0 = np.sqrt(low[0][good])
    rest = 0.0 if fit is None else held(fit.values["omega0"] ** 2, fit.values["preload"], fit.values["dry"])
    amplitude, phase = stretch.smooth_motion if stretch.ratio is None else (stretch.amplitude[keep], s.phase[keep])
    return ModalCurve(
        recording=recording,
        method="freevib" if stretch.ratio is None else "forcevib",
        start=samples[0],
        stop=samples[1],
        time=begin + s.time[keep][good],
        amplitude=amplitude[good],
        phase=phase[good],
        omega=low[2][good],
        omega0=omega0,
        damping=low[1][good],
        omega0_std=np.sqrt(variance[good]) / (2 * omega0),
        damping_std=0.5 * np.sqrt(of_damping[good]),
        force=force[keep][good],
        # the kernels' effective length is a third of their joint length
        independent=min(1.0, KERNELS_A_VALUE / (s.kernel + stretch.low_pass_kernel.size)),
        fit=fit,
        within=None
        if displacement is None or mass is not None
        else within_the_cycle(stretch, displacement, good, rest),
        cut=stretch.run_out / stretch.fs,
    )


def _bent_off(stretch: Stretch, fit: ModalFit) -> np.ndarray:
    """What the low-passes take off omega0² and h, (2, k), as the fitted laws have it: much near rest, else nothing."""
    first, keep = stretch.signal.equation_first, stretch.keep
    a, values = np.maximum(stretch.amplitude, np.finfo(float).tiny), fit.values
    spring = values["omega0"] ** 2 + 0.75 * values["cubic"] * a**2 + 4 * values["preload"] / (np.pi * a)
    friction = 0.5 * values["viscous"] + 2 * values["dry"] / (np.pi * a * np.abs(first))
    seen = np.real(stretch.passed(spring[None])[0]), np.imag(stretch.passed(friction[None], first)[0]) / np.imag(first)
    return np.stack([spring, friction])[:, keep] - stretch.low_pass(np.stack(seen))
