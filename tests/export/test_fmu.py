"""What is inside an FMU: description, units, structure, sources; names of any kind; the same model, the same bytes."""

from __future__ import annotations

import ctypes
import subprocess
import xml.etree.ElementTree as ElementTree
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest
from dashpot.errors import BadInput, ToolchainMissing
from dashpot.export import export
from dashpot.export.description import describe_fmu, identifier_of
from dashpot.export.facts import Facts
from dashpot.export.fmu import _in_a_message, choose_backend, export_fmu, fmu_sources
from dashpot.export.platforms import PLATFORMS, own_platform, parse_platforms
from dashpot.model import Parameter, Range
from dashpot.simulate.compiler import find_compiler
from fmpy import read_model_description
from fmpy.validation import validate_fmu

BACKENDS = ["native", "python"]
KINDS = ["base", "massless", "drag", "velocity", "acceleration", "volts", "counts"]
NASTY = [
    '"; system("x"); //',
    "<evil a='1'>&amp;</evil>",
    "${x} {{ 7*7 }} %s %n",
    "a\nb\tc\x00\x1b\ud800\ufffe",
    "../../etc/passwd",
    "",
    "Prüfstand №5",
    "int",
    "CON",
    "x" * 500,
    '*/ #error "no"',
]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("kind", KINDS)
def test_validator_finds_no_problem(fmus, kind, backend):
    assert validate_fmu(str(fmus(kind, backend))) == []


def test_variables_carry_units_descriptions_and_start_values_to_the_last_bit(models):
    oscillator = models["drag"]()
    # a value that six, and even sixteen, digits would not bring back
    odd = 0.1 + 0.2
    oscillator = oscillator.with_parameters({"dry": Parameter(odd, 1e-3, "m/s2")})
    description = describe_fmu(Facts(oscillator))
    by_name = {v.name: v for v in description.variables}
    assert list(by_name)[:5] == ["F", "x", "displacement", "velocity", "acceleration"]
    assert set(oscillator.parameters()) < set(by_name)
    assert float(by_name["dry"].start_text) == odd
    assert by_name["quadratic-drag.coefficient"].unit == "1/m"
    units = {n: by_name[n].unit for n in ("F", "x", "velocity", "x0", "v0", "max_step")}
    assert units == {"F": "N", "x": "m", "velocity": "m/s", "x0": "m", "v0": "m/s", "max_step": "s"}
    assert all(v.description for v in description.variables)
    assert {v.variability for n, v in by_name.items() if n in oscillator.parameters()} == {"tunable"}
    assert f" {odd!r}, " in fmu_sources(Facts(oscillator))[0]["variables.h"]


@pytest.mark.parametrize("backend", BACKENDS)
def test_description_as_an_importer_reads_it(fmus, models, backend):
    md = read_model_description(str(fmus("base", backend)))
    assert md.fmiVersion == "2.0"
    assert (md.modelExchange is None) is (backend == "python")
    variables = md.modelVariables
    assert len({v.valueReference for v in variables}) == len(variables)
    assert {v.type for v in variables} == {"Real"}
    inputs = [v.name for v in variables if v.causality == "input"]
    outputs = [v.name for v in variables if v.causality == "output"]
    assert inputs == (["F"] if backend == "native" else ["F", "F_rate"])
    ranged = [] if backend == "python" else ["amplitude", "outside_range"]
    assert outputs == ["x", "displacement", "velocity", "acceleration", "energy", "dissipated_power", *ranged]
    start = {v.name: float(v.start) for v in variables if v.causality == "parameter"}
    assert {name: start[name] for name in models["base"]().values()} == models["base"]().values()
    assert md.coSimulation.canInterpolateInputs is (backend == "native")
    assert md.coSimulation.canGetAndSetFMUstate
    assert md.coSimulation.canSerializeFMUstate
    assert md.coSimulation.canHandleVariableCommunicationStepSize
    assert not md.coSimulation.canBeInstantiatedOnlyOncePerProcess
    assert md.coSimulation.needsExecutionTool is (backend == "python")
    given = md.defaultExperiment
    assert (given.startTime, given.stopTime, given.stepSize) == ("0.0", "1.6", "0.0008")
    assert float(given.tolerance) == 1e-8


def test_friction_has_a_least_value_unless_the_model_breaks_it(models):
    def least(value: float) -> float | None:
        model = models["base"]().with_parameters({"dry": Parameter(value, 1e-3, "m/s2")})
        return next(v.min for v in describe_fmu(Facts(model)).variables if v.name == "dry")

    assert least(0.015) == least(0.0) == 0.0
    assert least(-0.015) is None


def test_names_of_variables_stand_in_the_c_table_as_a_log_can_have_them(models):
    header = fmu_sources(Facts(models["drag"]()))[0]["variables.h"]
    assert '"quadratic-drag.coefficient"},' in header
    assert '"der(velocity)"},' in header
    assert _in_a_message('a%s"\\\n') == "a_s___"


