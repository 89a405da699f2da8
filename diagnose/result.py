"""What a diagnosis says: verdict, effects, location, figures before and after; and the file it is written to."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from ..files.computed_once import computed_once
from ..identify.hilbert.hilbert_result import HilbertAnalysis, analysis_or_none
from ..identify.signals.registry import shown
from ..model import Oscillator, Parameter, Response
from ..model.fit_state import Left
from ..model.formula.closed_form import ClosedForm
from ..model.formula.nearest_law import NearestLaw
from ..model.formula.nearest_words import as_json as nearest_as_json
from ..model.left import over
from ..model.physical import law_strengths
from ..recording.recording import Recording
from ..simulate.work import Work
from .depends_on import DependsOn

SURE = shown(
    1e6, "odds", why="odds beyond this say no more than that nothing else is left: the noise itself is known no better"
)

Verdict = Literal["consistent", "missing-physics", "unexplained"]


@dataclass(frozen=True, eq=False)
class RecordFit:
    """One recording under the best of the given family and under the mended model, free-run.

    Attributes:
        file: the recording's name.
        holdout: whether no parameter was fitted to it.
        nrmse_before, nrmse_after: rms(simulated - measured) / std(measured).
        noise_floor: the same of a perfect model.
        time, measured, before, after: (n,) signals; ``after`` is ``before`` where nothing was mended.
        force: (n,) as recorded, None in free decay.
        response: what was measured, and in which unit.
    """

    file: str
    holdout: bool
    nrmse_before: float
    nrmse_after: float
    noise_floor: float
    time: np.ndarray = field(repr=False)
    measured: np.ndarray = field(repr=False)
    before: np.ndarray = field(repr=False)
    after: np.ndarray = field(repr=False)
    force: np.ndarray | None = field(repr=False)
    response: Response

    @property
    def left_before(self) -> Left:
        """What the family's best leaves of it, as it is said everywhere."""
        return Left(self.file, self.nrmse_before, over(self.nrmse_before, self.noise_floor))

    @property
    def left_after(self) -> Left:
        """The same of the mended model."""
        return Left(self.file, self.nrmse_after, over(self.nrmse_after, self.noise_floor))


@dataclass(frozen=True)
class Effect:
    """A named effect.

    Attributes:
        effect: name of the effect, without its variant.
        law: name of the law that models it, with its variant.
        path: where in the rig it acts.
        parameters: identified values.
        indistinguishable_from: other effects that these recordings cannot tell from it.
        separated_by: the experiment that would.
        odds: of the effect, or of one that cannot be distinguished from it, against all that was tried instead and, far
            from the noise, causes that the library does not have.
        share: part of the power that is left without it which it takes away; None where nothing ran without it.
    """

    effect: str
    law: str
    path: str
    parameters: Mapping[str, Parameter]
    indistinguishable_from: tuple[str, ...] = ()
    separated_by: str = ""
    odds: float = math.inf
    share: float | None = None

    @property
    def probability(self) -> float:
        """The same as the odds, 0 to 1."""
        odds = min(self.odds, SURE)
        return odds / (1.0 + odds)


@dataclass(frozen=True)
class Location:
    """Where simulation and recording differ.

    Ranges are (low, high); harmonics maps the order to its share of the mismatch's power. ``depends_on`` has the shares
    of the missing force by kind of coordinate; None where it is not known.
    """

    path: str
    statement: str
    displacement: tuple[float, float]
    velocity: tuple[float, float]
    amplitude: tuple[float, float]
    frequency_hz: tuple[float, float]
    time_s: tuple[float, float]
    recordings: tuple[str, ...]
    harmonics: Mapping[int, float]
    depends_on: DependsOn | None = None


@dataclass(frozen=True)
class Considered:
    """A law that was not taken: held-out NRMSE, BIC less that of the model without it (None: not fitted), and why."""

    effect: str
    holdout_nrmse: float | None
    delta_bic: float | None
    why_not: str


@dataclass(frozen=True)
class ChainFact:
    """What the measuring chain does to one recording, or to all.

    Attributes:
        what: ``hold``, ``offset``, ``drift``, ``force-offset``, or ``fault``: one that the model file knows of.
        file: the recording's name; None where it is of all.
        value: in ``unit``; None where it is no number.
        unit: of the value; of a hold its name.
        sentence: for a person.
    """

    what: str
    file: str | None
    value: float | None
    unit: str
    sentence: str


@dataclass(frozen=True, eq=False)
class LatentForce:
    """The missing force per unit mass along one recording, by a smoother that knows no law.

    Attributes:
        file: the recording.
        time, displacement, velocity: (n,) where it was found.
        force, std: (n,) the force that is missing from the family, positive where it opposes the motion's positive
            direction, and its standard deviation.
        named: (n,) what the named effects make of it; None where nothing was named.
    """

    file: str
    time: np.ndarray = field(repr=False)
    displacement: np.ndarray = field(repr=False)
    velocity: np.ndarray = field(repr=False)
    force: np.ndarray = field(repr=False)
    std: np.ndarray = field(repr=False)
    named: np.ndarray | None


