"""What a person reads of FREEVIB: to the digits that the errors carry, and in the recorded unit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.identify.hilbert.hilbert_files import describe, shown_value, so_many
from dashpot.identify.hilbert.hilbert_result import _why_not, hilbert_analysis
from dashpot.model.parameter import Parameter
from dashpot.model.show import value_and_error
from dashpot.recording import Recording
from dashpot.report.hilbert_page import hilbert_page
from dashpot.report.modal_table import modal_table

FS = 500.0
T = np.arange(3000) / FS
X = 8e-3 * np.exp(-0.5 * T) * np.cos(60.0 * T) + 1e-6 * np.random.default_rng(0).standard_normal(T.size)


@pytest.fixture(scope="module")
def decay():
    given = [Recording("decay.csv", FS, X, recorded_unit="mm")]
    return hilbert_analysis(given), given


def test_the_terminal_rounds_to_the_errors_and_has_millimetres(decay):
    analysis, given = decay
    fit = analysis.freevib
    assert fit is not None
    first, *rows, last = describe(analysis, given).splitlines()
    assert first == "FREEVIB, 1 free decay"
    assert last.startswith("  Eqs. 1, 6 and 7 leave")
    found = {row.split()[0]: row.split()[1:] for row in rows}
    values, stds = {**fit.values, **fit.derived}, {**fit.stds, **fit.derived_std}
    for name, value in values.items():
        factor = 1e3 if name == "F0/k" else 1.0
        shown, error = value_and_error(Parameter(factor * value, factor * stds[name]))
        assert found[name][:3] == [shown, "±", error]
    assert found["F0/k"][3] == "mm"
    assert found["preload"][3] == "m/s2"  # as the table of parameters that `dashpot show` prints


def test_what_was_recorded_in_metres_or_several_units_is_in_metres(decay):
    analysis, given = decay
    plain = [replace(given[0], recorded_unit="")]
    for recordings in (plain, [*given, *plain], [*given, replace(given[0], recorded_unit="um")]):
        assert [row.split()[-1] for row in describe(analysis, recordings).splitlines() if "F0/k" in row] == ["m"]


def test_the_page_has_lengths_as_recorded_too(decay):
    analysis, given = decay
    fit = analysis.freevib
    assert fit is not None
    table = modal_table(analysis, "m", "N", length=(1e3, "mm"), truth={"F0/k": 2e-6})
    assert table is not None
    (row,) = [row for row in table.rows if row[0] == "F0/k"]
    assert row[2:] == ("0.002", "mm")
    page = hilbert_page(analysis, given).html
    assert " mm, where the spring pulls with " in page
    assert "Each with one standard error." in page


def test_the_caption_promises_no_error_where_none_is_stated(decay):
    analysis, _ = decay
    assert analysis.freevib is not None
    table = modal_table(replace(analysis, freevib=analysis.freevib.without_errors), "m", "N")
    assert table is not None
    assert "Each with one standard error" not in str(table.caption)
    assert "none is stated" in str(table.caption)


def test_a_length_and_its_error_change_their_unit_together():
    assert shown_value("F0/k", 2e-3, 1e-4, "m", "N", (1e3, "mm")) == Parameter(2.0, 0.1, "mm")
    assert shown_value("F0/k", 2e-3, np.inf, "m", "N") == Parameter(2e-3, None, "m")
    assert shown_value("cubic", 2.0, 0.5, "m", "N", (1e3, "mm")) == Parameter(2.0, 0.5, "1/(m2.s2)")


def test_one_is_no_plural():
    assert (so_many(1, "free decay"), so_many(2, "driven stretch")) == ("1 free decay", "2 driven stretches")


def test_hundreds_of_times_have_no_power_of_ten(decay):
    analysis, _ = decay
    assert " leave 180 times its noise" in _why_not(analysis.curves[0], 182.0**2)