def test_units_have_their_base_exponents(fmus):
    def bases(kind):
        md = read_model_description(str(fmus(kind, "native")))
        return {
            u.name: u.baseUnit and {b: e for b in ("kg", "m", "s", "A", "rad") if (e := getattr(u.baseUnit, b))}
            for u in md.unitDefinitions
        }

    assert bases("base")["1/(m2.s2)"] == {"m": -2, "s": -2}
    assert bases("base")["N"] == {"kg": 1, "m": 1, "s": -2}
    assert bases("massless")["rad/s2"] == {"rad": 1, "s": -2}
    assert bases("volts")["V/s"] == {"kg": 1, "m": 2, "s": -4, "A": -1}
    assert bases("counts")["counts"] is None  # nothing is known of counts, so nothing is said


@pytest.mark.parametrize(
    ("kind", "response"),
    [("base", ["displacement"]), ("velocity", ["velocity"]), ("acceleration", ["F", "displacement", "velocity"])],
)
def test_structure_tells_what_an_output_depends_on(fmus, kind, response):
    """In model exchange outputs depend on the states; of inputs only an acceleration passes one straight on."""
    md = read_model_description(str(fmus(kind, "native")))
    depends = {u.variable.name: [v.name for v in u.dependencies] for u in md.outputs}
    initially = {u.variable.name: [v.name for v in u.dependencies] for u in md.initialUnknowns}
    assert (
        depends.items()
        >= {
            "x": response,
            "displacement": ["displacement"],
            "velocity": ["velocity"],
            "acceleration": ["F", "displacement", "velocity"],
        }.items()
    )
    assert initially["displacement"] == ["x0"]
    assert initially["velocity"] == ["v0"]
    parameters = {"mass", "omega0", "cubic", "preload", "viscous", "dry", "payload"}
    assert set(initially["acceleration"]) == {"F", "x0", "v0", "smoothing"} | parameters


def test_massless_input_is_said_to_be_a_specific_force(fmus):
    md = read_model_description(str(fmus("massless", "native")))
    assert md.modelVariables[0].unit == "rad/s2"
    assert "per unit mass" in md.modelVariables[0].description
    assert "mass" not in [v.name for v in md.modelVariables]


def test_archive_holds_sources_and_documentation(fmus, models, tmp_path):
    oscillator = replace(
        models["base"](),
        name="<b>stand</b>",
        cubic=Parameter(4.6e5, 5.2e3, "1/(m2.s2)"),
        amplitude=Range(2e-4, 9e-3, "m"),
    )
    with zipfile.ZipFile(export_fmu(oscillator, tmp_path / "rig.fmu")) as archive:
        names = archive.namelist()
        page = archive.read("documentation/index.html").decode()
    own = own_platform()
    assert f"binaries/{own.fmi2}/b_stand_b{own.suffix}" in names
    assert f"runs on {own.words}" in page
    assert {"sources/all.c", "sources/law.c", "sources/engine.c", "sources/variables.h"} < set(names)
    assert names == sorted(names)
    assert "&lt;b&gt;stand&lt;/b&gt;" in page
    assert "<b>stand" not in page
    assert "5.2·10³" in page
    assert "amplitude from 0.2 to 9 mm" in page


@pytest.mark.parametrize("backend", BACKENDS)
def test_same_model_same_bytes(models, tmp_path, monkeypatch, backend):
    first = export_fmu(models["base"](), tmp_path / "a.fmu", backend=backend).read_bytes()
    monkeypatch.setenv("DASHPOT_CACHE", str(tmp_path / "another cache"))
    second = export_fmu(models["base"](), tmp_path / "b.fmu", backend=backend).read_bytes()
    assert first == second
    other = models["base"]().with_parameters({"dry": Parameter(0.016, None, "m/s2")})
    third = export_fmu(other, tmp_path / "c.fmu", backend=backend)
    assert third.read_bytes() != first
    assert read_model_description(str(third)).guid != read_model_description(str(tmp_path / "a.fmu")).guid


@pytest.mark.parametrize("name", NASTY)
def test_no_text_of_a_model_reaches_c_and_no_name_breaks_anything(models, tmp_path, name):
    plain, own = fmu_sources(Facts(models["base"]()))
    nasty, guid = fmu_sources(Facts(replace(models["base"](), name=name)))
    changed = {file for file in plain if plain[file] != nasty[file]}
    assert changed <= {"variables.h"}  # the GUID alone
    assert nasty["variables.h"].replace(guid, "") == plain["variables.h"].replace(own, "")
    for backend in BACKENDS if name in NASTY[:3] else ["python"]:
        path = export_fmu(replace(models["base"](), name=name), tmp_path / f"{backend}.fmu", backend=backend)
        assert validate_fmu(str(path)) == []
        with zipfile.ZipFile(path) as archive:
            assert all(".." not in entry and entry.isascii() for entry in archive.namelist())
            assert ElementTree.fromstring(archive.read("modelDescription.xml")).get("modelName")


