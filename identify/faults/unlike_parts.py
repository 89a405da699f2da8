"""Whether the recordings ask for the same parameters everywhere, where a model leaves no more than noise.

A gain that walks by a few per cent, or a sensor that saturates a little, hides within noise of one per cent of the
motion, and moves parameters by many of their errors all the same. So what is fitted is divided in two: the earlier and
the later half of each recording, its larger and its smaller motion, each recording and all others, what is driven and
what is free. Of each division it is asked whether parameters of their own on one side would tell decisively more
(score test, Rao 1948; for the halves of a record Chow 1960), while initial states and sensors' zeros, and the
parameters that are common, take over what they can.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...recording.recording import Recording
from ..fit.reported_result import Fit, SegmentFit
from ..fit.scatter import noise_on_forces, scatter
from ..problem.linearised import Linearised, Sums
from ..problem.normal_equations import pseudo_inverse
from ..problem.output_error import OutputError, State
from ..problem.segments import Segment
from ..signals.hilbert import LONG
from ..signals.noise_spectrum import NoiseSpectrum
from ..signals.odds import ABOVE_NOISE, BEYOND_ERRORS, BY_CHANCE, is_noise
from ..signals.registry import numerics, shown
from .bent_channel import FoundBent, bent_channels
from .fault import with_error
from .faults_found import with_fault
from .fitted_problem import fitted_problem

_OWN = numerics(
    1e-8, "part of its information", why="rounding: a direction with less, once all else has taken its part, has none"
)
_DRAWS = numerics(60, "draws of force noise", why="as for the covariance: standard errors are good to 9 %")

_NAMED = shown(3, "recordings", why="a sentence names no more")


@dataclass(frozen=True, eq=False)
class Division:
    """One side of what was fitted.

    Attributes:
        recording: whose it is; None of what is free in all of them.
        kind: "later", "larger", "whole" or "free".
        inside: (n,) of a segment, which samples are on this side.
        since: of "later", from when, s; of "larger", beyond which amplitude.
    """

    recording: int | None
    kind: str
    inside: Callable[[Segment, np.ndarray], np.ndarray]
    since: float = np.nan


@dataclass(frozen=True, eq=False)
class Unlike:
    """A division whose sides ask for different parameters.

    Attributes:
        division: the one that tells most.
        chance: how often noise alone makes one of all divisions tell as much.
        name: the parameter that explains most of it alone.
        difference, error: of it, on this side less on the other.
        shifts: (free,) each, by how much the parameters move where either side alone is right, this parameter its own.
    """

    division: Division
    chance: float
    name: str
    difference: float
    error: float
    shifts: tuple[np.ndarray, ...]

    @property
    def recording(self) -> int | None:
        """Whose parts they are; None of all."""
        return self.division.recording


def unlike_parts(fit: Fit, recordings: Sequence[Recording]) -> tuple[Unlike | FoundBent, ...]:
    """The divisions whose sides contradict each other and the channels that are bent, beyond doubt, the clearest first.

    Very long recordings are not asked: the derivatives of all their samples are held in memory at once.

    Where more than noise is left only a bent channel that explains all of it is named.

    Args:
        fit: of these recordings.
        recordings: as they were fitted.
    """
    if not fit.names or max(s.segment.n for s in fit.segments) >= LONG:
        return ()
    problem, state = fitted_problem(fit, recordings)
    residuals = problem.residuals(state)
    if not all(bool(np.all(np.isfinite(r))) for r in residuals):
        return ()
    simulated = [segment.response - left for segment, left in zip(problem.segments, residuals, strict=True)]
    divisions = divisions_of(problem.segments, simulated)
    k, free = problem.shared, len(problem.free)
    rows = problem.derivatives(state, residuals)
    excess, noise = excess_of(fit)
    linearised = Linearised.of(problem, state, residuals, noise, rows)
    bent = bent_channels(problem, state, residuals, noise, linearised)
    if excess:
        explain = [one for one in bent if (one.size / one.error) ** 2 >= excess]
        return _explaining(explain, problem, state, fit, recordings)
    size = np.sqrt(np.maximum(np.diag(linearised.shared.normal)[:free], np.finfo(float).tiny))
    both: list[Sums] = []
    for division in divisions:
        sides = [division.inside(segment, made) for segment, made in zip(problem.segments, simulated, strict=True)]
        columns = {i: noise[i].lines(rows[i][:free] * inside) for i, inside in enumerate(sides) if np.any(inside)}
        both.append(linearised.beside(columns))
    asked = [(one.normal / np.outer(size, size), one.gradient / size) for one in (b.without(slice(k)) for b in both)]
    count, spread = len(divisions) + len(bent), np.eye(free)
    least = [_chance(reduced, asks, spread) * count for reduced, asks in asked]
    if min([*least, *(one.judged(1.0, count).chance for one in bent)]) > BY_CHANCE:
        return ()
    levels = noise_on_forces(problem, state, residuals, recordings)
    scattered = scatter(problem, state, noise, levels, _DRAWS, recordings=recordings)
    informed = linearised.shared.without(slice(free, None)).normal
    spread = spread_of_scores(informed, scattered, size)
    widest = float(np.max(np.linalg.eigvalsh(spread)))
    found: list[Unlike | FoundBent] = [one.judged(widest, count) for one in bent]
    for (reduced, asks), division, sums in zip(asked, divisions, both, strict=True):
        chance = _chance(reduced, asks, spread) * count
        information = np.maximum(np.diag(reduced), _OWN)
        variance = information * np.diag(spread)
        most = int(np.argmax(asks**2 / variance))
        difference = float(asks[most] / information[most] / size[most])
        error = float(np.sqrt(variance[most]) / information[most] / size[most])
        other = -(pseudo_inverse(sums.normal[:k, :k]) @ sums.normal[:k, k + most])[:free] * difference
        this = other + difference * (np.arange(free) == most)
        found.append(Unlike(division, chance, fit.names[most], difference, error, (other, this)))
    return tuple(sorted((one for one in found if one.chance <= BY_CHANCE), key=lambda one: one.chance))


def _explaining(
    bent: Sequence[FoundBent], problem: OutputError, state: State, fit: Fit, recordings: Sequence[Recording]
) -> tuple[FoundBent, ...]:
    """Those bent channels with which no more than noise is left, each fitted with the parameters, the likeliest first.

    What is far more than noise is no small step: which of two is the likelier its linear response does not say.
    """
    indices = list(problem.free)
    fits = [(one, with_fault(problem, state, one.fault, fit, recordings)) for one in bent]
    known = [(one, *made) for one, made in fits if made is not None]
    best = max((likelihood for _, likelihood, _, _ in known), default=0.0)
    least = np.finfo(float).tiny
    found = [
        replace(
            one,
            size=float(sizes[0]),
            shifts=(values - state.values[indices],),
            chance=float(least * np.exp(min(best - likelihood, -np.log(least)))),
        )
        for one, likelihood, sizes, values in known
    ]
    return tuple(sorted((one for one in found if one.chance <= BY_CHANCE), key=lambda one: one.chance))


def excess_of(fit: Fit) -> tuple[float, list[NoiseSpectrum]]:
    """By how much the residuals' power is more than noise, in its variance, and the noise by which that is so.

    None where it is no more: there the spectrum of what is left is the noise's. Where it is more that spectrum has the
    excess in it, and would hide what makes it.
    """
    over = np.array([stretch.over_noise for stretch in fit.segments])
    samples = np.array([float(stretch.segment.n) for stretch in fit.segments])
    if np.max(over) <= ABOVE_NOISE or is_noise(over**2, samples):
        return 0.0, list(fit.noise)
    flat = [
        replace(spectrum, density=np.full(spectrum.density.size, max(_level(stretch), np.finfo(float).tiny) ** 2))
        for spectrum, stretch in zip(fit.noise, fit.segments, strict=True)
    ]
    return float(samples @ np.maximum(over**2 - ABOVE_NOISE**2, 0.0)), flat


def _level(stretch: SegmentFit) -> float:
    """Standard deviation of the noise that is expected of a segment."""
    left = stretch.segment.response - stretch.simulated
    return float(np.sqrt(np.mean(left**2))) / max(stretch.over_noise, np.finfo(float).tiny)


def shifts_of(found: Sequence[Unlike | FoundBent]) -> list[np.ndarray]:
    """(free,) each, what may have moved the parameters, as likely as each explains what contradicts (model average)."""
    likely = np.array([found[0].chance / max(one.chance, np.finfo(float).tiny) for one in found[1:]])
    weights = np.array([1.0, *likely]) / (1.0 + np.sum(likely))
    return [np.sqrt(weight) * shift for weight, one in zip(weights, found, strict=True) for shift in one.shifts]


def unlike_in_words(found: Sequence[Unlike | FoundBent], fit: Fit, recordings: Sequence[Recording]) -> str:
    """Which sides contradict each other or which channel is bent, by how much, and what does that: a sentence."""
    unlike = found[0]
    others = sorted({one.recording for one in found[1:] if one.recording is not None} - {unlike.recording})
    rivals = [recordings[index].name for index in others if _rivals(found, index)]
    also = f"; as likely it is {' or '.join(rivals[:_NAMED])} that is not as it should be" if rivals else ""
    if isinstance(unlike, FoundBent):
        return f"{recordings[unlike.recording].name}: {unlike.words}{also}"
    division, parameter = unlike.division, fit.oscillator.parameters()[unlike.name]
    share = 100.0 / abs(parameter.value) if parameter.value else 0.0
    if abs(unlike.difference) < abs(parameter.value):
        size = f"{with_error(abs(unlike.difference) * share, unlike.error * share)} %"
    else:
        size = f"{with_error(abs(unlike.difference), unlike.error)} {parameter.unit}"
    more = f"{unlike.name} {'more' if unlike.difference > 0 else 'less'} by {size}"
    causes = {
        "later": "a gain that walks, a rig that warms or wears",
        "larger": "a sensor or a drive that saturates",
        "whole": "a gain, a zero or a clock that changed, a drive that saturates, another rig",
        "free": "a voltage taken for a force (its shaker brakes the rig by back-EMF), a force that is not all recorded",
    }[division.kind]
    if division.recording is None:
        sides = f"what is free and what is driven contradict each other: free, {more}"
    else:
        name, unit = recordings[division.recording].name, recordings[division.recording].unit
        sides = {
            "later": f"{name}: what it shows until {division.since:.4g} s and from there on contradict each other: "
            f"later {more}",
            "larger": f"{name}: its larger and its smaller motion contradict each other: above {division.since:.3g} "
            f"{unit} {more}",
            "whole": f"{name}: it contradicts {_others(division.recording, fit, recordings)}: there {more}",
        }[division.kind]
    return (
        f"{sides}, though no more than noise is left; {causes}, or physics that is missing does that; the standard "
        f"errors cover it for the parameter that shows it most{also}"
    )


def _rivals(found: Sequence[Unlike | FoundBent], index: int) -> bool:
    """Whether something of a recording explains it within the level of doubt as well as what explains it best."""
    return any(one.recording == index and found[0].chance > BY_CHANCE * one.chance for one in found)


def _others(index: int, fit: Fit, recordings: Sequence[Recording]) -> str:
    used = sorted({s.segment.recording for s in fit.segments} - {index})
    more = f" and {len(used) - _NAMED} more" if len(used) > _NAMED else ""
    return ", ".join(recordings[other].name for other in used[:_NAMED]) + more


def divisions_of(segments: Sequence[Segment], simulated: Sequence[np.ndarray]) -> list[Division]:
    """Every division that is asked for and has samples, of segments and what the model shows of each (n,)."""
    divisions: list[Division] = []
    recordings = sorted({segment.recording for segment in segments})
    for recording in recordings:
        own = [(s, made) for s, made in zip(segments, simulated, strict=True) if s.recording == recording]
        middle = float(np.median(np.concatenate([_times(s) for s, _ in own])))
        divisions.append(Division(recording, "later", _later(recording, middle), middle))
        if any(s.force is not None for s, _ in own):  # of a decay these are the two halves
            limit = float(np.median(np.concatenate([_amplitude(s, made) for s, made in own])))
            left = float(np.sqrt(np.mean(np.concatenate([s.response - made for s, made in own]) ** 2)))
            if limit > BEYOND_ERRORS * left:  # or the smaller motion is what the model makes of the force's noise
                divisions.append(Division(recording, "larger", _larger(recording, limit), limit))
        if len(recordings) > 1:
            divisions.append(Division(recording, "whole", _whole(recording)))
    if len({segment.force is None for segment in segments}) == 2:
        divisions.append(Division(None, "free", lambda segment, _: np.full(segment.n, segment.force is None)))
    motions = list(zip(segments, simulated, strict=True))  # of less than a cycle no part moves farther than the middle
    return [one for one in divisions if any(np.any(one.inside(segment, made)) for segment, made in motions)]


def _later(recording: int, middle: float) -> Callable[[Segment, np.ndarray], np.ndarray]:
    return lambda segment, _: (_times(segment) > middle) & (segment.recording == recording)


def _larger(recording: int, limit: float) -> Callable[[Segment, np.ndarray], np.ndarray]:
    return lambda segment, made: (_amplitude(segment, made) > limit) & (segment.recording == recording)


def _whole(recording: int) -> Callable[[Segment, np.ndarray], np.ndarray]:
    return lambda segment, _: np.full(segment.n, segment.recording == recording)


def _times(segment: Segment) -> np.ndarray:
    return segment.time + np.arange(segment.n) * segment.dt


def _amplitude(segment: Segment, made: np.ndarray) -> np.ndarray:
    """(n,) the largest deflection from the middle within a cycle about each sample."""
    from scipy.ndimage import maximum_filter1d

    return maximum_filter1d(np.abs(made - np.mean(made)), max(1, round(2 * np.pi / segment.pace / segment.dt)))


def spread_of_scores(informed: np.ndarray, scattered: np.ndarray, size: np.ndarray) -> np.ndarray:
    """(free, free) variance of scores that independent residuals would leave at 1: noise of the force is not such.

    Args:
        informed: (free, free) information.
        scattered: (free, free) scatter of the score.
        size: (free,) by which both are scaled.
    """
    root = _root(informed / np.outer(size, size), -0.5)
    values, vectors = np.linalg.eigh(root @ (scattered / np.outer(size, size)) @ root)
    return (vectors * np.maximum(values, 1.0)) @ vectors.T


def _root(matrix: np.ndarray, power: float) -> np.ndarray:
    """Symmetric power of a matrix; directions without information: 0."""
    values, vectors = np.linalg.eigh(matrix)
    kept = values > _OWN * max(float(values[-1]), np.finfo(float).tiny)
    return (vectors * np.where(kept, np.where(kept, values, 1.0) ** power, 0.0)) @ vectors.T


def _chance(reduced: np.ndarray, asks: np.ndarray, spread: np.ndarray) -> float:
    """How often noise asks for as much: chi-squared, with as many degrees of freedom as there are directions.

    Args:
        reduced, asks: information on the differences, and their score, in the scale of each parameter.
        spread: see ``spread_of_scores``.
    """
    from scipy.special import chdtrc

    inverse = _root(reduced, -0.5)
    known = float(np.trace(inverse @ reduced @ inverse))
    if not (np.isfinite(known) and np.all(np.isfinite(spread))):  # nothing can be said of them
        return 1.0
    directions = round(known)
    direction = inverse @ asks
    return float(chdtrc(directions, float(direction @ np.linalg.solve(spread, direction)))) if directions else 1.0
