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
    # itself; once in some twenty-five runs that ended in an abort behind a green summary. The verdict is in, so leave.
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(_status)
