"""The gallery's own command line."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from . import compare, examine, inputs
from .catalogue import ENTRIES, PROOF
from .entry import Entry
from .outcome import Outcome, as_json, from_json

FORMAT = "dashpot-gallery/1"
JSON, PAGE = "gallery.json", "gallery.html"


def options() -> argparse.ArgumentParser:
    """What the command line takes."""
    parser = argparse.ArgumentParser(
        prog="recorded.py", description="Recordings that other people made, through the commands as a user would."
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(ENTRIES)}; all where none is given")
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="the same")
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        default=Path("recorded"),
        metavar="DIR",
        help=f"folder for {JSON}, {PAGE} and the files of each entry; entries that are not run keep what it holds of "
        f"them. FILE.json: the figures of {', '.join(PROOF)} (or those named) as the blind proof shows them",
    )
    parser.add_argument("--limit", type=float, default=examine.LIMIT, metavar="S", help="seconds for one command")
    parser.add_argument("--quick", action="store_true", help="the fast ones, a short diagnosis, no FMU")
    parser.add_argument(
        "--compare", type=Path, metavar="OLD.json", help=f"a {JSON} to stand beside; says what got worse"
    )
    parser.add_argument("--check", action="store_true", help="exit code 1 where a bound of an entry is broken")
    parser.add_argument("--page", action="store_true", help=f"run nothing, make {PAGE} again")
    return parser


def main(arguments: Sequence[str] | None = None, entries: Mapping[str, Entry] = ENTRIES) -> int:
    """Run the gallery; exit code 1 where ``--check`` finds a bound broken, 2 for wrong input."""
    parser = options()
    given = parser.parse_args(arguments)
    names = [*given.names, *given.only]
    if unknown := [name for name in names if name not in entries]:
        parser.error(f"no such recording: {', '.join(unknown)}; known: {', '.join(entries)}")
    if given.limit <= 0:
        parser.error("--limit: seconds for one command must be positive")
    try:
        old = read(given.compare) if given.compare else None
        if given.output.suffix == ".json":
            chosen = [entries[name] for name in names or PROOF]
            work = given.output.with_suffix("")
            outcomes = list(run(chosen, work, given.limit, given.quick, print))
            given.output.write_text(
                json.dumps([proof_row(outcome) for outcome in outcomes], indent=1), encoding="utf-8"
            )
            return 0
        kept = read(given.output / JSON) if (given.output / JSON).is_file() else {}
    except (OSError, ValueError, KeyError, TypeError) as problem:
        parser.error(f"{problem!s}; give a {JSON} that this program wrote, or another folder with -o")
    chosen = (
        [] if given.page else [entries[n] for n in names or entries if names or entries[n].quick or not given.quick]
    )
    ran: dict[str, Outcome] = {}
    given.output.mkdir(parents=True, exist_ok=True)
    for outcome in run(chosen, given.output, given.limit, given.quick, print):
        ran[outcome.name] = outcome
        write(given.output, kept | ran, entries)
    if given.page:
        ran = kept
        write(given.output, kept, entries)
    print(f"{given.output / PAGE}")
    if old is not None:
        print(compare.text(compare.compare(old, ran)))
    broken = [
        sentence
        for name in ran
        if name in entries
        for sentence in compare.broken(entries[name], ran[name], given.quick)
    ]
    if given.check:
        print("\n".join(broken) or "Every bound is kept.")
    return 1 if given.check and broken else 0


def run(
    chosen: Iterable[Entry], output: Path, limit: float, quick: bool, say: Callable[[str], object]
) -> Iterable[Outcome]:
    """Run entries one after the other, each in a folder of its own below `output`; those without files are left out."""
    data = inputs.data_folder()
    for entry in chosen:
        if absent := inputs.absent(entry, data):
            say(f"{entry.name}: {', '.join(absent)} not in {data}; set DASHPOT_DATA to the folder of the recordings")
            continue
        outcome = examine.examine(entry, data, output / entry.name, limit, quick)
        say(line(outcome))
        sys.stdout.flush()
        yield outcome


def line(outcome: Outcome) -> str:
    """An outcome in one line for a terminal."""
    named = " + ".join(effect.effect + (f" ({effect.odds:.3g})" if effect.odds else "") for effect in outcome.effects)
    roles = (("training", outcome.error("training")), ("held out", outcome.error("holdout")))
    errors = ", ".join(f"{words} {compare.percent(value)} %" for words, value in roles if value is not None)
    said = (
        f": {named}" if named else "" if outcome.verdict in ("consistent", "unexplained") else f": {outcome.sentence}"
    )
    return f"{outcome.name} ({outcome.seconds:.0f} s): {outcome.verdict}{said}{'; ' if errors else ''}{errors}"


def read(path: Path) -> dict[str, Outcome]:
    """Outcomes of a gallery.json by name; raises OSError, ValueError, KeyError or TypeError where it is none."""
    content = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise ValueError(f"{path}: is no {FORMAT}")
    return {values["name"]: from_json(values) for values in content["outcomes"]}


def write(folder: Path, outcomes: Mapping[str, Outcome], entries: Mapping[str, Entry]) -> None:
    """Write gallery.json and gallery.html, in the order of the catalogue; what it no longer has is dropped."""
    from .page import gallery_page

    ordered = {name: outcomes[name] for name in entries if name in outcomes}
    content = {"format": FORMAT, "outcomes": [as_json(outcome) for outcome in ordered.values()]}
    (folder / JSON).write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    (folder / PAGE).write_text(gallery_page(ordered, entries, folder), encoding="utf-8")


def proof_row(outcome: Outcome) -> dict[str, Any]:
    """An outcome as the scoreboard of the blind proof shows it: errors as parts of one, rms in milli-units."""
    tested = [errors for errors in outcome.errors if errors.rms_before is not None]
    return {
        "name": outcome.name,
        "verdict": outcome.verdict,
        "sentence": outcome.sentence,
        "laws": [effect.effect for effect in outcome.effects],
        "records": [
            [file, role == "holdout", *(None if value is None else value / 100 for value in values)]
            for file, role, *values in outcome.judged
        ],
        "notes": list(outcome.notes),
        "seconds": outcome.seconds,
        "tests": [
            [f"test {errors.file.partition('.')[0]}", 1e3 * errors.rms_before, 1e3 * errors.rms_after, "mV"]
            for errors in tested
            if errors.rms_before is not None and errors.rms_after is not None
        ],
    }
