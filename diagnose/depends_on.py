"""On what a missing force depends: shares of its power with errors, what each kind adds, and the same in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..identify.signals.odds import SIGNIFICANT
from ..identify.signals.registry import shown
from .limits import MATTERS
from .wording import spoken

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
    "acceleration": "acceleration",
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
    def nothing(self) -> bool:
        """Whether what it adds is no more than its error, or too little to matter."""
        return self.adds < max(SIGNIFICANT * self.adds_std, MATTERS)


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
    def adding(self) -> tuple[Share, ...]:
        """Kinds that explain something beyond the first, the most first."""
        return tuple(share for share in self.shares if not share.within and not share.nothing)

    @property
    def idle(self) -> tuple[Share, ...]:
        """Kinds that add nothing to the first, and are no part of it, in the order of ``WORDS``."""
        order = list(WORDS)
        idle = [share for share in self.shares if not share.within and share.nothing]
        return tuple(sorted(idle, key=lambda share: order.index(share.kind)))

    @property
    def sentence(self) -> str:
        """``81 ± 4 % by displacement and velocity together; time adds nothing (at most 0.2 ± 0.6 %)``."""
        said = [f"{percent(self.first.share, self.first.std)} by {WORDS[self.first.kind]}"]
        said += [f"{WORDS[s.kind]} adds {percent(s.adds, s.adds_std)}" for s in self._said()[:_MOST]]
        if idle := self.idle:
            names = [WORDS[share.kind] for share in idle[:_MOST]]
            if len(idle) > _MOST:
                names.append(f"{len(idle) - _MOST} more")
            most = max(idle, key=lambda share: share.adds + share.adds_std)
            verb = "adds" if len(names) == 1 else "add"
            said.append(f"{spoken(names)} {verb} nothing (at most {percent(max(most.adds, 0.0), most.adds_std)})")
        return "; ".join(said)

    def _said(self) -> list[Share]:
        """Kinds that add something; both coordinates together only where they add more than each other kind does."""
        most = max((share.adds for share in self.adding if share.kind != _BOTH), default=0.0)
        return [share for share in self.adding if share.kind != _BOTH or share.adds - share.adds_std > most]

    def as_json(self) -> dict[str, Any]:
        """As ``diagnosis.json`` has it, under ``depends_on`` of the location."""
        return {
            "first": self.first.kind,
            "sentence": self.sentence,
            "shares": [
                {
                    "kind": share.kind,
                    "share": share.share,
                    "std": share.std,
                    "adds": share.adds,
                    "adds_std": share.adds_std,
                    "part_of_first": share.within,
                    "adds_nothing": share.nothing,
                }
                for share in self.shares
            ],
            "unexplained": {"share": 1.0 - self.first.share, "std": self.first.std},
            "blocks": self.blocks,
        }


def percent(share: float, std: float) -> str:
    """``81 ± 4 %``: to a tenth where the error is below one."""
    digits = 0 if 100.0 * std >= 0.95 else 1
    return f"{100.0 * share:.{digits}f} ± {100.0 * std:.{digits}f} %".replace("-0", "0", 1)
