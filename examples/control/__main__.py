"""``python -m dashpot.examples.control [DIR]``: identifies the rig, runs both controllers, draws ``control.svg``."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from ...model import Oscillator
from ...report.chart import Chart, Panel
from ...report.matplotlib_figure import save
from ...report.style import AFTER, BEFORE, EXACT, MEASURED
from ..identified import folder_named, identified
from . import damping, tracking

TURN_ON = 0.1  # s that the tracking takes to settle


def main(arguments: list[str]) -> None:
    """Both experiments in a folder, by default ``control``."""
    folder = folder_named(
        arguments,
        "control",
        "An identified rig under predictive control and under LQR with a Kalman filter; draws control.svg.",
    )
    model, fmu = identified(folder)
    picture, sentences = compare(model, fmu, folder)
    save(picture, folder / "control.svg")
    print("\n".join([*sentences, f"written: {folder / 'control.svg'}"]))


def compare(model: Oscillator, fmu: Path, folder: Path, seconds: float = 0.6) -> tuple[Chart, list[str]]:
    """A chart of both experiments, and what came out in a sentence each."""
    chart = Chart("control", "Tracking error of two predictive controllers; damping by two regulators")
    above, below = chart.row(1, 1, height=230), chart.row(1, 1, height=230)
    return chart, [_tracking(*above, model, fmu, folder, seconds), _damping(*below, model, fmu)]


def _tracking(path: Panel, missed: Panel, model: Oscillator, fmu: Path, folder: Path, seconds: float) -> str:
    errors = {}
    for name, linear, color in (("linear", True, BEFORE), ("nonlinear", False, AFTER)):
        force = tracking.controller(tracking.predictor(model, folder, linear=linear))
        x = tracking.follow(fmu, force, seconds)
        t = tracking.SAMPLE * np.arange(x.size)
        error = x - tracking.reference(t)
        errors[name] = float(np.max(np.abs(error[t >= TURN_ON]))) / tracking.AMPLITUDE
        path.line(t, 1e3 * x, color)
        missed.line(t[t >= TURN_ON], 1e6 * error[t >= TURN_ON], color, f"{name} prediction")
    path.line(t, 1e3 * tracking.reference(t), EXACT, "reference", dash="--", width=0.9)
    path.title, missed.title = "Model predictive control", "What it misses the reference by"
    for panel, label in ((path, "Displacement [mm]"), (missed, "Error [µm]")):
        panel.x.set(label="Time [s]")
        panel.y.set(label=label)
    return (
        f"model predictive control of {1e3 * tracking.AMPLITUDE:g} mm at {tracking.FREQUENCY:g} Hz: largest error "
        f"{100 * errors['linear']:.2g} % of the amplitude by the linear model, {100 * errors['nonlinear']:.2g} % by all"
    )


def _damping(motion: Panel, missed: Panel, model: Oscillator, fmu: Path) -> str:
    settled = {}
    designs = (
        ("free", None, MEASURED),
        ("designed at rest", damping.at_rest(model), BEFORE),
        ("designed about the motion", damping.about_motion(model), AFTER),
    )
    for name, pair, color in designs:
        states, known = damping.run(fmu, None if pair is None else damping.regulator(*pair))
        t = damping.SAMPLE * np.arange(len(states))
        motion.line(t, 1e3 * states[:, 0], color, name, width=0.8 if pair is None else 1.4)
        settled[name] = 1e3 * float(t[np.flatnonzero(np.abs(states[:, 0]) > 0.1 * damping.START)[-1]])
        if pair is not None:
            missed.line(t, 1e3 * (known - states)[:, 1], color)
    motion.title, missed.title = "LQR with a Kalman filter", "What the filter takes the velocity wrong by"
    for panel, label in ((motion, "Displacement [mm]"), (missed, "Error [mm/s]")):
        panel.x.set(label="Time [s]")
        panel.y.set(label=label)
    rest, about = settled["designed at rest"], settled["designed about the motion"]
    return (
        f"LQR with a Kalman filter from {1e3 * damping.START:g} mm: below a tenth after {about:.0f} ms where it was "
        f"designed about the motion, {rest:.0f} ms at rest, {settled['free']:.0f} ms or more free"
    )


if __name__ == "__main__":
    main(sys.argv[1:])
