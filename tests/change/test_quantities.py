"""What moved, in the machine's units."""

from __future__ import annotations

from dashpot.change.quantities import Change, Quantity, quantities
from dashpot.model import oscillator_with

STAND = {"mass": 0.5, "omega0": 80.0, "viscous": 5.0, "dry": 0.3, "cubic": 4e5, "preload": 0.08}
DRAG = {"quadratic-drag.coefficient": 2.0}


def test_a_friction_is_a_force_by_the_mass_of_its_state():
    models = [oscillator_with(STAND | {"mass": mass} | DRAG, ["quadratic-drag"]) for mass in (0.5, 0.6)]
    found = quantities(models)
    assert found["dry"] == Quantity("friction", "N", (0.5, 0.6))
    assert found["quadratic-drag.coefficient"].unit == "N.s2/m2"
    assert Change.of(found["dry"], 0, 1, 0.3, 0.44).words == "friction from 0.15 to 0.264 N"
    assert quantities(models, [0.55, 0.55])["dry"].factors == (0.55, 0.55)
    assert "mass" not in found


def test_without_a_mass_a_frequency_is_all():
    values = {key: value for key, value in STAND.items() if key != "mass"}
    found = quantities([oscillator_with(STAND, []), oscillator_with(values, [])])
    assert list(found) == ["omega0"]
    assert Change.of(found["omega0"], 0, 1, 80.0, 75.0).words == "natural frequency from 12.732 to 11.937 Hz"
    assert Change.of(found["omega0"], 0, 1, 80.0, 75.0).as_json()["unit"] == "Hz"
