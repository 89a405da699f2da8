"""Recordings of Equation 17 as a lab would make them: by the reference integrator, with noise and offsets."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ..recording.recording import Recording
from .force import chirp
from .oscillator import integrate_pieces
from .truth import TRUTH

UNITS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}


def acceleration(values: Mapping[str, float], x: np.ndarray, v: np.ndarray, force: np.ndarray) -> np.ndarray:
    """(n,) m/s² of Eq. 17 at displacements and velocities (n,) under a force (n,): zero where friction holds it."""
    v_zero, x_zero = v == 0.0, x == 0.0
    net = force / values["mass"] - values["omega0"] ** 2 * x - values["cubic"] * x**3
    net = net - values["preload"] * np.sign(x) - values["viscous"] * v
    grip = values["dry"] + np.where(x_zero, values["preload"], 0.0)
    held = np.sign(net) * np.maximum(np.abs(net) - grip, 0.0)
    return np.where(v_zero, held, net - values["dry"] * np.sign(v))


def recording_of(
    values: Mapping[str, float] = TRUTH,
    *,
    sweep: tuple[float, float, float] | None = None,
    begin: tuple[float, float] = (0.0, 0.0),
    fs: float = 500.0,
    seconds: float = 6.0,
    quantity: str = "displacement",
    noise: float = 1e-6,
    offset: float = 0.0,
    force_noise: float = 0.0,
    seed: int = 0,
    name: str = "run",
) -> Recording:
    """A recording of Eq. 17 by the project's reference integrator.

    Args:
        values: of Eq. 17.
        sweep: (N, Hz, Hz) level, first and last frequency of a force that is smooth between its samples; None: free.
        begin: displacement and velocity at the first sample.
        fs, seconds: sampling.
        quantity: what is recorded.
        noise: standard deviation of the displacement's noise; of the others it is that times omega0 or omega0².
        offset: what the sensor shows at zero, in the quantity's unit.
        force_noise: standard deviation of the force channel's noise, N.
        seed: of both noises.
        name: the recording's.
    """
    random = np.random.default_rng(seed)
    n = round(seconds * fs)
    t = np.arange(n) / fs
    pieces = np.zeros((n, 1))
    if sweep is not None:
        level, first, last = sweep
        pieces = chirp(level, first, (last - first) / seconds, t, 1 / fs)
    x, v = integrate_pieces(values, pieces[:-1], 1 / fs, *begin)
    y = {"displacement": x, "velocity": v, "acceleration": acceleration(values, x, v, pieces[:, 0])}[quantity]
    size = noise * values["omega0"] ** list(UNITS).index(quantity)
    y = y + offset + size * random.standard_normal(n)
    force = None if sweep is None else pieces[:, 0] + force_noise * random.standard_normal(n)
    return Recording(name, fs, y, force, quantity, UNITS[quantity])


def save(recording: Recording, path: str | Path) -> None:
    """Write a recording as CSV, whose header names time, force where there is one, and quantity with its unit."""
    given = {} if recording.force is None else {"force_N": recording.force}
    shown = {f"{recording.quantity}_{UNITS[recording.quantity].replace('/', '_')}": recording.response}
    columns = {"time_s": np.arange(recording.response.size) / recording.fs, **given, **shown}
    np.savetxt(path, np.column_stack(list(columns.values())), "%.9g", ",", header=",".join(columns), comments="")


def with_mass_added(values: Mapping[str, float], added: float) -> dict[str, float]:
    """Eq. 17 of the same rig with a further mass, kg, on it: all forces stay, and are over a larger mass."""
    part = values["mass"] / (values["mass"] + added)
    scaled = {name: part * values[name] for name in ("cubic", "preload", "viscous", "dry")}
    return {**scaled, "mass": values["mass"] + added, "omega0": part**0.5 * values["omega0"]}
