"""How many modes ring in the recordings: the fits of one and of several, and of one more at the line that is left.

A mode is a linear oscillator. What Eq. 17 lacks leaves lines too, that a mode only imitates, with a frequency and a
damping that are others where the motion is others. So another mode is taken where it is decisively likelier, where it
leaves no more than noise or the modes of either half of the motion explain the other half, where each of them rings,
and where each is another one than the others. Two that ring within each other's bandwidth hardly beat: their sum is one
swing whose damping is another where it is small, which one mode that is bent has too. There a bent one has to be less
likely, and the frequencies have to differ by more than what damping takes off them: friction of any other law bends a
fall so.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import combinations, product
from typing import Protocol

import numpy as np

from ...errors import BadInput
from ...model import Oscillator
from ...model.laws import MODES
from ...model.oscillator import Term
from ...model.terms import with_term
from ..motion.limits import RINGS
from ..problem.segments import Segment
from ..signals.odds import DECISIVE, SIGNIFICANT, is_noise
from ..start.further_modes import Mode, with_modes
from ..start.limits import HALF
from ..start.linear_modes import fitted_modes, left_by, one_mode_more
from .reported_result import Fit, SegmentFit

#: What a linear rig does without.
MEMBERS = ("cubic", "preload", "dry")
#: What bends the fall and the frequency of one mode, beside Eq. 17.
BENDING = ("quadratic-drag", "quintic-stiffness")


class Answer(Protocol):
    """Fits Eq. 17 from its own starts (None), or a model from its values and a fit's drifts, some parameters kept."""

    def __call__(self, fit: Fit | None, model: Oscillator | None, kept: Sequence[str] = (), *, doubted: bool) -> Fit:
        """As ``identify`` fits, from there."""
        ...


@dataclass(frozen=True, eq=False)
class Modes:
    """A fit of one mode or of several.

    Attributes:
        fit: which.
        kept: parameters that were kept at none in it.
        more: with one mode more, where that is decisively likelier and yet leaves more than noise.
        fewer: with those modes alone that it began from, where there are more.
    """

    fit: Fit
    kept: tuple[str, ...] = ()
    more: Modes | None = None
    fewer: Modes | None = None


def with_more_modes(first: Modes, answer: Answer, modes: Sequence[Mode] = (), *, doubted: bool) -> Modes:
    """The fit with the modes that the free motion shows, and one more at each line that is left, while they stand."""
    best, more = first, None
    while not _leaves_noise(best.fit) and len(known := modes_of_fit(best.fit.oscillator)) <= len(MODES):
        segments = [s.segment for s in best.fit.segments]
        lines = fitted_modes(segments, modes) if len(modes) > len(known) else one_mode_more(segments, known)
        other = _beside(best.fit, lines, answer) if _promises(best.fit, known, lines) else None
        if other is not None and _bends(other[0], best.fit, answer):
            break
        if other is None or not stand(other[0], best.fit):
            more = None if other is None or not odds(other[0], best.fit) > DECISIVE else Modes(*other)
            break
        best = Modes(*other)
    if doubted and best is not first:
        best = replace(best, fit=answer(best.fit, best.fit.oscillator, best.kept, doubted=True))
    return replace(best, more=more, fewer=None if best is first else first)


def _beside(fit: Fit, modes: Sequence[Mode], answer: Answer) -> tuple[Fit, tuple[str, ...]] | None:
    """Linear modes, the first of them nonlinear where that is decisively likelier; None where they do not simulate."""
    try:
        plain = answer(fit, with_modes(fit.oscillator, modes), MEMBERS, doubted=False)
        freed = answer(plain, plain.oscillator, doubted=False)
    except BadInput:
        return None
    return (freed, ()) if odds(freed, plain) > DECISIVE else (plain, MEMBERS)


