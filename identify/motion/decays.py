"""Free motion in a recording, found by itself: where the force is off, after a blow, or where the motion falls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ...recording.fact import fact
from ...recording.short_decay import LEAST_CYCLES, is_short_decay
from ..signals.limits import FEWEST_CYCLES
from ..signals.odds import ABOVE_NOISE, SIGNIFICANT
from ..signals.signals import Signal, response_of
from .blows import answers_against, blows_of, ringing
from .decay import Blow, Decay, FreeMotion
from .envelope import Envelope, envelope_of
from .excluded_ranges import left_out, swelling
from .falling import falling
from .force_off import force_is_silent, force_off, zero_of
from .free_motion import all_that_moves, modes_of_response, moving_in, off_behind, periods_of, pieces_of_rig
from .limits import KNOWN, TAKES
from .mode import Mode
from .rig_pieces import RigPieces
from .shared_modes import SharedModes
from .swings import swell_of, swings_of

if TYPE_CHECKING:
    from ...recording.recording import Recording

__all__ = ["Blow", "Decay", "FreeMotion", "find_decays", "find_free_motion", "force_is_silent"]


def find_decays(recording: Recording) -> tuple[Decay, ...]:
    """Find the free decays of a recording, in order of time; none is an empty tuple, not an error."""
    return find_free_motion(recording).decays


@fact("name", "motion", "force", "fs", "start", "free", "quantity")
def find_free_motion(recording: Recording) -> FreeMotion:
    """Find the free decays of a recording and say what was left out.

    Without a force, what one rig explains down to the noise is its decays, however few cycles they have: the modes of
    a linear one (``shared_modes``), or Eq. 17 (``rig_pieces``), whichever is likelier. Where neither does, the envelope
    decides. Nothing of few cycles is believed beside a response that swells: what drives it there may have done so
    throughout, and two cycles of a sweep are explained by many a rig.
    """
    by_envelope, force = _by_envelope(recording), recording.force
    if recording.free or not (force is None or np.ptp(force) == 0):
        return by_envelope
    swell = None
    for motion in (_explained(recording, by_envelope), by_envelope):
        swell = _swell_beside(recording, motion.decays)
        if swell is None:
            return motion
    return FreeMotion((), notes=(swelling(recording, swell),) if swell else (), swell=swell)


def linear_modes(recording: Recording, *, struck: bool = False) -> tuple[Mode, ...]:
    """The modes that all free pieces of a recording share, the strongest first; none where one is all.

    ``struck``: whether behind a hammer's blows too, which takes a second or two.
    """
    motion = find_free_motion(recording)
    return _modes_behind_blows(recording) if struck and motion.blows else motion.modes


@fact("name", "motion", "force", "fs", "start", "free", "quantity")
def _modes_behind_blows(recording: Recording) -> tuple[Mode, ...]:
    """There the pieces are known, and modes may lie as near to one another as the pieces are long."""
    pieces = [(decay.start, decay.stop) for decay in find_free_motion(recording).decays]
    shared = modes_of_response(response_of(recording), pieces)
    return () if shared is None else _modes_of(shared, recording.fs)


def _swell_beside(recording: Recording, decays: Sequence[Decay]) -> tuple[int, int] | None:
    """The samples between which the response swells beside decays; None where one of these has many cycles."""
    envelope = envelope_of(recording)
    if envelope is None:
        return None
    cycles = [(d.stop - d.start) / (2 * np.pi / d.omega * recording.fs if d.omega else envelope.period) for d in decays]
    if max(cycles, default=0.0) >= FEWEST_CYCLES:
        return None
    return swell_of(swings_of(response_of(recording).samples, envelope), decays)


def _explained(recording: Recording, by_envelope: FreeMotion) -> FreeMotion:
    """What one rig explains of a recording without a force, or what the envelope shows."""
    response = response_of(recording)
    whole = all_that_moves(response, by_envelope.decays)
    asked: list[RigPieces | None] = []

    def rig_of() -> RigPieces | None:
        if not asked:
            asked.append(pieces_of_rig(response, recording.quantity))
        return asked[0]

    def settled(evidence: float, count: int) -> bool:
        """Whether one mode, bent or not, leaves only noise of what no two look like, so many cycles in a piece.

        Where the envelope's decays hold all that moves, a bent one's pieces would not take their place.
        """
        rig = None if whole else rig_of()
        if rig is None or rig.share > 0.0 or not (rig.is_bent if rig.evidence > evidence else count == 1):
            return False
        longest = max(stop - start for start, stop in rig.pieces) / recording.fs * rig.omega / (2 * np.pi)
        return longest >= FEWEST_CYCLES and _holds(_of_rig(rig), response, by_envelope.decays, rig.omega)

    # what holds all that moves has shown its period: at others no more is to be found than how it is bent
    envelope = envelope_of(recording) if whole else None
    shared = modes_of_response(response, None, settled, None if envelope is None else [float(envelope.period)])
    rig = rig_of() if asked else None
    if rig is not None and (shared is None or rig.evidence > shared.evidence) and settled(0.0, 0):
        return _described(recording, _of_rig(rig))
    # a damped sine over the whole of few cycles may have a hold in it, before what is free
    few = envelope_of(recording) is None and shared is not None and _rings_out(shared, recording.n)
    is_linear = shared is not None and (few or _explains(shared, response, by_envelope.decays))
    linear = [_shared_decay(shared, k, recording.fs) for k in range(len(shared.pieces))] if shared else []
    # plucked again and again it goes on nearly as it did; but where no envelope falls there is nothing else to believe
    is_linear = is_linear or (bool(linear) and not by_envelope.decays and all_that_moves(response, linear))
    linear = linear if is_linear else []
    most = all_that_moves(response, linear or _ended(_whole(shared), response, by_envelope.decays))
    rig = None if most else rig_of()
    # of several modes each may look like a bent one for a few cycles, but not where there is ten times as much
    is_one = shared is None or shared.omega.size == 1 or (rig and shared.evidence < (1 - TAKES) * rig.evidence)
    if rig is not None and is_one and (shared is None or not is_linear or rig.evidence > shared.evidence):
        decays = _of_rig(rig)
        if _holds(decays, response, by_envelope.decays, rig.omega):
            return _described(recording, decays)
    if shared is not None and is_linear:
        motion = _described(recording, linear)
        return replace(motion, modes=_modes_of(shared, recording.fs))
    return by_envelope


def _of_rig(rig: RigPieces) -> list[Decay]:
    return [Decay(start, stop, rig.omega, rig.rate, rig.values) for start, stop in rig.pieces]


def _rings_out(shared: SharedModes, n: int) -> bool:
    """Whether there is one piece, which lasts to the end or to the noise: else parts of a frequency that glides."""
    (_, stop, audible), *others = shared.pieces
    return not others and (audible < stop or stop == n)


def _holds(decays: Sequence[Decay], response: Signal, others: Sequence[Decay], omega: float) -> bool:
    """Whether decays hold about all the time in which the response moves in others; the rest may be a hand's.

    What stopped it at the end is not asked for. Several decays within one of the others do not: that falls steadily,
    so that nothing stopped it between them, and it is another rig's.
    """
    if any(sum(other.start < (d.start + d.stop) / 2 < other.stop for d in decays) > 1 for other in others):
        return False
    theirs = moving_in(response, _ended(decays, response, others), omega)
    return bool(np.sum(moving_in(response, decays, omega) & theirs) >= TAKES * np.sum(theirs))


def _ended(decays: Sequence[Decay], response: Signal, others: Sequence[Decay]) -> list[Decay]:
    """The others, each up to where the last of the decays in it breaks off, which is where something stopped it."""
    ended = []
    for other in others:
        inside = [d for d in decays if other.start < d.stop < other.stop]
        last = max(inside, key=lambda d: d.stop, default=other)
        ended.append(replace(other, stop=last.stop) if _breaks_off(response, last) else other)
    return ended


def _breaks_off(response: Signal, decay: Decay) -> bool:
    if decay.omega is None or decay.rate is None:
        return False
    off = off_behind(response, (decay.start, decay.stop), np.array([decay.omega]), np.array([decay.rate]))
    return off is not None and off[0] > KNOWN


def _explains(shared: SharedModes, response: Signal, decays: Sequence[Decay]) -> bool:
    """Whether shared modes take about as much as an envelope does, or more, of the time in which the response moves.

    What is missing from them may be a hand's. Where a frequency glides with the amplitude, they take a part.
    """
    order = np.argsort(np.arange(shared.omega.size) != shared.main, kind="stable")
    omega, rate = shared.omega[order], (shared.zeta * shared.omega)[order]
    for start, stop, audible in shared.pieces:
        off = off_behind(response, (start, stop), omega, rate)
        if audible == stop and off is not None and off[1] and off[0] < KNOWN:
            return False  # it goes on, nearly so: what is linear ends in its noise, or is stopped
    taken = [Decay(start, audible) for start, _, audible in shared.pieces]
    ended = _ended(_whole(shared), response, decays)
    mine, theirs = (moving_in(response, some, float(shared.omega[shared.main])) for some in (taken, ended))
    return bool(np.sum(mine) >= TAKES * np.sum(theirs))


def _modes_of(shared: SharedModes, fs: float) -> tuple[Mode, ...]:
    """Several modes, that which moves most first; none where there is one.

    A line that stands while the main mode rings out is a tone, and no mode: in the longest piece it does not fall by a
    factor e, as far as is known of it.
    """
    omega, zeta = shared.omega, shared.zeta
    longest = max(stop - start for start, stop, _ in shared.pieces) / fs
    stands = (omega * (zeta + SIGNIFICANT * shared.errors[1]) * longest < 1) & (shared.rate * longest > 1)
    order = sorted(np.flatnonzero(~stands | (np.arange(omega.size) == shared.main)), key=lambda k: k != shared.main)
    if len(order) == 1:
        return ()
    frequency = shared.omega / (2 * np.pi)
    errors = shared.errors * np.stack([frequency, np.ones(frequency.size), np.ones(frequency.size)])
    return tuple(
        Mode(
            frequency=float(frequency[k]),
            low=float(frequency[k]),
            high=float(frequency[k]),
            share=float(shared.share[k]),
            strongest=k == shared.main,
            damping_ratio=float(shared.zeta[k]),
            errors=(float(errors[0, k]), float(errors[1, k]), float(errors[2, k])),
        )
        for k in order
    )


def _whole(shared: SharedModes | None) -> list[Decay]:
    """The pieces with what is below their noise; none of none."""
    if shared is None:
        return []
    omega = float(shared.omega[shared.main])
    return [Decay(start, stop, omega, shared.rate) for start, stop, _ in shared.pieces]


def _shared_decay(shared: SharedModes, which: int, fs: float) -> Decay:
    start, stop, audible = shared.pieces[which]
    omega = float(shared.omega[shared.main])
    return Decay(start, max(audible, min(stop, start + round(2 * np.pi / omega * fs))), omega, shared.rate)


def _described(recording: Recording, decays: Sequence[Decay]) -> FreeMotion:
    motion, envelope = FreeMotion(tuple(decays)), envelope_of(recording)
    return replace(motion, notes=left_out(recording, envelope, motion) if envelope is not None else ())


def _by_envelope(recording: Recording) -> FreeMotion:
    """The free decays by their envelope, and what was left out.

    With a force: from the sample after the force went off (its level over a cycle is down at its own noise) to where it
    comes on again. Without one, or with a force that is zero throughout: from where the motion was let go, or a cycle
    after the corner at which its envelope begins to fall, so that no driven part is in it, as long as it falls and
    is not stopped. Both end where the envelope meets the noise of the recording. A recording that is known to be free
    is one decay, and so is one of few cycles whose fall stands out of its own error (``short_decay``). Where nothing
    falls at the pace of the strongest line, it is asked for at those of faster ones.
    """
    if recording.free:
        return FreeMotion((Decay(0, recording.n),))
    undriven, envelope = recording.force is None or force_is_silent(recording), envelope_of(recording)
    if envelope is None:
        short = undriven and is_short_decay(np.asarray(recording.response, float), recording.fs)
        return FreeMotion((Decay(0, recording.n),) if short else ())
    motion = _shown_by(envelope, recording)
    if motion.decays or not undriven:
        return motion
    # a hand that pulls again and again may be the strongest line of all
    faster = [p for p in periods_of(response_of(recording).samples) if p < envelope.period]
    others = [_shown_by(other, recording) for p in faster if (other := envelope_of(recording, p)) is not None]
    return max((motion, *others), key=lambda one: sum(d.stop - d.start for d in one.decays))


def _shown_by(envelope: Envelope, recording: Recording) -> FreeMotion:
    """What an envelope shows of its recording: see ``_by_envelope``."""
    x, force = np.asarray(recording.response, float), recording.force
    period, blows = envelope.period, ()
    if force is None or force_is_silent(recording):
        swings, shortest = swings_of(x, envelope), FEWEST_CYCLES
        decays = falling(x, envelope, swings)
        if not decays:  # few cycles between a hold and a stop: their errors decide, not their number
            shortest = LEAST_CYCLES
            short = falling(x, envelope, swings, shortest)
            decays = [d for d in short if is_short_decay(x[d.start : d.stop], recording.fs)]
        if force is not None and np.ptp(force) > 0:
            # white noise may be a shaker's too: only a fall to the noise, or the whole record, is a free decay then
            size, floor = envelope.size, envelope.floor
            decays = [d for d in decays if size[d.stop - 1] < ABOVE_NOISE * floor or d.stop - d.start > TAKES * x.size]
    else:
        force = np.asarray(force, float)
        blows = tuple(Blow(*struck) for struck in recording.struck) or blows_of(force, period)
        if answers_against(blows, force, x, period, recording.quantity):
            blows = tuple(replace(blow, answered=False) for blow in blows)
        # a blow says how the motion began, which a decay must show by itself
        shortest = LEAST_CYCLES if blows else FEWEST_CYCLES
        decays = ringing(blows, envelope) if blows else force_off(force - zero_of(force, period)[0], envelope)
    decays = tuple(sorted((d for d in decays if d.stop - d.start >= shortest * period), key=lambda d: d.start))
    motion = FreeMotion(decays, blows)
    return replace(motion, notes=left_out(recording, envelope, motion))
