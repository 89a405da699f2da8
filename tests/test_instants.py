"""Commands that are ended, or meet a full disk, at any instant: the folder is the one before or the one asked for."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.export.fmu import export_fmu
from dashpot.model import Oscillator
from dashpot.model.file import save

PROGRAM = Path(__file__).parent / "interrupted.py"
pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="of Linux")
#: Set to a number, so many times as many instants are tried, also such at which memory ends.
FUZZ = "DASHPOT_FUZZ"
#: Each with how many instants `make test` tries, and `make test-all`: fewer of those that take long.
COMMANDS = {
    "show rig.yaml --json": (3, 15),
    "look sweep.csv decay.csv": (0, 3),
    "linearise rig.yaml --amplitude 1e-3": (0, 3),
    "compare old.yaml known.yaml": (0, 3),
    "watch old.yaml known.yaml --report new.html": (0, 3),
    "simulate rig.yaml sweep.csv -o out.csv": (0, 5),
    "export rig.yaml old.c new/a.casadi": (5, 15),
    "export rig.yaml a.mjcf b.urdf": (0, 3),
    "export rig.yaml a.fmu --platform linux64": (0, 3),
    "export rig.yaml a.ssp --platform linux64": (0, 3),
    "verify rig.fmu sweep.csv --json out.json --report out.html": (0, 3),
    "hilbert decay.csv -o curves": (0, 3),
    "identify decay.csv -o old.yaml --report new.html": (0, 3),
    "diagnose rig.yaml sweep.csv -o found": (0, 3),
    "batch fleet.yaml -o kept --jobs 1": (0, 3),
    "paper -o pages": (0, 0),
    "demo -o story": (0, 0),
}


@pytest.fixture(scope="session")
def there(tmp_path_factory, recorded):
    """Inputs, and what a former command left."""
    folder = tmp_path_factory.mktemp("there")
    oscillator = Oscillator.from_values(TRUTH, name="rig")
    save(oscillator, folder / "rig.yaml")
    for name in ("old", "known"):
        errors = {key: replace(p, std=0.01 * abs(p.value)) for key, p in oscillator.parameters().items()}
        save(oscillator.with_parameters(errors), folder / f"{name}.yaml")
    export_fmu(oscillator, folder / "rig.fmu")
    made = {"sweep": recorded(TRUTH, sweep=(1.5, 6.0, 14.0)), "decay": recorded(TRUTH, begin=(8e-3, 0.0))}
    for name, record in made.items():
        columns = [record.time, *([] if record.force is None else [record.force]), record.response]
        header = "time_s,x_m" if record.force is None else "time_s,force_N,x_m"
        np.savetxt(folder / f"{name}.csv", np.column_stack(columns), "%.9g", ",", header=header, comments="")
    (folder / "fleet.yaml").write_text(
        "format: dashpot-fleet/1\ndefaults: {mass: 0.27, report: false, diagnose: never, max-left: 3x}\n"
        "rigs: [{name: a, recordings: decay.csv}, {name: b, recordings: sweep.csv}]\n"
    )
    subprocess.run([sys.executable, "-P", "-m", "dashpot", "export", "rig.yaml", "old.c"], cwd=folder, check=True)
    return folder


LANES = [
    pytest.param(command, count, id=f"{command.split()[0]} {count}", marks=marks)
    for command, counts in COMMANDS.items()
    for count, marks in zip(counts, ((), pytest.mark.long), strict=True)
    if count
]


def disturbed(there, command, count, **environment):
    run = subprocess.run(
        [sys.executable, "-P", str(PROGRAM), str(there), "1", str(count), *command.split()],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, **environment},
    )
    assert run.returncode == 0, run.stderr[-2000:]
    return json.loads(run.stdout)


@pytest.mark.parametrize(("command", "count"), LANES)
def test_the_folder_is_the_one_before_or_the_one_asked_for(there, command, count):
    count = round(count * float(os.environ.get(FUZZ) or 1.0))
    result = disturbed(there, command, count)
    assert not result["faults"], "\n".join(result["faults"])
    assert result["usual"] in (0, 1)
    assert sum(result["ends"].values()) == count


@pytest.mark.skipif(not os.environ.get(FUZZ), reason=f"whether an instant falls between two files is chance: {FUZZ}=1")
@pytest.mark.long
def test_files_that_are_not_written_aside_are_found(there):
    faults = disturbed(there, "export rig.yaml old.c new/a.casadi", 100, CARELESS="1")["faults"]
    assert any("SIGKILL" in fault and "the folder is neither" in fault for fault in faults)
