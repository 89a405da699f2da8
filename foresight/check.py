"""A check before the fit: the quality of recordings, and which parameters of Eq. 17 they tell, and how well."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np

from ..errors import BadInput, printable
from ..files.spoken import spoken
from ..identify.fit.likeliest_modes import MEMBERS
from ..identify.fit.plainest import Absent, at_least, given_none, likely_absent
from ..identify.identification import belong_together, plain_models, with_fixed
from ..identify.problem.data import data_of, displacement_amplitude
from ..identify.problem.structure import typical_sizes
from ..identify.signals.registry import shown
from ..identify.start.start import estimated, hilbert_start
from ..model import Oscillator
from ..model.fit_state import percent_words, times_words
from ..model.machine_units import products
from ..model.parameter import Parameter
from ..model.physical import DAMPING_RATIO, machine
from ..model.show import columns_text, value_and_error
from ..recording.recording import WHOLE, Recording
from .advice import advised
from .information import Information, foretold, information, with_covariance
from .quality import Quality, qualities
from .told import Told

_FROM_ZERO = shown(
    2.0, "standard errors", why="below which a fit says that a parameter is not distinguishable from zero"
)
_WELL = shown(0.1, "of the value", why="a smaller error leaves two digits of it")


@dataclass(frozen=True, eq=False, repr=False)
class Check:
    """What is known before a fit.

    Attributes:
        recordings: their quality.
        parameters: of Eq. 17, and how well they are told.
        machine: the same as the machine has it: kg, N/m, N.
        left_out: names of members that a fit is expected to leave at zero.
        follows: whether Eq. 17 near its start values leaves no more than noise, so that the errors can be foretold.
        notes: one sentence each on what a user should know.
        model: Eq. 17 with the values from which a fit starts, and the errors expected.
    """

    recordings: tuple[Quality, ...]
    parameters: tuple[Told, ...]
    machine: tuple[Told, ...]
    left_out: tuple[str, ...]
    follows: bool
    notes: tuple[str, ...]
    model: Oscillator

    def __repr__(self) -> str:
        return describe(self)

    def __getitem__(self, name: str) -> Told:
        """One parameter, or quantity of the machine, by its name; raises KeyError where there is none."""
        return {told.name: told for told in (*self.machine, *self.parameters)}[name]

    def as_json(self) -> dict[str, Any]:
        """The same as plain data for ``json.dumps``: None where something is not known."""
        return {
            "format": "dashpot-check/1",
            "recordings": [{k: _finite(v) for k, v in asdict(quality).items()} for quality in self.recordings],
            "parameters": {told.name: _told_json(told) for told in self.parameters},
            "machine": {told.name: _told_json(told) for told in self.machine},
            "left_out": list(self.left_out),
            "follows": self.follows,
            "notes": list(self.notes),
        }


def check(
    recordings: Sequence[Recording],
    *,
    fixed: Mapping[str, float] = MappingProxyType({}),
    progress: Callable[[str], None] = lambda _: None,
) -> Check:
    """What recordings of one rig tell of Eq. 17, before anything is fitted by maximum likelihood.

    Args:
        recordings: of one rig.
        fixed: parameters that keep a value, by name.
        progress: called with one line a step.

    Raises:
        BadInput: where the recordings do not belong together or cannot carry a model.
    """
    belong_together(recordings)
    progress("free motion, start values by regression")
    start = hilbert_start(recordings, curves_too=False)
    model = with_fixed(estimated(start, recordings, "rig"), fixed, final=True)
    data = data_of(recordings, model)
    progress("what these recordings tell")
    others = partial(plain_models, model, start, recordings)
    whole = information(model, data, recordings, tuple(fixed), others)

    def without(zero: Oscillator, gone: Sequence[str]) -> np.ndarray:
        return information(zero, data, recordings, (*fixed, *gone)).covariance

    found = of_information(whole, recordings, without)
    return replace(found, parameters=advised(found.parameters, found.model, data)) if found.follows else found


def brief(model: Oscillator, recordings: Sequence[Recording], fixed: Sequence[str] = ()) -> str:
    """In a line, before a fit, what recordings are expected to tell; raises BadInput where that cannot be said.

    Args:
        model: with start values.
        recordings: of one rig.
        fixed: names of parameters that keep their values.
    """
    data = data_of(recordings, model)
    found = of_information(foretold(model, data, recordings, fixed), recordings)
    told = [
        f"{one.name} {percent_words(100 * one.std / abs(one.value))} %"
        for one in found.parameters
        if one.std and one.value and one.state in ("told", "poorly")
    ]
    lost = [one.name for one in found.parameters if one.state == "not told"]
    if not found.follows:
        return "the start values are not near enough to say what these recordings tell"
    expected = [f"expected errors {', '.join(told)}"] if told else []
    return "; ".join([*expected, *([f"not told: {', '.join(lost)}"] if lost else [])])


def said_before(
    recordings: Sequence[Recording], model: Oscillator, fixed: Sequence[str], say: Callable[[str], None]
) -> None:
    """Say in a line what recordings are expected to tell, before they are fitted; nothing where that is not known."""
    try:
        line = brief(model, recordings, fixed)
    except (BadInput, np.linalg.LinAlgError):  # the fit says what there is
        return
    if line:
        say(line)


def of_information(
    found: Information,
    recordings: Sequence[Recording],
    without: Callable[[Oscillator, Sequence[str]], np.ndarray] | None = None,
) -> Check:
    """The check that follows from what recordings tell.

    Args:
        found: what they tell of all parameters.
        recordings: of one rig.
        without: gives the covariance of the other parameters where some stay at zero; None takes what follows from that
            of all, which may be less.
    """
    model, names = found.model, found.names
    values = np.array([model.parameters()[name].value for name in names])
    absent = _absent(found)
    gone = () if absent is None else absent.names
    covariance = found.covariance
    known = with_covariance(model, names, covariance)
    parameters = [_told(name, p, name in gone, name not in names) for name, p in known.parameters().items()]
    if absent is not None:  # a fit leaves them at zero, and knows the others better for it
        places = [names.index(name) for name in gone]
        kept = [i for i in range(len(names)) if i not in places]
        sizes = _sizes(found)
        mean, given = given_none(values, covariance, sizes, places)
        left = [names[i] for i in kept]
        zero = model.with_parameters({name: Parameter(0.0, None, model.parameters()[name].unit) for name in gone})
        moved = {names[i]: Parameter(float(mean[i]), None, model.parameters()[names[i]].unit) for i in kept}
        plain, of_kept = zero.with_parameters(moved), given[np.ix_(kept, kept)]
        if without is not None:
            of_kept = at_least(of_kept, without(plain, gone))
        known = with_covariance(plain, left, of_kept + absent.spread)
        better = {name: p for name, p in known.parameters().items() if name in left}
        parameters = [_told(t.name, better[t.name], False, False) if t.name in better else t for t in parameters]
    if any(recording.base == WHOLE for recording in recordings):  # what drives it is per unit mass
        known, parameters = replace(known, mass=None), [told for told in parameters if told.name != "mass"]
    return Check(
        recordings=qualities(recordings, found.segments),
        parameters=tuple(_as_sure(told, found.follows) for told in parameters),
        machine=tuple(_of_machine(known, parameters, found.follows)),
        left_out=gone,
        follows=found.follows,
        notes=tuple(_notes(found, recordings, model)),
        model=known,
    )


def _absent(found: Information) -> Absent | None:
    names = list(found.names)
    values = np.array([found.model.parameters()[name].value for name in names])
    return likely_absent(names, values, found.covariance, _sizes(found))


def _sizes(found: Information) -> np.ndarray:
    """(k,) sizes at which each free parameter matters."""
    everything = tuple(found.model.parameters())
    values = np.array(list(found.model.values().values()))
    amplitude, pace = displacement_amplitude(found.segments), found.segments[0].pace
    sizes = typical_sizes(everything, values, amplitude, pace)
    return sizes[[everything.index(name) for name in found.names]]


def _of_machine(model: Oscillator, parameters: Sequence[Told], follows: bool) -> Iterator[Told]:
    """What of the machine is told; where it is that of a parameter that is not told, it is not told either."""
    state = {told.name: told.state for told in parameters}
    of = {product.name: name for name, product in products(model).items()} | {DAMPING_RATIO: "viscous"}
    for name, p in machine(model).items():
        told = _told(name, p, state.get(of.get(name, name)) == "not told", p.std is None)
        yield replace(_as_sure(told, follows), words="")


def _as_sure(told: Told, follows: bool) -> Told:
    """The same, called rough where Eq. 17 does not follow the recordings: its error is then no more than a guess."""
    return replace(told, state="rough") if not follows and told.state in ("told", "poorly") else told


def _told(name: str, parameter: Parameter, absent: bool, given: bool) -> Told:
    value, std = float(parameter.value), parameter.std
    if given:
        return Told(name, value, None, parameter.unit, "given")
    if std is None or not math.isfinite(std) or not std > 0:
        return Told(name, value, None, parameter.unit, "not told", f"{name} is not told at all")
    lost = absent or abs(value) < (_FROM_ZERO if name in MEMBERS else 1.0) * std
    state = "not told" if lost else "poorly" if std > _WELL * abs(value) else "told"
    shown_value, error = value_and_error(parameter)
    words = f"{name} is not told: {shown_value} ± {error} {parameter.unit}" if lost else ""
    return Told(name, value, float(std), parameter.unit, state, words)


def _notes(found: Information, recordings: Sequence[Recording], model: Oscillator) -> list[str]:
    notes = []
    if not found.follows:
        worst = int(np.argmax(found.over_noise))
        name = recordings[found.segments[worst].recording].name
        notes.append(
            f"Eq. 17 at its start values leaves {times_words(found.over_noise[worst])} times the noise, "
            f"{percent_words(100 * found.left[worst])} % of the motion, in {name}: either the start is not near, or "
            "the rig has physics that Eq. 17 lacks (dashpot diagnose); the errors are rough"
        )
    unused = sorted(set(range(len(recordings))) - {segment.recording for segment in found.segments})
    notes += [f"nothing in {recordings[i].name} can be used" for i in unused]
    if model.mass is None:
        notes.append("the mass is not told: no force was recorded, or none that drives it; all else is per unit mass")
    return notes


def describe(found: Check) -> str:
    """The check as text: recordings, table of parameters, what is not told, notes."""
    lines = ["Recordings", *(f"  {line}" for quality in found.recordings for line in quality.words())]
    lines += ["", "What a fit is expected to state", *columns_text([_cells(told) for told in found.parameters])]
    if found.machine:
        lines += ["", "As the machine has it", *columns_text([_cells(told) for told in found.machine])]
    said = [told.words for told in found.parameters if told.words]
    if found.left_out:
        said.append(f"a fit will leave {spoken(found.left_out)} at zero (identify --all keeps what it finds)")
    said += found.notes
    if said:
        lines += ["", "Take note", *(f"  - {sentence}" for sentence in said)]
    return printable("\n".join(lines))


def _cells(told: Told) -> tuple[str, ...]:
    value, error = value_and_error(Parameter(told.value, told.std, told.unit))
    share = "" if told.std is None or not told.value else f"({percent_words(100 * told.std / abs(told.value))} %)"
    return told.name, value, f"± {error}" if error else "", share, told.unit if told.unit != "1" else "", told.state


def _told_json(told: Told) -> dict[str, Any]:
    return {"value": _finite(told.value), "std": _finite(told.std), "unit": told.unit, "state": told.state} | (
        {"words": told.words} if told.words else {}
    )


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
