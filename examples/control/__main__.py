"""``python -m dashpot.examples.control [DIR]``: identifies the rig, runs both controllers, draws ``control.svg``."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from ...files.writing import write
from ...model import Oscillator
from ...report.style import AFTER, BEFORE, EXACT, MEASURED, drawing, svg
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
    write(folder / "control.svg", picture)
    print("\n".join([*sentences, f"written: {folder / 'control.svg'}"]))


def compare(model: Oscillator, fmu: Path, folder: Path, seconds: float = 0.6) -> tuple[str, list[str]]:
    """SVG of both experiments, and what came out in a sentence each."""
    with drawing(height=5.6) as figure:
        rows = figure.subplots(2, 2, sharex="row")
        sentences = [_tracking(rows[0], model, fmu, folder, seconds), _damping(rows[1], model, fmu)]
        return svg(
            figure, "control", "Tracking error of two predictive controllers; damping by two regulators"
        ), sentences


def _tracking(axes, model: Oscillator, fmu: Path, folder: Path, seconds: float) -> str:
    errors = {}
    for name, linear, color in (("linear", True, BEFORE), ("nonlinear", False, AFTER)):
        force = tracking.controller(tracking.predictor(model, folder, linear=linear))
        x = tracking.follow(fmu, force, seconds)
        t = tracking.SAMPLE * np.arange(x.size)
        error = x - tracking.reference(t)
        errors[name] = float(np.max(np.abs(error[t >= TURN_ON]))) / tracking.AMPLITUDE
        axes[0].plot(t, 1e3 * x, color=color)
        axes[1].plot(t[t >= TURN_ON], 1e6 * error[t >= TURN_ON], color=color, label=f"{name} prediction")
    axes[0].plot(t, 1e3 * tracking.reference(t), "--", color=EXACT, lw=0.9, label="reference")
    axes[0].set(title="Model predictive control", xlabel="Time [s]", ylabel="Displacement [mm]")
    axes[1].set(title="What it misses the reference by", xlabel="Time [s]", ylabel="Error [µm]")
    axes[1].set_ylim(-1.5 * axes[1].get_ylim()[1], None)  # room for the legend
    axes[1].legend(loc="lower center", ncols=2)
    return (
        f"model predictive control of {1e3 * tracking.AMPLITUDE:g} mm at {tracking.FREQUENCY:g} Hz: largest error "
        f"{100 * errors['linear']:.2g} % of the amplitude by the linear model, {100 * errors['nonlinear']:.2g} % by all"
    )


def _damping(axes, model: Oscillator, fmu: Path) -> str:
    settled = {}
    designs = (
        ("free", None, MEASURED),
        ("designed at rest", damping.at_rest(model), BEFORE),
        ("designed about the motion", damping.about_motion(model), AFTER),
    )
    for name, pair, color in designs:
        states, known = damping.run(fmu, None if pair is None else damping.regulator(*pair))
        t = damping.SAMPLE * np.arange(len(states))
        axes[0].plot(t, 1e3 * states[:, 0], color=color, label=name, lw=0.8 if pair is None else None)
        settled[name] = 1e3 * float(t[np.flatnonzero(np.abs(states[:, 0]) > 0.1 * damping.START)[-1]])
        if pair is not None:
            axes[1].plot(t, 1e3 * (known - states)[:, 1], color=color)
    axes[0].set(title="LQR with a Kalman filter", xlabel="Time [s]", ylabel="Displacement [mm]")
    axes[0].set_ylim(-1.0, None)
    axes[0].legend(loc="lower right")
    axes[1].set(title="What the filter takes the velocity wrong by", xlabel="Time [s]", ylabel="Error [mm/s]")
    rest, motion = settled["designed at rest"], settled["designed about the motion"]
    return (
        f"LQR with a Kalman filter from {1e3 * damping.START:g} mm: below a tenth after {motion:.0f} ms where it was "
        f"designed about the motion, {rest:.0f} ms at rest, {settled['free']:.0f} ms or more free"
    )


if __name__ == "__main__":
    main(sys.argv[1:])
