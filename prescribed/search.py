"""Which laws an element has beside the members of Eq. 17: added, exchanged and dropped by their odds.

Along a prescribed motion a law's force is known but for a few numbers, so that every law can be fitted beside what
there is, from all of its probes. What gains most is fitted with all else free; a law stays where its odds are decisive.
"""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..diagnose.limits import GROUP, LISTED, MATTERS, MOST_EFFECTS
from ..errors import BadInput
from ..identify.problem.equivalent import along_of
from ..identify.signals.odds import DECISIVE
from ..identify.signals.registry import budget, shown
from ..identify.start.measured_motion import probes
from ..model.law import Law
from ..model.laws import PRESCRIBED
from ..model.library import KNOWN
from .channels import Way, parsed
from .fit import FITTED, Fitted, Problem, Shape
from .judge import BAGS, Judge, probability
from .ways import best_of, fitted_ways, without_law, without_way

_log = logging.getLogger(__name__)

_REFINED = budget(5, "laws", why="of those that gain most at their probes, that are fitted with all else free")
_SHAPES = budget(2, "shapes, or sides", why="of a law that are fitted: what leaves the least at its probes")
_SHAPED = budget(3, "laws", why="of those that are fitted, the likeliest, whose shapes are freed")
_RIVALS = budget(8, "laws", why="that are tried in the place of each that was found")
_OWN = budget(3, "laws", why="of those that are fitted, the likeliest, whose strength may grow with a channel")
_LEFT = shown(0.6, "of the way", why="that is left after each round of laws: most searches take three to six")
_ALL = shown(0.9, "of the way", why="that the search takes; the rest is what follows it")
_PATHS = ("restoring", "dissipation", "memory")

Say = Callable[[str, float], None]


def asked() -> list[Law]:
    """The laws that a prescribed motion may show: forces of the motion itself that are not the same all the time."""
    laws = [*KNOWN.values(), *PRESCRIBED.values()]
    return [
        law
        for law in laws
        if law.force is not None
        and law.path in _PATHS
        and not law.learnt
        and not along_of(law).constant
        and not along_of(law).phases
    ]


@dataclass(frozen=True, eq=False)
class Named:
    """A law of the best structure, and how it stands beside what could be in its place.

    Attributes:
        law: itself.
        odds: that it, or one of its rivals, is there.
        rivals: names of laws that cannot be told from it, the most probable first.
        share: part of the power left without it that it takes away.
    """

    law: Law
    odds: float
    rivals: tuple[str, ...]
    share: float

    @property
    def probability(self) -> float:
        """That it, or one of its rivals, is there."""
        return self.odds / (1.0 + self.odds)


@dataclass(frozen=True, eq=False)
class NamedWay:
    """A dependence of the best structure on a channel, as ``Named``; rivals are named as ``str`` of a ``Way``."""

    way: Way
    odds: float
    rivals: tuple[str, ...]
    share: float


@dataclass(frozen=True, eq=False)
class Found:
    """What a search ended with.

    Attributes:
        plain: the members alone, those that the motions tell.
        best: with laws; the same as ``plain`` where none was named.
        named: its laws.
        tried: every other structure that was fitted, with why it was not taken.
        untried: what there was no time for, in words.
        dependent: what of it depends on channels.
    """

    plain: Fitted
    best: Fitted
    named: tuple[Named, ...]
    tried: tuple[tuple[Fitted, str], ...]
    untried: tuple[str, ...] = ()
    dependent: tuple[NamedWay, ...] = ()


