"""The page of a diagnosis: every verdict and every gap in the numbers comes out, escaped and small."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser

import numpy as np
import pytest
from dashpot.diagnose.result import ChainFact, Considered
from dashpot.model.laws import LIBRARY
from dashpot.model.oscillator import Provenance, Term
from dashpot.report.blocks import Page
from dashpot.report.diagnosis_page import diagnosis_page
from dashpot.report.diagnosis_text import describe
from dashpot.report.effects import by_rank, considered_section, effects_section, shifts
from dashpot.report.location import location_section
from dashpot.report.mended_curves import curves_section
from dashpot.report.missing_force import force_section

NASTY = "\"; // <script>alert(1)</script> $x^{2 & 'ü' \x00\ud800\x1b[31m {{ 7*7 }} @import url(http://x)"


class Reader(HTMLParser):
    """Keeps tags, attributes and text, and fails where tags do not close in order."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str]] = []
        self.words: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_startendtag(tag, attrs)
        if tag != "meta":
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += [(name, value or "") for name, value in attrs]
        self.words += [value for name, value in attrs if name == "aria-label" and value]  # it is read out

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open[-1:] not in (["style"], ["script"]):
            self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


def stands_alone(whole: str) -> Reader:
    """The page's text, after making sure that it is well-formed and that nothing in it points elsewhere."""
    reader = Reader(whole)
    assert not {"link", "iframe", "object", "embed", "img"} & set(reader.tags)
    for name, value in reader.attributes:
        assert name not in ("src", "action", "data")
        assert not name.startswith("on")
        if name in ("href", "xlink:href"):
            assert value.startswith("#")
        if name not in ("aria-label", "data-chart"):
            assert "http" not in value
    style = re.search(r"<style>.*?</style>", whole, re.DOTALL)
    assert style
    assert "@import" not in style.group()
    assert "url(" not in style.group()
    ids = [value for name, value in reader.attributes if name == "id"]
    assert len(ids) == len(set(ids))
    for data in re.findall(r'<script type="application/json" id="charts">(.*?)</script>', whole):
        json.loads(data, parse_constant=lambda odd: pytest.fail(f"{odd} among the data"))
    return reader


@pytest.fixture(scope="module")
def page_of(hand_made):
    """``page_of("consistent")``: the page of a verdict, drawn once."""
    return cache(
        lambda verdict: diagnosis_page(hand_made.verdicts[verdict](), files=("model.yaml", "diagnosis.json")).html
    )


@pytest.fixture(scope="module")
def whole_text(page_of) -> str:
    """What the page of a named effect says."""
    return stands_alone(page_of("missing-physics")).text


SAID = {
    "missing-physics": (
        "◆ Missing physics.",
        "use the mended model (model.yaml)",
        "look for drag that grows with the square of the speed (quadratic-drag).",
    ),
    "consistent": ("✓ Consistent.", "use the model as it is", "Nowhere: nothing is left", "no parameter has moved"),
    "unexplained": ("▲ Unexplained.", "do not rely on the model", "Ten times the noise is left in multisine.csv."),
}
ORDER = (
    "Measured, before and after",
    "Where the given model fails",
    "The missing force",
    "What is missing",
    "What was considered, and why not",
    "How the missing physics had bent the old parameters",
    "Backbone and damping curve",
    "The next experiment",
    "What remains, and what to know",
    "The measuring chain, which is no physics of the rig",
    "Where the numbers come from",
)


@pytest.mark.parametrize("verdict", SAID)
def test_every_verdict_has_its_page_in_order(verdict, page_of) -> None:
    whole = page_of(verdict)
    text = stands_alone(whole).text
    for words in SAID[verdict]:
        assert words in text
    first = ORDER[0] if verdict == "missing-physics" else "Measured and simulated"
    titles = re.findall(r"<h2>(.*?)</h2>", whole)
    seen = [title for title in titles if title != "The other recordings, in pictures"]
    assert tuple(seen) == (first, *ORDER[1:])
    # verdict, share, what is left (where the verdict does not say it) and what to do stand ahead of everything else
    head, rest = whole.split("<h2>", 1)
    assert head.index(SAID[verdict][0]) < head.index("What to do next:")
    told = verdict == "missing-physics"
    assert ("What is left:" in head, "What is left:" in rest) == (not told, told)
    assert text.index(SAID[verdict][0]) < text.index("What to do next:") < text.index(first)
    assert "diagnosis.json" in text
    assert "ab" * 32 in text or verdict != "missing-physics"


