"""Laws distinguished by prediction, where a simulation is lost: and those with side valleys, from all their probes.

Far from the truth a structure has lost the motion, and what a law would make of the path it took says nothing of the
law. Predicted over a cycle every structure follows, the right ones better. Those that do best go the way that
identification goes, which knows of no other structure: from prediction to simulation (``by_prediction``).

A contact of an actuator with play rings faster than the rig moves, and what one bounce does differently is carried into
all that follow: simulated, its likelihood has a summit for every count of bounces, and a start some per cent off ends
on a wrong one. A prediction over an eighth of a cycle forgets each bounce before it is carried far, and has hardly any
side valleys: on it the probes are distinguished. From there the best are continued over growing memories towards
simulation, which the race goes on with (``by_probing``).
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace

import numpy as np

from ...errors import DashpotError
from ...identify.fit.likelihood import maximum_likelihood
from ...identify.problem.data import Data
from ...identify.problem.structure import Fitted, Structure, shapes_of
from ...identify.signals.registry import budget
from ...identify.start.further_laws import MEMORY, placed
from ...identify.start.limits import HALF
from ...identify.start.measured_motion import Regression, probes
from ...model import Oscillator
from ...model.law import Law
from ..limits import PROBE_MEMORY
from .race import continued
from .starts import Proposal

_KEPT = budget(2, "places", why="one on each core is continued to a simulation")
_SAMPLES = budget(10_000, "samples", why="of the loudest segments; more tell the same probes apart")


def by_prediction(fitted: Fitted, data: Data, laws: Sequence[Law], cost: float) -> list[Proposal]:
    """Laws that make a prediction over a cycle better, where a fit that knows nothing else ends with them.

    Args:
        fitted: a structure beside which they are put.
        data: what it was fitted to.
        laws: those that are asked, but for those with side valleys, which are asked for in their own way.
        cost: of a parameter, in log-likelihood.
    """
    near, laws = replace(data, memory=MEMORY), [law for law in laws if not law.rugged]
    kept = [name for name in fitted.model.parameters() if name not in fitted.free]
    try:
        known = Structure(fitted.model, near, kept).fit(None).likelihood
    except DashpotError:
        return []
    with ThreadPoolExecutor(max_workers=2) as pool:
        found = list(pool.map(lambda law: placed(fitted.model, law, data, dict.fromkeys(kept)), laws))
    gains = {
        law.name: place.likelihood - known - cost * sum(not (p.shape or p.scale) for p in law.parameters)
        for law, place in zip(laws, found, strict=True)
        if place is not None
    }
    best = max(gains.values(), default=0.0)
    proposals = []
    for law, place in zip(laws, found, strict=True):
        if place is None or not gains[law.name] > max(HALF * best, 0.0):
            continue
        fixed = (*kept, *(name for name in shapes_of(place.model) if name not in kept))
        with suppress(DashpotError):  # nothing simulates from there
            fit = maximum_likelihood(place.model, data.recordings, fixed, data, doubted=False)
            proposals.append(Proposal(law.name, fit.oscillator, None, gains[law.name]))
    return proposals


def by_probing(fitted: Fitted, standing: Fitted, data: Data, laws: Sequence[Law]) -> list[Proposal]:
    """The best places of each law that acts on a recorded force, where a prediction from there beats what stands.

    All probes, the other values those that the measured motion asks for beside them, go one step of the prediction, the
    better half of them another, and so on (successive halving: Jamieson and Talwalkar 2016).

    Args:
        fitted: the model that the laws are put into.
        standing: the best that was found without them.
        data: what both were fitted to.
        laws: of the library; those that act on no recorded force have nothing to be simulated with.
    """
    regression = Regression(data, fitted.model)
    if not regression.forced:
        return []
    near = replace(_loudest(data), memory=PROBE_MEMORY)
    known = [_step(one.model, None, near) for one in (fitted, standing)]
    if not all(known):  # nothing to gain over
        return []
    least = max(fit.likelihood for fit in known if fit)

    proposals = []
    with ThreadPoolExecutor(max_workers=2) as pool:
        for law in laws:
            guesses = [regression.at(law, probe) for probe in probes(law, data.scales)]
            fits = _halved([guess.put_into(fitted.model) for guess in guesses if guess is not None], near, pool)
            better = [fit for fit in fits if fit.likelihood > least]
            proposals += [
                Proposal(law.name, model, None, fit.likelihood - least)
                for fit, model in zip(
                    better, pool.map(lambda f: continued(f.model, data, shapes_of(f.model)), better), strict=True
                )
            ]
    return proposals


def _halved(places: Sequence[Oscillator], data: Data, pool: ThreadPoolExecutor) -> list[Fitted]:
    """Of many places the best, fitted the longer the better they are."""

    def step(place: Oscillator | Fitted) -> Fitted | None:
        return _step(place, None, data) if isinstance(place, Oscillator) else _step(place.model, place.initial, data)

    running: Sequence[Oscillator | Fitted] = places
    while True:
        fits = sorted((fit for fit in pool.map(step, running) if fit), key=lambda fit: -fit.likelihood)
        if len(fits) <= _KEPT:
            return fits
        running = fits[: max(_KEPT, len(fits) // 2)]


def _step(model: Oscillator, initial: np.ndarray | None, data: Data) -> Fitted | None:
    """A model one step nearer to the recordings; None where nothing predicts from there."""
    try:
        fit = Structure(model, data, shapes_of(model)).fit(initial, most=1)
    except (DashpotError, np.linalg.LinAlgError):
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
