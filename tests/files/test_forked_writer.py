"""Work in a child process: its faults arrive, signals wait for it, and an end by force does not reach it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time

import pytest
from dashpot.errors import BadInput, DashpotError
from dashpot.files.forked_writer import run_in_child, signals_held

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="of Linux")


class Unpicklable(Exception):
    def __reduce__(self):
        raise TypeError


@pytest.mark.parametrize(
    ("problem", "arrives"),
    [
        (BadInput("a: b"), BadInput),
        (OSError(28, "No space left on device", "x"), OSError),
        (KeyboardInterrupt(), KeyboardInterrupt),
        (Unpicklable("odd"), RuntimeError),
    ],
)
def test_what_it_raises_arrives(problem, arrives):
    def work():
        raise problem

    with pytest.raises(arrives) as raised:
        run_in_child(work)
    assert str(problem) in str(raised.value)


def test_an_end_of_the_work_itself_is_said():
    with pytest.raises(DashpotError, match="ended by force"):
        run_in_child(lambda: os.kill(os.getpid(), signal.SIGKILL))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_waits_for_it(tmp_path, number):
    def interrupt(*_):
        raise KeyboardInterrupt

    def work():
        os.kill(os.getppid(), number)
        time.sleep(0.1)
        (tmp_path / "done").touch()

    before = signal.signal(number, interrupt)
    try:
        with pytest.raises(KeyboardInterrupt):
            run_in_child(work)
    finally:
        signal.signal(number, before)
    assert (tmp_path / "done").exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_that_another_thread_takes_waits_for_it_too(tmp_path, number):
    def interrupt(*_):
        raise KeyboardInterrupt

    over, heard = threading.Event(), signal.signal(number, interrupt)
    other = threading.Thread(target=over.wait)  # which holds no signal off
    other.start()

    def work():
        time.sleep(0.1)
        (tmp_path / "done").touch()

    def asked():
        with signals_held():
            os.kill(os.getpid(), number)
            run_in_child(work)

    try:
        with pytest.raises(KeyboardInterrupt):
            asked()
    finally:
        over.set()
        other.join()
        now = signal.signal(number, heard)
    assert (tmp_path / "done").exists()
    assert now is interrupt


KILLED = """
import os, signal, sys, time
from dashpot.files.forked_writer import run_in_child
def work():
    os.kill(os.getppid(), signal.SIGKILL)
    time.sleep(0.2)
    open(sys.argv[1], "w").close()
run_in_child(work)
"""


def test_an_end_by_force_does_not_reach_it(tmp_path):
    run = subprocess.run([sys.executable, "-P", "-c", KILLED, str(tmp_path / "done")], capture_output=True, check=False)
    assert run.returncode == -signal.SIGKILL
    until = time.monotonic() + 60
    while not (tmp_path / "done").exists():
        assert time.monotonic() < until
        time.sleep(0.01)


def test_without_another_process_it_is_done_here(monkeypatch):
    def full():
        raise OSError(11, "Resource temporarily unavailable")

    done = []
    monkeypatch.setattr(os, "fork", full)
    run_in_child(lambda: done.append(os.getpid()))
    assert done == [os.getpid()]