def test_the_page_says_what_is_missing_and_what_it_cannot_be_told_from(whole_text) -> None:
    law = LIBRARY["quadratic-drag"]
    text = whole_text
    for words in (law.sentence, law.curves, law.source, "cubic-damping", "a record at three times the amplitude."):
        assert " ".join(words.split()) in text
    for title in ("measured and simulated response", "missing force per unit mass", "Force to play in N"):
        assert title in text
    assert text.index("multisine.csv (held out)") < text.index("sweep.csv: measured and simulated")
    assert "quadratic-drag cubic-damping 12" in text  # pairs of the next experiment, the best separated first
    assert text.index("quadratic-drag cubic-damping 12") < text.index("quadratic-drag stribeck 4")


def test_what_was_recorded_is_said_of_all_recordings(hand_made) -> None:
    """The missing force is shown of one recording; the largest motion may be in another, or held out."""
    diagnosis = hand_made.missing()
    quiet = replace(diagnosis.latent[0], displacement=1e-6 * np.ones(3), velocity=1e-5 * np.ones(3))
    loud = hand_made.record("loud.csv", holdout=True, size=9e-3)
    text = stands_alone(Page("Where", [location_section(replace(diagnosis, latent=(quiet,)))]).html).text
    assert re.search(r"Velocity −0\.3\d* 0\.3\d* −0\.4\d* 0\.4\d* m/s", text)  # 5 mm at 12 Hz
    text = stands_alone(
        Page("Where", [location_section(replace(diagnosis, records=(*diagnosis.records, loud)))]).html
    ).text
    assert re.search(r"Velocity −0\.3\d* 0\.3\d* −0\.7\d* 0\.7\d* m/s", text)  # 9 mm
    assert re.search(r"Displacement −5\S* 5\S* −9\.\d* 9\.\d* mm", text)


def test_a_place_that_cannot_be_told_is_said_in_words(hand_made) -> None:
    diagnosis = hand_made.missing()
    assert diagnosis.location is not None
    for path, words in (
        ("unknown", "does not show where in the rig"),
        ("restoring", "It lies in the spring (path: restoring)."),
    ):
        place = replace(diagnosis.location, path=path)
        said = stands_alone(Page("Where", [location_section(replace(diagnosis, location=place))]).html).text
        assert words in said
        assert "(path: unknown)" not in said


def test_the_same_diagnosis_gives_the_same_page(hand_made) -> None:
    diagnosis = replace(hand_made.missing(), records=hand_made.missing().records[1:2])
    assert diagnosis_page(diagnosis).html == diagnosis_page(diagnosis).html


def test_considered_laws_are_sorted_and_those_without_numbers_last(hand_made, whole_text) -> None:
    diagnosis = hand_made.missing()
    assert [law.effect for law in by_rank(diagnosis)] == ["cubic-damping", "hysteresis", "stribeck", "viscoelastic"]
    text = whole_text
    assert text.index("as good, but not better") < text.index("leaves nine times the noise") < text.index("not run")


def test_bent_parameters_are_counted_in_standard_errors(hand_made, whole_text) -> None:
    shift = {s.name: s for s in shifts(hand_made.missing())}["viscous"]
    assert shift.errors == pytest.approx((4.5 - 5.0) / 4.5e-3)
    assert shift.percent == pytest.approx(-10.0)
    assert shift.bent
    assert not any(s.bent for s in shifts(hand_made.missing()) if s.name != "viscous")
    text = whole_text
    assert "viscous had been bent most, by 111 standard errors" in text
    assert "5.0000 4.5000" not in text  # as many digits as the error carries
    assert re.search(r"viscous 5 4\.5000 0\.0045 −111 −10 %", text)


