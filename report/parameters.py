"""Parameters on a page: table with errors, truth where it is known, the equation with its numbers, correlations."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from ..model.as_recorded import parameter_as_recorded
from ..model.display import number, percent_text, pretty_unit, quantity_text, typeset, value_text
from ..model.physical import machine, machine_words
from ..model.show import percent
from .blocks import Cell, Table, Text

if TYPE_CHECKING:
    from ..model import Oscillator, Parameter

#: Correlations from here on are shaded, the darker the closer to one.
_SHADES = (0.3, 0.6, 0.8, 0.95)


def parameter_table(model: Oscillator, truth: Mapping[str, float] | None = None) -> Table:
    """Value, standard error, percent, unit; with ``truth`` also the true value and the distance in standard errors."""
    words = model.descriptions()
    head = ["Parameter", "Value", "± std error", "relative", "Unit"]
    numeric = [1, 2, 3]
    if truth:
        head += ["True value", "Off by", "… std errors"]
        numeric += [5, 6, 7]
    rows: list[tuple[str | Cell, ...]] = []
    if model.mass is None:
        blank = ("",) * (3 if truth else 0)
        rows.append(("mass", Cell("unknown", "quiet"), "", "", "", *blank, model.why_no_mass))
    for name, p in model.parameters().items():
        value, error = value_text(p)
        row: list[str | Cell] = [name, value, error, percent_text(percent(p)), pretty_unit(p.unit)]
        if truth:
            row += _against(p, truth.get(name))
        row.append(words[name] + _besides(model, name, p))
        rows.append(tuple(row))
    return Table(
        (*head, "Meaning"), tuple(rows), tuple(numeric), "One standard error, at the maximum of the likelihood."
    )


def _besides(model: Oscillator, name: str, parameter: Parameter) -> str:
    if name == "omega0":
        return f" ({number(parameter.value / (2 * math.pi), 6)} Hz)"
    shown = parameter_as_recorded(model, parameter)
    return f" ({quantity_text(shown)})" if "." in name and shown.unit != parameter.unit else ""


def machine_table(model: Oscillator) -> Table:
    """What a drawing or a data sheet states, with the errors carried over: kg, N/m, N s/m, N, Hz, damping ratio."""
    words = machine_words(model)
    rows = []
    for name, p in machine(model).items():
        value, error = value_text(p)
        unit = "" if p.unit == "1" else pretty_unit(p.unit)
        rows.append((name, value, error, percent_text(percent(p)), unit, words[name]))
    head = ("Of the machine", "Value", "± std error", "relative", "Unit", "Meaning")
    caption = f"As the machine has it{model.over_what_drives}: from the parameters of the model, with their errors."
    return Table(head, tuple(rows), (1, 2, 3), caption)


def _against(parameter: Parameter, true: float | None) -> list[str | Cell]:
    if true is None:
        return ["", "", ""]
    off = parameter.value - true
    share = percent_text(100 * abs(off / true)) if true else number(abs(off))
    if not parameter.std or not math.isfinite(parameter.std):
        return [number(true, 6), share, ""]
    errors = off / parameter.std
    tone = "good" if abs(errors) <= 3 else "bad"
    return [number(true, 6), share, Cell(typeset(f"{errors:+.1f}"), tone)]


def equation_blocks(model: Oscillator) -> tuple[Text, ...]:
    """The equation of motion in letters and with its numbers."""
    unit = model.response.displacement_unit
    force = f"the force f in {pretty_unit(unit)}/s²"
    if model.mass:
        what = f"{model.input_words}, F," if model.driven_through else "force F"
        force = f"the {what} in {pretty_unit(model.force_unit)}"
    inside = "inside the bracket all forces are per unit mass" if model.mass else "all forces are per unit mass"
    where = f"The displacement x is in {pretty_unit(unit)}, {force}; {inside}."
    texts = [*model.equation().split("; "), *model.equation(_with_numbers(model)).split("; ")]
    return (*(Text(text, "equation") for text in texts), Text(where))


def _with_numbers(model: Oscillator) -> Callable[[str], str]:
    values = model.values()

    def shown(name: str) -> str:
        value = number(values[name], 4)
        return f"({value})" if value.startswith("−") else value

    return shown


def correlation_table(model: Oscillator) -> Table | None:
    """Correlations of the estimates; None where there is no covariance."""
    provenance = model.identified
    rows = provenance.covariance
    if rows is None:
        return None
    names = provenance.parameters or tuple(model.parameters())
    body: list[tuple[str | Cell, ...]] = []
    for i, name in enumerate(names):
        cells: list[str | Cell] = [name]
        for j in range(len(names)):
            scale = math.sqrt(max(rows[i][i], 0.0)) * math.sqrt(max(rows[j][j], 0.0))
            if j > i:
                cells.append("")
            elif not (scale > 0 and math.isfinite(scale)):
                cells.append(Cell("–", "quiet"))
            else:
                value = rows[i][j] / scale
                shade = sum(abs(value) > edge for edge in _SHADES) if i != j else 0
                cells.append(Cell(typeset(f"{value:.2f}"), f"level{shade}" if i != j else "quiet level0"))
        body.append(tuple(cells))
    caption = "Correlation of the estimates; a dark pair is known better together than each alone."
    return Table(("", *names), tuple(body), tuple(range(1, len(names) + 1)), caption)
