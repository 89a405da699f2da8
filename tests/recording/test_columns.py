"""Which column is which."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording.columns import choose_columns, parse_column
from dashpot.recording.table import Table


def table(*names: str, units: tuple[str, ...] = ()) -> Table:
    return Table("rig.csv", names, units or ("",) * len(names), lambda indices: np.zeros((2, len(indices))))


@pytest.mark.parametrize(
    ("name", "base", "unit", "kind"),
    [
        ("time_s", "time", "s", "time"),
        ("t_s", "t", "s", "time"),
        ("Time (ms)", "Time", "ms", "time"),
        ("t / s", "t", "s", "time"),
        ("Time/s", "Time", "s", "time"),
        ("Angle/rad", "Angle", "rad", "displacement"),
        ("rate/slope", "rate/slope", None, ""),
        ("force_N", "force", "N", "force"),
        ("F_N", "F", "N", "force"),
        ("F_in", "F_in", None, "force"),
        ("Force (N)", "Force", "N", "force"),
        ("displacement_m", "displacement", "m", "displacement"),
        ("x_mm", "x", "mm", "displacement"),
        ("x_in", "x", "in", "displacement"),
        ("Displacement [mm]", "Displacement", "mm", "displacement"),
        ("Angle, Ch P2 (rad) Run #14", "Angle, Ch P2 Run #14", "rad", "displacement"),
        ("Force (left) sensor", "Force (left) sensor", None, "force"),
        ("velocity_m_s", "velocity", "m/s", "velocity"),
        ("acceleration_g", "acceleration", "g", "acceleration"),
        ("acc_m_s2", "acc", "m/s2", "acceleration"),
        ("phi_rad", "phi", "rad", "displacement"),
        ("strain0_microstrain", "strain0", "microstrain", "displacement"),
        ("laser1_mm", "laser1", "mm", "displacement"),
        ("x(t)", "x(t)", None, "displacement"),
        ("V1_V", "V1", "V", ""),
        ("V_in", "V_in", None, ""),
        ("temperature", "temperature", None, ""),
    ],
)
def test_header_cells(name, base, unit, kind):
    column = parse_column(name)
    assert (column.base, column.unit.text if column.unit else None, column.kind) == (base, unit, kind)


@pytest.mark.parametrize(
    ("names", "options", "expected"),
    [
        (("time_s", "force_N", "displacement_m"), {}, (0, 1, 2)),
        (("x_mm", "t_s"), {}, (1, None, 0)),
        (("time_s", "force_N", "lvdt_V"), {}, (0, 1, 2)),
        (("t_s", "F_V", "probe_V"), {}, (0, 1, 2)),
        (("V1_V", "V2_V"), {"force": "V1_V", "response": "V2_V"}, (None, 0, 1)),
        (("V1_V", "V2_V"), {"force": "v1_v"}, (None, 0, 1)),
        (("time_s", "x_m", "a_m_s2"), {"quantity": "acceleration"}, (0, None, 2)),
        (("time_s", "x_m", "a_m_s2"), {"response": "a"}, (0, None, 2)),
        (("time_s", "force_N", "x_m"), {"force": "none"}, (0, None, 2)),
        (("time_s", "force_N", "x_m"), {"time": "none"}, (None, 1, 2)),
        (("", "", ""), {"time": "1", "force": 2, "response": "3"}, (0, 1, 2)),
        (("", ""), {"time": 1, "response": 2}, (0, None, 1)),
        (("",), {}, (None, None, 0)),
        (("time_s", "force_N", "x_m", "temperature_C"), {}, (0, 1, 2)),
    ],
)
def test_choice(names, options, expected):
    choice = choose_columns(table(*names), **options)
    assert (choice.time, choice.force, choice.response) == expected


def test_a_guess_is_noted():
    assert "probe_V" in choose_columns(table("time_s", "force_N", "probe_V")).notes[0]
    assert choose_columns(table("time_s", "force_N", "x_m")).notes == ()


def test_a_row_of_units_counts():
    choice = choose_columns(table("a1", "probe", "Zeit", units=("N", "mm", "s")))
    assert (choice.time, choice.force, choice.response) == (2, 0, 1)


@pytest.mark.parametrize(
    ("names", "options", "words"),
    [
        (("V1_V", "V2_V"), {}, "'V1_V', 'V2_V' is the response.*--response.*--base.*--force.*--fs"),
        (("time_s", "x_m", "y_m"), {}, "'x_m', 'y_m' is the response.*--response"),
        (("time_s", "force_N"), {}, "no column for the response.*--response"),
        (("t_s", "time_s", "x_m"), {}, "look like the time.*--time"),
        (("t_s", "F1_N", "F2_N", "x_m"), {}, "look like the force.*--force"),
        (("time_s", "x_m"), {"response": "xx_m"}, "no column 'xx_m'.*did you mean 'x_m'"),
        (("time_s", "x_m"), {"response": "qqq"}, "it has 'time_s', 'x_m'"),
        (("time_s", "x_m"), {"response": 3}, "numbered 1 to 2"),
        (("time_s", "x_m"), {"response": "x_m", "force": 2}, "--force and --response name the same column 'x_m'"),
        (("", ""), {}, "no header line.*--time 1 --response 2"),
        (("", "", ""), {}, "no header line.*--time 1 --force 2 --response 3"),
        (("", ""), {"response": "x_m"}, "must be a number from 1 to 2"),
    ],
)
def test_doubt_is_an_error_that_names_the_option(names, options, words):
    with pytest.raises(BadInput, match=words):
        choose_columns(table(*names), **options)
