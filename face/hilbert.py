"""FREEVIB's and FORCEVIB's results as a person holds them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..recording import Recording

if TYPE_CHECKING:
    from ..identify.hilbert.hilbert_result import HilbertAnalysis
    from ..identify.hilbert.modal_result import ModalCurve, ModalFit


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
        """What was left aside and why, one sentence each."""
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
        from .hilbert_files import FILES, write_files

        write_files(self.analysis, self.recordings, Path(folder))
        return [Path(folder) / name for name in FILES]
