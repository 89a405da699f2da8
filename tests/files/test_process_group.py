"""What a process started ends with it, also where it is over itself."""

from __future__ import annotations

import os
import select
import subprocess
import sys

import pytest
from dashpot.files import process_group

_STARTS_ANOTHER = """
import subprocess, sys, time
subprocess.Popen([sys.executable, "-c", "import time; print('begun', flush=True); time.sleep(600)"])
time.sleep(float(sys.argv[1]))
"""


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="this system has no groups of processes")
@pytest.mark.parametrize("seconds", ["600", "0"], ids=["it runs", "it is over"])
def test_what_it_started_ends_with_it(seconds: str) -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", _STARTS_ANOTHER, seconds], stdout=subprocess.PIPE, start_new_session=True
    )
    assert process.stdout is not None
    with process.stdout as said:
        assert said.readline() == b"begun\n"
        if seconds == "0":
            process.wait()
        assert not select.select([said], [], [], 0.2)[0]  # held open by what it started
        process_group.end(process)
        assert select.select([said], [], [], 10.0)[0]
        assert said.read() == b""
    assert process.returncode == (0 if seconds == "0" else -9)


def test_one_that_is_over_with_all_it_started_is_only_waited_for() -> None:
    process = subprocess.Popen([sys.executable, "-c", ""], start_new_session=True)
    process.wait()
    process_group.end(process)
    assert process.returncode == 0
