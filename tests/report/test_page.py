"""The page stands alone, is well-formed, says what came out, and escapes whatever a model file brings."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser

import pytest
from dashpot.model.display import number
from dashpot.model.laws import LIBRARY
from dashpot.report.agreement import agreement_section, verdict
from dashpot.report.blocks import Page, Section, Text
from dashpot.report.comparison import comparisons
from dashpot.report.page import identification_page
from dashpot.report.parameters import equation_blocks
from dashpot.report.usage import usage_section
from dashpot.verify.verification import Verification

VOID = {"meta", "link", "br", "hr", "img", "input"}
NASTY = '"; system("x"); // <script>alert(1)</script> $x^{2 & \'ü\' \x00\ud800 {{ 7*7 }}'
TRUTH = {"mass": 0.27, "omega0": 79.6, "cubic": 4.6e5, "preload": 0.074, "viscous": 5.0, "dry": 0.015}


class Reader(HTMLParser):
    """Keeps text and attributes, and fails where tags do not close in order."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.attributes: list[tuple[str, str, str]] = []
        self.tags: list[str] = []
        self.words: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += [(tag, name, value or "") for name, value in attrs]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += [(tag, name, value or "") for name, value in attrs]

    def handle_endtag(self, tag: str) -> None:
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] not in ("style", "script"):
            self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


@pytest.fixture(scope="module")
def pages(identifications, verified) -> Callable[[str, bool], str]:
    """Page of an identification, with or without a verification, written once."""

    @cache
    def write(kind: str, proven: bool) -> str:
        identification = identifications[kind]()
        truth = TRUTH if kind == "stand" and proven else None
        return identification_page(
            identification, verified(identification) if proven else None, truth, files=("model.yaml",)
        ).html

    return write


@pytest.mark.parametrize(
    ("kind", "proven"),
    [pytest.param("stand", False, marks=pytest.mark.long), ("stand", True), ("roll", False), ("volts", True)],
)
def test_the_page_is_well_formed_and_stands_alone(kind, proven, pages) -> None:
    reader = Reader(pages(kind, proven))
    assert not {"link", "iframe", "object", "embed", "img"} & set(reader.tags)
    for tag, name, value in reader.attributes:
        if name in ("src", "href", "xlink:href", "data", "action"):
            assert value.startswith("#"), f"{tag} {name}={value}"
        assert not name.startswith("on")
        if not name.startswith("xmlns"):
            assert "http" not in value
    ids = [value for _, name, value in reader.attributes if name == "id"]
    assert len(ids) == len(set(ids))
    assert "@import" not in reader.text
    charts = json.loads(
        re.search(r'<script type="application/json" id="charts">(.*?)</script>', pages(kind, proven))[1]
    )
    drawn = [value for _, name, value in reader.attributes if name == "data-chart"]
    assert [chart["key"] for chart in charts] == drawn
    assert len(drawn) == len(set(drawn)) >= 5
    assert reader.text.count("In figures") == len(drawn)
    assert len(pages(kind, proven).encode()) < 1_500_000


def test_every_parameter_is_shown_with_error_unit_and_truth(identifications, pages) -> None:
    identification = identifications["stand"]()
    text = Reader(pages("stand", True)).text
    assert "True value" in text
    off = (identification.oscillator.mass.value - 0.27) / identification.oscillator.mass.std
    assert f"{off:+.1f}".replace("-", "−") in text
    for unit in ("kg", "rad/s", "1/(m²·s²)", "m/s²", "1/s"):
        assert unit in text
    assert "True value" not in Reader(pages("stand", False)).text


def test_the_verdict_follows_the_verification(identifications, verified, pages) -> None:
    identification = identifications["stand"]()

    def said(proof: Verification) -> str:
        return verdict(comparisons(identification, proof)).text

    assert "The model reproduces all 2 recordings: its FMU" in Reader(pages("stand", True)).text
    assert "reproduces all 2 recordings, among them multisine.csv" in said(
        verified(identification, held_out="multisine.csv")
    )
    wide = verified(identification)
    wide = replace(wide, recordings=tuple(replace(c, nrmse=0.05, nrmse_limit=0.2) for c in wide.recordings))
    shown = verdict(comparisons(identification, wide))
    assert shown.tone == "note"
    assert "no better than its own errors allow: its FMU leaves 5 % of the motion" in shown.text
    assert "where 20 % would still pass" in shown.text
    bad = said(verified(identification, passed=False))
    assert "does not reproduce any of the 2 recordings" in bad
    assert "10 times what noise explains" in bad
    assert "not verified as an FMU" in Reader(pages("stand", False)).text


