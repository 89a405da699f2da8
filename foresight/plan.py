"""The excitation that would tell a quantity so well: among releases, sweeps, random and stepped forces.

Each candidate is rehearsed by the engine: the response's derivatives over the noise give the errors that a fit would
state (Goodwin and Payne 1977: experiments are compared by the information that they hold). Its level is as large as
the limits of force and stroke let it be, and parts of that; its length, or how often a release is made, follows from
how the errors shrink with it. The shortest that tells enough is chosen, and tried: simulated with noise and identified.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..errors import BadInput, DashpotError
from ..identify.identification import identify
from ..identify.problem.data import Data
from ..identify.signals.registry import budget, numerics, shown
from ..model import Oscillator
from ..model.display import scale_of
from ..model.fit_state import percent_words, times_words
from ..model.law import Scales
from .excitation import STEPS, Excitation
from .rehearsal import Played, rehearse
from .virtual import DENSITY, Noise, natural_hz, recordings_of_plan, simulated, without_errors
from .want import Want, errors_of, quantities, stated, wants_of

#: What may be played, and tried where nobody says which.
TESTS = ("decay", "sweep", "random", "stepped")

_CYCLES = numerics(60.0, "natural cycles", why="of a first rehearsal; lengths follow from what it tells")
_LEAST_CYCLES = numerics(20.0, "natural cycles", why="fewer are no recording that a fit takes for a motion of its own")
_HELD = numerics(8.0, "natural cycles", why="of each frequency of a stepped sine, so that it is one")
_LEVELS = numerics((1.0, 0.5, 0.2), "parts of the largest", why="what hinges on small motion shows at one of them")
_BANDS = numerics(((0.8, 1.25), (0.5, 2.0)), "times the natural frequency", why="about the resonance, and around it")
_NEAR = numerics(0.97, "of the stroke", why="to which a level is brought, so that noise does not lead beyond it")
_LOWER = numerics(0.85, "times the level", why="a step towards a level that keeps to the stroke")
_SPARE = numerics(
    0.85, "of the error wanted", why="what is planned for: an estimate of an error errs by a tenth itself"
)
_ROUNDS = budget(5, "rehearsals", why="in which a level is brought to the stroke")
_LENGTHS = budget(3, "rehearsals", why="in which a length is brought to the error wanted")
_FINALISTS = budget(3, "excitations", why="of which the length is found by further rehearsals")
_MOST_RELEASES = shown(20, "releases", why="more than anybody makes by hand")
_SAMPLES = budget(400_000, "samples", why="of the longest rehearsal")
_DIGITS = shown(2, "digits", why="of levels and lengths that a person sets")


@dataclass(frozen=True)
class Trial:
    """One simulated and identified realisation of a plan: stated and true errors of each want, in its unit."""

    stated: tuple[float, ...]
    off: tuple[float, ...]
    reached: bool


@dataclass(frozen=True, eq=False, repr=False)
class Plan:
    """An excitation and what it is expected to tell.

    Attributes:
        model: of the rig.
        wants: what was wanted.
        excitation: what to play.
        fs: samples a second.
        noise: that was counted on.
        expected: standard error of each want, in its unit.
        peak: largest displacement that is expected.
        others: the best of each other kind of test, with the largest of its errors over those wanted.
        trials: how it went when it was simulated and identified.
        signal: (n,) force to play; None for a release.
    """

    model: Oscillator
    wants: tuple[Want, ...]
    excitation: Excitation
    fs: float
    noise: Noise
    expected: tuple[float, ...]
    peak: float
    others: tuple[tuple[Excitation, float], ...]
    trials: tuple[Trial, ...]
    signal: np.ndarray | None

    @property
    def tells(self) -> bool:
        """Whether the errors that are expected are those wanted."""
        return all(error <= want.error for error, want in zip(self.expected, self.wants, strict=True))

    @property
    def reached(self) -> int:
        """How often the trials stated the errors wanted."""
        return sum(trial.reached for trial in self.trials)

    @property
    def passed(self) -> bool:
        """Whether it is expected to tell what is wanted, and did so in more than half of the trials."""
        return self.tells and 2 * self.reached >= len(self.trials)

    def __repr__(self) -> str:
        return describe(self)

    def csv(self) -> str:
        """The force to play over time, as CSV; raises BadInput for a release, which needs none."""
        if self.signal is None:
            raise BadInput("a release plays no force; leave out the file for it")
        unit = "".join(c if c.isalnum() else "_" for c in self.model.force_unit)
        rows = (f"{i / self.fs:.9g},{force:.9g}" for i, force in enumerate(self.signal))
        return "\n".join([f"time_s,force_{unit}", *rows]) + "\n"

    def as_json(self) -> dict[str, Any]:
        """The same as plain data for ``json.dumps``."""
        e = self.excitation
        return {
            "format": "dashpot-plan/1",
            "excitation": {
                "kind": e.kind,
                "level": e.level,
                "unit": self.model.response.displacement_unit if e.kind == "decay" else self.model.force_unit,
                "from_hz": e.band_hz[0],
                "to_hz": e.band_hz[1],
                "seconds": e.seconds,
                "repeats": e.repeats,
                "fs": self.fs,
            },
            "sentence": _sentence(self),
            "wants": [
                {"name": want.name, "wanted": want.error, "expected": _finite(error), "unit": want.unit}
                for want, error in zip(self.wants, self.expected, strict=True)
            ],
            "tells": self.tells,
            "peak": self.peak,
            "instead": [
                {"sentence": other.sentence(self.model.response.displacement_unit, self.model.force_unit)}
                | {"error_over_wanted": _finite(ratio)}
                for other, ratio in self.others
            ],
            "noise": {"response": self.noise.sensor, "force": self.noise.force},
            "trials": [
                {"stated": list(map(_finite, t.stated)), "off": list(map(_finite, t.off)), "reached": t.reached}
                for t in self.trials
            ],
            "reached": self.reached,
        }


@dataclass(frozen=True)
class Bounds:
    """What may be asked of a rig: displacement, force (inf: any), length of the test in s, and which tests."""

    amplitude: float
    force: float = math.inf
    seconds: float = 600.0
    tests: tuple[str, ...] = TESTS


def plan(
    model: Oscillator,
    wants: Sequence[str],
    bounds: Bounds,
    noise: Noise,
    *,
    fs: float | None = None,
    tries: int = 3,
    seed: int = 0,
    progress: Callable[[str], None] = lambda _: None,
) -> Plan:
    """The shortest test that would tell what is wanted.

    Args:
        model: of the rig, as far as it is known.
        wants: such as ``cubic 1%``, ``dry 0.001 m/s2``, ``friction 5%``.
        bounds: what may be asked of the rig.
        noise: of the sensors.
        fs: samples a second; sixty a cycle where None.
        tries: how often it is simulated and identified.
        seed: of the noise of these.
        progress: called with one line a step.

    Raises:
        BadInput: something wanted is no quantity of the model, or nothing within the bounds simulates.
    """
    model = without_errors(model)
    wanted = wants_of(wants, model)
    fs = fs or float(f"{DENSITY * natural_hz(model, bounds.amplitude)[1]:.2g}")
    stage = Stage(model, wanted, bounds, noise, fs)
    progress("levels within stroke and force")
    first = stage.candidates()
    progress(f"what {len(first)} excitations would tell")
    judged = stage.judged(first) if first else []
    if not judged:
        raise BadInput(
            f"{model.name}: no test within the limits can be simulated; ask for more amplitude or force, or other tests"
        )
    progress("how long the best of them must be")
    finished = stage.finished(judged)
    best = min(finished, key=lambda one: (max(one.ratio, 1.0), one.excitation.seconds * one.excitation.repeats))
    others = {}
    for one in sorted(finished, key=lambda one: (max(one.ratio, 1.0), one.excitation.seconds * one.excitation.repeats)):
        if one.excitation.kind != best.excitation.kind:
            others.setdefault(one.excitation.kind, (one.excitation, one.ratio))
    trials = []
    for number in range(tries):
        progress(f"tried by simulating and identifying: {number + 1} of {tries}")
        trials.append(stage.tried(best.excitation, (seed, number)))
    return Plan(
        model=model,
        wants=wanted,
        excitation=best.excitation,
        fs=fs,
        noise=noise,
        expected=tuple(best.errors),
        peak=best.peak,
        others=tuple(others.values()),
        trials=tuple(trials),
        signal=None if best.excitation.kind == "decay" else best.excitation.signal(fs),
    )


@dataclass(frozen=True, eq=False)
class Judged:
    """An excitation with the errors that it tells with, the largest of these over that wanted, and how far it moves."""

    excitation: Excitation
    errors: tuple[float, ...]
    ratio: float
    peak: float


class Stage:
    """The rig and what it is asked, beside which excitations are rehearsed."""

    def __init__(
        self,
        model: Oscillator,
        wants: tuple[Want, ...],
        bounds: Bounds,
        noise: Noise,
        fs: float,
    ) -> None:
        natural = natural_hz(model, bounds.amplitude)
        self.model, self.wants, self.bounds, self.noise = model, wants, bounds, noise
        self.fs, self.rate, self.natural = fs, min(DENSITY * natural[1], fs), natural
        mass = None if model.mass is None else model.mass.value
        pace = 2 * np.pi * natural[1]
        scales = Scales(
            length=bounds.amplitude,
            omega=pace,
            force=bounds.force if math.isfinite(bounds.force) else (mass or 1.0) * pace**2 * bounds.amplitude,
            response=bounds.amplitude * pace ** _order(model),
            duration=_CYCLES / natural[0],
            mass=mass,
        )
        self.data = Data((), (), (noise.sensor,), (noise.force,), scales)

    def rehearsed(self, excitations: Sequence[Excitation]) -> Played:
        """They, by the engine."""
        reach = self.bounds.amplitude
        return rehearse(self.model, self.model, excitations, self.data, self.rate, self.fs, reach)

    def candidates(self) -> list[Excitation]:
        """Every kind of test at its largest level and parts of that."""
        low, high = self.natural
        seconds = min(_CYCLES / low, self.bounds.seconds)
        found = []
        if "decay" in self.bounds.tests:
            found += [Excitation("decay", self.bounds.amplitude * part, part, (low, high), seconds) for part in _LEVELS]
        if self.model.mass is None:
            return [_rounded(e) for e in found]
        driven = []
        for below, above in _BANDS:
            band = (below * low, above * high)
            driven += [
                Excitation(kind, 1.0, 1.0, band, min(max(seconds, self._least(kind)), self.bounds.seconds))
                for kind in self.bounds.tests
                if kind != "decay"
            ]
            if "sweep" in self.bounds.tests:
                driven.append(Excitation("sweep", 1.0, 1.0, (band[1], band[0]), seconds))
        levels = self._levels(driven)
        for excitation, level in zip(driven, levels, strict=True):
            if level is not None:
                found += [replace(excitation, level=level * part, relative=part) for part in _LEVELS]
        return [_rounded(e) for e in found]

    def _least(self, kind: str) -> float:
        """Least seconds of a driven test."""
        return (_HELD * STEPS if kind == "stepped" else _LEAST_CYCLES) / self.natural[0]

    def _levels(self, driven: Sequence[Excitation]) -> list[float | None]:
        """The largest level of each that keeps to stroke and force; None where none simulates."""
        if not driven:
            return []
        stroke, model = self.bounds.amplitude, self.model
        mass = 1.0 if model.mass is None else model.mass.value
        damping = max(model.viscous.value, 1e-3 * model.omega0.value) + 4 * abs(model.dry.value) / (
            np.pi * model.omega0.value * stroke
        )
        start = mass * (damping * model.omega0.value * stroke + abs(model.preload.value))
        levels = np.full(len(driven), min(start, self.bounds.force))
        largest: list[float | None] = [None] * len(driven)
        for _ in range(_ROUNDS):
            peaks = self.rehearsed([replace(e, level=float(f)) for e, f in zip(driven, levels, strict=True)]).peaks
            for i, peak in enumerate(peaks):
                if peak <= stroke and (largest[i] is None or levels[i] > largest[i]):
                    largest[i] = float(levels[i])
                ratio = _NEAR * stroke / peak if np.isfinite(peak) and peak > 0 else 0.5
                levels[i] = min(levels[i] * float(np.clip(ratio, 0.3, 3.0)), self.bounds.force)
        return largest

    def judged(self, excitations: Sequence[Excitation]) -> list[Judged]:
        """Those that keep to the stroke, with the errors that they tell with."""
        played = self.rehearsed(excitations)
        names = tuple(self.model.parameters())
        found = []
        for i, excitation in enumerate(excitations):
            peak = played.peaks[i]
            if peak > self.bounds.amplitude * (1 + 1e-6):
                continue
            free = [j for j, name in enumerate(names) if excitation.kind != "decay" or name != "mass"]
            covariance = played.covariance(i, free, self.noise.force * math.sqrt(self.rate / self.fs))
            if covariance is None:
                continue
            told = covariance / excitation.repeats
            errors = errors_of(self.wants, self.model, [names[j] for j in free], told)
            ratio = max(error / want.error for error, want in zip(errors, self.wants, strict=True))
            found.append(Judged(excitation, tuple(errors), ratio, peak))
        return found

    def finished(self, judged: Sequence[Judged]) -> list[Judged]:
        """The most promising as long as they must be: the errors shrink with the root of that."""
        promising = sorted(judged, key=lambda one: one.excitation.seconds * one.ratio**2)
        kinds = [
            min((one for one in promising if one.excitation.kind == kind), key=promising.index, default=None)
            for kind in self.bounds.tests
        ]
        chosen = list(dict.fromkeys([*promising[:_FINALISTS], *(one for one in kinds if one is not None)]))
        return [self._as_long_as_it_must_be(one) for one in chosen]

    def _as_long_as_it_must_be(self, one: Judged) -> Judged:
        best = one
        for _ in range(_LENGTHS):
            longer = self._scaled(one)
            if longer == (one.excitation.seconds, one.excitation.repeats):
                break
            excitation = _rounded(replace(one.excitation, seconds=longer[0], repeats=longer[1]))
            again = self._within_the_stroke(excitation)
            if again is None:
                break
            one = again
            if (one.ratio <= 1.0 and (best.ratio > 1.0 or _total(one) < _total(best))) or one.ratio < best.ratio > 1.0:
                best = one
            if _SPARE * _SPARE < one.ratio <= _SPARE * 1.05:
                break
        return best

    def _within_the_stroke(self, excitation: Excitation) -> Judged | None:
        """It with as much less force as a longer test needs, that meets a resonance more slowly."""
        for _ in range(_ROUNDS):
            if found := self.judged([excitation]):
                return found[0]
            excitation = _rounded(replace(excitation, level=_LOWER * excitation.level))
        return None

    def _scaled(self, one: Judged) -> tuple[float, int]:
        """Seconds and repeats after which the errors are expected to be as wanted, within the bounds."""
        e, needs = one.excitation, (one.ratio / _SPARE) ** 2
        most = min(self.bounds.seconds, _SAMPLES / self.rate)
        if e.kind == "decay":
            often = min(_MOST_RELEASES, max(1, int(self.bounds.seconds // e.seconds)))
            return e.seconds, int(np.clip(math.ceil(e.repeats * min(needs, 1e6)), 1, often))
        return float(np.clip(e.seconds * min(needs, 1e6), min(self._least(e.kind), most), most)), 1

    def tried(self, excitation: Excitation, seed: Sequence[int]) -> Trial:
        """The plan simulated with noise and identified."""
        model = self.model
        clean = [simulated(model, excitation, self.fs)]
        given = recordings_of_plan(model, [excitation], clean, self.fs, self.noise, seed)
        truth = quantities(model)
        fixed = {} if model.mass is None or excitation.kind != "decay" else {"mass": model.mass.value}
        try:
            found = identify(given, effects=[t.effect for t in model.terms], fixed=fixed, every=False).oscillator
        except DashpotError:
            nothing = tuple(math.inf for _ in self.wants)
            return Trial(nothing, nothing, False)
        known = quantities(found)
        errors = tuple(stated(known.get(want.name)) for want in self.wants)
        wrong = tuple(
            abs(known[want.name].value - truth[want.name].value) if want.name in known else math.inf
            for want in self.wants
        )
        return Trial(errors, wrong, all(e <= want.error for e, want in zip(errors, self.wants, strict=True)))


def _order(model: Oscillator) -> int:
    return ("displacement", "velocity", "acceleration").index(model.response.quantity)


def _total(one: Judged) -> float:
    return one.excitation.seconds * one.excitation.repeats


def _rounded(e: Excitation) -> Excitation:
    """With a level, frequencies and a length that a person sets: levels down, lengths up, to two digits."""
    low, high = (float(f"{f:.{_DIGITS + 1}g}") for f in e.band_hz)
    return replace(e, level=_digits(e.level, math.floor), seconds=_digits(e.seconds, math.ceil), band_hz=(low, high))


def _digits(value: float, towards: Callable[[float], int]) -> float:
    place = 10.0 ** (math.floor(math.log10(value)) - _DIGITS + 1)
    return float(f"{towards(value / place * (1 - 1e-9 if towards is math.ceil else 1 + 1e-9)) * place:.{_DIGITS}g}")


def _sentence(plan: Plan) -> str:
    model = plan.model
    said = plan.excitation.sentence(model.response.displacement_unit, model.force_unit)
    return f"{said[0].upper()}{said[1:]}, sampled at {plan.fs:g} Hz."


def describe(plan: Plan) -> str:
    """The plan as text: what to play, what it tells, how the trials went."""
    model = plan.model
    unit = model.response.displacement_unit
    scale = scale_of(unit, plan.peak)
    lines = [_sentence(plan), f"It moves up to {scale.factor * plan.peak:.3g} {scale.unit}."]
    truth = quantities(model)
    for want, error in zip(plan.wants, plan.expected, strict=True):
        share = f" ({percent_words(100 * error / abs(truth[want.name].value))} %)" if truth[want.name].value else ""
        enough = "" if error <= want.error else ": not what is wanted"
        lines.append(f"Expected of {want.name}: ± {error:.2g} {want.unit}{share}, wanted ± {want.error:.2g}{enough}")
    if not plan.tells:
        lines.append(
            "No test within the limits tells what is wanted; this one comes nearest. Allow more amplitude, force or "
            "time, or measure with less noise."
        )
    if plan.trials:
        within = sum(all(o <= 2 * s for o, s in zip(t.off, t.stated, strict=True)) for t in plan.trials)
        lines.append(
            f"Simulated and identified {len(plan.trials)} times: the errors wanted were stated {plan.reached} times, "
            f"the truth lay within twice the stated errors {within} times."
        )
    for other, ratio in plan.others:
        said = other.sentence(unit, model.force_unit)
        lines.append(
            f"Instead: {said}; "
            + ("tells it too" if ratio <= 1.0 else f"comes to {times_words(ratio)} times the error wanted")
        )
    return "\n".join(lines)


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