def _bends(fit: Fit, before: Fit, answer: Answer) -> bool:
    """Whether modes within each other's bandwidth are no likelier than one mode fewer that a further law bends."""
    if not odds(fit, before) > DECISIVE:
        return False
    modes = list(zip(modes_of_fit(fit.oscillator), _errors(fit.oscillator), strict=True))
    pairs = [(*one, *other) for one, other in combinations(modes, 2)]
    if any(_of_one_frequency(a, d, b, e) for a, d, b, e in pairs):
        return True
    if not any(abs(a[0] - b[0]) < a[0] * a[1] + b[0] * b[1] for a, _, b, _ in pairs):
        return False
    for law in BENDING:
        with suppress(BadInput):
            bent = answer(before, with_term(before.oscillator, law, {"coefficient": 0.0}), doubted=False)
            if odds(bent, fit) > 0.0:
                return True
    return False


def _of_one_frequency(one: Mode, error: tuple[float, float], other: Mode, of_other: tuple[float, float]) -> bool:
    """Whether natural frequencies differ by no more than what damping takes off them, and their errors."""
    apart = abs(np.log(one[0] / other[0]))
    return bool(
        apart < abs(one[1] ** 2 - other[1] ** 2) + SIGNIFICANT * np.hypot(error[0] / one[0], of_other[0] / other[0])
    )


def _promises(fit: Fit, known: Sequence[Mode], more: Sequence[Mode]) -> bool:
    """Whether linear modes take half of the way from what a fit leaves down to the noise, before anything is simulated.

    In each segment of the motion itself, or of what the fit leaves, whose own mode may be none of a linear rig.
    """
    whole, left = [s.segment for s in fit.segments], _rest_of(fit)
    return _takes_half(left, np.fmin(left_by(whole, more), left_by(left, (*known, *more))), fit)


