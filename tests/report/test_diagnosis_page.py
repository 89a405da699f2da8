"""The diagnosis as page and as text: every verdict and every gap in the numbers comes out, escaped and small."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser

import numpy as np
import pytest
from dashpot.diagnose.result import (
    Considered,
    Diagnosis,
    Effect,
    Experiment,
    LatentForce,
    Location,
    RecordFit,
)
from dashpot.model import Oscillator, Parameter, Response
from dashpot.model.laws import LIBRARY
from dashpot.model.oscillator import Provenance, Range, Term
from dashpot.report.blocks import page
from dashpot.report.diagnosis_page import diagnosis_page
from dashpot.report.diagnosis_text import describe
from dashpot.report.effects import by_rank, effects_section, shifts
from dashpot.report.mended_curves import curves_section

FS = 400.0
OMEGA = 2 * math.pi * 12.0
GIVEN = {"mass": 0.3, "omega0": OMEGA, "viscous": 5.0, "dry": 0.02, "cubic": 4e5, "preload": 0.05}
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

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open[-1:] != ["style"]:
            self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


def stands_alone(whole: str) -> Reader:
    """The page's text, after making sure that it is well-formed and that nothing in it points elsewhere."""
    reader = Reader(whole)
    assert not {"script", "link", "iframe", "object", "embed", "img"} & set(reader.tags)
    for name, value in reader.attributes:
        assert name not in ("src", "action", "data")
        assert not name.startswith("on")
        if name in ("href", "xlink:href"):
            assert value.startswith("#")
        if not name.startswith("xmlns"):
            assert "http" not in value
    style = re.search(r"<style>.*?</style>", whole, re.DOTALL)
    assert style
    assert "@import" not in style.group()
    assert "url(" not in style.group()
    ids = [value for name, value in reader.attributes if name == "id"]
    assert len(ids) == len(set(ids))
    paths = " ".join(value for name, value in reader.attributes if name == "d")
    assert "nan" not in paths.lower()
    assert "inf" not in paths.lower()
    return reader


def record(file: str, *, holdout: bool = False, seconds: float = 20.0, forced: bool = True, size: float = 5e-3):
    """A swell of a sine; the model before is a fifth too large in its middle, the one after right to the noise."""
    t = np.arange(int(seconds * FS)) / FS
    swell = np.exp(-(((t - seconds / 2) / (seconds / 6)) ** 2)) if forced else np.exp(-t / (seconds / 6))
    true = size * swell * np.cos(OMEGA * t)
    noise = 0.01 * size * np.random.default_rng(3).standard_normal(t.size)
    force = np.cos(OMEGA * t) if forced else None
    return RecordFit(file, holdout, 0.21, 0.021, 0.0204, t, true + noise, true * (1 + 0.2 * swell), true, force)


def sure(model: Oscillator, share: float = 1e-3) -> Oscillator:
    """The same oscillator with standard errors."""
    errors = {n: Parameter(p.value, share * abs(p.value), p.unit) for n, p in model.parameters().items()}
    return model.with_parameters(errors)


def mended(before: Oscillator, law: str) -> Oscillator:
    """``before`` with a law of the library, with plain numbers, and a better viscous damping."""
    numbers = {p.name: min(max(0.5 if p.unit != "X" else 2e-3, p.lower), p.upper) for p in LIBRARY[law].parameters}
    values = {k: v for k, v in before.values().items() if "." not in k} | {f"{law}.{k}": v for k, v in numbers.items()}
    values["viscous"] *= 0.9
    found = Oscillator.from_values(
        values, name=before.name, response=before.response, force_unit=before.force_unit, effects=(law,)
    )
    return replace(
        sure(found),
        amplitude=before.amplitude,
        frequency=before.frequency,
        identified=Provenance(({"file": "sweep.csv", "kind": "sweep", "sha256": "ab" * 32},), "ml", "dashpot 0.1.0"),
    )


def given(quantity: str = "displacement", unit: str = "m", *, mass: bool = True) -> Oscillator:
    """The model that was given, in any unit."""
    values = GIVEN if mass else {k: v for k, v in GIVEN.items() if k != "mass"}
    model = Oscillator.from_values(values, name="bench", response=Response(quantity, unit))
    inner = model.response.displacement_unit
    return replace(sure(model), amplitude=Range(2e-4, 6e-3, inner), frequency=Range(8, 16, "Hz"))


def latent(one: RecordFit) -> LatentForce:
    """A force of the speed, with some scatter."""
    v = np.gradient(one.measured, one.time)
    force = 2 * v * np.abs(v)
    off = 0.02 * np.sin(np.arange(v.size))
    return LatentForce(one.file, one.time, one.measured, v, force + off, np.full(v.size, 0.02), force)


