"""The force of an element along a motion, against closed forms and an integrator that is not the product's."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.specimens import LAWS, Specimen, motion
from dashpot.model.element import Element
from dashpot.model.library import find
from dashpot.simulate.imposed import force_along, pace_of, spline_of

FS = 500.0
MEMBERS = {"inertia": 3.0, "stiffness": 7e3, "cubic": 4e7, "preload": 5.0, "viscous": 500.0, "dry": 20.0, "load": 9.0}
NUMBERS = {
    "hysteresis": {"stiffness": 2e5, "limit": 2e-4, "exponent": 1.0, "loading": 0.5},
    "viscoelastic": {"stiffness": 2e4, "rate": 12.0},
    "nonlinear-maxwell": {"stiffness": 2e5, "limit": 3e-4, "speed": 0.02, "exponent": 2.5},
    "lugre": {"stiffness": 1e5, "damping": 40.0, "limit": 3e-4, "excess": 0.6, "speed": 0.01},
    "stribeck": {"excess": 30.0, "speed": 0.01, "exponent": 1.0},
    "two-sided-stop": {"stiffness": 3e5, "position": 3e-3},
    "one-sided-stop": {"stiffness": 3e5, "position": 2e-3},
    "quadratic-drag": {"coefficient": 4e3},
    "cubic-damping": {"coefficient": 5e4},
    "softening-stiffness": {"stiffness": 2e4, "width": 1e-3},
    "quadratic-stiffness": {"coefficient": 2e6},
    "digressive-damping": {"force": 60.0, "speed": 0.02},
    "gas-spring": {"force": 50.0, "length": 9e-3, "exponent": 1.3},
    "exponential-spring": {"force": 10.0, "length": 2e-3},
    "asymmetric-friction": {"viscous": 200.0},
}


@pytest.mark.parametrize("law", ["", *NUMBERS])
@pytest.mark.parametrize("kind", ["sweep", "triangle"])
def test_the_force_is_that_of_an_integrator_of_its_own(law: str, kind: str) -> None:
    assert set(LAWS) == set(NUMBERS)
    x = motion(kind, 5e-3, 2.0, FS, 6.0)
    given = NUMBERS.get(law, {})
    whole = given | {p.name: 0.0 for p in (find(law).parameters if law else ()) if p.name not in given}
    own = {f"{law}.{name}": value for name, value in whole.items()}
    made = force_along(Element.from_values(MEMBERS | own, laws=[find(law)] if law else []), x, 1.0 / FS)
    v, a = spline_of(x, 1.0 / FS)
    expected = Specimen(MEMBERS, law, given).force(x, v, a, 1.0 / FS)
    # beside a turn, a stop or the middle a sample is on one side or the other
    off = np.abs(made - expected) / np.std(expected)
    assert np.quantile(off, 0.98) < 2e-3
    assert np.median(off) < 2e-4


def test_an_origin_moves_every_law() -> None:
    x = motion("sweep", 5e-3, 2.0, FS, 4.0)
    element, aside = (Element.from_values(MEMBERS, origin=origin) for origin in (0.0, 0.2))
    assert force_along(aside, x + 0.2, 1.0 / FS) == pytest.approx(force_along(element, x, 1.0 / FS), abs=1e-6)


def test_pace_is_that_of_a_sine() -> None:
    time = np.arange(5000) / FS
    x = 2e-3 * np.sin(14.0 * time)
    assert pace_of(x, spline_of(x, 1.0 / FS)[0]) == pytest.approx(14.0, rel=2e-3)
