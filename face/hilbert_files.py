"""FREEVIB's and FORCEVIB's results as files: curves over time, fitted laws, a page."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import BadInput
from ..files.writing import together, write

if TYPE_CHECKING:
    from ..identify.hilbert.hilbert_result import HilbertAnalysis
    from ..recording import Recording

ALL = "all"  # in the place of a mode
FILES = ("curves.csv", "hilbert.json", "report.html")


def run(
    recordings: Sequence[Recording], mode: str | None, folder: Path, say: Callable[[str], None]
) -> tuple[dict[str, Any], str]:
    """Analyse recordings and write ``FILES`` into a folder; returns what stands in the JSON file, and a summary.

    Args:
        recordings: of one rig.
        mode: which of several modes, as ``--mode`` has it; None: the strongest where others would be in its way;
            ``all``: one after the other, each into a folder of its own in `folder`.
        folder: made where it does not exist.
        say: called with one line per remark.

    Raises:
        BadInput: nothing can be evaluated, or a file cannot be written.
    """
    if mode is not None and mode.strip().lower() == ALL:
        return _each_mode(recordings, folder, say)
    from ..identify import hilbert_analysis
    from ..identify.hilbert.hilbert_files import describe
    from ..identify.motion.modes import mode_alone

    told: list[str] = []
    given, band = mode_alone(list(recordings), mode, None, told.append)
    told = [note.removeprefix("note: ") for note in told]
    analysis = hilbert_analysis(given).of_one_mode(told, band is not None)
    for note in analysis.notes:
        say(f"note: {note}")
    result = write_files(analysis, given, folder)
    say(f"written: {', '.join(str(folder / name) for name in FILES)}")
    return result, describe(analysis, given)


def _each_mode(recordings: Sequence[Recording], folder: Path, say: Callable[[str], None]) -> tuple[dict[str, Any], str]:
    """As ``run``, mode by mode; what no mode that was evaluated holds of the motion is said as the share left aside."""
    from ..identify.motion.mode_lines import modes_of

    entries: list[dict[str, Any]] = []
    words: list[str] = []
    left = 1.0
    for number, mode in enumerate(modes_of(recordings, whole=True), 1):
        entry = {"mode": number, "frequency_hz": mode.frequency, "share": mode.share}
        title = f"Mode {number}, {mode.frequency:.4g} Hz, {100 * mode.share:.3g} % of the motion"
        try:
            result, text = run(recordings, str(number), folder / f"mode-{number}", say)
        except BadInput as problem:
            entries.append(entry | {"problem": str(problem)})
            words.append(f"{title}: {problem}")
            continue
        left -= mode.share
        entries.append(entry | result)
        words.append(f"{title}\n{text}")
    if all("problem" in entry for entry in entries):
        raise BadInput(" ".join(["No mode can be evaluated by itself.", *words]))
    left = max(0.0, left)
    return {"modes": entries, "left_aside": left}, "\n".join([*words, f"Left aside: {100 * left:.2g} % of the motion."])


def write_files(analysis: HilbertAnalysis, recordings: Sequence[Recording], folder: Path) -> dict[str, Any]:
    """Write ``FILES`` of an analysis of these recordings into a folder, all or none; returns what the JSON file says.

    Raises:
        BadInput: a file cannot be written.
    """
    from ..identify.hilbert.hilbert_files import as_json, curves_csv
    from ..report.hilbert_page import hilbert_page

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
