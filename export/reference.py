"""A reference result: a short sweep within the model's validity and the exact response, to hold importers against.

It lies in ``extra/dashpot``: FMI 2.0.5 (section 2.3) and FMI 3.0 (section 2.5.1) keep ``extra`` for what tools add and
recommend a folder named after a domain in reverse; dashpot has none, so the folder has its name.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..model.display import number
from ..simulate.casadi_step import exact_output, exact_step
from ..simulate.compiler import find_compiler
from ..simulate.core import core_of
from ..simulate.force import Force, straight_lines
from .description import Description
from .facts import LARGE, Facts
from .render import plain_text

if TYPE_CHECKING:
    from ..model import Oscillator

FOLDER = "extra/dashpot"
_SAMPLES = 601
#: At least so many samples a cycle, so that a hold of the force is not too far from the force itself.
_SAMPLES_A_CYCLE = 25
#: The sweep in parts of the natural frequency; the peak it should reach, in parts of the largest valid amplitude.
_FROM, _TO = 0.7, 1.4
_LEAST, _MOST = 0.45, LARGE
#: A motion below this part of the largest amplitude shows nothing of the model.
_LITTLE = 1e-3
_TRIALS = 20
#: Internal steps that the sweep may take: a model with a far faster motion inside would keep an export waiting.
_MOST_STEPS = 1e6


@dataclass(frozen=True, eq=False)
class Reference:
    """A sweep from rest and the response to it.

    Attributes:
        level: amplitude of the force, in the unit of ``F``.
        start, end: of the sweep, Hz.
        time, force: (n,) s and the unit of ``F``.
        straight: (n, 4) outputs with the force in straight lines from sample to sample.
        held: (n, 4) outputs with the force held from sample to sample; at a sample, before it jumps there.
    """

    level: float
    start: float
    end: float
    time: np.ndarray
    force: np.ndarray
    straight: np.ndarray
    held: np.ndarray


def reference_result(facts: Facts, description: Description) -> dict[str, bytes]:
    """Input, outputs and a word about them by their names in the archive; the same model gives the same bytes.

    Raises BadInput where a value of the model is not finite.
    """
    result = reference(facts)
    if isinstance(result, str):
        name = plain_text(facts.oscillator.name) or "the model"
        return {f"{FOLDER}/README.txt": f"There is no reference result of {name}: {result}.\n".encode()}
    outputs = ["time", *facts.equations.output_names]
    tables = {
        "input.csv": (["time", "F"], np.column_stack([result.time, result.force])),
        "output_straight.csv": (outputs, np.column_stack([result.time, result.straight])),
        "output_held.csv": (outputs, np.column_stack([result.time, result.held])),
    }
    files = {f"{FOLDER}/{name}": _csv(*table).encode() for name, table in tables.items()}
    return {f"{FOLDER}/README.txt": _words(facts, description, result).encode(), **files}


def reference(facts: Facts) -> Reference | str:
    """The sweep that keeps the model within its validity, and the response; or in words why there is none.

    Raises BadInput where a value of the model is not finite.
    """
    oscillator, top = facts.oscillator, facts.amplitude
    run = _Run(facts)
    omega, h = facts.natural
    dt = _round_down(2 * math.pi / omega / _SAMPLES_A_CYCLE)
    if dt * _SAMPLES > _MOST_STEPS * facts.max_step:
        return f"its fastest motion needs internal steps of {facts.max_step:.2g} s, too many for a sweep"
    start, end = _band(oscillator, omega / (2 * math.pi))
    time = np.array([float(f"{k * dt:.12g}") for k in range(_SAMPLES)])
    phase = 2 * np.pi * (start * time + (end - start) * time**2 / (2 * time[-1]))
    mass = oscillator.mass.value if oscillator.mass is not None else 1.0
    level = mass * _MOST * top * omega * max(2 * h, 0.2 * omega)
    best, low, high = None, None, None
    for _ in range(_TRIALS):
        level = float(f"{level:.3g}")
        if not 1e-300 < level < 1e300:
            break
        # as the file has it: the response is that to the numbers a reader finds there
        force = np.array([float(f"{u:.8e}") for u in level * np.sin(phase)])
        straight = run(straight_lines(force, dt), force, dt)
        peak = float(np.max(np.abs(straight[:, 1])))
        if np.all(np.isfinite(straight)) and peak <= _MOST * top:
            low = level
            # friction may hold it nearly all the time
            best = (level, force, straight) if peak >= _LITTLE * top else best
            if peak >= _LEAST * top:
                break
            level = 2 * level if high is None else math.sqrt(level * high)
        else:
            high = level
            level = level / 2 if low is None else math.sqrt(level * low)
    if best is None:
        return f"no sweep from rest was found that moves it, and by less than {number(top)} {_length(oscillator)}"
    level, force, straight = best
    held = Force(np.column_stack([force[:-1], np.zeros((_SAMPLES - 1, 3))]))
    response = run(held, np.append(force[0], force[:-1]), dt)
    if not np.all(np.isfinite(response)):
        return "under a force that is held from sample to sample its motion grows beyond bounds"
    return Reference(level, start, end, time, force, straight, response)


class _Run:
    """The model from rest, by the compiled core or, where there is no compiler, by the CasADi step that repeats it."""

    def __init__(self, facts: Facts) -> None:
        import casadi as ca

        self.facts = facts
        self.values = np.array(list(facts.values.values()))
        eq = facts.equations
        y = exact_output(eq, eq.z, eq.u, eq.p, eq.t)
        self.output = ca.Function("output", [eq.z, eq.u, eq.p, eq.t], [y])

    def __call__(self, force: Force, at_samples: np.ndarray, dt: float) -> np.ndarray:
        """(n, 4) outputs under the force, which is (n,) ``at_samples`` where they are read."""
        n = at_samples.size
        z = self._states(force, n, dt)
        time = np.arange(n) * dt
        p = np.tile(self.values[:, None], n)
        return np.array(self.output(z.T, at_samples[None, :], p, time[None, :])).T

    def _states(self, force: Force, n: int, dt: float) -> np.ndarray:
        oscillator, longest = self.facts.oscillator, self.facts.max_step
        rest = np.zeros(self.facts.equations.z.numel())
        if find_compiler() is not None:
            return core_of(oscillator).record(self.values, rest, force, n, dt, longest, states=True)
        step = exact_step(oscillator, dt, longest)
        states = [rest]
        for k in range(n - 1):
            ends = [force.pieces[k, 0], force.pieces[k, 0] + force.pieces[k, 1] * dt]
            states.append(np.array(step(states[-1], ends, self.values, k * dt, dt)).ravel())
        return np.array(states)


def _band(oscillator: Oscillator, natural: float) -> tuple[float, float]:
    """Frequencies of the sweep, Hz: about the natural one, within what the recordings covered."""
    start, end = _FROM * natural, _TO * natural
    valid = oscillator.frequency
    if valid is not None and max(start, valid.min) < min(end, valid.max):
        start, end = max(start, valid.min), min(end, valid.max)
    return float(f"{start:.3g}"), float(f"{end:.3g}")


def _round_down(step: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above ``step``."""
    power = math.floor(math.log10(step))
    digit = max(d for d in (1, 2, 5) if d == 1 or d * 10.0**power <= step)
    return float(f"{digit}e{power}")


