"""The report of an identification: one HTML page that stands alone."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..export.render import plain_text
from ..identify.signals.said import said
from ..model.as_recorded import as_recorded
from ..model.display import Scale, full_stop, number, pretty_unit, quantity_text, scale_of
from ..model.fit_state import lacking
from ..model.physical import machine
from ..model.show import warnings as model_warnings
from .agreement import agreement_section, verdict
from .backbone_distance import distance_figure
from .backbone_figure import backbone_figure, backbone_kind
from .blocks import Block, Code, Items, Page, Section, Table, Text, picture
from .characteristics import friction_figure, stiffness_figure
from .comparison import Comparison, comparisons
from .modal_table import modal_table
from .parameters import correlation_table, equation_blocks, machine_table, parameter_table
from .provenance import files_text, recordings_table
from .time_history import SHADES, Taken, recording_figure
from .usage import usage_section
from .used import left, left_pieces, taken, used_table

if TYPE_CHECKING:
    from ..identify.identification import Identification
    from ..model import Oscillator
    from ..verify.verification import Verification

#: What of the machine is said first, where it is known.
_FIRST = {"natural_frequency": "natural frequency", "damping_ratio": "damping ratio", "total_mass": "moving mass"}
#: Where the estimates that need no simulation came from.
_SOURCES = {
    "pieces": "the fit of Eq. 17 to its free pieces",
    "regression": "a regression in weak form over all recordings, not from the Hilbert transform",
    "curves": "the Hilbert transform's curves",
    "spectrum": "the largest line of the spectrum",
}


def identification_page(
    identification: Identification,
    verification: Verification | None = None,
    truth: Mapping[str, float] | None = None,
    files: Sequence[str] = (),
    typed: Sequence[str] = (),
) -> Page:
    """The report.

    Args:
        identification: model, curves, fit and recordings.
        verification: the FMU's runs, where there were any; the pictures then show the FMU instead of the fit.
        truth: true values by parameter name, where they are known, in the model's units.
        files: names of the files made beside the report, for the section on how to use them.
        typed: the recordings' files as a user typed them, for the command that comes next; left out, their names.
    """
    model = identification.oscillator
    shown = comparisons(identification, verification)
    sections = [
        Section("The machine", (machine_table(model), *equation_blocks(model), parameter_table(model, truth))),
        Section("Backbones and frequency response", tuple(_backbones(identification, verification))),
        agreement_section(shown, "FMU" if verification is not None else "model", model.omega0.value / (2 * np.pi)),
        Section("How sure the numbers are", tuple(_certainty(identification))),
        Section("FREEVIB and FORCEVIB beside the fit", _methods(identification), folded=True),
        Section("Spring and damping", tuple(_characteristics(identification)), folded=True),
        Section("Recordings", tuple(_recordings(identification)), folded=True),
        Section("Where the model holds", tuple(_validity(identification))),
        usage_section(model, files),
        Section("Where the numbers come from", tuple(_provenance(identification, files)), folded=True),
    ]
    lead = _lead(identification, shown, verified=verification is not None, files=files, typed=typed)
    return Page(f"Identification of {model.name}", sections, lead=lead)


def _lead(
    identification: Identification,
    shown: Sequence[Comparison],
    *,
    verified: bool,
    files: Sequence[str],
    typed: Sequence[str],
) -> list[Block]:
    """Whether the numbers may be believed, the first of them, and what to type next."""
    model = identification.oscillator
    saved = next((name for name in files if name.endswith(".yaml")), None)
    yaml = saved or "model.yaml"
    first = "" if saved else f", of the model saved as {yaml}"
    recordings = typed or tuple(dict.fromkeys(r.name.partition("#")[0] for r in identification.recordings))
    numbers = Text(_in_short(model), lead="In short:")
    left = lacking(model)
    told = identification.useless or identification.unexplained
    if left or told:
        worst = max(left, key=lambda one: one.times, default=None)
        words = "" if worst is None else f"It leaves {worst.of_noise} in {worst.file}, {worst.of_motion}. "
        if told and (identification.useless or not left):
            words += full_stop(f"{told[0].upper()}{told[1:]}") + " "
        words += "The recordings hold something that the model does not, and the standard errors below may not hold."
        again = f"dashpot diagnose {shlex.join([yaml, *recordings])} -o diagnosis"
        ask = Code(f"What is missing{first} (with the options that the recordings were read with):", again)
        warning = Text(words, "warn", "▲ More than noise is left." if left else "▲ No rig has such a friction.")
        return [*([verdict(shown)] if verified else []), warning, ask, numbers]
    fmu = next((name for name in files if name.endswith(".fmu")), None)
    if verified:
        how = "Next, the same proof on a recording of your own; programs that load the model stand further below:"
        return [verdict(shown), Code(how, f"dashpot verify {shlex.quote(fmu or 'model.fmu')} recording.csv"), numbers]
    made = fmu or f"{yaml.removesuffix('.yaml')}.fmu"
    commands = f"dashpot export {shlex.join([yaml, made])}\ndashpot verify {shlex.join([made, *recordings])}"
    how = f"Next, as an FMU and proven on the recordings{first} (with the options that these were read with):"
    return [verdict(shown), Code(how, commands), numbers]


def _in_short(model: Oscillator) -> str:
    """The figures that every rig has, in a sentence."""
    known = machine(model)
    words = []
    for name, called in _FIRST.items():
        if name in known:
            words.append(f"{called} {quantity_text(known[name])}")
    return full_stop(", ".join(words))


def _methods(identification: Identification) -> tuple[Table, ...]:
    """FREEVIB, FORCEVIB and maximum likelihood beside one another; nothing where neither of the former has a result."""
    model = identification.oscillator
    unit = model.response.displacement_unit
    table = modal_table(identification.measured, unit, model.force_unit, model, length=as_recorded(model, 1.0, unit))
    return () if table is None else (table,)


def _backbones(identification: Identification, verification: Verification | None) -> list[Block]:
    kind = backbone_kind(identification.oscillator)
    fmu = "; markers: the same taken from the FMU's output" if verification is not None else ""
    caption = (
        "The paper's Fig. 4. Dash-dot: backbones of the free decays by FREEVIB (Eq. 12); dotted: backbones of the "
        f"forced records by FORCEVIB; thin: the model's {kind} backbone; dashed: the model's response by Eq. 14 to a "
        f"sine of the recorded level{fmu}. Right: the backbones alone, over a logarithmic amplitude."
    )
    blocks = [picture(lambda: backbone_figure(identification, verification), caption)]
    if identification.measured.curves:
        caption = (
            "The same backbones as their distance from the model's mean natural frequency, which is what FREEVIB and "
            "FORCEVIB measure. A model that lacks something shows as a bend that all curves share."
        )
        blocks.append(picture(lambda: distance_figure(identification, verification), caption))
    return blocks


def _characteristics(identification: Identification) -> list[Block]:
    points = (
        " Points: from the measured backbones, describing function inverted, so that they are forces and not their "
        "fundamentals (Eq. 15 as printed gives the latter)."
    )
    return [
        picture(
            lambda: stiffness_figure(identification),
            "Static characteristic of the spring per unit mass (the paper's Fig. 5), whole and without its linear part."
            + points,
        ),
        picture(
            lambda: friction_figure(identification),
            "Damping curve h(A) (viscous = 2 h) and friction force per unit mass over velocity (the paper's Fig. 7), "
            "whole and without its viscous part." + points.replace("backbones", "damping curves"),
        ),
    ]


def _recordings(identification: Identification) -> list[Block]:
    kinds = [r.get("kind", "") for r in identification.oscillator.identified.recordings]
    rows = []
    for i, r in enumerate(identification.recordings):
        peak = said(r, float(np.max(np.abs(r.response))))
        force = "none" if r.force is None else said(r, float(np.max(np.abs(r.force))), force=True)
        kind = str(kinds[i]) if i < len(kinds) else ""
        length = f"{number(r.duration, 4)} s"
        decays = str(len(identification.hilbert.decays[i]))
        rows.append((r.name, kind, length, f"{number(r.fs, 5)} Hz", peak, force, decays))
    head = ("Recording", "Kind", "Length", "Sampled at", "Largest response", "Largest force", "Free decays")
    blocks: list[Block] = [Table(head, tuple(rows), (2, 3, 4, 5, 6)), *used_table(identification)]
    for i, r in enumerate(identification.recordings):
        stretches = taken(identification, i)
        caption = f"{plain_text(r.name)} as recorded. {_shaded(stretches)}"
        where, why, _ = left(identification, i)
        if where:
            caption += f" Left: {where}. {full_stop(why[:1].upper() + why[1:])}"
        notes = [note for note in r.notes if note.removeprefix(f"{r.name}: ") not in why]
        caption += "".join(f" {note}" for note in notes)
        rest = left_pieces(identification, i)
        blocks.append(
            picture(
                lambda r=r, t=stretches, i=i, rest=rest: recording_figure(r, t, f"recording-{i + 1}", rest), caption
            )
        )
    return blocks


def _shaded(stretches: Sequence[Taken]) -> str:
    """What the colours of what was fitted stand for."""
    kinds = [kind for kind in SHADES if any(kind == found for found, _, _ in stretches)]
    if not kinds:
        return "Nothing of it was fitted."
    return f"Shaded: what was fitted, {', '.join(f'{SHADES[kind][0]} where it is {kind}' for kind in kinds)}."


def _certainty(identification: Identification) -> list[Block]:
    blocks: list[Block] = []
    table = correlation_table(identification.oscillator)
    if table is not None:
        blocks.append(table)
    notes = [*identification.notes, *model_warnings(identification.oscillator)]
    sentences = tuple(dict.fromkeys(full_stop(note) for note in notes))
    if sentences:
        blocks += [Text("Take note:"), Items(sentences)]
    else:
        blocks.append(
            Text("The identification has nothing to remark: no parameter is poorly known, none has an odd sign.")
        )
    return blocks


def _validity(identification: Identification) -> list[Block]:
    model = identification.oscillator
    rows = []
    for name, span in (("amplitude", model.amplitude), ("frequency", model.frequency)):
        if span is not None:
            (low, unit), (high, _) = (as_recorded(model, value, span.unit) for value in (span.min, span.max))
            scale = scale_of(unit, high) if unit == span.unit else Scale(1.0, pretty_unit(unit))
            rows.append((name, *(number(v * scale.factor, 4) for v in (low, high)), scale.unit))
    if not rows:
        return [Text("The model states no range; judge for yourself how far it reaches.")]
    return [
        Table(("Range", "From", "To", "Unit"), tuple(rows), (1, 2)),
        Text("This is what the recordings covered. Beyond it the model is an extrapolation."),
    ]


def _provenance(identification: Identification, files: Sequence[str]) -> list[Block]:
    provenance = identification.oscillator.identified
    fit = identification.fit
    rest = "came to rest" if fit.converged else "was stopped at its limit"
    how = (
        f"Method: {provenance.method or 'not stated'}, "
        f"direct estimates from {_SOURCES[identification.hilbert.source]}; "
        f"the search {rest} after {fit.iterations} steps"
        + ("" if provenance.log_likelihood is None else f", log likelihood {number(provenance.log_likelihood, 7)}")
        + f". Software: {provenance.software or 'not stated'}."
    )
    blocks: list[Block] = [*recordings_table(provenance), Text(how)]
    unit = pretty_unit(identification.oscillator.response.unit)
    blocks.append(Text(f"Response: {identification.oscillator.response.quantity} in {unit}."))
    return [*blocks, *files_text(files)]