def _foretell(modes: Sequence[Mode], fit: Fit) -> bool:
    """Whether linear modes fitted to either half of each segment take half of the way to the noise in the other."""
    halves = [[s.segment.n // 2 * k for k in range(3)] for s in fit.segments]
    whole, left = [s.segment for s in fit.segments], _rest_of(fit)
    for learnt, asked in ((0, 1), (1, 0)):
        parts = [[s.part(*h[k : k + 2]) for s, h in zip(whole, halves, strict=True)] for k in (learnt, asked)]
        rest = [s.part(*h[asked : asked + 2]) for s, h in zip(left, halves, strict=True)]
        if not _takes_half(rest, left_by(parts[1], fitted_modes(parts[0], modes)), fit):
            return False
    return True


def _rest_of(fit: Fit) -> list[Segment]:
    """What a fit leaves of the response, in place of it."""
    return [replace(s.segment, response=s.segment.response - s.simulated) for s in fit.segments]


def _takes_half(rest: Sequence[Segment], left: np.ndarray, fit: Fit) -> bool:
    """Whether mean squares (segments,) take half of the way from what a fit leaves down to the noise."""
    size = np.array([float(segment.n) for segment in rest])
    needed = np.log([max(s.over_noise, 1.0) for s in fit.segments])
    gain = 0.5 * (np.log(left_by(rest, ())) - np.log(left))
    return bool(gain @ size > HALF * needed @ size)


def modes_of_fit(model: Oscillator) -> tuple[Mode, ...]:
    """Natural frequency in rad/s and damping ratio of the model's own mode, and of the further ones."""
    own = [(model.omega0.value, model.viscous.value, 0.0 if model.mass is None else 1.0 / model.mass.value)]
    for term in model.terms:
        if term.effect in MODES:
            frequency, viscous, gain = (term.parameters[n].value for n in ("frequency", "viscous", "participation"))
            own.append((frequency, viscous, gain))
    return tuple((omega, viscous / (2 * omega), gain) for omega, viscous, gain in own)


def odds(fit: Fit, other: Fit) -> float:
    """Logarithm of the odds of a fit against another one (Schwarz 1978).

    A member of Eq. 17 that is hardly told from none costs what it would cost to leave it out. Of fits to different
    stretches the samples that both have are compared, as if what is left were white.
    """
    alike = _samples(fit) == _samples(other)
    gain = fit.log_likelihood - other.log_likelihood if alike else _white_gain(fit, other)
    return gain - 0.5 * (_cost(fit) - _cost(other))


def _cost(fit: Fit) -> float:
    """Twice the logarithm of what the unknowns of a fit cost."""
    each = float(np.log(sum(s.segment.n for s in fit.segments)))
    known = fit.oscillator.parameters()
    cost = each * sum(s.initial.size for s in fit.segments if not s.segment.rests)
    for name in fit.names:
        value, std = known[name].value, known[name].std
        cost += min(each, (value / std) ** 2) if name in MEMBERS and std else each
    return cost


def _samples(fit: Fit) -> list[tuple[int, int, int]]:
    return [(s.segment.recording, s.segment.start, s.segment.stop) for s in fit.segments]


def _white_gain(fit: Fit, other: Fit) -> float:
    """Gain of log-likelihood over the samples that both fits have, in white noise of unknown level."""
    gain = 0.0
    for mine, theirs in product(fit.segments, other.segments):
        first = max(mine.segment.start, theirs.segment.start)
        last = min(mine.segment.stop, theirs.segment.stop)
        if mine.segment.recording == theirs.segment.recording and last - first > 1:
            left, before = (_power(s, first, last) for s in (mine, theirs))
            gain += 0.5 * (last - first) * float(np.log(before / left)) if min(left, before) > 0 else 0.0
    return gain


def _power(part: SegmentFit, first: int, last: int) -> float:
    """Mean square of what is left over samples of the recording."""
    left = part.segment.response - part.simulated
    return float(np.mean(left[first - part.segment.start : last - part.segment.start] ** 2))


def _leaves_noise(fit: Fit) -> bool:
    squares = np.array([s.over_noise**2 for s in fit.segments])
    return is_noise(squares, np.array([float(s.segment.n) for s in fit.segments]))


def stand(fit: Fit, before: Fit) -> bool:
    """Whether the modes of a fit are there, held against a fit of fewer."""
    modes, errors = modes_of_fit(fit.oscillator), _errors(fit.oscillator)
    worst, worst_before = (max(part.over_noise for part in some.segments) for some in (fit, before))
    explains = _leaves_noise(fit) or (worst < worst_before and _foretell(modes, before))
    if not (odds(fit, before) > DECISIVE and explains):
        return False
    if any(not zeta < RINGS for _, zeta, _ in modes) or any(map(_is_a_tone, fit.oscillator.terms)):
        return False
    return all(
        any(abs(a[k] - b[k]) > SIGNIFICANT * np.hypot(d[k], e[k]) for k in (0, 1))
        for (a, d), (b, e) in combinations(list(zip(modes, errors, strict=True)), 2)
    )


def _is_a_tone(term: Term) -> bool:
    """Whether a further mode is neither driven nor damped, as far as is known: hum is that, and no mode.

    Damping below zero is none: where the search for a line has not come to its end, its errors are too small.
    """
    if term.effect not in MODES:
        return False
    driven, damped = term.parameters["participation"], term.parameters["viscous"]
    return not (
        (driven.std is not None and abs(driven.value) > SIGNIFICANT * driven.std)
        or (damped.std is not None and damped.value > SIGNIFICANT * damped.std)
    )


def _errors(model: Oscillator) -> list[tuple[float, float]]:
    """Standard errors of each mode's frequency and damping ratio, as ``modes_of_fit`` has them; infinite if unknown."""
    parameters = [(model.omega0, model.viscous)]
    terms = [term.parameters for term in model.terms if term.effect in MODES]
    parameters += [(known["frequency"], known["viscous"]) for known in terms]
    known = [(omega.value, *(np.inf if p.std is None else p.std for p in (omega, rate))) for omega, rate in parameters]
    return [(std, by / (2 * omega)) for omega, std, by in known]
