"""Where each law of the library is put in: by its score beside a model, and by the measured motion itself."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from ...errors import BadInput
from ...identify.fit.likelihood import maximum_likelihood
from ...identify.problem.data import Data, noise_spectra
from ...identify.problem.equivalent import along_of
from ...identify.problem.search_point import SHOWN
from ...identify.problem.structure import Fitted, Structure, renamed, without_states
from ...identify.signals.odds import DECISIVE
from ...identify.signals.registry import budget, numerics
from ...identify.start.measured_motion import Regression
from ...model import Oscillator
from ...model.law import Law
from ...model.library import find
from ...model.terms import with_term, without_term
from .judgement import only_a_name
from .score_test import Screen

_MOST = budget(4, "lines", why="a tone has one, its harmonics made by friction some more")
_FEWEST = numerics(64, "samples", why="a shorter segment has too few frequencies for a line to stand out of")


@dataclass(frozen=True, eq=False)
class Proposal:
    """A law at some values.

    Attributes:
        law: its name.
        model: with the law in it.
        initial: (segments, states); None where they are to be found.
        gain: of log-likelihood, that whoever proposes it expects in the end.
        offsets: what the sensors show at zero; None where that is to be found.
    """

    law: str
    model: Oscillator
    initial: np.ndarray | None
    gain: float
    offsets: np.ndarray | None = None


def by_score(fitted: Fitted, data: Data, laws: Sequence[Law], cost: Callable[[Law], float]) -> list[Proposal]:
    """Every law with what its score says of it, put in beside a fitted model; ``cost`` as for ``Screen.starts``."""
    data = replace(data, scales=replace(data.scales, lines=residual_lines(fitted, data)))
    plain = [law for law in laws if not law.rugged]
    return [
        Proposal(start.effect, start.model, start.initial, start.promise, start.offsets)
        for start in Screen(fitted, data).starts(plain, cost)
    ]


def by_motion(fitted: Fitted, data: Data, laws: Sequence[Law]) -> list[Proposal]:
    """Every law that the measured motion speaks for, all other values those that it asks for beside the law."""
    data = replace(data, scales=replace(data.scales, lines=residual_lines(fitted, data)))
    regression = Regression(data, fitted.model)
    plain = regression.plain()
    proposals = []
    for guess in regression.guesses(laws):
        gain = regression.gain(plain, guess)
        if gain > 0:
            put, begun = guess.put_into(fitted.model), guess.begun(fitted.initial)
            proposals.append(Proposal(guess.effect, put, begun, gain, fitted.offsets))
    return proposals


def by_zeros(fitted: Fitted, data: Data, laws: Sequence[Law]) -> list[Proposal]:
    """A constant force in the place of what the sensors show at zero, as far as that is common.

    Beside free zeros its score is nothing: to first order a load moves the rest as a zero does. What it does to a
    spring that is not linear shows where it is as large as it can be.
    """
    zeros = zip(data.offsets, fitted.offsets, strict=False)
    shown = {offset.recording: offset.taken + value for offset, value in zeros if offset.channel == "response"}
    if not shown or fitted.initial is None or any(segment.order for segment in data.segments):
        return []
    mean, model = float(np.mean([*shown.values()])), fitted.model
    moved = fitted.initial.copy()
    moved[:, 0] += mean
    left = [value - mean * (o.channel == "response") for o, value in zip(data.offsets, fitted.offsets, strict=True)]
    constant = [law for law in laws if law.force is not None and along_of(law).constant]
    return [
        Proposal(
            law.name,
            with_term(model, law.name, {law.parameters[0].name: model.omega0.value**2 * mean}),
            moved,
            np.inf,
            np.array(left),
        )
        for law in constant
    ]


def unseen_in_motion(law: Law) -> bool:
    """Whether the measured motion says nothing of a law: a sensor's, which shows in the record alone, or a constant."""
    return law.record is not None or (law.force is not None and along_of(law).constant)


def without(fitted: Fitted, data: Data, law: str) -> list[tuple[Oscillator, np.ndarray | None]]:
    """A fitted model with one law less: the family doing what it can of it, and what the measured motion then asks for.

    With initial states.
    """
    guess, initial = Regression(data, without_term(fitted.model, law)).family(), without_states(fitted, law)
    starts: list[tuple[Oscillator, np.ndarray | None]] = [(handed_down(fitted, data, law), initial)]
    return starts if guess is None else [*starts, (guess.put_into(without_term(fitted.model, law)), initial)]


def without_anew(fitted: Fitted, data: Data, law: str) -> list[tuple[Oscillator, np.ndarray | None]]:
    """The same as a fit finds it that knows nothing, from prediction to simulation; nothing where none simulates.

    Where the path depends on the smallest change the likelihood has many summits, and a law may seem to be needed
    because the model without it rests on a lower one.
    """
    smaller = without_term(fitted.model, law)
    guess = Regression(data, smaller).family()
    guessed = smaller if guess is None else guess.put_into(smaller)
    fixed = [name for name in smaller.parameters() if name not in fitted.free]
    with suppress(BadInput):  # nothing simulates from there
        return [(maximum_likelihood(guessed, data.recordings, fixed, data, doubted=False).oscillator, None)]
    return []


