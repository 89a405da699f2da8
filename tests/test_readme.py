"""The README's Python runs, and that on its exports and the program in C; its two commands exist; it stays short."""

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
PAGES = {page: (ROOT / page).read_text(encoding="utf-8") for page in ("README.md", "docs/control.md", "docs/fmu.md")}
BLOCKS = {page: re.findall(r"```python\n(.*?)```", text, re.DOTALL) for page, text in PAGES.items()}
PROGRAMS = re.findall(r"```c\n(.*?)```", PAGES["docs/fmu.md"], re.DOTALL)
#: Lines of two screens.
TWO_SCREENS = 110


def test_there_are_blocks_to_run():
    assert {page: len(blocks) for page, blocks in BLOCKS.items()} == dict.fromkeys(PAGES, 1)
    assert len(PROGRAMS) == 1


def test_it_fits_two_screens():
    assert len(README.splitlines()) <= TWO_SCREENS


@pytest.mark.parametrize("page", BLOCKS)
def test_the_block_runs(page, capsys):
    exec(compile(BLOCKS[page][0], page, "exec"), {})
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
