"""The paper's figures, remade from the built-in stand."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ..files.writing import writable, write

PAGE = "paper.html"


def run(folder: Path, say: Callable[[str], None]) -> Path:
    """Write Figs. 1 and 3 to 7 of Feldman, Bucher, Rotberg 2009 as one page into a folder; returns its path.

    Args:
        folder: made where it does not exist.
        say: called with one line per step.

    Raises:
        BadInput: where the folder cannot be written.
    """
    from ..examples import recordings
    from ..examples.truth import TRUTH
    from ..identify import hilbert_analysis
    from ..identify.motion.decays import find_decays
    from ..recording import read
    from ..report.paper_page import paper_page

    target = folder / PAGE
    writable(target)
    files = recordings("paper-stand")
    free, sweep = read(files["bursts"]), read(files["sweep_high"])
    say("FREEVIB and FORCEVIB on the built-in stand's bursts and sweep")
    analysis = hilbert_analysis([free, sweep])
    write(target, paper_page(analysis, free, find_decays(free), sweep, TRUTH).html)
    say(f"written: {target}")
    return target
