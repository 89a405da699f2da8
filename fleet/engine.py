"""Who works on the tasks: processes of this machine, or a Dask cluster. Neither remembers anything; the store does."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures import as_completed as as_they_come
from typing import Any

from ..errors import BadInput
from .child import Children

#: How long a scheduler is waited for, s.
PATIENCE = 10.0
Task = dict[str, Any]
Answer = tuple[Task, dict[str, Any]]
#: Answers to tasks, in the order in which they come.
Engine = Callable[[Sequence[Task]], Iterator[Answer]]


def local(module: str, jobs: int) -> Engine:
    """So many processes at a time on this machine.

    Args:
        module: whose ``main`` does a task, see ``Children``.
        jobs: how many.
    """

    def run(tasks: Sequence[Task]) -> Iterator[Answer]:
        children = Children(module)
        pool = ThreadPoolExecutor(jobs)  # each thread waits for one process
        try:
            waiting = {pool.submit(children.answer, task): task for task in tasks}
            for future in as_they_come(waiting):
                yield waiting[future], future.result()
        finally:  # also where whoever asks is interrupted
            pool.shutdown(wait=False, cancel_futures=True)
            children.end()
            pool.shutdown(wait=True)

    return run


def dask(module: str, scheduler: str, say: Callable[[str], None]) -> Engine:
    """The workers of a Dask cluster, which share the disk that the store is on; each runs as many as it has threads.

    Raises:
        BadInput: Dask is not installed, or nobody answers at the address.
    """
    with _client(scheduler) as client:  # before anything is begun
        say(f"dashboard: {client.dashboard_link}")

    def run(tasks: Sequence[Task]) -> Iterator[Answer]:
        from distributed import as_completed  # pyright: ignore[reportMissingImports]

        with _client(scheduler) as client:
            waiting = {client.submit(_on_a_worker, module, task, pure=False): task for task in tasks}
            for future in as_completed(list(waiting), loop=client.loop):
                yield waiting[future], _result(future)

    return run


def _client(scheduler: str) -> Any:
    try:
        from distributed import Client  # pyright: ignore[reportMissingImports]
        from distributed.comm.addressing import get_address_host_port  # pyright: ignore[reportMissingImports]
    except ModuleNotFoundError:
        raise BadInput(
            "--scheduler needs dask and distributed, which are not installed; pip install 'dashpot[fleet]', or leave "
            "the option out and use --jobs"
        ) from None
    try:
        get_address_host_port(scheduler)  # a client of no address at all would hang for long as it ends
        return Client(scheduler, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as problem:
        words = " ".join(str(problem).split())[:200]
        raise BadInput(f"--scheduler {scheduler}: no Dask scheduler answers ({words}); check the address") from None


def _result(future: Any) -> dict[str, Any]:
    try:
        return future.result()
    except BadInput:
        raise
    except Exception as problem:  # the cluster's own: a worker that went, a scheduler that is no more
        words = " ".join(str(problem).split())[:200]
        raise BadInput(
            f"the cluster did not do its work ({type(problem).__name__}: {words}); mend it and run again: what is done "
            "is kept"
        ) from None


def _on_a_worker(module: str, task: Task) -> dict[str, Any]:
    return Children(module).answer(task)
