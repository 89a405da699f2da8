"""A known mass or stiffness on a rig: two decays tell its mass, and what does not fit is said."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.face.added import identified_with_added
from dashpot.face.commands import identify
from dashpot.model.file import dumps, loads
from dashpot.recording import Recording
from scipy.integrate import solve_ivp

FS, SECONDS, MASS = 500.0, 6.0, TRUTH["mass"]


def decay(name: str, seed: int, mass: float = 0.0, stiffness: float = 0.0, damping: float = 1.0) -> Recording:
    """A release of the stand's linear part with dry friction, by an independent integrator."""
    total = MASS + mass
    spring = (MASS * TRUTH["omega0"] ** 2 + stiffness) / total
    viscous, dry = damping * MASS * TRUTH["viscous"] / total, MASS * TRUTH["dry"] / total

    def rates(t, y):
        return [y[1], -spring * y[0] - viscous * y[1] - dry * np.tanh(y[1] / 1e-5)]

    t = np.arange(round(FS * SECONDS)) / FS
    x = solve_ivp(rates, (0.0, t[-1]), [4e-3, 0.0], t_eval=t, rtol=1e-9, atol=1e-12, max_step=2e-3).y[0]
    return Recording(name, FS, x + 4e-6 * np.random.default_rng(seed).standard_normal(t.size))


@pytest.fixture(scope="module")
def plain() -> Recording:
    return decay("plain", 1)


@pytest.mark.parametrize(
    ("mass", "stiffness"), [(0.05, 0.0), (0.0, 200.0), (0.02, 300.0)], ids=["mass", "stiffness", "both"]
)
def test_what_was_added_tells_the_mass(plain: Recording, mass: float, stiffness: float) -> None:
    loaded = decay("loaded", 2, mass, stiffness)
    found = identified_with_added(
        lambda: [plain, loaded],
        {"loaded": f"{1e3 * mass} g"} if mass else {},
        {"loaded": f"{1e-3 * stiffness} kN/m"} if stiffness else {},
    )
    model = found.oscillator
    assert model.mass is not None
    assert model.mass.unit == "kg"
    for name in ("mass", "omega0", "viscous", "dry"):
        parameter = model.parameters()[name]
        assert abs(parameter.value - TRUTH[name]) < 3.5 * parameter.std
    assert model.mass.std < 2e-3 * MASS
    again = loads(dumps(model))  # with what was added, and the covariance
    assert "added" not in again.identified.recordings[0]
    assert again.identified.recordings[1]["added"] == " and ".join(
        text for text, there in ((f"{mass:g} kg", mass), (f"{stiffness:g} N/m", stiffness)) if there
    )
    assert any("tells the mass" in note for note in found.notes)


def test_two_loads_tell_more_than_one(plain: Recording) -> None:
    one, two = decay("one", 2, 0.05), decay("two", 3, 0.1)
    alone = identify(plain, one, add_mass={"one": 0.05})
    both = identify(plain, one, two, add_mass={"one": 0.05, "two": 0.1})
    assert both["mass"].std < 0.8 * alone["mass"].std
    assert abs(both["mass"].value - MASS) < 3.5 * both["mass"].std


def test_a_mounting_that_changed_the_rig_is_said_and_widens_the_errors(plain: Recording) -> None:
    right, wrong = (decay("loaded", 4, 0.05, damping=d) for d in (1.0, 1.3))
    fits, off = (identified_with_added(lambda r=r: [plain, r], {"loaded": 0.05}, {}) for r in (right, wrong))
    assert not any("mounting" in note for note in fits.notes)
    assert any("mounting it may have changed the rig" in note for note in off.notes)
    assert off.oscillator.omega0.std > 3 * fits.oscillator.omega0.std


@pytest.mark.parametrize(
    ("masses", "stiffnesses", "words"),
    [
        ({"other": "50 g"}, {}, "no recording is called 'other'"),
        ({"plain": "50 g", "again": "50 g"}, {}, "give at least one of the rig as it is"),
        ({"again": "50 N"}, {}, "give it such as 0.5 kg"),
        ({}, {"again": "50 kg"}, "give it such as 200 N/m"),
        ({"again": "50 g"}, {}, "by no more than its error"),
        ({"again": float("nan")}, {}, "mass added to again must be a finite number"),
        ({"again": 0.0}, {}, "mass added to again is 0.0"),
        ({"again": True}, {}, "mass added to again"),
    ],
)
def test_what_tells_nothing_is_refused(plain: Recording, masses, stiffnesses, words: str) -> None:
    again = decay("again", 5)
    with pytest.raises(BadInput, match=words):
        identified_with_added(lambda: [plain, again], masses, stiffnesses)


def test_a_mass_that_is_given_is_not_told_too(plain: Recording) -> None:
    with pytest.raises(BadInput, match="what was added tells it; leave one of them out"):
        identify(plain, decay("loaded", 2, 0.05), add_mass={"loaded": 0.05}, mass="270 g")


def test_a_load_on_the_wrong_recording_is_refused(plain: Recording) -> None:
    with pytest.raises(BadInput, match="the wrong way"):
        identified_with_added(lambda: [decay("loaded", 2, 0.05), plain], {"plain": "50 g"}, {})
