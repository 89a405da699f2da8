"""The pages of laws: every law has one, and what they tell of it is true."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from dashpot.model.describing import natural_motion
from dashpot.model.laws import BASE, LIBRARY, PRESCRIBED
from dashpot.report.law_figure import FORCE, LENGTH, OMEGA, RIG, example, fundamental, harmonics, law_figure
from dashpot.report.law_page import PLACES, law_page, laws, library_table, page_name
from dashpot.report.matplotlib_figure import drawn

RIG_LAWS = {law.name: law for law in laws()}


def test_every_law_has_a_page_and_a_row():
    assert [law.name for law in laws()] == [*(law.name for law in BASE), *LIBRARY, *PRESCRIBED]
    assert len({page_name(law) for law in laws()}) == len(laws())
    rows = re.findall(r"^\| \[(\S+)\]\(library/(\S+)\.md\) \|", library_table(), re.MULTILINE)
    assert sorted(rows) == sorted((law.name, page_name(law)) for law in laws())
    assert {law.path for law in laws()} <= set(PLACES)


@pytest.mark.parametrize("law", laws(), ids=lambda law: law.name)
def test_the_example_keeps_the_bounds_and_differs_from_the_rig(law):
    pair = example(law)
    assert pair.without.values() == RIG
    assert pair.having.values() != RIG
    for name, (low, high) in pair.having.bounds().items():
        assert low <= pair.having.values()[name] <= high


def test_the_rig_is_what_its_words_say():
    omega, h = natural_motion(example(LIBRARY["quadratic-drag"]).without, [1e-6, LENGTH])
    assert h == pytest.approx([0.02 * OMEGA] * 2, rel=1e-2)
    assert omega[1] / omega[0] == pytest.approx(1.026, abs=2e-3)


def test_a_linear_rig_answers_a_sine_as_the_textbook_says():
    from dashpot.model import Oscillator

    rig = Oscillator.from_values(RIG | {"cubic": 0.0})
    for ratio in (0.8, 1.0, 1.2):
        w = ratio * OMEGA
        exact = FORCE / RIG["mass"] / (OMEGA**2 - w**2 + 1j * RIG["viscous"] * w)
        assert fundamental(rig, FORCE, w) == pytest.approx(exact, rel=3e-3)
    assert harmonics(rig) == []


def test_the_harmonic_of_a_square_law():
    """A slight asymmetry, by harmonic balance: x2 = c A²/2 / (omega0² - 4 omega²); its acceleration is 4 times that."""

    from dashpot.model import oscillator_with

    c = 2e3
    rig = oscillator_with(RIG | {"cubic": 0.0, "quadratic-stiffness.coefficient": c}, effects=("quadratic-stiffness",))
    amplitude = abs(fundamental(rig, FORCE, OMEGA))
    ((order, level),) = harmonics(rig, -90.0)[:1]
    assert order == 2
    assert 10 ** (level / 20) == pytest.approx(4 * c * amplitude / 2 / (3 * OMEGA**2), rel=0.02)


@pytest.mark.parametrize("name", list(RIG_LAWS))
def test_a_page_has_its_law_and_a_picture_that_parses(name):
    law = RIG_LAWS[name]
    page = law_page(law, "picture.svg")
    assert page.startswith(f"# {name}\n")
    assert law.sentence in page
    assert "](picture.svg)" in page
    for parameter in law.parameters:
        assert f"| `{parameter.name}` |" in page
    for line in page.splitlines():
        if line.startswith("|"):
            assert len(re.findall(r"(?<!\\)\|", line)) in (3, 6), line
    root = ElementTree.fromstring(drawn(law_figure(law, page_name(law)), "svg"))
    assert name in root.findtext("{http://www.w3.org/2000/svg}title", "")
    assert len(root.findall(".//{http://www.w3.org/2000/svg}path")) > 10


def test_tell_tales_tell_the_sides_apart():
    assert "even and odd ones" in law_page(RIG_LAWS["one-sided-stop"], "")
    assert "odd ones only" in law_page(RIG_LAWS["hysteresis"], "")
    assert "no harmonic above" in law_page(RIG_LAWS["viscoelastic"], "")
    steady = harmonics(example(RIG_LAWS["quadratic-stiffness"]).having)
    assert np.all(np.diff([order for order, _ in steady]) > 0)
