"""What all tests share: how the test process ends."""

from __future__ import annotations

import os
import sys

_status = 0


def pytest_sessionfinish(session, exitstatus):
    global _status
    _status = int(exitstatus)


def pytest_unconfigure(config):
    # PythonFMU's libraries stay in the process after their FMU is freed, and what they hold is torn down after Python
    # itself: the suspect of an abort that once followed a green summary. Only a run that used PythonFMU leaves early;
    # every other one ends in the ordinary way, so that damage done by the engine or the native FMU would show.
    if "pythonfmu" not in sys.modules:
        return
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(_status)
