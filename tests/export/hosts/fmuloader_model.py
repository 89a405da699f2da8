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
    instance, model = _second(fmu, known) if known.version == 2 else _third(fmu, known)
    x = integrate(model, known, force, dt, parameters, hold, source, output)
    instance.terminate()
    instance.free_instance()
    return x


def _second(fmu: Path, known: Described):
    from fmuloader.fmi2 import Fmi2Slave, Fmi2Type

    instance = Fmi2Slave(fmu, model_identifier=known.identifiers[INTERFACE])
    instance.instantiate("rig", Fmi2Type.MODEL_EXCHANGE, guid=known.token)
    instance.setup_experiment(start_time=0.0)

    def settle() -> None:
        while instance.new_discrete_states().newDiscreteStatesNeeded:
            pass

    return instance, Model(
        instance.enter_initialization_mode,
        instance.exit_initialization_mode,
        instance.set_real,
        instance.get_real,
        instance.set_time,
        instance.set_continuous_states,
        lambda: instance.get_continuous_states(len(known.states)),
        lambda: instance.get_derivatives(len(known.states)),
        lambda: instance.get_event_indicators(known.indicators),
        instance.enter_event_mode,
        settle,
        instance.enter_continuous_time_mode,
        lambda: instance.completed_integrator_step()[0],
    )


def _third(fmu: Path, known: Described):
    from fmuloader.fmi3 import Fmi3Slave

    instance = Fmi3Slave(fmu, model_identifier=known.identifiers[INTERFACE])
    instance.instantiate_model_exchange("rig", instantiation_token=known.token)

    def settle() -> None:
        while instance.update_discrete_states().discrete_states_need_update:
            pass

    return instance, Model(
        instance.enter_initialization_mode,
        instance.exit_initialization_mode,
        instance.set_float64,
        instance.get_float64,
        instance.set_time,
        instance.set_continuous_states,
        lambda: instance.get_continuous_states(len(known.states)),
        lambda: instance.get_continuous_state_derivatives(len(known.states)),
        lambda: instance.get_event_indicators(known.indicators),
        instance.enter_event_mode,
        settle,
        instance.enter_continuous_time_mode,
        lambda: instance.completed_integrator_step()[0],
    )