class Search:
    """A search over the laws.

    Args:
        problem: motions and forces.
        laws: to ask for.
        every: whether all members stay.
        progress: called with what is being done, and which part of all is done.
        until: time of the monotonic clock at which it ends with the best that it has.
    """

    def __init__(
        self,
        problem: Problem,
        laws: Sequence[Law] | None = None,
        *,
        every: bool = False,
        progress: Say = lambda _what, _part: None,
        until: float = math.inf,
    ) -> None:
        self.problem, self.judge = problem, Judge(problem)
        self.laws = asked() if laws is None else list(laws)
        self.every, self.progress, self.until = every, progress, until
        self.known: dict[tuple[str, ...], Fitted] = {}
        self._ways_known: dict[tuple[str, ...], list[Fitted]] = {}
        self._beside_known: dict[tuple[str, ...], list[Fitted]] = {}
        self.untried: list[str] = []
        self._round = 0

    def _said(self, what: str, part: float) -> None:
        """Say what is being done, and a part of all that never falls: nobody knows how many rounds there will be."""
        done, more = (1.0 - _LEFT ** (self._round + one) for one in (0, 1))
        self.progress(what, _ALL * (done + part * (more - done)))

    def find(self) -> Found:
        """Search from the members alone."""
        first = self.members_alone()
        best = properly_named(self._climbed(first))
        named = tuple(
            Named(law, *self._standing(law.name, without_law(best.shape, law), best)) for law in best.shape.laws
        )
        dependent = tuple(
            NamedWay(way, *self._standing(str(way), without_way(best.shape, way), best)) for way in best.shape.ways
        )
        self.progress("which members the motions tell", _ALL)
        plain, kept = self.plainest(first), self.plainest(best)
        tried = tuple((other, self._why_not(other, best)) for other in self.known.values() if other.names != best.names)
        return Found(plain, kept, named, tried, tuple(self.untried), dependent)

    def members_alone(self) -> Fitted:
        """All members, and no law."""
        made = self.fitted(Shape(), {})
        assert made is not None  # members are numbers along any motion
        return made

    def with_laws(self, laws: Sequence[Law]) -> Fitted:
        """All members and these laws, each begun at the best of its probes beside the others before it."""
        fitted = self.members_alone()
        for law in laws:
            begun = [(law, probe) for _, probe in self._probed(fitted.shape, fitted.values, law)]
            made = self._refined(fitted.shape, fitted.values, begun)
            if not made:
                raise BadInput(f"{law.name} makes no force along these motions; leave it out")
            fitted = max(made, key=lambda one: one.likelihood)
        return fitted

    def with_ways(self, fitted: Fitted, asked: Sequence[str]) -> Fitted:
        """The same with strengths that depend on channels, as ``parsed`` reads them, all else free."""
        for text in asked:
            way = parsed(text, self.problem.spans, [*fitted.shape.strengths(), "load"])
            if any((other.of, other.channel) == (way.of, way.channel) for other in fitted.shape.ways):
                raise BadInput(f"'{text}': {way.of} depends on {way.channel} already; leave one of the two out")
            begun = {**fitted.values, way.name: way.begun}
            made = self.fitted(replace(fitted.shape, ways=(*fitted.shape.ways, way)), begun)
            if made is None:
                raise BadInput(f"'{text}': no force comes of it along these motions; leave it out")
            fitted = made
        return fitted

    def anew(self, fitted: Fitted) -> Fitted:
        """The best from all probes of its laws too: beside what depends on channels these may lie elsewhere."""
        for law in fitted.shape.laws if fitted.shape.ways else ():
            for _, probe in self._probed(without_law(fitted.shape, law), fitted.values, law):
                at = {**fitted.values, **{f"{law.name}.{name}": value for name, value in probe.items()}}
                one = self.fitted(fitted.shape, at)
                fitted = fitted if one is None or not one.likelihood > fitted.likelihood else one
        return fitted

    def plainest(self, fitted: Fitted) -> Fitted:
        """The same without members that the motions do not tell from none, the least probable dropped first."""
        needed = {way.of for way in fitted.shape.ways}
        while not self.every and fitted.shape.members:
            left = [name for name in fitted.shape.members if name not in needed]
            shorter = [self.fitted(self._less(fitted, name), fitted.values) for name in left]
            there = [one for one in shorter if one is not None]
            odds = [float(self.judge.odds(fitted, one)[0]) for one in there]
            if not odds or not min(odds) <= 0.0:
                break
            fitted = there[int(np.argmin(odds))]
        return fitted

    @staticmethod
    def _less(fitted: Fitted, member: str) -> Shape:
        return replace(fitted.shape, members=tuple(name for name in fitted.shape.members if name != member))

    def _over(self) -> bool:
        return time.monotonic() > self.until

    def fitted(self, shape: Shape, begun: Mapping[str, float]) -> Fitted | None:
        """A structure fitted from its places, with its likelihood; None where no force comes of it."""
        made = self.problem.fit(shape, begun)
        return None if made is None else self.problem.weighed(made)

    def _kept(self, fitted: Fitted | None) -> Fitted | None:
        """The better of a fit and what is known of its laws."""
        if fitted is None:
            return None
        laws = tuple(sorted(fitted.names))
        if laws not in self.known or fitted.likelihood > self.known[laws].likelihood:
            self.known[laws] = fitted
        return self.known[laws]

    def _climbed(self, leader: Fitted) -> Fitted:
        """From a structure to one that no neighbour is better than."""
        led: set[tuple[str, ...]] = set()
        self._kept(leader)
        while tuple(sorted(leader.names)) not in led:
            led.add(tuple(sorted(leader.names)))
            _log.info("%s leads: log-likelihood %.6g", " + ".join(leader.names) or "members alone", leader.likelihood)
            best = leader
            for shorter in self._shorter(leader):
                if float(self.judge.odds(leader, shorter)[0]) < DECISIVE:
                    best = shorter
            if best is leader:
                for other in self._exchanged(leader):
                    if float(self.judge.odds(other, best)[0]) > 0.0:
                        best = other
                best = self._better(leader, best, laws=False)
            if best is leader and len(leader.names) < MOST_EFFECTS:
                more = [one for one in self._added(leader) if self._matters(one, leader)]
                decisive = [one for one in more if float(self.judge.odds(one, leader)[0]) > DECISIVE]
                best = best_of(decisive, self._odds_against(leader)) or leader
            if best is leader:
                best = self._better(leader, best, laws=True)
            leader = best if best is leader else self._kept(self.anew(best)) or best
        return leader

    def _better(self, leader: Fitted, best: Fitted, *, laws: bool) -> Fitted:
        """The likeliest with another dependence, or a law, in the place of one on a channel; else what is best."""
        for way in leader.shape.ways:
            rest = without_way(leader.shape, way)
            others = self._with_own(rest, self._rivals(rest, leader)) if laws else self._ways(rest, leader.values)
            other = best_of([leader, *others], self._odds_against(leader))
            if other is not None and other is not leader and float(self.judge.odds(other, best)[0]) > 0.0:
                best = other
        return best

    def _odds_against(self, leader: Fitted) -> Callable[[Fitted], float]:
        return lambda one: float(self.judge.odds(one, leader)[0])

    def _ways(self, shape: Shape, values: Mapping[str, float]) -> list[Fitted]:
        """A structure with one dependence on a channel more."""
        names = tuple(sorted((*(law.name for law in shape.laws), *map(str, shape.ways))))
        if not self.problem.spans or self._over():
            self.untried += ["what depends on a channel"] if self.problem.spans else []
            return []
        if names not in self._ways_known:
            self._said("what depends on a channel", 0.0)
            fit = lambda *how: self._kept(self.fitted(*how))  # noqa: E731
            self._ways_known[names] = fitted_ways(self.problem, shape, values, fit)
        return self._ways_known[names]

    def _rivals(self, rest: Shape, best: Fitted) -> list[Fitted]:
        """What could be in the place of something that was named: laws and dependences beside the rest, asked once."""
        names = tuple(sorted((*(law.name for law in rest.laws), *map(str, rest.ways))))
        if names not in self._beside_known:
            self._beside_known[names] = self._beside(rest, best.values, self._more_laws(best), _RIVALS)
        return self._beside_known[names]

    @staticmethod
    def _matters(one: Fitted, leader: Fitted) -> bool:
        pairs = zip([*leader.residuals, *leader.held], [*one.residuals, *one.held], strict=True)
        return any(np.sum(old**2) > (1.0 + MATTERS) * np.sum(new**2) for old, new in pairs)

    def _shorter(self, leader: Fitted) -> list[Fitted]:
        made = []
        for law in leader.shape.laws:
            one = self._kept(self.fitted(without_law(leader.shape, law), leader.values))
            made += [] if one is None else [one]
        for way in leader.shape.ways:
            one = self._kept(self.fitted(without_way(leader.shape, way), leader.values))
            made += [] if one is None else [one]
        return made

    def _more_laws(self, leader: Fitted) -> list[Law]:
        return [law for law in self.laws if law.name not in leader.names]

    def _exchanged(self, leader: Fitted) -> list[Fitted]:
        """The leader with one law in the place of another."""
        made = []
        for law in leader.shape.laws:
            made += self._beside(without_law(leader.shape, law), leader.values, self._more_laws(leader), _REFINED)
        return made

    def _added(self, leader: Fitted) -> list[Fitted]:
        made = self._beside(leader.shape, leader.values, self._more_laws(leader), _REFINED)
        return self._with_own(leader.shape, made)

    def _with_own(self, base: Shape, made: list[Fitted]) -> list[Fitted]:
        """These, and the likeliest with a law more than the base, now with a strength that grows with a channel.

        A law whose strength differs between recordings explains none of them while it is the same in all.
        """
        if not self.problem.spans or self._over():
            return made
        laws = [one for one in made if len(one.shape.laws) > len(base.laws)]
        both = []
        for one in sorted(laws, key=lambda one: -one.likelihood)[:_OWN]:
            law = next(law for law in one.shape.laws if law not in base.laws)
            of = next((f"{law.name}.{p.name}" for p in law.parameters if p.strength), None)
            for channel in self.problem.spans if of is not None else ():
                way = Way(channel, of or "", "linear")
                names = tuple(sorted((*one.names, str(way))))
                if names not in self.known:
                    self._kept(self.fitted(replace(one.shape, ways=(*one.shape.ways, way)), one.values))
                kept = self.known.get(names)
                both += [] if kept is None else [kept]
        return [*made, *both]

    def _beside(self, shape: Shape, values: Mapping[str, float], laws: Sequence[Law], most: int) -> list[Fitted]:
        """A structure with one law more: of those that gain most at their probes, with all else free."""
        there = " + ".join(law.name for law in shape.laws) or "Eq. 17"
        if self._over():
            self.untried.append(f"a further law beside {there}")
            return []
        probed = []
        for i, law in enumerate(laws):
            self._said(f"{law.name} beside {there}", i / len(laws))
            probed += [(left, law, probe) for left, probe in self._probed(shape, values, law)]
        self._round += 1
        probed.sort(key=lambda one: one[0])
        first = list(dict.fromkeys(law.name for _, law, _ in probed))[:most]
        made = self._refined(shape, values, [(law, probe) for _, law, probe in probed if law.name in first])
        return [*self._ways(shape, values), *made]

    def _refined(
        self, shape: Shape, values: Mapping[str, float], begun: Sequence[tuple[Law, Mapping[str, float]]]
    ) -> list[Fitted]:
        """A structure with each of some laws from each of its probes, all else free: the best of each law."""
        made: dict[str, Fitted] = {}
        for law, probe in begun:
            at = {**values, **{f"{law.name}.{name}": value for name, value in probe.items()}}
            one = self._kept(self.fitted(replace(shape, laws=(*shape.laws, law)), at))
            if one is not None and (law.name not in made or one.likelihood > made[law.name].likelihood):
                made[law.name] = one
        ordered = sorted(made.values(), key=lambda one: -one.likelihood)
        return [*(self._shaped(one) for one in ordered[:_SHAPED]), *ordered[_SHAPED:]]

    def _shaped(self, fitted: Fitted) -> Fitted:
        """The same with the shapes of its laws free, where that is decisively more probable."""
        shapes = frozenset(f"{law.name}.{p.name}" for law in fitted.shape.laws for p in law.parameters if p.shape)
        if not shapes - fitted.shape.freed:
            return fitted
        freed = self.fitted(replace(fitted.shape, freed=shapes), fitted.values)
        if freed is None or not float(self.judge.odds(freed, fitted)[0]) > DECISIVE:
            return fitted
        return self._kept(freed) or fitted

    def _probed(self, shape: Shape, values: Mapping[str, float], law: Law) -> list[tuple[float, dict[str, float]]]:
        """The power that is left with a law at the best of its probes of each shape and side, all else linear free.

        With the probes, the least first; where the law makes no force there is none.
        """
        best: dict[tuple[float, ...], tuple[float, dict[str, float]]] = {}
        shapes = [p.name for p in law.parameters if p.shape]
        for probe, found in self.problem.probed(shape, values, law, probes(law, self.problem.scales)):
            kind = tuple(value if name in shapes else math.copysign(1.0, value) for name, value in probe.items())
            if kind not in best or found < best[kind][0]:
                best[kind] = found, dict(probe)
        return sorted(best.values(), key=lambda one: one[0])[:_SHAPES]

    def _standing(self, cause: str, rest: Shape, best: Fitted) -> tuple[float, tuple[str, ...], float]:
        """Odds of what is named, its rivals, and its share.

        Rivals are the smallest set that holds the share ``GROUP`` of the probability, with one cause in its place.
        """
        without = self.fitted(rest, best.values)
        others = self._rivals(rest, best)
        odds, there = {cause: np.zeros(1 + BAGS)}, {*(law.name for law in rest.laws), *map(str, rest.ways)}
        for other in [*others, *([] if without is None else [without])]:
            (name,) = set(other.names) - there or {""}
            if name != cause:
                odds[name] = -self.judge.odds(best, other, BAGS)
        known = dict(zip(odds, probability(list(odds.values())), strict=True))
        names = sorted(known, key=lambda name: -known[name])
        count = int(np.searchsorted(np.cumsum([known[name] for name in names]), GROUP)) + 1
        group = [name for name in names[:count] if name]
        held = sum(known[name] for name in {*group, cause})
        weighed = held / max(1.0 - held, np.finfo(float).tiny)
        on = weighed / (1.0 + weighed * self.judge.mismatch(best) / LISTED)
        share = 1.0 - best.power / without.power if without is not None and without.power > 0.0 else 1.0
        return float(on), tuple(name for name in group if name != cause), max(share, 0.0)

    def _why_not(self, other: Fitted, best: Fitted) -> str:
        odds = float(self.judge.odds(best, other)[0])
        if set(best.names) < set(other.names):
            return f"its odds are not decisive: {-odds:.3g} in log-evidence"
        return f"{' + '.join(best.names) or 'Eq. 17 alone'} is more probable: by {odds:.4g} in log-evidence"


