"""What the commands and the calls of Python share."""

from __future__ import annotations

import math

import pytest
from dashpot.errors import BadInput
from dashpot.face.workflow import SECONDS, seconds_allowed


@pytest.mark.parametrize(
    ("asked", "said", "seconds"),
    [
        (None, "", 60.0),
        (None, " 90 ", 90.0),
        (None, "inf", math.inf),
        (7.0, "90", 7.0),
        (math.inf, "nonsense", math.inf),
    ],
)
def test_a_diagnosis_may_take_what_was_asked_then_what_the_environment_says_then_a_minute(
    monkeypatch, asked, said, seconds
):
    monkeypatch.setenv(SECONDS, said)
    assert seconds_allowed(asked) == seconds


@pytest.mark.parametrize("said", ["a while", "0", "-3", "nan"])
def test_an_environment_that_says_no_time_is_refused(monkeypatch, said):
    monkeypatch.setenv(SECONDS, said)
    with pytest.raises(BadInput, match=f"DASHPOT_SECONDS is '{said}'"):
        seconds_allowed(None)
