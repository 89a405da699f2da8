"""What differs between recordings of one rig: its frequency, damping, friction or gain, each within a spread.

Between two blows, or two days, a rig is not quite the same: its clamp has settled, its oil is warmer. One model of all
recordings then leaves what looks like missing physics, or a second mode, with errors that are far too small. So each
recording may have values of its own about a common mean (``random_effects``). Whether it has is asked of the fit in
which all of them have (Cochran 1954). Where that leaves more than noise, the recordings must differ by more than the
blocks of one recording do: what a family lacks differs along each of them as well.

A law that the family lacks makes a damping by the amplitude, and recordings begin at different ones. So a damping
differs where no law by the amplitude, none faster than its square, tells as much.

A motion that is driven need not pass the amplitudes of another one, and what is let go passes all below its first. So
where some are driven a frequency or a gain must tell more than a law by the amplitude too, and what sets all driven
recordings apart from the others, as a lag of the drive does, is no difference between recordings. The gain of a force
is the mass that it asks for.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...errors import BadInput
from ...model import Oscillator
from ...recording.as_recorded import InUnit
from ...recording.fact import changed
from ...recording.recording import Recording
from ..fit.from_prediction import from_prediction, keeps_step
from ..fit.limits import CYCLES
from ..fit.reported_result import Fit
from ..fit.reweighted_fit import over_noise
from ..fit.scatter import noise_on_forces, scatter
from ..motion.blows import ContactForce
from ..motion.excitation import kind_of
from ..problem.chain import Fault
from ..problem.data import noise_at
from ..problem.descent import search
from ..problem.equivalent import equivalent
from ..problem.linearised import Linearised
from ..problem.normal_equations import pseudo_inverse
from ..problem.output_error import OutputError, State
from ..problem.segments import Segment
from ..signals.noise_spectrum import NoiseSpectrum
from ..signals.odds import BY_CHANCE, is_noise
from ..signals.registry import budget, numerics, shown
from .contradiction import covering
from .fault import with_error
from .fitted_problem import fitted_problem
from .random_effects import OwnValues
from .unlike_parts import spread_of_scores

#: What may differ between recordings, and what a sentence calls it.
KINDS = {
    "omega0": "natural frequency",
    "viscous": "viscous damping",
    "dry": "dry friction",
    "mass": "mass that the force asks for, or the gain of a channel,",
}
_LET_GO = "let go"
_FEELER = numerics(1e-2, "of a parameter", why="size for finite differences")
_STEPS = budget(20, "steps", why="a search takes ten to twenty")
_STEEPEST = numerics(
    0.1,
    "of a frequency, over a factor of e of the amplitude",
    why="a spring that changes faster shows along each recording; joints soften by a tenth to a fifth over a decade",
)
_SLOPES = numerics(41, "slopes", why="of laws by the amplitude, a twentieth of the steepest apart")
_DRAWS = numerics(60, "draws of force noise", why="as for the covariance: standard errors are good to 9 %")
_NAMED = shown(3, "recordings", why="a sentence names no more")


@dataclass(frozen=True)
class Deviation(Fault):
    """By how much a parameter of the rig was another while one recording was made."""

    parameter: str = ""
    typical: float = 1.0

    moves = True

    def meant(self, segment: Segment, sizes: np.ndarray) -> Segment:
        """See ``Fault``: the chain is sound, and the rig another."""
        known = {name: size for name, size in segment.differs if name != self.parameter}
        return replace(segment, differs=(*known.items(), (self.parameter, float(sizes[0]))))

    def scale(self, segment: Segment) -> float:
        """See ``Fault``."""
        return self.typical

    def in_words(self, sizes: np.ndarray, errors: np.ndarray, response: InUnit, force: InUnit) -> str:
        """See ``Fault``."""
        return f"{self.parameter} differs by {with_error(float(sizes[0]), float(errors[0]))}"


def differing(fit: Fit, recordings: Sequence[Recording]) -> tuple[list[Recording], Oscillator] | None:
    """The recordings, each with what of the rig differed in it, and the model with the means; None where nothing does.

    Args:
        fit: of these recordings, with all parameters common.
        recordings: as they were fitted.
    """
    problem, state = fitted_problem(fit, recordings)
    used = sorted({segment.recording for segment in problem.segments})
    sorts = _sorts(problem, recordings, used)
    kinds = [name for name in KINDS if name in fit.names and _freedom(name, sorts) > 0]
    if not kinds:
        return None
    above = not _leaves_noise([s.over_noise for s in fit.segments], problem.segments)
    over = [max(s.over_noise for s in fit.segments if s.segment.recording == index) for index in used]
    # the first one has all kinds, as that of which the others are told
    told = ["mass" not in kinds or sort != _LET_GO for sort in sorts]
    first = int(np.argmin(np.where(told, over, math.inf)))
    others = [index for index in used if index != used[first]]
    names = list(fit.oscillator.parameters())
    sizes = [_FEELER * _size(problem, state, names.index(name)) for name in kinds]
    asked = [Deviation(i, parameter=k, typical=size) for k, size in zip(kinds, sizes, strict=True) for i in others]
    own = problem.with_faults(asked)
    point = replace(state, offsets=np.pad(state.offsets, (0, len(asked))))
    imitated = _imitated(problem, fit, kinds, used, sorts)
    at_once = not above or set(sorts) != {_LET_GO}  # else the phase may be lost, and a slope says nothing
    if at_once and not _own_values(own, point, fit, recordings, kinds, first, imitated)[1]:
        return None
    if not keeps_step(problem.segments, problem.residuals(state)):
        try:
            point = from_prediction(own, point)[0]
        except BadInput:
            return None
    point = search(own, point, tolerance=0.1, most=_STEPS, informed=False).state
    if not all(bool(np.all(np.isfinite(residual))) for residual in own.residuals(point)):
        return None
    values, chosen = _own_values(own, point, fit, recordings, kinds, first, imitated)
    if not chosen:
        return None
    step, effects = values.effects(chosen, values.sizes(chosen))
    differs = {kinds[k]: dict(zip(used, map(float, row), strict=True)) for k, row in zip(chosen, effects, strict=True)}
    known = fit.oscillator.parameters()
    moved = dict(zip(fit.names, point.values[list(problem.free)] + step, strict=True))
    mean = fit.oscillator.with_parameters({k: replace(known[k], value=float(value)) for k, value in moved.items()})
    made = [
        changed(recording, differs=tuple((name, of_each[i]) for name, of_each in differs.items() if i in of_each))
        for i, recording in enumerate(recordings)
    ]
    return made, mean


def alike(recordings: Sequence[Recording]) -> list[Recording]:
    """The recordings as of a rig in which nothing differs: a difference of nothing is known, and not asked for."""
    return [changed(recording, differs=tuple((name, 0.0) for name in KINDS)) for recording in recordings]


def _sorts(problem: OutputError, recordings: Sequence[Recording], used: Sequence[int]) -> list[str]:
    """Of each recording, whether it was let go or struck, or how it is driven."""
    let_go = [all(is_let_go(s) for s in problem.segments if s.recording == index) for index in used]
    return [_LET_GO if free else kind_of(recordings[index], ()) for index, free in zip(used, let_go, strict=True)]


def _freedom(name: str, sorts: Sequence[str]) -> int:
    """How many recordings may differ in a parameter from another one of their sort."""
    told = [sort for sort in sorts if name != "mass" or sort != _LET_GO]
    return len(told) - len(set(told))


@dataclass(frozen=True, eq=False)
class _Imitated:
    """How a kind would differ between recordings by what is no difference between them.

    Attributes:
        laws: (laws, recordings) by laws of the amplitude, from none to the steepest.
        apart: (sorts, recordings) by what sets those of one sort apart, of any size.
        freedom: how many recordings may differ from another one of their sort.
    """

    laws: np.ndarray
    apart: np.ndarray
    freedom: int


def _imitated(
    problem: OutputError, fit: Fit, kinds: Sequence[str], used: Sequence[int], sorts: Sequence[str]
) -> list[_Imitated]:
    """Of each kind; a damping falls no faster with the amplitude than friction's, and rises no faster than its square.

    Args:
        problem: that was fitted.
        fit: of it.
        kinds: names of parameters.
        used: the recordings.
        sorts: of each recording.
    """
    size = []
    for index in used:
        # as it was measured: what is simulated moves as much more as a gain differs
        own = [segment for segment in problem.segments if segment.recording == index]
        parts = [segment.response / segment.pace**segment.order for segment in own]
        motion = np.concatenate([part - np.mean(part) for part in parts]) ** 2
        size.append(math.sqrt(2.0 * float(np.sum(motion**2)) / max(float(np.sum(motion)), np.finfo(float).tiny)))
    logs = np.log(np.maximum(size, np.finfo(float).tiny))
    middle, pace = float(np.exp(np.mean(logs))), problem.segments[0].pace
    values = fit.oscillator.values()
    damping = abs(equivalent(values, middle, pace)[1])
    steepest = {"viscous": 2.0 * damping, "dry": 3.0 * damping * math.pi / 4.0 * pace * middle}
    driven = set(sorts) != {_LET_GO}
    if driven:
        steepest |= {"omega0": _STEEPEST * values["omega0"], "mass": values["mass"]}
    slopes = np.linspace(-1.0, 1.0, _SLOPES)
    # what is let go tells of every amplitude below its first, what is driven of those that it is driven at
    bends = slopes[::2] if driven else np.zeros(1)
    logs = logs - np.mean(logs)
    bent = logs**2 - np.mean(logs**2)
    laws = (slopes[:, None, None] * logs + bends[:, None] * bent).reshape(-1, len(used))
    apart = np.equal.outer(list(dict.fromkeys(sorts)), sorts).astype(float)[1:]
    none = np.zeros((1, len(used)))
    return [
        _Imitated(steepest[kind] * laws if kind in steepest else none, apart, _freedom(kind, sorts)) for kind in kinds
    ]


def _leaves_noise(ratios: Sequence[float], segments: Sequence[Segment]) -> bool:
    """Whether what is left of each segment, in times the noise, is noise."""
    return is_noise(np.array(ratios) ** 2, np.array([float(segment.n) for segment in segments]))


def _size(problem: OutputError, state: State, place: int) -> float:
    return max(abs(float(state.values[place])), float(problem.scale[place]))


def is_let_go(segment: Segment) -> bool:
    """Whether a motion falls by itself, so that it passes the amplitudes below its first one."""
    return segment.force is None or isinstance(segment.force, ContactForce)


def _own_values(
    own: OutputError,
    point: State,
    fit: Fit,
    recordings: Sequence[Recording],
    kinds: Sequence[str],
    first: int,
    imitated: Sequence[_Imitated],
) -> tuple[OwnValues, list[int]]:
    """The likelihood about a point, and which kinds differ beyond doubt."""
    residuals = own.residuals(point)
    noise = noise_at(own, residuals, point, fit.oscillator)
    linearised = Linearised.of(own, point, residuals, noise)
    places = [fit.names.index(name) for name in kinds]
    values = OwnValues.of(linearised, point, places, first, len(imitated[0].laws[0]))
    chosen = _decisive(values, [(1.0, None)] * len(kinds), imitated)
    if chosen and _leaves_noise(over_noise(own, residuals, point, fit.oscillator, recordings), own.segments):
        scale = _noise_of_the_force(own, point, noise, residuals, linearised, recordings)
        chosen = _decisive(values, [(scale, None)] * len(kinds), imitated)
    elif chosen:
        chosen = _decisive(values, _within(own, point, residuals, noise, places), imitated)
    return values, chosen


def _within(
    own: OutputError,
    point: State,
    residuals: Sequence[np.ndarray],
    noise: Sequence[NoiseSpectrum],
    places: Sequence[int],
) -> list[tuple[float, int | None]]:
    """Of each kind, the mean square of what blocks of some cycles ask for, in their errors, and how many there are."""
    linearised = Linearised.in_time(own, point, residuals, noise)
    asked: list[list[float]] = [[] for _ in places]
    for blocks in linearised.block([_edges(segment) for segment in own.segments]):
        for sums in (block.without(linearised.initial_rows) for block in blocks):
            for k, place in enumerate(places):
                if sums.normal[place, place] > 0.0:
                    asked[k].append(float(sums.gradient[place] ** 2 / sums.normal[place, place]))
    return [(max(float(np.mean(squares)), 1.0) if squares else 1.0, len(squares)) for squares in asked]


def _edges(segment: Segment) -> list[int]:
    """Where blocks of some cycles of a segment begin, and where the last one ends."""
    count = max(1, int(segment.n * segment.dt * segment.pace / (2 * np.pi * CYCLES)))
    return np.linspace(0, segment.n, count + 1).astype(int).tolist()


def _noise_of_the_force(
    own: OutputError,
    point: State,
    noise: Sequence[NoiseSpectrum],
    residuals: Sequence[np.ndarray],
    linearised: Linearised,
    recordings: Sequence[Recording],
) -> float:
    """By how much scores scatter more, at most, than the spectrum says, of noise of the force that a rig passes on."""
    levels = noise_on_forces(own, point, residuals, recordings)
    if not any(level and segment.force is not None for level, segment in zip(levels, own.segments, strict=True)):
        return 1.0
    scattered = scatter(own, point, noise, levels, _DRAWS, recordings=recordings)
    informed = linearised.shared.without(slice(len(own.free), None)).normal
    size = np.sqrt(np.maximum(np.diag(informed), np.finfo(float).tiny))
    return float(np.max(np.linalg.eigvalsh(spread_of_scores(informed, scattered, size))))


def _decisive(
    values: OwnValues, scales: Sequence[tuple[float, int | None]], imitated: Sequence[_Imitated]
) -> list[int]:
    """Kinds that differ beyond doubt beside each other; what tells least goes first.

    Args:
        values: the likelihood about a point.
        scales: by how much what is asked of each is more than independent noise asks for, a mean square, and of how
            many blocks it is the mean; None where it is known.
        imitated: what each kind must tell more than.
    """
    from scipy.special import chdtrc, fdtrc

    kinds, count = values.here.shape
    chosen = list(range(kinds))
    while chosen:
        least = values.lost(chosen)
        chances = []
        for k in chosen:
            scale, blocks = scales[k]
            rest = [other for other in chosen if other != k]
            instead, along = (
                np.zeros((len(each), *values.here.shape)) for each in (imitated[k].laws, imitated[k].apart)
            )
            instead[:, k], along[:, k] = imitated[k].laws, imitated[k].apart
            gain = max(2.0 * (values.lost(rest, instead, along) - least), 0.0) / scale
            freedom = imitated[k].freedom
            if blocks is None:
                chances.append(float(chdtrc(freedom, gain)))
            else:
                chances.append(float(fdtrc(freedom, max(blocks - count, 1), gain / freedom)))
        worst = int(np.argmax(chances))
        if kinds * chances[worst] <= BY_CHANCE:
            break
        del chosen[worst]
    return chosen


def with_spread(fit: Fit, recordings: Sequence[Recording]) -> tuple[Fit, tuple[str, ...]]:
    """The fit with standard errors that hold what differs between its recordings, and a sentence on each such thing.

    A common value is a mean over recordings, and no better known than such a mean can be. Of a few recordings the size
    of the spread is hardly known itself: the error is that within which the mean lies in 68 of 100 cases (Student
    1908). Pieces of one recording differ as one.

    Args:
        fit: of these recordings.
        recordings: with what differed in each; see ``differing``.
    """
    from scipy.special import ndtr, stdtrit

    used = sorted({segment.segment.recording for segment in fit.segments})
    sets = list(dict.fromkeys(recordings[i].differs for i in used))
    kinds = [name for name in KINDS if name in fit.names and any(name in dict(differs) for differs in sets)]
    if not kinds or len(sets) < 2:
        return fit, ()
    problem, state = fitted_problem(fit, recordings)
    names, free = list(fit.oscillator.parameters()), len(problem.free)
    sizes = {name: _FEELER * _size(problem, state, names.index(name)) for name in kinds}
    own = problem.with_faults([Deviation(i, parameter=name, typical=sizes[name]) for name in kinds for i in used])
    effects = np.array([[dict(differs).get(name, 0.0) for differs in sets] for name in kinds])
    of_set = np.equal.outer([sets.index(recordings[i].differs) for i in used], np.arange(len(sets))).astype(float)
    point = replace(state, offsets=np.append(state.offsets, effects @ of_set.T))
    residuals = own.residuals(point)
    sums = Linearised.of(own, point, residuals, noise_at(own, residuals, point, fit.oscillator)).shared
    sums = sums.without(slice(free, free + len(problem.offsets)))
    made = np.eye(free + len(kinds) * len(used), free + len(kinds) * len(sets))
    made[free:, free:] = np.kron(np.eye(len(kinds)), of_set)
    driven = {s.recording for s in problem.segments if not is_let_go(s)}
    of_driven = [any(recordings[i].differs == differs for i in used if i in driven) for differs in sets]
    told = [np.flatnonzero(of_driven) if name == "mass" else np.arange(len(sets)) for name in kinds]
    size = np.array(
        [np.std(each[of], ddof=1) * stdtrit(of.size - 1, ndtr(1.0)) for each, of in zip(effects, told, strict=True)]
    )
    prior = np.append(np.zeros(free), np.repeat(size**-2.0, len(sets)))
    together = pseudo_inverse(made.T @ sums.normal @ made + np.diag(prior))
    values, axes = np.linalg.eigh(together[:free, :free] - pseudo_inverse(sums.normal[:free, :free]))
    wider = covering(fit, list((axes * np.sqrt(np.maximum(values, 0.0))).T))
    noise = _leaves_noise([s.over_noise for s in fit.segments], problem.segments)
    others = "all else agrees" if noise else "beside it the model leaves more than noise"
    files, said = [next(r.name for r in recordings if r.differs == differs) for differs in sets], []
    for k, name in enumerate(kinds):
        place, at = fit.names.index(name), free + k * len(sets) + np.arange(len(sets))
        errors = np.sqrt(together[place, place] + np.diag(together)[at] + 2.0 * together[place, at])
        parameter = fit.oscillator.parameters()[name]
        values, named = parameter.value + effects[k][told[k]], [files[i] for i in told[k]]
        said.append(f"{_in_words(name, values, errors[told[k]], named, parameter.unit)}; {others}")
    return wider, tuple(said)


def _in_words(name: str, values: np.ndarray, errors: np.ndarray, files: Sequence[str], unit: str) -> str:
    """By how much a parameter differs between files, and what it is in each, or from where to where."""
    factor, unit = (1.0 / (2 * math.pi), "Hz") if name == "omega0" else (1.0, unit)
    low, high = int(np.argmin(values)), int(np.argmax(values))
    share = 100.0 / abs(float(np.mean(values)))
    size = with_error(share * (values[high] - values[low]), share * math.hypot(errors[low], errors[high]))
    named = range(len(files)) if len(files) <= _NAMED else (low, high)
    each = [f"{factor * values[i]:.4g} {unit} in {files[i]}" for i in named]
    return (
        f"the {KINDS[name]} differs by {'' if len(files) == 2 else 'up to '}{size} % between the recordings "
        f"({(', ' if len(files) <= _NAMED else ' to ').join(each)})"
    )
