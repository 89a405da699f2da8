"""What the calls before a fit take: sizes with units, noise of recordings, and the recordings of a model file."""

from __future__ import annotations

import shutil
from pathlib import Path

import dashpot
import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.face.foresight import amplitude_of, noise_of, size, whole
from dashpot.model import Oscillator, Provenance, Range
from dashpot.model.file import save

MODEL = Oscillator.from_values(TRUTH, name="stand")


def test_a_size_is_a_number_or_has_a_unit():
    assert size("1um", "m", "the noise") == pytest.approx(1e-6)
    assert size("2 kN", "N", "the force") == 2000.0
    assert size(0.5, "N", "the force") == 0.5
    for wrong in ("1N", "-1um", -1.0, float("inf"), "much"):
        with pytest.raises(BadInput):
            size(wrong, "m", "the noise")
    assert whole(3.0, "runs", 1) == 3
    with pytest.raises(BadInput, match="whole number from 1"):
        whole(0, "runs", 1)


def test_noise_is_as_stated_or_as_recordings_show_it(recorded):
    sweep = recorded(sweep=(0.6, 8.0, 18.0), seconds=6.0, noise=3e-6, force_noise=2e-3)
    seen = noise_of(MODEL, [sweep], None, None, None)
    assert seen.sensor == pytest.approx(3e-6, rel=0.2)
    assert seen.force == pytest.approx(2e-3, rel=0.2)
    stated = noise_of(MODEL, [sweep], "1um", "0 N", None)
    assert (stated.sensor, stated.force) == (pytest.approx(1e-6), 0.0)
    other = recorded(begin=(1e-3, 0.0), seconds=2.0, quantity="velocity")
    with pytest.raises(BadInput, match="shows velocity"):
        noise_of(MODEL, [other], None, None, None)
    with pytest.raises(BadInput, match="not known"):
        noise_of(MODEL, [], None, None, None)


def test_the_recordings_of_a_model_file_are_found_beside_it(tmp_path):
    source = Path(dashpot.examples.recordings()["bursts"])
    shutil.copy(source, tmp_path)
    (bursts,) = dashpot.read(tmp_path / source.name)
    from dataclasses import replace

    known = Provenance(recordings=({"file": source.name, "sha256": bursts.sha256},))
    rig = replace(MODEL, identified=known, amplitude=Range(1e-4, 8e-3, "m"))
    save(rig, tmp_path / "rig.yaml")
    assert noise_of(rig, [], None, None, tmp_path).sensor == pytest.approx(1e-6, rel=0.2)
    other = replace(rig, identified=Provenance(recordings=({"file": source.name, "sha256": "0" * 64},)))
    with pytest.raises(BadInput, match="not known"):
        noise_of(other, [], None, None, tmp_path)
    assert amplitude_of(rig, None) == 8e-3
    with pytest.raises(BadInput, match="how far it may move"):
        amplitude_of(MODEL, None)


def test_the_calls_of_python_are_those_of_the_commands(recorded):
    release = recorded(begin=(5e-3, 0.0), seconds=4.0, noise=2e-5)
    told = dashpot.check(release, mass="270 g")
    assert told["stiffness"].value == pytest.approx(0.27 * TRUTH["omega0"] ** 2, rel=0.02)
    free = dashpot.Model.from_values({**TRUTH, "mass": None}, name="free")
    found = dashpot.plan(free, "viscous 2%", like=release, most_amplitude="5 mm", tries=0)
    assert found.noise.sensor == pytest.approx(2e-5, rel=0.2)
    assert np.isfinite(found.expected[0])
    with pytest.raises(BadInput, match="no test"):
        dashpot.plan(free, "viscous 2%", like=release, most_amplitude="5 mm", tests="hammer")