def test_laws_that_were_not_run_for_one_reason_stand_together(hand_made) -> None:
    many = tuple(Considered(name, None, 0.0, "nothing asks for it") for name in ("one", "two", "three", "four"))
    diagnosis = replace(hand_made.missing(), considered=(*many, Considered("five", 0.2, -3.0, "nothing asks for it")))
    text = stands_alone(Page("Considered", [considered_section(diagnosis)]).html).text
    assert "Not run, as nothing asks for it: one, two, three, four." in text
    assert "five 0.2 −3.0 nothing asks for it" in text


def test_a_force_within_its_uncertainty_has_no_picture(hand_made) -> None:
    diagnosis = hand_made.missing()
    loud = diagnosis.latent[0]
    quiet = replace(loud, file="quiet.csv", std=np.full(loud.force.size, 1e3))
    text = stands_alone(Page("Force", [force_section(replace(diagnosis, latent=(quiet, loud)))]).html).text
    assert "In quiet.csv it does not rise above its uncertainty." in text
    assert "sweep.csv: missing force per unit mass" in text
    assert "quiet.csv: missing force" not in text
    alone = stands_alone(Page("Force", [force_section(replace(diagnosis, latent=(quiet,)))]).html).text
    assert "quiet.csv: missing force per unit mass" in alone


@pytest.mark.parametrize("law", LIBRARY)
def test_every_law_of_the_library_has_its_card(law, hand_made) -> None:
    text = stands_alone(Page("Card", [effects_section(hand_made.missing(law))]).html).text
    assert " ".join(LIBRARY[law].sentence.split()) in text
    assert f"{LIBRARY[law].phrase[1:]} ({law})" in text  # the card's title, its first letter large
    for p in LIBRARY[law].parameters:
        assert p.description in text


def test_free_decays_only_and_other_units(hand_made) -> None:
    diagnosis = hand_made.missing(before=hand_made.given("displacement", "rad", mass=False))
    diagnosis = replace(diagnosis, experiment=replace(diagnosis.experiment, kind="decay", level=0.2, signal=None))
    text = stands_alone(diagnosis_page(diagnosis).html).text
    assert "force: none recorded" in text
    assert "[deg]" in {word for chart in diagnosis_page(diagnosis).charts for word in chart.panels[0].y.label.split()}
    assert "Release from 11.5 deg" in text
    assert "= f(t)" in text
    for quantity, unit, shown in (("acceleration", "m/s2", "[mm/s²]"), ("displacement", "V", "[mV]")):
        diagnosis = hand_made.missing("softening-stiffness/sine", hand_made.given(quantity, unit))
        diagnosis = replace(diagnosis, records=diagnosis.records[2:])
        stands_alone(diagnosis_page(diagnosis).html)
        labels = {panel.y.label for chart in diagnosis_page(diagnosis).charts for panel in chart.panels}
        assert f"{quantity.capitalize()} {shown}" in labels


def test_the_measuring_chain_is_said_under_its_own_heading(hand_made) -> None:
    plain = hand_made.missing()
    fact = ChainFact("offset", "sweep.csv", 2.5e-2, "m", "sweep.csv: its sensor shows 25 mm at zero; taken off")
    told = replace(plain, chain=(fact,))
    assert "its sensor shows 25 mm at zero" in stands_alone(diagnosis_page(told).html).text
    assert "The measuring chain" in describe(told)
    assert "The measuring chain" not in describe(plain)
    assert told.as_json()["chain"] == [
        {"what": "offset", "file": "sweep.csv", "value": 2.5e-2, "unit": "m", "sentence": fact.sentence}
    ]


def test_numbers_that_are_not_known_are_said_to_be(hand_made) -> None:
    text = stands_alone(diagnosis_page(hand_made.nothing_known()).html).text
    assert "unknown" in text
    assert "A law of your own, my-own-law." in text
    assert "nan" not in text.replace("resonan", "")
    said = describe(hand_made.nothing_known())
    assert "unknown" in said
    assert "nan" not in said


