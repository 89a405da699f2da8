"""The threads that simulate: the core releases the interpreter's lock."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from functools import cache


@cache
def pool() -> ThreadPoolExecutor:
    """One set for all searches of the process."""
    return ThreadPoolExecutor(max_workers=os.cpu_count() or 1)
