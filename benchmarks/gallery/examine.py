"""One entry through the commands: identify, simulate, diagnose, simulate again, verify; a plain fit beside them."""

from __future__ import annotations

import json
import math
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from . import inputs, plain
from .command import Run, run
from .entry import Entry, Piece
from .outcome import Effect, Errors, Outcome

MODEL, DIAGNOSIS = "model.yaml", "diagnosis"
#: Seconds for a command, and of a diagnosis in a quick look.
LIMIT, SHORT = 600.0, 60.0
_NOT_PARAMETERS = ("format", "name", "terms", "response", "valid", "identified")


def examine(entry: Entry, data: Path, work: Path, limit: float = LIMIT, quick: bool = False) -> Outcome:
    """Run an entry in the folder `work`, which is made anew; every command has `limit` seconds.

    A quick look gives the diagnosis less time and leaves the FMU out. Raises OSError where files cannot be written.
    """
    shutil.rmtree(work, ignore_errors=True)
    inputs.prepare(entry, data, work)
    training = [piece.file for piece in entry.training]
    runs = [run(["identify", *training, *entry.options, "-o", MODEL], work, limit)]
    diagnosis: dict[str, Any] = {}
    if (work / MODEL).is_file():
        runs += _simulations(entry, MODEL, "before", work, limit)
        held_out = [word for piece in entry.holdout for word in ("--holdout", piece.file)]
        words = ["diagnose", MODEL, *training, *held_out, *entry.options, "-o", DIAGNOSIS]
        runs.append(run(words, work, min(limit, SHORT) if quick else limit))
        if (work / DIAGNOSIS / "diagnosis.json").is_file():
            diagnosis = json.loads((work / DIAGNOSIS / "diagnosis.json").read_text(encoding="utf-8"))
            runs += _simulations(entry, f"{DIAGNOSIS}/{MODEL}", "after", work, limit)
            if (work / DIAGNOSIS / "model.fmu").is_file() and not quick:
                words = ["verify", f"{DIAGNOSIS}/model.fmu", *training, *entry.options, "--json", "verify.json"]
                runs.append(run(words, work, limit))
    return assemble(entry, work, runs, diagnosis)


def _simulations(entry: Entry, model: str, name: str, work: Path, limit: float) -> list[Run]:
    """The free run of a model over the motion of every piece; files NAME-FILE.csv.gz."""
    runs = []
    for piece in entry.pieces:
        part = () if piece.motion is None else ("--part", f"{piece.motion[0]}:{piece.motion[1]}")
        words = ["simulate", model, piece.file, *entry.options, *part, "-o", simulated_file(name, piece)]
        runs.append(run(words, work, limit))
    return runs


def simulated_file(name: str, piece: Piece) -> str:
    """Where the free run of the model ``before`` or ``after`` along a piece is kept."""
    return f"{name}-{piece.file.partition('.')[0]}.csv.gz"


def assemble(entry: Entry, work: Path, runs: Sequence[Run], diagnosis: Mapping[str, Any]) -> Outcome:
    """What the commands left behind in `work`, put together; `diagnosis` is the content of diagnosis.json, or empty."""
    model = work / MODEL
    last = runs[-1]
    if diagnosis:
        verdict, sentence = str(diagnosis["verdict"]), str(diagnosis.get("sentence", ""))
    else:
        # one that ended well and wrote nothing is a fault too
        verdict, sentence = ("fault" if last.end == "done" else last.end), last.last_line
    effects = tuple(_effect(entry, effect) for effect in diagnosis.get("effects", ()))
    return Outcome(
        entry.name,
        verdict,
        _right(entry, verdict, effects),
        sentence,
        _parameters(yaml.safe_load(model.read_text(encoding="utf-8"))) if model.is_file() else {},
        effects,
        _errors(entry, work),
        tuple(
            (row["file"], role, *(_percent(row[key]) for key in ("nrmse_before", "nrmse_after", "noise_floor")))
            for role, rows in (("training", "train"), ("holdout", "holdout"))
            for row in diagnosis.get("fit", {}).get(rows, ())
        ),
        tuple((" ".join(step.arguments[:2]), step.end, step.exit_code, step.seconds, step.last_line) for step in runs),
        tuple(dict.fromkeys(note for step in runs for note in step.notes)) + tuple(diagnosis.get("notes", ())),
        _words(diagnosis.get("remainder")),
    )


