"""What the sensors of a virtual rig record, and the truth that is sealed."""

from __future__ import annotations

from typing import Any

import numpy as np

from .effects import twins
from .noise import measured
from .recordings import amplitude
from .virtual import Virtual

FORCE_NOISE = 1e-3  # of the record's peak force, standard deviation


def record(virtual: Virtual) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Give the recordings, (n, 3) each with time s, force N, displacement m or acceleration m/s², and the truth.

    Where nothing drives the rig in any recording there is no force: (n, 2).

    The rig was driven by the clean force; the recorded one has noise. A record's noise floor is the rms of what the
    noise adds to the displacement over the standard deviation of the recorded one: the NRMSE of a perfect model. Of a
    dirty rig's recordings held out `reachable` is the NRMSE of the exact law.
    """
    rng = np.random.default_rng([*virtual.entropy, 4])
    tables, recordings = {}, {}
    dirt = virtual.dirt or {}
    driven = any(plan.drive.kind != "none" for plan in virtual.plans.values())
    for name, response in virtual.responses.items():
        peak = float(np.abs(response.force).max())
        force = response.force + FORCE_NOISE * peak * rng.standard_normal(len(response.force))
        shown = measured(rng, virtual.noise, response.shown)
        channels = [np.arange(len(force)) / virtual.base.fs, *([force] if driven else []), shown]
        tables[name] = np.column_stack(channels)
        noise = float(np.sqrt(np.mean((shown - response.shown) ** 2)))
        moving = float(shown[dirt.get("held", {}).get(name, 0) :].std())
        recordings[name] = {
            "noise_floor": noise / moving,
            "peak_force_N": peak,
            "amplitude_m": amplitude(response.x),
            "length_s": len(force) / virtual.base.fs,
            "drive": virtual.plans[name].drive.kind,
            "phases": virtual.phases[name],
        }
        if name in dirt.get("reachable", {}):
            recordings[name]["reachable"] = float(np.hypot(dirt["reachable"][name], noise) / moving)
    spec = virtual.spec
    parameters = {
        key: float(value) for key, value in virtual.rig(virtual.trial.plan.training[-1], virtual.level).items()
    }
    truth = {
        "kind": spec.kind,
        "effects": list(spec.effects),
        "variants": list(spec.variants),
        "twins": twins(spec.effects, parameters) if spec.kind == "single" else [],
        "scale": virtual.scale,
        "parameters": parameters,
        "natural_frequency_hz": virtual.base.omega / (2 * np.pi),
        "working_amplitude_m": virtual.base.amplitude,
        "fs_hz": virtual.base.fs,
        "experiment": virtual.trial.experiment,
        "quantity": virtual.trial.quantity,
        "noise": virtual.noise,
        "redraws": virtual.redraws,
        "recordings": recordings,
    } | ({"dirt": dirt} if dirt else {})
    return tables, truth
