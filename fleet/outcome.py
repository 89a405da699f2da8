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


def from_json(told: Any) -> Outcome | None:
    """The outcome in plain data; None where it is none, of another version, or not of its form."""
    if not isinstance(told, dict) or told.get("format") != FORMAT or told.get("state") not in STATES:
        return None
    try:
        outcome = Outcome(**{name: _frozen(value) for name, value in told.items() if name != "format"})
    except TypeError:
        return None
    return outcome if _of_form(outcome) else None


def _frozen(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _of_form(told: Outcome) -> bool:
    """Whether each attribute is of its kind, each number finite, and model and page are files of the entry."""
    return (
        all(isinstance(text, str) for text in (told.key, told.name, told.sentence))
        and told.stage in ("identify", "diagnose")
        and isinstance(told.wanted, bool)
        and type(told.attempts) is int
        and told.attempts >= 0
        and all(text is None or isinstance(text, str) for text in (told.model, told.page, told.verdict))
        and all(_texts(texts) for texts in (told.effects, told.notes))
        and all(isinstance(numbers, tuple) and _numbers(numbers) for numbers in (told.picture, told.left))
        and _each(told.seconds, _is_number)
        and _each(told.files, lambda value: isinstance(value, str))
        and _each(told.parameters, _is_parameter)
        and isinstance(told.recordings, tuple)
        and all(
            _each(one, lambda _: True) and _numbers(map(one.get, ("nrmse", "over_noise"))) for one in told.recordings
        )
        and all(name is None or name in told.files for name in (told.model, told.page))
    )


def _each(told: Any, holds: Callable[[Any], bool]) -> bool:
    return isinstance(told, Mapping) and all(isinstance(name, str) and holds(value) for name, value in told.items())


def _texts(told: Any) -> bool:
    return isinstance(told, tuple) and all(isinstance(text, str) for text in told)


def _numbers(told: Iterable[Any]) -> bool:
    """Numbers, or None where one is not known."""
    return all(value is None or _is_number(value) for value in told)


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and math.isfinite(value)


def _is_recording(told: Any) -> bool:
    return _each(told, lambda _: True) and _numbers(map(told.get, ("nrmse", "over_noise")))


def _is_parameter(told: Any) -> bool:
    return (
        isinstance(told, Mapping)
        and set(told) == {"value", "std", "unit"}
        and _numbers((told["value"], told["std"]))
        and isinstance(told["unit"], str)
    )
