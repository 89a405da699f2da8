"""The stand that is broken by a law: what it is beside the stand as it is, and which laws it has."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.broken import FS, HELD_OUT, SENSOR_NOISE, TRAINING, can_break, make, records, sizes
from dashpot.examples.concealed.effects import SINGLE
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.model.laws import LIBRARY
from dashpot.recording import read


def test_every_law_of_the_library_with_a_cause_can_be_hidden():
    without = [name for name in LIBRARY if not name.startswith("free/") and not can_break(name)]
    assert without == []
    assert not can_break("gas-spring")
    with pytest.raises(ValueError, match="no law 'gas-spring'"):
        sizes("gas-spring")


def test_variants_differ_and_strength_scales():
    assert set(sizes("softening-stiffness")) != set(sizes("softening-stiffness/sine"))
    assert set(sizes("stiffness-drift")) == {"drift_rate"}
    assert set(sizes("stiffness-drift/settling")) == {"drift_gain", "drift_time"}
    assert sizes("quadratic-drag", 0.2)["drag"] == pytest.approx(0.2 * sizes("quadratic-drag")["drag"])


def test_unbroken_it_is_the_paper_s_stand():
    """Two integrators that share no code, on the same decay."""
    (decay,) = records(names=["ringdown"], noise=False)
    assert decay.force is None
    still = np.zeros((decay.shown.size, 1))
    x = integrate_pieces(TRUTH, still[:-1], 1 / FS, 8e-3, 0.0)[0]
    assert np.abs(decay.shown - x).max() < 1e-8 * 8e-3


def test_broken_it_is_another_by_far_more_than_its_noise(tmp_path):
    paths = make("quadratic-drag", tmp_path, names=["ringdown"])
    assert [path.name for path in paths] == ["ringdown.csv.gz"]
    shown = read(paths[0])
    (plain,) = records(names=["ringdown"])
    assert shown.fs == pytest.approx(FS)
    assert np.std(shown.response - plain.shown) > 100 * SENSOR_NOISE


def test_the_same_law_gives_the_same_recordings(tmp_path):
    first, second = (make("sensor-offset", tmp_path / name, names=["ringdown"])[0].read_bytes() for name in "ab")
    assert first == second
    assert {record.name for record in records("constant-force", noise=False)} == {*TRAINING, *HELD_OUT}


def test_each_effect_is_the_middle_of_its_range():
    for name in SINGLE:
        assert sizes(name) == sizes(name)
        assert all(np.isfinite(value) for value in sizes(name).values())
