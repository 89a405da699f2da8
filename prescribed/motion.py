"""A prescribed motion as a force law feels it: displacement, velocity, acceleration, and where they tell nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..errors import BadInput
from ..identify.problem.segments import Segment, blank_of
from ..identify.signals.odds import SIGNIFICANT
from ..identify.signals.registry import numerics
from ..identify.signals.signals import drive_of
from ..model.units import compose
from ..recording.recording import Recording
from ..recording.resolution import rounding_noise
from ..recording.smoothing import weights_of_polynomials, with_polynomials
from ..simulate.imposed import pace_of, spline_of

_ORDER = numerics(7, "order", why="of the polynomials that smooth: their second derivative is still of the fifth")
_OTHER = numerics(5, "order", why="of those over the same window that tell how far the motion may be another one")
_SPANS = numerics((9, 13, 17, 25, 35, 51, 71, 101), "samples", why="windows that are tried, a third longer each")
_LEAST_NOISE = numerics(1e-9, "of a force", why="rounding")
_MOVING = numerics(0.9, "of the samples", why="a motion that stands for longer than that tells little")
_FEWEST = numerics(32, "samples", why="fewer hold no cycle of a force law")


@dataclass(frozen=True, eq=False)
class Moved:
    """One recording of a prescribed motion.

    Attributes:
        name: of the recording.
        displacement, velocity, acceleration: (n,) of the motion, less its noise; of the cubic spline through it.
        dt: sample interval, s.
        start: time of the first sample, s.
        pace: angular frequency at which it mostly goes, rad/s.
        still: speed below which it cannot be told from none.
        told: (n,) where a force is known by it: not what was filled in, where it stands still, or where it begins.
        otherwise: velocity and acceleration by polynomials of a lower order over the same window, which is as long as
            the displacement lets it be: how far they may be off.
        channels: (n,) of each channel, by its name.
    """

    name: str
    displacement: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    dt: float
    start: float
    pace: float
    still: float
    told: np.ndarray
    otherwise: tuple[np.ndarray, np.ndarray]
    channels: Mapping[str, np.ndarray]

    @property
    def n(self) -> int:
        """Number of samples."""
        return self.displacement.size

    @property
    def time(self) -> np.ndarray:
        """(n,) s."""
        return self.start + self.dt * np.arange(self.n)


@dataclass(frozen=True, eq=False)
class Imposed(Moved):
    """The same with the force that the motion took.

    Attributes:
        force: (n,) recorded.
        noise: standard deviation of white noise on the force.
    """

    force: np.ndarray
    noise: float

    def along(self, origin: float) -> np.ndarray:
        """(n, 4) displacement from an origin, velocity, time and nothing: what a law is evaluated along."""
        return np.column_stack([self.displacement - origin, self.velocity, self.time, np.zeros(self.n)])

    def part(self, begin: int, end: int) -> Imposed:
        """The samples from ``begin`` to ``end``, of which the first half cycle is not fitted."""
        cut = {name: getattr(self, name)[begin:end] for name in ("displacement", "velocity", "acceleration", "force")}
        told = self.told[begin:end].copy()
        told[: int(np.pi / self.pace / self.dt)] = False
        velocity, acceleration = self.otherwise
        other = velocity[begin:end], acceleration[begin:end]
        channels = {name: values[begin:end] for name, values in self.channels.items()}
        start = self.start + begin * self.dt
        return replace(self, **cut, told=told, start=start, otherwise=other, channels=channels)

    def doubted(self) -> Imposed:
        """The same as polynomials of another order have its velocity and acceleration."""
        velocity, acceleration = self.otherwise
        return replace(self, velocity=velocity, acceleration=acceleration)

    def segment(self, place: int) -> Segment:
        """The force as the response of a segment, whose leftovers are judged as those of any."""
        return Segment(place, 0, self.n, self.force, None, self.dt, self.start, self.pace)


def moved(recording: Recording) -> Moved:
    """The motion of a recording, whatever force it took.

    A displacement is smoothed by polynomials over windows (Savitzky, Golay 1964), of the length that tells each sample
    best from its neighbours (Craven, Wahba 1979); a velocity is integrated. What the force did before half a cycle had
    passed depends on how the specimen was left, which nobody recorded.

    Raises:
        BadInput: the motion is an acceleration, or does not move.
    """
    name, shown = recording.name, np.asarray(recording.response, float)
    if recording.quantity == "acceleration":
        raise BadInput(
            f"{name}: a prescribed acceleration does not tell where the specimen was; give its displacement or velocity"
        )
    if not np.ptp(shown) > 0.0 or shown.size < _FEWEST:
        raise BadInput(f"{name}: the prescribed column does not move; choose another one with --prescribed")
    if recording.quantity == "velocity":
        shown = np.concatenate([[0.0], np.cumsum(0.5 * (shown[1:] + shown[:-1]))]) * recording.dt
    span, noise = _smoothing(shown, _ORDER)
    smooth, acceleration = (with_polynomials(shown, span, _ORDER, k) * recording.fs**k for k in (0, 2))
    velocity, _ = spline_of(smooth, recording.dt)
    otherwise = tuple(with_polynomials(shown, span, _OTHER, k) * recording.fs**k for k in (1, 2))
    still = (
        SIGNIFICANT * noise * recording.fs * float(np.linalg.norm(weights_of_polynomials(span, _ORDER, 1)[span // 2]))
    )
    pace = pace_of(smooth, velocity)
    told = ~blank_of(recording) & (np.abs(velocity) > still)
    turned = np.diff(np.sign(velocity)) != 0  # on which side of the turn a sample is, its own time does not tell
    told[1:] &= ~turned
    told[:-1] &= ~turned
    told[: min(int(np.pi / pace * recording.fs), recording.n // 2)] = False
    return Moved(
        name,
        smooth,
        velocity,
        acceleration,
        recording.dt,
        recording.start,
        pace,
        still,
        told,
        (otherwise[0], otherwise[1]),
        {channel.name: _quieter(channel.over(recording.n)) for channel in recording.channels},
    )


def imposed(recording: Recording) -> Imposed:
    """The motion of a recording, see ``moved``, and the force that it took.

    Raises:
        BadInput: there is no force, or it never changes; the motion is an acceleration, or tells nothing.
    """
    name, drive = recording.name, drive_of(recording)
    if drive is None:
        raise BadInput(
            f"{name}: a prescribed motion tells nothing without the force that it took; name it with --force"
        )
    motion, force = moved(recording), drive.samples
    if not np.ptp(force) > 0.0:
        raise BadInput(f"{name}: the force is {force[0]:g} throughout; choose another column with --force")
    if np.count_nonzero(motion.told) < _FEWEST or np.quantile(np.abs(motion.velocity), _MOVING) <= motion.still:
        raise BadInput(
            f"{name}: the prescribed column moves no more than its noise in nine tenths of the record or more; choose "
            "another one with --prescribed, or keep the part that moves with --part"
        )
    noise = max(drive.noise, rounding_noise(force), _LEAST_NOISE * float(np.std(force)))
    return Imposed(**vars(motion), force=force, noise=noise)


def _quieter(channel: np.ndarray) -> np.ndarray:
    """(n,) of a channel less its noise, as the displacement is: a force times noise would look like another force."""
    return with_polynomials(channel, _smoothing(channel, _ORDER)[0], _ORDER) if np.ptp(channel) > 0.0 else channel


def _smoothing(signal: np.ndarray, order: int) -> tuple[int, float]:
    """Samples of a window, and the standard deviation of what a signal (n,) has beyond the polynomials over it."""
    found = []
    for span in (span for span in _SPANS if span < signal.size // 2):
        own = weights_of_polynomials(span, order, 0)[span // 2, span // 2]
        left = (signal - with_polynomials(signal, span, order))[span:-span]
        found.append((float(np.mean(left**2)) / (1.0 - own) ** 2, span, own))
    foretold, span, own = min(found)
    return span, float(np.sqrt(foretold * (1.0 - own)))


def unit_of_motion(recording: Recording) -> str:
    """Unit of the displacement that a recording shows, or that follows from the velocity that it shows."""
    return compose("X.s" if recording.quantity == "velocity" else "X", recording.unit)


def origin_of(motions: Sequence[Imposed]) -> float:
    """Displacement that laws count from: the recorded zero, or the stroke's middle where an end is nearer to it."""
    low = min(float(np.min(motion.displacement)) for motion in motions)
    high = max(float(np.max(motion.displacement)) for motion in motions)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    return 0.0 if abs(middle) < half - abs(middle) else middle
