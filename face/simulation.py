"""A simulated response: along a recording, or under a force of one's own."""

from __future__ import annotations

import gzip
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import BadInput
from ..files.arguments import number_of, path_of, shown, text_of
from ..files.writing import write
from ..model import Oscillator, Response
from ..model.covered import further
from ..model.fit_state import percent_words
from ..model.left import share_of_motion
from ..recording import Recording, recordings_of
from ..recording.content import MOST_MB
from ..recording.fact import changed
from ..recording.frequency import frequency_of
from ..recording.objects import is_series, series_of
from ..recording.plain_numbers import vector_of
from ..recording.recording import HOLDS

#: A first guess of how far a force moves a rig, in static deflections: a resonance that is met in passing.
_RESONANCE = 10.0


@dataclass(frozen=True, eq=False, repr=False)
class Simulation:
    """A response of a model, event-exact.

    Attributes:
        name: of what was simulated.
        time: (n,), s.
        response: (n,) as a sensor would show it, in ``shown.unit``; NaN from where the motion runs away.
        force: (n,) in the unit of the model's force; None for free motion.
        shown: quantity and unit of the response.
        measured: the recording that it runs along; None under a force of one's own.
        beyond: a sentence where its displacement goes further than what the model was identified in.
    """

    name: str
    time: np.ndarray
    response: np.ndarray
    force: np.ndarray | None
    shown: Response
    measured: Recording | None = None
    beyond: str = ""

    @property
    def nrmse(self) -> float | None:
        """rms(simulated - measured) / std(measured); None without a recording."""
        if self.measured is None:
            return None
        return share_of_motion([self.response - self.measured.response], [self.measured.response])

    @property
    def lost(self) -> float | None:
        """From when on, s, the simulation has run away and holds NaN; None where it has not."""
        gone = np.flatnonzero(~np.isfinite(self.response))
        return float(self.time[gone[0]]) if gone.size else None

    def __repr__(self) -> str:
        peak = float(np.nanmax(np.abs(self.response), initial=0.0))
        words = (
            f"{self.name}: {self.shown.quantity} over {self.time.size} samples, {self.time[-1] - self.time[0]:.4g} s, "
            f"up to {self._said(peak)}"
        )
        if self.lost is not None:
            return f"{words}; it runs away at {self.lost:.4g} s"
        if self.nrmse is not None:
            words += f"; leaves {percent_words(100 * self.nrmse)} % of the measured motion, all of it in one run"
        return f"{words}; {self.beyond}" if self.beyond else words

    def _said(self, value: float) -> str:
        """A response in the unit as recorded; under a force of one's own with a fitting prefix."""
        from ..identify.signals.said import said
        from ..model.display import scale_of

        scale = scale_of(self.shown.unit, value)
        return f"{value * scale.factor:.3g} {scale.unit}" if self.measured is None else said(self.measured, value)

    def _repr_html_(self) -> str:
        from .words import paragraph

        return paragraph(repr(self)) + self.plot()._repr_svg_()

    def plot(self) -> Any:
        """Simulated and measured response over time, and what is left; a matplotlib Figure."""
        from ..model.display import scale_of
        from ..report.style import MEASURED, MODEL
        from .plot import new_plot

        scale = scale_of(self.shown.unit, self.response)
        with new_plot(2 if self.measured is not None else 1) as (figure, axes):
            if self.measured is not None:
                measured = np.asarray(self.measured.response)
                axes[0].plot(self.time, measured * scale.factor, color=MEASURED, linewidth=2.2, label="measured")
                axes[1].plot(self.time, (measured - self.response) * scale.factor, color=MODEL, linewidth=0.8)
                axes[1].set_title("What the simulation leaves")
                axes[1].set_xlabel("Time [s]")
                axes[1].set_ylabel(scale.label("Residual"))
            axes[0].plot(self.time, self.response * scale.factor, color=MODEL, linewidth=0.9, label="simulated")
            axes[0].set_title(self.name)
            axes[0].set_xlabel("Time [s]")
            axes[0].set_ylabel(scale.label(self.shown.quantity.capitalize()))
            axes[0].legend(loc="best")
        return figure

    def save(self, path: str | Path) -> Path:
        """Write time, force, measured and simulated response as CSV (.csv or .csv.gz); returns the path."""
        from ..face.simulation import write_columns, write_response

        path = path_of(path, "a CSV file")
        check_csv(path)
        if self.measured is not None:
            write_response(path, self.measured, self.response)
        else:
            force = {} if self.force is None else {"force_N": self.force}
            unit = self.shown.unit.replace("/", "_")
            write_columns(path, {"time_s": self.time, **force, f"{self.shown.quantity}_{unit}": self.response})
        return path