def properly_named(fitted: Fitted) -> Fitted:
    """The same with each law under the name that suits its values, of those that share its equation.

    Stops are stiffer than the spring beside them, and a clearance is not.
    """
    for law in fitted.shape.laws:
        base = {**dict.fromkeys(FITTED, 0.0), **fitted.values}
        base["omega0"] = math.sqrt(max(base["stiffness"], 0.0))
        own = [fitted.values[f"{law.name}.{p.name}"] for p in law.parameters]
        held = any(way.of.rpartition(".")[0] == law.name for way in fitted.shape.ways)
        if held or law.proper is None or law.proper(_by_name(law, own), base):
            continue
        alike = [o for o in KNOWN.values() if (law.twin == o.name or o.twin == law.name) and o.name not in fitted.names]
        for other in alike:
            suits = other.proper is not None and other.proper(_by_name(other, own), base)
            if any(own[len(other.parameters) :]) or not suits:
                continue
            laws = tuple(other if one is law else one for one in fitted.shape.laws)
            values = {**fitted.values, **{f"{other.name}.{name}": v for name, v in _by_name(other, own).items()}}
            fitted = replace(fitted, shape=replace(fitted.shape, laws=laws), values=values)
            break
    return fitted


def _by_name(law: Law, values: Sequence[float]) -> dict[str, float]:
    """A law's parameters by name, from values in order; what those of another law do not have is zero."""
    return {p.name: values[i] if i < len(values) else 0.0 for i, p in enumerate(law.parameters)}
