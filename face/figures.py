"""The pictures of a page as files, for a paper or a slide: each chart that the page draws, in the kinds asked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import BadInput
from ..files.arguments import path_of, shown

if TYPE_CHECKING:
    from ..report.blocks import Page

#: Folder of the pictures of a page.
FIGURES = "figures"


def kinds_of(given: Any) -> tuple[str, ...]:
    """Kinds of files, as a text ("pdf,svg") or several, each once and in that order; raises BadInput for others."""
    from ..report.matplotlib_figure import KINDS

    several = given.split(",") if isinstance(given, str) else given
    if not isinstance(several, list | tuple) or not all(isinstance(kind, str) for kind in several):
        raise BadInput(f"kinds of pictures are such as 'pdf' or 'pdf,svg', not {shown(given)}")
    kinds = tuple(dict.fromkeys(kind.strip().lower() for kind in several))
    for kind in kinds:
        if kind not in KINDS:
            raise BadInput(f"{shown(kind)} is no kind of picture; there are {', '.join(KINDS)}, such as 'pdf,svg'")
    return kinds


def write_figures(page: Page, folder: Path, kinds: Sequence[str]) -> list[Path]:
    """Draw each chart of a page as a file of each kind in a folder, ``KEY.KIND``; returns their paths."""
    from ..report.matplotlib_figure import save

    charts = page.charts if kinds else []
    drawn = [(chart, folder / f"{chart.key}.{kind}") for chart in charts for kind in kinds]
    for chart, path in drawn:
        save(chart, path)
    return [path for _, path in drawn]


def beside(file: Path) -> Path:
    """The folder of the pictures that belong to a file."""
    return file.with_name(f"{file.stem}-{FIGURES}")


def figures_of(page: Callable[[], Page], folder: str | Path, kinds: str | Sequence[str]) -> list[Path]:
    """Write the charts of a page, which is made once the arguments are known to be right, all or none.

    Raises BadInput where a kind is not known or the folder cannot be written.
    """
    from ..files.writing import together

    place, checked = path_of(folder, "a folder for the pictures"), kinds_of(kinds)
    with together():
        return write_figures(page(), place, checked)
