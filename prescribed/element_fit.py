"""From recordings of a prescribed motion and its force to an element, and to the law that its members lack."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..errors import BadInput
from ..files.spoken import spoken
from ..identify.fit.limits import CYCLES
from ..identify.provenance import stamp, unit_of_file
from ..identify.signals.odds import ABOVE_NOISE, SIGNIFICANT
from ..model.dependence import FORMS
from ..model.element import Element
from ..model.fit_state import percent_words, times_words
from ..model.law import Law
from ..model.left import over, share_of_motion
from ..model.library import find
from ..model.oscillator import Range
from ..recording.checks import overlapping
from ..recording.prescribed import refuse_free
from ..recording.recording import Recording
from ..simulate.imposed import force_along
from .channels import Way, spans_of
from .columns import SEARCHED
from .errors import element_of
from .fit import Fitted, Problem
from .motion import Imposed, imposed, origin_of, unit_of_motion
from .search import Found, Search
from .ways import forms_told


@dataclass(frozen=True)
class Record:
    """How one recording came out: rms of what an element leaves over the force's standard deviation, and the noise's.

    Both are of the samples that were fitted, run by the engine along the whole motion.
    """

    file: str
    nrmse: float
    noise_floor: float

    @property
    def over_noise(self) -> float:
        """Times the noise that is left."""
        return over(self.nrmse, self.noise_floor)

    @property
    def of_force(self) -> str:
        """``3.2 % of the force``."""
        return f"{percent_words(100 * self.nrmse)} % of the force"

    @property
    def of_noise(self) -> str:
        """``19 times the noise``."""
        return f"{times_words(self.over_noise)} times the noise"


@dataclass(frozen=True, eq=False)
class ElementFit:
    """An element and how it was found.

    Attributes:
        element: with standard errors, validity and provenance.
        recordings: what it was identified from.
        motions: of these.
        forces: (n,) of each, as the element makes it, its recording's own constant in it.
        records: of each.
        notes: one sentence each on what a user should know.
    """

    element: Element
    recordings: tuple[Recording, ...]
    motions: tuple[Imposed, ...]
    forces: tuple[np.ndarray, ...]
    records: tuple[Record, ...]
    notes: tuple[str, ...]

    @property
    def left(self) -> str | None:
        """A sentence on what is left where that is more than noise; else None."""
        worst = max(self.records, key=lambda record: record.over_noise)
        if worst.over_noise <= ABOVE_NOISE:
            return None
        return f"it leaves {worst.of_force} in {worst.file}, {worst.of_noise}"


def record_of(motion: Imposed, left: np.ndarray) -> Record:
    """How a motion came out of whose force (n,) is left."""
    told = motion.told
    force, share = [motion.force[told]], share_of_motion([left[told]], [motion.force[told]])
    return Record(motion.name, share, share_of_motion([np.full(int(np.sum(told)), motion.noise)], force))


@dataclass(frozen=True, eq=False)
class ElementFound:
    """What the members of Eq. 17 lack along prescribed motions.

    Attributes:
        before: the members alone.
        after: with the laws that were found; None where none was.
        found: odds, rivals and what else was tried.
        held: recordings that nothing was fitted to in the search; parts of the others where none were given.
        in_pieces: whether they are such parts.
        held_before, held_after: of each of them, as the search saw it.
    """

    before: ElementFit
    after: ElementFit | None
    found: Found
    held: tuple[str, ...]
    in_pieces: bool
    held_before: tuple[Record, ...]
    held_after: tuple[Record, ...]

    @property
    def best(self) -> ElementFit:
        """The element that is handed over."""
        return self.after or self.before


def identify_element(
    recordings: Sequence[Recording], *, name: str = "element", laws: Sequence[str] = (), every: bool = False
) -> ElementFit:
    """Identify the members of Eq. 17, with laws where asked for, from prescribed motions and their forces.

    Args:
        recordings: of one specimen; ``response`` is the motion, ``force`` what it took.
        name: of the specimen.
        laws: names of laws to be fitted beside the members, and what depends on a channel: "viscous:current", or
            "dry:pressure:power" where it is not linear.
        every: whether members stay that the recordings do not tell from none.

    Raises:
        BadInput: where the recordings do not belong together, or a law is no force.
    """
    motions = _motions(recordings)
    problem = Problem(motions, (), origin_of(motions), spans=spans_of(recordings))
    search = Search(problem, every=every)
    asked = [text for text in laws if ":" in text]
    begun = search.with_laws([_force_law(law) for law in laws if law not in asked])
    fitted = search.plainest(search.anew(search.with_ways(begun, asked)))
    return _fit_of(fitted, problem, recordings, name)


def diagnose_element(
    recordings: Sequence[Recording],
    holdout: Sequence[Recording] = (),
    *,
    name: str = "element",
    progress: Callable[[str, float], None] = lambda _what, _part: None,
    seconds: float = math.inf,
) -> ElementFound:
    """Find the laws that the members of Eq. 17 lack along prescribed motions.

    Args:
        recordings: to fit to.
        holdout: to judge by; where none are given, the last third of each recording that is long enough.
        name: of the specimen.
        progress: called with what is being done, and which part of all is done.
        seconds: after which the best that it has is taken.

    Raises:
        BadInput: where the recordings do not belong together.
    """
    until = time.monotonic() + seconds
    motions = _motions([*recordings, *holdout])
    origin, given = origin_of(motions), len(recordings)
    training, held = motions[:given], motions[given:]
    if not held:
        training, held = _in_pieces(training)
    spans = spans_of([*recordings, *holdout])
    problem = Problem(training, held, origin, SEARCHED, spans)
    found = Search(problem, progress=progress, until=until).find()
    progress("the element on every recording", 0.95)
    whole = Problem(motions, (), origin, spans=spans)
    everything = [*recordings, *holdout]
    before = _fit_of(_again(found.plain, whole), whole, everything, name)
    best = _again(found.best, whole)
    if found.dependent:
        best, found = _with_forms(best, whole, found)
    after = _fit_of(best, whole, everything, name) if found.named or found.dependent else None
    each = (found.plain.held, found.best.held)
    records = [tuple(record_of(m, left) for m, left in zip(held, rows, strict=True)) for rows in each]
    progress("done", 1.0)
    return ElementFound(before, after, found, tuple(m.name for m in held), not holdout, *records)


def _motions(recordings: Sequence[Recording]) -> tuple[Imposed, ...]:
    if not recordings:
        raise BadInput("no recording was given; name at least one file with a motion and its force")
    refuse_free(recordings)
    for problem in overlapping(recordings):
        raise BadInput(problem.sentence)
    motions = tuple(imposed(recording) for recording in recordings)
    units = {(unit_of_motion(r), r.force_unit) for r in recordings}
    if len(units) > 1:
        raise BadInput(
            f"the recordings are in different units ({', '.join(' and '.join(pair) for pair in sorted(units))}); "
            "give them in one"
        )
    return motions


def _force_law(name: str) -> Law:
    law = find(name)
    if law.force is None:
        raise BadInput(f"{name} is no force; of a prescribed motion only forces are identified")
    return law


def _in_pieces(motions: Sequence[Imposed]) -> tuple[tuple[Imposed, ...], tuple[Imposed, ...]]:
    """The first two thirds of each motion that is long enough, and its last third."""
    training, held = [], []
    for motion in motions:
        cut = 2 * motion.n // 3
        if motion.n * motion.dt * motion.pace / (2 * np.pi) < CYCLES:
            training.append(motion)
            continue
        training.append(motion.part(0, cut))
        held.append(motion.part(cut, motion.n))
    return tuple(training), tuple(held)


def _with_forms(best: Fitted, whole: Problem, found: Found) -> tuple[Fitted, Found]:
    """The best with the forms of its dependences that all recordings ask for, and what was found with those."""
    search = Search(whole)
    best, told = forms_told(whole, search.judge, whole.weighed(best), search.fitted)
    dependent = []
    for named in found.dependent:
        way, near = told[named.way]
        own = {str(Way(way.channel, way.of, how)) for how in FORMS}
        others = [name for name in named.rivals if name not in own]
        dependent.append(replace(named, way=way, rivals=(*near, *others)))
    return best, replace(found, dependent=tuple(dependent))


def _again(fitted: Fitted, problem: Problem) -> Fitted:
    """The same structure fitted to all motions."""
    made = problem.fit(fitted.shape, fitted.values)
    return fitted if made is None else made


def _fit_of(fitted: Fitted, problem: Problem, recordings: Sequence[Recording], name: str) -> ElementFit:
    """The element, run along every motion."""
    first = recordings[0]
    element = element_of(fitted, problem, name, (unit_of_motion(first), first.force_unit))
    forces, records = [], []
    for motion in problem.motions:
        force = force_along(element, motion.displacement, motion.dt, start=motion.start, channels=motion.channels)
        told = motion.told
        force += float(np.mean(motion.force[told] - force[told]))
        forces.append(force)
        records.append(record_of(motion, motion.force - force))
    files: list[Mapping[str, Any]] = [
        {"file": r.name, "sha256": r.sha256, "kind": "prescribed"}
        | unit_of_file(r)
        | {"nrmse": one.nrmse, "over_noise": one.over_noise}
        for r, one in zip(recordings, records, strict=True)
    ]
    reach = max(float(np.max(np.abs(m.displacement - element.origin))) for m in problem.motions)
    speeds = [np.abs(m.velocity[m.told]) for m in problem.motions]
    unit = element.unit
    element = replace(
        element,
        amplitude=Range(0.0, reach, unit),
        speed=Range(min(float(np.min(s)) for s in speeds), max(float(np.max(s)) for s in speeds), f"{unit}/s"),
        identified=replace(
            element.identified,
            recordings=tuple(files),
            method="least squares along the motion",
            **stamp(),
        ),
    )
    return ElementFit(
        element,
        tuple(recordings),
        problem.motions,
        tuple(forces),
        tuple(records),
        tuple(_notes(fitted, element, recordings)),
    )


def _notes(fitted: Fitted, element: Element, recordings: Sequence[Recording]) -> list[str]:
    notes = [note for recording in recordings for note in recording.notes]
    absent = [name for name in element.members if name not in (*fitted.shape.members, "load")]
    if absent:
        are, them = ("are", "them") if absent[1:] else ("is", "it")
        notes.append(f"{spoken(absent)} {are} left at zero: the recordings do not tell {them} from none (--all)")
    if element.origin:
        notes.append(
            f"displacements are counted from the middle of the stroke, {element.origin:.6g} {element.unit} as recorded"
        )
    spread = [constant - float(np.mean(fitted.constants)) for constant in fitted.constants]
    load = element.parameters()["load"]
    if load.std and max(map(abs, spread)) > SIGNIFICANT * load.std and len(spread) > 1:
        notes.append(
            f"the constant force differs between the recordings, from {min(fitted.constants):.4g} to "
            f"{max(fitted.constants):.4g} {element.force_unit}, as where a load cell is set to zero for each: "
            "load is their mean"
        )
    return notes
