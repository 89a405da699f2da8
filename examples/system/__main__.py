"""``python -m dashpot.examples.system [DIR]``: two coupled rigs, told in four ways and damped; draws ``system.svg``."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from ...report.chart import Chart
from ...report.matplotlib_figure import save
from ...report.style import AFTER, BEFORE, EXACT, FORCED, MEASURED
from ..identified import folder_named, identified
from .coupled import WAYS, Rig, coupled

STIFFNESS, PAYLOAD, START = 1000.0, 0.1, 5e-3  # N/m, kg, m
GAIN = 4.0  # N.s/m, of the controller's velocity feedback
STEP, FINE = 1e-3, 1e-4  # s; the latter with curvature is the reference
_COLORS = dict(zip(WAYS, (BEFORE, MEASURED, AFTER, FORCED), strict=True))


def main(arguments: list[str]) -> None:
    """The experiment in a folder, by default ``system``."""
    folder = folder_named(
        arguments, "system", "Two rigs coupled through a spring, told in four ways and damped; draws system.svg."
    )
    picture, sentences = compare(identified(folder)[1])
    save(picture, folder / "system.svg")
    print("\n".join([*sentences, f"written: {folder / 'system.svg'}"]))


def compare(fmu: Path, seconds: float = 1.0) -> tuple[Chart, list[str]]:
    """A chart of the errors and of the controlled motion, and the errors in a sentence each."""
    rigs = (Rig(x0=START), Rig(payload=PAYLOAD))
    true = coupled(fmu, rigs, STIFFNESS, way="curvature", step=FINE, seconds=seconds)[:: round(STEP / FINE)]
    t, sentences = STEP * np.arange(len(true)), []
    chart = Chart("system", "Errors of co-simulation over time; motion with and without a controller")
    errors, motion = chart.row(1, 1)
    for way in WAYS:
        error = np.abs(coupled(fmu, rigs, STIFFNESS, way=way, step=STEP, seconds=seconds) - true).max(axis=1) / START
        errors.line(t[1:], 100 * np.maximum.accumulate(error[1:]), _COLORS[way], way)
        sentences.append(f"{way:12} largest error {100 * error.max():.2g} % of the start's displacement")
    errors.title = "Coupled at 1 ms, not iterated"
    errors.x.set(label="Time [s]")
    errors.y.set(label="Largest error so far [% of the start]", log=True, low=1e-4, high=100.0)
    damped = (Rig(x0=START, actuator=lambda _t, _x, v: -GAIN * v), rigs[1])
    controlled = coupled(fmu, damped, STIFFNESS, way="curvature", step=STEP, seconds=seconds)
    motion.line(t, 1e3 * true[:, 1], EXACT, "free", width=0.9)
    motion.line(t, 1e3 * controlled[:, 1], AFTER, "the other rig's controller on")
    motion.title = "The rig with the payload"
    motion.x.set(label="Time [s]")
    motion.y.set(label="Displacement [mm]")
    return chart, sentences


if __name__ == "__main__":
    main(sys.argv[1:])
