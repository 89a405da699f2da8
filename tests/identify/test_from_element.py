"""A rig identified with a damper that was measured by itself: masses of known size, by another integrator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.specimens import Specimen, motion, recorded
from dashpot.face.workflow import identified
from dashpot.model.element import Element
from dashpot.prescribed.element_fit import identify_element
from dashpot.recording import Recording, recordings_of
from scipy.integrate import solve_ivp

FS, MASS, STIFFNESS, VISCOUS, DRAG = 400.0, 12.0, 3.0e4, 25.0, 260.0
OWN = 40.0  # N.s/m, of the rig beside its damper


def element(law: bool = True, load: float = 0.0) -> Element:
    """The damper alone, from two tests in a machine."""
    specimen = Specimen({"viscous": VISCOUS, "load": load}, "quadratic-drag" if law else "", {"coefficient": DRAG})
    tests = [
        replace(recorded(specimen, motion(kind, 0.03, 4.0, FS, 8.0), FS, noise=2e-3, seed=seed), name=f"{kind}.csv")
        for seed, kind in enumerate(("sweep", "sines"))
    ]
    return identify_element(tests, name="damper", laws=["quadratic-drag"] if law else []).element


def rig(forced: bool, seed: int = 0, unit: str = "m") -> Recording:
    """The damper in its rig, driven by a sweep, or let go."""
    n = 6000 if forced else 2400
    t = np.arange(n) / FS

    def push(at: float) -> float:
        return 60.0 * np.sin(2 * np.pi * (4.0 * at + 0.2 * at**2)) if forced else 0.0

    def rates(at: float, z: np.ndarray) -> list[float]:
        x, v = z
        return [v, (push(at) - STIFFNESS * x - (VISCOUS + OWN) * v - DRAG * v * abs(v)) / MASS]

    begun = [0.0, 0.0] if forced else [0.025, 0.0]
    x = solve_ivp(rates, (0.0, t[-1]), begun, t_eval=t, rtol=1e-9, atol=1e-12, max_step=1e-2).y[0]
    noise = np.random.default_rng(seed).standard_normal(n)
    force = np.array([push(float(at)) for at in t]) if forced else None
    return Recording("rig.csv", FS, x + 1e-5 * noise, force, unit=unit)


def off(found: object, name: str, value: float) -> float:
    """In standard errors."""
    parameter = found.oscillator.parameters()[name]  # type: ignore[attr-defined]
    return abs(parameter.value - value) / parameter.std


def test_the_law_is_kept_over_the_mass_and_the_rest_is_the_rigs() -> None:
    damper = element()
    found = identified(lambda: [rig(True)], start=damper)
    rigs, own = found.oscillator.parameters(), damper.parameters()
    kept = rigs["quadratic-drag.coefficient"]
    assert kept.std is None
    mass = found.oscillator.mass
    assert mass is not None
    assert mass.value == pytest.approx(MASS, rel=2e-3)
    assert kept.value * mass.value == pytest.approx(own["quadratic-drag.coefficient"].value, rel=1e-3)
    assert off(found, "omega0", np.sqrt(STIFFNESS / MASS)) < 4
    assert rigs["viscous"].value * MASS == pytest.approx(VISCOUS + OWN, rel=0.02)
    assert max(part.over_noise for part in found.fit.segments) < 1.1
    said = " ".join(found.notes)
    assert "quadratic-drag of damper keeps its values, forces divided by 12" in said
    assert "(--with quadratic-drag frees it)" in said
    assert "viscous began at what damper has" in said


def test_a_law_that_is_named_is_freed() -> None:
    found = identified(lambda: [rig(True)], start=element(), laws=["quadratic-drag"])
    assert off(found, "quadratic-drag.coefficient", DRAG / MASS) < 4
    assert off(found, "mass", MASS) < 4
    assert any("began at the element's values" in note for note in found.notes)


def test_decays_alone_need_the_mass() -> None:
    damper = element()
    with pytest.raises(BadInput, match=r"free decays .* the forces of damper are divided; give it with --mass"):
        identified(lambda: [rig(False)], start=damper)
    found = identified(lambda: [rig(False)], start=damper, mass=MASS)
    assert found.oscillator.mass is not None
    assert found.oscillator.mass.value == MASS
    kept = found.oscillator.parameters()["quadratic-drag.coefficient"]
    assert kept.value == pytest.approx(damper.parameters()["quadratic-drag.coefficient"].value / MASS)
    assert off(found, "omega0", np.sqrt(STIFFNESS / MASS)) < 4


def test_an_element_without_further_laws_is_a_start_alone() -> None:
    found = identified(lambda: [rig(False)], start=element(law=False, load=5.0), mass=MASS)
    assert not found.oscillator.terms
    assert any("load of damper is not taken over" in note for note in found.notes)


def test_other_units_are_refused() -> None:
    with pytest.raises(BadInput, match="its displacement is in rad, and damper was measured in m"):
        identified(lambda: [rig(False, unit="rad")], start=element(), mass=MASS)


def test_a_rig_that_its_base_drives_takes_the_law_over_the_mass_that_is_given() -> None:
    t = np.arange(6000) / FS
    level, turn = 5e-3, 2 * np.pi * (4.0 * t + 0.2 * t**2)
    pace, rise = 2 * np.pi * (4.0 + 0.4 * t), 2 * np.pi * 0.4
    base = level * np.sin(turn)

    def rates(at: float, z: np.ndarray) -> list[float]:
        x, v = z
        pushed = level * (np.cos(turn_at(at)) * rise - np.sin(turn_at(at)) * (2 * np.pi * (4.0 + 0.4 * at)) ** 2)
        return [v, -pushed - (STIFFNESS * x + (VISCOUS + OWN) * v + DRAG * v * abs(v)) / MASS]

    def turn_at(at: float) -> float:
        return 2 * np.pi * (4.0 * at + 0.2 * at**2)

    begun = [0.0, -level * pace[0]]
    x = solve_ivp(rates, (0.0, t[-1]), begun, t_eval=t, rtol=1e-9, atol=1e-12, max_step=1e-2).y[0]
    noise = 1e-5 * np.random.default_rng(3).standard_normal((2, t.size))
    recordings = recordings_of({"time_s": t, "x_m": x + base + noise[0], "base_m": base + noise[1]})
    with pytest.raises(BadInput, match="which does not tell its mass"):
        identified(lambda: recordings, start=element())
    found = identified(lambda: recordings, start=element(), mass=MASS)
    assert found.oscillator.mass is None
    assert found.oscillator.values()["quadratic-drag.coefficient"] == pytest.approx(DRAG / MASS, rel=5e-3)
    assert found.oscillator.omega0.value == pytest.approx(np.sqrt(STIFFNESS / MASS), rel=2e-3)
