"""The page inside an FMU: what a vibration engineer looks for is there, its pictures show the model, text is text."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from html.parser import HTMLParser
from xml.etree import ElementTree

import numpy as np
import pytest
from dashpot.export.curves import curves, pictures, table
from dashpot.export.description import describe_fmu
from dashpot.export.documentation import documentation
from dashpot.export.facts import Facts
from dashpot.model import Oscillator, Parameter, Provenance, Range, Response
from dashpot.model.backbone import damping_curve
from dashpot.model.display import value_text
from dashpot.model.laws import LIBRARY
from dashpot.model.physical import law_strengths

SHA = "0123456789abcdef" * 4
SVG = "{http://www.w3.org/2000/svg}"
VOID = {"meta", "path", "rect"}


def page(model: Oscillator, hold: str = "The input is held.") -> str:
    return documentation(Facts(model), describe_fmu(Facts(model)), hold)


def words(text: str) -> str:
    """What a reader sees."""
    body = re.sub(r"<(style|title)\b.*?</\1>", " ", text, flags=re.DOTALL)
    return " ".join(re.sub(r"<[^>]*>", " ", body).replace("&#39;", "'").split())


@pytest.fixture
def identified(models):
    base = models["base"]().with_parameters(
        {
            "mass": Parameter(0.27, 3e-4, "kg"),
            "cubic": Parameter(4.6e5, 5.2e3, "1/(m2.s2)"),
            "viscous": Parameter(5.0, 0.01, "1/s"),
            "omega0": Parameter(79.6, 0.02, "rad/s"),
        }
    )
    recording = {"file": "sweep <high>.csv", "kind": "sweep", "sha256": SHA}
    return replace(
        base,
        amplitude=Range(2e-4, 9e-3, "m"),
        frequency=Range(5.0, 20.0, "Hz"),
        identified=Provenance(
            recordings=(recording, {"file": "decay.csv"}),
            method="maximum-likelihood",
            software="dashpot 0.1.0",
            parameters=("omega0", "cubic"),
            covariance=((4e-4, -98.8), (-98.8, 2.704e7)),
            log_likelihood=12345.678,
        ),
    )


class Balance(HTMLParser):
    """Every element that opens closes."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag, attrs):
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag


def test_everything_an_engineer_looks_for_is_there(identified):
    text = page(identified, "The force goes in a straight line.")
    Balance().feed(text)
    seen = words(text)
    for wanted in (
        "identified from 2 recordings",
        "mass [x'' + viscous x' + dry sgn(x') + omega0² x + cubic x³ + preload sgn(x)] = F(t)",
        "mass 0.27000 0.00030 0.11 % kg moving mass",
        "cubic 4.600·10⁵ 5.2·10³ 1.1 % 1/(m²·s²) cubic stiffness per unit mass",
        "(12.6687 Hz)",
        "omega0 and cubic (correlation −0.95)",
        "amplitude from 0.2 to 9 mm",
        "frequency from 5 to 20 Hz",
        "The force goes in a straight line.",
        "A pre-tensioned spring that must first be lifted off its seat",
        "Feldman and Braun 1993",
        "Method: maximum-likelihood. Software: dashpot 0.1.0. Log likelihood: 12345.68.",
        f"sweep &lt;high&gt;.csv sweep {SHA}",
        "decay.csv not known",
        "max_step s fixed parameter",
        "Shaded: amplitudes that the recordings covered",
    ):
        assert wanted in seen, wanted
    assert "No parameter has a standard error" not in seen


def test_a_model_that_states_nothing_says_so(models):
    seen = words(page(models["massless"]()))
    assert "input F too: none was given" in seen
    assert "mass unknown" in seen
    assert "The model file states no range" in seen
    assert "The model states no range of amplitudes; the one drawn is a guess." in seen
    assert "the numbers were given, not measured" in seen
    assert "deg" in seen  # radians are shown in degrees


@pytest.mark.parametrize("effect", LIBRARY)
def test_every_law_is_explained(with_law, effect):
    model = with_law(effect)
    law = model.terms[0].law
    text = page(model).replace("&#39;", "'")
    assert law.sentence in text
    assert law.source.replace("&", "&amp;") in text
    assert text.count("<svg") == 2


def test_where_a_memory_starts_is_said(with_law):
    assert "the laws with a memory start from hysteresis.deflection0" in words(page(with_law("hysteresis")))


def test_the_same_model_gives_the_same_page_which_stands_alone(identified):
    text = page(identified)
    assert text == page(identified)
    assert len(text) < 40_000
    assert "<script" not in text
    assert set(re.findall(r"https?://[^\"' <)]*", text)) == {"http://www.w3.org/2000/svg"}
    assert not re.search(r"\b(src|href)=", text)
    assert "nan" not in " ".join(re.findall(r' d="([^"]*)"', text))


@pytest.mark.parametrize(
    "nasty", ["<b>\"&'", "</style><script>alert(1)</script>", "{{ 7*7 }} {% raw %}", "a\x00\ud800b"]
)
def test_text_of_a_model_stays_text(identified, nasty):
    provenance = replace(
        identified.identified, recordings=({"file": nasty, "kind": nasty},), method=nasty, software=nasty
    )
    model = replace(identified, name=nasty, identified=provenance)
    text = page(model)
    Balance().feed(text)
    text.encode()
    assert "<script" not in text
    assert "<b>&quot;" not in text
    assert "49" not in words(text).partition("Parameters")[0]


# The curves -----------------------------------------------------------------------------------------------------------


