"""Pictures for a person at a keyboard: matplotlib Figures in the style of the reports that a notebook shows."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

from ..recording.picture import plot_class
from ..report.style import WIDTH, styled


@cache
def _plot_class() -> Any:
    class Plot(plot_class()):
        """A matplotlib Figure that shows itself in a notebook, in the style of the reports."""

        style = staticmethod(styled)

    return Plot


@contextmanager
def new_plot(count: int = 1, *, beside: bool = False, height: float = 3.0) -> Iterator[tuple[Any, Any]]:
    """A Figure with so many axes, one below the other or ``beside`` one another, in the style of the reports."""
    with styled():
        tall = height if beside or count == 1 else 0.8 * height * count
        figure = _plot_class()(figsize=(WIDTH, tall), layout="constrained")
        rows, columns = (1, count) if beside else (count, 1)
        axes = figure.subplots(rows, columns, squeeze=False, sharex=not beside).ravel()
        yield figure, axes
