"""Blocks of recordings that no law explains while the rest agrees: a hand, a knock, a touched table.

Whatever acted there once is no physics of the rig, and one model of all blocks is bent by it. The best structure starts
anew in each block of some cycles, so that what happened in one does not reach the next. What it leaves in a block is
held against what it leaves where the motion is as large or larger: what the structure lacks shows there too. A block
beyond what these scatter is a stretch along which something unrecorded acted (``Recording.unknown``); it is left out,
and the motion behind it begins anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..identify.faults.limits import ALIKE
from ..identify.motion.blows import ContactForce
from ..identify.problem.data import Data, expected_noise
from ..identify.problem.limits import WORTH_ITS_START
from ..identify.problem.normal_equations import pseudo_inverse
from ..identify.problem.prediction import FREE
from ..identify.problem.segments import Segment
from ..identify.signals.odds import ABOVE_NOISE, BY_CHANCE, SIGNIFICANT
from ..identify.signals.registry import budget, numerics
from ..recording.fact import changed
from ..recording.recording import Recording
from .limits import FEWEST_WINDOWS
from .search.found import Found
from .search.weigh import in_stretches, judged

MOST_TIMES = budget(2, "searches again", why="where ever more blocks stand out of the rest, they are no exceptions")
_RANGE = numerics(2.0, "times", why="the range of amplitudes over which a power of it describes what is left")


@dataclass(frozen=True)
class OddBlock:
    """A block that no law explains.

    Attributes:
        file: the recording's name.
        begin, end: when it is, s.
        times: rms of what is left there over that of motion as large elsewhere.
    """

    file: str
    begin: float
    end: float
    times: float

    def __str__(self) -> str:
        return f"{self.file}, {self.begin:.4g} to {self.end:.4g} s"

    @property
    def sentence(self) -> str:
        """For a person."""
        return (
            f"{self}: no law explains what happens there ({self.times:.2g} "
            "times what is left of motion as large elsewhere), as where a hand or a knock moved or stopped the rig, or "
            "friction held it; it was left out"
        )


def odd_blocks(found: Found) -> list[OddBlock]:
    """Where the best structure of a search leaves far more than elsewhere, in order of the recordings."""
    blocks: list[tuple[OddBlock, Segment, float]] = []
    for data in found.weighing.parts:
        if data.segments[0].slide:
            return []  # whose pieces are a cycle each
        parted = _moving(replace(in_stretches(data, _count), memory=FREE))
        if not parted.segments:
            continue
        fitted = judged(found.fitted.model, parted)
        values = fitted.model.values()
        for i, (segment, left) in enumerate(zip(parted.segments, fitted.residuals, strict=True)):
            noise = expected_noise(segment, values, parted.sensor[i], parted.force[i])
            ratio = float(np.sqrt(np.mean(left**2))) / noise
            name = parted.recordings[segment.recording].name
            whole = OddBlock(name, segment.time, segment.time + segment.n * segment.dt, ratio)
            blocks.append((whole, segment, float(np.std(segment.response))))
    levels = [_level(i, blocks) for i in range(len(blocks))]
    odd = {i for i, level in enumerate(levels) if level is not None and level[1]}
    made: list[OddBlock] = []
    for i, (block, segment, _) in enumerate(blocks):
        level = levels[i]
        beside = {i - 1, i + 1} & odd and level is not None and level[2]
        if level is None or not (i in odd or beside):
            continue
        times = block.times / level[0]
        if made and made[-1].file == block.file and abs(made[-1].end - block.begin) < segment.dt:
            made[-1] = replace(made[-1], end=block.end, times=max(times, made[-1].times))
        else:
            made.append(replace(block, times=times))
    return made


def _count(segment: Segment) -> int:
    """Into how many blocks a segment is cut: of as many cycles as say more than the state at their beginning.

    A blow is one with its ringing.
    """
    if isinstance(segment.force, ContactForce):
        return 1
    return max(1, int(segment.n * segment.dt * segment.pace / (2 * np.pi) / WORTH_ITS_START))


def _moving(data: Data) -> Data:
    """The same without segments that do not move, which say nothing."""
    kept = [i for i, s in enumerate(data.segments) if np.std(s.response) > data.sensor[i] > 0.0]
    segments, sensor, force = (tuple(row[i] for i in kept) for row in (data.segments, data.sensor, data.force))
    return replace(data, segments=segments, sensor=sensor, force=force)


def _level(i: int, blocks: Sequence[tuple[OddBlock, Segment, float]]) -> tuple[float, bool, bool] | None:
    """What is left of motion as large as that of a block, whether the block has decidedly more, and whether it has
    significantly more; None where there is too little such motion.

    The power that is left goes with a power of the amplitude, over a small range of it (an outlier of a regression, by
    the rest of it: Cook and Weisberg 1982, section 2.2).
    """
    from scipy.special import stdtrit

    block, segment, moved = blocks[i]
    alike = [
        (np.log(size), 2.0 * np.log(max(other.times, np.finfo(float).tiny)))
        for k, (other, where, size) in enumerate(blocks)
        if abs(k - i) > 1
        and moved / _RANGE <= size <= moved * _RANGE
        and (where.quantity, where.force is None) == (segment.quantity, segment.force is None)
    ]
    if len(alike) < FEWEST_WINDOWS:
        return None
    x, y = np.array(alike).T
    if not np.all(np.isfinite(y)) or not 0.0 < block.times < np.inf or np.max(x) < np.log(moved / ALIKE):
        return None  # what nothing else is as large as may be where physics begins
    x = x - np.log(moved)
    columns = np.stack([np.ones(x.size), x], axis=1)
    expected, slope = np.linalg.lstsq(columns, y, rcond=None)[0]
    freedom = x.size - 2
    spread = np.sqrt(np.sum((y - expected - slope * x) ** 2) / freedom)
    of_mean = pseudo_inverse(columns.T @ columns)[0, 0]
    spread = max(float(spread), np.sqrt(2.0 / segment.n)) * np.sqrt(1.0 + of_mean)
    beyond = 2.0 * np.log(block.times) - max(expected, 2.0 * np.log(ABOVE_NOISE))
    far = float(stdtrit(freedom, 1.0 - BY_CHANCE / len(blocks)))
    return float(np.exp(expected / 2)), bool(beyond > far * spread), bool(beyond > SIGNIFICANT * spread)


def without(recordings: Sequence[Recording], odd: Sequence[OddBlock]) -> list[Recording]:
    """Recordings along which it is not known what acted in these blocks."""
    made = []
    for recording in recordings:
        runs = set(recording.unknown)
        for block in odd:
            # a stretch of a recording is named for it
            if block.file == recording.name or block.file.startswith(f"{recording.name}, "):
                first, last = (round((t - recording.start) * recording.fs) for t in (block.begin, block.end))
                runs.add((max(first, 0), min(last, recording.n)))
        made.append(changed(recording, unknown=tuple(sorted(runs))) if runs > set(recording.unknown) else recording)
    return made
