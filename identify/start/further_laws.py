"""Start values for laws beside Eq. 17, where somebody says that they are there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from ...errors import DashpotError
from ...model import Oscillator
from ...model.law import Law
from ...model.library import find
from ...model.terms import with_term
from ..problem.data import Data
from ..problem.structure import Fitted, Structure, shapes_of
from ..signals.registry import budget
from .limits import MEMORY
from .measured_motion import Regression, probes

_STEPS = budget(4, "steps", why="so many show which start is the best")


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
    for effect in effects:
        law = find(effect)
        place = placed(model, law, data, fixed)
        model = with_term(model, effect, {p.name: 0.0 for p in law.parameters}) if place is None else place.model
    return model


def placed(
    model: Oscillator, law: Law, data: Data, fixed: Mapping[str, float | None] = MappingProxyType({})
) -> Fitted | None:
    """A model with one law more where the recordings like it best, after some steps; None where it simulates nowhere.

    Args:
        model: beside which it is put.
        law: of the library.
        data: what is to be fitted.
        fixed: parameters that keep a value, by name; None the one that they have.
    """
    near = replace(data, memory=MEMORY)
    guess = Regression(data, model).best(law)
    places = [] if guess is None else [guess.put_into(model)]
    places += [with_term(model, law.name, probe) for probe in probes(law, data.scales)]
    known = model.values()
    values = {name: known[name] if value is None else value for name, value in fixed.items()}
    best = None
    for place in (holding(place, values) for place in places):
        try:
            fit = Structure(place, near, (*values, *shapes_of(place))).fit(None, most=_STEPS)
        except DashpotError:
            continue
        if np.isfinite(fit.likelihood) and (best is None or fit.likelihood > best.likelihood):
            best = fit
    return best


def holding(model: Oscillator, values: Mapping[str, float]) -> Oscillator:
    """The model with those of some values set whose parameters it has."""
    known = model.parameters()
    return model.with_parameters(
        {name: replace(known[name], value=value, std=None) for name, value in values.items() if name in known}
    )
