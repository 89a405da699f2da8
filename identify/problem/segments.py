"""Recordings cut where the physics changes hands: free decays, and what the recorded force drives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ...files.computed_once import computed_once
from ...recording.recording import QUANTITIES, Recording
from ...recording.short_decay import LEAST_CYCLES
from ...simulate.force import Force, force_between
from ..motion.blows import ContactForce, contact_force, through
from ..motion.decays import find_free_motion, force_is_silent
from ..motion.excitation import band_of
from ..motion.first_motion import starts_at_rest
from ..motion.force_off import zero_of
from ..motion.quiet import quiet_noise
from ..signals.hilbert import noise_level
from ..signals.odds import HALF_AGAIN
from ..signals.registry import numerics
from ..signals.signals import response_of
from .limits import FEWEST_SWINGS, NEAR_ITS_OWN, WORTH_A_SLIDE, WORTH_ITS_START

FORCE_BAND = numerics(
    3.0, "times the natural frequency", why="force above it hardly moves the mass: by a ninth of its static effect"
)
_SHORTEST_CYCLE = numerics(3, "samples", why="fewer have no cycle")
COARSE_FORCE_BAND = numerics(
    1.0,
    "times the natural frequency",
    why="what only compares laws may interpolate the force to 1e-5 up to the resonance, to 1e-4 at twice that",
)


@dataclass(frozen=True, eq=False)
class Segment:
    """A stretch of one recording that is simulated in one go from an initial state of its own.

    Attributes:
        recording: index of the recording.
        start, stop: samples of the recording, as a Python slice.
        response: (n,) measured response.
        force: what drives it, None for a free decay.
        dt: sample interval, s.
        time: time of the first sample, s.
        pace: angular frequency of the motion, rad/s, by which times are judged: see ``pace_of``.
        slide: whether that is the force's and not the rig's own.
        rests: whether it begins at rest; its initial state is then known (where friction holds the mass, an initial
            state has no derivative to find it by).
        quantity: what the response shows of the motion.
        after: sample of the recording at which the stretch before it ended; None where it is the first. From there goes
            on what no sensor shows (``state_from_previous_segment``).
        blank: (n,) which samples were filled in and are not fitted; None where all were measured.
        differs: names of parameters of the rig, and by how much each was another along it than the common one.
    """

    recording: int
    start: int
    stop: int
    response: np.ndarray
    force: Force | None
    dt: float
    time: float
    pace: float
    rests: bool = False
    slide: bool = False
    quantity: str = "displacement"
    after: int | None = None
    blank: np.ndarray | None = None
    differs: tuple[tuple[str, float], ...] = ()

    @property
    def order(self) -> int:
        """How often the response is the displacement's derivative."""
        return QUANTITIES.index(self.quantity)

    @property
    def n(self) -> int:
        """Number of samples."""
        return self.stop - self.start

    @property
    def kind(self) -> str:
        """What moves it: "free", "struck" by a hammer, or "driven" by the recorded force."""
        return "free" if self.force is None else "struck" if isinstance(self.force, ContactForce) else "driven"

    @property
    def cycle(self) -> int:
        """Samples of a cycle at its pace."""
        return max(_SHORTEST_CYCLE, round(2 * np.pi / self.pace / self.dt))

    @computed_once
    def noise(self) -> float:
        """Standard deviation of the response's white noise, from these samples alone."""
        return noise_level(self.response, 1.0 / self.dt)

    @computed_once
    def coarse_force(self) -> Force | None:
        """The force as a search may take it that only leads to where a fit begins."""
        return None if self.force is None else self.force.coarser(int(FORCE_BAND / COARSE_FORCE_BAND), self.dt)

    def part(self, begin: int, end: int) -> Segment:
        """The samples from ``begin`` to ``end`` of this segment."""
        force = self.force
        if force is not None:
            force = force.part(begin, end)
        return replace(
            self,
            start=self.start + begin,
            stop=self.start + end,
            response=self.response[begin:end],
            force=force,
            time=self.time + begin * self.dt,
            rests=self.rests and begin == 0,
            after=self.start + begin if begin else self.after,
            blank=None if self.blank is None else self.blank[begin:end],
        )


def cut(recordings: Sequence[Recording], omega0: float, force_band: float = FORCE_BAND) -> tuple[Segment, ...]:
    """Segments of all recordings.

    A free decay is simulated without force, whatever noise the force channel shows meanwhile; a recording without a
    force, or with a silent one, contributes its decays alone. The rest of a recording with force is forced; a hammer's
    blow is simulated together with the ringing after it. Where nothing moves there is
    nothing to fit. What is too short to be worth its initial values is all there is of some recordings: it is taken
    where nothing else is.

    Args:
        recordings: with or without force.
        omega0: natural frequency, rad/s, to judge lengths and the force's interpolation.
        force_band: the force is interpolated finely enough up to this multiple of the natural frequency.
    """
    pace = pace_of(recordings, omega0)
    found = _cut(recordings, pace, pace > omega0, force_band, WORTH_ITS_START)
    return found or _cut(recordings, pace, pace > omega0, force_band, LEAST_CYCLES)


