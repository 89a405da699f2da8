"""How the force ran between its samples, where nobody said: the hold that the recordings ask for.

A hold is a known filter: what is held lags by half a sample and loses (pi f dt)²/6 of its size, straight lines lose
twice that and do not lag. A fit under a wrong hold takes the loss for mass and the lag for damping (Pintelon and
Schoukens 2012: what is assumed of the force between samples is part of the model). So the same model is fitted under
each hold, and the likelihoods decide. Physics that the model lacks may lie nearer to one hold than to another by
chance: no hold is believed whose residual asks for a further lag or a further loss of the force.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from ...model import Oscillator
from ...model.fit_state import LACKING
from ...model.oscillator import HOLDS as HOLDS_IN_WORDS
from ...recording.continuity import is_rough, without_noise
from ...recording.fact import changed
from ...recording.recording import HOLDS, Recording
from ...simulate.force import force_between, smooth_force
from ..motion.blows import ContactForce
from ..problem.data import measured, noise_of
from ..problem.descent import cost_of, search
from ..problem.linearised import Linearised
from ..problem.normal_equations import pseudo_inverse
from ..problem.offset import Offset
from ..problem.output_error import OutputError, State
from ..problem.search_point import Outcome
from ..problem.segments import FORCE_BAND, Segment
from ..problem.structure import Structure
from ..signals.noise_spectrum import NoiseSpectrum, concentrated_likelihood
from ..signals.odds import ABOVE_NOISE, DECISIVE
from ..signals.registry import budget
from ..signals.signals import drive_of
from .from_prediction import FIRST_MEMORY
from .limits import HOPELESS, MATTERS, NEAR_HOLD
from .mismatch import gain_of_mismatch
from .reported_result import Fit
from .reweighted_fit import over_noise

_STEPS = budget(
    6, "steps", why="from one hold to another: the difference is small, and each step squares what is left of it"
)


@dataclass(frozen=True, eq=False)
class HoldFound:
    """What recordings say of the force between their samples.

    Attributes:
        hold: ``zero`` or ``linear`` where that is decisively likelier than ``smooth`` and matters; else ``smooth``.
        log_odds: of each hold against a smooth force; empty where no hold makes a difference.
        values: (k,) free parameters under each hold.
        gain: of log-likelihood from a smooth force to ``hold``, by the noise that is left under that.
        further: the same from there by a further lag and loss of the force.
    """

    hold: str
    log_odds: Mapping[str, float]
    values: Mapping[str, np.ndarray]
    gain: float = 0.0
    further: float = 0.0

    def believed(self, further: float | None = None) -> bool:
        """Whether the hold is all that the records ask for; ``further`` stands in for that of another fit."""
        shown = self.further if further is None else further
        # a gain grows with the square of what it is gained by
        return shown < max(DECISIVE, NEAR_HOLD**2 * self.gain)

    def spread(self, hold: str) -> np.ndarray | float:
        """(k, k) mean square of the parameters' distance from those under ``hold``, every hold by its likelihood.

        What not knowing the hold adds to a covariance: the law of total variance over models that are equally
        probable beforehand (Hoeting et al. 1999, Eq. 3). That is right on the average over the holds; a rig has one. So
        those that are not ruled out count at least alike, whichever is a little likelier in these records.
        """
        if hold not in self.values:
            return 0.0
        log_odds = np.array([self.log_odds[other] for other in self.values])
        likely = np.exp(log_odds - np.max(log_odds))
        open_still = log_odds > np.max(log_odds) - DECISIVE
        weights = np.maximum(likely / likely.sum(), open_still / np.sum(open_still))
        distances = np.array([values - self.values[hold] for values in self.values.values()])
        distances[weights == 0.0] = 0.0
        return (distances.T * weights) @ distances


def held_as(recordings: Sequence[Recording], hold: str | None) -> list[Recording]:
    """The recordings, with that hold where nobody said theirs; a switched force that is held is that of its levels."""
    held = [changed(r, hold=hold) if r.hold is None and hold is not None else r for r in recordings]
    return [_levelled(r) if r.hold == "zero" else r for r in held]


def _levelled(recording: Recording) -> Recording:
    """A recording whose force, where that is switched, is that of its levels."""
    if (drive := drive_of(recording)) is None or (levels := without_noise(drive.samples)) is drive.samples:
        return recording
    return changed(recording, force=levels, force_noise=recording.force_noise or drive.noise)


def hold_note(hold: str) -> str:
    """A sentence for the user on a hold that was found."""
    return f"the force is {HOLDS_IN_WORDS[hold]}: fitted so, as the recordings ask for it (--hold says otherwise)"


def hold_of_recordings(recordings: Sequence[Recording]) -> str:
    """The hold that driven recordings have in common; smooth where they have none, or nobody said."""
    holds = {r.hold or "smooth" for r in recordings if r.force is not None and np.any(r.force)}
    return holds.pop() if len(holds) == 1 else "smooth"


def find_hold(problem: OutputError, state: State, oscillator: Oscillator, recordings: Sequence[Recording]) -> HoldFound:
    """Compare the holds at the best fit under a smooth force.

    Args:
        problem: the model over the recordings' segments.
        state: its best point.
        oscillator: the model there.
        recordings: of the segments; the hold is sought of those that do not say theirs.
    """
    unknown = HoldFound("smooth", {}, {})
    here = problem.residuals(state)
    noise = _noise(problem, here, oscillator)
    there = {hold: _under(problem, hold, recordings).residuals(state) for hold in HOLDS if hold != "smooth"}
    if max(_distance(left, here, noise) for left in there.values()) < MATTERS:
        return unknown  # no parameter can be moved by more of its standard errors than the whole response is
    # of a model that leaves more than noise the difference is not believed as it is
    within = max(over_noise(problem, here, state, oscillator, recordings)) <= ABOVE_NOISE
    linearised = Linearised.of(problem, state, here, noise)
    reached, _ = _reached(problem, linearised, state, here, noise)
    del here
    log_odds, at_most = {"smooth": 0.0}, {}
    for hold in tuple(there):
        other = _under(problem, hold, recordings)
        ahead, least = _promised(other, linearised, state, there.pop(hold), noise, reached + HOPELESS)
        log_odds[hold], at_most[hold] = reached - ahead, reached - least
    del linearised
    others = {
        hold: _under(problem, hold, recordings) for hold, odds in at_most.items() if not (within and odds < -HOPELESS)
    }
    if not others:
        return HoldFound("smooth", log_odds, {})
    smooth = _tried("smooth", problem, state, noise, oscillator)
    trials = [smooth, *(_tried(hold, other, state, noise, oscillator) for hold, other in others.items())]
    moving = [trial for trial in trials[1:] if trial.moved(smooth) > MATTERS]
    if not moving:
        return unknown
    best = max(moving, key=lambda trial: trial.likelihood)
    log_odds |= {trial.hold: _log_odds(trial, smooth, oscillator, recordings) for trial in trials}
    found = HoldFound("smooth", log_odds, {trial.hold: trial.values for trial in trials})
    if not log_odds[best.hold] > DECISIVE:
        return found
    gain = cost_of(smooth.outcome.residuals, best.noise) - best.outcome.cost
    further = _further(best.problem, best.outcome.state, best.noise, recordings, best.hold)
    return replace(found, hold=best.hold, gain=gain, further=further)


def hold_of_fit(fit: Fit, recordings: Sequence[Recording]) -> HoldFound:
    """``find_hold`` at the maximum of the likelihood, with the memory and the offsets found there."""
    return find_hold(*_point(fit, recordings), fit.oscillator, recordings)


class _Fitting(Protocol):
    """Fits recordings, from a model that is known to be near or from none; ``doubted`` as in ``identify``."""

    def __call__(self, recordings: Sequence[Recording], known: Oscillator | None, *, doubted: bool) -> Fit: ...


def with_hold(
    fit: Fit, recordings: Sequence[Recording], answer: _Fitting, *, doubted: bool
) -> tuple[Fit, Sequence[Recording], list[str]]:
    """The fit under the hold that was said or that the recordings ask for; these with it, and a sentence about it.

    Args:
        fit: under a smooth force, or under the hold that was said.
        recordings: what was fitted.
        answer: fits them again.
        doubted: whether the answer is, see ``maximum_likelihood``.
    """
    estimate, names, notes = hold_of_fit(fit, recordings), fit.names, []
    trial, known = (estimate, fit.oscillator) if estimate.hold != "smooth" else (None, None)
    more = estimate.values and max(s.over_noise for s in fit.segments) > ABOVE_NOISE
    rough = bool(more) and _are_rough(recordings)
    likeliest = _over_a_cycle(fit, recordings, rough=rough) if rough or (more and trial is None) else "smooth"
    if likeliest != "smooth" and (trial is None or trial.hold != likeliest):
        # without the lag of half a sample a search may end in a valley from which the right one is not reached
        trial, known = replace(estimate, hold=likeliest, values={}), None
    if trial is not None:
        held = held_as(recordings, trial.hold)
        # in full where the other, found under a wrong hold, does not keep step
        again = answer(held, known, doubted=False)
        if known is None:
            trial = replace(trial, gain=_gained(fit, again))
        further = further_of_fit(again, recordings, trial.hold)
        if rough or (trial.gain > 0.0 and _no_worse(again, fit) and trial.believed(further)):
            fit = answer(held, known and again.oscillator, doubted=doubted)
            estimate, recordings, notes = trial, held, [hold_note(trial.hold)]
    hold = hold_of_recordings(recordings)
    fit = with_hold_unknown(fit, estimate.spread(hold) if fit.names == names else 0.0)
    return replace(fit, oscillator=replace(fit.oscillator, hold=hold)), recordings, notes


def _are_rough(recordings: Sequence[Recording]) -> bool:
    """Whether the forces whose hold nobody said are such as no curve joins: a chain that made them smooth had to."""
    forces = [r.force for r in recordings if r.hold is None and r.force is not None and np.any(r.force)]
    return bool(forces) and all(is_rough(force) for force in forces)


def _over_a_cycle(fit: Fit, recordings: Sequence[Recording], *, rough: bool) -> str:
    """The hold that is likeliest over one cycle at a time, where no valley misleads.

    What is missing hides much of it there: the fit in full decides, but for rough forces, which are never smooth.
    """
    problem, state = _point(fit, recordings)
    problem, model = problem.predicting(FIRST_MEMORY), fit.oscillator
    residuals = problem.residuals(state)
    if not all(np.all(np.isfinite(r)) for r in residuals):
        return "zero"  # nobody knows
    noise, holds = _noise(problem, residuals, model), ("zero", "linear" if rough else "smooth")
    tried = [_tried(hold, _under(problem, hold, recordings), state, noise, model) for hold in holds]
    return max(tried, key=lambda trial: trial.likelihood).hold


def _gained(fit: Fit, again: Fit) -> float:
    """Log-likelihood that a fit to the same segments gains by the noise that it leaves; 0 where it gains nothing sure.

    What a wrong model leaves counts by how unlike itself it is.
    """
    segments = [part.segment for part in fit.segments]
    if [(s.start, s.n) for s in segments] != [(part.segment.start, part.segment.n) for part in again.segments]:
        return 0.0
    before, after = ([part.segment.response - part.simulated for part in other.segments] for other in (fit, again))
    if not gain_of_mismatch(before, after, segments)[0][0] > DECISIVE:
        return 0.0
    return cost_of(before, again.noise) - cost_of(after, again.noise)


def _no_worse(fit: Fit, other: Fit) -> bool:
    """Whether a fit leaves no more than noise, or no more than another does: it has not run away."""
    ratio, allowed = (max(s.over_noise for s in candidate.segments) for candidate in (fit, other))
    return ratio <= max(allowed, LACKING)


def further_of_fit(fit: Fit, recordings: Sequence[Recording], hold: str) -> float:
    """What a further lag and loss of the force would gain at a fit under ``hold`` of those that do not say theirs."""
    problem, state = _point(fit, recordings)
    return _further(problem, state, fit.noise, recordings, hold)


def _point(fit: Fit, recordings: Sequence[Recording]) -> tuple[OutputError, State]:
    model = fit.oscillator
    fixed = [name for name in model.parameters() if name not in fit.names]
    data = measured([s.segment for s in fit.segments], recordings, model, coarse=False)
    tiny = np.finfo(float).tiny
    offsets = [Offset(o.recording, o.channel, max(o.std, tiny), o.value, o.middle) for o in fit.offsets]
    structure = Structure(model, data, fixed, offsets)
    problem = structure.problem.coarsely().predicting(fit.memory)
    initial = np.array([s.initial for s in fit.segments])
    return problem, State(structure.values, initial, np.array([o.value for o in fit.offsets]))


def with_hold_unknown(fit: Fit, spread: np.ndarray | float) -> Fit:
    """The fit with what not knowing the hold adds to its covariance and standard errors."""
    covariance = fit.covariance + spread
    errors = dict(zip(fit.names, np.sqrt(np.maximum(np.diag(covariance), 0.0)), strict=True))
    known = fit.oscillator.parameters()
    wider = {n: replace(p, std=float(errors[n])) for n, p in known.items() if p.std is not None and n in errors}
    return replace(fit, covariance=covariance, oscillator=fit.oscillator.with_parameters(wider))


class _Trial:
    """The fit under one hold; its likelihood is concentrated over the noise spectra (Whittle 1953)."""

    def __init__(self, hold: str, problem: OutputError, outcome: Outcome, oscillator: Oscillator) -> None:
        self.hold, self.problem, self.outcome = hold, problem, outcome
        self.noise = _noise(problem, outcome.residuals, oscillator) if np.isfinite(outcome.cost) else []
        self.likelihood = concentrated_likelihood(self.noise) if self.noise else -math.inf
        self.values = outcome.state.values[list(problem.free)]
        self.errors = np.sqrt(np.diag(pseudo_inverse(outcome.information)))

    def moved(self, other: _Trial) -> float:
        """Largest distance of a parameter from that of another fit, in standard errors."""
        known = self.errors > 0
        return float(np.max(np.abs(self.values - other.values)[known] / self.errors[known], initial=0.0))


def _tried(
    hold: str, problem: OutputError, state: State, noise: Sequence[NoiseSpectrum], oscillator: Oscillator
) -> _Trial:
    """The fit under a hold, weighed anew on the way: each hold's alike, for weights of its own make any likelier."""
    first = search(problem, state, noise, tolerance=0.1, most=_STEPS)
    there = _noise(problem, first.residuals, oscillator)
    again = search(problem, first.state, there, tolerance=0.1, most=_STEPS, residuals=first.residuals)
    return _Trial(hold, problem, again, oscillator)


