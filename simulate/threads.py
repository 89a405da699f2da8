"""The threads of a process, by the number of its cores: the core, numpy and scipy release the interpreter's lock.

A forked process has none of its parent's threads, and begins with a set of its own.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from functools import cache


@cache
def pool() -> ThreadPoolExecutor:
    """One set for all searches of the process."""
    return ThreadPoolExecutor(max_workers=os.cpu_count() or 1)


if hasattr(os, "register_at_fork"):  # which Windows lacks, as it lacks forks
    os.register_at_fork(after_in_child=pool.cache_clear)
