"""Proof that the artefact reproduces the recordings: the FMU run under FMPy with the recorded force.

The force is fed as it ran between its samples: as the recordings say, else as the FMU's own model was identified, else
smooth. It goes in by input derivatives of up to third order where the FMU takes them (those that dashpot makes),
else by straight lines between points closer together than the samples; where it is held, by its samples alone.

What "reproduces" means follows from the recording's noise and from the errors that the model inside states of itself:
what is left, the distance of the backbones, and the parameters that the recording asks for may each be what chance
makes once in a thousand (``chance``, ``backbones``, ``score``), and no more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import BadInput
from ..identify.fit.hold import held_as
from ..identify.problem.replay import Replay, force_of, run_along
from ..identify.signals.said import said
from ..identify.signals.signals import noise_levels
from ..model import Response
from ..model.fit_state import percent_words, times_words
from ..model.left import share_of_motion
from ..model.show import finite
from ..recording.given import recordings_of
from ..recording.prescribed import refuse_free, refuse_prescribed
from ..recording.recording import Recording
from ..recording.units import find_unit
from .backbones import Backbone, Compared, compared
from .chance import Run, by_chance, powers, usual
from .fmu_process import TIME_LIMIT
from .fmu_run import FmuRun, FmuStopped
from .model_inside import Twin, twin_of
from .noise_floor import Piece, pieces
from .score import Score, score_of

__all__ = ["NOISE_RATIO", "Backbone", "RecordingCheck", "Verification", "verify"]

#: Noise levels are good to a tenth: they come from the highest frequencies alone.
NOISE_RATIO = 1.1
#: Draws of noise that the model's core runs through ...
DRAWS = 40
#: ... and that an FMU does where no core stands in for it: each costs a call a sample.
DRAWS_OF_FMU = 8


@dataclass(frozen=True, eq=False, repr=False)
class RecordingCheck:
    """One recording against the FMU.

    Attributes:
        file: the recording's name.
        nrmse: rms(simulated - measured) / std(measured), free run over the whole recording, or over its free decays
            where there is no force.
        noise_floor: what a perfect model leaves on average: sensor noise, and force noise as the rig passes it on.
        backbone_max_error_hz: largest distance of the two backbones; None where the recording gives none.
        passed: whether nothing ``failed``.
        time, measured, simulated: (n,) signals, for pictures.
        backbones: pairs (recording's, FMU's).
        response: what was measured, and in which unit.
        besides: what the sensors show at zero, in words: no part of the motion, and left out.
        nrmse_limit: NRMSE that noise and the model's own errors exceed once in a thousand.
        backbone_over_limit: distance of the backbones over what they exceed once in a thousand, at the amplitude where
            that is largest; None where there is no backbone.
        score: the parameter that the recording asks for most; None where it has failed already, or tells of none, or
            the FMU holds no model that answers as it does.
        failed: of each criterion that failed a sentence with its figures.
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
    nrmse_limit: float = np.inf
    backbone_over_limit: float | None = None
    score: Score | None = None
    failed: tuple[str, ...] = ()

    @property
    def over_noise(self) -> float:
        """How many times the noise is left."""
        return self.nrmse / self.noise_floor if self.noise_floor > 0 else np.inf

    def __repr__(self) -> str:
        verdict = "passes" if self.passed else "fails"
        return (
            f"<{self.file}: {verdict}, NRMSE {self.nrmse:.3g}, noise floor {self.noise_floor:.3g}, "
            f"limit {self.nrmse_limit:.3g}>"
        )


