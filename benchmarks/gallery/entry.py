"""What the gallery knows of a recording before anything is run: one frozen entry each."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

#: What a run of one entry can end in: the three verdicts of a diagnosis, and the ways not to reach one.
VERDICTS = ("consistent", "missing-physics", "unexplained", "refused", "timeout", "fault")

Made = Literal["", "plate-angle"]


@dataclass(frozen=True)
class Piece:
    """One file that the commands get: a recording as it lies in the data folder, or a part of it.

    Attributes:
        source: file in the data folder; with ``stand/`` ahead one that the package brings.
        rows: first and last-but-one sample; None for the whole file, which is then handed on untouched.
        name: of the file that the commands see; that of the source where it is empty.
        made: what had to be done to the columns: ``plate-angle`` for an angle from pixels.
        motion: seconds from the first sample over which errors are stated; None for all. Rest before a release, the
            noise after a decay and a drive that was not recorded stay outside.
        judged: first and last-but-one sample of those that count in a published figure; None for all.
    """

    source: str
    rows: tuple[int, int] | None = None
    name: str = ""
    made: Made = ""
    motion: tuple[float, float] | None = None
    judged: tuple[int, int | None] | None = None

    @property
    def file(self) -> str:
        """Name of the file that the commands see."""
        return self.name or self.source.rpartition("/")[2]


@dataclass(frozen=True)
class Columns:
    """Which columns the plain fit reads, by their header; ``fs`` in Hz where no column holds the time."""

    response: str
    force: str | None = None
    time: str | None = "time_s"
    quantity: Literal["displacement", "velocity", "acceleration"] = "displacement"
    fs: float | None = None


@dataclass(frozen=True)
class Published:
    """A figure that others reached, or a fit outside this software: what, how much in which unit, by whom."""

    what: str
    value: float
    unit: str
    source: str


@dataclass(frozen=True)
class Bounds:
    """What an entry must keep: errors in per cent of the motion, and the allowed verdicts (all where empty)."""

    training: float | None = None
    holdout: float | None = None
    verdicts: tuple[str, ...] = ()


@dataclass(frozen=True)
class Entry:
    """One recording of the gallery.

    Attributes:
        name: how it is called on the command line.
        title: what it is.
        kind: ``free`` decay, ``forced``, or ``imposed`` motion (no oscillator: to be refused in one sentence).
        training, holdout: what is identified and diagnosed, and what is held out from both.
        tests: simulated at the end, for a published figure; no command but ``simulate`` sees them.
        options: of the commands, where the header does not say it all.
        columns: for the plain fit; None where there is nothing to fit.
        documented: effects that count as right where one is named.
        linear: whether what is documented is Eq. 17 itself, so that ``consistent`` is right.
        physics: the documented physics in words.
        published: figures to stand beside.
        note: what was done to the file, and what its origin leaves open.
        quick: whether it is among the fast ones.
        bounds: what must not get worse.
    """

    name: str
    title: str
    kind: Literal["free", "forced", "imposed"]
    training: tuple[Piece, ...]
    columns: Columns | None
    physics: str
    holdout: tuple[Piece, ...] = ()
    tests: tuple[Piece, ...] = ()
    options: tuple[str, ...] = ()
    documented: tuple[str, ...] = ()
    linear: bool = False
    published: tuple[Published, ...] = ()
    note: str = ""
    quick: bool = False
    bounds: Bounds = field(default=Bounds())

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """All of them."""
        return (*self.training, *self.holdout, *self.tests)
