"""FREEVIB, FORCEVIB and maximum likelihood in one table, each parameter with its standard error."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ..identify.hilbert.hilbert_files import UNITS, shown_value
from ..model.display import number, pretty_unit, times_text, value_text
from ..model.fit_state import LACKING
from .blocks import Cell, Table

if TYPE_CHECKING:
    from ..identify.hilbert.hilbert_result import HilbertAnalysis
    from ..identify.hilbert.modal_result import LawFit, ModalFit
    from ..model import Oscillator
    from ..model.parameter import Parameter
    from ..recording.as_recorded import InUnit

_FROM = {"freevib": "FREEVIB", "forcevib": "FORCEVIB"}


def modal_table(
    analysis: HilbertAnalysis,
    unit: str,
    force: str,
    model: Oscillator | None = None,
    truth: Mapping[str, float] | None = None,
    length: InUnit | None = None,
) -> Table | None:
    """One row a parameter; None where neither method has a result.

    Args:
        analysis: FREEVIB's and FORCEVIB's fits.
        unit, force: of the displacement, and of what drives.
        model: by maximum likelihood, for a column of its own.
        truth: true values, where they are known.
        length: factor and unit in which lengths are shown, where that is another.
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
    for name in UNITS:
        if not any(name in values for values, _ in columns):
            continue
        one = shown_value(name, 1.0, None, unit, force, length)
        row: list[str | Cell] = [name]
        for values, stds in columns:
            known = name in values and shown_value(name, values[name], stds[name], unit, force, length)
            row.append(_text(known) if known else Cell("–", "quiet"))
        if truth is not None:
            row.append(number(one.value * truth[name], 6) if name in truth else "")
        rows.append((*row, pretty_unit(one.unit)))
    missed = [_left(fit.over_noise) for fit in fits.values()]
    rows.append(("times the noise", *missed, *[""] * (len(head) - 1 - len(missed) + (truth is not None)), ""))
    if truth is not None:
        head.append("True value")
    stated = model is not None or any(fit.has_errors for fit in fits.values())
    caption = (
        ("Each with one standard error. " if stated else "")
        + "FREEVIB and FORCEVIB: Eqs. 1, 6, 7 together, fitted to all curves of the method"
        + ("; maximum likelihood: the motion itself, simulated." if model is not None else ".")
        + " Last row: rms of what the laws leave, over that of the noise. "
        f"Beyond {LACKING:g} they are not all that moves the rig: no error would hold, and none is stated."
    )
    return Table((*head, "Unit"), tuple(rows), tuple(range(1, len(head))), caption)


def laws_table(fit: ModalFit, unit: str, caption: str, length: InUnit | None = None) -> Table:
    """The laws of one method, each by itself: what it says, and how far it misses the curves."""
    rows: list[tuple[str | Cell, ...]] = []
    for law in (fit.preload, fit.polynomial, fit.both, fit.damping):
        if law is None:
            continue
        shown = {n: shown_value(n, law.values[n], law.stds[n], unit, "N", length) for n in law.values}
        words = ", ".join(f"{name} {_text(value)} {pretty_unit(value.unit)}" for name, value in shown.items())
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


def _text(known: Parameter) -> str:
    if known.std is None:  # no error says how many digits count
        return number(known.value, 4)
    shown, error = value_text(known)
    return f"{shown} ± {error}" if error else shown
