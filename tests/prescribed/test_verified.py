"""The FMU of a force law by itself along recorded motions: it passes what is right, fails what is wrong."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.specimens import Specimen, motion, recorded
from dashpot.export import export_element
from dashpot.model.element import Element
from dashpot.prescribed.element_fit import identify_element
from dashpot.prescribed.verified import verify
from dashpot.recording import Recording
from dashpot.report.verification_page import verification_page
from dashpot.simulate.compiler import find_compiler
from dashpot.verify.fmu_run import FmuRun

FS = 200.0
MEMBERS = {"stiffness": 9e3, "viscous": 700.0, "dry": 35.0, "load": 120.0}
pytestmark = pytest.mark.skipif(find_compiler() is None, reason="no C compiler")


def recording(seed: int, kind: str = "sweep", level: float = 1.0, noise: float = 3e-3) -> Recording:
    moved = motion(kind, 6e-3 * level, 2.0, FS, 10.0)
    made = recorded(Specimen(MEMBERS), moved, FS, noise=noise, motion_noise=2e-5, seed=seed)
    return replace(made, name=f"{kind}{seed}.csv")


@pytest.fixture(scope="module")
def element() -> Element:
    return identify_element([recording(1), recording(2, "sines", 0.7)]).element


@pytest.mark.parametrize("version", [2, 3])
def test_a_right_element_passes_and_the_floor_is_the_noise(element: Element, version: int, tmp_path: Path) -> None:
    (fmu,) = export_element(element, tmp_path / "strut.fmu", version=version)
    records = [recording(1), recording(3, "random", 0.8)]
    found = verify(fmu, records)
    assert found.passed
    for check in found.recordings:
        assert check.noise_floor == pytest.approx(3e-3, rel=0.3)
        assert check.noise_floor < check.nrmse_limit < 1.5 * check.noise_floor
        assert check.nrmse == pytest.approx(check.noise_floor, rel=0.15)
        assert check.backbone_max_error_hz is None
        assert check.response.unit == "N"
    told = found.as_json()["recordings"][0]
    assert told["pass"] is True
    assert told["nrmse"] == found.recordings[0].nrmse
    page = verification_page(found).html
    assert "reproduces all 2 recordings" in page
    assert "Force" in page


@pytest.mark.parametrize(("name", "part"), [("viscous", 1.03), ("dry", 0.6), ("stiffness", 1.05)])
def test_a_wrong_one_fails(element: Element, name: str, part: float, tmp_path: Path) -> None:
    value = element.parameters()[name]
    wrong = element.with_parameters({name: replace(value, value=part * value.value)})
    (fmu,) = export_element(wrong, tmp_path / "strut.fmu")
    found = verify(fmu, [recording(3, "random", 0.8)])
    assert not found.passed
    assert "once in a thousand" in found.sentence()
    assert "of the force of random3.csv" in verification_page(found).html


def test_another_constant_of_the_load_cell_is_no_fault(element: Element, tmp_path: Path) -> None:
    (fmu,) = export_element(element, tmp_path / "strut.fmu")
    one = recording(3, "random", 0.8)
    assert verify(fmu, [replace(one, force=np.asarray(one.force) + 50.0)]).passed


def test_the_fmu_gives_the_force_of_the_engine_under_verify(element: Element, tmp_path: Path) -> None:
    from dashpot.simulate.imposed import force_along

    x = motion("sines", 5e-3, 2.0, FS, 5.0)
    for version in (2, 3):
        (fmu,) = export_element(element, tmp_path / "strut.fmu", version=version)
        with FmuRun(fmu) as run:
            assert run.moved
            assert run.element is not None
            assert run.element.values() == element.values()
            made = run.force_along(x, 1.0 / FS)
        expected = force_along(element, x, 1.0 / FS)
        assert np.quantile(np.abs(made - expected), 0.98) < 1e-6 * np.std(expected)


def test_what_was_not_prescribed_or_is_in_other_units_is_refused(element: Element, tmp_path: Path) -> None:
    (fmu,) = export_element(element, tmp_path / "strut.fmu")
    with pytest.raises(BadInput, match="nobody says that its motion was prescribed"):
        verify(fmu, [replace(recording(1), prescribed=False)])
    with pytest.raises(BadInput, match=r"displacement is in rad, and .* has it in m"):
        verify(fmu, [replace(recording(1), unit="rad")])