@dataclass(frozen=True, eq=False)
class Experiment:
    """The next recording to make.

    Attributes:
        sentence: what to play and why.
        kind: sweep, multisine, sine, decay or none.
        level: largest force, or release displacement for a decay.
        band_hz: lowest and highest frequency.
        seconds: length.
        separates: pairs of models it would tell apart and by how many times the noise.
        signal: (n,) force to play, ``fs`` Hz; None for a decay.
        fs: sampling frequency of the signal.
    """

    sentence: str
    kind: str
    level: float
    band_hz: tuple[float, float]
    seconds: float
    separates: tuple[tuple[str, str, float], ...]
    signal: np.ndarray | None
    fs: float


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis:
    """The whole outcome.

    Attributes:
        verdict: ``missing-physics`` where the model is mended, whatever remains; ``consistent`` where it is not and
            what is left is noise, or a hundredth of the power of every recording; else ``unexplained``.
        sentence: the verdict for a person.
        effects: what is missing, the most important first.
        location: where the family fails; None where it does not.
        before: best of the given family, with standard errors.
        model: the mended model, with standard errors and provenance; the family's best where nothing was mended.
        records: training and held-out recordings.
        considered: the laws that were tried and not taken.
        experiment: what to record next.
        remainder: what stays beyond the noise after mending, in one sentence; None where nothing does.
        latent: the missing force in the recordings that show it best.
        notes: what a user should know.
        chain: what the measuring chain does, which is no physics of the rig.
        work: how often the recordings were simulated for it, and how long that took.
        recordings: all that it was judged by, whole, less what the measuring chain does.
        forms: closed forms that the learnt curves of ``model`` may be, of each the shortest first.
        nearest: of each learnt curve the nearest law of the library, and where the curve departs from it.
    """

    verdict: Verdict
    sentence: str
    effects: tuple[Effect, ...]
    location: Location | None
    before: Oscillator
    model: Oscillator
    records: tuple[RecordFit, ...]
    considered: tuple[Considered, ...]
    experiment: Experiment | None
    remainder: str | None
    latent: tuple[LatentForce, ...]
    notes: tuple[str, ...]
    chain: tuple[ChainFact, ...] = ()
    work: Work | None = None
    recordings: tuple[Recording, ...] = ()
    forms: tuple[ClosedForm, ...] = ()
    nearest: tuple[NearestLaw, ...] = ()

    def __repr__(self) -> str:
        return f"<Diagnosis: {self.verdict}. {self.sentence}>"

    @computed_once
    def measured(self) -> HilbertAnalysis:
        """What FREEVIB and FORCEVIB say of the recordings, without any model; empty, with a note, where nothing."""
        return analysis_or_none(self.recordings)

    @property
    def mended(self) -> bool:
        """Whether ``model`` has laws that the given family lacks, named or not."""
        return self.verdict == "missing-physics"

    def of_machine(self, effect: Effect) -> dict[str, Parameter]:
        """The strengths of an effect's law in the machine's units, by parameter; none where the mass is not known."""
        known = law_strengths(self.model)
        return {name: known[key] for name in effect.parameters if (key := f"{effect.law}.{name}") in known}

    def parameter_shift(self) -> dict[str, dict[str, float | None]]:
        """How far each parameter had been bent by what was missing; ``std`` is the mended model's."""
        after = self.model.parameters()
        return {
            name: {"before": old.value, "after": after[name].value, "std": after[name].std}
            for name, old in self.before.parameters().items()
            if name in after
        }

    def as_json(self) -> dict[str, Any]:
        """The diagnosis file, ``dashpot-diagnosis/1``."""
        return {
            "format": "dashpot-diagnosis/1",
            "verdict": self.verdict,
            "sentence": self.sentence,
            "effects": [
                {
                    "effect": e.effect,
                    "law": e.law,
                    "path": e.path,
                    "parameters": {
                        name: {"value": p.value, "std": p.std, "unit": p.unit} for name, p in e.parameters.items()
                    },
                    "machine": {
                        name: {"value": p.value, "std": p.std, "unit": p.unit} for name, p in self.of_machine(e).items()
                    },
                    "indistinguishable_from": list(e.indistinguishable_from),
                    "separated_by": e.separated_by,
                    "odds": _number(min(e.odds, SURE)),
                    "probability": _number(e.probability),
                    "share": _number(e.share),
                }
                for e in self.effects
            ],
            "location": None if self.location is None else _location(self.location),
            "fit": {
                key: [
                    {
                        "file": r.file,
                        "nrmse_before": _number(r.nrmse_before),
                        "nrmse_after": _number(r.nrmse_after),
                        "noise_floor": _number(r.noise_floor),
                    }
                    for r in self.records
                    if r.holdout == held
                ]
                for key, held in (("train", False), ("holdout", True))
            },
            "parameter_shift": self.parameter_shift(),
            "formulas": [form.as_json() for form in self.forms],
            "nearest_laws": [nearest_as_json(law, self.model) for law in self.nearest],
            "considered": [
                {
                    "effect": c.effect,
                    "holdout_nrmse": _number(c.holdout_nrmse),
                    "delta_bic": _number(c.delta_bic),
                    "why_not": c.why_not,
                }
                for c in self.considered
            ],
            "next_experiment": self.experiment.sentence if self.experiment else "",
            "remainder": self.remainder,
            "chain": [
                {"what": c.what, "file": c.file, "value": _number(c.value), "unit": c.unit, "sentence": c.sentence}
                for c in self.chain
            ],
            "notes": list(self.notes),
            "work": None if self.work is None else self.work.as_json(),
        }


def _location(location: Location) -> dict[str, Any]:
    return {
        "path": location.path,
        "statement": location.statement,
        "displacement": list(location.displacement),
        "velocity": list(location.velocity),
        "amplitude": list(location.amplitude),
        "frequency_hz": list(location.frequency_hz),
        "time_s": list(location.time_s),
        "recordings": list(location.recordings),
        "harmonics": {str(order): share for order, share in location.harmonics.items()},
        "depends_on": None if location.depends_on is None else location.depends_on.as_json(),
    }


def _number(value: float | None) -> float | None:
    """JSON has no infinity and no NaN."""
    return value if value is not None and math.isfinite(value) else None
