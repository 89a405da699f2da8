"""The sources inside an FMU are all that another machine needs: FMPy compiles them there with CMake."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from dashpot.export.platforms import own_platform
from dashpot.simulate.force import straight_lines
from dashpot.verify.fmu_run import FmuRun


@pytest.mark.parametrize("version", [pytest.param(2, marks=pytest.mark.long), 3])
def test_fmpy_compiles_it(fmu_of, tmp_path, version):
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    if shutil.which("cmake", path=path) is None:
        pytest.skip("cmake is not installed")
    made = tmp_path / "rig.fmu"
    own = own_platform()
    folder = f"binaries/{own.fmi2 if version == 2 else own.fmi3}/"
    with zipfile.ZipFile(fmu_of(version)) as old, zipfile.ZipFile(made, "w") as bare:
        assert any(name.startswith(folder) for name in old.namelist())
        for name in old.namelist():
            if not name.startswith("binaries"):
                bare.writestr(name, old.read(name))
    done = subprocess.run(
        [sys.executable, "-P", "-m", "fmpy", "compile", str(made)],
        env={**os.environ, "PATH": path},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    with zipfile.ZipFile(made) as archive:
        assert any(name.startswith(folder) and name.endswith(own.suffix) for name in archive.namelist())
    force = straight_lines(np.sin(np.arange(400) * 0.07), 1e-3)
    initial = np.array([1e-3, 0.0])
    with FmuRun(fmu_of(version)) as ours, FmuRun(made) as theirs:
        expected = ours.record(force, 400, 1e-3, initial)
        assert theirs.record(force, 400, 1e-3, initial) == pytest.approx(expected, abs=1e-12 * np.max(np.abs(expected)))
