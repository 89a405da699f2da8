"""The paper's stand, and laws that only tests know."""

from __future__ import annotations

import math

import pytest
from dashpot.model import Oscillator
from dashpot.model.law import Law, LawParameter
from dashpot.model.laws import LIBRARY

RIG = {
    "mass": 0.27,
    "omega0": 2 * math.pi * 12.67,
    "cubic": 4.6e5,
    "preload": 0.02 / 0.27,
    "viscous": 5.0,
    "dry": 0.015,
}


@pytest.fixture
def rig():
    """``rig(cubic=0.0)``: an oscillator with the stand's values but for those given; ``effects`` as in from_values."""

    def make(effects: tuple[str, ...] = (), **changed: float) -> Oscillator:
        values = {name: changed.pop(name, value) for name, value in RIG.items()}
        return Oscillator.from_values({**values, **changed}, effects=effects)

    return make


@pytest.fixture
def contact(monkeypatch):
    """A linear spring that acts beyond +gap only, put into the library for one test."""
    law = Law(
        name="contact",
        path="restoring",
        parameters=(LawParameter("stiffness", "1/s2", "contact stiffness"), LawParameter("gap", "X", "clearance", 0.0)),
        force=lambda motion, p: p["stiffness"] * (motion.x - p["gap"]) * (1 + motion.sign(motion.x - p["gap"])) / 2,
        equation="contact",
        sentence="A contact.",
        source="test",
    )
    monkeypatch.setitem(LIBRARY, "contact", law)
