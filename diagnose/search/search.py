"""The search for what is missing: structures of laws, raced against each other and weighed by their evidence.

From the best structure so far every law of the library is added, every law that was added is dropped again, and each,
or several at once, exchanged for one that acts most like it. What arrives is weighed; where one of them is decisively
more probable it leads, and the search goes on from there. A structure leads again only where it came to a decisively
better place, so that there is an end, and at the end no neighbour of the leader promises to reach it.
"""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import combinations

import numpy as np

from ...errors import BadInput
from ...identify.fit.from_prediction import keeps_step
from ...identify.problem.data import Data
from ...identify.problem.prediction import FREE
from ...identify.problem.structure import Fitted
from ...identify.signals.odds import DECISIVE
from ...identify.signals.registry import budget
from ...identify.start.limits import HALF
from ...model import Oscillator
from ...model.law import Law
from ...model.library import KNOWN, find
from ..limits import MOST_EFFECTS
from .by_prediction import by_prediction, by_probing
from .candidate import Candidate, key
from .found import Found, Weighing
from .judgement import accepted, first_of_several, leading, needed_in_samples, only_a_name
from .likeness import alike, moves_along
from .measure import Measure, measure_by
from .neighbours import asked_by_motion, dropped, each_learnt, entered_again, finer, kept, more_general, with_shapes
from .race import PATIENCE, Entry, Start, race, started
from .starts import Proposal, by_motion, by_score, by_zeros, unseen_in_motion
from .weigh import foreseen_loss, judged

_ALIKE = budget(2, "laws", why="for which a law is exchanged at least: those that act most like it")
_MOST_ALIKE = budget(4, "laws", why="the same where more act nearly as much like it")
_CONVERGES = budget(
    10, "steps", why="far from the noise an exchanged law is given those that quadratic convergence takes"
)

_log = logging.getLogger(__name__)
#: What each way of asking is, for the log.
_ASKED = {
    "_moved": "regression on the measured motion",
    "_as_long_or_shorter": "one law less, or exchanged",
    "_scored": "the score of every law",
    "_less_scored": "laws of lower scores",
    "_predicted": "prediction over a cycle",
    "_rugged": "laws with side valleys",
    "_learnt": "curves that are learnt: spring, damping, mass, drive, sensor",
}


def best_of_family(model: Oscillator, data: Data) -> Fitted:
    """The parameters of a model's own structure that suit the training recordings best.

    Raises BadInput where it does not simulate with these values.
    """
    start = started(Entry((), model), data, Measure())
    if start is None:
        raise BadInput("the model does not simulate with its start values; check the units of force and response")
    race([start], Measure(), None, data.points)
    return start.fitted


