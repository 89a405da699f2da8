"""How much a model may leave of its recordings before `identify` ends with exit code 1 is for the user to say."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.commands import cli
from dashpot.examples.oscillator import integrate
from dashpot.examples.truth import TRUTH
from dashpot.model.file import load

FS, N = 500.0, 1000


@pytest.fixture
def decay(tmp_path):
    x = integrate(TRUTH, np.zeros(N), 1 / FS, 8e-3, 0.0)[0]
    x = x + 1e-6 * np.random.default_rng(3).standard_normal(N)
    path = tmp_path / "decay.csv"
    np.savetxt(path, np.column_stack([np.arange(N) / FS, x]), "%.9g", ",", header="time_s,displacement_m", comments="")
    return path


def ended(*arguments):
    try:
        cli.main([str(argument) for argument in arguments])
    except SystemExit as stop:
        return stop.code
    return 0


@pytest.mark.parametrize(("allowed", "code"), [("0.5x", 1), ("1.5 x", 0), ("0.0001%", 0)])
def test_what_is_left_is_a_gate_and_the_model_is_written_all_the_same(capsys, tmp_path, decay, allowed, code):
    """The model leaves the noise: once that, and of a share of the motion noise is no part."""
    made = tmp_path / "m.yaml"
    assert ended("identify", decay, "-o", made, "--max-left", allowed) == code
    said = capsys.readouterr().err
    assert ("decay.csv: the model leaves " in said) == bool(code)
    assert ("times the noise, more than 0.5 times the noise (--max-left)" in said) == bool(code)
    assert 0.9 < load(made).identified.recordings[0]["over_noise"] < 1.1


@pytest.mark.parametrize("text", ["5", "x", "-3x", "0%", "%", "", "nan%", "infx"])
def test_what_may_be_left_has_a_unit(capsys, tmp_path, decay, text):
    assert ended("identify", decay, "-o", tmp_path / "m.yaml", "--max-left", text) == 2
    assert "such as 5%" in capsys.readouterr().err
    assert not (tmp_path / "m.yaml").exists()


@pytest.fixture
def with_drag(tmp_path):
    """A decay with quadratic drag, which Eq. 17 lacks: it leaves some per cent of the motion and follows it all."""
    n, x, v, moved = 20, 8e-3, 0.0, []

    def acceleration(x, v):
        return -(60.0**2) * x - 0.6 * v - 60.0 * v * abs(v)

    for _ in range(2 * N):
        moved.append(x)
        for _ in range(n):
            step = 1 / FS / n
            half = v + 0.5 * step * acceleration(x, v)
            x, v = x + step * half, v + step * acceleration(x + 0.5 * step * half, half)
    x = np.array(moved) + 1e-6 * np.random.default_rng(3).standard_normal(2 * N)
    path, times = tmp_path / "drag.csv", np.arange(2 * N) / FS
    np.savetxt(path, np.column_stack([times, x]), "%.9g", ",", header="time_s,displacement_m", comments="")
    return path


def test_a_remainder_that_matters_is_bad_news(capsys, tmp_path, with_drag):
    """Five per cent of the motion beside noise; whoever says how much may be left is asked instead."""
    made = tmp_path / "m.yaml"
    assert ended("identify", with_drag, "-o", made) == 1
    assert "the parameters may be off by more than their errors" in capsys.readouterr().err
    assert load(made).identified.recordings[0]["nrmse"] > 0.01
    assert ended("identify", with_drag, "-o", made, "--max-left", "20%") == 0