def _log_odds(trial: _Trial, other: _Trial, oscillator: Oscillator, recordings: Sequence[Recording]) -> float:
    """How much likelier one hold is; what a wrong model leaves under it repeats itself, and counts for less."""
    gain = trial.likelihood - other.likelihood
    left, state = trial.outcome.residuals, trial.outcome.state
    if not max(over_noise(trial.problem, left, state, oscillator, recordings)) > ABOVE_NOISE:
        return gain
    gained = float(gain_of_mismatch(other.outcome.residuals, left, trial.problem.segments)[0][0])
    return math.copysign(min(abs(gain), max(math.copysign(1.0, gain) * gained, 0.0)), gain)


def _under(problem: OutputError, hold: str, recordings: Sequence[Recording]) -> OutputError:
    """The same problem with the force under another hold where a recording does not say its own."""
    return problem.over([_driven(s, recordings[s.recording], hold) for s in problem.segments])


def _noise(problem: OutputError, residuals: Sequence[np.ndarray], oscillator: Oscillator) -> list[NoiseSpectrum]:
    return noise_of(problem.segments, residuals, oscillator.values(), problem.memory)


def _driven(segment: Segment, recording: Recording, hold: str, delay: float = 0.0, loss: float = 0.0) -> Segment:
    """The segment under a hold, its force's samples first delayed and smoothed: F - delay F' + loss F'', s and s²."""
    if segment.force is None or recording.force is None or recording.hold is not None:
        return segment
    if isinstance(segment.force, ContactForce):  # a hammer's sensor shows a force that no converter makes
        return segment
    samples = np.asarray(recording.force[segment.start : segment.stop], float)
    highest = FORCE_BAND * segment.pace / (2 * np.pi)
    if delay or loss:
        spline = smooth_force(samples, segment.dt, highest)
        starts = spline.pieces[:: spline.fine]
        samples = samples.copy()
        samples[:-1] += 2.0 * loss * starts[:, 2] - delay * starts[:, 1]
    return replace(segment, force=force_between(samples, segment.dt, hold, highest))


