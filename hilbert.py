"""FREEVIB's and FORCEVIB's results as files: curves over time, fitted laws, a page."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .callable_module import callable_as_its_name
from .writing import together, write

if TYPE_CHECKING:
    from .identify.hilbert_result import HilbertAnalysis
    from .recording import Recording

callable_as_its_name(__name__)  # dashpot.hilbert(...)
FILES = ("curves.csv", "hilbert.json", "report.html")


def run(
    recordings: Sequence[Recording], mode: str | None, folder: Path, say: Callable[[str], None]
) -> tuple[dict[str, Any], str]:
    """Analyse recordings and write ``FILES`` into a folder; returns what stands in the JSON file, and a summary.

    Args:
        recordings: of one rig.
        mode: which of several modes, as ``--mode`` has it; None: the strongest where others would be in its way.
        folder: made where it does not exist.
        say: called with one line per remark.

    Raises:
        BadInput: nothing can be evaluated, or a file cannot be written.
    """
    from .identify import hilbert_analysis
    from .identify.hilbert_files import describe
    from .identify.modes import mode_alone

    told: list[str] = []
    given, band = mode_alone(list(recordings), mode, None, told.append)
    told = [note.removeprefix("note: ") for note in told]
    analysis = hilbert_analysis(given).of_one_mode(told, band is not None)
    for note in analysis.notes:
        say(f"note: {note}")
    result = write_files(analysis, given, folder)
    say(f"written: {', '.join(str(folder / name) for name in FILES)}")
    return result, describe(analysis, given)


def write_files(analysis: HilbertAnalysis, recordings: Sequence[Recording], folder: Path) -> dict[str, Any]:
    """Write ``FILES`` of an analysis of these recordings into a folder, all or none; returns what the JSON file says.

    Raises:
        BadInput: a file cannot be written.
    """
    from .identify.hilbert_files import as_json, curves_csv
    from .report.hilbert_page import hilbert_page

    result = as_json(analysis, recordings)
    texts = (
        curves_csv(analysis, recordings),
        json.dumps(result, indent=2, ensure_ascii=False, allow_nan=False) + "\n",
        hilbert_page(analysis, recordings, FILES[:2]),
    )
    with together():
        for name, text in zip(FILES, texts, strict=True):
            write(folder / name, text)
    return result
