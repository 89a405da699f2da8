"""Energy and dissipated power of a model with any law: they balance, and what is passive never gives."""

from __future__ import annotations

from dataclasses import replace

import casadi
import numpy as np
import pytest
from dashpot.model.laws import LIBRARY

#: Half a difference of friction between both directions, and the friction it belongs to: see docs/laws.md.
HALF_DIFFERENCES = {"asymmetric-friction": "viscous", "asymmetric-friction/dry": "dry"}

#: Dampings of whatever shape was learnt: nothing keeps them from giving.
LEARNT = {name for name, law in LIBRARY.items() if law.learnt and law.path == "dissipation"}


def on(*paths):
    return [name for name, law in LIBRARY.items() if law.path in paths]


@pytest.mark.parametrize("mass", [True, False], ids=["mass", "per-unit-mass"])
@pytest.mark.parametrize("effect", LIBRARY)
def test_the_energy_changes_by_what_is_put_in_less_what_is_dissipated(effect, mass, with_law, at_random):
    """The change is a central difference of fourth order along the flow, which knows no derivative of an expression."""
    model = with_law(effect)
    at = at_random(model if mass else replace(model, mass=None))
    eq, h = at.eq, 5e-6
    zdot = at(eq.zdot)
    near = {n: (at.z + n * h * zdot, at.t + n * h) for n in (-2, -1, 1, 2)}
    energy = {n: at(eq.energy, *there) for n, there in near.items()}
    sides = [np.sign(at(eq.surfaces, *there)) for there in near.values()]
    kept = np.all(np.ptp(sides, axis=0) == 0.0, axis=0)  # the difference must not reach over a kink
    assert np.mean(kept) > 0.9
    change = (8 * (energy[1] - energy[-1]) - (energy[2] - energy[-2])) / (12 * h)
    put_in, dissipated = at(eq.drive) * at.z[1], at(eq.dissipated)
    size = np.max(np.abs(put_in)) + np.max(np.abs(dissipated))
    assert np.max(np.abs(change[kept])) > 0.1 * size
    assert np.max(np.abs(change - put_in + dissipated)[kept]) < 1e-10 * size


@pytest.mark.parametrize("effect", LIBRARY)
def test_the_energy_is_the_same_on_both_sides_of_every_surface(effect, with_law, at_random):
    """So that no event makes it jump."""
    at = at_random(with_law(effect))
    eq, energies = at.eq, at(at.eq.energy)
    assert casadi.depends_on(eq.energy, eq.s)  # on the side of the preload's seat at least
    inputs, here = casadi.vertcat(eq.z, eq.u), np.vstack([at.z, at.u])
    for i in range(eq.s.numel()):
        slope = casadi.jacobian(eq.surfaces[i], inputs).T
        place = here
        for _ in range(3):  # Newton's method onto the surface, each direction by its own size
            away, along = (at(e, place[:-1], None, place[-1]) for e in (eq.surfaces[i], slope))
            step = along * np.ptp(here, axis=1)[:, None] ** 2
            place = place - away * step / np.sum(along * step, axis=0)
        away, before = at(eq.surfaces[i], place[:-1], None, place[-1]), at(eq.surfaces[i])
        assert np.max(np.abs(away)) < 1e-12 * np.max(np.abs(before))
        sides = [casadi.substitute(eq.energy, eq.s[i], casadi.SX(side)) for side in (-1.0, 1.0)]
        left, right = at(casadi.vertcat(*sides), place[:-1], None, place[-1])
        assert np.max(np.abs(right - left)) < 1e-12 * np.max(energies)


@pytest.mark.parametrize("effect", on("restoring"))
def test_a_spring_dissipates_nothing(effect, with_law, share):
    dampers = {f"{effect}.{p.name}": 0.0 for p in LIBRARY[effect].parameters if p.unit == "1/s"}
    energy, dissipated, size = share(with_law(effect, **dampers))
    assert np.ptp(energy) > 1e-6
    assert np.max(np.abs(dissipated)) < 1e-13 * size


@pytest.mark.parametrize("effect", [e for e in on("restoring", "dissipation", "memory", "inertia") if e not in LEARNT])
def test_what_is_passive_takes_and_never_gives_more_than_it_has_stored(effect, with_law, at_random, share):
    model = with_law(effect)
    _, dissipated, size = share(model)
    law = LIBRARY[effect]
    keeps = law.learnt or (law.path == "restoring" and not any(p.unit == "1/s" for p in law.parameters))
    assert keeps or np.max(dissipated) > 1e-6 * size
    if effect not in HALF_DIFFERENCES:
        assert np.min(dissipated) > -1e-13 * size
        return
    assert np.min(dissipated) < -1e-3 * size  # by itself it gives, not so with the friction that it is a half of
    whole = HALF_DIFFERENCES[effect]
    here = at_random(with_law(effect, **{whole: abs(model.values()[f"{effect}.{whole}"])}))
    assert np.min(here(here.eq.dissipated)) > -1e-13 * size


@pytest.mark.parametrize("effect", on("dissipation"))
def test_friction_stores_nothing(effect, with_law, share):
    energy, _, _ = share(with_law(effect))
    assert LIBRARY[effect].stored is None
    assert np.all(energy == 0.0)


@pytest.mark.parametrize("effect", on("excitation", "measurement", "either"))
def test_what_stands_in_the_path_of_force_or_record_has_no_part_in_the_energy(effect, with_law, share):
    energy, dissipated, size = share(with_law(effect))
    assert np.all(energy == 0.0)
    assert np.max(np.abs(dissipated)) < 1e-15 * size


def test_what_feeds_the_motion_without_being_recorded_is_negative_dissipation(with_law, at_random, share):
    expected = {
        "stiffness-drift": lambda p, at: -p["rate"] * at.z[0] ** 2 / 2,
        "stiffness-drift/settling": lambda p, at: (
            -p["change"] / p["time"] * np.exp(-at.t / p["time"]) * at.z[0] ** 2 / 2
        ),
        "tonal-disturbance": lambda p, at: -p["amplitude"] * np.cos(at.z[2]) * at.z[1],
    }
    assert set(expected) == set(on("environment"))
    for effect, power in expected.items():
        model = with_law(effect)
        p = {name.rpartition(".")[2]: value for name, value in model.values().items()}
        _, dissipated, size = share(model)
        assert np.max(np.abs(dissipated)) > 1e-6 * size
        assert dissipated == pytest.approx(p["mass"] * power(p, at_random(model)), rel=1e-9, abs=1e-13 * size)
