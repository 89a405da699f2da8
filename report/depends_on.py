"""On what the missing force depends: bars with errors, by each kind of coordinate alone and beyond the first."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..diagnose.depends_on import WORDS, DependsOn, percent
from .blocks import Block, Table, Text, picture
from .chart import Box, Chart
from .style import AFTER, BEFORE, EXACT

if TYPE_CHECKING:
    from ..diagnose.result import Location

_ROLES = {"part": "a part of it", "adds": "adds to it", "nothing": "adds nothing", "not-told": "not told"}
_ROOM = 10.0  # per cent beside none and all
_HALF = 0.32  # of a bar's row
_CAP = 0.12  # half of the stroke at either end of an error


def depends_on_blocks(place: Location) -> list[Block]:
    """Sentence, picture and table; empty where the shares are not known."""
    depends = place.depends_on
    if depends is None:
        return []
    caption = (
        "What each kind of coordinate explains of the missing force's power beyond the noise: by itself (left) and "
        f"beyond {WORDS[depends.first.kind]} (right). Strokes: standard errors, by leaving out each of "
        f"{depends.blocks} blocks of the recordings."
    )
    rows = tuple(
        (
            WORDS[share.kind],
            f"{percent(share.share, share.std)}",
            "" if share.within else percent(share.adds, share.adds_std),
            "the first" if share is depends.first else _ROLES[share.role],
        )
        for share in depends.shares
    )
    table = Table(("The missing force follows", "By itself", "Beyond the first", ""), rows, (1, 2), cards=True)
    sentence = f"{depends.sentence}. What no kind explains is neither a function of them nor noise of the sensors."
    return [Text(sentence, lead="It depends on:"), picture(lambda: depends_on_figure(depends), caption), table]


def depends_on_figure(depends: DependsOn, key: str = "depends-on") -> Chart:
    """Chart of the shares as bars with their errors, the first kind at the top."""
    chart = Chart(key, f"On what the missing force depends: {depends.sentence}")
    alone, beyond = chart.row(1.6, 1, height=26 * len(depends.shares) + 70)
    names = []
    for i, share in enumerate(depends.shares):
        at = float(len(depends.shares) - 1 - i)
        names.append((at, WORDS[share.kind]))
        for panel, value, std, colour in (
            (alone, share.share, share.std, AFTER),
            (beyond, 0.0 if share.within else share.adds, 0.0 if share.within else share.adds_std, BEFORE),
        ):
            said = f"{WORDS[share.kind]}: {percent(value, std)}"
            bar = (0.0, max(100.0 * value, 0.0))
            panel.marks.append(Box(bar, (at - _HALF, at + _HALF), colour, 1.0, said))
            if std > 0.0:
                low, high = 100.0 * (value - std), 100.0 * (value + std)
                panel.line(*_stroke(low, high, at), EXACT, width=1.3)
    for panel, title in ((alone, "By itself"), (beyond, f"Beyond {WORDS[depends.first.kind]}")):
        panel.title = title
        panel.y.set(names=names if panel is alone else (), low=-0.7, high=len(names) - 0.3)
        panel.x.label = "Share of the missing force's power [%]"
    # what is not told has errors of any size, which would hide the others
    alone.x.set(low=max(min(0.0, alone.limits("x")[0]), -_ROOM), high=100.0 + _ROOM)
    return chart


def _stroke(low: float, high: float, at: float) -> tuple[list[float], list[float]]:
    """A line from low to high with a short stroke at either end."""
    return [low, low, low, high, high, high], [at - _CAP, at + _CAP, at, at, at - _CAP, at + _CAP]
