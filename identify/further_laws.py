"""Start values for laws beside Eq. 17, where somebody says that they are there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from ..errors import DashpotError
from ..model import Oscillator
from ..model.laws import find
from ..model.terms import with_term
from .data import Data
from .measured_motion import Regression, probes
from .structure import Structure, shapes_of

#: Predicted over a cycle every start leads near its own place; so many steps show which is the best.
_MEMORY = 1.0
_STEPS = 4


def with_laws(
    model: Oscillator, effects: Sequence[str], data: Data, fixed: Mapping[str, float] = MappingProxyType({})
) -> Oscillator:
    """The model with further laws, one after another, each at the place where the recordings like it best.

    Places are those of the regression on the measured motion, and the law's own probes; each is fitted a few steps as a
    prediction over a cycle. What is known stays meanwhile: else a stiffness that is said to be linear bends itself
    around what the law is there for, and the place that is best beside it is a bad one without.

    Args:
        model: Eq. 17 with start values, and the laws it has.
        effects: names of laws of the library.
        data: what is to be fitted.
        fixed: parameters that keep a value, by name.

    Raises:
        BadInput: where there is no law of that name.
    """
    near = replace(data, memory=_MEMORY)
    for effect in effects:
        law = find(effect)
        guess = Regression(data, model).best(law)
        places = [] if guess is None else [guess.put_into(model)]
        places += [with_term(model, effect, probe) for probe in probes(law, data.scales)]
        best, score = places[0] if places else with_term(model, effect, {p.name: 0.0 for p in law.parameters}), -np.inf
        for place in (holding(place, fixed) for place in places):
            try:
                fit = Structure(place, near, (*fixed, *shapes_of(place))).fit(None, most=_STEPS)
            except DashpotError:
                continue
            if np.isfinite(fit.likelihood) and fit.likelihood > score:
                best, score = fit.model, fit.likelihood
        model = best
    return model


def holding(model: Oscillator, values: Mapping[str, float]) -> Oscillator:
    """The model with those of some values set whose parameters it has."""
    known = model.parameters()
    return model.with_parameters(
        {name: replace(known[name], value=value, std=None) for name, value in values.items() if name in known}
    )
