"""The names of the pictures of a page: those that docs/commands.md has, and no others."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from dashpot.identify import hilbert_analysis
from dashpot.report.diagnosis_page import diagnosis_page
from dashpot.report.hilbert_page import hilbert_page
from dashpot.report.page import identification_page
from dashpot.report.verification_page import verification_page

DOCUMENT = Path(__file__).parents[2] / "docs" / "commands.md"


def documented(command: str) -> set[str]:
    """The keys of a row of the table, without the numbers behind them."""
    table = DOCUMENT.read_text(encoding="utf-8").partition("## Pictures as files")[2]
    (row,) = (line for line in table.splitlines() if line.startswith(f"| `{command}"))
    return {re.sub(r"-1$", "", key) for key in re.findall(r"`([a-z0-9-]+)`", row.split("|")[3])}


def drawn(page) -> set[str]:
    return {re.sub(r"-\d+$", "", chart.key) for chart in page.charts}


def test_an_identification_and_its_verification_draw_what_is_documented(identifications, verified):
    found = identifications["stand"]()
    assert drawn(identification_page(found)) == documented("identify -o")
    assert drawn(verification_page(verified(found))) == documented("verify")
    assert drawn(hilbert_page(hilbert_analysis(found.recordings), found.recordings)) == documented("hilbert")


@pytest.mark.parametrize("verdict", ["missing-physics", "consistent", "unexplained"])
def test_a_diagnosis_draws_what_is_documented(hand_made, verdict):
    keys = drawn(diagnosis_page(hand_made.verdicts[verdict]()))
    assert keys <= documented("diagnose")
    assert keys == documented("diagnose") - {"depends-on"} or verdict != "missing-physics"
