"""A model that leaves much says so wherever it goes: in the FMU's description and log, CasADi's description, C, SSP."""

from __future__ import annotations

import json
import zipfile
from dataclasses import replace

import numpy as np
import pytest
from dashpot.export.casadi_functions import export_casadi
from dashpot.export.facts import Facts
from dashpot.export.fmu import export_fmu
from dashpot.export.plain_c import plain_c
from dashpot.export.platforms import own_platform
from dashpot.export.ssp import export_ssp, note
from dashpot.model import Provenance
from dashpot.model.fit_state import state_of_fit
from fmpy.validation import validate_fmu


@pytest.fixture
def lacking(models):
    """A model that leaves four times the noise, with a covariance."""
    model = models["base"]()
    names = tuple(model.parameters())
    covariance = tuple(map(tuple, np.diag([(1e-4 * value) ** 2 for value in model.values().values()]).tolist()))
    recording = {"file": "sweep %s.csv", "nrmse": 0.05, "over_noise": 4.0}
    return replace(model, identified=Provenance((recording,), parameters=names, covariance=covariance))


def in_log(model):
    return state_of_fit(model).replace("%", "per cent")


@pytest.mark.parametrize("version", [pytest.param(2, marks=pytest.mark.long), 3])
def test_an_fmu_describes_it_and_logs_it_where_the_importer_wants_a_log(lacking, callers, fmu_of, tmp_path, version):
    path = export_fmu(lacking, tmp_path / "rig.fmu", version=version, platforms=(own_platform(),))
    assert validate_fmu(str(path)) == []
    with zipfile.ZipFile(path) as opened:
        assert f"Take note: {state_of_fit(lacking)}." in opened.read("modelDescription.xml").decode()
        assert "sweep" not in opened.read("sources/variables.h").decode()
    loud = callers(path, "CoSimulation")
    assert loud.messages == [(1, in_log(lacking))]
    loud.start()
    assert len(loud.messages) == 1
    quiet = callers(path, "CoSimulation", logging=False)
    assert quiet.messages == []
    assert callers(fmu_of(version), "CoSimulation").messages == []  # of a model of which nothing must be known


def test_an_fmu_in_python_logs_it_too(lacking, callers, tmp_path):
    path = export_fmu(lacking, tmp_path / "rig.fmu", backend="python")
    assert validate_fmu(str(path)) == []
    assert callers(path, "CoSimulation").start().messages == [(1, in_log(lacking))]


def test_the_description_of_casadi_functions_has_it_by_recording(lacking, models, tmp_path):
    *_, described = export_casadi(lacking, tmp_path / "rig.casadi")
    data = json.loads(described.read_text())
    assert data["state_of_fit"] == state_of_fit(lacking)
    assert data["recordings"] == [{"file": "sweep %s.csv", "nrmse": 0.05, "over_noise": 4.0}]
    *_, described = export_casadi(models["base"](), tmp_path / "given.casadi")
    assert json.loads(described.read_text())["state_of_fit"] is None


def test_the_header_in_c_has_it(lacking, models):
    _, header = plain_c(Facts(lacking), "rig.h")
    assert f"Take note: {state_of_fit(lacking)}." in " ".join(header.replace("\n *", "").split())
    assert "Take note" not in plain_c(Facts(models["base"]()), "rig.h")[1]


def test_draws_of_such_a_model_are_told_to_spread_too_little(lacking, tmp_path):
    said = note(lacking)
    assert said == f"stand: {state_of_fit(lacking)}, and a result by more than the draws spread"
    assert note(lacking, 0) is None
    with zipfile.ZipFile(export_ssp(lacking, tmp_path / "rig.ssp", draws=1)) as opened:
        assert said in opened.read("documentation/index.html").decode()
        for name in ("SystemStructure.ssd", "draw_01.ssd", "resources/parameters/draw_01.ssv"):
            assert f"Take note: {state_of_fit(lacking)}." in opened.read(name).decode()
