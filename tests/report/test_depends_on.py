"""The picture of the shares: a bar a kind with its error, the first at the top."""

from __future__ import annotations

from dataclasses import replace

import pytest
from dashpot.diagnose.depends_on import DependsOn, Share
from dashpot.diagnose.result import Location
from dashpot.report.blocks import Figure, Table, Text
from dashpot.report.chart import Box, Line
from dashpot.report.depends_on import depends_on_blocks

PLACE = Location("restoring", "", (0, 1), (0, 1), (0, 1), (0, 1), (0, 1), (), {})
DEPENDS = DependsOn(
    (
        Share("displacement", 0.8, 0.04, 0.8, 0.04, within=True),
        Share("memory", 0.3, 0.02, 0.08, 0.02),
        Share("constant", 0.1, 0.02, 0.0, 0.0, within=True),
        Share("time", 0.0, 0.0, -0.01, 0.006),
    ),
    40,
)


def test_bars_and_strokes_are_the_shares_and_their_errors():
    text, figure, table = depends_on_blocks(replace(PLACE, depends_on=DEPENDS))
    assert isinstance(text, Text)
    assert isinstance(figure, Figure)
    assert isinstance(table, Table)
    assert text.text.startswith("80 ± 4 % by displacement; the motion before adds 8 ± 2 %; time adds nothing")
    alone, beyond = figure.chart.panels
    bars = [mark for mark in alone.marks if isinstance(mark, Box)]
    assert [bar.x[1] for bar in bars] == pytest.approx([80.0, 30.0, 10.0, 0.0])
    strokes = [mark for mark in alone.marks if isinstance(mark, Line)]
    assert [(line.x.min(), line.x.max()) for line in strokes] == [
        pytest.approx((76.0, 84.0)),
        pytest.approx((28.0, 32.0)),
        pytest.approx((8.0, 12.0)),
    ]
    assert bars[0].y[0] > bars[1].y[1]  # the first at the top
    assert [mark.x[1] for mark in beyond.marks if isinstance(mark, Box)] == pytest.approx([0.0, 8.0, 0.0, 0.0])
    assert [row[3] for row in table.rows] == ["the first", "adds to it", "a part of it", "adds nothing"]


def test_without_shares_there_is_nothing():
    assert depends_on_blocks(PLACE) == []
