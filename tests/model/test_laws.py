"""The library of laws: complete, readable, with bounds that make sense; and the table of docs/laws.md."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from dashpot.model.equations import equations
from dashpot.model.law_table import law_table
from dashpot.model.law_trial import problems
from dashpot.model.laws import BASE, LIBRARY

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("effect", LIBRARY)
def test_every_law_is_complete(effect, with_law):
    law = LIBRARY[effect]
    assert law.name == effect
    assert list(problems(law)) == []
    assert law.curves.endswith(".")
    assert law.sentence.endswith(".")
    for p in law.parameters:
        value = with_law(effect).values()[f"{effect}.{p.name}"]
        assert p.lower <= value <= p.upper
        if p.probes != "lines":
            # a parameter that is looked for on both sides of zero has no bound there
            assert all(p.lower <= probe * (1 if p.size is None else abs(probe)) for probe in p.probes)
    eq = equations(with_law(effect))
    assert len(eq.inner) == eq.z.numel() - 2
    assert len(set(eq.state_names)) == len(eq.state_names)


def test_strengths_start_at_nothing():
    """A law whose strength is zero changes nothing, which is how a search grows a model by it."""
    for law in LIBRARY.values():
        for p in law.parameters:
            assert not p.strength or p.lower <= 0.0 <= p.upper, f"{law.name}.{p.name}"


def test_the_equation_of_a_model_puts_every_law_in_its_place(with_law):
    model = with_law("viscoelastic", "actuator-lag", "sensor-offset", "constant-force")
    base = "mass [x'' + viscous x' + dry sgn(x') + omega0² x + cubic x³ + preload sgn(x)"
    assert model.equation() == (
        f"{base} + stiffness (x - q) - load] = F(t); q' = rate (x - q); F → G, time G' = F - G; record r → r + offset"
    )
    twice = with_law("clearance", "softening-stiffness").equation()
    assert "clearance.stiffness (x beyond ±gap) + softening-stiffness.stiffness width tanh(x / width)" in twice
    assert model.equation(lambda name: "#").count("#") == sum(len(term.parameters) for term in model.terms) + 6


def test_the_laws_of_equation_17_have_names_of_their_own():
    assert {law.name for law in BASE}.isdisjoint(LIBRARY)
    assert all(math.isfinite(p.lower) or p.lower == -math.inf for law in BASE for p in law.parameters)


def test_the_table_of_the_document_is_that_of_the_library():
    document = (ROOT / "docs/laws.md").read_text(encoding="utf-8")
    _, table = document.split("<!-- made by dashpot.model.law_table.law_table -->\n\n")
    assert table == law_table(), (
        "put what dashpot.model.law_table.law_table() returns behind the marker of docs/laws.md"
    )
