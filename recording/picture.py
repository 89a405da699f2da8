"""A picture of a recording as it is: response and force over time, what is not shown or not known shaded."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from .missing import Runs

_WIDTH, _HEIGHT = 9.2, 2.4
#: Samples from which on a line is drawn as an image within the picture: as so many strokes it takes megabytes.
_MANY = 20_000


@cache
def plot_class() -> Any:
    """A matplotlib Figure that shows itself in a notebook, whatever the backend."""
    from matplotlib.figure import Figure

    class Plot(Figure):
        """Drawn within ``style``."""

        style = staticmethod(nullcontext)

        def _repr_svg_(self) -> str:
            import io

            out = io.StringIO()
            with self.style():
                self.savefig(out, format="svg")
            text = out.getvalue()
            return text[text.index("<svg") :]

    return Plot


class Track(NamedTuple):
    """What is drawn on one axis: values (n,), and the runs of samples that are shaded, in these ``words``."""

    what: str
    values: np.ndarray
    unit: str
    runs: Runs
    words: str


def plotted(name: str, time: np.ndarray, shown: Sequence[Track]) -> Any:
    """The Figure: one axis for each track over the time (n,), s."""
    from matplotlib.ticker import EngFormatter

    figure = plot_class()(figsize=(_WIDTH, _HEIGHT * len(shown)), layout="constrained")
    for axes, (what, values, unit, runs, words) in zip(
        figure.subplots(len(shown), 1, squeeze=False, sharex=True).ravel(), shown, strict=True
    ):
        axes.plot(time, values, linewidth=0.8, color="#4d4d4d", rasterized=time.size > _MANY)
        for i, (start, stop) in enumerate(runs):
            axes.axvspan(
                time[start],
                time[min(stop, time.size) - 1],
                color="#d55e00",
                alpha=0.2,
                label=words if i == 0 else None,
            )
        if runs:
            axes.legend(loc="best")
        axes.set_ylabel(f"{what} [{unit}]")
        if unit[:1] in "mNV" and unit[:2] not in ("mm", "mil"):
            axes.yaxis.set_major_formatter(EngFormatter(unit))
            axes.set_ylabel(what)
        axes.grid(visible=True, color="#e3e3e3", linewidth=0.7)
    figure.axes[0].set_title(name, loc="left")
    figure.axes[-1].set_xlabel("Time [s]")
    return figure