@dataclass(frozen=True, eq=False, repr=False)
class Verification:
    """An FMU against recordings."""

    fmu: str
    recordings: tuple[RecordingCheck, ...]

    def __repr__(self) -> str:
        return "\n".join([self.sentence(), *(f"  {check!r}" for check in self.recordings)])

    @property
    def passed(self) -> bool:
        """Whether every recording is reproduced."""
        return all(check.passed for check in self.recordings)

    def sentence(self) -> str:
        """The outcome in one sentence."""
        if self.passed:
            several = len(self.recordings) > 1
            what = f"{len(self.recordings)} recordings" if several else self.recordings[0].file
            most = max(self.recordings, key=lambda check: check.over_noise)
            if most.over_noise <= NOISE_RATIO:
                return f"{self.fmu} reproduces {what} to within {'their' if several else 'its'} noise"
            return (
                f"{self.fmu} reproduces {what} to within noise and what the model's own errors allow: of {most.file} "
                f"{percent_words(100 * most.nrmse)} % of the motion is left, {times_words(most.over_noise)} times the "
                f"noise, where {percent_words(100 * most.nrmse_limit)} % would still pass"
            )
        bad = [check for check in self.recordings if not check.passed]
        worst = max(bad, key=lambda check: check.nrmse / check.nrmse_limit if check.nrmse_limit > 0 else np.inf)
        return (
            f"{self.fmu} does not reproduce {', '.join(check.file for check in bad)}; "
            f"{worst.file}: {' and '.join(worst.failed)}"
        )

    def as_json(self) -> dict[str, Any]:
        """The form that ``dashpot verify --json`` writes."""
        return {
            "fmu": self.fmu,
            "recordings": [
                {
                    "file": check.file,
                    "nrmse": finite(check.nrmse),
                    "noise_floor": finite(check.noise_floor),
                    "nrmse_limit": finite(check.nrmse_limit),
                    "backbone_max_error_hz": finite(check.backbone_max_error_hz),
                    "backbone_over_limit": finite(check.backbone_over_limit),
                    "score": None if check.score is None else check.score.as_json(),
                    "besides": list(check.besides),
                    "failed": list(check.failed),
                    "pass": check.passed,
                }
                for check in self.recordings
            ],
            "pass": self.passed,
        }


def verify(
    fmu: Path,
    recordings: Sequence[Recording] | Any,
    *,
    noise_ratio: float = NOISE_RATIO,
    limit: float | None = None,
    progress: Callable[[str], None] | None = None,
    keep: Callable[[Verification], None] = lambda _: None,
    imposed: Callable[[FmuRun, Recording, float], RecordingCheck] | None = None,
) -> Verification:
    """Run the FMU with the force of each recording and compare response, backbone and parameters.

    Args:
        fmu: a co-simulation FMU of FMI 2.0 or 3.0 with an input ``F``; each recording is held against
            the first output of its own unit.
        recordings: what it should reproduce; also what ``recordings_of`` reads.
        noise_ratio: how many times what chance makes of the NRMSE may be left, for the noise is not known exactly.
        limit: longest time, s, that the FMU may take without finishing a step; None: TIME_LIMIT.
        progress: called with one line per recording.
        keep: called with the result before the FMU is ended, which may take it seconds.
        imposed: checks a recording against the FMU of a force law by itself: see ``prescribed/verified.py``.

    Raises:
        BadInput: where the file is no such FMU, or it cannot simulate, or none of its outputs has a recording's unit.
    """
    checks = []
    progress = progress or (lambda _: None)
    recordings = recordings_of(recordings)
    if not recordings:
        raise BadInput(f"{Path(fmu).name}: no recording was given to hold it against; give at least one")
    with FmuRun(Path(fmu), limit=TIME_LIMIT if limit is None else limit) as run:
        if run.moved and imposed is None:
            raise BadInput(f"{fmu}: holds a force law by itself, which is not run here; dashpot verify takes it")
        (refuse_free if run.moved else refuse_prescribed)(recordings)
        checked = imposed if imposed is not None and run.moved else _check
        for recording in recordings if run.moved else held_as(recordings, run.hold):
            check = checked(run, recording, noise_ratio)
            progress(
                f"{recording.name}: NRMSE {check.nrmse:.3g}, noise floor {check.noise_floor:.3g}, "
                f"limit {check.nrmse_limit:.3g}"
                + ("" if check.backbone_max_error_hz is None else f", backbone {check.backbone_max_error_hz:.2g} Hz")
            )
            for words in check.besides:
                progress(f"{recording.name}: {words}; left aside")
            for words in run.heard():
                progress(f"{recording.name}: the FMU says: {words}")
            checks.append(check)
        result = Verification(Path(fmu).name, tuple(checks))
        keep(result)
    return result


def _check(run: FmuRun, recording: Recording, noise_ratio: float) -> RecordingCheck:
    runs = [_run(run, piece) for piece in _pieces(recording)]
    parts = [one.piece.recording for one in runs]
    measured = np.concatenate([np.asarray(part.response, float) for part in parts])
    simulated = np.concatenate([one.replay.response for one in runs])
    spread = float(np.std(measured))
    if not spread > 0:
        raise BadInput(f"{recording.name}: the response does not move; there is nothing to compare with")
    count = DRAWS if all(one.twin.values.size for one in runs) else DRAWS_OF_FMU
    noise = powers(runs, count, own=False)
    drawn = noise if all(one.twin.exact for one in runs) else powers(runs, count, own=True)
    nrmse = share_of_motion([simulated - measured], [measured])
    floor = usual(noise) / spread
    limit = noise_ratio * float(np.sqrt(by_chance(drawn))) / spread
    backbones = [pair for place, one in enumerate(runs) for pair in compared(one, place)]
    failed = of_size(nrmse, floor, limit) + _of_backbones(backbones, recording)
    score = None
    if not failed and run.model is not None and count == DRAWS:
        score = score_of(run.model, recording)
        failed += [] if score is None or score.passed else [score.sentence()]
    return RecordingCheck(
        recording.name,
        nrmse,
        floor,
        max((float(np.max(pair.distance)) for pair in backbones), default=None),
        not failed,
        np.concatenate([part.time for part in parts]),
        measured,
        simulated,
        tuple((pair.recorded, pair.simulated) for pair in backbones),
        Response(recording.quantity, recording.unit),
        tuple(words for one in runs for words in _besides(one.replay, recording)),
        limit,
        max((pair.over for pair in backbones), default=None),
        score,
        tuple(failed),
    )


