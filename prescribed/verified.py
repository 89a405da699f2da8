"""An FMU along motions that were imposed: the force that it gives, and what chance makes of a perfect element.

Noise comes twice: on the force, and on the motion, whose rates the force feels. Each draw has both once more, the
motion smoothed anew, and parameters from the element's own covariance, as ``chance`` has it of an oscillator.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import BadInput
from ..identify.signals.signals import noise_levels
from ..model import Response
from ..model.element import Element
from ..model.equations import FORCE
from ..model.left import share_of_motion
from ..recording.fact import changed
from ..recording.recording import Recording
from ..simulate.imposed import force_along
from ..verify.chance import by_chance, root_of, usual
from ..verify.fmu_run import FmuRun
from ..verify.model_inside import SAME, covariance_of
from ..verify.verification import DRAWS, DRAWS_OF_FMU, RecordingCheck, Verification, of_size
from ..verify.verification import verify as verify_any
from .motion import Imposed, imposed, unit_of_motion


def verify(fmu: Path, recordings: Sequence[Recording] | Any, **how: Any) -> Verification:
    """Run an FMU along recordings and compare: an oscillator's with their forces, an element's with their motions.

    Args:
        fmu: as ``verify.verification.verify`` takes it; or one of a force law by itself, with the inputs
            ``displacement``, ``velocity`` and ``acceleration`` and the output ``F``, which is held against the
            recorded force, but for a constant of each load cell.
        recordings: what it should reproduce.
        how: as of ``verify.verification.verify``, whose errors are raised too.
    """
    return verify_any(fmu, recordings, imposed=check_of_force, **how)


def check_of_force(run: FmuRun, recording: Recording, noise_ratio: float) -> RecordingCheck:
    """One recording of a prescribed motion against the FMU of an element.

    Raises BadInput where the recording's units are not the FMU's.
    """
    one = run_imposed(run, recording)
    motion, told = one.motion, one.motion.told
    spread, first = float(np.std(motion.force[told])), int(np.argmax(told))
    count = DRAWS if one.values.size else DRAWS_OF_FMU
    noise = one.powers(count, own=False)
    drawn = noise if one.exact else one.powers(count, own=True)
    nrmse, floor = (
        share_of_motion([(one.force - motion.force)[told]], [motion.force[told]]),
        usual(noise) / spread,
    )
    limit = noise_ratio * float(np.sqrt(by_chance(drawn))) / spread
    failed = of_size(nrmse, floor, limit)
    return RecordingCheck(
        recording.name,
        nrmse,
        floor,
        None,
        not failed,
        recording.time[first:],
        motion.force[first:],
        one.force[first:],
        (),
        Response(FORCE, recording.force_unit),
        nrmse_limit=limit,
        failed=tuple(failed),
    )


@dataclass(frozen=True, eq=False)
class ImposedRun:
    """An FMU along one recording.

    Attributes:
        recording: of the motion and its force.
        motion: of that.
        force: (n,) that the FMU gives, the recording's own constant in it.
        respond: displacement (n,) and (k,) parameters -> (n,) force, of the element inside or of the FMU itself.
        values: (k,) of the parameters; none where nothing is known of them.
        covariance: (k, k) of these.
    """

    recording: Recording
    motion: Imposed
    force: np.ndarray
    respond: Callable[[np.ndarray, np.ndarray], np.ndarray]
    values: np.ndarray
    covariance: np.ndarray

    @property
    def exact(self) -> bool:
        """Whether nothing is known of errors of its own."""
        return not np.any(self.covariance)

    def powers(self, count: int, *, own: bool) -> np.ndarray:
        """(draws,) mean square that each of ``count`` other recordings would leave.

        ``own`` says whether the parameters are drawn too.
        """
        return np.array([power for power in self._drawn(count, own) if np.isfinite(power)])

    def _drawn(self, count: int, own: bool) -> Iterator[float]:
        recording, motion, told = self.recording, self.motion, self.motion.told
        shown, sensor = np.asarray(recording.response, float), noise_levels(recording)[0]
        plain, root = self.respond(motion.displacement, self.values), root_of(self.covariance)
        for draw in range(count):
            values = self.values
            if own:
                values = values + root @ np.random.default_rng([1, draw]).standard_normal(len(root))
            random = np.random.default_rng([2, draw])
            moved = imposed(changed(recording, response=shown + sensor * random.standard_normal(shown.size)))
            left = self.respond(moved.displacement, values) - plain + motion.noise * random.standard_normal(shown.size)
            yield float(np.var(left[told]))


def run_imposed(run: FmuRun, recording: Recording) -> ImposedRun:
    """The FMU along the motion of a recording; raises BadInput where the recording's units are not the FMU's."""
    for name, unit in (("displacement", unit_of_motion(recording)), ("F", recording.force_unit)):
        wanted = run.variables[name].unit
        if wanted not in (None, unit):
            raise BadInput(
                f"{recording.name}: {name} is in {unit}, and {run.path} has it in {wanted}; say what the columns are "
                "with --prescribed, --force and their units"
            )
    motion = imposed(recording)
    channels = _channels(run, recording, motion)
    force = run.force_along(motion.displacement, motion.dt, motion.start, channels)
    inside = run.element
    told = motion.told
    values, covariance = np.zeros(0), np.zeros((0, 0))

    def asked(displacement: np.ndarray, _: np.ndarray) -> np.ndarray:
        return run.force_along(displacement, motion.dt, motion.start, channels)

    respond: Callable[[np.ndarray, np.ndarray], np.ndarray] = asked
    if inside is not None:
        made = force_along(inside, motion.displacement, motion.dt, start=motion.start, channels=motion.channels)
        if float(np.sqrt(np.mean((made - force)[told] ** 2))) <= SAME * motion.noise:  # it stands in for the FMU
            values = np.array(list(inside.values().values()))
            covariance = covariance_of(inside, tuple(inside.parameters()))
            respond = _core_of(inside, motion)
    constant = float(np.mean((motion.force - force)[told]))
    return ImposedRun(recording, motion, force + constant, respond, values, covariance)


def _channels(run: FmuRun, recording: Recording, motion: Imposed) -> list[np.ndarray]:
    """(n,) of each further input of an FMU; raises BadInput where the recording lacks it, or has another unit."""
    units, made = {channel.name: channel.unit for channel in recording.channels}, []
    for name in run.channels:
        own = name if name in units else name.removesuffix("_channel")
        wanted = run.variables[name].unit
        if own not in units:
            raise BadInput(
                f"{recording.name}: the force of {run.path} depends on the {own}, and nobody says what it was; give it "
                f"with --channel {own}=NUMBER{f', in {wanted}' if wanted else ''}, or name its column"
            )
        if wanted not in (None, units[own]):
            raise BadInput(f"{recording.name}: the channel {own} is in {units[own]}, and {run.path} has it in {wanted}")
        made.append(motion.channels[own])
    return made


def _core_of(element: Element, motion: Imposed) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    parameters = element.parameters()

    def respond(displacement: np.ndarray, values: np.ndarray) -> np.ndarray:
        moved = {n: replace(p, value=float(v)) for (n, p), v in zip(parameters.items(), values, strict=True)}
        how = {"start": motion.start, "channels": motion.channels}
        return force_along(element.with_parameters(moved), displacement, motion.dt, **how)

    return respond
