"""A model in words: what ``dashpot show`` prints, and the same as data for other programs."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from .as_recorded import as_recorded, parameter_as_recorded, recorded_response
from .fit_state import faults_of_recordings, left_of, left_over, state_of_fit
from .oscillator import HOLDS
from .physical import machine, machine_words

if TYPE_CHECKING:
    from .element import Element
    from .oscillator import Oscillator, Provenance, Range
    from .parameter import Parameter

STRONG = 0.9  # correlation above which two parameters are hard to tell apart
_MEANING = {
    "viscous": "damping that feeds the motion",
    "dry": "friction that pushes the motion on",
    "preload": "a spring that pushes off the middle position",
}


def describe(oscillator: Oscillator) -> str:
    """The model as text: equation, parameters with error and percent, correlations, validity, origin, warnings."""
    o = oscillator
    equation = o.equation().replace("; ", "\n  ")
    parts = [f"{o.name}\n\n  {equation}", "Parameters\n" + "\n".join(_table(o))]
    parts.append(f"As the machine has it{o.over_what_drives}\n" + "\n".join(columns_text(machine_table(o))))
    for term in o.terms:
        parts.append(f"{term.effect} ({term.law.path})\n  {term.law.sentence}")
    strong = [f"  {first} and {second}: {value:+.3f}" for first, second, value in strong_correlations(o)]
    if strong:
        parts.append(
            f"Correlations above {STRONG:g} (such a pair is known better together than each alone)\n"
            + "\n".join(strong)
        )
    parts.append("Valid for (what the recordings covered)\n" + "\n".join(_validity(o)))
    parts.append("Identified from\n" + "\n".join(origin_lines(o)))
    noted = warnings(o)
    if noted:
        parts.append("Take note\n" + "\n".join(f"  - {sentence}" for sentence in noted))
    return "\n\n".join(parts) + "\n"


def as_json(oscillator: Oscillator) -> dict[str, Any]:
    """The same as plain data for ``json.dumps``: numbers with their units, None where something is not known."""
    o = oscillator
    words = o.descriptions()
    return {
        "format": "dashpot-show/1",
        "name": o.name,
        "equation": o.equation(),
        "mass_known": o.mass is not None,
        "parameters": {
            name: {
                "value": float(p.value),
                "std": finite(p.std),
                "percent": percent(p),
                "unit": p.unit,
                "description": words[name],
            }
            for name, p in o.parameters().items()
        },
        "machine": {
            name: {"value": float(p.value), "std": finite(p.std), "percent": percent(p), "unit": p.unit}
            for name, p in machine(o).items()
        },
        "terms": [{"effect": t.effect, "path": t.law.path, "sentence": t.law.sentence} for t in o.terms],
        "response": {"quantity": o.response.quantity, "unit": o.response.unit},
        "excitation": {"unit": o.force_unit, "hold": o.hold},
        "valid": valid_as_json(amplitude=o.amplitude, frequency=o.frequency),
        "identified": identified_as_json(o.identified),
        "correlations": [
            {"parameters": [first, second], "correlation": value} for first, second, value in strong_correlations(o)
        ],
        "state_of_fit": state_of_fit(o),
        "warnings": warnings(o),
    }


def valid_as_json(**covered: Range | None) -> dict[str, Any]:
    """Ranges that the recordings covered, by their names."""
    return {
        name: None if r is None else {"min": float(r.min), "max": float(r.max), "unit": r.unit}
        for name, r in covered.items()
    }


def identified_as_json(identified: Provenance) -> dict[str, Any]:
    """Where numbers come from."""
    return {
        "recordings": [dict(recording) for recording in identified.recordings],
        "method": identified.method,
        "software": identified.software,
        "commit": identified.commit or None,
        "versions": dict(identified.versions),
        "command": identified.command or None,
        "parameters": list(identified.parameters),
        "covariance": None
        if identified.covariance is None
        else [[float(c) for c in row] for row in identified.covariance],
        "log_likelihood": finite(identified.log_likelihood),
    }


def finite(value: float | None) -> float | None:
    """A number for JSON, which has no infinity and no NaN: None in their place."""
    return None if value is None or not math.isfinite(value) else float(value)


def percent(parameter: Parameter) -> float | None:
    """Standard error in percent of the value; None where it is missing or endless, or the value is zero."""
    if parameter.std is None or parameter.value == 0 or not math.isfinite(parameter.std):
        return None
    return float(100 * parameter.std / abs(parameter.value))


def strong_correlations(oscillator: Oscillator) -> list[tuple[str, str, float]]:
    """Pairs of parameters whose estimates are correlated above 0.9 in size, strongest first."""
    provenance = oscillator.identified
    rows = provenance.covariance
    if rows is None:
        return []
    names = provenance.parameters or tuple(oscillator.parameters())
    pairs = []
    for i in range(len(rows)):
        for j in range(i):
            scale = math.sqrt(max(rows[i][i], 0.0)) * math.sqrt(max(rows[j][j], 0.0))
            if scale > 0 and abs(rows[i][j]) > STRONG * scale:
                pairs.append((names[j], names[i], float(rows[i][j] / scale)))
    return sorted(pairs, key=lambda pair: -abs(pair[2]))


def warnings(oscillator: Oscillator) -> list[str]:
    """What a user should know before using the numbers, one sentence each."""
    o = oscillator
    parameters = o.parameters()
    noted = [f"{sentence}." for sentence in (*left_over(o), *faults_of_recordings(o))]
    noted += [sentence for name, p in parameters.items() if (sentence := _negative(o, name, p))]
    for name, p in parameters.items():
        if p.std and p.value > 0 and p.std > 0.5 * p.value:
            if not math.isfinite(p.std):
                known = "not known at all"
            elif p.std > p.value:  # then a share of the value says nothing, least where that is all but zero
                known = f"no larger than its error, {p.std:.2g} {p.unit}"
            else:
                known = f"known to {percent(p):.0f} % only"
            noted.append(f"{name} is {known}: these recordings do not carry it; record where it matters, or fix it.")
    if o.cubic.value < 0 and not o.terms:
        noted.append(_softening(o))
    if o.mass is None:
        what = "minus the acceleration of the base" if o.is_base_driven else "a force per unit mass"
        noted.append(f"The mass is not known ({o.why_no_mass}): the input is {what}.")
    if all(p.std is None for p in parameters.values()):
        noted.append("No parameter has a standard error: the numbers were given, not measured.")
    return noted


def _negative(o: Oscillator, name: str, p: Parameter) -> str | None:
    """A sentence where a parameter is negative that nature wants positive."""
    path = next((t.law.path for t in o.terms if name.startswith(f"{t.effect}.")), None)
    meaning = _MEANING.get(name) or (_MEANING["viscous"] if path == "dissipation" else None)
    if meaning is None or p.value >= 0:
        return None
    if p.std is not None and p.value > -2 * p.std:
        return f"{name} is negative but within two standard errors of zero: these recordings may hold none of it."
    return (
        f"{name} is negative, {meaning}: a sign that the model lacks something and this parameter makes up for it; "
        "do not trust it beyond what was recorded."
    )


def _softening(o: Oscillator) -> str:
    """Where a softening spring stops pulling back harder, and where it lets go: x² = omega0² / (3|c|) and / |c|."""
    top = o.omega0.value / math.sqrt(3 * -o.cubic.value)
    cubic = o.cubic
    if cubic.std and cubic.value > -2 * cubic.std:
        return (
            "cubic is negative but within two standard errors of zero: these recordings may hold none of it, and "
            f"a simulation beyond {_length(o, top * math.sqrt(3))} does not come back; fix it (--fix cubic=0) to go on."
        )
    reach = "" if o.amplitude is None else f"; the recordings reach {_length(o, o.amplitude.max)}"
    return (
        f"cubic is negative: the spring's force falls beyond {_length(o, top)} and no longer pulls back beyond "
        f"{_length(o, top * math.sqrt(3))}{reach}. A simulation that goes there does not come back."
    )


def _table(o: Oscillator) -> list[str]:
    return columns_text(parameter_cells(o))


def parameter_cells(o: Oscillator) -> list[tuple[str, ...]]:
    """A row a parameter: name, value, error, percent, unit, meaning."""
    words = o.descriptions()
    cells = [
        (name, value, f"± {error}" if error else "", _percent_text(p), p.unit, words[name] + _besides(o, name, p))
        for name, p in o.parameters().items()
        for value, error in [value_and_error(p)]
    ]
    if o.mass is None:
        cells.insert(0, ("mass", "unknown", "", "", "", o.why_no_mass))
    return cells


def machine_table(o: Oscillator) -> list[tuple[str, ...]]:
    """As ``parameter_cells``, of what a drawing or a data sheet states: kg, N/m, N s/m, N, Hz, damping ratio."""
    words = machine_words(o)
    return [
        (name, value, f"± {error}" if error else "", _percent_text(p), "" if p.unit == "1" else p.unit, words[name])
        for name, p in machine(o).items()
        for value, error in [value_and_error(p)]
    ]


def columns_text(cells: Sequence[tuple[str, ...]]) -> list[str]:
    """Rows of cells as lines, one column below the other; the last column is not filled up."""
    last = len(cells[0]) - 1
    width = [max(len(cell[i]) for cell in cells) for i in range(last)]
    return [
        "  "
        + "  ".join(
            [*(f"{cell[i]:{'<' if i in (0, 2, 4) else '>'}{width[i]}}" for i in range(last)), cell[last]]
        ).rstrip()
        for cell in cells
    ]


def value_and_error(parameter: Parameter) -> tuple[str, str]:
    """Value and error as text, both to the second digit of the error; the error is empty where there is none."""
    value, std = float(parameter.value), parameter.std
    if not std or not math.isfinite(std):
        return f"{value:.6g}", "0" if std == 0 else "" if std is None else f"{std:g}"
    last = math.floor(math.log10(std)) - 1  # place of the error's second digit
    size = math.floor(math.log10(max(abs(value), std)))
    if size - last > 14:  # an error below what a float can tell
        return f"{value:.15g}", f"{std:.1e}"
    if -4 <= size < 7 and last <= 0:
        return f"{round(value, -last) + 0.0:.{-last}f}", f"{std:.{-last}f}"  # and not -0
    digits = max(size - last, 1)
    return f"{value:.{digits}e}", f"{std:.1e}"


def _percent_text(p: Parameter) -> str:
    share = percent(p)
    return "" if share is None else f"({share:.2g} %)" if share < 99.5 else f"({share:.0f} %)"


def _besides(o: Oscillator, name: str, p: Parameter) -> str:
    """A frequency in Hz, a length of a law in the unit as recorded."""
    if name == "omega0":
        return f", {p.value / (2 * math.pi):.6g} Hz"
    return f", {in_words}" if "." in name and (in_words := recorded_words(o, p)) else ""


def recorded_words(o: Oscillator, parameter: Parameter) -> str:
    """A length, speed or acceleration in the unit as recorded: ``1.200 ± 0.010 mm``; empty where that is its own."""
    shown = parameter_as_recorded(o, parameter)
    if shown.unit == parameter.unit:
        return ""
    value, error = value_and_error(shown)
    return f"{value}{f' ± {error}' if error else ''} {shown.unit}"


def _length(o: Oscillator, value: float) -> str:
    """A displacement in the unit as recorded, to three digits."""
    shown, unit = as_recorded(o, value, o.response.displacement_unit)
    return f"{shown:.3g} {unit}"


def span_words(model: Oscillator | Element, span: Range) -> str:
    """What was covered, in the unit as recorded: ``0.1 to 5.8 mm``."""
    (low, unit), (high, _) = (as_recorded(model, value, span.unit) for value in (span.min, span.max))
    return f"{low:.4g} to {high:.4g} {unit}"


def _validity(o: Oscillator) -> list[str]:
    ranges = []
    for name, r in (("amplitude", o.amplitude), ("frequency", o.frequency)):
        if r is not None:
            ranges.append(f"  {name:<10} {span_words(o, r)}")
    force = [] if o.mass is None else [f"  force      {HOLDS[o.hold]} (hold: {o.hold})"]
    recorded = recorded_response(o)
    besides = f", recorded in {recorded}" if recorded != o.response.unit else ""
    return [*(ranges or ["  not stated"]), f"  response   {o.response.quantity} in {o.response.unit}{besides}", *force]


def origin_lines(o: Oscillator | Element) -> list[str]:
    """Where the numbers come from: each recording with what is left of it, then method and software."""
    provenance = o.identified
    left = {one.file: f"; left {one.of_noise}, {one.of_motion}" for one in left_of(o)}
    lines = [
        f"  {_recording(recording)}{left.get(str(recording.get('file')), '')}{_zero(o, recording)}"
        for recording in provenance.recordings
    ]
    lines = lines or ["  not stated"]
    likelihood = None if provenance.log_likelihood is None else f"log likelihood {provenance.log_likelihood:.6g}"
    how = [part for part in (provenance.method, provenance.software, likelihood) if part]
    return [*lines, *([f"  by {', '.join(how)}"] if how else [])]


def _zero(o: Oscillator | Element, recording: Mapping[str, Any]) -> str:
    """What the sensor shows at rest, where that stands out."""
    if recording.get("zero") is None:
        return ""
    value, unit = as_recorded(o, float(recording["zero"]), o.response.unit)
    return f"; at zero its sensor shows {value:.4g} {unit}"


def _recording(recording: Mapping[str, Any]) -> str:
    kind, sha256 = recording.get("kind"), recording.get("sha256")
    return (
        f"{recording.get('file', '?')}"
        + (f" ({kind})" if kind else "")
        + (f", sha256 {sha256[:12]}…" if sha256 else "")
    )
