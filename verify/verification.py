"""Proof that the artefact reproduces the recordings: the FMU run under FMPy with the recorded force.

The force is fed as it ran between its samples: as the recordings say, else as the FMU's own model was identified, else
smooth. It goes in by input derivatives of up to third order where the FMU takes them (those that dashpot makes),
else by straight lines between points closer together than the samples; where it is held, by its samples alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import BadInput
from ..identify.decays import Decay, find_decays
from ..identify.displacement import displacement
from ..identify.excitation import kind_of
from ..identify.forced_regression import forced_regression
from ..identify.freevib import freevib
from ..identify.hold import held_as
from ..identify.replay import Replay, force_of, natural_frequency, run_along
from ..identify.signals import Signal, drive_of, noise_levels
from ..model import Response
from ..recording.fact import changed
from ..recording.recording import Recording
from .fmu_process import TIME_LIMIT
from .fmu_run import FmuRun
from .noise_floor import floor_of_fmu, pieces

#: What "reproduces" means: at most this many times the noise floor.
NOISE_RATIO = 1.1
#: Backbones must agree to this part of the natural frequency (0.02 Hz of 12.67 Hz) ...
BACKBONE_PART = 0.02 / 12.67
#: ... wherever the amplitude exceeds this part of the largest (0.3 mm of 9 mm).
AMPLITUDE_PART = 1.0 / 30.0


@dataclass(frozen=True, eq=False)
class Backbone:
    """Natural frequency over amplitude: (n,) in the displacement's unit and (n,) in Hz; ``method`` made it."""

    method: str
    amplitude: np.ndarray
    frequency: np.ndarray


@dataclass(frozen=True, eq=False)
class RecordingCheck:
    """One recording against the FMU.

    Attributes:
        file: the recording's name.
        nrmse: rms(simulated - measured) / std(measured), free run over the whole recording, or over its free decays
            where there is no force.
        noise_floor: the same of a perfect model: sensor noise, and force noise as the rig passes it on.
        backbone_max_error_hz: largest distance of the two backbones; None where the recording gives none.
        passed: whether both are within their limits.
        time, measured, simulated: (n,) signals, for pictures.
        backbones: pairs (recording's, FMU's).
        response: what was measured, and in which unit.
        besides: what the sensors show at zero, in words: no part of the motion, and left aside.
    """

    file: str
    nrmse: float
    noise_floor: float
    backbone_max_error_hz: float | None
    passed: bool
    time: np.ndarray
    measured: np.ndarray
    simulated: np.ndarray
    backbones: tuple[tuple[Backbone, Backbone], ...]
    response: Response
    besides: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Verification:
    """An FMU against recordings."""

    fmu: str
    recordings: tuple[RecordingCheck, ...]

    @property
    def passed(self) -> bool:
        """Whether every recording is reproduced."""
        return all(check.passed for check in self.recordings)

    def sentence(self) -> str:
        """The outcome in one sentence."""
        if self.passed:
            return f"{self.fmu} reproduces {len(self.recordings)} recording(s) to within their noise"
        bad = [check for check in self.recordings if not check.passed]
        worst = max(bad, key=lambda check: check.nrmse / check.noise_floor if check.noise_floor > 0 else np.inf)
        return (
            f"{self.fmu} does not reproduce {', '.join(check.file for check in bad)}: the worst, {worst.file}, has an "
            f"NRMSE of {worst.nrmse:.3g} where its noise alone makes {worst.noise_floor:.3g}"
        )

    def as_json(self) -> dict[str, Any]:
        """The form that ``dashpot verify --json`` writes."""
        return {
            "fmu": self.fmu,
            "recordings": [
                {
                    "file": check.file,
                    "nrmse": _finite(check.nrmse),
                    "noise_floor": _finite(check.noise_floor),
                    "backbone_max_error_hz": _finite(check.backbone_max_error_hz),
                    "besides": list(check.besides),
                    "pass": check.passed,
                }
                for check in self.recordings
            ],
            "pass": self.passed,
        }


def _finite(value: float | None) -> float | None:
    """JSON has no number for what is not finite."""
    return value if value is not None and np.isfinite(value) else None


def verify(
    fmu: Path,
    recordings: Sequence[Recording],
    *,
    noise_ratio: float = NOISE_RATIO,
    limit: float = TIME_LIMIT,
    progress: Callable[[str], None] = lambda _: None,
) -> Verification:
    """Run the FMU with the force of each recording and compare response and backbone.

    Args:
        fmu: a co-simulation FMU of FMI 2.0 or 3.0 with an input ``F``; each recording is held against
            the first output of its own unit.
        recordings: what it should reproduce.
        noise_ratio: largest NRMSE over noise floor that passes.
        limit: longest time, s, that the FMU may take without finishing a step.
        progress: called with one line per recording.

    Raises:
        BadInput: where the file is no such FMU, or it cannot simulate, or none of its outputs has a recording's unit.
    """
    checks = []
    with FmuRun(Path(fmu), limit=limit) as run:
        for recording in held_as(recordings, run.hold):
            check = _check(run, recording, noise_ratio)
            progress(
                f"{recording.name}: NRMSE {check.nrmse:.3g}, noise floor {check.noise_floor:.3g}"
                + ("" if check.backbone_max_error_hz is None else f", backbone {check.backbone_max_error_hz:.2g} Hz")
            )
            for words in check.besides:
                progress(f"{recording.name}: {words}; left aside")
            for words in run.heard():
                progress(f"{recording.name}: the FMU says: {words}")
            checks.append(check)
    return Verification(Path(fmu).name, tuple(checks))