def _cut(
    recordings: Sequence[Recording], pace: float, slide: bool, force_band: float, cycles: float
) -> tuple[Segment, ...]:
    """Segments of at least so many cycles."""
    segments: list[Segment] = []
    for index, recording in enumerate(recordings):
        shortest = (WORTH_A_SLIDE if slide else cycles) * 2 * np.pi / pace * recording.fs
        least = WORTH_A_SLIDE * 2 * np.pi / pace * recording.fs
        force = recording.force
        motion = find_free_motion(recording)
        decays = motion.decays
        ends = [(decay.start, decay.stop, False) for decay in decays]
        known = {decay.start for decay in decays if decay.omega is not None}  # what their cycles tell was asked before
        period = round(2 * np.pi / pace * recording.fs)
        if motion.blows and force is not None:
            ends = through(motion.blows, decays, period)
            force = contact_force(np.asarray(force, float), motion.blows, period)
        elif force is not None and np.any(force) and not (motion.swell or (decays and force_is_silent(recording))):
            edges = [0, *(edge for decay in decays for edge in (decay.start, decay.stop)), recording.n]
            ends, force = _pushed(ends, edges, shortest, np.asarray(force, float), period)
        ends = [(a, b, forced) for start, stop, forced in ends for a, b in known_parts(recording, start, stop)]
        blank = blank_of(recording)
        highest = force_band * pace / (2 * np.pi)
        quiet, slow = quiet_noise(response_of(recording).samples, motion.blows, recording.dt, pace)
        for start, stop, forced in sorted(ends):
            # what a force drives all through a recording says more than it costs once it has gone through a cycle; so
            # does a free recording that was let in for its fall, and a blow upon a mass at rest costs nothing
            costs = (start, stop) != (0, recording.n) and not (forced and motion.blows)
            if stop - start < (shortest if costs else least) and start not in known:
                continue
            driven = None
            if forced and force is not None and np.any(force[start:stop]):
                samples = np.asarray(force[start:stop], float)
                driven = force_between(samples, recording.dt, recording.hold or "smooth", highest)
                driven = ContactForce(driven.pieces, driven.fine, driven.hold) if motion.blows else driven
            signal = response_of(recording).part(start, stop)
            response, noise = signal.samples, signal.noise
            if not np.std(response) > HALF_AGAIN * max(noise, quiet):
                continue
            whole = Segment(
                recording=index,
                start=start,
                stop=stop,
                response=response,
                force=driven,
                dt=recording.dt,
                time=recording.start + start * recording.dt,
                pace=pace,
                rests=forced and starts_at_rest(response, recording.dt, pace, max(noise, slow)),
                slide=slide,
                quantity=recording.quantity,
                after=segments[-1].stop if segments and segments[-1].recording == index else None,
                blank=blank[start:stop] if np.any(blank[start:stop]) else None,
                differs=recording.differs,
            )
            segments += _pieces(whole) if slide else [whole]
    return tuple(segments)


def _pushed(
    decays: Sequence[tuple[int, int, bool]], edges: Sequence[int], shortest: float, force: np.ndarray, period: int
) -> tuple[list[tuple[int, int, bool]], np.ndarray]:
    """Decays and what is driven between them, (start, stop, forced), with the force along these.

    A push that is shorter than what is fitted by itself goes on with the decay that it set going, along which the force
    is zero.
    """
    made, alone = list(decays), force
    for a, b in zip(edges[::2], edges[1::2], strict=True):
        after = next((decay for decay in decays if decay[0] == b), None)
        if after is None or b - a >= shortest or not b > a:
            made.append((a, b, True))
            continue
        if alone is force:
            alone = force - zero_of(force, period)[0]
        alone[b : after[1]] = 0.0
        made.remove(after)
        before = next((part for part in made if part[1] == a and part[2]), None)
        if before is not None:
            made.remove(before)
        made.append((a if before is None else before[0], after[1], True))
    return made, alone


def known_parts(recording: Recording, start: int, stop: int) -> list[tuple[int, int]]:
    """Parts of a stretch along which what drives it is known."""
    gaps = [(max(a, start), min(b, stop)) for a, b in recording.unknown if b > start and a < stop]
    edges = [start, *(edge for gap in gaps for edge in gap), stop]
    return [(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if b > a]


def blank_of(recording: Recording) -> np.ndarray:
    """(n,) which samples of the response were filled in."""
    blank = np.zeros(recording.n, bool)
    for start, stop in recording.blank:
        blank[start:stop] = True
    return blank


def _pieces(whole: Segment) -> list[Segment]:
    """A cycle of the motion each: no spring holds a slide near its place, and what little its model lacks adds up.

    Multiple shooting (Bock, 1981) with initial states that are free.
    """
    count = max(1, round(whole.n * whole.dt * whole.pace / (2 * np.pi)))
    edges = np.linspace(0, whole.n, count + 1).round().astype(int)
    return [whole.part(int(begin), int(end)) for begin, end in pairwise(edges)]


def stretches(segments: Sequence[Segment]) -> list[tuple[int, ...]]:
    """Indices of segments that follow one another without a gap, each such stretch together."""
    runs: list[list[int]] = []
    for i, segment in enumerate(segments):
        last = segments[runs[-1][-1]] if runs else None
        follows = last is not None and (last.recording, last.stop) == (segment.recording, segment.start)
        if follows and last is not None and (last.force is None) == (segment.force is None):
            runs[-1].append(i)
        else:
            runs.append([i])
    return [tuple(run) for run in runs]


def pace_of(recordings: Sequence[Recording], omega0: float) -> float:
    """Angular frequency of the motion, rad/s: a rig swings at its natural frequency.

    One with a spring so soft that no recording holds ten swings (a slide, a positioning table) moves as it is driven.
    """
    longest = max(recording.n * recording.dt for recording in recordings)
    driven = [recording for recording in recordings if recording.force is not None and np.any(recording.force)]
    if longest * omega0 > 2 * np.pi * FEWEST_SWINGS or not driven:
        return omega0
    lines = [(response_of(recording).frequency, band_of(recording) or (0.0, 0.0)) for recording in driven]
    # a line that nothing drives, such as hum, is no motion of a slide
    pace = max((2 * np.pi * line for line, (_, high) in lines if line <= NEAR_ITS_OWN * high), default=0.0)
    return pace if pace > NEAR_ITS_OWN * omega0 else omega0
