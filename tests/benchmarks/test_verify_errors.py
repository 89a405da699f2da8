"""The benchmark of `verify`: its core does what an FMU does, and its models are off by what it says."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from dashpot.examples.truth import TRUTH
from dashpot.export import export
from dashpot.model import Oscillator
from dashpot.verify.verification import verify

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
sys.path.append(str(BENCHMARKS))

from verify_errors import CoreRun, main, off, recorded, verification  # noqa: E402  (it lies beside the package)

MODEL = Oscillator.from_values(TRUTH)


@pytest.mark.parametrize("kind", [pytest.param("bursts", marks=pytest.mark.long), "decay"])
def test_its_core_gives_what_the_fmu_gives(tmp_path, kind):
    export(MODEL, tmp_path / "rig.fmu")
    record = recorded(kind, 10.0, 3)
    (fmu,) = verify(tmp_path / "rig.fmu", [record]).recordings
    core = verification._check(CoreRun(MODEL), record, verification.NOISE_RATIO)
    assert fmu.passed == core.passed
    assert core.nrmse == pytest.approx(fmu.nrmse, rel=1e-3)
    assert core.nrmse_limit == pytest.approx(fmu.nrmse_limit, rel=1e-2)
    assert core.score.gain == pytest.approx(fmu.score.gain, rel=1e-2)


def test_a_wrong_model_is_off_in_one_parameter():
    moved = off(MODEL, "dry", 0.01)
    apart = {name for name, value in moved.values().items() if value != TRUTH[name]}
    assert apart == {"dry"}
    assert moved.values()["dry"] == pytest.approx(TRUTH["dry"] + 0.01)


def test_it_prints_the_rates_of_right_and_wrong_models(capsys):
    main(["3", "10"])
    out = capsys.readouterr().out
    assert "right models (true): 100.0 % of 3 pass" in out
    assert "wrong models (true): 100.0 % of 3 fail" in out