def test_a_diverging_simulation_is_told_and_drawn_as_far_as_it_goes(identifications, verified) -> None:
    identification = identifications["stand"]()
    proof = verified(identification, passed=False)
    first = proof.recordings[0]
    lost = first.simulated.copy()
    lost[300:] = float("nan")
    proof = replace(proof, recordings=(replace(first, nrmse=float("nan"), simulated=lost), proof.recordings[1]))
    shown = comparisons(identification, proof)
    assert f"simulation of {first.file} diverges" in verdict(shown).text
    kinds = [block.kind for block in agreement_section(shown, "FMU").blocks]
    assert kinds == ["table", "figure", "figure", "figure"]  # no spectrum of the one that diverges


def test_without_a_force_the_mass_is_unknown(pages) -> None:
    text = Reader(pages("roll", False)).text
    assert "mass unknown" in text
    assert re.search(r"\d deg\b", text)
    assert "= f(t)" in text


def test_a_nasty_name_is_harmless(identifications) -> None:
    identification = identifications["stand"]()
    first = replace(identification.recordings[0], name=NASTY, notes=(NASTY,))
    kinds = ({"file": NASTY, "kind": NASTY, "sha256": None}, *identification.oscillator.identified.recordings[1:])
    model = replace(
        identification.oscillator,
        name=NASTY,
        identified=replace(identification.oscillator.identified, recordings=kinds, software=NASTY),
    )
    identification = replace(
        identification, oscillator=model, recordings=(first, identification.recordings[1]), notes=(NASTY,)
    )
    text = identification_page(identification, files=(NASTY + ".yaml",)).html
    assert text.encode("utf-8")
    reader = Reader(text)
    assert reader.tags.count("script") == 3
    assert "<script>alert(1)</script>" in reader.text
    assert "{{ 7*7 }}" in reader.text
    assert "\x00" not in text


def test_the_same_results_give_the_same_page(identifications, verified, pages) -> None:
    identification = identifications["volts"]()
    again = identification_page(identification, verified(identification), None, ("model.yaml",)).html
    assert again == pages("volts", True)


def test_the_files_that_were_made_are_named_in_the_code(identifications) -> None:
    model = identifications["stand"]().oscillator

    def said(*files: str) -> str:
        return Reader(Page("Use", [usage_section(model, files)]).html).text

    text = said("model.yaml", "my rig.fmu", "my rig.casadi", "my rig.step.casadi")
    assert 'simulate_fmu("my rig.fmu"' in text
    assert 'ca.Function.load("my rig.casadi")' in text
    assert "dashpot export" not in text
    assert "dashpot export model.yaml model.fmu" in said()


def test_notes_and_warnings_reach_the_page(pages) -> None:
    assert "A gap of one sample was closed." in Reader(pages("stand", False)).text
    assert "not distinguishable from zero in these recordings" in Reader(pages("roll", False)).text


def test_an_empty_section_is_left_out() -> None:
    text = Reader(Page("A page", [Section("Empty", ()), Section("Full", (Text("words"),))]).html).text
    assert "Empty" not in text
    assert "Full words" in text


@pytest.mark.parametrize(
    "effect",
    [
        "hysteresis",
        *(
            pytest.param(effect, marks=pytest.mark.long)
            for effect in ("attached-resonator", "actuator-backlash", "sensor-nonlinearity")
        ),
    ],
)
def test_a_model_with_laws_of_any_kind_has_its_page(effect, identifications, with_law) -> None:
    identification = identifications["stand"]()
    model = replace(
        with_law(effect), identified=identification.oscillator.identified, amplitude=identification.oscillator.amplitude
    )
    text = Reader(identification_page(replace(identification, oscillator=model)).html).text
    assert "No picture here" not in text
    kind = "mean" if effect in ("hysteresis", "attached-resonator") else "exact"
    assert f"thin: the model's {kind} backbone" in text
    for name in model.parameters():
        assert name in text


@pytest.mark.parametrize("effect", LIBRARY)
def test_the_equation_of_every_law_is_shown_with_its_numbers(effect, with_law) -> None:
    model = with_law(effect)
    shown = [block.text for block in equation_blocks(model)]
    half = (len(shown) - 1) // 2
    letters, numbers = shown[:half], shown[half : 2 * half]
    assert letters == model.equation().split("; ")
    assert not {"{", "}"} & set("".join(shown))
    for name, value in model.values().items():
        if name.startswith(effect) and value:
            assert number(value, 4) in " ".join(numbers)
            assert name.rpartition(".")[2] in " ".join(letters) or effect in " ".join(letters)


def test_a_memory_that_cannot_be_followed_is_said_in_the_place_of_the_picture(identifications, with_law) -> None:
    identification = identifications["stand"]()
    model = replace(
        with_law("viscoelastic", **{"viscoelastic.rate": 1e9}), amplitude=identification.oscillator.amplitude
    )
    text = Reader(identification_page(replace(identification, oscillator=model)).html).text
    assert "No picture here" in text


def test_on_a_phone_a_long_head_wraps() -> None:
    narrow = re.search(r"@media \(max-width: 40rem\) \{(.*?)\n\}", Page("t", []).html, re.DOTALL)
    assert narrow is not None
    assert "thead th { white-space: normal;" in narrow.group(1)