@dataclass(eq=False)
class Search:
    """The search over the library.

    Attributes:
        data: training recordings.
        holdout: recordings that no parameter is fitted to; None where nothing could be held out.
        laws: the library, with the user's laws; those that are learnt are asked for where all others have failed.
        progress: called with what is being done and which part of all is done.
        until: time of the monotonic clock at which it ends with the best that it has.
        before: what a search over almost the same recordings ended with: whatever came within reach there is entered
            first, from where it came to.
        candidates: every structure that was entered, by the laws it adds.
        untried: what was not asked for want of time, in words.
        asked_rugged: whether laws with side valleys were asked for.
    """

    data: Data
    holdout: Data | None
    laws: Sequence[Law] = field(default_factory=lambda: tuple(KNOWN.values()))
    progress: Callable[[str, float], None] = lambda _what, _part: None
    until: float = math.inf
    before: Found | None = None
    untried: list[str] = field(default_factory=list, init=False)
    candidates: dict[tuple[str, ...], Candidate] = field(default_factory=dict, init=False)
    _asked: dict[tuple[tuple[str, ...], tuple[str, ...]], Fitted] = field(default_factory=dict, init=False)
    _less: list[Proposal] = field(default_factory=list, init=False)
    asked_rugged: bool = field(default=False, init=False)
    _led: set[tuple[str, ...]] = field(default_factory=set, init=False)
    _front_before: Fitted | None = field(default=None, init=False)
    _measures: tuple[Measure, Measure] = field(default=(Measure(), Measure()), init=False)

    def find(self, family: Fitted) -> Found:
        """Search from the fitted family, and return what it ended with."""
        memory = self.data.memory
        selected, known = self.from_family(family), dict(self.candidates)
        if self.before is not None:
            left = self.before.candidates.items()
            known = {laws: replace(one, fit=None) for laws, one in left if one.stage != "judged"} | known
        return Found(selected, known, self.weighing, self.asked_rugged, memory, tuple(self.untried))

    def from_family(self, family: Fitted) -> Candidate:
        """The best structure there is, starting from the given family."""
        self._compare_by(family)
        leader = self.candidates[()] = self.weigh((), family)
        if self.before is None:
            leader = self._climbed(leader)
        elif (again := self._entered_again(leader, self.before)).laws == self.before.selected.laws and self._same_data:
            leader = again  # its neighbours were asked
        else:
            leader = self._climbed(again)
        if leader.laws or (first := first_of_several(leader, self.candidates.values(), self.parts)) is None:
            return leader
        several, given = self._climbed(first), self.candidates[()]
        return several if accepted(several, given, self.parts) else given

    @property
    def _same_data(self) -> bool:
        """Whether the earlier search was fitted to the same: only what was held out has changed."""
        assert self.before is not None
        mine, theirs = self.data.segments, self.before.weighing.data.segments
        return len(mine) == len(theirs) and all(
            np.array_equal(one.response, other.response) for one, other in zip(mine, theirs, strict=True)
        )

    def _entered_again(self, leader: Candidate, before: Found) -> Candidate:
        """What leads of all that came within reach in an earlier search, then whatever beats it."""
        self.asked_rugged = before.asked_rugged
        known = [one for one in before.candidates.values() if one.laws and one.stage == "judged"]
        for leads in (True, False):
            some = [one for one in known if (one.laws == before.selected.laws) is leads]
            starts = self._started(entered_again(some, self.data))
            self._race(starts, self._front(leader, ()))
            leader = self._best_of_neighbours(leader, starts)
        return leader

    def _climbed(self, leader: Candidate) -> Candidate:
        """From a structure to one that no neighbour is better than."""
        reached: dict[tuple[str, ...], Candidate] = {}
        while leader.laws not in reached or self._now(leader) > self._now(reached[leader.laws]) + DECISIVE:
            reached[leader.laws] = leader
            self._led.add(leader.laws)
            _log.info("%s leads: log-evidence %.6g", leader.name, leader.value)
            best = leader
            for way in self._ways(leader):
                asked = f"beside {best.name}: {_ASKED.get(way.__name__, way.__name__)}"
                if self._over():
                    self.untried.append(asked)
                    continue
                _log.info("%s", asked)
                best = self._best_of_neighbours(best, way(best))
                if best.laws != leader.laws:
                    break
            leader = self._simulated(best)
        return leader

    def _now(self, candidate: Candidate) -> float:
        """What speaks for a structure in the measure of now: two measures of one place are no progress."""
        assert candidate.fit is not None
        return self.weigh(candidate.laws, candidate.fit, candidate.held_out).value

    def _over(self) -> bool:
        """Whether no time is left."""
        return time.monotonic() > self.until

    def _ways(self, leader: Candidate) -> list[Callable[[Candidate], list[Start]]]:
        """From where a leader is asked, one after another, until another leads.

        Near the noise a law is added to what nothing as long can replace. Far from it the leader has bent itself around
        what is missing, and the measured motion has not; of what is scored there the best half goes first.
        """
        if self._at_noise(leader, ()):
            return [self._as_long_or_shorter, self._scored]
        assert leader.fit is not None
        before = self.before if self.before is not None and leader.laws == self.before.selected.laws else None
        if before and before.is_reached_by(leader.fit):  # what else was asked is known: less adds no motion
            return [self._moved, self._as_long_or_shorter, self._scored]
        if any(find(law).rugged for law in leader.laws):
            return []  # what it leaves may be a side valley's, and no sign of a second law
        ways = [self._moved, self._as_long_or_shorter, self._scored, self._less_scored]
        # a law with side valleys is simulated slowly, from many places: asked for where each other has failed by itself
        rugged = [] if self.asked_rugged else [self._rugged]
        ways += [] if keeps_step(self.data.segments, leader.fit.residuals) else [self._predicted]
        if not leader.laws:
            return [*ways, *rugged, self._learnt]
        # a second cause has to tell more than a smooth spring and damping do, which then may be exchanged for it
        smooth = any(find(law).learnt for law in leader.laws)
        first = [self._as_long_or_shorter, self._learnt] if smooth else [self._learnt]
        first += [self._moved, *rugged]  # what the motion shows of a second cause costs less
        return [*first, *(way for way in ways if way not in first)]

    def _best_of_neighbours(self, leader: Candidate, starts: Sequence[Start]) -> Candidate:
        """What leads once neighbours of the leader have been weighed; the leader, weighed anew, where none does."""
        arrived = self._arrived(leader, starts)
        return leading(self.candidates[leader.laws], arrived, self.parts)

    @property
    def weighing(self) -> Weighing:
        """By what structures are weighed here."""
        return Weighing(self.data, self.holdout, self.laws, self._measures)

    @property
    def parts(self) -> tuple[Data, ...]:
        """Training recordings, and those held out where there are any."""
        return self.weighing.parts

    def _as_long_or_shorter(self, leader: Candidate) -> list[Start]:
        """The leader less one of its laws, and with one exchanged, raced."""
        assert leader.fit is not None
        self.progress("what the best could do without", 0.0)
        at_noise = self._at_noise(leader, ())
        # far from the noise what led before it is known as well as it will be
        shorter = [law for law in leader.laws if at_noise or key([n for n in leader.laws if n != law]) not in self._led]
        entries = [*dropped(leader, self.data, shorter), *self._exchanged(leader)]
        starts = self._started(entries, noise=at_noise)
        self._race(starts, leader.fit)
        if at_noise and len(leader.laws) > 1:
            doubted = [law for law in leader.laws if self._rests_low(leader, law, starts)]
            anew = self._started(dropped(leader, self.data, doubted, anew=True), noise=True)
            self._race(anew, leader.fit)
            starts += anew
        return starts

    def _rests_low(self, leader: Candidate, law: str, starts: Sequence[Start]) -> bool:
        """Whether the leader without a law may rest on a low summit: it loses more than a linearised response does."""
        assert leader.fit is not None
        others, measure = key([name for name in leader.laws if name != law]), self._measures[0]
        for start in starts:
            start.measured_by(measure)
        reached = max((start.ceiling for start in starts if start.laws == others), default=-np.inf)
        lost = measure.value(leader.fit.residuals) - reached
        return lost > foreseen_loss(leader.fit, self.data, law, measure) + DECISIVE

    def _moved(self, leader: Candidate) -> list[Start]:
        """The leader with one law more, where the measured motion puts it, or its score where that is blind; raced."""
        assert leader.fit is not None
        laws = [law for law in self._addable(leader) if not law.rugged]
        unseen = [law for law in laws if unseen_in_motion(law)]
        blind = self._added(leader, by_score(leader.fit, self.data, unseen, self._cost_of)) if unseen else []
        loaded = self._added(leader, by_zeros(leader.fit, self.data, unseen))
        starts = self._from_motion(leader, [law for law in laws if law not in unseen], [*blind, *loaded])
        # what nothing else speaks for must come to the noise; else it waits until all laws are asked for their scores
        return [start for start in starts if start.near or start not in blind]

    def _scored(self, leader: Candidate) -> list[Start]:
        """The leader with one law more, where its score puts it, raced; far from the noise those of the best half."""
        assert leader.fit is not None
        if not (laws := self._addable(leader)):
            return []
        self.progress("score of every law", 0.0)
        proposals = by_score(leader.fit, self.data, laws, self._cost_of)
        least = 0.0 if self._at_noise(leader, ()) else HALF * max((p.gain for p in proposals), default=0.0)
        self._less = [proposal for proposal in proposals if proposal.gain < least]
        better = [proposal for proposal in proposals if proposal.gain >= least]
        return self._raced(leader, [*better, *by_zeros(leader.fit, self.data, laws)])

    def _less_scored(self, leader: Candidate) -> list[Start]:
        """The others, raced."""
        return self._raced(leader, self._less)

    def _predicted(self, leader: Candidate) -> list[Start]:
        """The leader with one law more, of those that predict better where no simulation keeps step, raced."""
        assert leader.fit is not None
        self.progress("prediction over a cycle", 0.0)
        return self._raced(leader, by_prediction(leader.fit, self.data, self._addable(leader), self._cost(1)))

    def _rugged(self, leader: Candidate) -> list[Start]:
        """The given family with one law with side valleys, where it predicts better than the leader, raced."""
        family, self.asked_rugged = self.candidates[()], True
        assert family.fit is not None
        assert leader.fit is not None
        self.progress("prediction over a cycle", 0.0)
        rugged = [law for law in self._addable(family) if law.rugged]
        return self._raced(family, by_probing(family.fit, leader.fit, self.data, rugged))

    def _learnt(self, leader: Candidate) -> list[Start]:
        """Curves beside the leader, raced; of mass, drive and sensor where the measured motion speaks for them."""
        every = self._addable(leader, learnt=True)
        coarse = [law for law in every if law.name not in {other.finer for other in every}]  # those are gone on to
        entries = [entry for entry in each_learnt(leader, coarse, self.data) if entry.laws not in self.candidates]
        starts = self._started(entries)
        # what leads may stand for another path, and bend what the motion says beside it
        for beside in {leader.laws: leader, (): self.candidates.get((), leader)}.values():
            others = [p for p in self._spoken_for(beside, coarse) if asked_by_motion(beside, find(p.law))]
            starts += self._added(beside, [p for p in others if key((*beside.laws, p.law)) not in self.candidates])
        return self._raced(leader, (), starts)

    def _spoken_for(self, leader: Candidate, laws: Sequence[Law]) -> list[Proposal]:
        """Of laws those that gain half as much on the measured motion as the best of them."""
        assert leader.fit is not None
        proposals = by_motion(leader.fit, self.data, laws)
        best = max((proposal.gain for proposal in proposals), default=0.0)
        return [proposal for proposal in proposals if proposal.gain > HALF * best]

    def _from_motion(self, leader: Candidate, laws: Sequence[Law], beside: Sequence[Start]) -> list[Start]:
        """Of laws that the measured motion speaks for, those that gain half as much there as the best; with others."""
        self.progress("regression on the measured motion", 0.0)
        return self._raced(leader, self._spoken_for(leader, laws), beside)

    def _raced(self, leader: Candidate, proposals: Sequence[Proposal], beside: Sequence[Start] = ()) -> list[Start]:
        """The leader with one law more, where that was proposed, raced; with others."""
        assert leader.fit is not None
        self._race(starts := [*beside, *self._added(leader, proposals)], leader.fit)
        return starts

    def _arrived(self, leader: Candidate, starts: Sequence[Start]) -> list[Candidate]:
        """Neighbours of the leader that came within reach, weighed; the others are kept with the reason they left."""
        assert leader.fit is not None
        front = self._front(leader, starts)
        self._race(freed := self._with_shapes(starts, front), front)
        starts = [*starts, *freed]
        front = self._front(leader, starts)
        self._compare_by(front)
        best = self._paid_by(front)
        by_laws: dict[tuple[str, ...], list[Start]] = {}
        for start in starts:
            start.measured_by(self._measures[0])
            by_laws.setdefault(start.laws, []).append(start)
        arrived = []
        for laws, own in by_laws.items():
            first = max(own, key=self._paid)
            if self._paid(first) < max(best - DECISIVE, self._paid_by(leader.fit) if first.adds else -np.inf):
                self._left(laws, first, best)
                continue
            self.progress("weighing what arrived", 0.95)
            candidate = self.weigh(laws, first.fitted)
            if (known := self.candidates.get(laws)) is None or candidate.value > known.value:
                _log.info("%s: weighed, log-evidence %.6g", candidate.name, candidate.value)
                self.candidates[laws] = candidate
                arrived.append(candidate)
        return arrived

    def _front(self, leader: Candidate, starts: Sequence[Start]) -> Fitted:
        """The best so far, parameters paid for."""
        assert leader.fit is not None
        front = max(starts, key=self._paid, default=None)
        return leader.fit if front is None or self._paid(front) < self._paid_by(leader.fit) else front.fitted

    def _at_noise(self, leader: Candidate, starts: Sequence[Start]) -> bool:
        """Whether the best so far leaves about the noise."""
        front = self._front(leader, starts)
        return self._measures[0].near(front.residuals, front.model, self.data)

    def _compare_by(self, front: Fitted) -> None:
        """Compare all structures by the noise that the best of them leaves."""
        if front is self._front_before:
            return
        self._front_before, apart = front, self.weighing.apart
        self._measures = measure_by(front, self.data), measure_by(judged(front.model, apart), apart)
        for laws, candidate in self.candidates.items():
            if candidate.stage == "judged" and candidate.fit is not None:
                self.candidates[laws] = self.weigh(laws, candidate.fit, candidate.held_out)

    def _race(self, starts: Sequence[Start], standing: Fitted) -> None:
        for start in starts:
            start.measured_by(self._measures[0])
        needed = needed_in_samples(standing, self.data) if any(start.adds for start in starts) else 0.0
        how = starts, self._measures[0], standing, self.data.points
        raced = race(*how, lambda what, part: self.progress(what, 0.3 + 0.65 * part), self._over, needed)
        self._measures = raced, self._measures[1]

    def _cost(self, parameters: int) -> float:
        return 0.5 * parameters * math.log(self.data.points)

    def _cost_of(self, law: Law) -> float:
        """What a further law has to gain: for each parameter that is fitted at once."""
        return self._cost(sum(not (p.shape or p.scale) for p in law.parameters))

    def _paid(self, start: Start) -> float:
        return start.value - self._cost(start.count)

    def _paid_by(self, fitted: Fitted) -> float:
        return self._measures[0].value(fitted.residuals) - self._cost(len(fitted.free))

    def _left(self, laws: tuple[str, ...], front: Start, best: float) -> None:
        """Keep what is known of a structure that did not arrive."""
        if laws in self.candidates:
            return
        short = best - (self._paid(front) if front.resting else front.ceiling - self._cost(front.count))
        far = f"what it promised stayed {short:.4g} below the best" if math.isfinite(short) else "it follows nothing"
        why = f"left after {front.steps} steps: {far}"
        if front.resting and math.isfinite(short):
            why = f"fitted, it stays {short:.4g} below the best in log-likelihood, its parameters paid for"
        left = Candidate(laws, front.fitted, stage="left" if front.steps else "simulated", why=why)
        _log.info("%s: %s", left.name, why)
        self.candidates[laws] = left

    def weigh(self, laws: tuple[str, ...], fitted: Fitted, held_out: Fitted | None = None) -> Candidate:
        """A fitted structure with what speaks for it; see ``Weighing.weigh``."""
        return self.weighing.weigh(laws, fitted, held_out)

    def _started(self, entries: Iterable[Entry], *, noise: bool = False) -> list[Start]:
        """Those that can be simulated."""
        put = partial(started, data=self.data, measure=self._measures[0], beside_noise=noise)
        starts = [put(entry) for entry in entries if not self._over()]
        return [start for start in starts if start is not None]

    def _addable(self, leader: Candidate, *, learnt: bool = False) -> list[Law]:
        """The laws that the leader could have besides: those that have a cause, or those that are learnt."""
        return [] if len(leader.laws) == MOST_EFFECTS else self._beside(leader, learnt=learnt)

    def _beside(self, leader: Candidate, *, learnt: bool = False) -> list[Law]:
        """The laws that the leader does not have."""
        assert leader.fit is not None
        present = {name for term in leader.fit.model.terms for name in (term.law.effect, term.law.twin)}
        laws = [law for law in self.laws if law.learnt == learnt]
        return [law for law in laws if law.effect not in present and not only_a_name(law)]

    def _added(self, leader: Candidate, proposals: Sequence[Proposal]) -> list[Start]:
        """The leader with one law more, where that was proposed."""
        assert leader.fit is not None
        entries = []
        measure = self._measures[0]
        near = measure.near(leader.fit.residuals, leader.fit.model, self.data)
        for proposal in proposals:
            # far from the truth the leader has bent itself, and what it says of a law is no bound for it
            hoped = measure.value(leader.fit.residuals) + proposal.gain if near else np.inf
            cost = self._cost_of(find(proposal.law))
            laws, fixed = key((*leader.laws, proposal.law)), kept(leader.fit, proposal.model)
            if proposal.gain < cost:
                promised = f"its score promises {max(proposal.gain, 0.0):.3g} in log-likelihood"
                short = Candidate(laws, why=f"{promised}, less than its parameters cost")
                _log.info("%s: %s", short.name, short.why)
                self.candidates.setdefault(laws, short)
                continue
            patience = 0 if near else PATIENCE
            begun = proposal.initial, proposal.offsets
            entries.append(Entry(laws, proposal.model, *begun, fixed, hoped, patience, adds=True))
        return self._started(entries)

    def _exchanged(self, leader: Candidate) -> list[Entry]:
        """The leader with one law, or several at once, exchanged for one that acts most like it on its own motion."""
        assert leader.fit is not None
        entries = [*more_general(leader), *finer(leader)]
        # on the motion of a leader that is right, what acts like one of its laws begins near its own maximum
        patience = PATIENCE if self._at_noise(leader, ()) else _CONVERGES
        for names in (some for size in range(len(leader.laws)) for some in combinations(leader.laws, size + 1)):
            place = leader.laws, names
            if place in self._asked and self._asked[place] is leader.fit:
                continue
            self._asked[place] = leader.fit
            proposals = alike(leader.fit, self.data, names, [law for law in self._beside(leader) if moves_along(law)])
            for rank, proposal in enumerate(proposals):
                laws = key([law for law in leader.laws if law not in names] + [proposal.law])
                known = self.candidates.get(laws)
                if known is not None and known.stage == "judged":
                    # it may rest on a side summit, beside the one that the leader shows the way to
                    if known.value > leader.value - DECISIVE:
                        continue
                elif rank >= _MOST_ALIKE or (rank >= _ALIKE and proposal.gain < HALF * proposals[0].gain):
                    continue
                fixed = kept(leader.fit, proposal.model)
                begun = proposal.initial, proposal.offsets
                entries.append(Entry(laws, proposal.model, *begun, fixed, patience=patience))
        return entries

    def _with_shapes(self, starts: Sequence[Start], front: Fitted) -> list[Start]:
        """Starts with the shape of their laws free too, of those that came far."""
        far = [start for start in starts if self._paid(start) > self._paid_by(front) - DECISIVE]
        return self._started([entry for start in far if (entry := with_shapes(start)) is not None])

    def _simulated(self, leader: Candidate) -> Candidate:
        """The leader fitted as a simulation, from here on, where it keeps step with the recordings; else as it was."""
        if self.data.memory == FREE or leader.fit is None:
            return leader
        free = replace(self.data, memory=FREE)
        fixed = [name for name in leader.fit.model.parameters() if name not in leader.fit.free]
        fit = leader.fit
        start = started(Entry(leader.laws, fit.model, fit.initial, fit.offsets, fixed), free, Measure())
        if start is None:
            return leader
        race([start], Measure(), None, self.data.points)
        if not keeps_step(free.segments, start.fitted.residuals):
            return leader
        _log.info("%s keeps step with the recordings: simulated from here on, no longer predicted", leader.name)
        self.data = free
        self.holdout = None if self.holdout is None else replace(self.holdout, memory=FREE)
        before = self.candidates[()].fit
        family = None if before is None else judged(before.model, free)
        self.candidates = {laws: c for laws, c in self.candidates.items() if c.stage != "judged"}
        self._compare_by(start.fitted)
        if family is not None:
            self.candidates[()] = self.weigh((), family)
        again = self.weigh(leader.laws, start.fitted)
        self.candidates[leader.laws] = again
        return again
