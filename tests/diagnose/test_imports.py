"""What a diagnosis loads: nothing that takes longer to import than it does for the answer."""

from __future__ import annotations

import subprocess
import sys

import pytest

PROGRAM = """
import sys
from dashpot import diagnose, identify
from dashpot.examples.virtual_recording import recording_of
import dashpot.report.diagnosis_page

decay = recording_of(begin=(9e-3, 0.0), seconds=4.0, noise=2e-6, name="decay")
found = identify([decay])
diagnose(found.oscillator, [decay])
print(*[name for name in ("scipy.signal", "scipy.stats", "matplotlib") if name in sys.modules])
"""


@pytest.mark.long
def test_a_plain_decay_is_diagnosed_without_what_is_slow_to_import(tmp_path):
    run = subprocess.run(
        [sys.executable, "-P", "-c", PROGRAM], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert run.stdout.split() == []
