"""What an FMU of either back-end says about itself: its GUID and its documentation page."""

from __future__ import annotations

import hashlib
import math
from typing import TYPE_CHECKING, Any

from .. import __version__
from ..model.display import full_stop, number, percent_text, pretty_unit, scale_of, typeset, value_text
from ..model.laws import BASE
from ..model.oscillator import HOLDS
from ..model.physical import machine, machine_words
from ..model.show import percent, strong_correlations
from ..model.show import warnings as model_warnings
from .curves import curves, pictures, table
from .description import Description
from .facts import Facts
from .render import plain_text, render

if TYPE_CHECKING:
    from ..model import Oscillator


def guid_of(texts: list[str]) -> str:
    """A GUID that is the same for the same texts."""
    digest = hashlib.sha256("\0".join(texts).encode()).hexdigest()
    return f"{{{digest[:8]}-{digest[8:12]}-{digest[12:16]}-{digest[16:20]}-{digest[20:32]}}}"


def documentation(facts: Facts, description: Description, hold: str) -> str:
    """The FMU's documentation/index.html, one page that stands alone.

    Equation, parameters with their errors, backbone and damping curve, validity, how the inputs are taken, variables,
    laws with their sources, recordings.

    Args:
        facts: of the model.
        description: the FMU's variables.
        hold: what becomes of the input between two communication points, for a user.
    """
    oscillator = facts.oscillator
    identified = oscillator.identified
    count = len(identified.recordings)
    return render(
        "fmu_documentation.html.j2",
        description=description,
        origin=f", identified from {count} recording{'s' if count > 1 else ''}" if count else "",
        forces=_forces(oscillator),
        hold=hold,
        starts=_starts(description),
        parameters=_parameters(oscillator),
        machine=_machine(oscillator),
        over=oscillator.over_what_drives,
        correlations=", ".join(
            f"{first} and {second} (correlation {typeset(f'{value:+.2f}')})"
            for first, second, value in strong_correlations(oscillator)
        ),
        warnings=[full_stop(sentence) for sentence in model_warnings(oscillator)],
        ranges=_ranges(oscillator),
        outside=oscillator.amplitude is not None and description.place("outside") is not None,
        variables=[
            (v.name, pretty_unit(v.unit), f"{v.variability} {v.causality}", v.description)
            for v in description.variables
        ],
        laws=_laws(oscillator),
        recordings=[
            (
                plain_text(str(r.get("file", "?"))),
                plain_text(str(r.get("kind") or "")),
                str(r.get("sha256") or "not known"),
            )
            for r in identified.recordings
        ],
        provenance=_provenance(oscillator),
        footer=f"Made by dashpot {__version__}.",
        **_curves(facts),
    )


def _forces(o: Oscillator) -> str:
    length = pretty_unit(o.response.displacement_unit)
    response = f"the response as recorded is the {o.response.quantity} in {pretty_unit(o.response.unit)}"
    if o.mass is None:
        return (
            f"Forces are per unit mass, the input F too: {o.why_no_mass}. "
            f"The displacement x is in {length}; {response}."
        )
    force = pretty_unit(o.force_unit)
    if o.driven_through:
        return (
            f"The input F is the {o.input_words}, in {force}; the mass is over what that counts, and forces inside the "
            f"bracket are per unit mass. The displacement x is in {length}; {response}."
        )
    return (
        f"Forces inside the bracket are per unit mass. The displacement x is in {length}, the force F in {force}; "
        f"{response}. In the recordings the force was taken to be {HOLDS[o.hold]}."
    )


def _starts(description: Description) -> str:
    names = [v.name for v in description.variables if v.role == "initial" and v.index > 1]
    return f"; the laws with a memory start from {', '.join(names)}" if names else ""


def _parameters(o: Oscillator) -> list[tuple[str, ...]]:
    words = o.descriptions()
    rows = []
    if o.mass is None:
        rows.append(("mass", "unknown", "", "", "", o.why_no_mass))
    for name, p in o.parameters().items():
        meaning = plain_text(words[name])
        if name == "omega0":
            meaning += f" ({number(p.value / (2 * math.pi), 6)} Hz)"
        rows.append((name, *value_text(p), percent_text(percent(p)), pretty_unit(p.unit), meaning))
    return rows


def _machine(o: Oscillator) -> list[tuple[str, ...]]:
    words = machine_words(o)
    return [
        (
            name,
            *value_text(p),
            percent_text(percent(p)),
            "" if p.unit == "1" else pretty_unit(p.unit),
            plain_text(words[name]),
        )
        for name, p in machine(o).items()
    ]


def _ranges(o: Oscillator) -> list[tuple[str, str, str, str]]:
    rows = []
    for name, span in (("amplitude", o.amplitude), ("frequency", o.frequency)):
        if span is not None:
            scale = scale_of(span.unit, span.max)
            rows.append((name, number(span.min * scale.factor, 4), number(span.max * scale.factor, 4), scale.unit))
    return rows


def _curves(facts: Facts) -> dict[str, Any]:
    drawn = curves(facts)
    if drawn is None:
        return {"pictures": (), "caption": "", "curve_head": (), "curve_rows": ()}
    unit = facts.oscillator.response.displacement_unit
    caption = (
        "The natural frequency of the model's free vibration (backbone) and its damping, each as the mean over "
        "a cycle, which is what the Hilbert transform measures. "
    )
    caption += (
        "Shaded: amplitudes that the recordings covered; dashed: beyond them."
        if drawn.stated
        else "The model states no range of amplitudes; the one drawn is a guess."
    )
    head, rows = table(drawn, unit)
    return {"pictures": pictures(drawn, unit), "caption": caption, "curve_head": head, "curve_rows": rows}


def _laws(o: Oscillator) -> list[tuple[str, ...]]:
    laws = [*BASE, *(term.law for term in o.terms)]
    return [
        (plain_text(law.name), plain_text(f"{full_stop(law.sentence)} {law.curves}"), plain_text(law.source))
        for law in laws
    ]


def _provenance(o: Oscillator) -> str:
    provenance = o.identified
    if not (provenance.recordings or provenance.method or provenance.software):
        return "The model file does not say; the numbers were given, not measured."
    parts = [
        f"Method: {plain_text(provenance.method) or 'not stated'}",
        f"Software: {plain_text(provenance.software) or 'not stated'}",
    ]
    if provenance.log_likelihood is not None and math.isfinite(provenance.log_likelihood):
        parts.append(f"Log likelihood: {number(provenance.log_likelihood, 7)}")
    return ". ".join(parts) + ". The standard errors are one sigma, at the maximum of the likelihood."
