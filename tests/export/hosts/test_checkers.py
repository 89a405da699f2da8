"""What checks FMUs finds nothing in ours: FMPy's validator and the FMU Manipulation Toolbox, FMI 2.0 and 3.0."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from importlib.util import find_spec

import pytest

KINDS = ["base", "massless", "drag", "velocity", "acceleration", "volts", "counts"]


@pytest.fixture(scope="module")
def toolbox():
    """What ``fmutool -check`` says of an FMU and ends with; older ones end with 0 whatever they find."""
    if find_spec("fmu_manipulation_toolbox") is None:
        pytest.skip("fmu-manipulation-toolbox not installed")

    def check(fmu):
        program = "import sys; from fmu_manipulation_toolbox.cli.fmutool import fmutool; sys.exit(fmutool())"
        done = subprocess.run(
            [sys.executable, "-P", "-c", program, "-input", str(fmu), "-check"],
            cwd=fmu.parent,
            capture_output=True,
            text=True,
            check=False,
        )
        said = done.stdout + done.stderr
        return done.returncode, [line for line in said.splitlines() if line.startswith(("WARN", "ERROR", "CRIT"))], said

    return check


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("kind", KINDS)
def test_no_problem_is_found(fmu_of, toolbox, kind, version):
    from fmpy.validation import validate_fmu

    fmu = fmu_of(version, name=kind)
    status, problems, said = toolbox(fmu)
    assert (status, problems) == (0, [])
    assert f"compliant with FMI-{version}.0" in said
    assert validate_fmu(str(fmu)) == []


def test_a_python_fmu_passes_too(fmus, toolbox):
    status, problems, _ = toolbox(fmus("base", "python"))
    assert (status, problems) == (0, [])


@pytest.mark.parametrize(("old", "new"), [('causality="input"', 'causality="inout"'), (' start="0.27"', "")])
def test_a_problem_would_be_found(fmu_of, toolbox, tmp_path, old, new):
    with zipfile.ZipFile(fmu_of(2)) as good, zipfile.ZipFile(tmp_path / "bad.fmu", "w") as bad:
        for name in good.namelist():
            content = good.read(name)
            if name == "modelDescription.xml":
                assert old.encode() in content
                content = content.replace(old.encode(), new.encode())
            bad.writestr(name, content)
    _, problems, _ = toolbox(tmp_path / "bad.fmu")
    assert problems