def missing(law: str = "quadratic-drag", before: Oscillator | None = None) -> Diagnosis:
    """A diagnosis that named an effect."""
    before = before or given()
    forced = before.mass is not None
    model = mended(before, law)
    records = (
        record("sweep.csv", forced=forced),
        record("decay.csv", forced=False, seconds=6.0),
        record("multisine.csv", holdout=True, forced=forced),
    )
    effect = Effect(
        LIBRARY[law].effect,
        law,
        LIBRARY[law].path,
        model.terms[0].parameters,
        ("cubic-damping",),
        "a record at three times the amplitude",
    )
    place = Location(
        "dissipation",
        "Too little damping above 4 mm",
        (-5e-3, 5e-3),
        (-0.3, 0.3),
        (4e-3, 6e-3),
        (11.0, 13.0),
        (8.0, 12.0),
        ("sweep.csv",),
        {1: 0.9, 3: 0.1},
    )
    considered = (
        Considered("stribeck", None, 3.25, "not supported"),
        Considered("hysteresis", 0.19, -12.0, "leaves nine times the noise"),
        Considered("cubic-damping", 0.022, -900.0, "as good, but not better"),
        Considered("viscoelastic", math.nan, math.nan, "its fit did not come to rest"),
    )
    t = np.arange(4000) / FS
    plan = Experiment(
        "Play a sweep from 8 to 16 Hz at 2.5 N",
        "sweep",
        2.5,
        (8.0, 16.0),
        10.0,
        (("quadratic-drag", "stribeck", 4.0), ("quadratic-drag", "cubic-damping", 12.0)),
        2.5 * np.sin(2 * math.pi * (8 * t + 0.4 * t**2)),
        FS,
    )
    return Diagnosis(
        "missing-physics",
        "The damping lacks a force that grows with the square of the speed",
        (effect,),
        place,
        before,
        model,
        records,
        considered,
        plan,
        None,
        (latent(records[0]),),
        ("A gap of one sample was closed",),
    )


def consistent() -> Diagnosis:
    """Nothing is missing: no effect, no place, no force, no plan."""
    found = missing()
    records = tuple(replace(r, before=r.after, nrmse_before=r.nrmse_after) for r in found.records)
    return replace(
        found,
        verdict="consistent",
        sentence="The model explains the recordings to their noise",
        effects=(),
        location=None,
        model=found.before,
        records=records,
        experiment=None,
        latent=(),
        notes=(),
    )


def unexplained() -> Diagnosis:
    """Something is missing, and no law of the library is it."""
    found = missing()
    records = tuple(replace(r, after=r.before, nrmse_after=r.nrmse_before) for r in found.records)
    return replace(
        found,
        verdict="unexplained",
        sentence="No law of the library explains what is left",
        effects=(),
        model=found.before,
        records=records,
        remainder="Ten times the noise is left in multisine.csv",
        latent=(replace(found.latent[0], named=None),),
    )


@cache
def shown_text() -> str:
    """What the page of ``missing()`` says."""
    return stands_alone(diagnosis_page(missing(), files=("model.yaml", "diagnosis.json"))).text


VERDICTS: dict[str, Callable[[], Diagnosis]] = {
    "missing-physics": missing,
    "consistent": consistent,
    "unexplained": unexplained,
}
SAID = {
    "missing-physics": (
        "◆ Missing physics.",
        "use the mended model (model.yaml)",
        "look for quadratic-drag in the rig",
    ),
    "consistent": ("✓ Consistent.", "use the model as it is", "Nowhere beyond the noise", "no parameter has moved"),
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
    "Where the numbers come from",
)


@pytest.mark.parametrize("verdict", VERDICTS)
def test_every_verdict_has_its_page_in_order(verdict) -> None:
    found = VERDICTS[verdict]()
    whole = diagnosis_page(found, files=("model.yaml", "diagnosis.json"))
    text = stands_alone(whole).text
    for words in SAID[verdict]:
        assert words in text
    first = ORDER[0] if verdict == "missing-physics" else "Measured and simulated"
    titles = re.findall(r"<h2>(.*?)</h2>", whole)
    assert tuple(titles) == (first, *ORDER[1:])
    assert text.index(SAID[verdict][0]) < text.index("What to do next:") < text.index(first)
    assert "diagnosis.json" in text
    assert "ab" * 32 in text or verdict != "missing-physics"


def test_the_page_says_what_is_missing_and_what_it_cannot_be_told_from() -> None:
    law = LIBRARY["quadratic-drag"]
    text = shown_text()
    for words in (law.sentence, law.curves, law.source, "cubic-damping", "a record at three times the amplitude."):
        assert " ".join(words.split()) in text
    for title in ("measured and simulated response", "missing force per unit mass", "Force to play in N"):
        assert title in text
    assert text.index("multisine.csv (held out)") < text.index("sweep.csv: measured and simulated")
    assert "quadratic-drag cubic-damping 12" in text  # pairs of the next experiment, the best separated first
    assert text.index("quadratic-drag cubic-damping 12") < text.index("quadratic-drag stribeck 4")


