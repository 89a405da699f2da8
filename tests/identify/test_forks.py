"""A process that is begun from one that has identified, in whatever way, identifies as well."""

from __future__ import annotations

import multiprocessing
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = Path(__file__).parent / "forks.py"
#: A hang is told from work: the work takes seconds.
PATIENCE = 240


@pytest.mark.parametrize("kind", [*multiprocessing.get_all_start_methods(), "busy"])
def test_another_process_finds_the_same(kind):
    if kind == "busy" and "fork" not in multiprocessing.get_all_start_methods():
        pytest.skip("this system has no forks")
    line = [sys.executable, "-P", str(PROGRAM), kind]
    run = subprocess.run(line, capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert run.stdout == "1\n", run.stderr
