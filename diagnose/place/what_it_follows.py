"""What the missing force follows: one kind of coordinate, chosen as the plainest that explains it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..limits import AHEAD, FAINT, GENERALITY, LOCKED, PLAINER, TELLING
from .equation_error import Stretch
from .free_form import KINDS, Rows, explained, idle, rows_of, shares, solve
from .mismatch_ranges import Line, line_in, orders, where_it_is

#: Kinds of coordinates, the plainest first: a less plain one has to explain more than this part beyond the plainer one.
_ORDER = ("constant", "delay", "time", "displacement", "velocity", "damping by position", "sensor", "force")
#: One frequency: as strong in all recordings, or the more the harder the rig is driven.
LINES = ("tone", "ringing")
#: Kinds that hold another one within them, or lie within it.
_RELATED = {
    "constant": ("displacement", "velocity", "force", "displacement and velocity"),
    "delay": ("force",),
    "force": ("delay", "constant"),
    "displacement": ("constant", "displacement and velocity"),
    "velocity": ("constant", "displacement and velocity"),
    "damping by position": ("displacement and velocity",),
    "displacement and velocity": ("constant", "displacement", "velocity", "damping by position"),
}
_PATHS = {
    "constant": "restoring",
    "delay": "excitation",
    "time": "environment",
    "tone": "environment",
    "ringing": "inertia",
    "displacement": "restoring",
    "velocity": "dissipation",
    "damping by position": "dissipation",
    "sensor": "measurement",
    "force": "excitation",
    "memory": "memory",
}


@dataclass(frozen=True, eq=False)
class Symptoms:
    """What the missing force follows.

    Attributes:
        rows: the missing force of all segments.
        kind: the coordinate that it follows, or ``unknown``.
        shares: for each kind the share of the excess that it explains.
        here: names of the recordings in which it is beyond the noise.
        line: a line in its spectrum.
        orders: share of each harmonic order of the motion.
        first: parts of the first order in phase with displacement and with velocity.
    """

    rows: Rows
    kind: str
    shares: dict[str, float]
    here: tuple[str, ...]
    line: Line | None
    orders: dict[int, float]
    first: tuple[float, float]

    @property
    def path(self) -> str:
        """Where in the rig it seems to live."""
        return _PATHS.get(self.kind, "unknown")


def symptoms(stretches: Sequence[Stretch]) -> Symptoms:
    """What the missing force of some stretches follows."""
    rows = rows_of(stretches)
    explains = shares(rows)
    line = line_in(rows)
    if line is not None:
        explains["tone" if line.steady else "ringing"] = _line_share(rows, line.frequency_hz)
    here = [s.name for s, beyond in zip(stretches, where_it_is(rows), strict=True) if beyond]
    by_order, first = orders(rows)
    kind = _kind(explains)
    if kind == "memory" and sum(by_order.values()) < LOCKED:
        kind = "unknown"  # slow noise resembles a slow relaxation, but keeps no step with the motion
    return Symptoms(rows, kind, explains, tuple(dict.fromkeys(here)), line, by_order, first)


def _kind(explains: dict[str, float]) -> str:
    best = max(explains.values())
    for name in LINES:
        if explains.get(name, 0.0) > max(TELLING, PLAINER * best):
            return name
    if best < TELLING:
        leader = max(explains, key=lambda kind: explains[kind])
        strangers = [share for kind, share in explains.items() if kind not in (leader, *_RELATED.get(leader, ()))]
        if best < FAINT or best < AHEAD * max(strangers, default=0.0):
            return "unknown"
    name = plainest(explains)
    if name == "displacement and velocity":
        return max(("displacement", "velocity", "damping by position"), key=lambda kind: explains[kind])
    return name


def plainest(explains: Mapping[str, float]) -> str:
    """The plainest kind whose share is about that of the best one; a line where nothing else comes near to it."""
    part = dict.fromkeys(_ORDER, PLAINER) | GENERALITY
    best = max(explains, key=lambda kind: explains[kind])
    return next((kind for kind in part if explains.get(kind, -1.0) >= part[kind] * explains[best]), best)


def _line_share(rows: Rows, frequency: float) -> float:
    columns = line_columns(rows, frequency)
    gain = explained(rows, columns * rows.weight[:, None]) - idle(rows, columns.shape[1])
    return min(gain / max(float(rows.left @ rows.left - rows.silent @ rows.silent), 1e-300), 1.0)


def line_columns(rows: Rows, frequency: float) -> np.ndarray:
    """(n, 2 stretches) one frequency, Hz, with a size and a phase of its own in each stretch."""
    columns = np.zeros((rows.target.size, 2 * len(rows.stretches)))
    edges = np.cumsum([0, *(s.n for s in rows.stretches)])
    for i, s in enumerate(rows.stretches):
        turn = 2 * np.pi * frequency * s.time
        columns[edges[i] : edges[i + 1], 2 * i] = np.cos(turn)
        columns[edges[i] : edges[i + 1], 2 * i + 1] = np.sin(turn)
    return columns


def with_kind(signature: Symptoms) -> Rows:
    """The rows less what the kind's own free-form terms explain as well."""
    rows = signature.rows
    whole = np.hstack([rows.base, KINDS[signature.kind](rows) * rows.weight[:, None]])
    return replace(rows, left=rows.target - whole @ solve(whole, rows.target))
