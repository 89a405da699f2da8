"""fmuloader in model exchange, FMI 2.0 and 3.0, under an integrator of our own.

Traps: those of ``fmuloader_slave``; and the numbers of states and event indicators are the caller's to know.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from described import MODEL_EXCHANGE, Described, describe
from integrating import Model, integrate

NEEDS = ("fmuloader",)
INTERFACE = MODEL_EXCHANGE
HOLDS = {2: ("zero", "first"), 3: ("zero", "first")}


def run(
    fmu: Path,
    force: np.ndarray,
    dt: float,
    parameters: dict[str, float],
    hold: str,
    *,
    source: str = "F",
    output: str = "x",
) -> np.ndarray:
    """(n,) output at the samples of the force."""
    known = describe(fmu)
    it, model = _second(fmu, known) if known.version == 2 else _third(fmu, known)
    x = integrate(model, known, force, dt, parameters, hold, source, output)
    it.terminate()
    it.free_instance()
    return x


def _second(fmu: Path, known: Described):
    from fmuloader.fmi2 import Fmi2Slave, Fmi2Type

    it = Fmi2Slave(fmu, model_identifier=known.identifiers[INTERFACE])
    it.instantiate("rig", Fmi2Type.MODEL_EXCHANGE, guid=known.token)
    it.setup_experiment(start_time=0.0)

    def settle() -> None:
        while it.new_discrete_states().newDiscreteStatesNeeded:
            pass

    return it, Model(
        it.enter_initialization_mode,
        it.exit_initialization_mode,
        it.set_real,
        it.get_real,
        it.set_time,
        it.set_continuous_states,
        lambda: it.get_continuous_states(len(known.states)),
        lambda: it.get_derivatives(len(known.states)),
        lambda: it.get_event_indicators(known.indicators),
        it.enter_event_mode,
        settle,
        it.enter_continuous_time_mode,
        lambda: it.completed_integrator_step()[0],
    )


def _third(fmu: Path, known: Described):
    from fmuloader.fmi3 import Fmi3Slave

    it = Fmi3Slave(fmu, model_identifier=known.identifiers[INTERFACE])
    it.instantiate_model_exchange("rig", instantiation_token=known.token)

    def settle() -> None:
        while it.update_discrete_states().discrete_states_need_update:
            pass

    return it, Model(
        it.enter_initialization_mode,
        it.exit_initialization_mode,
        it.set_float64,
        it.get_float64,
        it.set_time,
        it.set_continuous_states,
        lambda: it.get_continuous_states(len(known.states)),
        lambda: it.get_continuous_state_derivatives(len(known.states)),
        lambda: it.get_event_indicators(known.indicators),
        it.enter_event_mode,
        settle,
        it.enter_continuous_time_mode,
        lambda: it.completed_integrator_step()[0],
    )
