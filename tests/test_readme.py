"""The README's Python and C blocks run, and its two commands exist."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from dashpot.examples.truth import TRUTH
from dashpot.export import export
from dashpot.model import Oscillator
from dashpot.simulate.compiler import find_compiler

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
PROGRAMS = re.findall(r"```c\n(.*?)```", README, re.DOTALL)


def test_there_are_blocks_to_run():
    assert len(BLOCKS) == 3
    assert len(PROGRAMS) == 1


@pytest.mark.parametrize("block", BLOCKS, ids=["identify", "casadi", "ssp"])
def test_the_block_runs(block, capsys):
    exec(compile(block, "README.md", "exec"), {})
    assert capsys.readouterr().out.strip()


def test_the_program_in_c_runs(tmp_path):
    compiler = find_compiler()
    assert compiler is not None
    export(Oscillator.from_values(TRUTH, name="rig"), tmp_path / "rig.c")
    (tmp_path / "main.c").write_text(PROGRAMS[0], encoding="utf-8")
    strict = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"]
    subprocess.run([compiler, *strict, "main.c", "rig.c", "-o", "program", "-lm"], cwd=tmp_path, check=True)
    said = subprocess.run([tmp_path / "program"], capture_output=True, text=True, check=True).stdout
    stiffness = TRUTH["omega0"] ** 2 * TRUTH["mass"]
    assert said.endswith(" m\n")
    assert 0.3 / stiffness < float(said.split()[0]) < 1.0 / stiffness  # a slow ramp to 1 N, stiffened and preloaded


def test_the_two_commands_are_targets():
    targets = re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    for command in re.findall(r"^make (\w+)", README, re.MULTILINE):
        assert command in targets
