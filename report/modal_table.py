"""FREEVIB, FORCEVIB and maximum likelihood in one table, each parameter with its standard error."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from ..identify.hilbert.hilbert_files import UNITS
from ..model import units
from ..model.display import number, pretty_unit, times_text, value_text
from ..model.fit_state import LACKING
from ..model.parameter import Parameter
from .blocks import Cell, Table

if TYPE_CHECKING:
    from ..identify.hilbert.hilbert_result import HilbertAnalysis
    from ..identify.hilbert.modal_result import LawFit, ModalFit
    from ..model import Oscillator

_FROM = {"freevib": "FREEVIB", "forcevib": "FORCEVIB"}


def modal_table(
    analysis: HilbertAnalysis,
    unit: str,
    force: str,
    model: Oscillator | None = None,
    truth: Mapping[str, float] | None = None,
) -> Table | None:
    """One row a parameter; None where neither method has a result.

    Args:
        analysis: FREEVIB's and FORCEVIB's fits.
        unit, force: of the displacement, and of what drives.
        model: by maximum likelihood, for a column of its own.
        truth: true values, where they are known.
    """
    fits = {name: fit for method, name in _FROM.items() if (fit := getattr(analysis, method)) is not None}
    if not fits:
        return None
    columns = [({**fit.values, **fit.derived}, {**fit.stds, **fit.derived_std}) for fit in fits.values()]
    head = ["Parameter", *fits]
    if model is not None:
        known = model.parameters()
        columns.append(({n: p.value for n, p in known.items()}, {n: p.std for n, p in known.items()}))
        head.append("Maximum likelihood")
    rows: list[tuple[str | Cell, ...]] = []
    for name, of in UNITS.items():
        if not any(name in values for values, _ in columns):
            continue
        row: list[str | Cell] = [name]
        row += [_cell(values.get(name), stds.get(name)) for values, stds in columns]
        if truth is not None:
            row.append(number(truth[name], 6) if name in truth else "")
        rows.append((*row, pretty_unit(units.compose(of, unit, force))))
    missed = [_left(fit.over_noise) for fit in fits.values()]
    rows.append(("times the noise", *missed, *[""] * (len(head) - 1 - len(missed) + (truth is not None)), ""))
    if truth is not None:
        head.append("True value")
    caption = (
        "Each with one standard error. FREEVIB and FORCEVIB: Eqs. 1, 6, 7 together, fitted to all curves of the method"
        + ("; maximum likelihood: the motion itself, simulated." if model is not None else ".")
        + " Last row: rms of what the laws leave, over that of the noise. "
        f"Beyond {LACKING:g} they are not all that moves the rig: no error would hold, and none is stated."
    )
    return Table((*head, "Unit"), tuple(rows), tuple(range(1, len(head))), caption)


def laws_table(fit: ModalFit, unit: str, caption: str) -> Table:
    """The laws of one method, each by itself: what it says, and how far it misses the curves."""
    rows: list[tuple[str | Cell, ...]] = []
    for law in (fit.preload, fit.polynomial, fit.both, fit.damping):
        if law is None:
            continue
        words = ", ".join(
            f"{name} {_text(law.values[name], law.stds[name])} {pretty_unit(units.compose(UNITS[name], unit))}"
            for name in law.values
        )
        rows.append((_name(law), words, _left(law.over_noise)))
    return Table(("Law", "Parameters", "Times the noise"), tuple(rows), (2,), caption)


def _name(law: LawFit) -> str:
    equation = {
        "preload": "Eq. 1",
        "polynomial": "Eq. 6",
        "preload and polynomial": "Eqs. 1 and 6",
        "viscous and dry": "Eq. 7",
    }
    return f"{law.law} ({equation[law.law]})"


def _left(times: float) -> Cell:
    """Bad where the law leaves more than noise: then it is not all that moves the rig."""
    return Cell(times_text(times), "good" if times <= LACKING else "bad")


def _cell(value: float | None, std: float | None) -> str | Cell:
    return Cell("–", "quiet") if value is None else _text(value, std)


def _text(value: float, std: float | None) -> str:
    if std is None or not math.isfinite(std):  # no error says how many digits count
        return number(value, 4)
    shown, error = value_text(Parameter(value, std, ""))
    return f"{shown} ± {error}" if error else shown
