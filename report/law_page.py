"""The library of laws as pages of Markdown, made from the laws themselves: what each is, and how it is known."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType

from ..model.display import number, pretty_unit
from ..model.effect_words import phrase_of
from ..model.law import Law, LawParameter
from ..model.laws import BASE, LIBRARY, PRESCRIBED
from ..model.units import compose
from .law_figure import example, harmonics

#: Where a law lives, for a person who stands before the machine.
PLACES = {
    "restoring": "what pulls the mass back: springs, seats, stops, gravity",
    "dissipation": "what brakes the motion: dampers, bearings, seals, air, oil",
    "memory": "what remembers the way it came: joints, wire ropes, rubber",
    "inertia": "what moves along: cables, brackets, a second mode",
    "excitation": "between the recorded force and the mass: amplifier, shaker, stinger",
    "measurement": "between the motion and the record: sensor, amplifier, filter",
    "either": "on the way of the force or of the record: electronics, filters",
    "environment": "what changes by itself: warming, creep, loosening, a fan nearby",
}


def laws() -> tuple[Law, ...]:
    """All laws: those of Eq. 17 first."""
    return (*BASE, *LIBRARY.values(), *PRESCRIBED.values())


def page_name(law: Law) -> str:
    """Name of the law's page and pictures, without a suffix."""
    return law.name.replace("/", "-")


def law_page(law: Law, picture: str, named: Mapping[str, Sequence[str]] = MappingProxyType({})) -> str:
    """A page on one law; ``picture`` is where its figure lies, as seen from the page.

    ``named`` has pages on which a diagnosis named the law, as links, each with its recordings.
    """
    phrase = phrase_of(law)
    lines = "<br>".join(f"`{line}`" for line in law.in_words(str).split("; "))
    kept = "–" if law.force is None else "yes" if law.stored is not None else "no: all power it takes is dissipated"
    where = ", where [the motion was prescribed](../prescribed.md)" if law.name in PRESCRIBED else ""
    usage = (
        "One of the five laws of Eq. 17, in every model; `--fix NAME=VALUE` keeps a parameter of it."
        if law in BASE
        else f"`dashpot identify ... --with {law.name}` fits it; `dashpot diagnose` looks for it of itself{where}."
    )
    return "\n".join(
        [
            f"# {law.name}",
            "",
            f"*{phrase[:1].upper()}{phrase[1:]}.*",
            "",
            law.sentence,
            "",
            "| | |",
            "|---|---|",
            f"| equation | {_cell(lines)} |",
            f"| in the machine | {law.path}: {PLACES[law.path]} |",
            f"| backbone and damping | {_cell(law.curves) or '–'} |",
            f"| stores energy | {kept} |",
            f"| source | {_cell(law.source)} |",
            "",
            usage,
            "",
            "## Parameters",
            "",
            "| name | unit | bounds | what it is | in the picture |",
            "|---|---|---|---|---|",
            *_parameters(law),
            "",
            "Units are for a displacement in m and a force in N; for a rotation read rad and N·m. "
            "Forces are per unit mass.",
            "",
            "## How it is known",
            "",
            f"![What {law.name} does, computed]({picture})",
            "",
            _tell_tale(law),
            "",
            *_where_named(named),
        ]
    )


def _where_named(named: Mapping[str, Sequence[str]]) -> list[str]:
    if not named:
        return []
    rows = [f"- {page}: `{'`, `'.join(files)}`" for page, files in named.items()]
    return ["## Where it was named", "", "By a diagnosis of these recordings:", "", *rows, ""]


def _parameters(law: Law) -> list[str]:
    values = example(law).having.values()
    return [
        f"| `{p.name}` | {pretty_unit(compose(p.unit, 'm'))} | {_bounds(p)} | {_cell(p.description)} | "
        f"{number(values[p.name if law in BASE else f'{law.name}.{p.name}'])} |"
        for p in law.parameters
    ]


def _bounds(p: LawParameter) -> str:
    low, high = (None if math.isinf(bound) else number(bound) for bound in (p.lower, p.upper))
    if low is None and high is None:
        return "none"
    return f"from {low}" if high is None else f"up to {high}" if low is None else f"{low} to {high}"


def _tell_tale(law: Law) -> str:
    pair = example(law)
    without = dict(harmonics(pair.without))
    found = [(order, level) for order, level in harmonics(pair.having) if level > without.get(order, -math.inf) + 1]
    alone = "The rig alone is a slightly hardening spring, which leaves a third harmonic of its own. "
    if not found:
        return f"{alone}Under a sine the law adds no harmonic above a thousandth of the fundamental."
    spoken = ", ".join(f"{order} ({number(100 * 10 ** (level / 20), 2)} %)" for order, level in found)
    even = all(order % 2 == 0 for order, _ in found)
    odd = all(order % 2 == 1 for order, _ in found)
    kind = (
        "even ones only, as of what differs between the two sides"
        if even
        else ("odd ones only, as of what is alike on both sides" if odd else "even and odd ones: the two sides differ")
    )
    return f"{alone}Under a sine the law adds or lifts harmonics, {kind}: {spoken} of the acceleration's fundamental."


def library_table() -> str:
    """A table of all laws by where they live, each with a link to ``library/NAME.md``."""
    parts = []
    for path, place in PLACES.items():
        rows = [
            f"| [{law.name}](library/{page_name(law)}.md) | {_cell(law.sentence)} | {_cell(law.curves)} |"
            for law in laws()
            if law.path == path
        ]
        parts.append(
            "\n".join(
                [
                    f"### {place[:1].upper()}{place[1:]}",
                    "",
                    "| law | what it is | how it is known |",
                    "|---|---|---|",
                    *rows,
                ]
            )
        )
    return "\n\n".join(parts) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")
