"""A library that breaks off or never ends is a sentence, not the end of this process."""

from __future__ import annotations

import sys

import pytest
from dashpot.errors import BadInput
from dashpot.recording.formats import apart


@pytest.mark.skipif(sys.platform == "win32", reason="of POSIX")
@pytest.mark.parametrize(
    ("program", "limit", "says"),
    [
        ("import os; os.abort()", 60.0, "cannot be read as MAT, the library that reads it broke off"),
        ("import time; time.sleep(60)", 0.3, "was read as MAT for 0 s without an end"),
    ],
)
def test_how_the_process_may_end(monkeypatch, program, limit, says):
    monkeypatch.setattr(apart, "_PROGRAM", program)
    monkeypatch.setattr(apart, "_SECONDS", limit)
    with pytest.raises(BadInput, match=says):
        apart.read_apart("mat", "MAT", "rec.mat", b"", 1.0)
