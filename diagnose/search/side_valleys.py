"""Where a law with side valleys is put in when the measured motion is silent on it: simulated from all its probes.

The regression on the measured motion has no side valleys, but needs a motion that shows the law above the noise for
long: short bursts do not show the contacts of an actuator with play, which ring faster than the rig moves. A
simulation tells the probes apart, once a few steps have bent the rest of the model to each of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from ...errors import DashpotError
from ...identify.data import Data
from ...identify.measured_motion import Guess, Regression, probes
from ...identify.structure import Fitted, Structure, shapes_of
from ...model import Oscillator
from ...model.law import Law
from .starts import Proposal

#: So many are kept in the end.
_KEPT = 3
#: The loudest segments are simulated, as many as have this many samples together.
_SAMPLES = 30_000


def by_probing(fitted: Fitted, data: Data, laws: Sequence[Law]) -> list[Proposal]:
    """The best places of each law that acts on a recorded force, all other values those that a few steps ask for.

    All probes go one step, the better half of them another, and so on (successive halving: Jamieson and
    Talwalkar 2016).

    Args:
        fitted: the model that the laws are put into.
        data: what it was fitted to.
        laws: of the library; those that act on no recorded force have nothing to be simulated with.
    """
    regression = Regression(data, fitted.model)
    if not regression.forced:
        return []
    loudest = _loudest(data)
    plain = _step(fitted.model, None, loudest)
    if plain is None:  # nothing to gain over
        return []
    proposals = []
    for law in laws:
        guesses = [regression.at(law, probe) for probe in probes(law, data.scales)]
        fits = _halved([(g, g.put_into(fitted.model)) for g in guesses if g is not None], loudest)
        proposals += [
            Proposal(law.name, fit.model, guess.begun(fitted.initial), fit.likelihood - plain.likelihood)
            for guess, fit in fits
            if fit.likelihood > plain.likelihood
        ]
    return proposals


def _halved(places: Sequence[tuple[Guess, Oscillator]], data: Data) -> list[tuple[Guess, Fitted]]:
    """Of many places the best, fitted the longer the better they are."""

    def step(place: tuple[Guess, Oscillator | Fitted]) -> tuple[Guess, Fitted] | None:
        guess, known = place
        model, initial = (known, None) if isinstance(known, Oscillator) else (known.model, known.initial)
        fit = _step(model, initial, data)
        return None if fit is None else (guess, fit)

    running: Sequence[tuple[Guess, Oscillator | Fitted]] = places
    with ThreadPoolExecutor(max_workers=2) as pool:
        while True:
            fits = sorted((fit for fit in pool.map(step, running) if fit), key=lambda fit: -fit[1].likelihood)
            if len(fits) <= _KEPT:
                return fits
            running = fits[: max(_KEPT, len(fits) // 2)]


def _step(model: Oscillator, initial: np.ndarray | None, data: Data) -> Fitted | None:
    """A model one step nearer to the recordings; None where nothing simulates from there."""
    try:
        fit = Structure(model, data, shapes_of(model)).fit(initial, most=1)
    except DashpotError:
        return None
    return fit if np.isfinite(fit.likelihood) else None


def _loudest(data: Data) -> Data:
    """The segments with the largest motion, as many as have enough samples, in their order."""
    order = sorted(range(len(data.segments)), key=lambda i: -float(np.std(data.segments[i].response)))
    before = np.cumsum([0] + [data.segments[i].n for i in order])
    kept = sorted(i for i, n in zip(order, before, strict=False) if n < _SAMPLES)
    return replace(
        data,
        segments=tuple(data.segments[i] for i in kept),
        sensor=tuple(data.sensor[i] for i in kept),
        force=tuple(data.force[i] for i in kept),
    )
