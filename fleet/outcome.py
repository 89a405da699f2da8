"""What became of an entry: the JSON that is kept of it, ``dashpot-entry/1``."""

from __future__ import annotations

from collections.abc import Mapping
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

    @property
    def finished(self) -> bool:
        """Whether nothing is left to be done for it."""
        return self.state not in (*TRIED_AGAIN, "open") and not self.wanted

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        return {"format": FORMAT, **asdict(self)}


def from_json(told: Any) -> Outcome | None:
    """The outcome in plain data; None where it is none, or of another version."""
    if not isinstance(told, dict) or told.get("format") != FORMAT or told.get("state") not in STATES:
        return None
    try:
        return Outcome(**{name: _frozen(value) for name, value in told.items() if name != "format"})
    except TypeError:
        return None


def _frozen(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value