def simulated(
    oscillator: Oscillator,
    given: Sequence[Any],
    initial: tuple[float, float],
    seconds: float | None,
    options: Mapping[str, Any],
) -> Simulation:
    """See ``Model.simulate``."""
    if given:
        return along(oscillator, recordings_of(*given, **options))
    force, fs = options.get("force"), options.get("fs")
    force, instants = _driving(force, options.get("time"))
    if fs is None and instants is not None:
        fs = _rate(instants, force)
    if fs is None or not 0 < frequency_of(fs) < np.inf:
        raise BadInput("without a recording give the sampling frequency, fs in Hz, and a force (n,) or seconds")
    if force is None and seconds is None:
        raise BadInput("without a recording give a force (n,) with fs, or how many seconds of free motion")
    fs = frequency_of(fs)
    samples = None if force is None else vector_of(force, "the force")
    if samples is not None and (samples.ndim != 1 or not samples.size or not np.all(np.isfinite(samples))):
        raise BadInput(f"the force has shape {samples.shape}; give one column of finite numbers")
    beginning = vector_of(initial, "initial, a displacement and a velocity,")
    if beginning.shape != (2,) or not np.all(np.isfinite(beginning)):
        raise BadInput(f"initial must be a displacement and a velocity, not {shown(initial)}")
    longest = MOST_MB * 1e6 / 8 / fs  # as many samples as a recording may have
    if samples is None and not 0 < number_of(seconds, "seconds") <= longest:
        raise BadInput(f"{shown(seconds)} s at {fs:g} Hz: give a number above zero, of at most {longest:.6g} s")
    n = round(float(seconds or 0.0) * fs) if samples is None else samples.size
    if n < 2:
        raise BadInput(f"{seconds} s at {fs:g} Hz are {n} samples; give at least two")
    hold = text_of(oscillator.hold if options.get("hold") is None else options["hold"], "hold")
    if hold not in HOLDS:
        raise BadInput(f"hold {hold[:40]!r} is not known; use one of {', '.join(HOLDS)}")
    response, displacement = _driven(oscillator, samples, n, 1.0 / fs, beginning, hold)
    beyond = _beyond(oscillator, displacement)
    return Simulation(oscillator.name, np.arange(n) / fs, response, samples, oscillator.response, beyond=beyond)


#: A step between two instants may differ from the mean one by this part of it: stamps are rounded.
_UNEVEN = 1e-3


def _driving(force: Any, time: Any) -> tuple[Any, np.ndarray | None]:
    """The force, and its instants (n,) in s: those that are given, else those of a Series by its index."""
    instants = None
    if force is not None and is_series(force):
        _, force, instants = series_of(force)
    if time is not None and not isinstance(time, str | int):
        instants = vector_of(time, "the times")
    return force, instants


def _rate(instants: np.ndarray, force: Any) -> float:
    """Sampling frequency, Hz, of instants (n,); raises BadInput where their steps are uneven, or not the force's."""
    if instants.ndim != 1 or instants.size < 2 or not np.all(np.isfinite(instants)):
        raise BadInput(f"the times have shape {instants.shape}; give one finite time in s for each value of the force")
    if force is not None and (given := vector_of(force, "the force")).shape != instants.shape:
        raise BadInput(f"the force has shape {given.shape}, the times {instants.shape}; give one time for each value")
    steps = np.diff(instants)
    mean = float(np.mean(steps))
    if not mean > 0.0 or np.max(np.abs(steps - mean)) > _UNEVEN * mean:
        raise BadInput("the times of the force do not go on in even steps; interpolate it, or read it as a recording")
    return 1.0 / mean


