"""The search for what is missing: one effect after another, each tried from several starts and judged on other records.

A law comes in where the training recordings ask for it by more than its parameters cost (Schwarz 1978) and the
held-out ones, of another level and kind, are told better with it than without.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ...errors import DashpotError
from ...identify.data import Data, likelihood, noise_spectra
from ...identify.from_prediction import keeps_step
from ...identify.measured_motion import Regression
from ...identify.noise_spectrum import NoiseSpectrum
from ...identify.prediction import FREE
from ...identify.settle import settled
from ...identify.structure import Fitted, Structure, phases_of, renamed, shapes_of, without_states
from ...model import Oscillator
from ...model.law import Law
from ...model.laws import LIBRARY, find
from ...model.terms import generalised, without_term
from ...simulate.core import internal_step
from .judgement import ACCEPT_TRAIN, INDISTINGUISHABLE, Round, Trial, only_a_name, ordered
from .residual_test import expected
from .score_test import Screen
from .spectral_lines import residual_lines

#: A law is fitted where it promises this gain of log-likelihood; three parameters gain 6 by chance once in 130.
WORTH_A_FIT = 6.0
#: Fitted to the end are this many laws ...
_FINALISTS = 6
#: ... of those that are within this part of the best gain after a few steps.
_NEAR = 0.1
#: ... and, once one law has reached the noise, within this part of its gain.
_HALFWAY = 0.4
_FEW_STEPS = 3
#: The law of a sensor that sits elsewhere all the time.
SENSOR_OFFSET = "sensor-offset"
#: Factors of two by which a parameter is moved at most, where steps alone would be caught.
_PACES = 4
#: A law whose simulation takes this many times as many steps is given fewer of the search's.
_SLOW = 4.0
#: A law that gains less than this, or whose other parameters alone gain something, is compared with a family that has
#: been searched for again.
_CLOSE_CALL = 200.0
#: Laws that each of the two screens sends to be fitted.
_LEADING = 7
#: ... and this many altogether are.
_CANDIDATES = 9
#: So many of the best are fitted once more where they leave between so many times the noise ...
_CONTENDERS = 3
_CLOSE = 1.05
#: ... and so many.
_FAIR = 3.0
#: A family that leaves this many times the noise is too far off for its derivatives to tell all.
_FAR = 1.2
#: Above this many times the noise something may be left for the shape of a law to explain.
_SHAPES_MATTER = 1.02


@dataclass(eq=False)
class Search:
    """The search over the library.

    Attributes:
        data: training recordings.
        holdout: recordings that no parameter is fitted to.
        laws: the library, with the user's laws.
        progress: called with what is being done and which part of all is done.
        by_motion: gain of each law in the last regression on the measured motion.
    """

    data: Data
    holdout: Data
    laws: Sequence[Law] = field(default_factory=lambda: tuple(LIBRARY.values()))
    progress: Callable[[str, float], None] = lambda _what, _part: None
    by_motion: dict[str, float] = field(default_factory=dict, init=False)

    def best_of_family(self, model: Oscillator) -> Fitted:
        """The parameters of a model's own structure that suit the training recordings best."""
        fitted = Structure(model, self.data).fit(settle=True, most=15)
        return self._polish(fitted, ())

    def simulated(self, fitted: Fitted) -> Fitted:
        """The model fitted as a simulation, from here on, where it keeps step with the recordings; else as it was."""
        if self.data.memory == FREE:
            return fitted
        free = replace(self.data, memory=FREE)
        fixed = [name for name in fitted.model.parameters() if name not in fitted.free]
        try:
            found = Structure(fitted.model, free, fixed).fit(fitted.initial, settle=True)
        except DashpotError:
            return fitted
        if not keeps_step(free.segments, found.residuals):
            return fitted
        self.data, self.holdout = free, replace(self.holdout, memory=FREE)
        return self._polish(found, fixed)

    def judge(self, model: Oscillator, data: Data | None = None) -> Fitted:
        """The held-out recordings, or others, under a model as it is; only initial states and offsets are found anew.

        A recording through which the model does not simulate is not told at all.
        """
        data = data or self.holdout
        structure = Structure(model, data, tuple(model.parameters()))
        state = settled(structure.problem, structure.state(None))
        residuals = structure.problem.residuals(state)
        if all(np.all(np.isfinite(residual)) for residual in residuals):
            return structure.fit(state.initial, tolerance=0.1)
        told = tuple(
            residual if np.all(np.isfinite(residual)) else segment.response
            for segment, residual in zip(data.segments, residuals, strict=True)
        )
        return Fitted(model, state.initial, told, likelihood(told, model, data), ())

    def round(self, fitted: Fitted) -> Round:
        """Try the library on a fitted model."""
        before = self.judge(fitted.model)
        starts = self._starts(fitted)
        self.progress("fitting the laws that promise most", 0.3)
        early: list[tuple[float, str, Fitted]] = []
        near = max(self._ratios(fitted)) <= _FAR
        noise = noise_spectra(fitted.residuals, fitted.model, self.data) if near else None
        for i, (effect, models) in enumerate(starts.items()):
            steps = _FEW_STEPS
            if self._slowness(models[0][0], fitted.model) > _SLOW:  # the better start alone, and fewer steps
                models, steps = models[:1], _FEW_STEPS - 1
            found = [f for m, initial in models if (f := self._fit(m, initial, steps, noise=noise)) is not None]
            if found:
                best = max(found, key=lambda f: f.likelihood)
                early.append((best.likelihood, effect, best))
            self.progress(f"{effect}", 0.3 + 0.3 * (i + 1) / len(starts))
        early.sort(key=lambda one: -one[0])
        trials: list[Trial] = []
        # far from the truth first steps are those of white noise; the family is held against them after the same
        base = fitted.likelihood if near or not early else self._like_the_others(fitted)
        bar = ACCEPT_TRAIN / 2 if near else _NEAR * (early[0][0] - base) if early else 0.0
        for i, (value, effect, one) in enumerate(early):
            trial = self.trial(effect, one, fitted, before, finished=False)
            if i < _FINALISTS and (trial.gain if near else value - base) > bar:
                trial = self.trial(effect, self.finish(one), fitted, before, finished=True)
                if max(self._ratios(trial.fitted)) <= _FAR:  # nothing can do much better than reach the noise
                    bar = max(bar, _HALFWAY * (trial.fitted.likelihood - fitted.likelihood))
            trials.append(trial)
            self.progress(f"{effect}", 0.6 + 0.3 * (i + 1) / len(early))
        trials = self._to_the_end(trials, fitted, before)
        if not near and not any(t.finished and max(self._ratios(t.fitted)) <= _FAR for t in trials):
            trials += self._rugged(fitted, before)
        trials = self._with_twins(trials, fitted, before)
        round_ = Round(fitted, before, ordered(trials))
        best = round_.best
        if best is None:
            return round_
        if best.gain > _CLOSE_CALL and not self._worth(without_term(best.fitted.model, best.effect), fitted) > 0:
            return round_
        again = self._family_again(fitted, best)
        if again is None:
            return round_
        judged = self.judge(again.model)
        lost, lost_holdout = again.likelihood - fitted.likelihood, judged.likelihood - before.likelihood
        moved = [replace(t, gain=t.gain - lost, holdout_gain=t.holdout_gain - lost_holdout) for t in trials]
        return Round(again, judged, ordered(moved))

    def _like_the_others(self, fitted: Fitted) -> float:
        """Log-likelihood of a model after the first steps that laws are given."""
        fixed = [name for name in fitted.model.parameters() if name not in fitted.free]
        plain = self._fit(fitted.model, fitted.initial, _FEW_STEPS, fixed)
        return fitted.likelihood if plain is None else min(plain.likelihood, fitted.likelihood)

    def _to_the_end(self, trials: Sequence[Trial], fitted: Fitted, before: Fitted) -> list[Trial]:
        """The trials; the best, where they have nearly reached the noise, fitted once more to be compared there."""
        found = ordered(trials)
        bar = _HALFWAY * found[0].score if found else 0.0
        again = []
        for i, trial in enumerate(found):
            if (
                i < _CONTENDERS
                and trial.finished
                and trial.score > bar
                and _CLOSE < max(self._ratios(trial.fitted)) < _FAIR
            ):
                better = self.trial(trial.effect, self.finish(trial.fitted), fitted, before, finished=True)
                again.append(better if better.gain > trial.gain else trial)
            else:
                again.append(trial)
        return again

    def _with_twins(self, trials: Sequence[Trial], fitted: Fitted, before: Fitted) -> list[Trial]:
        """The same fits under the names of laws with the same equation, as far as their values suit these names."""
        found = {trial.effect: trial for trial in trials}
        for trial in trials:
            for law in self.laws:
                if law.twin == trial.effect and only_a_name(law):
                    found[law.name] = replace(trial, effect=law.name, fitted=renamed(trial.fitted, trial.effect, law))
            general = find(trial.effect).twin
            if general is None or trial.proper or not trial.supported:
                continue
            known = found.get(general)
            if known is None or known.score < trial.score - INDISTINGUISHABLE:
                noise = noise_spectra(trial.fitted.residuals, trial.fitted.model, self.data)
                wider = generalised(trial.fitted.model, trial.effect)
                one = self._fit(wider, trial.fitted.initial, _FEW_STEPS, noise=noise)
                if one is not None:
                    found[general] = self.trial(general, self.finish(one), fitted, before, finished=True)
        return list(found.values())

    def _rugged(self, fitted: Fitted, before: Fitted) -> list[Trial]:
        """The laws with too many side valleys to be screened, fitted at length where nothing else explains."""
        present = {term.law.effect for term in fitted.model.terms}
        regression = Regression(self.data, fitted.model)
        plain = regression.plain()
        found = []
        for law in self.laws:
            guess = regression.best(law) if law.rugged and law.effect not in present else None
            # the measured motion knows no side valleys: what it speaks against is not worth a long search
            if guess is None or regression.gain(plain, guess) < _HALFWAY * max(self.by_motion.values(), default=0.0):
                continue
            self.progress(law.name, 0.9)
            one = self._paced(guess.put_into(fitted.model), law, fitted.initial)
            if one is not None:
                one = self._fit(one.model, one.initial, 2 * _FEW_STEPS) or one
            if one is not None and one.likelihood > fitted.likelihood:
                found.append(self.trial(law.name, self.finish(one), fitted, before, finished=True))
        return found

    def _paced(self, model: Oscillator, law: Law, initial: np.ndarray) -> Fitted | None:
        """A law's own parameters moved by factors of two as long as that helps, the others fitted to them each time.

        The regression knows little of what happens faster than the rig's own motion, such as a contact's stiffness.
        """
        own = [f"{law.name}.{p.name}" for p in law.parameters]
        best = self._fit(model, initial, _FEW_STEPS, own)
        for name in (f"{law.name}.{p.name}" for p in law.parameters if not p.shape):
            for factor in (2.0, 0.5):
                for _ in range(_PACES):
                    if best is None:
                        return None
                    moved = replace(best.model.parameters()[name], value=factor * best.model.values()[name])
                    one = self._fit(best.model.with_parameters({name: moved}), best.initial, _FEW_STEPS - 1, own)
                    if one is None or one.likelihood < best.likelihood:
                        break
                    best = one
        return best

    def _family_again(self, fitted: Fitted, best: Trial) -> Fitted | None:
        """The model without the law, fitted again from where the law led the others; None where that gains nothing.

        A search that had stopped in a side valley would otherwise credit the law with leaving it.
        """
        model = without_term(best.fitted.model, best.effect)
        initial = best.fitted.initial[:, : fitted.initial.shape[1]]
        shapes = tuple(name for name in fitted.model.parameters() if name not in fitted.free)
        other = self._fit(model, initial, 15, shapes)
        if other is None:
            return None
        other = self._polish(other, shapes)
        return other if other.likelihood > fitted.likelihood + 0.5 else None

    def reconsidered(self, chain: Sequence[Trial]) -> tuple[list[Trial], Fitted]:
        """With a further effect in, those that are still needed, the most needed first, and the model with these."""
        current = chain[-1].fitted
        lost = {chain[-1].effect: chain[-1].gain}
        for trial in chain[:-1]:
            smaller = without_term(current.model, trial.effect)
            noise = noise_spectra(current.residuals, current.model, self.data)
            reduced = self._fit(smaller, without_states(current, trial.effect), 15, noise=noise)
            if reduced is not None:
                reduced = self._polish(reduced, shapes_of(reduced.model))
            cost = 0.5 * len(find(trial.effect).parameters) * math.log(self.data.points)
            loss = np.inf if reduced is None else current.likelihood - reduced.likelihood - cost
            if reduced is not None and loss < ACCEPT_TRAIN:
                current = reduced
            else:
                lost[trial.effect] = loss
        kept = [trial for trial in chain if trial.effect in lost]
        return sorted(kept, key=lambda trial: -lost[trial.effect]), current

    def trial(self, effect: str, one: Fitted, fitted: Fitted, before: Fitted, *, finished: bool) -> Trial:
        """A fitted law against the model without it."""
        phases = phases_of(one.model) - phases_of(fitted.model)  # a phase of each stretch is a parameter like any other
        count = len(one.free) - len(fitted.free) + phases * len(self.data.segments)
        gain = one.likelihood - fitted.likelihood - 0.5 * count * math.log(self.data.points)
        if not finished:
            return Trial(effect, one, None, gain, -np.inf, finished)
        holdout = self.judge(one.model)
        cost = 0.5 * phases * len(self.holdout.segments) * math.log(self.holdout.points)
        return Trial(effect, one, holdout, gain, holdout.likelihood - before.likelihood - cost, finished)

    def finish(self, fitted: Fitted) -> Fitted:
        """Fit to the end: first the shape of its laws as it is, then that too where more than noise is left."""
        shapes = tuple(name for name in shapes_of(fitted.model) if name not in fitted.free)
        if max(self._ratios(fitted)) > _FAR:
            fitted = self._fit(fitted.model, fitted.initial, 12, shapes) or fitted
        done = self._polish(fitted, shapes)
        if not shapes or max(self._ratios(done)) < _SHAPES_MATTER:
            return done
        freed = self._fit(done.model, done.initial, 12, ())
        if freed is None:
            return done
        freed = self._polish(freed, ())
        cost = 0.5 * len(shapes) * math.log(self.data.points)
        return freed if freed.likelihood - cost > done.likelihood else done

    def _starts(self, fitted: Fitted) -> dict[str, list[tuple[Oscillator, np.ndarray]]]:
        """For each law worth a fit the models to start from."""
        present = {name for term in fitted.model.terms for name in (term.law.effect, term.law.twin)}
        laws = [law for law in self.laws if law.effect not in present and not law.rugged and not only_a_name(law)]
        self.progress("score of every law", 0.02)
        self.data = replace(self.data, scales=replace(self.data.scales, lines=residual_lines(fitted, self.data)))
        scored = {start.effect: start for start in Screen(fitted, self.data).starts(laws)}
        gains = {name: max(start.promise, start.gain) for name, start in scored.items()}
        near = max(self._ratios(fitted)) <= _FAR
        starts = {
            name: [(scored[name].gain, scored[name].model, scored[name].initial)]
            for name in _leading(gains)
            if not near or gains[name] > self._cost(find(name)) + ACCEPT_TRAIN / 2
        }
        # close to the truth the score tells all; far from it the base model has bent itself around what is missing
        if not near:
            self.progress("regression on the measured motion", 0.2)
            regression = Regression(self.data, fitted.model)
            plain = regression.plain()
            guesses = {guess.effect: guess for guess in regression.guesses(laws)}
            self.by_motion = by_motion = {name: regression.gain(plain, guess) for name, guess in guesses.items()}
            for name in _leading(by_motion):
                model = guesses[name].put_into(fitted.model)
                initial = guesses[name].begun(fitted.initial)
                gain = self._worth(model, fitted, initial)
                starts.setdefault(name, []).append((gain, model, initial))
        best_first = sorted(starts, key=lambda name: -max(start[0] for start in starts[name]))
        return {name: [(model, initial) for _, model, initial in starts[name]] for name in best_first[:_CANDIDATES]}

    def _slowness(self, model: Oscillator, base: Oscillator) -> float:
        """How many times as many internal steps a model takes."""
        length = self.data.scales.length
        try:
            return internal_step(base, base.values(), length) / internal_step(model, model.values(), length)
        except DashpotError:
            return np.inf

    def _cost(self, law: Law) -> float:
        """What the parameters of a law must gain to pay for themselves, those of its shape left aside."""
        return 0.5 * sum(not p.shape for p in law.parameters) * math.log(self.data.points)

    def _ratios(self, fitted: Fitted) -> list[float]:
        """What is left in each segment over the noise."""
        return [
            float(np.sqrt(np.mean(residual**2))) / expected(fitted, self.data, i)
            for i, residual in enumerate(fitted.residuals)
        ]

    def _worth(self, model: Oscillator, fitted: Fitted, initial: np.ndarray | None = None) -> float:
        """Gain of log-likelihood of a model as it is."""
        try:
            structure = Structure(model, self.data)
            state = settled(structure.problem, structure.state(fitted.initial if initial is None else initial))
            residuals = structure.problem.residuals(state)
        except DashpotError:
            return -np.inf
        return likelihood(residuals, model, self.data) - fitted.likelihood

    def _fit(
        self,
        model: Oscillator,
        initial: np.ndarray,
        most: int,
        fixed: Sequence[str] | None = None,
        noise: Sequence[NoiseSpectrum] | None = None,
    ) -> Fitted | None:
        try:
            structure = Structure(model, self.data, shapes_of(model) if fixed is None else fixed)
            fitted = structure.fit(initial, noise=noise, most=most, settle=True)
        except DashpotError:
            return None
        return fitted if fitted.finite and np.isfinite(fitted.likelihood) else None

    def _polish(self, fitted: Fitted, fixed: Sequence[str]) -> Fitted:
        """Further steps, every frequency weighed by the noise that is left there."""
        for most in (8, 4):
            noise = noise_spectra(fitted.residuals, fitted.model, self.data)
            try:
                again = Structure(fitted.model, self.data, fixed).fit(fitted.initial, noise=noise, most=most)
            except DashpotError:  # it jumps with the smallest change
                return fitted
            if not again.finite or again.likelihood < fitted.likelihood + 0.5:
                return again if again.likelihood > fitted.likelihood else fitted
            fitted = again
        return fitted


def _leading(gains: dict[str, float]) -> list[str]:
    """The laws with the largest promised gains, as far as they are worth a fit."""
    best = sorted(gains, key=lambda name: -gains[name])
    return [name for name in best[:_LEADING] if gains[name] > WORTH_A_FIT]