def of_size(nrmse: float, floor: float, limit: float) -> list[str]:
    """The sentence of what is left, where that is more than chance."""
    if nrmse <= limit:
        return []
    return [
        f"an NRMSE of {nrmse:.3g} is left where noise alone leaves {floor:.3g} on average, and noise with the model's "
        f"own errors more than {limit:.3g} once in a thousand"
    ]


def _of_backbones(backbones: Sequence[Compared], recording: Recording) -> list[str]:
    """The sentence of the backbones that are farthest apart, where that is more than chance."""
    worst = max(backbones, key=lambda pair: pair.over, default=None)
    if worst is None or worst.over <= 1.0:
        return []
    there = worst.worst
    unit = Response(recording.quantity, recording.unit).displacement_unit
    return [
        f"the backbones ({worst.recorded.method}) are {worst.distance[there]:.3g} Hz apart at "
        f"{worst.amplitude[there]:.3g} {unit}, where noise and the model's own errors make more than "
        f"{worst.limit[there]:.3g} Hz once in a thousand"
    ]


def _besides(replay: Replay, recording: Recording) -> list[str]:
    """What the sensors were found to show beside the motion, in words: what exceeds their noise."""
    sensor, _ = noise_levels(recording)
    words = []
    if abs(replay.zero) > sensor:
        words.append(f"its sensor shows {said(recording, replay.zero)} at zero")
    if replay.drift:
        words.append(f"its sensor drifts by {said(recording, replay.drift, per='/s')}")
    if replay.load:
        words.append(f"its load cell shows {said(recording, replay.load, force=True)} at zero")
    return words


def _pieces(recording: Recording) -> list[Piece]:
    """Its pieces; raises BadInput where it has none."""
    parts = pieces(recording)
    if not parts:
        raise BadInput(
            f"{recording.name}: has neither a force nor a free decay; give the column of the force (--force)"
        )
    return parts


def _is_input(run: FmuRun, recording: Recording) -> None:
    """Raises BadInput where the recorded force is no input of the FMU, by their units."""
    wanted, given = find_unit(run.force_unit or ""), find_unit(recording.force_unit)
    if wanted is None or given is None or wanted.si == given.si:
        return
    if run.model is not None and run.model.mass is None:
        advice = "the mass was not identified; identify it from a recording with a force, or give it with --mass"
    else:
        advice = "say what the column is with --force and --force-unit"
    raise BadInput(f"{recording.name}: its force is in {given.text}, {run.path} needs one in {wanted.text}: {advice}")


def _run(run: FmuRun, piece: Piece) -> Run:
    """The FMU along a piece, and what answers in its place to other forces and parameters."""
    recording = piece.recording
    force, output = force_of(recording), run.output_for(recording)
    if force is not None:
        _is_input(run, recording)
    stopped: FmuStopped | None = None

    def simulate(state: np.ndarray, n: int, load: float) -> np.ndarray:
        nonlocal stopped
        pushed = force.shifted(-load) if force is not None and load else force
        try:
            return run.record(pushed, n, recording.dt, state, recording.start, output)
        except FmuStopped as stop:  # from another start the motion may stay within bounds
            stopped = stop
            return stop.of(n)

    replay = run_along(simulate, recording, run.inner)
    if stopped is not None and not np.all(np.isfinite(replay.response)):
        raise stopped
    pushed = force if force is None else force.shifted(-replay.load)
    twin = twin_of(run.model, recording, pushed, replay, piece.sensor)
    if twin is None:
        initial, n, dt, start = replay.initial, recording.n, recording.dt, recording.start
        twin = Twin(np.zeros(0), np.zeros((0, 0)), lambda other, _: run.record(other, n, dt, initial, start, output))
    return Run(piece, replay, twin)