def _check(run: FmuRun, recording: Recording, noise_ratio: float) -> RecordingCheck:
    pieces = _pieces(recording)
    runs = [_run(run, piece) for piece in pieces]
    measured = np.concatenate([np.asarray(piece.response, float) for piece in pieces])
    simulated = np.concatenate([replay.response for replay, _ in runs])
    spread = float(np.std(measured))
    if not spread > 0:
        raise BadInput(f"{recording.name}: the response does not move; there is nothing to compare with")
    nrmse = float(np.sqrt(np.mean((simulated - measured) ** 2))) / spread
    variance = sum(piece.n * noise**2 for piece, (_, noise) in zip(pieces, runs, strict=True)) / measured.size
    floor = float(np.sqrt(variance)) / spread
    backbones = tuple(
        pair for piece, (replay, _) in zip(pieces, runs, strict=True) for pair in _backbones(piece, replay.response)
    )
    error = _largest_error(backbones)
    frequency = natural_frequency(recording) / (2 * np.pi)
    passed = nrmse <= noise_ratio * floor and (error is None or error <= BACKBONE_PART * frequency)
    time = np.concatenate([piece.time for piece in pieces])
    shown = Response(recording.quantity, recording.unit)
    besides = [words for replay, _ in runs for words in _besides(replay, recording)]
    return RecordingCheck(
        recording.name, nrmse, floor, error, bool(passed), time, measured, simulated, backbones, shown, tuple(besides)
    )


def _besides(replay: Replay, recording: Recording) -> list[str]:
    """What the sensors were found to show beside the motion, in words: what exceeds their noise."""
    sensor, _ = noise_levels(recording)
    words = []
    if abs(replay.zero) > sensor:
        words.append(f"its sensor shows {replay.zero:.4g} {recording.unit} at zero")
    if replay.drift:
        words.append(f"its sensor drifts by {replay.drift:.4g} {recording.unit}/s")
    if replay.load:
        words.append(f"its load cell shows {replay.load:.4g} {recording.force_unit} at zero")
    return words


def _pieces(recording: Recording) -> list[Recording]:
    """Its pieces; raises BadInput where it has none."""
    parts = pieces(recording)
    if not parts:
        raise BadInput(
            f"{recording.name}: has neither a force nor a free decay; give the column of the force (--force)"
        )
    return parts


def _run(run: FmuRun, recording: Recording) -> tuple[Replay, float]:
    """The FMU along a recording, and the rms of what noise alone leaves."""
    force = force_of(recording)

    def simulate(state: np.ndarray, n: int, load: float) -> np.ndarray:
        pushed = force.shifted(-load) if force is not None and load else force
        return run.record(pushed, n, recording.dt, state, recording.start, output)

    output = run.output_for(recording)
    replay = run_along(simulate, recording, run.inner)
    pushed = force if force is None else force.shifted(-replay.load)
    moved = replay.response - replay.shown(recording.dt)
    return replay, floor_of_fmu(run, recording, pushed, replay.initial, moved)


def _backbones(recording: Recording, simulated: np.ndarray) -> tuple[tuple[Backbone, Backbone], ...]:
    """Backbones by the same method from the recording and from the FMU's response."""
    twin = changed(recording, response=simulated)
    pairs = []
    free = recording.force is None or not np.any(recording.force)
    decays = (Decay(0, recording.n),) if free else find_decays(recording)
    for decay in decays:
        ends = decay.start, decay.stop
        pairs.append(_pair(lambda r, ends=ends: _free(displacement(r).part(*ends)), recording, twin))
    # a multisine has no envelope that passes slowly through the amplitudes, so it has no backbone to compare
    drive = drive_of(recording)
    if drive is not None and kind_of(recording, decays) in ("sweep", "sine"):
        pairs.append(_pair(lambda r: _forced(displacement(r), drive), recording, twin))
    return tuple(pair for pair in pairs if pair is not None)


def _pair(
    make: Callable[[Recording], Backbone], recording: Recording, twin: Recording
) -> tuple[Backbone, Backbone] | None:
    try:
        return make(recording), make(twin)
    except BadInput:
        return None  # too few cycles or too little motion for a backbone: then there is none to compare


def _free(decay: Signal) -> Backbone:
    curve = freevib(decay)
    return Backbone("FREEVIB", curve.amplitude, curve.omega0 / (2 * np.pi))


def _forced(x: Signal, drive: Signal) -> Backbone:
    curve = forced_regression(x, drive)
    return Backbone("regression", curve.amplitude, curve.omega0 / (2 * np.pi))


def _largest_error(backbones: Sequence[tuple[Backbone, Backbone]]) -> float | None:
    if not backbones:
        return None
    largest = max(float(np.max(pair[0].amplitude)) for pair in backbones)
    worst = 0.0
    for recorded, simulated in backbones:
        low = max(recorded.amplitude.min(), simulated.amplitude.min(), AMPLITUDE_PART * largest)
        high = min(recorded.amplitude.max(), simulated.amplitude.max())
        if high <= low:
            continue
        grid = np.linspace(low, high, 200)
        difference = _at(recorded, grid) - _at(simulated, grid)
        error = float(np.max(np.abs(difference)))
        worst = max(worst, error if np.isfinite(error) else np.inf)
    return worst


def _at(backbone: Backbone, amplitude: np.ndarray) -> np.ndarray:
    order = np.argsort(backbone.amplitude)
    return np.interp(amplitude, backbone.amplitude[order], backbone.frequency[order])
