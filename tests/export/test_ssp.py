"""The SSP archive: valid by the schemas, its system the FMU's run, its variants what setting the parameters gives."""

from __future__ import annotations

import zipfile
from dataclasses import replace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.export.ssp import MOST_DRAWS, export_ssp, note
from dashpot.model import Provenance
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd, read_ssv, validate_tree
from lxml import etree

DT, STOP = 1e-3, 0.2
STD = [3e-4, 2e-3, 5e3, 8e-4, 2e-3, 5e-4]
SSV = "{http://ssp-standard.org/SSP1/SystemStructureParameterValues}"


def certain(model):
    """The model with a covariance."""
    rows = np.diag(np.square([*STD, *[0.1] * 9][: len(model.parameters())])).tolist()
    names = tuple(model.parameters())
    return replace(model, identified=Provenance(parameters=names, covariance=tuple(map(tuple, rows))))


@pytest.fixture(scope="module")
def archive(models, tmp_path_factory):
    return export_ssp(certain(models["base"]()), tmp_path_factory.mktemp("ssp") / "rig.ssp", draws=3)


def force(t):
    return np.sin(80.0 * t)


def test_the_archive_holds_system_variants_fmu_and_sets(archive):
    with zipfile.ZipFile(archive) as opened:
        assert opened.namelist() == [
            "SystemStructure.ssd",
            "documentation/index.html",
            "draw_01.ssd",
            "draw_02.ssd",
            "draw_03.ssd",
            "resources/parameters/draw_01.ssv",
            "resources/parameters/draw_02.ssv",
            "resources/parameters/draw_03.ssv",
            "resources/parameters/nominal.ssv",
            "resources/stand.fmu",
        ]


@pytest.mark.parametrize("kind", ["base", "massless", "drag", "counts"])
def test_every_file_is_valid_by_its_schema(models, tmp_path, kind):
    path = export_ssp(certain(replace(models[kind](), name="<\"&'> №5")), tmp_path / "rig.ssp", draws=1)
    system = read_ssd(str(path)).system
    assert [(c.name, c.kind) for c in system.connectors] == [
        ("F", "input"),
        *((name, "output") for name in ("x", "displacement", "velocity", "acceleration")),
    ]
    assert len(system.connections) == 5
    assert read_ssv(str(path), "resources/parameters/nominal.ssv").parameters
    with zipfile.ZipFile(path) as opened:
        for name in opened.namelist():
            tree = etree.fromstring(opened.read(name)) if name.endswith((".ssd", ".ssv")) else None
            if name.endswith(".ssd"):
                validate_tree(tree, "SystemStructureDescription.xsd")
                (inline,) = tree.iter(f"{SSV}ParameterSet")
                beside = "nominal" if name == "SystemStructure.ssd" else name.removesuffix(".ssd")
                other = etree.fromstring(opened.read(f"resources/parameters/{beside}.ssv"))
                assert [dict(element.attrib) for element in inline.iter()] == [
                    dict(element.attrib) for element in other.iter()
                ]
            elif name.endswith(".ssv"):
                validate_tree(tree, "SystemStructureParameterValues.xsd")
                sets = [element.get("name") for element in tree.iter(f"{SSV}Parameter")]
                assert sets == [f"rig.{parameter}" for parameter in models[kind]().parameters()]


@pytest.mark.parametrize("chosen", [None, "nominal", "draw_02"])
def test_a_run_of_the_system_is_a_run_of_the_fmu_with_these_parameters(archive, instances, models, chosen):
    values, given = models["base"]().values(), None
    if chosen is not None:
        given = read_ssv(str(archive), f"resources/parameters/{chosen}.ssv")
        values = {parameter.name.removeprefix("rig."): float(parameter.value) for parameter in given.parameters}
        assert (values == models["base"]().values()) == (chosen == "nominal")
    simulated = simulate_ssp(str(archive), stop_time=STOP, step_size=DT, parameter_set=given, input={"F": force})
    alone = instances().start(**values)
    expected = []
    for k in range(simulated.size):
        # FMPy hands an input on after the step: it arrives one step late
        alone.step(k * DT, DT, force((k - 1) * DT) if k else 0.0)
        expected.append(alone.get("x", "velocity"))
    assert np.max(np.abs(simulated["x"])) > 1e-4
    simulated = np.column_stack([simulated["rig.x"], simulated["rig.velocity"]])
    assert np.max(np.abs(simulated - expected) / np.max(np.abs(expected), axis=0)) < 1e-12


def test_draws_differ_in_their_response(archive):
    responses = []
    for name in ("nominal", "draw_01", "draw_02", "draw_03"):
        given = read_ssv(str(archive), f"resources/parameters/{name}.ssv")
        run = simulate_ssp(str(archive), stop_time=0.05, step_size=DT, parameter_set=given, input={"F": force})
        responses.append(run["x"][-1])
    assert len(set(responses)) == 4
    assert np.ptp(responses) < 0.02 * abs(responses[0])


def test_same_model_same_bytes(models, tmp_path):
    model = certain(models["drag"]())
    first = export_ssp(model, tmp_path / "a.ssp", draws=2).read_bytes()
    assert first == export_ssp(model, tmp_path / "b.ssp", draws=2).read_bytes()
    assert first != export_ssp(model, tmp_path / "c.ssp", draws=2, seed=1).read_bytes()


def test_without_a_covariance_the_nominal_system_alone_and_a_word_about_it(models, tmp_path):
    model = models["base"]()
    path = export_ssp(model, tmp_path / "rig.ssp")
    with zipfile.ZipFile(path) as opened:
        assert [name for name in opened.namelist() if "draw" in name] == []
        page = opened.read("documentation/index.html").decode()
    assert "holds no covariance" in page
    assert "holds no covariance" in (note(model) or "")
    assert note(model, 0) is None
    assert note(certain(model)) is None
    with pytest.raises(BadInput, match="--draws 0"):
        export_ssp(model, tmp_path / "b.ssp", draws=5)
    for wrong in (-1, MOST_DRAWS + 1):
        with pytest.raises(BadInput, match="between 0 and"):
            export_ssp(certain(model), tmp_path / "b.ssp", draws=wrong)
    assert not (tmp_path / "b.ssp").exists()


def test_the_page_has_a_cell_for_each_head(archive, models):
    lines = zipfile.ZipFile(archive).read("documentation/index.html").decode().splitlines()
    heads, first = ([line for line in lines if line.startswith(f"<tr><th>{name}</th>")] for name in ("set", "nominal"))
    assert heads[0].count("<th>") - 1 == first[0].count("<td>") == len(models["base"]().parameters())
