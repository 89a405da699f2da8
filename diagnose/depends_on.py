"""On what a missing force depends: shares of its power with errors, what each kind adds, and the same in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..files.spoken import spoken
from ..identify.signals.odds import SIGNIFICANT
from ..identify.signals.registry import shown
from .limits import MATTERS, PLAINER

_MOST = shown(4, "kinds", why="of those that add something, and of those that do not: as many as a sentence carries")
#: Each kind of coordinate as a sentence says it, those that a person asks for first at the top.
WORDS = {
    "time": "time",
    "displacement": "displacement",
    "velocity": "velocity",
    "displacement and velocity": "displacement and velocity together",
    "force": "the recorded force",
    "base": "the motion of the base",
    "memory": "the motion before",
    "damping by position": "a damping by position",
    "amplitude": "the amplitude of the cycle",
    "phase": "the phase in the cycle",
    "constant": "a constant",
    "delay": "a delay of the force",
    "sensor": "a sensor that is not straight",
    "tone": "one steady frequency",
    "ringing": "one frequency that rings with the motion",
}

_BOTH = "displacement and velocity"


@dataclass(frozen=True)
class Share:
    """What one kind of coordinate explains of the missing force's power beyond the noise.

    Attributes:
        kind: a key of ``WORDS``.
        share, std: by itself, at most 1, and its standard error.
        adds, adds_std: what it explains beyond the first kind; of that itself its whole share.
        within: whether the first kind has it in itself, or is it.
    """

    kind: str
    share: float
    std: float
    adds: float
    adds_std: float
    within: bool = False

    @property
    def role(self) -> str:
        """``part`` of the first kind, ``adds`` to it, adds ``nothing``, or ``not-told`` by these recordings."""
        if self.within:
            return "part"
        if self.adds > max(SIGNIFICANT * self.adds_std, MATTERS):
            return "adds"
        return "nothing" if self.adds + self.adds_std < 1.0 - PLAINER else "not-told"


@dataclass(frozen=True)
class DependsOn:
    """Shares of all kinds, the plainest one that explains about as much as the best first.

    Attributes:
        shares: the first kind, then the others by what they add.
        blocks: so many blocks of the recordings were left out, one after another, for the errors.
    """

    shares: tuple[Share, ...]
    blocks: int

    @property
    def first(self) -> Share:
        """The plainest kind that explains about as much as the best."""
        return self.shares[0]

    @property
    def told(self) -> bool:
        """Whether the share of the first kind is more than its error."""
        return self.first.share > SIGNIFICANT * self.first.std

    def those(self, role: str) -> list[Share]:
        """Kinds of one role: of those that add something the most first, else in the order of ``WORDS``."""
        found = [share for share in self.shares if share.role == role]
        return found if role == "adds" else sorted(found, key=lambda share: list(WORDS).index(share.kind))

    @property
    def sentence(self) -> str:
        """``81 ± 4 % by displacement and velocity together; time adds nothing (at most 0.2 ± 0.6 %)``."""
        part = f"{percent(self.first.share, self.first.std)} by {WORDS[self.first.kind]}"
        if not self.told:
            return f"not told by these recordings; the most, {part}"
        said = [part]
        said += [f"{WORDS[s.kind]} adds {percent(s.adds, s.adds_std)}" for s in self._said()[:_MOST]]
        if idle := self.those("nothing"):
            most = max(idle, key=lambda share: share.adds + share.adds_std)
            verb = "adds" if len(idle) == 1 else "add"
            said.append(f"{_names(idle)} {verb} nothing (at most {percent(max(most.adds, 0.0), most.adds_std)})")
        if unknown := self.those("not-told"):
            verb = "adds" if len(unknown) == 1 else "add"
            said.append(f"whether {_names(unknown)} {verb} anything is not told")
        return "; ".join(said)

    def _said(self) -> list[Share]:
        """Kinds that add something; both coordinates together only where they add more than each other kind does."""
        adding = self.those("adds")
        most = max((share.adds for share in adding if share.kind != _BOTH), default=0.0)
        return [share for share in adding if share.kind != _BOTH or share.adds - share.adds_std > most]

    def as_json(self) -> dict[str, Any]:
        """As ``diagnosis.json`` has it, under ``depends_on`` of the location."""
        return {
            "first": self.first.kind,
            "told": self.told,
            "sentence": self.sentence,
            "shares": [
                {
                    "kind": share.kind,
                    "share": share.share,
                    "std": share.std,
                    "adds": share.adds,
                    "adds_std": share.adds_std,
                    "role": "first" if share is self.first else share.role,
                }
                for share in self.shares
            ],
            "unexplained": {"share": 1.0 - self.first.share, "std": self.first.std},
            "blocks": self.blocks,
        }


def _names(shares: list[Share]) -> str:
    names = [WORDS[share.kind] for share in shares[:_MOST]]
    return spoken([*names, *([f"{len(shares) - _MOST} more"] if len(shares) > _MOST else [])])


def percent(share: float, std: float) -> str:
    """``81 ± 4 %``: to a tenth where the error is below one."""
    error = 100.0 * std
    digits = 0 if int(error) > 0 else 1
    value = round(100.0 * share, digits) + 0.0  # no minus before a zero
    return f"{value:.{digits}f} ± {error:.{digits}f} %"