def _effect(entry: Entry, effect: Mapping[str, Any]) -> Effect:
    """A named effect and whether it is documented, alone or in its group."""
    group = tuple(effect.get("indistinguishable_from", ()))
    if effect["effect"] in entry.documented:
        counts = "in the group" if group else "alone"
    else:
        counts = "in the group" if set(group) & set(entry.documented) else "not documented"
    return Effect(effect["effect"], effect.get("odds"), group, counts)


def _right(entry: Entry, verdict: str, effects: Sequence[Effect]) -> bool:
    """Whether the verdict says what is documented."""
    if entry.kind == "imposed":
        return verdict == "refused"
    if verdict == "consistent":
        return entry.linear
    return verdict == "missing-physics" and bool(effects) and effects[0].counts != "not documented"


def _parameters(model: Mapping[str, Any]) -> dict[str, tuple[float | None, float | None, str]]:
    """Parameters of a model file, those of its terms as EFFECT.NAME."""
    values = {name: value for name, value in model.items() if name not in _NOT_PARAMETERS}
    for term in model.get("terms") or ():
        values |= {f"{term['effect']}.{name}": value for name, value in term["parameters"].items()}
    return {
        name: (_number(value.get("value")), _number(value.get("std")), str(value.get("unit", "")))
        for name, value in values.items()
        if isinstance(value, Mapping)
    }


def _number(value: Any) -> float | None:
    """PyYAML reads 1e-3 as text."""
    return None if value is None else float(value)


def _words(value: Any) -> str:
    """A sentence, or what a graded remainder states, as text."""
    return "" if value is None else value if isinstance(value, str) else json.dumps(value)


def _percent(value: float | None) -> float | None:
    return 100 * float(value) if value is not None and math.isfinite(value) else None


def _errors(entry: Entry, work: Path) -> tuple[Errors, ...]:
    """The errors of every piece: before, after, and by the plain fit."""
    plain_errors = _plain(entry, work)
    rows = []
    for role, pieces in (("training", entry.training), ("holdout", entry.holdout), ("test", entry.tests)):
        for piece in pieces:
            before, after = (_simulated(work / simulated_file(name, piece), piece) for name in ("before", "after"))
            rows.append(
                Errors(piece.file, role, before[0], after[0], plain_errors.get(piece.file), before[1], after[1])
            )
    return tuple(rows)


def _simulated(path: Path, piece: Piece) -> tuple[float | None, float | None]:
    """NRMSE in per cent and rms in the unit of the response, of what ``dashpot simulate`` wrote."""
    if not path.is_file():
        return None, None
    measured, simulated = inputs.table(path)[1][:, -2:].T
    begin, end = piece.judged or (0, None)
    residual = (simulated - measured)[begin:end]
    rms = float(np.sqrt(np.mean(residual**2)))
    if not math.isfinite(rms):
        return None, None
    return 100 * rms / float(np.std(measured[begin:end])), rms if piece.judged else None


def _plain(entry: Entry, work: Path) -> dict[str, float]:
    """What a linear oscillator leaves, in per cent: fitted to the first training piece, tried on the others.

    Its runs are kept as plain-FILE.csv.gz, over the motion of each piece.
    """
    if entry.columns is None:
        return {}
    errors: dict[str, float] = {}
    oscillator = None
    for piece in entry.pieces:
        dt, response, force = inputs.signals(entry.columns, work / piece.file)
        begin, end = (round(edge / dt) for edge in piece.motion or (0.0, dt * response.size))
        response, force = response[begin:end], None if force is None else force[begin:end]
        if oscillator is None:
            oscillator = plain.fit(dt, response, force, entry.columns.quantity)
            simulated = oscillator.simulated
        elif force is not None:
            simulated = plain.held_out(oscillator, dt, response, force, entry.columns.quantity)
        else:
            continue
        first, last = piece.judged or (0, None)
        residual = (simulated - response)[first:last]
        errors[piece.file] = 100 * float(np.sqrt(np.mean(residual**2)) / np.std(response[first:last]))
        kept = np.column_stack([np.arange(response.size) * dt + begin * dt, response, simulated])
        np.savetxt(
            work / simulated_file("plain", piece), kept, "%.9g", ",", header="time_s,measured,plain", comments=""
        )
    return errors
