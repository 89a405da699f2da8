"""The next recording to make: the one in which the models that survived differ most, in units of the noise.

Two models differ in a recording by what is left of the difference of their responses when either may re-tune all its
parameters and initial states to imitate the other (T-optimal design: Atkinson and Fedorov 1975, linearised). With one
model left the recording is chosen that shrinks its parameters' errors most (D-optimal).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...errors import DashpotError
from ...foresight.excitation import Excitation
from ...foresight.rehearsal import Played, apart, rehearse
from ...identify.problem.data import Data
from ...identify.problem.linearised import off, orthonormal
from ...identify.signals.limits import CLEAR_OF_NOISE
from ...identify.signals.registry import budget, numerics
from ...model import Oscillator
from ...model.effect_words import effect_in_words
from ...simulate.core import STEPS_PER_PERIOD, internal_step
from ..limits import POORLY_KNOWN, WORTHWHILE
from ..result import Experiment
from ..wording import effects_in_words, figure, quantity
from .excitations import BEYOND, Limits, candidates, limits_of

_ROUNDED = numerics(1.05, "times the limit", why="a peak is met between samples")

_MODELS = budget(
    4, "models", why="the first and its closest rivals; each further one costs a simulation of every experiment"
)
_DENSITY = numerics(60.0, "samples a cycle", why="ten harmonics are sampled six times each")
_FINALISTS = budget(3, "experiments", why="those that tell most; only these are rehearsed with rivals fitted anew")
_SLOWER = budget(
    10.0, "times the internal steps", why="a rival that takes more is a fit that ran away; it would take minutes"
)
_STIFFEST = budget(
    40.0,
    "times the internal steps",
    why=(
        "a model that takes more has a contact that rings at a hundred times the frequency of the rig, which no "
        "recording shows: it would take minutes to hours, and its answer would be worth nothing"
    ),
)


def next_experiment(models: Mapping[str, Oscillator], data: Data, *, limits: Limits | None = None) -> Experiment:
    """Choose the next recording.

    Args:
        models: names and models with their values, the best first, then its rivals.
        data: what was recorded: noise, levels and band.
        limits: what may be asked of the rig; what was recorded where None. Up to 1.5 times as much is considered.
    """
    names = list(models)[:_MODELS]
    if not names:
        return _nothing("no model is left to choose an experiment for")
    first = models[names[0]]
    natural = data.scales.omega / (2 * np.pi)
    limits = limits or limits_of(data)
    plans = candidates(limits, natural)
    fs = max(recording.fs for recording in data.recordings)
    rate = min(fs, _DENSITY * natural)
    played: dict[str, Played] = {}
    reach = BEYOND * data.scales.length
    for name in names:
        try:
            pace = _pace(models[name], reach)
            if pace > _STIFFEST * STEPS_PER_PERIOD * natural:
                continue
            if pace > _SLOWER * _pace(first, reach):
                continue
            played[name] = rehearse(models[name], first, plans, data, rate, fs, reach)
        except (DashpotError, np.linalg.LinAlgError):
            continue
    if names[0] not in played:
        return _nothing(
            f"{effect_in_words(names[0])} does not simulate beyond the recordings, or is as stiff as no recording "
            "shows, so that no experiment can be planned with it"
        )
    safe = [i for i in range(len(plans)) if _safe(i, played, limits)]
    rivals = [name for name in names[1:] if name in played]
    if rivals:
        return _separating(names[0], rivals, played, plans, safe, first, fs)
    return _sharpening(names[0], first, played[names[0]], plans, safe, fs)


def _pace(model: Oscillator, reach: float) -> float:
    """Internal steps a second that a model takes up to a displacement."""
    return 1.0 / internal_step(model, model.values(), reach)


def _safe(i: int, played: Mapping[str, Played], limits: Limits) -> bool:
    """Whether no model expects the rig to move farther than it may."""
    return all(model.peaks[i] <= _ROUNDED * BEYOND * limits.displacement for model in played.values())


def _separating(
    name: str,
    rivals: Sequence[str],
    played: Mapping[str, Played],
    plans: Sequence[Excitation],
    safe: Sequence[int],
    model: Oscillator,
    fs: float,
) -> Experiment:
    """The experiment that tells the first model from the rival nearest to it.

    A few are chosen by linearised imitation; in these the rivals are fitted to the first model's response.
    """

    def worth(i: int, differ: Mapping[str, float]) -> float:
        return min(differ.values()) * (WORTHWHILE if plans[i].relative > 1.0 else 1.0)

    linear = {i: {rival: apart(played[name], played[rival], i) for rival in rivals} for i in safe}
    leading = sorted(safe, key=lambda i: -worth(i, linear[i]))[:_FINALISTS]
    fitted = {i: {r: min(linear[i][r], played[r].imitates(played[name], i)) for r in rivals} for i in leading}
    if not fitted:
        return _nothing("every excitation that would tell the models apart moves the rig farther than it may go")
    best = max(fitted, key=lambda i: worth(i, fitted[i]))
    names = [name, *rivals]
    pairs = [(a, b) for j, a in enumerate(names) for b in names[j + 1 :]]
    separates = tuple((a, b, fitted[best][b] if a == name else apart(played[a], played[b], best)) for a, b in pairs)
    separated = [(b, z) for a, b, z in separates if a == name]
    clear = [b for b, z in separated if z >= CLEAR_OF_NOISE]
    not_separated = [b for b, z in separated if z < CLEAR_OF_NOISE]
    if not clear:
        largest = max(z for _, z in separated)
        sentence = (
            f"No recording within {BEYOND:g} times the present levels tells {effect_in_words(name)} from "
            f"{effects_in_words(rivals, 'or')} (at most {figure(largest, 2)} times the noise, either re-tuned): "
            "measure the part itself, or with less noise."
        )
        return Experiment(
            sentence=sentence,
            kind="none",
            level=0.0,
            band_hz=(0.0, 0.0),
            seconds=0.0,
            separates=separates,
            signal=None,
            fs=fs,
        )
    least = min(z for b, z in separated if b in clear)
    why = (
        f"{effect_in_words(name)} then differs from {effects_in_words(clear)} by {figure(least, 2)} times the noise "
        "or more, however it is re-tuned"
    )
    if not_separated:
        why += f"; it does not tell {name} from {effects_in_words(not_separated, 'or')}"
    return _experiment(plans[best], model, why, separates, fs)


def _sharpening(
    name: str,
    model: Oscillator,
    played: Played,
    plans: Sequence[Excitation],
    safe: Sequence[int],
    fs: float,
) -> Experiment:
    """With one model left: the experiment that shrinks the errors of its parameters most."""
    parameters = model.parameters()
    count = len(parameters)
    size = np.array([abs(p.value) if p.value else 1.0 for p in parameters.values()])
    std = np.array([p.std if p.std else np.inf for p in parameters.values()])
    prior = np.diag(np.where(np.isfinite(std), (size / np.maximum(std, 1e-300)) ** 2, 1e-12))
    known = float(np.linalg.slogdet(prior)[1])
    best, most, after = -1, -np.inf, std / size
    for i in safe:
        slopes = played.derivatives[i]
        if slopes is None:
            continue
        rows = off(orthonormal(slopes[count:]), slopes[:count]) * size[:, None]
        information = prior + rows @ rows.T
        # twice what it tells beyond what is known (Lindley 1956), which is never negative
        gain = (float(np.linalg.slogdet(information)[1]) - known) * (1.0 if plans[i].relative <= 1.0 else WORTHWHILE)
        if gain > most:
            best, most = i, gain
            after = np.sqrt(np.maximum(np.diag(np.linalg.pinv(information, hermitian=True)), 0.0))
    if best < 0:
        return _nothing("every excitation that is worth a recording moves the rig farther than it may go")
    before = std / size
    if not np.any(np.isfinite(before)):
        why = f"no rival of {effect_in_words(name)} is left; this would test it hardest"
        return _experiment(plans[best], model, why, (), fs)
    poor = [
        k
        for k in range(count)
        if np.isfinite(before[k]) and before[k] > POORLY_KNOWN and after[k] < WORTHWHILE * before[k]
    ]
    if poor:
        k = max(poor, key=lambda k: before[k] / after[k])
        named = list(parameters)[k]
        why = f"it brings the error of {named} from {figure(100 * before[k], 2)} to about {figure(100 * after[k], 2)} %"
    else:
        k = int(np.argmax(np.where(np.isfinite(before), before / np.maximum(after, 1e-300), 0.0)))
        named = list(parameters)[k]
        why = f"no rival of {effect_in_words(name)} is left; this tests it hardest and sharpens {named} most"
    return _experiment(plans[best], model, why, (), fs)


def _experiment(
    plan: Excitation,
    model: Oscillator,
    why: str,
    separates: tuple[tuple[str, str, float], ...],
    fs: float,
) -> Experiment:
    decay = plan.kind == "decay"
    unit = model.response.displacement_unit if decay else model.force_unit
    level = quantity(plan.level, unit)
    times = "as much as ever so far" if plan.relative == 1.0 else f"{figure(plan.relative, 2)} times the largest so far"
    low, high = plan.band_hz
    what = {
        "sweep": f"Sweep from {figure(low)} to {figure(high)} Hz with {level} peak ({times})",
        "multisine": f"Play a multisine of random phases from {figure(low)} to {figure(high)} Hz "
        f"with {level} peak ({times})",
        "sine": f"Drive at {figure(low)} Hz with {level} peak ({times}) and stop at half time to let it ring down",
        "decay": f"Release it at {level} ({times}) and let it ring down",
    }[plan.kind]
    length = f"over {figure(plan.seconds)} s" if plan.kind == "sweep" else f"for {figure(plan.seconds)} s"
    return Experiment(
        sentence=f"{what}, {length}: {why}.",
        kind=plan.kind,
        level=plan.level,
        band_hz=(min(low, high), max(low, high)),
        seconds=plan.seconds,
        separates=separates,
        signal=None if decay else plan.signal(fs),
        fs=fs,
    )


def _nothing(sentence: str) -> Experiment:
    return Experiment(
        sentence=sentence[0].upper() + sentence[1:] + ".",
        kind="none",
        level=0.0,
        band_hz=(0.0, 0.0),
        seconds=0.0,
        separates=(),
        signal=None,
        fs=0.0,
    )
