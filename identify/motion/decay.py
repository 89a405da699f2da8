"""A free decay, and all free motion of a recording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..signals.registry import numerics
from .mode import Mode

_BEFORE = numerics(4, "parts of a cycle", why="of which one shows how a rig was before a blow")


@dataclass(frozen=True)
class Decay:
    """A free decay: samples start to stop of a recording, as Python slices them.

    ``omega`` and ``rate``: its natural frequency, rad/s, and the rate of its fall, 1/s, where it was taken because
    these are known, however few cycles it has. ``rig``: the parameters of Eq. 17, in SI, that explain it to the noise.
    """

    start: int
    stop: int
    omega: float | None = field(default=None, compare=False)
    rate: float | None = field(default=None, compare=False)
    rig: Mapping[str, float] | None = field(default=None, compare=False)


@dataclass(frozen=True)
class Blow:
    """A blow of a hammer.

    Attributes:
        start: first sample of its contact.
        stop: the one after its last.
        clipped: whether its force was cut off.
        contacts: how often it hit.
        answered: whether the response goes where it was struck.
    """

    start: int
    stop: int
    clipped: bool = False
    contacts: int = 1
    answered: bool = True

    def before(self, period: int) -> int:
        """First sample of the part of a cycle of so many samples before it, in which the rig is as it was."""
        return max(0, self.start - period // _BEFORE)

    @property
    def is_known(self) -> bool:
        """Whether a simulation may be driven by it."""
        return self.answered and not self.clipped


@dataclass(frozen=True)
class FreeMotion:
    """What moves freely in a recording, in order of time, and what was left out.

    Attributes:
        decays: where nothing drives the motion.
        blows: what set it going, where a hammer's force was recorded.
        notes: one sentence each on what was left out and why; none where all that moves is used.
        modes: of a linear rig that ring together, that which moves most first; none where there is one.
        swell: samples between which the response grows most swings in a row, where nothing that was recorded drives it
            and nothing else of it is known to be free; None where it does not.
    """

    decays: tuple[Decay, ...]
    blows: tuple[Blow, ...] = ()
    notes: tuple[str, ...] = ()
    modes: tuple[Mode, ...] = ()
    swell: tuple[int, int] | None = None
