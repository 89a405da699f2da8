"""What a check says of recordings: quality as they were made, which parameters are told, and what is not."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import pytest
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.foresight.check import _of_machine, brief, check, describe
from dashpot.identify import identify
from dashpot.model import Oscillator


@pytest.fixture(scope="module")
def sweep(recorded):
    return recorded(sweep=(0.6, 8.0, 18.0), seconds=8.0, fs=600.0, noise=2e-6, force_noise=2e-3, seed=3, name="sweep")


@pytest.fixture(scope="module")
def found(sweep):
    return check([sweep])


def test_errors_are_within_a_factor_of_what_a_fit_states(found, sweep):
    stated = identify([sweep], every=False).oscillator.parameters()
    for told in found.parameters:
        assert told.std == pytest.approx(stated[told.name].std, rel=0.3), told.name
        assert abs(told.value - TRUTH[told.name]) < 5 * told.std, told.name


def test_the_quality_is_that_of_the_recording(found):
    (quality,) = found.recordings
    assert quality.kind == "sweep"
    assert quality.noise == pytest.approx(2e-6, rel=0.15)
    assert quality.force_noise == pytest.approx(2e-3, rel=0.15)
    assert quality.force_peak == pytest.approx(0.6, rel=0.02)
    assert quality.samples_a_cycle == pytest.approx(600.0 / 12.7, rel=0.05)
    assert quality.used > 0.95
    assert [kind for kind, _, _ in quality.pieces] == ["driven"]


def test_a_machine_has_errors_of_its_own(found):
    assert found["friction"].value == pytest.approx(TRUTH["mass"] * TRUTH["dry"], abs=5 * found["friction"].std)
    assert found["mass"].state == "told"
    with pytest.raises(KeyError):
        found["absent"]


def test_json_has_no_number_that_json_lacks(found):
    data = json.loads(json.dumps(found.as_json(), allow_nan=False))
    assert data["format"] == "dashpot-check/1"
    assert data["parameters"]["dry"]["std"] == pytest.approx(found["dry"].std)
    assert data["follows"] is True
    assert "not told" not in repr(found)


@pytest.fixture(scope="module")
def quiet(recorded):
    """A short noisy release of a rig without cubic spring and preload."""
    return recorded({**TRUTH, "cubic": 0.0, "preload": 0.0}, begin=(3e-3, 0.0), seconds=4.0, noise=5e-5, name="release")


def test_what_is_not_told_says_what_would_tell_it(quiet):
    found = check([quiet])
    states = {told.name: told.state for told in found.parameters}
    assert states["omega0"] == "told"
    assert states["cubic"] == states["preload"] == "not told"
    words = found["preload"].words
    assert words.startswith("preload is not told: ")
    assert "release it from" in words or "record longer" in words
    assert any("no force was recorded" in note for note in found.notes)
    assert "natural_frequency" in repr(found)
    assert "total_mass" not in repr(found)


def test_what_is_not_told_of_a_parameter_is_not_told_of_the_machine_either(quiet):
    """With a known mass each of these is a parameter times a number."""
    found = check([quiet], fixed={"mass": 0.27})
    for name, of in (("cubic_stiffness", "cubic"), ("preload_force", "preload"), ("damping", "viscous")):
        assert (found[name].state, found[name].words) == (found[of].state, "")
    # likelier absent, though two errors and more from zero
    lost = replace(found["dry"], state="not told"), *(t for t in found.parameters if t.name != "dry")
    (friction,) = [told for told in _of_machine(found.model, lost, True) if told.name == "friction"]
    assert friction.state == "not told"


def test_percents_and_lists_are_as_everywhere_else(quiet):
    found = replace(check([quiet]), left_out=("cubic", "preload", "dry"))
    said = describe(found)
    assert "a fit will leave cubic, preload and dry at zero" in said
    assert not re.search(r"e\+0\d %|one in [\d.]+e", said)


def test_a_mass_that_is_given_has_no_error(quiet):
    found = check([quiet], fixed={"mass": 0.27})
    assert found["mass"].state == "given"
    assert found["mass"].std is None
    assert found["stiffness"].value == pytest.approx(0.27 * TRUTH["omega0"] ** 2, rel=0.02)


def test_physics_that_eq_17_lacks_makes_the_errors_rough(recorded, sweep):
    bent = recorded(sweep=(0.6, 8.0, 18.0), seconds=8.0, fs=600.0, noise=2e-6, name="bent")
    clipped = replace(bent, response=bent.response + 40.0 * bent.response**2)
    found = check([clipped])
    assert not found.follows
    assert any("times the noise" in note for note in found.notes)
    assert {told.state for told in (*found.parameters, *found.machine)} <= {"rough", "not told"}
    assert found["omega0"].state == found["stiffness"].state == "rough"
    assert "e+0" not in " ".join(found.notes)


def test_before_a_fit_it_is_a_line(sweep, quiet):
    assert brief(Oscillator.from_values(TRUTH), [sweep]).startswith("expected errors mass 0.")
    away = Oscillator.from_values({**TRUTH, "omega0": 60.0})
    assert brief(away, [sweep]) == "the start values are not near enough to say what these recordings tell"


def test_without_recordings_it_says_so():
    with pytest.raises(BadInput, match="no recording"):
        check([])
