"""What became of an entry: the JSON that is kept of it, ``dashpot-entry/1``."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, get_args
from typing import Literal as _Literal

#: ``good``: the model leaves no more than noise, or than ``max-left`` allows. ``mended``: a diagnosis named what was
#: missing, and nothing remains. ``doubtful``: a model that leaves more. ``bad-input`` and ``fault`` would come again;
#: ``killed``, ``timeout`` and ``memory`` need not. ``open``: nothing was done yet.
State = _Literal["good", "mended", "doubtful", "bad-input", "fault", "killed", "timeout", "memory", "open"]
STATES: tuple[str, ...] = get_args(State)
#: Rows that are done and believed.
BELIEVED = ("good", "mended")
#: What is tried again in the next run; the rest is tried again when its key changes.
TRIED_AGAIN = ("killed", "timeout", "memory")
FORMAT = "dashpot-entry/1"
#: Rows of an entry's curve.
CURVE = ("amplitude", "damping_ratio")


@dataclass(frozen=True)
class Outcome:
    """One entry's result.

    Attributes:
        key: of the entry that it is the result of.
        name: of the entry.
        state: one of STATES.
        sentence: for a person.
        stage: ``identify`` or ``diagnose``, the one that it comes from.
        wanted: whether a diagnosis is still to be made.
        attempts: how often that stage was begun and did not end by itself.
        seconds: that each stage took, by its name.
        parameters: value, std and unit by name, of the model that is given.
        recordings: what the model leaves of each, as in the model file.
        model, page: their files, below the entry's folder; None where there is none.
        verdict, effects: of the diagnosis.
        curve: damping ratio over the amplitude, by ``CURVE``: as many numbers of each, in the ``unit`` of the first;
            nothing where no range of amplitudes is known.
        picture: size of the motion over time, 0 to 1, and ``left``: of what the model leaves, in the same scale.
        notes: what a user should know.
        files: hash of each of the entry's other files by its name below the entry's folder.
    """

    key: str
    name: str
    state: State
    sentence: str
    stage: str = "identify"
    wanted: bool = False
    attempts: int = 0
    seconds: Mapping[str, float] = field(default_factory=dict)
    parameters: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    recordings: tuple[Mapping[str, Any], ...] = ()
    model: str | None = None
    page: str | None = None
    verdict: str | None = None
    effects: tuple[str, ...] = ()
    curve: Mapping[str, Any] = field(default_factory=dict)
    picture: tuple[float, ...] = ()
    left: tuple[float, ...] = ()
    notes: tuple[str, ...] = ()
    files: Mapping[str, str] = field(default_factory=dict)

    @property
    def finished(self) -> bool:
        """Whether nothing is left to be done for it."""
        return self.state not in (*TRIED_AGAIN, "open") and not self.wanted

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        return {"format": FORMAT, **asdict(self)}


def from_json(row: Any) -> Outcome | None:
    """The outcome in plain data; None where it is none, of another version, or not of its form."""
    if not isinstance(row, dict) or row.get("format") != FORMAT or row.get("state") not in STATES:
        return None
    try:
        outcome = Outcome(**{name: _frozen(value) for name, value in row.items() if name != "format"})
    except TypeError:
        return None
    return outcome if _of_form(outcome) else None


def _frozen(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _of_form(row: Outcome) -> bool:
    """Whether each attribute is of its kind, each number finite, and model and page are files of the entry."""
    return (
        all(isinstance(text, str) for text in (row.key, row.name, row.sentence))
        and row.stage in ("identify", "diagnose")
        and isinstance(row.wanted, bool)
        and type(row.attempts) is int
        and row.attempts >= 0
        and all(text is None or isinstance(text, str) for text in (row.model, row.page, row.verdict))
        and all(_texts(texts) for texts in (row.effects, row.notes))
        and all(isinstance(numbers, tuple) and _numbers(numbers) for numbers in (row.picture, row.left))
        and _each(row.seconds, _is_number)
        and _is_curve(row.curve)
        and _each(row.files, lambda value: isinstance(value, str))
        and _each(row.parameters, _is_parameter)
        and isinstance(row.recordings, tuple)
        and all(
            _each(one, lambda _: True) and _numbers(map(one.get, ("nrmse", "over_noise"))) for one in row.recordings
        )
        and all(name is None or name in row.files for name in (row.model, row.page))
    )


def _each(row: Any, holds: Callable[[Any], bool]) -> bool:
    return isinstance(row, Mapping) and all(isinstance(name, str) and holds(value) for name, value in row.items())


def _texts(row: Any) -> bool:
    return isinstance(row, tuple) and all(isinstance(text, str) for text in row)


def _numbers(row: Iterable[Any]) -> bool:
    """Numbers, or None where one is not known."""
    return all(value is None or _is_number(value) for value in row)


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and math.isfinite(value)


def _is_curve(row: Any) -> bool:
    if row == {}:
        return True
    if not isinstance(row, Mapping) or set(row) != {*CURVE, "unit"} or not isinstance(row["unit"], str):
        return False
    columns = [row[name] for name in CURVE]
    return (
        all(isinstance(column, list | tuple) and all(map(_is_number, column)) for column in columns)
        and len(columns[0]) == len(columns[1]) > 0
        and all(size > 0 for size in columns[0])
    )


def _is_parameter(row: Any) -> bool:
    return (
        isinstance(row, Mapping)
        and set(row) == {"value", "std", "unit"}
        and _numbers((row["value"], row["std"]))
        and isinstance(row["unit"], str)
    )
