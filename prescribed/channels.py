"""Channels of prescribed motions, and what a strength that depends on one makes of its column.

A force is linear in its strengths, so that a strength times a function of a channel is its column times that function,
sample by sample; see ``model/dependence.py`` for the forms. Here a channel is counted in halves of its recorded range,
so that every number of a form is about one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput
from ..identify.signals.registry import numerics
from ..model.dependence import FORMS, Dependence, own_name, possible
from ..model.law import LawParameter
from ..recording.recording import Recording
from .motion import Imposed

_STEEPEST = numerics(0.9, "of a half range", why="a denominator that vanishes within what was recorded is no law")
_EXPONENT = numerics(6.0, "powers", why="steeper is a switch, whatever the channel")
_ROUNDED = numerics(10, "parts of the range", why="to which a reference value is rounded, to be read")
_SAME = numerics(1e-6, "of its size", why="what a file of six digits leaves of a number")


@dataclass(frozen=True)
class Span:
    """A channel over all recordings: what it is called, its unit, and what was recorded of it."""

    name: str
    unit: str
    low: float
    high: float

    @property
    def half(self) -> float:
        """Half of its range."""
        return 0.5 * (self.high - self.low)

    @property
    def reference(self) -> float:
        """A round number about the middle."""
        step = 10.0 ** math.floor(math.log10((self.high - self.low) / _ROUNDED))
        middle = round(0.5 * (self.low + self.high) / step) * step
        return float(f"{middle:.12g}")


@dataclass(frozen=True)
class Way:
    """A strength that depends on a channel in a fit; its name is that of a dependence's own number."""

    channel: str
    of: str
    how: str

    @property
    def name(self) -> str:
        """Of its own number; of itself where it has none."""
        return own_name(self.of, self.channel, self.how) or f"{self.of}.{self.channel}_{self.how}"

    def __str__(self) -> str:
        return f"{self.of}({self.channel}, {self.how})"

    @property
    def begun(self) -> float:
        """Where its own number is begun: in proportion, or no dependence."""
        return 1.0 if self.how == "power" else 0.0

    def placed(self) -> LawParameter | None:
        """Its own number, where the force is not linear in that."""
        if self.how == "power":
            return LawParameter("exponent", "1", "", -_EXPONENT, _EXPONENT)
        return LawParameter("rate", "1", "", -_STEEPEST, _STEEPEST) if self.how == "inverse" else None


def spans_of(recordings: Sequence[Recording]) -> dict[str, Span]:
    """The channels of recordings of one specimen, by name.

    Raises:
        BadInput: a recording lacks a channel, has it in another unit, or a channel never changes.
    """
    known: dict[str, tuple[str, list[float]]] = {}
    for recording in recordings:
        for channel in recording.channels:
            values = channel.over(recording.n)
            unit, ends = known.setdefault(channel.name, (channel.unit, []))
            if unit != channel.unit:
                raise BadInput(
                    f"{recording.name}: the channel {channel.name} is in {channel.unit}, and in {unit} elsewhere; give "
                    "it in one unit"
                )
            ends += [float(np.min(values)), float(np.max(values))]
    for name, (unit, ends) in known.items():
        for recording in recordings:
            if name not in {channel.name for channel in recording.channels}:
                raise BadInput(
                    f"{recording.name}: has no channel {name}, which others have; give it, or leave it out of all"
                )
        if not max(ends) - min(ends) > _SAME * max(map(abs, ends)):
            raise BadInput(
                f"the channel {name} never changes, it is {ends[0]:.6g} {unit} throughout, so that nothing can be seen "
                "to depend on it; leave it out, or add a recording where it is another"
            )
    return {name: Span(name, unit, min(ends), max(ends)) for name, (unit, ends) in known.items()}


def ways_of(span: Span, of: str) -> list[Way]:
    """The forms in which a strength may depend on a channel; a load, which each recording has another of, in one."""
    hows = ["linear"] if of == "load" else list(FORMS)
    return [
        Way(span.name, of, how) for how in hows if possible(how, span.unit, span.low, span.high, span.reference) is None
    ]


def column_of(way: Way, span: Span, column: np.ndarray, motion: Imposed, own: float) -> np.ndarray:
    """(n,) of the strength's column (n,) times the form; of ``linear`` what the slope alone is multiplied by."""
    channel = motion.channels[way.channel]
    apart = (channel - span.reference) / span.half
    if way.how == "linear":
        return column * apart
    if way.how == "inverse":
        return column / (1.0 + own * apart)
    return FORMS[way.how].value(column, own, channel, span.reference)


def dependence_of(way: Way, span: Span) -> Dependence:
    """As an element has it, its own number apart."""
    return Dependence(way.channel, way.of, way.how, span.reference, span.unit, span.low, span.high)


def size_of(way: Way, span: Span) -> float:
    """What its own number here is multiplied by to be that of an element."""
    return 1.0 if way.how == "power" else 1.0 / span.half


def parsed(text: str, spans: Mapping[str, Span], strengths: Sequence[str]) -> Way:
    """``STRENGTH:CHANNEL`` or ``STRENGTH:CHANNEL:HOW`` as a way; raises BadInput for anything else."""
    of, _, rest = text.partition(":")
    channel, _, how = rest.partition(":")
    how = how or "linear"
    if channel not in spans:
        there = f"there are {', '.join(spans)}" if spans else "name one with --channel"
        raise BadInput(f"'{text}': the recordings have no channel '{channel}'; {there}")
    if of not in strengths:
        raise BadInput(
            f"'{text}': nothing is called '{of}' that may depend on {channel}; there are {', '.join(strengths)}"
        )
    if how not in FORMS:
        raise BadInput(f"'{text}': '{how}' is no form of a dependence; there are {', '.join(FORMS)}")
    span = spans[channel]
    if (said := possible(how, span.unit, span.low, span.high, span.reference)) or (of == "load" and how != "linear"):
        raise BadInput(
            f"'{text}': {of} cannot depend on {channel} so, for {said or 'each recording has a load of its own'}"
        )
    return Way(channel, of, how)