def _distance(there: Sequence[np.ndarray], here: Sequence[np.ndarray], noise: Sequence[NoiseSpectrum]) -> float:
    """Size of the difference that a hold makes to the responses, in standard deviations of the noise."""
    if not all(np.all(np.isfinite(r)) for r in there):
        return math.inf
    return math.sqrt(sum(float(np.sum(s.lines(r - b) ** 2)) for s, r, b in zip(noise, there, here, strict=True)))


def _reached(
    problem: OutputError,
    linearised: Linearised,
    state: State,
    residuals: Sequence[np.ndarray],
    noise: Sequence[NoiseSpectrum],
) -> tuple[float, State | None]:
    """Negative log-likelihood that the linearised response reaches, but for a constant, and where.

    ``linearised`` has the derivatives, which one hold or another changes by a part of a sample's turn.
    """
    if not all(np.all(np.isfinite(r)) for r in residuals):
        return -math.inf, None  # nobody knows
    here = linearised.leaving([spectrum.lines(r) for spectrum, r in zip(noise, residuals, strict=True)])
    return 0.5 * here.shared.left(here.shared.step()), state.stepped(problem.free, *here.step())


def _promised(
    problem: OutputError,
    linearised: Linearised,
    state: State,
    residuals: Sequence[np.ndarray],
    noise: Sequence[NoiseSpectrum],
    hopeless: float,
) -> tuple[float, float]:
    """Negative log-likelihood that steps along the same derivatives promise at last, and the least that it may become.

    What a step shows its promise to be wrong by may be gained once more. Where that would be ``hopeless`` still,
    another step is taken from there as long as each leads further: friction that lets go answers to the second.
    """
    ahead, least, before = math.inf, math.inf, math.inf
    for _ in range(_STEPS):
        promised, there = _reached(problem, linearised, state, residuals, noise)
        if there is None:
            return min(ahead, promised), min(least, promised)
        residuals = problem.residuals(there)
        found = cost_of(residuals, noise)
        ahead, least, state = promised, promised - abs(found - promised), there
        if least <= hopeless or not found < before:
            break
        before = found
    return ahead, least


def _further(
    problem: OutputError, state: State, noise: Sequence[NoiseSpectrum], recordings: Sequence[Recording], hold: str
) -> float:
    """Gain of log-likelihood from a further delay and a further loss, both free, linearised (a score test, Rao 1948).

    Twice the gain is chi² of two degrees of freedom, so that a right hold shows as much by chance once in exp(gain).
    """
    residuals = problem.residuals(state)
    directions = []
    for delay, loss in ((0.5, 0.0), (0.0, 1.0 / 12.0)):  # what the holds themselves differ by
        other = problem.over(
            [_driven(s, recordings[s.recording], hold, delay * s.dt, loss * s.dt**2) for s in problem.segments]
        )
        directions.append([r - moved for r, moved in zip(residuals, other.residuals(state), strict=True)])
    columns = {
        i: spectrum.lines(np.stack(both))
        for i, (spectrum, both) in enumerate(zip(noise, zip(*directions, strict=True), strict=True))
    }
    gain = Linearised.of(problem, state, residuals, noise, single=False).gain(columns)[0]
    return gain if np.isfinite(gain) else math.inf
