"""Laws of other installed packages: the example's, and broken ones, as distributions on the path."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path

import dashpot
import pytest
from dashpot.errors import BadInput
from dashpot.model import library
from dashpot.model.laws import BASE
from dashpot.model.library import KNOWN, find

PACKAGE = Path(dashpot.__file__).parent / "examples" / "law_package"
TAKEN = "from dataclasses import replace\nfrom dashpot.model.laws.quadratic_drag import LAW\n"
NAME = "eddy-current-brake"


def distribution(folder, name, points, **modules):
    """What pip leaves of a package: its modules, and the folder that names its entry points."""
    told = folder / f"{name.replace('-', '_')}-1.0.dist-info"
    told.mkdir(parents=True)
    (told / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    lines = [f"[{library.GROUP}]", *(f"{key} = {value}" for key, value in points.items())]
    (told / "entry_points.txt").write_text("\n".join(lines) + "\n")
    for module, text in modules.items():
        (folder / f"{module}.py").write_text(text, encoding="utf-8")
    return folder


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """Installs packages, and takes them and their laws away again."""
    known, modules = dict(KNOWN), set(sys.modules)

    def install(name, points, **texts):
        monkeypatch.syspath_prepend(str(distribution(tmp_path / name, name, points, **texts)))
        forget()

    def forget():
        library.take_installed_laws.cache_clear()
        library._loaded.cache_clear()

    yield install
    for law in set(KNOWN) - set(known):
        del KNOWN[law]
    for module in set(sys.modules) - modules:
        if module.startswith("dashpot_"):
            del sys.modules[module]
    forget()


@pytest.fixture
def example(installed):
    project = tomllib.loads((PACKAGE / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    (module,) = PACKAGE.glob("*.py")
    installed(project["name"], project["entry-points"]["dashpot.laws"], **{module.stem: module.read_text("utf-8")})


def test_the_law_of_the_example_is_found_and_simulated(example):
    assert NAME not in KNOWN
    law = find(NAME)
    assert law.parameters[0].name == "peak"
    values = {"mass": 1.0, "omega0": 60.0, "cubic": 0.0, "preload": 0.0, "viscous": 0.1, "dry": 0.0}
    model = dashpot.Model.from_values(values | {f"{NAME}.peak": 0.9, f"{NAME}.speed": 0.3}, laws=[NAME])
    small, large = model.backbone([1e-6, 0.05]).damping_ratio
    assert small == pytest.approx((0.1 + 2 * 0.9 / 0.3) / 120.0, rel=1e-3)  # the slope at rest is a viscous damper's
    assert large < 0.5 * small
    decay = model.simulate(initial=(8e-3, 0.0), seconds=4.0, fs=500.0)
    assert abs(decay.response[-200:]).max() < 1e-4


def test_a_fresh_python_has_it_by_name(example, tmp_path):
    """As a model file names it, with nothing said of where it comes from."""
    program = f"from dashpot.model.library import find; print(find({NAME!r}).path)"
    folders = [str(folder) for folder in tmp_path.iterdir()]
    line = [sys.executable, "-P", "-c", f"import sys; sys.path[:0] = {folders!r}\n{program}"]
    assert subprocess.run(line, capture_output=True, text=True, check=True).stdout == "dissipation\n"


def test_the_doctor_names_it(example):
    from dashpot.face.doctor import _laws

    (finding,) = _laws()
    assert finding.good
    assert finding.what == "dashpot-eddy-current-brake (dashpot.laws: eddy-current-brake)"
    assert finding.words == f"laws: {NAME}"


@pytest.mark.parametrize(
    ("point", "text", "said"),
    [
        ("dashpot_broken:LAW", "1 / 0\n", "cannot be imported .ZeroDivisionError"),
        ("dashpot_broken:ABSENT", "", "cannot be imported .AttributeError"),
        ("dashpot_broken:LAW", "LAW = 3\n", "is a int without a Law"),
        ("dashpot_broken", "from dashpot.model.laws.quadratic_drag import LAW\n", "is a module without a Law"),
        ("dashpot_broken", f"{TAKEN}LAW = replace(LAW)\n", "there is one of that name already"),
    ],
)
def test_a_broken_package_is_told_and_spoils_nothing(installed, point, text, said):
    before = dict(KNOWN)
    installed("broken", {"broken": point}, dashpot_broken=text)
    (problem,) = library.take_installed_laws()
    assert before == KNOWN
    with pytest.raises(BadInput, match=said):
        find("quadratic-darg")
    assert "uninstall it" in problem
    assert find("quadratic-drag") is before["quadratic-drag"]


def test_a_module_or_several_laws_may_be_named(installed):
    text = (PACKAGE / "dashpot_eddy_current_brake.py").read_text(encoding="utf-8")
    more = "\nfrom dataclasses import replace\nSECOND = replace(LAW, name='second-brake')\nBOTH = [LAW, SECOND]\n"
    installed("several", {"several": "dashpot_several:BOTH"}, dashpot_several=text + more)
    assert library.take_installed_laws() == ()
    assert {NAME, "second-brake"} <= set(KNOWN)
    assert not {law.name for law in BASE} & {"second-brake"}
