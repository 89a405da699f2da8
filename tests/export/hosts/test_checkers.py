"""What checks FMUs finds nothing in ours: FMPy's validator and the FMU Manipulation Toolbox, FMI 2.0 and 3.0."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from importlib.util import find_spec

import pytest
from dashpot.model.laws import LIBRARY

KINDS = ["base", "massless", "drag", "velocity", "acceleration", "volts", "counts"]


#: One start of Python for all that is to be checked.
PROGRAM = """
import sys
from fmu_manipulation_toolbox.cli.fmutool import fmutool
worst = 0
for fmu in sys.argv[1:]:
    sys.argv = ["fmutool", "-input", fmu, "-check"]
    try:
        worst = max(worst, fmutool() or 0)
    except SystemExit as end:
        worst = max(worst, end.code or 0)
sys.exit(worst)
"""


@pytest.fixture(scope="module")
def toolbox():
    """What ``fmutool -check`` says of FMUs and ends with; older ones end with 0 whatever they find."""
    if find_spec("fmu_manipulation_toolbox") is None:
        pytest.skip("fmu-manipulation-toolbox not installed")

    def check(*fmus):
        done = subprocess.run(
            [sys.executable, "-P", "-c", PROGRAM, *(str(fmu) for fmu in fmus)],
            cwd=fmus[0].parent,
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


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("whole", [False, pytest.param(True, marks=pytest.mark.long)], ids=["kinds", "library"])
def test_no_problem_is_found_with_any_law(law_fmu, toolbox, kinds, version, whole):
    effects = LIBRARY if whole else kinds
    status, problems, said = toolbox(*(law_fmu(version, effect) for effect in effects))
    assert (status, problems) == (0, [])
    assert said.count(f"compliant with FMI-{version}.0") == len(effects)


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