def test_no_experiment_and_no_remainder_claim_nothing_that_is_open(hand_made) -> None:
    diagnosis = hand_made.verdicts["unexplained"]()
    some = {"latent": (), "experiment": None, "remainder": None}
    text = stands_alone(diagnosis_page(replace(diagnosis, records=diagnosis.records[1:2], **some)).html).text
    assert "None was worked out." in text
    assert "stays unexplained" in text
    assert "Nothing stays beyond the noise" not in text
    diagnosis = hand_made.missing()
    text = stands_alone(diagnosis_page(replace(diagnosis, records=diagnosis.records[1:2], **some)).html).text
    assert "record what would tell before you rely on the name." in text
    assert "None was worked out." in text
    assert "decay.csv: the old model leaves 21 % of the motion" in text
    assert "the new one 2.1 % of the motion" in text


def test_a_diagnosis_of_nothing_comes_out(hand_made) -> None:
    model = hand_made.given()
    empty = replace(hand_made.verdicts["consistent"](), records=(), considered=(), model=model, before=model)
    text = stands_alone(diagnosis_page(empty).html).text
    assert "No recording was compared." in text
    assert "No other law was tried." in text
    assert describe(empty).startswith("✓ Consistent.")


@pytest.mark.long
def test_long_and_many_recordings_keep_the_page_small(hand_made) -> None:
    diagnosis = hand_made.missing()
    long = [hand_made.record(f"long-{i}.csv", seconds=1000.0, holdout=i == 0) for i in range(2)]
    short = [hand_made.record(f"short-{i}.csv", holdout=i < 6) for i in range(10)]
    diagnosis = replace(diagnosis, records=(*long, *short), latent=(hand_made.latent(long[0]),) * 4)
    whole = diagnosis_page(diagnosis).html
    assert len(whole) < 1_500_000
    text = stands_alone(whole).text
    assert "Without a picture, in the table only:" in text
    assert all(r.file in text for r in diagnosis.records)


def test_whatever_is_said_is_escaped(hand_made) -> None:
    diagnosis = hand_made.missing()
    effect = replace(diagnosis.effects[0], indistinguishable_from=(NASTY,), separated_by=NASTY, path=NASTY)
    place = replace(diagnosis.location, statement=NASTY, path=NASTY, recordings=(NASTY,))
    provenance = Provenance(({"file": NASTY, "kind": NASTY, "sha256": None},), NASTY, NASTY)
    diagnosis = replace(
        diagnosis,
        sentence=NASTY,
        effects=(effect,),
        location=place,
        before=replace(diagnosis.before, name=NASTY),
        model=replace(diagnosis.model, name=NASTY, identified=provenance),
        records=tuple(replace(r, file=f"{i}{NASTY}") for i, r in enumerate(diagnosis.records)),
        considered=(Considered(NASTY, 0.1, 1.0, NASTY),),
        experiment=replace(diagnosis.experiment, sentence=NASTY, separates=((NASTY, NASTY, 3.0),)),
        remainder=NASTY,
        latent=(replace(diagnosis.latent[0], file=NASTY),),
        notes=(NASTY,),
    )
    whole = diagnosis_page(diagnosis, files=(NASTY + ".yaml",)).html
    assert whole.encode("utf-8")
    assert "\x00" not in whole
    reader = stands_alone(whole)
    assert "<script>alert(1)</script>" in reader.text
    assert "{{ 7*7 }}" in reader.text
    assert "\x1b" not in describe(diagnosis)
    assert "\x00" not in describe(diagnosis)


def test_a_term_of_a_variant_is_drawn_with_its_backbone(hand_made) -> None:
    diagnosis = hand_made.missing("softening-stiffness/sine")
    assert isinstance(diagnosis.model.terms[0], Term)
    text = stands_alone(Page("Curves", [curves_section(diagnosis)]).html).text
    assert "Natural frequency in Hz and damping in 1/s" in text
    assert "nothing shows here" not in text
    for law in ("sensor-lag", "stiffness-drift/settling"):
        lag = stands_alone(Page("Curves", [curves_section(hand_made.missing(law))]).html).text
        assert f"({law}) nothing shows here" in lag
    memory = stands_alone(Page("Curves", [curves_section(hand_made.missing("viscoelastic"))]).html).text
    assert "Damping curve" in memory