def along(oscillator: Oscillator, recordings: Sequence[Recording]) -> Simulation:
    """The response to the force of the one recording, from the beginning that comes closest to it.

    Raises BadInput where there is another number of them, or it is of other units than the model.
    """
    from ..identify.fit.hold import held_as
    from ..identify.identification import of_one_motion
    from ..identify.motion.decays import find_decays, force_is_silent
    from ..identify.motion.modes import in_the_same_band
    from ..identify.problem.replay import replay

    if len(recordings) != 1:
        named = f"; name one of {', '.join(r.name for r in recordings[:5])}" if recordings else ""
        raise BadInput(f"simulate makes one response, and {len(recordings)} records were given{named}")
    (measured,) = in_the_same_band(held_as(recordings, oscillator.hold), oscillator.identified.band)
    if not of_one_motion(measured, oscillator.response):
        raise BadInput(
            f"{measured.name}: records {measured.quantity} in {measured.unit}, {oscillator.name} is of "
            f"{oscillator.response.quantity} in {oscillator.response.unit}; "
            "say what the column is with --quantity and --unit"
        )
    if measured.rides and not oscillator.takes_acceleration:  # which per unit mass is the same equation
        oscillator = replace(oscillator, mass=None)
    if oscillator.mass is None and not measured.rides and measured.force is not None and np.any(measured.force):
        if not (force_is_silent(measured) and find_decays(measured)):
            raise BadInput(
                f"{measured.name}: driven, and {oscillator.name} has no mass to tell what a force does: identify it "
                "from a recording with a force, or give it with --mass; or leave the force out with --force none"
            )
        measured = changed(measured, force=None)
    response = replay(oscillator, measured)
    shown = Response(measured.quantity, measured.unit)
    beyond = _beyond(oscillator, response) if shown.quantity == "displacement" else ""
    return Simulation(measured.name, measured.time, response, measured.force, shown, measured, beyond)


def _beyond(oscillator: Oscillator, displacement: np.ndarray) -> str:
    """Whether a motion (n,) swings further than any that the model was identified in, in words; empty where not."""
    motion = displacement[np.isfinite(displacement)]
    swing = 0.5 * float(np.ptp(motion)) if motion.size else 0.0
    both = further(oscillator, oscillator.amplitude, swing)
    return "" if both is None else f"it swings by {both[0]}, and the model was identified up to {both[1]}"


def _driven(
    oscillator: Oscillator, force: np.ndarray | None, n: int, dt: float, initial: np.ndarray, hold: str
) -> tuple[np.ndarray, np.ndarray]:
    """Response and displacement, (n,) each."""
    from ..identify.problem.segments import FORCE_BAND
    from ..simulate.core import core_of, step_for
    from ..simulate.force import force_between

    values, omega = oscillator.values(), max(oscillator.omega0.value, 1e-6)
    highest = FORCE_BAND * omega / (2 * np.pi)
    pushed = None if force is None else force_between(force, dt, hold, highest)
    core = core_of(oscillator)
    begin = np.concatenate([initial, np.zeros(len(core.equations.inner))])
    size = float(np.max(np.abs(force))) / values.get("mass", 1.0) / omega**2 * _RESONANCE if force is not None else 0.0
    peak = max(abs(begin[0]), abs(begin[1]) / omega, size)

    def run(peak: float, *, states: bool = False) -> np.ndarray:
        step = step_for(oscillator, peak or 1e-6, n * dt)
        return core.record(np.array(list(values.values())), begin, pushed, n, dt, step, states=states)

    displacement = run(peak, states=True)[:, 0]
    return run(max(peak, float(np.nanmax(np.abs(displacement), initial=0.0)))), displacement


# A simulated response beside the measured one, as CSV.


def write_response(path: Path, recording: Recording, simulated: np.ndarray) -> None:
    """Write time, force, measured and simulated response, units in the header; gzipped where the name ends in .gz.

    Args:
        path: file to write, whole or not at all.
        recording: what was measured, (n,).
        simulated: (n,), in the unit of the recording's response.
    """
    unit = recording.unit.replace("/", "_")
    columns = {"time_s": recording.time}
    if recording.force is not None:
        columns[f"force_{recording.force_unit}"] = recording.force
    columns[f"{recording.quantity}_{unit}"] = recording.response
    columns[f"simulated_{recording.quantity}_{unit}"] = simulated
    write_columns(path, columns)


def check_csv(path: Path) -> None:
    """Raises BadInput where a file's name is not that of a table."""
    if not path.name.endswith((".csv", ".csv.gz")):
        raise BadInput(f"{path}: a simulation is written as CSV; end the name in .csv or .csv.gz")


def write_columns(path: Path, columns: Mapping[str, np.ndarray]) -> None:
    """Write columns (n,) under their names as CSV; gzipped where the name ends in .gz."""
    text = io.StringIO()
    np.savetxt(text, np.column_stack(list(columns.values())), "%.9g", ",", header=",".join(columns), comments="")
    content = text.getvalue().encode("utf-8")
    write(path, gzip.compress(content, mtime=0) if path.suffix == ".gz" else content)
