"""Text files as loggers write them: prose, dates, sensitivities, units in a row of their own."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording.formats.delimited import read_delimited

ROWS = [(0.001 * i, 0.5 * i, 1.25 - 0.25 * i) for i in range(50)]


def text(above: str, delimiter: str = ";", comma: bool = True) -> bytes:
    rows = "\n".join(delimiter.join(f"{value:.4f}" for value in row) for row in ROWS)
    return f"{above}\n{rows.replace('.', ',') if comma else rows}\n".encode()


@pytest.mark.parametrize(
    ("above", "names", "units"),
    [
        ("Logger 12\nDate: 21.11.2026 12:00\nTime;Force;Disp\ns;N;mm", ("Time", "Force", "Disp"), ("s", "N", "mm")),
        ("Rate;1000\nTime;Force;Disp\nSens;10,2;22\ns;N;mm", ("Time", "Force", "Disp"), ("s", "N", "mm")),
        ("Ch0;Ch1;Ch2\nTime;Force;Disp\n[s];[N];[mm]", ("Time", "Force", "Disp"), ("s", "N", "mm")),
        ("Time;Force;Disp\ns;N;mm\nclock;AI1;AI2", ("Time", "Force", "Disp"), ("s", "N", "mm")),
        ("A logger\nwithout names", ("", "", ""), ("", "", "")),
        ("\n".join(f"Line {i}: words" for i in range(20)) + "\nt_s;F_N;x_mm", ("t_s", "F_N", "x_mm"), ("", "", "")),
    ],
)
@pytest.mark.parametrize("comma", [True, False])
def test_the_numbers_begin_where_they_do(above, names, units, comma):
    table = read_delimited("rig.csv", text(above, comma=comma))
    assert (table.names, table.units) == (names, units)
    np.testing.assert_allclose(table.numbers([0, 1, 2]), ROWS, rtol=1e-12)


@pytest.mark.parametrize(
    ("above", "says"),
    [
        ("t;F;x\n0;OVER;1", "line 2, column 'F' holds 'OVER'"),
        ("t;F;x\n0;1;2\nOVER;OVER;OVER", "line 3, column 't' holds 'OVER'"),
        ("t;F", "names 2 columns but line"),
    ],
)
def test_a_fault_among_the_numbers_is_no_preamble(above, says):
    with pytest.raises(BadInput, match=says):
        read_delimited("rig.csv", text(above, comma=False)).numbers([0, 1, 2])
