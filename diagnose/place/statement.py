"""The sentence that says where the mismatch lies, so that a person can act on it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ...files.spoken import spoken
from ...identify.signals.registry import numerics
from ...model import Oscillator
from ...model.units import compose
from ..limits import ALL_AMPLITUDES
from ..result import RecordFit
from ..wording import figure, quantity
from .free_form import KINDS, TURNING, Rows, explained, idle, solve
from .mismatch_ranges import where_it_is
from .what_it_follows import LOCKED, Symptoms, with_kind

_PARAMETERS = numerics(3, "parameters", why="place, side and strength of an onset")
_FEWEST = numerics(50, "samples", why="beyond an onset, or it is fitted to their noise")

_ONSETS = numerics(
    np.linspace(0.1, 0.9, 17),
    "parts of the largest displacement",
    why="a grid of places at which an onset is looked for",
)
_SPEEDS = numerics(
    np.array([0.02, 0.04, 0.08, 0.15]),
    "parts of the largest speed",
    why="a grid of speeds at which friction may change, even in the logarithm",
)
_NO_DELAY = numerics(2 * np.pi, "rad", why="a delay by more than a cycle would look like one by a cycle less")

#: Low and high by the name of the coordinate, as in ``Location``.
Ranges = dict[str, tuple[float, float]]


def what_it_follows(signature: Symptoms, model: Oscillator, ranges: Ranges) -> tuple[str, Ranges]:
    """The first half of the sentence, and the ranges that it narrows."""
    rows, unit = signature.rows, model.response.displacement_unit
    if signature.kind in ("tone", "ringing") and signature.line is not None:
        line = signature.line
        pull = quantity(line.amplitude, compose("X/s2", unit))
        what = f"at {line.frequency_hz:.4g} Hz, "
        if line.steady:
            what += f"whatever the motion: a force of {pull} per unit mass that was not recorded"
        else:
            what += f"more where the rig moves more, about {pull} per unit mass: a second body that rings"
        return what, {"frequency_hz": (line.frequency_hz, line.frequency_hz)}
    if signature.kind == "displacement":
        what, acts = _over_displacement(rows, unit, ranges["displacement"])
        return what, {"displacement": acts}
    if signature.kind in ("velocity", "damping by position"):
        return _over_velocity(rows, signature, unit), {}
    return _in_words(signature, rows, model, ranges), {}


def _over_displacement(rows: Rows, unit: str, full: tuple[float, float]) -> tuple[str, tuple[float, float]]:
    """The sentence for a force that follows the displacement, and the range where it acts."""
    x = rows.joined(lambda s: s.x)
    size = float(np.max(np.abs(x)))
    smooth = max(_gain(rows, x**2), _gain(rows, x**5), _gain(rows, x**2, x**5))
    best, side, onset = 0.0, 0, 0.0
    pitch = float(_ONSETS[1] - _ONSETS[0])
    for places in (_ONSETS, np.linspace(-pitch, pitch, 9)):
        middle = 0.0 if places is _ONSETS else onset
        for part in middle + places * size:
            plus, minus = np.maximum(x - part, 0.0), np.maximum(-x - part, 0.0)
            for which, column in ((1, plus), (-1, -minus), (0, plus - minus)):
                if np.count_nonzero(column) > _FEWEST and (gain := _gain(rows, column)) > best:
                    best, side, onset = gain, which, float(part)
    if best > smooth + idle(rows, _PARAMETERS):
        low, high = full if side == 0 else (onset, float(x.max())) if side > 0 else (float(x.min()), -onset)
        sides = {1: "on the positive side", -1: "on the negative side", 0: "on both sides"}[side]
        at = onset if side >= 0 else -onset
        return (
            f"beyond {quantity(at, unit)} {sides}, and nothing that the family cannot tell before: a spring force that "
            "sets in there",
            (low, high),
        )
    lopsided = _gain(rows, x**2, x**4) > _gain(rows, x**5, np.abs(x) * x)
    growing = _slope(rows, x**2 if lopsided else x**5)
    where = "at every displacement, more the larger it is"
    if lopsided:
        stiffer = "positive" if growing > 0 else "negative"
        return f"{where}: a spring force that is not alike on both sides (stiffer on the {stiffer} one)", full
    bend = "stiffens" if growing > 0 else "gives way"
    return f"{where}, alike on both sides: a spring that {bend} otherwise than its cubic term", full


def _over_velocity(rows: Rows, signature: Symptoms, unit: str) -> str:
    """The same for one that follows the velocity."""
    x, v = rows.joined(lambda s: s.x), rows.joined(lambda s: s.v)
    if signature.kind == "damping by position":
        if _gain(rows, x**2 * v) > _gain(rows, x * v):
            more, side = "more" if _slope(rows, x**2 * v) > 0 else "less", "far from the middle"
        else:
            more, side = "more", f"on the {'positive' if _slope(rows, x * v) > 0 else 'negative'} side"
        return f"a damping that depends on the displacement: {more} {side}"
    lopsided = _gain(rows, np.abs(v)) > _gain(rows, v * np.abs(v))
    if lopsided:
        way = "upwards" if _slope(rows, np.abs(v)) > 0 else "downwards"
        return f"at every displacement, a resistance that is larger when it moves {way} than back"
    slow, speed = 0.0, 0.0
    largest = float(np.max(np.abs(v)))
    for part in _SPEEDS * largest:
        column = np.sign(v) * np.exp(-np.abs(v) / part)
        if (gain := _gain(rows, column)) > slow:
            slow, speed = gain, float(part)
    if slow > max(_gain(rows, v * np.abs(v)), _gain(rows, v**3)) + idle(rows, 2):
        more = "more" if _slope(rows, np.sign(v) * np.exp(-np.abs(v) / speed)) > 0 else "less"
        low = quantity(2 * speed, compose("X/s", unit))
        return f"at every displacement, {more} friction at speeds below about {low} than above"
    if _slope(rows, v * np.abs(v)) > 0:
        return (
            "at every displacement, a resistance that grows faster with speed than dry and viscous friction (a drag, "
            "or friction that falls with speed first)"
        )
    return "at every displacement, a resistance that grows less with speed than dry and viscous friction"


def _in_words(signature: Symptoms, rows: Rows, model: Oscillator, ranges: Ranges) -> str:
    """The sentence of the other kinds."""
    unit = model.response.displacement_unit
    if signature.kind == "constant":
        pull = _slope(rows, np.ones(rows.target.size))
        shift = -pull / model.omega0.value**2
        return (
            f"always, whatever the motion: a constant pull of {quantity(-pull, compose('X/s2', unit))} per unit mass, "
            f"or a zero of the sensor that is {quantity(shift, unit)} off"
        )
    if signature.kind == "delay":
        late = _slope(rows, rows.joined(lambda s: s.drive_rate))
        order = "after" if late > 0 else "before"
        force, rate = rows.joined(lambda s: s.drive), rows.joined(lambda s: s.drive_rate)
        if abs(late) * float(np.std(rate)) > _NO_DELAY * float(np.std(force)):
            return (
                "where a force acts, in step with its rate of change, and by more than a delay could: the motion does "
                "not follow the recorded force through this model"
            )
        return (
            "where a force acts, in step with its rate of change: the motion comes "
            f"{figure(1e3 * abs(late))} ms {order} what the recorded force says (a delay or lag of actuator, "
            "sensor or clock)"
        )
    if signature.kind == "time":
        longest = max(float(np.ptp(s.time)) for s in rows.stretches)
        x, t = rows.joined(lambda s: s.x), rows.joined(lambda s: s.time)
        change = _slope(rows, x * t) * longest / model.omega0.value**2
        word = "grows" if change > 0 else "falls"
        part = figure(100 * abs(change), 2)
        return f"as time passes: the stiffness {word} by about {part} % in {figure(longest)} s of a recording"
    if signature.kind == "force":
        return f"where a force acts, and following it rather than the motion: {_over_force(rows)}"
    if signature.kind == "sensor":
        return (
            "at large displacements, as a sensor that is not straight would show it: in the record, not in the motion"
        )
    if signature.kind == "memory":
        return (
            f"in step with the motion (order 1: {100 * signature.first[0]:.0f} % with displacement, "
            f"{100 * signature.first[1]:.0f} % with velocity) and no function of either: a force that remembers, or a "
            "second body"
        )
    locked = sum(signature.orders.values())
    if locked < LOCKED and np.ptp(ranges["amplitude"]) > ALL_AMPLITUDES * np.max(ranges["amplitude"]):
        return "at all times and amplitudes, and in step with nothing: noise that is not white, or a force from outside"
    strongest = max(signature.orders, key=lambda k: signature.orders[k])
    low, high = ranges["amplitude"]
    return (
        f"at amplitudes from {quantity(low, unit)} to {quantity(high, unit)}, most in order {strongest} of the motion, "
        "following neither displacement, velocity, force nor time alone"
    )


def _over_force(rows: Rows) -> str:
    """What happens between the recorded force and the mass, as far as its shape tells."""
    force, rate = rows.joined(lambda s: s.drive), rows.joined(lambda s: s.drive_rate)
    turning = np.clip(rate / max(TURNING * float(np.std(rate)), 1e-300), -1.0, 1.0)
    bend = np.abs(force) * force
    if _gain(rows, turning) > max(_gain(rows, bend), _gain(rows, force**3)):
        return "it holds back when the force turns (play or friction between the recorded force and the mass)"
    word = "less" if _slope(rows, bend) > 0 else "more"
    return f"of large forces {word} arrives than in proportion"


def in_which_recordings(signature: Symptoms, names: list[str]) -> str:
    """In which recordings it is, in which it should be and is not, and which cannot tell."""
    rows = signature.rows
    used = list(dict.fromkeys(s.name for s in rows.stretches))
    here = [name for name in names if name in signature.here]
    driven = {s.name for s in rows.stretches if s.driven}
    free = [name for name in used if name not in driven]
    if signature.kind in ("force", "delay"):
        rest = with_kind(signature)
        still = [s.name for s, beyond in zip(rows.stretches, where_it_is(rest), strict=True) if beyond and not s.driven]
        decays = f"free decay ({spoken(free)}) agrees without it" if free and not still else "free decay cannot tell"
        return f"in the forced recordings ({spoken([name for name in here if name in driven])}); {decays}"
    if len(here) == len(used):
        return "in every recording" if len(used) > 1 else f"in {here[0]}"
    absent = [name for name in used if name not in here]
    if signature.kind in KINDS:
        rest = with_kind(signature)
        quiet = set()
        for i, s in enumerate(rows.stretches):
            made = rows.part(rows.left, i) - rest.part(rest.left, i)
            if 2 * float(made @ made) < float(np.sum(rows.part(rows.silent, i) ** 2)):
                quiet.add(s.name)
        if set(absent) <= quiet:
            return f"in {spoken(here)}; in {spoken(absent)} it would be too small to see"
    return f"in {spoken(here)}, not in {spoken(absent)}"


def how_far_off(records: Sequence[RecordFit]) -> str:
    """How far the response is off where it is farthest."""
    known = [record.left_before for record in records if math.isfinite(record.left_before.times)]
    worst = max(known, key=lambda left: left.times, default=None)
    return f" (response off by up to {worst.of_noise}, in {worst.file})" if worst is not None else ""


def _gain(rows: Rows, *columns: np.ndarray) -> float:
    return explained(rows, np.column_stack(columns) * rows.weight[:, None])


def _slope(rows: Rows, column: np.ndarray) -> float:
    """Coefficient of one column, the family's own terms beside it."""
    return float(solve(np.column_stack([rows.base, column * rows.weight]), rows.target)[-1])
