"""What a law of the library does to a rig, drawn: the tell-tales by which it is known in a recording.

The rig is a slightly hardening spring with viscous damping, once alone and once with the law at a size that shows. What
is drawn follows from where the law acts: backbone and damping curve of what acts on the motion, the frequency response
at two levels of what lies between force and record, a decay over time of what changes by itself; and always the
spectrum that a sine leaves. All of it is computed by the package's own describing functions and simulation.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from ..model import Oscillator
from ..model.describing import natural_motion
from ..model.law import Law, LawParameter, Scales
from ..model.laws import BASE
from ..model.oscillator import Response
from ..simulate.core import core_of, internal_step
from ..simulate.force import force_between
from .chart import Chart, Panel
from .style import AFTER, EXACT

#: The rig: 12.7 Hz, 2 % of critical damping, 2.5 % stiffer in frequency at the largest amplitude, 8 mm.
LENGTH, OMEGA = 8e-3, 79.6
RIG = {"mass": 0.27, "omega0": OMEGA, "cubic": 7e6, "preload": 0.0, "viscous": 3.2, "dry": 0.0}
#: What the laws of Eq. 17 are shown by, in place of the rig's own.
_MORE = {"omega0": 1.05 * OMEGA, "cubic": 2.8e7, "preload": 0.3, "viscous": 6.4, "dry": 0.3}
#: The force that drives it, N, to some 6 mm in resonance.
FORCE = 0.27 * 3.2 * OMEGA * 6e-3
SCALES = Scales(LENGTH, OMEGA, FORCE, LENGTH, duration=4.0, mass=0.27, lines=(2.4 * OMEGA,))
#: Size of a strength as a part of what is natural for its unit, by where the law acts: springs show less than dampers.
_STRENGTHS = {"dissipation": 0.03, "environment": 0.1, "measurement": 0.04}
_STRENGTH = 0.2
#: A friction, as a part of the force that drives the rig.
_FRICTION = 0.2
#: Cycles that a driven rig is given to settle, that are looked at, and samples of each.
_SETTLE, _LOOK, _SAMPLES = 60, 40, 64
#: Frequencies at which a response is computed, over the natural one, and its levels over FORCE.
_RATIOS = np.linspace(0.65, 1.35, 57)
_LEVELS = (1.0, 0.25)
_HARMONICS = 8
#: What lies below this, in dB of the fundamental, is not drawn.
_FLOOR = -90.0


@dataclass(frozen=True, eq=False)
class Pair:
    """The rig alone and with the law."""

    without: Oscillator
    having: Oscillator

    @property
    def both(self) -> tuple[tuple[Oscillator, dict[str, Any]], ...]:
        """Each with how it is drawn."""
        return (
            (self.without, {"color": EXACT, "dash": "--", "width": 0.9, "label": "without it"}),
            (self.having, {"color": AFTER, "label": "with the law"}),
        )


def example(law: Law) -> Pair:
    """The rig alone, and with the law at a size that shows; of a law of Eq. 17 with more of it than the rig has."""
    own = law in BASE
    values = _MORE if own else {f"{law.name}.{p.name}": size_that_shows(law, p) for p in law.parameters}
    taken = {p.name: values[p.name] for p in law.parameters} if own else values
    response = Response("displacement", "m")
    having = Oscillator.from_values({**RIG, **taken}, laws=() if own else (law,), response=response)
    return Pair(Oscillator.from_values(RIG, response=response), having)


def size_that_shows(law: Law, p: LawParameter) -> float:
    """A value of a law's parameter at which the law shows on the rig, in the parameter's unit."""
    if p.probes == "lines":
        return SCALES.lines[0]
    if law.path == "dissipation" and p.unit == "X/s2":
        return _FRICTION * FORCE / RIG["mass"]
    probe = p.probes[len(p.probes) // 2] if p.probes else 1.0
    part = _STRENGTHS.get(law.path, _STRENGTH) if p.strength else 1.0
    return float(np.clip(part * float(probe) * p.natural(SCALES), p.lower, p.upper))


def law_figure(law: Law, key: str) -> Chart:
    """Chart of three pictures; ``key`` names it."""
    pair = example(law)
    chart = Chart(key)
    first, second, third = chart.row(1, 1, 1, height=240)
    if law.path == "environment":
        _decay(first, second, pair)
        shown = "a decay's frequency and amplitude over time"
    elif law.force is None or law.path == "inertia":
        _responses(first, second, pair)
        shown = "the frequency response at two levels"
    else:
        _curves(first, second, pair)
        shown = "backbone and damping curve"
    _spectra(third, pair)
    chart.title = f"{law.name}: {shown}, and the spectrum that a sine leaves, with the law and without"
    return chart


def _curves(backbone: Panel, curve: Panel, pair: Pair) -> None:
    amplitude = np.geomspace(0.02, 1.0, 80) * LENGTH
    for model, how in pair.both:
        omega, h = natural_motion(model, amplitude)
        backbone.line(omega / (2 * np.pi), 1e3 * amplitude, **how)
        curve.line(1e3 * amplitude, h, **how)
    backbone.title, curve.title = "Backbone", "Damping curve"
    backbone.x.set(label="Natural frequency [Hz]")
    backbone.y.set(label="Amplitude [mm]", low=0.0)
    curve.x.set(label="Amplitude [mm]", low=0.0)
    curve.y.set(label="h [1/s]", low=0.0)
    low, high = backbone.limits("x")
    if high - low < 0.5:  # a curve that stays is to look so
        backbone.x.set(low=(low + high) / 2 - 0.25, high=(low + high) / 2 + 0.25)


def _responses(size: Panel, phase: Panel, pair: Pair) -> None:
    for model, how in pair.both:
        for level, width in zip(_LEVELS, (1.5, 0.8), strict=True):
            tone = np.array([fundamental(model, level * FORCE, ratio * OMEGA) for ratio in _RATIOS]) / (level * FORCE)
            share = "full" if level == 1 else "a quarter of the"
            style = {**how, "width": width, "label": f"{how['label']}, {share} force"}
            size.line(_RATIOS * OMEGA / (2 * np.pi), 1e3 * np.abs(tone), **style)
            phase.line(_RATIOS * OMEGA / (2 * np.pi), np.degrees(np.unwrap(np.angle(tone))), **style)
    size.title, phase.title = "Response over force", "Its phase"
    for panel in (size, phase):
        panel.x.set(label="Frequency [Hz]")
    size.y.set(label="[mm/N]", low=0.0)
    phase.y.set(label="[°]")


def _decay(pace: Panel, size: Panel, pair: Pair) -> None:
    dt = 2 * np.pi / OMEGA / _SAMPLES
    for model, how in pair.both:
        x = _run(model, None, round(SCALES.duration / dt), dt, begin=LENGTH)
        t = dt * np.arange(x.size)
        x = x - np.mean(x[-10 * _SAMPLES :])
        up = np.flatnonzero((x[:-1] < 0) & (x[1:] >= 0))
        crossing = t[up] - dt * x[up] / (x[up + 1] - x[up])
        peak = [np.max(np.abs(x[a:b])) for a, b in pairwise(up)]
        pace.line(crossing[1:], 1 / np.diff(crossing), **how)
        size.line(crossing[1:], 1e3 * np.array(peak), **how)
    pace.title, size.title = "Frequency of a decay", "Its amplitude"
    for panel in (pace, size):
        panel.x.set(label="Time [s]")
    pace.y.set(label="[Hz]")
    size.y.set(label="[mm]", log=True)


def _spectra(panel: Panel, pair: Pair) -> None:
    for model, how in pair.both:
        order, level = spectrum(model)
        panel.line(order, np.maximum(level, _FLOOR), **{**how, "width": 1.0})
    panel.title = "Spectrum under a sine"
    ticks = [(float(n), str(n)) for n in range(1, _HARMONICS + 1)]
    panel.x.set(label="Frequency over the sine's", low=0.0, high=_HARMONICS + 0.5, names=ticks)
    panel.y.set(label="Acceleration [dB]", low=_FLOOR, high=5.0)


def spectrum(model: Oscillator) -> tuple[np.ndarray, np.ndarray]:
    """Of what is recorded under a sine at the natural frequency, turned into an acceleration.

    Returns:
        Frequency over the sine's (n,), and the level (n,) in dB of the fundamental.
    """
    steady = _driven(model, FORCE, OMEGA)
    window = np.blackman(steady.size)
    order = np.arange(steady.size // 2 + 1) / _LOOK
    lines = np.abs(np.fft.rfft((steady - np.mean(steady)) * window)) * order**2
    near = int(np.argmax(lines * (np.abs(order - 1) < 0.5)))
    inside = order <= _HARMONICS + 0.5
    with np.errstate(divide="ignore"):
        return order[inside], 20 * np.log10(lines[inside] / lines[near])


def harmonics(model: Oscillator, least: float = -60.0) -> list[tuple[int, float]]:
    """The harmonics, from the second, that ``spectrum`` shows above ``least`` dB: order and level."""
    order, level = spectrum(model)
    at = {n: float(np.max(level[np.abs(order - n) < 2.5 / _LOOK])) for n in range(2, _HARMONICS + 1)}
    return [(n, value) for n, value in at.items() if value > least]


def fundamental(model: Oscillator, force: float, omega: float) -> complex:
    """What is recorded of a steady motion under ``force`` cos(``omega`` t), N: its complex amplitude, m."""
    steady = _driven(model, force, omega)
    turn = np.exp(-2j * np.pi * np.arange(steady.size) / _SAMPLES)
    return complex(2 * np.mean(steady * turn))


def _driven(model: Oscillator, force: float, omega: float) -> np.ndarray:
    """The last (n,) samples, whole cycles from a crest of the force, of a run from rest."""
    n, dt = (_SETTLE + _LOOK) * _SAMPLES, 2 * np.pi / omega / _SAMPLES
    given = force * np.cos(2 * np.pi * np.arange(n + 1) / _SAMPLES)
    return _run(model, given, n, dt)[_SETTLE * _SAMPLES :]


def _run(model: Oscillator, force: np.ndarray | None, n: int, dt: float, begin: float = 0.0) -> np.ndarray:
    core, values = core_of(model), model.values()
    smooth = None if force is None else force_between(force, dt, "smooth", 2.0 / (dt * _SAMPLES))
    numbers = np.array([values[name] for name in core.parameter_names])
    step = internal_step(model, values, LENGTH)
    return core.record(numbers, np.array([begin, 0.0]), smooth, n, dt, step)