def test_the_same_diagnosis_gives_the_same_page() -> None:
    found = replace(missing(), records=missing().records[1:2])
    assert diagnosis_page(found) == diagnosis_page(found)


def test_considered_laws_are_sorted_and_those_without_numbers_last() -> None:
    found = missing()
    assert [one.effect for one in by_rank(found)] == ["cubic-damping", "hysteresis", "stribeck", "viscoelastic"]
    text = shown_text()
    assert text.index("as good, but not better") < text.index("leaves nine times the noise") < text.index("not run")


def test_bent_parameters_are_counted_in_standard_errors() -> None:
    one = {s.name: s for s in shifts(missing())}["viscous"]
    assert one.errors == pytest.approx((5.0 - 4.5) / 4.5e-3)
    assert one.percent == pytest.approx(100 * 0.5 / 4.5)
    assert one.bent
    assert not any(s.bent for s in shifts(missing()) if s.name != "viscous")
    text = shown_text()
    assert "viscous had been bent most, by 111 standard errors" in text
    assert "5.0000 4.5000" not in text  # as many digits as the error carries
    assert re.search(r"viscous 5 4\.5000 0\.0045 \+111 \+11 %", text)


@pytest.mark.parametrize("law", LIBRARY)
def test_every_law_of_the_library_has_its_card(law) -> None:
    text = stands_alone(page("Card", [effects_section(missing(law))])).text
    assert " ".join(LIBRARY[law].sentence.split()) in text
    assert law in text
    for p in LIBRARY[law].parameters:
        assert p.description in text


def test_free_decays_only_and_other_units() -> None:
    found = missing(before=given("displacement", "rad", mass=False))
    found = replace(found, experiment=replace(found.experiment, kind="decay", level=0.2, signal=None))
    text = stands_alone(diagnosis_page(found)).text
    assert "force: none recorded" in text
    assert "[deg]" in text
    assert "Release from 11.5 deg" in text
    assert "= f(t)" in text
    for quantity, unit, shown in (("acceleration", "m/s2", "[mm/s²]"), ("displacement", "V", "[mV]")):
        found = missing("softening-stiffness/sine", given(quantity, unit))
        found = replace(found, records=found.records[2:])
        text = stands_alone(diagnosis_page(found)).text
        assert f"{quantity.capitalize()} {shown}" in text


def nothing_known() -> Diagnosis:
    """Numbers that are not there wherever one can be missing."""
    found = missing()
    lost = found.records[0].before.copy()
    lost[500:] = np.nan
    gone = replace(found.records[0], before=lost, nrmse_before=math.nan, noise_floor=math.nan)
    wild = replace(found.records[1], before=found.records[1].before * 1e200, nrmse_before=math.inf, noise_floor=0.0)
    empty = replace(found.records[2], before=np.full(lost.size, np.nan), after=np.full(lost.size, np.nan))
    none = (math.nan, math.nan)
    place = Location("odd", "", none, none, (0.0, 0.0), none, none, (), {})
    poor = {
        name: Parameter(p.value, None if name == "dry" else math.nan, p.unit)
        for name, p in found.model.parameters().items()
    }
    poor["cubic"] = Parameter(math.nan, 1.0, poor["cubic"].unit)
    poor["preload"] = Parameter(0.0, 0.0, poor["preload"].unit)
    unknown = {"strength": Parameter(math.nan, None, "1"), "other": Parameter(1.0, math.inf, "1")}
    effect = replace(found.effects[0], law="my-own-law", effect="my-own-law", parameters=unknown)
    force = replace(found.latent[0], std=np.full(lost.size, np.nan), named=np.full(lost.size, np.nan))
    silent = replace(found.latent[0], force=np.full(lost.size, np.nan))
    plan = Experiment("", "multisine", math.nan, none, math.nan, (("a", "b", math.nan),), np.zeros(100), math.nan)
    return replace(
        found,
        effects=(effect,),
        location=place,
        model=replace(
            found.before.with_parameters({k: v for k, v in poor.items() if "." not in k}),
            amplitude=None,
            frequency=None,
        ),
        before=replace(found.before, amplitude=None),
        records=(gone, wild, empty),
        latent=(force, silent),
        experiment=plan,
        remainder="",
    )


def test_numbers_that_are_not_known_are_said_to_be() -> None:
    text = stands_alone(diagnosis_page(nothing_known())).text
    assert "unknown" in text
    assert "A law of your own, my-own-law." in text
    assert "nan" not in text.replace("resonan", "")
    said = describe(nothing_known())
    assert "unknown" in said
    assert "nan" not in said


