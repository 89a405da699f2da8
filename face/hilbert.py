"""FREEVIB's and FORCEVIB's results as a person holds them, and as files: curves over time, fitted laws, a page."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import BadInput
from ..files.writing import together, write
from ..recording import Recording
from .figures import FIGURES, figures_of, write_figures
from .workflow import WRITING, Say, analysed, silent

if TYPE_CHECKING:
    from ..identify.hilbert.hilbert_result import HilbertAnalysis
    from ..identify.hilbert.modal_result import ModalCurve, ModalFit


ALL = "all"  # in the place of a mode
FILES = ("curves.csv", "hilbert.json", "report.html")


@dataclass(frozen=True, eq=False, repr=False)
class Hilbert:
    """What the Hilbert transform alone says of a rig.

    Attributes:
        analysis: curves, fits and notes.
        recordings: what was evaluated.
    """

    analysis: HilbertAnalysis
    recordings: tuple[Recording, ...]

    @property
    def curves(self) -> tuple[ModalCurve, ...]:
        """One of each decay (FREEVIB) and of each driven stretch (FORCEVIB): arrays over time."""
        return self.analysis.curves

    @property
    def freevib(self) -> ModalFit | None:
        """Eqs. 1, 6, 7 fitted to all decays together; None without one."""
        return self.analysis.freevib

    @property
    def forcevib(self) -> ModalFit | None:
        """The same of all driven stretches, with the mass; None without one."""
        return self.analysis.forcevib

    @property
    def notes(self) -> tuple[str, ...]:
        """What was left out and why, one sentence each."""
        return self.analysis.notes

    def __repr__(self) -> str:
        from ..identify.hilbert.hilbert_files import describe

        return describe(self.analysis, self.recordings)

    def _repr_html_(self) -> str:
        from .words import preformatted

        return preformatted(repr(self)) + self.plot()._repr_svg_()

    def plot(self) -> Any:
        """The curves' natural frequency and damping over the amplitude; a matplotlib Figure."""
        from ..model import Response
        from ..model.display import scale_of
        from ..report.style import FORCED, FREE
        from .plot import new_plot

        first = self.recordings[0]
        unit = Response(first.quantity, first.unit).displacement_unit
        scale = scale_of(unit, max(float(np.max(c.amplitude)) for c in self.curves))
        with new_plot(2, beside=True, height=3.6) as (figure, (left, right)):
            for curve in self.curves:
                free = curve.method == "freevib"
                style: dict[str, Any] = {"color": FREE if free else FORCED, "linestyle": "-." if free else ":"}
                left.plot(curve.omega0 / (2 * np.pi), curve.amplitude * scale.factor, **style)
                right.plot(curve.amplitude * scale.factor, curve.damping, **style)
            left.set_title("Backbones")
            left.set_xlabel("Natural frequency [Hz]")
            left.set_ylabel(scale.label("Amplitude"))
            left.set_ylim(0, None)
            right.set_title("Damping curves")
            right.set_xlabel(scale.label("Amplitude"))
            right.set_ylabel("Damping h [1/s]")
        return figure

    def as_json(self) -> dict[str, Any]:
        """The laws, their errors and what they come from, as ``dashpot hilbert`` writes them."""
        from ..identify.hilbert.hilbert_files import as_json

        return as_json(self.analysis, self.recordings)

    def save(self, folder: str | Path) -> list[Path]:
        """Write curves.csv, hilbert.json and report.html into a folder; returns their paths."""
        return write_files(self.analysis, self.recordings, Path(folder))[1]

    def figures(self, folder: str | Path, kinds: str | Sequence[str] = "svg") -> list[Path]:
        """Draw the charts of the page as files into a folder, in one or several of pdf, png, svg; returns the paths.

        Raises:
            BadInput: a kind is not known, or the folder cannot be written.
        """
        from ..report.hilbert_page import hilbert_page

        return figures_of(lambda: hilbert_page(self.analysis, self.recordings, FILES[:2]), folder, kinds)


def run(
    recordings: Sequence[Recording],
    mode: str | None,
    folder: Path,
    say: Say,
    figures: Sequence[str] = (),
    stage: Say = silent,
) -> tuple[dict[str, Any], str]:
    """Analyse recordings and write ``FILES`` into a folder; returns what stands in the JSON file, and a summary.

    Args:
        recordings: of one rig.
        mode: which of several modes, as ``--mode`` has it; None: the strongest where others would be in its way;
            ``all``: one after the other, each into a folder of its own in `folder`.
        folder: made where it does not exist.
        say: called with one line per remark.
        figures: kinds of files that each picture of the page is drawn as too.
        stage: called with what is worked at from now on.

    Raises:
        BadInput: nothing can be evaluated, or a file cannot be written.
    """
    if mode is not None and mode.strip().lower() == ALL:
        return _each_mode(recordings, folder, say, figures, stage)
    from ..identify.hilbert.hilbert_files import describe

    stage("FREEVIB and FORCEVIB")
    analysis, given = analysed(recordings, mode)
    for note in analysis.notes:
        say(f"note: {note}")
    stage(WRITING)
    result, written = write_files(analysis, given, folder, figures)
    say(f"written: {', '.join(map(str, written))}")
    return result, describe(analysis, given)


def _each_mode(
    recordings: Sequence[Recording], folder: Path, say: Say, figures: Sequence[str], stage: Say
) -> tuple[dict[str, Any], str]:
    """As ``run``, mode by mode; what no mode that was evaluated holds of the motion is said as the share left out."""
    from ..identify.motion.mode_lines import modes_of

    entries: list[dict[str, Any]] = []
    words: list[str] = []
    left = 1.0
    for number, mode in enumerate(modes_of(recordings, whole=True, struck=True), 1):
        entry: dict[str, Any] = {"mode": number, **mode.as_json()}
        title = f"Mode {number}, {mode}"
        try:
            result, text = run(recordings, str(number), folder / f"mode-{number}", say, figures, stage)
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


def write_files(
    analysis: HilbertAnalysis, recordings: Sequence[Recording], folder: Path, figures: Sequence[str] = ()
) -> tuple[dict[str, Any], list[Path]]:
    """Write ``FILES`` of an analysis of these recordings into a folder, and its pictures, all or none.

    Returns:
        What the JSON file says, and the paths written.

    Raises:
        BadInput: a file cannot be written.
    """
    from ..identify.hilbert.hilbert_files import as_json, curves_csv
    from ..report.hilbert_page import hilbert_page

    result = as_json(analysis, recordings)
    page = hilbert_page(analysis, recordings, FILES[:2])
    texts = (
        curves_csv(analysis, recordings),
        json.dumps(result, indent=2, ensure_ascii=False, allow_nan=False) + "\n",
        page.html,
    )
    with together():
        for name, text in zip(FILES, texts, strict=True):
            write(folder / name, text)
        drawn = write_figures(page, folder / FIGURES, figures)
    return result, [*(folder / name for name in FILES), *drawn]
