"""What reads untrusted bytes, under a fuzzer led by the code that it reaches: a result or a sentence, nothing else."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = Path(__file__).parent / "guided.py"
#: Set to a number, so many times as many inputs are tried, others each time.
FUZZ = "DASHPOT_FUZZ"
TARGETS = ("text", "wav", "npz", "model", "fleet", "words")
pytestmark = pytest.mark.skipif(not importlib.util.find_spec("atheris"), reason="atheris is not installed: .[fuzz]")


def guided(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    line = [sys.executable, "-P", str(PROGRAM), *arguments]
    seeded = {**os.environ, "PYTHONHASHSEED": "0", **environment}  # the order of sets is chance too
    return subprocess.run(line, capture_output=True, text=True, errors="replace", check=False, env=seeded)


@pytest.mark.parametrize("count", [pytest.param(500, id="a taste"), pytest.param(20_000, marks=pytest.mark.long)])
@pytest.mark.parametrize("target", TARGETS)
def test_whatever_the_bytes_are_there_is_a_result_or_a_sentence(target, count):
    more = float(os.environ.get(FUZZ) or 0.0)
    seed = int.from_bytes(os.urandom(3)) + 1 if more else 1
    done = guided(target, str(round(count * (more or 1.0))), str(seed))
    assert done.returncode == 0, f"{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
    assert "Done " in done.stderr


def test_a_fault_is_found():
    """Where a sentence is taken for a fault, as it would be where one reads of the wrong kind."""
    done = guided("model", "500", "1", GUIDED_STRICT="1")
    assert done.returncode != 0
    assert "BadInput" in done.stdout + done.stderr
