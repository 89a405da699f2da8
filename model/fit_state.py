"""The state of a fit, which travels with its result: what it leaves of each recording, and what that means for use.

The model file keeps it by recording (``identified.recordings``); every figure and sentence about it, in ``show``, FMU,
CasADi functions, C, SSP, notebooks and reports, is made here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..errors import BadInput

if TYPE_CHECKING:
    from .element import Element
    from .oscillator import Oscillator

#: A recording holds more than a model where that leaves so many times its noise, which itself is estimated.
LACKING = 1.5
#: A simulation follows the motion where it leaves less than this part of it: its phase is then off by less than as much
#: in radians, where a sine is still a straight line.
FOLLOWS = 0.3


@dataclass(frozen=True)
class MostLeft:
    """What a model may leave of a recording: a part of the motion's standard deviation, or so many times the noise."""

    part: float = math.inf
    times: float = math.inf


@dataclass(frozen=True)
class Left:
    """What a model leaves of a recording, rms; ``left.py`` makes both figures.

    Attributes:
        file: the recording's name.
        part: over the standard deviation of the motion, simulated freely; of an element, of the force.
        times: the same rms over that of the noise.
        of: what was fitted, ``motion`` or ``force``.
    """

    file: str
    part: float
    times: float
    of: str = "motion"

    @property
    def noise(self) -> float:
        """What noise alone leaves, as a part of the motion."""
        return self.part / self.times if self.times > 0 and math.isfinite(self.part) else math.nan

    @property
    def of_noise(self) -> str:
        """``19 times the noise``."""
        return f"{times_words(self.times)} times the noise"

    @property
    def of_motion(self) -> str:
        """``3.2 % of the motion``, or of the force."""
        return f"{percent_words(100 * self.part)} % of the {self.of}"

    def as_json(self) -> dict[str, float]:
        """As a model file has it, under a recording; without what is not finite."""
        figures = {"nrmse": self.part, "over_noise": self.times}
        return {name: value for name, value in figures.items() if math.isfinite(value)}


def left_of(model: Oscillator | Element) -> list[Left]:
    """What a model leaves of each recording that it was identified from, where that is known."""
    of = "force" if model.imposed else "motion"
    return [
        Left(str(r["file"]), float(r["nrmse"]), float(r["over_noise"]), of)
        for r in model.identified.recordings
        if r.get("nrmse") is not None and r.get("over_noise") is not None
    ]


def times_words(ratio: float) -> str:
    """How many times as large, in ASCII: ``1.02``, ``12``, ``190``."""
    if not math.isfinite(ratio):
        return "infinitely many"
    if ratio < 100:
        return f"{ratio:.2f}" if ratio < 9.995 else f"{ratio:.0f}"
    return f"{float(f'{ratio:.2g}'):.6g}"


def percent_words(share: float) -> str:
    """A share in percent (already times 100) to two digits, in ASCII."""
    return f"{share:.2g}" if share < 99.5 else f"{share:.0f}"


def parse_most_left(text: str) -> MostLeft:
    """``5%`` of the motion or ``3x`` the noise; raises BadInput for anything else."""
    try:
        size = float(text.strip()[:-1])
    except ValueError:
        size = -1.0
    if not 0.0 < size < float("inf") or text.strip()[-1] not in "%x":
        raise BadInput(f"'{text}' is neither a share of the motion, such as 5%, nor times the noise, such as 3x")
    return MostLeft(part=size / 100.0) if text.strip().endswith("%") else MostLeft(times=size)


def beyond(oscillator: Oscillator, most: MostLeft) -> list[str]:
    """A sentence for each recording of which the model leaves more than that.

    A part of the motion counts where it is more than noise, which no model tells.
    """
    allowed = (
        f"{100 * most.part:.4g} % of the motion" if math.isinf(most.times) else f"{most.times:.4g} times the noise"
    )
    return [
        f"{left.file}: the model leaves {left.of_motion}, {left.of_noise}, more than {allowed}"
        for left in left_of(oscillator)
        if (left.part > most.part and left.times > LACKING) or left.times > most.times
    ]


def left_over(model: Oscillator | Element) -> list[str]:
    """A sentence for each recording of which the model leaves more than its noise."""
    family = "model" if model.terms else "Eq. 17 family"
    return [
        f"{left.file}: the model leaves {left.of_noise}, {left.of_motion}, "
        f"so the recording holds something that the {family} does not, and the parameters may be off by more than "
        "their errors"
        for left in lacking(model)
    ]


def faults_of_recordings(oscillator: Oscillator) -> list[str]:
    """A sentence for each recording to which the measuring chain did something that the fit does not know of."""
    return [
        f"{r['file']}: {r['fault']}; until then the parameters may be off by more than their errors"
        for r in _faulty(oscillator)
    ]


def state_of_fit(model: Oscillator | Element) -> str | None:
    """What must be known of all of a model's parameters, in a sentence without names of files; None: nothing.

    It has at most 250 characters of ASCII, so that it can stand anywhere.
    """
    count, beyond_noise, faulty = len(model.identified.recordings), lacking(model), _faulty(model)
    sentences = []
    if beyond_noise:
        part, times = (max(getattr(left, figure) for left in beyond_noise) for figure in ("part", "times"))
        most = Left("", part, times, beyond_noise[0].of)
        sentences.append(
            f"the model leaves more than noise of {_of(len(beyond_noise), count)}, up to {most.of_noise} and "
            f"{most.of_motion}"
        )
    if faulty:
        sentences.append(
            f"{_of(len(faulty), count)} {'bears' if len(faulty) == 1 else 'bear'} a fault of the measuring chain"
        )
    if not sentences:
        return None
    return f"{', and '.join(sentences)}, so the parameters may be off by more than their errors"


def _of(some: int, count: int) -> str:
    return "its recording" if count == 1 else f"{some} of its {count} recordings"


def lacking(model: Oscillator | Element) -> list[Left]:
    """What the model leaves of those recordings that hold more than it does."""
    return [left for left in left_of(model) if left.times > LACKING]


def _faulty(model: Oscillator | Element) -> list[Mapping[str, Any]]:
    return [r for r in model.identified.recordings if r.get("fault")]