def test_a_diagnosis_of_nothing_comes_out() -> None:
    empty = replace(consistent(), records=(), considered=(), model=given(), before=given())
    text = stands_alone(diagnosis_page(empty)).text
    assert "No recording was compared." in text
    assert "No other law was tried." in text
    assert describe(empty).startswith("✓ Consistent.")


def test_long_and_many_recordings_keep_the_page_small() -> None:
    found = missing()
    long = [record(f"long-{i}.csv", seconds=1000.0, holdout=i == 0) for i in range(2)]
    short = [record(f"short-{i}.csv", holdout=i < 6) for i in range(10)]
    found = replace(found, records=(*long, *short), latent=(latent(long[0]),) * 4)
    whole = diagnosis_page(found)
    assert len(whole) < 1_500_000
    text = stands_alone(whole).text
    assert "Without a picture, in the table only:" in text
    assert all(r.file in text for r in found.records)


def test_whatever_is_said_is_escaped() -> None:
    found = missing()
    effect = replace(found.effects[0], indistinguishable_from=(NASTY,), separated_by=NASTY, path=NASTY)
    place = replace(found.location, statement=NASTY, path=NASTY, recordings=(NASTY,))
    provenance = Provenance(({"file": NASTY, "kind": NASTY, "sha256": None},), NASTY, NASTY)
    found = replace(
        found,
        sentence=NASTY,
        effects=(effect,),
        location=place,
        before=replace(found.before, name=NASTY),
        model=replace(found.model, name=NASTY, identified=provenance),
        records=tuple(replace(r, file=f"{i}{NASTY}") for i, r in enumerate(found.records)),
        considered=(Considered(NASTY, 0.1, 1.0, NASTY),),
        experiment=replace(found.experiment, sentence=NASTY, separates=((NASTY, NASTY, 3.0),)),
        remainder=NASTY,
        latent=(replace(found.latent[0], file=NASTY),),
        notes=(NASTY,),
    )
    whole = diagnosis_page(found, files=(NASTY + ".yaml",))
    assert whole.encode("utf-8")
    assert "\x00" not in whole
    reader = stands_alone(whole)
    assert "<script>alert(1)</script>" in reader.text
    assert "{{ 7*7 }}" in reader.text
    assert "\x1b" not in describe(found)
    assert "\x00" not in describe(found)


@pytest.mark.parametrize("verdict", VERDICTS)
def test_the_text_holds_what_it_must(verdict) -> None:
    found = VERDICTS[verdict]()
    text = describe(found)
    assert len(text.splitlines()) <= 40
    assert max(len(line) for line in text.splitlines()) <= 100
    assert text.startswith(SAID[verdict][0])
    for r in found.records:
        assert re.search(rf"{r.file} .*0\.021.*0\.0204", text) or verdict == "unexplained"
    assert re.search(r"multisine\.csv .* held out", text)
    if verdict == "missing-physics":
        assert "coefficient  0.50000 ± 0.00050 1/m" in text
        assert "Not told from cubic-damping; it would take a record at three times the amplitude." in text
        assert "viscous  5 → 4.5000 ± 0.0045 1/s  (by 111 standard errors, 11 %)" in text
        assert "dry " not in text
        assert "A gap of one sample was closed." in text
    if verdict != "consistent":
        assert "Too little damping above 4 mm." in text
        assert "Play a sweep from 8 to 16 Hz at 2.5 N." in text
    if verdict == "unexplained":
        assert "Remains: Ten times the noise is left in multisine.csv." in text


def test_the_text_stays_short_however_much_there_is_to_say() -> None:
    found = missing()
    words = "something of great length that goes on and on " * 20
    effect = replace(found.effects[0], separated_by=words)
    records = tuple(replace(found.records[i % 3], file=f"{i}-{'x' * 80}.csv") for i in range(30))
    found = replace(
        found,
        sentence=words,
        effects=(effect,) * 6,
        location=replace(found.location, statement=words),
        records=records,
        experiment=replace(found.experiment, sentence=words),
        remainder=words,
        notes=tuple(f"{i} {words}" for i in range(9)),
    )
    lines = describe(found).splitlines()
    assert len(lines) <= 55
    assert max(len(line) for line in lines) <= 100


def test_a_term_of_a_variant_is_drawn_with_its_backbone() -> None:
    found = missing("softening-stiffness/sine")
    assert isinstance(found.model.terms[0], Term)
    text = stands_alone(page("Curves", [curves_section(found)])).text
    assert "Natural frequency in Hz and damping in 1/s" in text
    assert "nothing shows here" not in text
    for law in ("sensor-lag", "stiffness-drift/settling"):
        lag = stands_alone(page("Curves", [curves_section(missing(law))])).text
        assert f"Of {law.partition('/')[0]} nothing shows here" in lag
    memory = stands_alone(page("Curves", [curves_section(missing("viscoelastic"))])).text
    assert "Damping curve" in memory