def test_curves_are_those_of_the_closed_forms():
    """Eq. 6 for the cubic spring, Eq. 7 for viscous and dry friction (Feldman, Bucher, Rotberg 2009)."""
    values = {"mass": 0.27, "omega0": 79.6, "cubic": 4.6e5, "preload": 0.0, "viscous": 5.0, "dry": 0.015}
    model = replace(Oscillator.from_values(values), amplitude=Range(2e-4, 9e-3, "m"))
    drawn = curves(Facts(model))
    assert drawn is not None
    expected = np.sqrt(79.6**2 + 0.75 * 4.6e5 * drawn.amplitude**2) / (2 * np.pi)
    assert np.max(np.abs(drawn.frequency / expected - 1)) < 1e-9
    expected = damping_curve(5.0, 0.015, drawn.amplitude, 2 * np.pi * drawn.frequency)
    assert np.max(np.abs(drawn.damping / expected - 1)) < 1e-9
    assert drawn.amplitude[0] < drawn.low == 2e-4 < drawn.high == 9e-3 < drawn.amplitude[-1]
    head, rows = table(drawn, "m")
    assert head[0] == "Amplitude [mm]"
    assert [row[0] for row in (rows[0], rows[-1])] == ["0.2", "9"]
    ratio = 100 * drawn.damping[drawn.amplitude == 9e-3][0] / (2 * np.pi * drawn.frequency[drawn.amplitude == 9e-3][0])
    assert float(rows[-1][3]) == pytest.approx(ratio, rel=5e-3)


def test_the_picture_shows_the_numbers_and_marks_the_range(identified):
    drawn = curves(Facts(identified))
    assert drawn is not None
    backbone = ElementTree.fromstring(pictures(drawn, "m")[0])
    assert backbone.get("role") == "img"
    title = backbone.find(f"{SVG}title")
    assert title is not None
    assert backbone.get("aria-labelledby") == title.get("id")
    texts = {e.text: e for e in backbone.iter(f"{SVG}text")}
    assert {"Amplitude [mm]", "Natural frequency [Hz]"} < set(texts)
    # the axes read off their own ticks: the curve's ends are where the numbers say
    at = {float(t): e for t, e in texts.items() if t and re.fullmatch(r"[\d.]+", t)}
    across = sorted((math.log(v), float(e.get("x") or 0)) for v, e in at.items() if e.get("text-anchor") == "middle")
    up = sorted((v, float(e.get("y") or 0) - 4) for v, e in at.items() if e.get("text-anchor") == "end")
    full = next(e.get("d") or "" for e in backbone.iter(f"{SVG}path") if e.get("stroke-width") == "2.5")
    points = np.array([pair.split() for pair in re.split("[ML]", full)[1:]], float)
    amplitude = np.exp(np.interp(points[:, 0], [x for _, x in across], [v for v, _ in across], left=np.nan))
    frequency = np.interp(-points[:, 1], [-y for _, y in up], [v for v, _ in up])
    there = np.isfinite(amplitude)
    expected = np.interp(amplitude[there] * 1e-3, drawn.amplitude, drawn.frequency)
    inside = (expected > up[0][0]) & (expected < up[-1][0])
    assert np.count_nonzero(inside) > 20
    assert np.max(np.abs(frequency[there][inside] - expected[inside])) < 0.02
    (band,) = backbone.iter(f"{SVG}rect")
    assert float(band.get("x") or 0) == pytest.approx(points[0, 0], abs=0.11)
    width = float(band.get("width") or 0)
    assert float(band.get("x") or 0) + width == pytest.approx(points[-1, 0], abs=0.21)


@pytest.mark.parametrize(
    "changed",
    [
        {"cubic": -4.6e7, "preload": 0.0},  # lets go within the range
        {"viscous": 0.0, "dry": 0.0, "cubic": 0.0, "preload": 0.0},  # two flat lines
        {"viscous": -1.0, "dry": 0.0},
        {"preload": -0.5},
        {"omega0": 1e-6, "cubic": 0.0, "preload": 0.0},
        {"omega0": 1e9, "cubic": 0.0},
        {"cubic": 1e300},
        {"cubic": -1e300},
    ],
)
def test_odd_models_have_sound_pictures_or_none(models, changed):
    model = models["base"]()
    model = model.with_parameters({n: replace(model.parameters()[n], value=v) for n, v in changed.items()})
    for valid in (None, Range(0.0, 9e-3, "m"), Range(9e-3, 9e-3, "m"), Range(1e-12, 1e3, "m"), Range(0.0, 0.0, "m")):
        ranged = replace(model, amplitude=valid)
        text = page(ranged)
        assert "nan" not in " ".join(re.findall(r' d="([^"]*)"', text))
        for svg in re.findall(r"<svg.*?</svg>", text, re.DOTALL):
            ElementTree.fromstring(svg)
            assert len(svg) < 12_000
        assert ("<svg" in text) or "No periodic motion" in text
    assert curves(Facts(replace(model, amplitude=Range(0.0, 0.0, "m")))) is None


def test_a_recorded_velocity_has_its_curves_over_the_displacement(models):
    model = replace(models["velocity"](), amplitude=Range(2e-4, 9e-3, "m"))
    assert model.response == Response("velocity", "m/s")
    assert "Amplitude [mm]" in page(model)


def test_friction_and_drag_stand_there_in_the_machine_s_units(models):
    model = models["drag"]().with_parameters(
        {"mass": Parameter(0.27, 3e-4, "kg"), "dry": Parameter(0.15, 0.01, "m/s2")}
    )
    said = words(page(model))
    assert "As the machine has it" in said
    # the errors of mass and friction, 0.11 and 6.7 %
    assert "friction 0.0405 0.0027 6.7 % N dry friction: mass dry" in said
    strength = law_strengths(model)["quadratic-drag.coefficient"]
    assert f"quadratic-drag.coefficient {value_text(strength)[0]} " in said.partition("As the machine has it")[2]
    assert "N·s²/m² quadratic drag" in said
