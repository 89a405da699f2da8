"""What would tell one effect from its rivals: the next experiment where it does, else the truth about it."""

from __future__ import annotations

from collections.abc import Sequence

from ...files.spoken import spoken
from ...identify.signals.limits import CLEAR_OF_NOISE
from ..result import Experiment
from ..wording import effects_in_words, figure
from .excitations import BEYOND


def separated_by(effect: str, rivals: Sequence[str], experiment: Experiment | None) -> str:
    """The experiment's own sentence only where it tells this effect from one of its rivals.

    Args:
        effect: name of the effect; variants of it count as the same.
        rivals: the effects that the recordings cannot tell from it.
        experiment: the next one, with the pairs of models that it separates and by how many times the noise.

    Returns:
        Whole sentences; empty where there is no rival. The pairs that an experiment was not planned for are said to
        be open: nothing is claimed that was not computed.
    """
    if not rivals:
        return ""
    known = {} if experiment is None else _times_the_noise(effect, experiment)
    separated = [rival for rival in rivals if known.get(rival, 0.0) >= CLEAR_OF_NOISE]
    near = [rival for rival in rivals if rival in known and rival not in separated]
    unknown = [rival for rival in rivals if rival not in known]
    said = []
    if experiment is not None and separated:
        said.append(experiment.sentence)
        if near and not _is_about(effect, experiment):
            said.append(f"It does not tell {effect} from {spoken(near, 'or')}.")
    elif experiment is not None and near:
        most = figure(max(known[rival] for rival in near), 2)
        what = (
            f"No experiment within {BEYOND:g} times the recorded levels was found that separates"
            if experiment.kind == "none"
            else "The next experiment does not separate"
        )
        said.append(f"{what} {effect} from {effects_in_words(near, 'or')} (at most {most} times the noise).")
    if unknown:
        said.append(f"No experiment was worked out that would tell {effect} from {effects_in_words(unknown, 'or')}.")
    return " ".join(said)


def _times_the_noise(effect: str, experiment: Experiment) -> dict[str, float]:
    """By effect the multiple of the noise by which the experiment separates it from this one, the nearest variant's."""
    times: dict[str, float] = {}
    for pair in experiment.separates:
        first, second = (name.partition("/")[0] for name in pair[:2])
        if effect in (first, second) and first != second:
            other = second if first == effect else first
            times[other] = min(pair[2], times.get(other, pair[2]))
    return times


def _is_about(effect: str, experiment: Experiment) -> bool:
    """Whether the experiment was chosen for this effect, so that its own sentence says what it does not tell."""
    return bool(experiment.separates) and experiment.separates[0][0].partition("/")[0] == effect
