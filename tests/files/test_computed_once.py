"""A value is computed once, and no fork finds a lock that nobody will free."""

from __future__ import annotations

import os
import signal
import threading
from dataclasses import dataclass

import pytest
from dashpot.files.computed_once import computed_once


@dataclass(frozen=True)
class Owner:
    calls: list
    wait: threading.Event | None = None

    @computed_once
    def value(self) -> int:
        """Its docstring."""
        self.calls.append(1)
        if self.wait is not None:
            self.wait.wait()
        return 7


def test_it_is_computed_once_for_each_object():
    one, other = Owner([]), Owner([])
    assert (one.value, one.value, other.value) == (7, 7, 7)
    assert len(one.calls) == len(other.calls) == 1
    assert Owner.__dict__["value"].__doc__ == "Its docstring."


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no forks")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_child_computes_it_while_a_thread_of_its_parent_does():
    free = threading.Event()
    busy = Owner([], free)
    thread = threading.Thread(target=lambda: busy.value)
    thread.start()
    while not busy.calls:
        pass
    child = os.fork()
    if child == 0:
        signal.alarm(20)  # which ends it where it waits
        os._exit(Owner([]).value)
    _, status = os.waitpid(child, 0)
    free.set()
    thread.join()
    assert os.waitstatus_to_exitcode(status) == 7