def _csv(names: list[str], columns: np.ndarray) -> str:
    """The columns, (n, names), to nine digits: an importer is held against them to a millionth of the peak."""
    rows = [",".join([f"{row[0]:.12g}", *(f"{value + 0.0:.8e}" for value in row[1:])]) for row in columns]
    return "\n".join([",".join(names), *rows]) + "\n"


def _words(facts: Facts, description: Description, result: Reference) -> str:
    o = facts.oscillator
    unit = {v.name: v.unit for v in description.variables}
    dt, stop = result.time[1], result.time[-1]
    bend = (result.end - result.start) / (2 * stop)
    peak = float(np.max(np.abs(result.straight[:, 1])))
    valid = "" if o.amplitude is None else f"; the model is valid to {o.amplitude.max:.4g} {o.amplitude.unit}"
    columns = ", ".join(f"{name} [{unit[name]}]" for name in facts.equations.output_names)
    return f"""\
Reference result of {plain_text(o.name) or "the model"}

A sine sweep from {result.start:g} to {result.end:g} Hz in {stop:g} s, from rest, all variables at their start values:

    F(t) = {result.level:g} {unit["F"]} sin(2 pi ({result.start:g} t + {bend:.6g} t^2))

sampled every {dt:g} s. The largest displacement is {peak:.4g} {_length(o)}{valid}.

input.csv            time [s], F [{unit["F"]}]
output_straight.csv  time [s], {columns}:
                     F runs in a straight line from each sample to the next (FMI 2.0: fmi2SetRealInputDerivatives
                     before each step; an input F_rate, where there is one: the slope over the coming step)
output_held.csv      the same with F held from each sample to the next, as most importers do:
                     fmpy simulate FILE.fmu --input-file input.csv --output-interval {dt:g} --stop-time {stop:g}

How far the two differ is what the hold costs. Acceleration in output_held.csv is that before F jumps.
Computed by dashpot with located events and internal steps of at most max_step; nine digits. Another importer should
agree to a millionth of the peak of each column.
"""


def _length(o: Oscillator) -> str:
    return plain_text(o.response.displacement_unit)