@pytest.mark.parametrize(
    ("name", "identifier"),
    [
        ("technion-rig", "technion_rig"),
        ("5th stand", "model_5th_stand"),
        ("", "oscillator"),
        ("№", "oscillator"),
        ("int", "int_model"),
        ("CON", "CON_model"),
        ('"; system("x"); //', "system_x"),
    ],
)
def test_identifier_is_one_in_c_and_a_file_name_anywhere(name, identifier):
    assert identifier_of(name) == identifier


def test_every_symbol_of_fmi_2_is_there(fmus, tmp_path):
    from fmpy import extract, fmi2

    folder = Path(extract(str(fmus("base", "native")), unzipdir=str(tmp_path)))
    library = ctypes.CDLL(str(next((folder / "binaries").rglob("stand.*"))))
    classes = (fmi2._FMU2, fmi2.FMU2Slave, fmi2.FMU2Model)
    wanted = {name for c in classes for name in vars(c) if name.startswith("fmi2")}
    assert len(wanted) > 40
    assert [name for name in sorted(wanted) if not hasattr(library, name)] == []
    assert not hasattr(library, "dp_advance")  # two models in one process must not meet


def test_our_c_compiles_without_a_warning(models, tmp_path):
    compiler = find_compiler()
    if compiler is None:
        pytest.skip("there is no C compiler")
    sources, _ = fmu_sources(Facts(models["drag"]()))
    for name, text in sources.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wshadow", "-pedantic", "-fsyntax-only"]
    run = subprocess.run([compiler, *flags, "all.c"], cwd=tmp_path, capture_output=True, text=True, check=False)
    ours = [line for line in run.stderr.splitlines() if "warning:" in line and not line.startswith("law.c")]
    assert run.returncode == 0
    assert ours == []


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_value_that_is_not_finite_is_refused_and_nothing_written(models, tmp_path, backend):
    broken = models["base"]().with_parameters({"cubic": Parameter(float("nan"), None, "1/(m2.s2)")})
    with pytest.raises(BadInput, match="'cubic' is nan"):
        export_fmu(broken, tmp_path / "rig.fmu", backend=backend)
    assert list(tmp_path.iterdir()) == []


def test_unknown_backend_is_refused(models, tmp_path):
    with pytest.raises(BadInput, match="'native' or 'python'"):
        export_fmu(models["base"](), tmp_path / "rig.fmu", backend="java")


# Which back-end an export takes, and what it says where it cannot take the native one.


def test_what_is_asked_for_is_taken():
    assert choose_backend(None) == "native"
    assert choose_backend("native") == "native"
    assert choose_backend("python") == "python"


def test_without_a_compiler_the_model_runs_in_python_and_that_is_said(no_compiler, models, tmp_path):
    said = []
    (path,) = export(models["base"](), tmp_path / "rig.fmu", progress=said.append)
    (sentence,) = said
    for word in ("no C compiler", "Python with the package casadi", "slower", "co-simulation only", "pip install"):
        assert word in sentence
    with zipfile.ZipFile(path) as archive:
        assert "resources/step.casadi" in archive.namelist()
        assert "needs Python with the package casadi" in archive.read("documentation/index.html").decode()


def test_without_a_listener_it_is_a_warning(no_compiler):
    with pytest.warns(UserWarning, match="runs its model in Python"):
        assert choose_backend(None) == "python"


@pytest.mark.parametrize("asked", [{"backend": "native"}, {"platforms": parse_platforms("all")}])
def test_what_was_asked_for_by_name_is_not_replaced(no_compiler, models, tmp_path, asked):
    with pytest.raises(ToolchainMissing, match="no C compiler was found"):
        export(models["base"](), tmp_path / "rig.fmu", **asked)
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_is_refused():
    with pytest.raises(BadInput, match="'native' or 'python'"):
        choose_backend("java")
    with pytest.raises(BadInput, match="leave the platforms out"):
        choose_backend("python", PLATFORMS)


@pytest.mark.parametrize(
    ("name", "asked", "words"),
    [
        ("rig.fmu", {"version": 4}, "use 2 or 3"),
        ("rig.fmu", {"version": 3, "backend": "python"}, "leave out --fmi 3"),
        ("rig.ssp", {"version": 3}, "leave out --fmi 3"),
    ],
)
def test_a_version_that_cannot_be_is_refused(models, tmp_path, name, asked, words):
    with pytest.raises(BadInput, match=words):
        export(models["base"](), tmp_path / name, **asked)
    assert list(tmp_path.iterdir()) == []


def test_a_platform_that_cannot_be_built_here_is_refused_with_how_to_have_it(no_zig, models, tmp_path, monkeypatch):
    monkeypatch.setattr("dashpot.simulate.compiler.find_compiler", lambda: "cc")
    others = [p for p in PLATFORMS if p != own_platform()]
    with pytest.raises(ToolchainMissing, match=rf"no compiler for {others[0].name}.*pip install"):
        export(models["base"](), tmp_path / "rig.fmu", platforms=PLATFORMS)
    assert list(tmp_path.iterdir()) == []
