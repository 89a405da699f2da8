"""What came out for one entry: figures and sentences, as they stand in gallery.json."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any


@dataclass(frozen=True)
class Errors:
    """Errors of one file, rms(simulated - measured) / std(measured) in per cent; None where nothing simulates.

    Attributes:
        file: as the commands saw it.
        role: ``training``, ``holdout`` or ``test``.
        before: free run of the identified model, by ``dashpot simulate``.
        after: of the mended one.
        plain: of the linear oscillator that the gallery fits itself.
        rms_before, rms_after: in the unit of the response, over the samples that a published figure counts.
    """

    file: str
    role: str
    before: float | None = None
    after: float | None = None
    plain: float | None = None
    rms_before: float | None = None
    rms_after: float | None = None

    @property
    def reached(self) -> float | None:
        """The error of the best model there is: the mended one, else the identified one."""
        return self.before if self.after is None else self.after


@dataclass(frozen=True)
class Effect:
    """A named effect: its odds where they are given, what it cannot be told from, and how it counts.

    `counts` is ``alone`` or ``in the group`` where it is documented, else ``not documented``.
    """

    effect: str
    odds: float | None
    group: tuple[str, ...]
    counts: str


@dataclass(frozen=True)
class Outcome:
    """One entry, run.

    Attributes:
        name: of the entry.
        verdict: one of ``entry.VERDICTS``; an entry whose diagnosis was not run has that of identification, or "".
        right: whether the verdict says what is documented; None where nothing was said.
        sentence: the diagnosis', or the last line of what was refused or broke down.
        parameters: name to (value, standard error, unit).
        effects: named, the most important first.
        errors: by file.
        judged: the diagnosis' own table: file, ``training`` or ``holdout``, before, after and noise in per cent.
        steps: command, how it ended, exit code, seconds, last line of stderr.
        notes: what identification and diagnosis remarked.
        remainder: what the diagnosis says is left.
    """

    name: str
    verdict: str
    right: bool | None
    sentence: str
    parameters: Mapping[str, tuple[float | None, float | None, str]]
    effects: tuple[Effect, ...]
    errors: tuple[Errors, ...]
    judged: tuple[tuple[str, str, float | None, float | None, float | None], ...]
    steps: tuple[tuple[str, str, int | None, float, str], ...]
    notes: tuple[str, ...] = ()
    remainder: str = ""

    @property
    def seconds(self) -> float:
        """All commands together."""
        return sum(step[3] for step in self.steps)

    def error(self, role: str) -> float | None:
        """The worst error reached over files of that role; for ``holdout`` the diagnosis' own where it chose."""
        reached = [errors.reached for errors in self.errors if errors.role == role]
        if role == "holdout" and not reached:
            reached = [row[3] for row in self.judged if row[1] == role]
        known = [value for value in reached if value is not None]
        return max(known) if known and len(known) == len(reached) else None


def as_json(outcome: Outcome) -> dict[str, Any]:
    """An outcome as plain values."""
    return asdict(outcome) | {"seconds": round(outcome.seconds, 1)}


def from_json(values: Mapping[str, Any]) -> Outcome:
    """An outcome from what `as_json` made of it, read back; raises KeyError or TypeError for anything else."""
    known = {name: values[name] for name in (field.name for field in fields(Outcome))}
    known |= {
        "parameters": {name: tuple(value) for name, value in values["parameters"].items()},
        "effects": tuple(Effect(**(effect | {"group": tuple(effect["group"])})) for effect in values["effects"]),
        "errors": tuple(Errors(**errors) for errors in values["errors"]),
        "judged": tuple(tuple(row) for row in values["judged"]),
        "steps": tuple(tuple(row) for row in values["steps"]),
        "notes": tuple(values["notes"]),
    }
    return Outcome(**known)
