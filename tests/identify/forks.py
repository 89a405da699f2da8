"""Identifies a recording here, then in a process that is begun as the first argument says; prints what both found.

``fork``, ``spawn``, ``forkserver``; ``busy``: forked again and again while another thread identifies.
"""

from __future__ import annotations

import multiprocessing
import sys
import threading
import warnings

from dashpot.examples.truth import TRUTH
from dashpot.examples.virtual_recording import recording_of
from dashpot.identify import identify

FORKS = 6


def found(_: int = 0) -> float:
    """A number that the whole computation goes into."""
    return identify([recording_of(TRUTH, sweep=(1.5, 6.0, 14.0))]).oscillator.parameters()["omega0"].value


def main(kind: str) -> None:
    """Print the distinct values found; one where all agree."""
    warnings.simplefilter("ignore", DeprecationWarning)  # Python 3.12 warns of forks beside threads
    here = found()
    if kind != "busy":
        with multiprocessing.get_context(kind).Pool(1) as pool:
            print(len({here, *pool.map(found, range(2))}))
        return
    context, ended = multiprocessing.get_context("fork"), threading.Event()

    def compute() -> None:
        while not ended.is_set():
            found()

    thread = threading.Thread(target=compute)
    thread.start()
    values = {here}
    try:
        for _ in range(FORKS):
            with context.Pool(1) as pool:
                values.add(pool.apply(found))
    finally:
        ended.set()
        thread.join()
    print(len(values))


if __name__ == "__main__":
    main(sys.argv[1])
