"""What was recorded altogether: the ranges that those of a mismatch are held against."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ...errors import BadInput
from ...identify.motion.displacement import displacement
from ...identify.motion.excitation import band_of
from ...identify.signals.hilbert import AnalyticSignal, analytic_signal
from ...identify.signals.limits import SHORTEST_PERIOD
from ...identify.signals.registry import numerics
from ...model import Oscillator
from ...recording.recording import QUANTITIES, Recording
from ...recording.smoothing import with_polynomials
from ..limits import LARGE_PART
from ..result import RecordFit

Range = tuple[float, float]
_WINDOW = numerics(
    1 / 6,
    "of a cycle",
    why="over which a velocity is taken from a displacement: three harmonics pass, the noise above does not",
)
_GAP = numerics(1.5, "times the shortest spacing", why="samples of one piece differ by rounding of their times alone")


@dataclass(frozen=True)
class RecordedRanges:
    """Low and high over all recordings, in the model's units; None where no recording tells.

    Attributes:
        displacement, velocity: of the motion as measured, the one integrated or differentiated from the other.
        amplitude: of its envelope (Hilbert transform).
        frequency_hz: of the forces, by the band that holds 99 % of their power, and of free motion.
        time_s: of the time stamps.
    """

    displacement: Range | None
    velocity: Range | None
    amplitude: Range | None
    frequency_hz: Range | None
    time_s: Range | None


def recorded_ranges(records: Sequence[RecordFit], model: Oscillator) -> RecordedRanges:
    """Take together what all recordings covered, those fitted to and those held out.

    Args:
        records: as a diagnosis has them; a record may consist of several pieces, with other times between them.
        model: whose frequency says how long a cycle is.
    """
    pieces = [piece for record in records for piece in _pieces(record)]
    cycle = 2 * np.pi / model.omega0.value
    motions = [(piece, x) for piece in pieces if (x := _displacement(piece, cycle)) is not None]
    envelopes = [(piece, _envelope(x, piece.fs)) for piece, x in motions]
    return RecordedRanges(
        displacement=_extent([_sure(x, piece, cycle, 0) for piece, x in motions]),
        velocity=_extent([_sure(_velocity(x, piece, cycle), piece, cycle, 1) for piece, x in motions]),
        amplitude=_extent([_sure(e.amplitude, piece, cycle, 0) for piece, e in envelopes if e is not None]),
        frequency_hz=_extent([_frequencies(piece, envelope) for piece, envelope in envelopes]),
        time_s=_extent([np.asarray(record.time, float) for record in records]),
    )


def _pieces(record: RecordFit) -> list[Recording]:
    """The evenly sampled stretches of a record; those that hold no numbers are left out."""
    time, measured = np.asarray(record.time, float), np.asarray(record.measured, float)
    force = None if record.force is None else np.asarray(record.force, float)
    if time.size < 2:
        return []
    steps = np.diff(time)
    dt = float(np.median(steps))
    if not dt > 0:
        return []
    edges = [0, *(np.flatnonzero((steps > _GAP * dt) | (steps <= 0)) + 1), time.size]
    pieces = []
    for start, stop in pairwise(edges):
        if stop - start < 2 or not np.all(np.isfinite(measured[start:stop])):
            continue
        part = None if force is None else force[start:stop]
        pieces.append(Recording(record.file, 1.0 / dt, measured[start:stop], part, quantity=record.response.quantity))
    return pieces


def _displacement(piece: Recording, cycle: float) -> np.ndarray | None:
    """(n,) as measured or integrated, of the latter less its mean over a cycle: an integral wanders."""
    from scipy.ndimage import uniform_filter1d

    try:
        x = displacement(piece).samples
    except (BadInput, ValueError):  # it does not oscillate, or is too short for a spline
        return None
    width = max(round(cycle * piece.fs), 1)
    return x if piece.quantity == "displacement" else x - uniform_filter1d(x, width, mode="nearest")


def _velocity(x: np.ndarray, piece: Recording, cycle: float) -> np.ndarray:
    """(n,) measured, or from the displacement by local cubics (Savitzky and Golay 1964); empty where unknown."""
    if piece.quantity == "velocity":
        return piece.response
    if piece.quantity == "acceleration":  # integrated twice already: its slope holds no more than the sensor's noise
        return np.gradient(x, piece.dt)
    span = max(int(_WINDOW * cycle * piece.fs) | 1, SHORTEST_PERIOD)
    return np.empty(0) if x.size < span else with_polynomials(x, span, 3, 1) / piece.dt


def _sure(signal: np.ndarray, piece: Recording, cycle: float, order: int) -> np.ndarray:
    """Without a cycle at either end where it was integrated: what the integration adds is known worst there."""
    if QUANTITIES.index(piece.quantity) <= order:
        return signal
    margin = int(cycle * piece.fs)
    return signal[margin : signal.size - margin]


def _envelope(x: np.ndarray, fs: float) -> AnalyticSignal | None:
    try:
        return analytic_signal(x, fs)
    except BadInput:  # too few cycles, or too few samples in one
        return None


def _frequencies(piece: Recording, envelope: AnalyticSignal | None) -> np.ndarray:
    """Lowest and highest: of the force, else of the motion while it is large enough to tell; empty where unknown."""
    band = band_of(piece)
    if band is not None:
        return np.array(band)
    if envelope is None:
        return np.empty(0)
    large = envelope.amplitude > LARGE_PART * np.max(envelope.amplitude)
    return np.quantile(envelope.omega[large] / (2 * np.pi), [0.05, 0.95]) if np.any(large) else np.empty(0)


def _extent(signals: Sequence[np.ndarray]) -> Range | None:
    """Least and largest number of all signals."""
    finite = [signal[np.isfinite(signal)] for signal in signals]
    ends = [(float(signal.min()), float(signal.max())) for signal in finite if signal.size]
    return (min(low for low, _ in ends), max(high for _, high in ends)) if ends else None