def handed_down(fitted: Fitted, data: Data, law: str) -> Oscillator:
    """The model less a law, with what Eq. 17 can do of that, by least squares on the motion that the fitted one makes.

    A law that is learnt may have taken most of the spring over, and a spring without it be none.
    """
    smaller = without_term(fitted.model, law)
    dropped, own = next((t.law, t.parameters) for t in fitted.model.terms if t.effect == law)
    if dropped.force is None or along_of(dropped).phases:
        return smaller
    structure = Structure(fitted.model, data)
    state = structure.state(fitted.initial, fitted.offsets)
    values = {name: parameter.value for name, parameter in own.items()}
    columns, forces = [], []
    for i, segment in enumerate(structure.problem.segments):
        x, v = structure.problem.states(i, state)[:, :SHOWN].T
        motion = np.column_stack([x, v, segment.time + segment.dt * np.arange(x.size), np.zeros(x.size)])
        forces.append(along_of(dropped).force(values, motion, segment.dt))
        columns.append(np.column_stack([x, x**3, np.sign(x), v, np.sign(v)]))
    basis, force = np.concatenate(columns), np.concatenate(forces)
    if not (np.all(np.isfinite(basis)) and np.all(np.isfinite(force))):
        return smaller
    names, known = ("omega0", "cubic", "preload", "viscous", "dry"), smaller.parameters()
    free = [k for k, name in enumerate(names) if name in fitted.free]
    size = np.sqrt(np.mean(basis[:, free] ** 2, axis=0))
    size[size == 0.0] = 1.0
    more = dict(zip([names[k] for k in free], np.linalg.lstsq(basis[:, free] / size, force)[0] / size, strict=True))
    squared = known["omega0"].value ** 2 + more.pop("omega0", 0.0)
    moved = {name: replace(known[name], value=known[name].value + add) for name, add in more.items()}
    if squared <= 0.0:
        return smaller
    return smaller.with_parameters(moved | {"omega0": replace(known["omega0"], value=float(np.sqrt(squared)))})


def generalised(fitted: Fitted, laws: Sequence[str]) -> Iterator[tuple[str, str, Fitted]]:
    """Laws of a fit that are cases of a more general one, with that and the same fit under its name."""
    taken = {term.effect for term in fitted.model.terms}  # those of the given family too
    for name in laws:
        general = find(name).twin
        if general is not None and general not in taken and not only_a_name(find(name)):
            yield name, general, renamed(fitted, name, find(general))


def residual_lines(fitted: Fitted, data: Data) -> tuple[float, ...]:
    """Angular frequencies, rad/s: the loudest line, then those that stand out most.

    The periodogram over the smooth spectrum around it is exponentially distributed where there is only noise (Fisher
    1929). A line is placed between the bins by a parabola through its logarithms. The loudest, by its power
    over the sensor's noise, comes first: of a tone friction makes harmonics, which stand out where less is left over.
    """
    peaks: list[tuple[float, float]] = []
    loudest: list[tuple[float, float]] = []
    resolution = max((2 * np.pi / (s.n * s.dt) for s in data.segments if s.n > _FEWEST), default=0.0)
    spectra = noise_spectra(fitted.residuals, fitted.model, data)
    for segment, residual, noise, sensor in zip(data.segments, fitted.residuals, spectra, data.sensor, strict=True):
        if segment.n <= _FEWEST:
            continue
        window = np.hanning(segment.n)
        loudness = np.abs(np.fft.rfft(residual * window)) ** 2
        power = loudness / np.sum(window**2) / noise.density
        power[:3] = 0.0
        standing = np.flatnonzero(power >= np.log(power.size) + DECISIVE)
        standing = standing[standing < power.size - 1]  # the highest bin has no neighbour to place it by
        if not standing.size:
            continue
        placed = {place: _placed(power, int(place)) * 2 * np.pi / (segment.n * segment.dt) for place in standing}
        loud = standing[np.argmax(loudness[standing])]
        loudest.append((float(loudness[loud] / np.sum(window**2)) / sensor**2, placed[loud]))
        peaks += [(float(power[place]), placed[place]) for place in np.argsort(power)[::-1][:3] if place in placed]
    lines: list[float] = []
    for _, omega in [*sorted(loudest, reverse=True)[:1], *sorted(peaks, reverse=True)]:
        if all(abs(omega - known) > 2 * resolution for known in lines):
            lines.append(omega)
    return tuple(lines[:_MOST])


def _placed(power: np.ndarray, place: int) -> float:
    """Where a line lies, in bins."""
    left, middle, right = np.log(power[place - 1 : place + 2] + 1e-300)
    bend = left - 2 * middle + right
    return place + (0.5 * (left - right) / bend if bend < 0 else 0.0)
