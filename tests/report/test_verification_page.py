"""The page of a verification: agreement, backbones, and what does not agree in words."""

from __future__ import annotations

from dataclasses import replace

from dashpot.report.verification_page import verification_page


def test_what_agrees_is_shown_by_recording(identifications, verified) -> None:
    page = verification_page(verified(identifications["stand"]())).html
    assert "<h1>Verification of rig.fmu</h1>" in page
    assert "The model reproduces all 2 recordings: its FMU leaves at most 1.00 times the noise floor." in page
    assert "What does not agree" not in page
    # each recording and its backbones, and a spectrum of the one nearest to its noise
    backbones = sum(bool(c.backbones) for c in verified(identifications["stand"]()).recordings)
    assert backbones > 0
    assert page.count("<figure ") == 2 + backbones + 1
    assert len(page) < 1.5e6


def test_what_does_not_agree_is_told_first(identifications, verified) -> None:
    proof = verified(identifications["stand"](), passed=False)
    told = {"failed": ("an NRMSE of 3 % where noise allows 1 %",), "besides": ("a zero of 1 µm",)}
    first = replace(proof.recordings[0], **told)
    page = verification_page(replace(proof, recordings=(first, proof.recordings[1]))).html
    assert "does not reproduce any of the 2 recordings" in page
    assert page.index("What does not agree") < page.index("Measured and simulated")
    assert "sweep.csv: an NRMSE of 3 % where noise allows 1 %." in page
    assert "sweep.csv: a zero of 1 µm." in page
