"""The pictures of a page as files: which kinds, under which names, and what is refused before anything is drawn."""

from __future__ import annotations

import dashpot
import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.face.figures import beside, kinds_of


def test_kinds_are_taken_as_a_text_or_several_each_once():
    assert kinds_of("pdf, SVG,pdf") == ("pdf", "svg")
    assert kinds_of(["png"]) == ("png",)
    for wrong in ("gif", "", "pdf,,svg", 3, [1], None):
        with pytest.raises(BadInput, match="kind"):
            kinds_of(wrong)


def test_the_folder_is_named_after_the_file_beside_which_it_stands(tmp_path):
    assert beside(tmp_path / "rig.yaml") == tmp_path / "rig-figures"


def test_an_analysis_draws_the_charts_of_its_page(tmp_path):
    t = np.arange(2000) / 500.0
    noise = np.random.default_rng(1).normal(size=t.size)
    decay = 5e-3 * np.exp(-2.0 * t) * np.cos(80.0 * t) + 1e-6 * noise
    found = dashpot.hilbert(decay, fs=500.0)
    drawn = found.figures(tmp_path / "paper", "svg,pdf")
    assert {path.name for path in drawn} >= {"curves.svg", "curves.pdf"}
    assert {path.read_bytes()[:4] for path in drawn} == {b"<?xm", b"%PDF"}
    with pytest.raises(BadInput, match="'gif' is no kind of picture; there are pdf, png, svg"):
        found.figures(tmp_path / "other", "gif")
    assert not (tmp_path / "other").exists()


def test_a_loaded_model_has_no_pictures(tmp_path):
    model = dashpot.Model.from_values(TRUTH)
    with pytest.raises(BadInput, match="identify it here"):
        model.figures(tmp_path)
