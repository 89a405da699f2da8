"""``dashpot paper``: one page with every figure that it names."""

from __future__ import annotations

import pytest
from dashpot.face.paper import PAGE, run


@pytest.mark.long
def test_the_page_has_the_papers_figures(tmp_path):
    said: list[str] = []
    page = run(tmp_path / "paper", said.append)
    assert page == tmp_path / "paper" / PAGE
    text = page.read_text("utf-8")
    for number in (1, 3, 4, 5, 6, 7):
        assert f"Fig. {number}" in text, number
    assert text.count("<svg") + text.count("data:image") >= 6
    assert "Figure " not in text  # the paper's numbers and no others
    assert "http://" not in text.replace("http://www.w3.org", "")  # it needs nothing from elsewhere
    assert said[-1] == f"written: {page}"
