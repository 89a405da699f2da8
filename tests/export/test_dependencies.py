"""What modelDescription.xml lists as dependencies is all there is: importers take every other derivative for zero."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from dashpot.model.laws import LIBRARY
from fmpy import read_model_description

MODELS = [((), {}), *(((effect,), {}) for effect in LIBRARY), (("sensor-lag",), {"quantity": "acceleration"})]


def name_of(given: object) -> str:
    return "-".join(given) or "base" if isinstance(given, tuple) else ""


def place(caller: Any, seed: int, part: float, **further: float) -> Any:
    """The FMU at a state that meets no surface but by chance, that part of its motion's size."""
    random = np.random.default_rng(seed)
    starts = caller.known.starts
    size = caller.initialise().nominals()
    caller.fmu.reset()
    state = part * np.array(size) * random.uniform(0.2, 0.7, len(size)) * random.choice([-1, 1], len(size))
    values = dict(zip(starts, state.tolist(), strict=True)) | {"F": float(random.uniform(0.2, 0.9))} | further
    return caller.start(at=0.3, **values)


def unlisted(caller: Any, unknowns: Any, knowns: list[str]) -> set[tuple[str, str]]:
    """Pairs of unknown and known with a derivative that is not zero and yet not listed."""
    listed = {u.variable.name: {v.name for v in u.dependencies} for u in unknowns}
    columns = {name: caller.derivative(list(listed), [name], [1.0]) for name in knowns}
    return {(u, k) for k in knowns for u, d in zip(listed, columns[k], strict=True) if d != 0.0 and k not in listed[u]}


@pytest.mark.parametrize(("effects", "further"), MODELS, ids=name_of)
def test_nothing_depends_on_what_is_not_listed(law_fmu, callers, effects, further):
    fmu = law_fmu(3, *effects, **further)
    told, caller = read_model_description(str(fmu)), callers(fmu)
    unknowns = [*told.outputs, *told.derivatives, *told.eventIndicators]
    knowns = ["F", "time", *caller.known.states]
    for part, changed in ((1.0, {}), (1.0, {"smoothing": 0.1}), (0.01, {"v0": 0.0, "dry": 9.0})):
        for seed in range(3):
            place(caller, seed, part, **changed)
            assert unlisted(caller, unknowns, knowns) == set()
            caller.fmu.reset()


@pytest.mark.parametrize(("effects", "further"), MODELS, ids=name_of)
def test_nor_at_the_start(law_fmu, callers, effects, further):
    fmu = law_fmu(3, *effects, **further)
    told, caller = read_model_description(str(fmu)), callers(fmu)
    for changed in ({}, {"v0": 0.0, "dry": 9.0}, {"smoothing": 0.1}):
        caller.initialise(at=0.3, **{"F": 0.4, "x0": 2e-4, "v0": -0.1, **changed})
        knowns = ["F", "time", *caller.known.starts, *caller.known.tunable]
        assert unlisted(caller, told.initialUnknowns, knowns) == set()
        caller.fmu.reset()
