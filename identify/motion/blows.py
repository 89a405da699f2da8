"""Blows of a hammer in a recorded force: contacts that are over before the mass has swung back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...model.oscillator import QUANTITIES
from ...simulate.force import Force
from ..signals.limits import CLEAR_OF_NOISE, DECAY_PART, FEWEST_CYCLES, FLAT, SEVERAL, SHORTEST_PERIOD
from ..signals.noise_beside_edges import OF_MEDIAN
from ..signals.registry import numerics
from .decay import Blow, Decay
from .envelope import Envelope
from .force_off import runs
from .limits import BEYOND

_JOIN = numerics(20, "parts of a cycle", why="noise ends a contact for less than one of them")
_FLANK = numerics(8, "parts of a contact", why="of which one, on either side, is a flank below what ends it")
_EQUAL = numerics(1e-9, "of the peak", why="by which samples of a converter's largest reading differ")


def blows_of(force: np.ndarray, period: int) -> tuple[Blow, ...]:
    """Blows in a force (n,) upon a motion of so many samples a cycle; none where it pushes in any other way as well.

    Contacts that follow one another before half of the cycles of a decay have rung are one blow that hit several times.
    """
    force = force - np.median(force)
    size = np.abs(force)
    peak = float(np.max(size))
    over = max(CLEAR_OF_NOISE * OF_MEDIAN * float(np.median(size)), DECAY_PART * peak)
    if not peak > 2 * over:
        return ()
    join = max(2, period // _JOIN)
    contacts: list[tuple[int, int]] = []
    for a, b in runs(size > over):
        if contacts and a - contacts[-1][1] <= join:
            contacts[-1] = (contacts[-1][0], b)
        else:
            contacts.append((a, b))
    # a contact begins and ends at a level, and rises to twice that at least
    contacts = [(a, b) for a, b in contacts if np.max(size[a:b]) > 2 * over]
    contacts = [(max(0, a - (b - a) // _FLANK), min(size.size, b + (b - a) // _FLANK)) for a, b in contacts]
    # over within half a cycle: the mass has its momentum before the spring takes it away (Ewins 2000, 3.4)
    if any(2 * (b - a) > period for a, b in contacts):
        return ()
    noise = BEYOND * OF_MEDIAN * float(np.median(size))
    contacts = [(a - _falls(force[:a][::-1], b - a, noise), b + _falls(force[b:], b - a, noise)) for a, b in contacts]
    # not a few contacts but a train of them: a drive in pulses
    rings = FEWEST_CYCLES * period / 2
    if len(contacts) > SEVERAL and np.median(np.diff([a for a, _ in contacts])) < rings:
        return ()
    largest = float(np.max(force)) if abs(np.max(force)) >= abs(np.min(force)) else float(np.min(force))
    blows: list[Blow] = []
    for a, b in contacts:
        clipped = int(np.sum(np.abs(force[a:b] - largest) <= _EQUAL * peak)) >= FLAT
        if blows and a - blows[-1].stop < rings:
            last = blows[-1]
            blows[-1] = Blow(last.start, b, last.clipped or clipped, last.contacts + 1)
        else:
            blows.append(Blow(a, b, clipped))
    return tuple(blows)


def _falls(force: np.ndarray, most: int, noise: float) -> int:
    """How many samples beside a contact, so many at most, fall on from one to the next, above the noise.

    A crystal or a soft tip lets go slowly: a thousandth of the momentum is in what is below a level.
    """
    side = force[:most] * np.sign(force[:1])
    on = (side > noise) & (np.diff(side, prepend=np.inf) < 0)
    return int(np.argmin(on)) if not np.all(on) else side.size


def ringing(blows: tuple[Blow, ...], envelope: Envelope) -> list[Decay]:
    """Decays after blows: from the end of each to the noise or to the next one."""
    size, floor, n = envelope.size, envelope.floor, envelope.size.size
    decays: list[Decay] = []
    ends = [blow.start for blow in blows[1:]] + [n]
    for blow, end in zip(blows, ends, strict=True):
        risen = min(blow.stop + envelope.period, end)  # the envelope's kernel reaches a cycle back
        low = np.flatnonzero(size[risen:end] < floor)
        stop = risen + int(low[0]) if low.size else end
        if stop > risen and size[risen] > 2 * floor:
            decays.append(Decay(blow.stop, stop))
    first = blows[0].start
    if first >= FEWEST_CYCLES * envelope.period / 2 and size[0] > 2 * floor:  # it rang before
        low = np.flatnonzero(size[:first] < floor)
        decays.insert(0, Decay(0, int(low[0]) if low.size else first))
    return decays


@dataclass(frozen=True)
class ContactForce(Force):
    """A force that is known to be zero but for contacts, so that its sensor's noise counts during these alone."""

    def coarser(self, times: int, dt: float) -> Force:
        """The same: a contact is shorter than the pieces that suit the motion."""
        return self

    def with_added(self, samples: np.ndarray, dt: float) -> Force:
        """The same force with something added during its contacts."""
        added = super().with_added(samples, dt)
        return replace(self, pieces=np.where(self._contact[:, None], added.pieces, self.pieces))

    @property
    def _contact(self) -> np.ndarray:
        """(m,) which of the pieces are of a contact."""
        size = np.abs(self.pieces[:, 0])
        return size > DECAY_PART * np.max(size, initial=0.0)

    def contacts(self, n: int) -> np.ndarray:
        """(n,) which part of the interval behind each sample is of a contact."""
        parts = self._contact[: self.pieces.shape[0] // self.fine * self.fine].reshape(-1, self.fine).mean(axis=1)
        return np.pad(parts, (0, max(n - parts.size, 0)))[:n]


def contact_force(force: np.ndarray, blows: Sequence[Blow], period: int) -> np.ndarray:
    """The force (n,) during the contacts, about what the sensor read just before each, and zero elsewhere.

    After a blow the hammer is in the air: what the sensor shows then is its offset and its noise (the force window of
    impact testing, Ewins 2000, 3.7).
    """
    alone = np.zeros_like(force)
    for blow in blows:
        before = force[max(0, blow.start - period) : blow.start]
        after = force[blow.stop : blow.stop + period]
        quiet = before if before.size >= SHORTEST_PERIOD else after
        zero = float(np.median(quiet)) if quiet.size else 0.0
        alone[blow.start : blow.stop] = force[blow.start : blow.stop] - zero
    return alone


def through(blows: Sequence[Blow], decays: Sequence[Decay], period: int) -> list[tuple[int, int, bool]]:
    """Stretches (start, stop, forced) of a struck recording: blows with the ringing that they set going.

    The mass is in how far a blow moves it, which all of the ringing tells, and what rang before it as well; outside
    contacts there is no force, and so no noise of it. A blow into a ringing goes on with it. A ringing without its blow
    is where that was clipped or its response goes against it.
    Each begins a quarter of a cycle before its blow, still at rest where it was.
    """
    parts: list[tuple[int, int, bool]] = []
    for decay in decays:
        blow = next((blow for blow in blows if blow.stop == decay.start and blow.is_known), None)
        start = decay.start if blow is None else blow.before(period)
        if blow is not None and parts and parts[-1][1] >= start:
            parts[-1] = (parts[-1][0], decay.stop, True)
        else:
            parts.append((start, decay.stop, blow is not None))
    return parts


def answers_against(blows: Sequence[Blow], force: np.ndarray, response: np.ndarray, period: int, quantity: str) -> bool:
    """Whether the motion that blows set going runs against them.

    A plug may be turned round, or a sensor look the other way. A mass goes where it is pushed, whatever holds it: over
    a cycle from where the force was largest its response is nearly that of an undamped linear rig of its frequency.
    Blows count by what they set going; what still rings from before one belongs to none and has any sign.

    Args:
        blows: of the recording.
        force: (n,) recorded.
        response: (n,) displacement, velocity or acceleration.
        period: samples a cycle of the motion.
        quantity: which of these the response is.
    """
    struck = contact_force(force, blows, period)
    both = moves = plain = 0.0
    for blow in blows:
        before = response[blow.before(period) : blow.start]
        peak = blow.start + int(np.argmax(np.abs(struck[blow.start : blow.stop])))  # a band draws a contact out
        first = slice(blow.start, peak + period)
        moved = response[first] - (np.mean(before) if before.size else 0.0)
        expected = _linear_response(struck[first], 2 * np.pi / period, quantity)
        both, moves, plain = both + moved @ expected, moves + moved @ moved, plain + expected @ expected
    # at a correlation below -1/2 they are more than a third of a cycle apart, which no filter or delay makes of a chain
    # that is meant to show the motion
    return bool(2 * both < -np.sqrt(moves * plain))


def _linear_response(force: np.ndarray, omega: float, quantity: str) -> np.ndarray:
    """Response (n,) of x'' + omega² x = force from rest, with time in samples."""
    order = QUANTITIES.index(quantity)
    impulse = np.sin(omega * np.arange(force.size) + order * np.pi / 2) * omega ** (order - 1)
    driven = np.convolve(force, impulse)[: force.size]
    return driven + force if quantity == "acceleration" else driven
