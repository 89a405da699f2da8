"""Backbones of a recording and of the FMU's response, by the same method, and the band within which they must agree.

The band is what chance makes: the scatter of the backbones of other recordings of the same (``chance``), at each of a
few amplitudes, so many times as Student's distribution asks for all of them together.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput
from ..identify.hilbert.forced_regression import forced_regression
from ..identify.hilbert.freevib import freevib
from ..identify.motion.displacement import displacement
from ..identify.motion.excitation import kind_of
from ..identify.signals.odds import BY_CHANCE
from ..identify.signals.signals import Signal, drive_of
from ..recording.fact import changed
from ..recording.recording import Recording
from .chance import Run
from .noise_floor import Piece

#: Backbones are compared wherever the amplitude exceeds this part of the largest (0.3 mm of 9 mm).
AMPLITUDE_PART = 1.0 / 30.0
#: Amplitudes at which they are: a backbone of some tens of cycles has no more that are independent.
AMPLITUDES = 20
#: Draws of a band; each costs a Hilbert transform.
DRAWS = 20


@dataclass(frozen=True, eq=False)
class Backbone:
    """Natural frequency over amplitude: (n,) in the displacement's unit and (n,) in Hz; ``method`` made it."""

    method: str
    amplitude: np.ndarray
    frequency: np.ndarray

    def at(self, amplitude: np.ndarray) -> np.ndarray:
        """(m,) natural frequency at other amplitudes."""
        order = np.argsort(self.amplitude)
        return np.interp(amplitude, self.amplitude[order], self.frequency[order])


@dataclass(frozen=True, eq=False)
class Compared:
    """Two backbones over the amplitudes that both have.

    Attributes:
        recorded, simulated: the recording's and the FMU's.
        amplitude: (m,).
        limit: (m,) largest distance in Hz that is chance; infinite where that is not known.
    """

    recorded: Backbone
    simulated: Backbone
    amplitude: np.ndarray
    limit: np.ndarray

    @property
    def distance(self) -> np.ndarray:
        """(m,) how far apart they are, Hz."""
        return np.abs(self.recorded.at(self.amplitude) - self.simulated.at(self.amplitude))

    @property
    def _parts(self) -> np.ndarray:
        return self.distance / np.maximum(self.limit, np.finfo(float).tiny)

    @property
    def worst(self) -> int:
        """Where they are farthest apart for what chance makes there."""
        return int(np.argmax(self._parts))

    @property
    def over(self) -> float:
        """How far apart they are there, in what chance exceeds once in a thousand."""
        return float(self._parts[self.worst])


def compared(run: Run, place: int) -> list[Compared]:
    """The backbones that a piece has, each beside that of the FMU's response; ``place`` is the piece's."""
    recording = run.piece.recording
    found = []
    for make in _makers(run.piece):
        pair = _made(make, recording), _made(make, changed(recording, response=run.replay.response))
        if pair[0] is not None and pair[1] is not None:
            found.append((make, pair[0], pair[1]))
    largest = max((float(np.max(recorded.amplitude)) for _, recorded, _ in found), default=0.0)
    results, drawn = [], None
    for make, recorded, simulated in found:
        low = max(recorded.amplitude.min(), simulated.amplitude.min(), AMPLITUDE_PART * largest)
        high = min(recorded.amplitude.max(), simulated.amplitude.max())
        if not high > low:
            continue
        drawn = drawn or [changed(recording, response=y) for y in run.draws(DRAWS, place, own=True)]
        grid = np.linspace(low, high, AMPLITUDES)
        results.append(Compared(recorded, simulated, grid, _limit(make, drawn, simulated, grid)))
    return results


def _limit(
    make: Callable[[Recording], Backbone], drawn: list[Recording], simulated: Backbone, grid: np.ndarray
) -> np.ndarray:
    """(m,) distance in Hz that chance exceeds anywhere once in a thousand, from what some draws scatter."""
    from scipy.special import stdtrit

    others = [_made(make, recording) for recording in drawn]
    apart = np.array([other.at(grid) - simulated.at(grid) for other in others if other is not None])
    if len(apart) < DRAWS // 2:
        return np.full(grid.size, np.inf)  # a backbone that chance mostly leaves none of says nothing
    return -float(stdtrit(len(apart), 0.5 * BY_CHANCE / grid.size)) * np.sqrt(np.mean(apart**2, axis=0))


def _makers(piece: Piece) -> list[Callable[[Recording], Backbone]]:
    """What makes the backbones that a piece may have, of a recording with its force and any response."""
    makers: list[Callable[[Recording], Backbone]] = [
        lambda recording, ends=(decay.start, decay.stop): _free(displacement(recording).part(*ends))
        for decay in piece.decays
    ]
    # a multisine has no envelope that passes slowly through the amplitudes, so it has no backbone to compare
    drive = drive_of(piece.recording)
    if drive is not None and kind_of(piece.recording, piece.decays) in ("sweep", "sine"):
        makers.append(lambda recording: _forced(displacement(recording), drive))
    return makers


def _made(make: Callable[[Recording], Backbone], recording: Recording) -> Backbone | None:
    try:
        made = make(recording)
    except BadInput:
        return None  # too few cycles or too little motion for a backbone: then there is none to compare
    return made if np.all(np.isfinite(made.frequency)) else None


def _free(decay: Signal) -> Backbone:
    curve = freevib(decay)
    return Backbone("FREEVIB", curve.amplitude, curve.omega0 / (2 * np.pi))


def _forced(x: Signal, drive: Signal) -> Backbone:
    curve = forced_regression(x, drive)
    return Backbone("regression", curve.amplitude, curve.omega0 / (2 * np.pi))
