"""A rig whose damper, seal or spring was measured by itself: the element's laws go into the model, over its mass.

An element has forces in newtons, an oscillator forces per unit mass. Where the mass is identified too, the laws are
divided by what it comes out as, again until that no longer moves: what a force tells of the mass and what the element
tells of the force settle each other in two or three rounds.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..errors import BadInput
from ..model import Oscillator
from ..model.element import INERTIA, Element
from ..recording.recording import WHOLE, Recording
from .identification import Identification
from .signals.registry import budget
from .start.start import estimated, hilbert_start

_ROUNDS = budget(4, "fits", why="after which the mass has moved by less than its error")
#: Members that an oscillator has too.
_SHARED = ("cubic", "preload", "viscous", "dry")


def identify_from(
    element: Element,
    recordings: Sequence[Recording],
    answer: Callable[[Oscillator, Mapping[str, float], bool], Identification],
    *,
    mass: float | None = None,
    freed: Collection[str] = (),
) -> Identification:
    """Identify a rig with the laws of an element that was measured by itself.

    Args:
        element: its further laws keep their values, and its members are where the rig's begin.
        recordings: of the rig.
        answer: identifies from a start, parameters keeping values; the last is ``doubted``.
        mass: kg, where it is known.
        freed: names of laws of the element that are identified too, from its values.

    Raises:
        BadInput: where the units are not the rig's, or nothing tells the mass.
    """
    estimate = estimated(hilbert_start(recordings), recordings, element.name)
    _check_units(element, estimate, recordings)
    divisor = mass if mass is not None else _mass_of(estimate, recordings, element)
    found, settled = None, mass is not None
    for _ in range(_ROUNDS):
        if settled:
            break
        found = answer(start_of(element, estimate, divisor), kept(element, divisor, freed), False)
        identified = found.oscillator.mass
        if identified is None or identified.std is None:
            break
        settled = abs(identified.value - divisor) <= identified.std
        divisor = identified.value
        estimate = found.oscillator
    final = answer(start_of(element, estimate, divisor), kept(element, divisor, freed), True)
    return replace(final, notes=(*_notes(element, divisor, freed, final.oscillator), *final.notes))


def at_channels(element: Element, recordings: Sequence[Recording]) -> tuple[Element, list[str]]:
    """An element where the channels of a rig's recordings are, or its own references; with what is to be said."""
    values, said = {}, []
    for name, one in element.channels.items():
        there = [channel for r in recordings for channel in r.channels if channel.name == name]
        if any(channel.unit != one.unit for channel in there):
            raise BadInput(f"the channel {name} is in {there[0].unit}, and {element.name} has it in {one.unit}")
        known = np.concatenate([np.atleast_1d(np.asarray(channel.values, float)) for channel in there] or [np.zeros(0)])
        if not known.size:
            said.append(
                f"{element.name} depends on the {name}, and is taken at {one.reference:.4g} {one.unit}, where it is "
                f"stated; --channel {name}=NUMBER takes it elsewhere"
            )
            continue
        values[name] = float(np.mean(known))
        span = "" if np.ptp(known) == 0.0 else f", the mean of {np.min(known):.4g} to {np.max(known):.4g}"
        said.append(f"{element.name} is taken at a {name} of {values[name]:.4g} {one.unit}{span}")
        outside = one.beyond(float(np.min(known)), float(np.max(known)))
        said += [outside] if outside else []
    return element.at(values), said


def start_of(element: Element, estimate: Oscillator, mass: float) -> Oscillator:
    """The rig as it is estimated with the element's laws in it, and with its members where the element has some.

    What an estimate holds of the laws already goes on from there.
    """
    values = {name: value for name, value in estimate.values().items() if "." not in name}
    members = element.values()
    values |= {name: members[name] / mass for name in _SHARED if members[name]}
    if estimate.mass is None:
        values["mass"] = mass
    started = estimate.values()
    laws = [term.law for term in element.terms]
    terms = {name: started.get(name, value) for name, value in _terms(element, mass).items()}
    return Oscillator.from_values(
        values | terms, name=estimate.name, response=estimate.response, force_unit=estimate.force_unit, laws=laws
    )


def kept(element: Element, mass: float, freed: Collection[str]) -> dict[str, float]:
    """Parameters of the element's laws by name, per unit mass, but for those that are freed."""
    return {n: value for n, value in _terms(element, mass).items() if n.rpartition(".")[0] not in freed}


def _terms(element: Element, mass: float) -> dict[str, float]:
    """Parameters of the element's laws by name: strengths over the mass, all others as they are."""
    return {
        f"{term.effect}.{p.name}": term.parameters[p.name].value / (mass if p.strength else 1.0)
        for term in element.terms
        for p in term.law.parameters
    }


def _check_units(element: Element, estimate: Oscillator, recordings: Sequence[Recording]) -> None:
    length = estimate.response.displacement_unit
    if element.unit != length:
        raise BadInput(
            f"{recordings[0].name}: its displacement is in {length}, and {element.name} was measured in "
            f"{element.unit}; give both in one unit"
        )
    forced = [r for r in recordings if r.force is not None and not r.rides]  # what a base does is no force
    if forced and forced[0].force_unit != element.force_unit:
        raise BadInput(
            f"{forced[0].name}: its force is in {forced[0].force_unit}, and {element.name} was measured in "
            f"{element.force_unit}; give both in one unit"
        )


def _mass_of(estimate: Oscillator, recordings: Sequence[Recording], element: Element) -> float:
    """The mass that a force tells; raises BadInput where there is none."""
    if all(recording.base == WHOLE for recording in recordings):
        why = "the base alone drives the rig, which does not tell its mass"
    elif estimate.mass is None:
        why = "nothing but free decays was recorded, which do not tell the mass"
    else:
        return estimate.mass.value
    raise BadInput(f"{why}, by which the forces of {element.name} are divided; give it with --mass")


def _notes(element: Element, mass: float, freed: Collection[str], found: Oscillator) -> list[str]:
    """What was made of the element, in sentences."""
    members = element.values()
    begun = [name for name in _SHARED if members[name]]
    held = [term.effect for term in element.terms if term.effect not in freed]
    loose = [term.effect for term in element.terms if term.effect in freed]
    notes = []
    if held:
        keeps = "keeps its values" if len(held) == 1 else "keep their values"
        frees = " ".join(f"--with {name}" for name in held)
        notes.append(
            f"{' and '.join(held)} of {element.name} {keeps}, forces divided by {mass:.4g} kg ({frees} frees "
            f"{'it' if len(held) == 1 else 'them'})"
        )
    if loose:
        notes.append(f"{' and '.join(loose)} of {element.name} began at the element's values, divided by {mass:.4g} kg")
    if begun:
        notes.append(
            f"{', '.join(begun)} began at what {element.name} has over {mass:.4g} kg, and are those of the whole rig"
        )
    left = [name for name in (INERTIA, "stiffness", "load") if members[name]]
    if left:
        notes.append(
            f"{', '.join(left)} of {element.name} {'is' if len(left) == 1 else 'are'} not taken over: the rig's mass, "
            "frequency and zero are its own"
        )
    reach, moved = element.amplitude, found.amplitude
    if element.terms and reach is not None and moved is not None and moved.max > reach.max:
        notes.append(
            f"the rig moves as far as {moved.max:.4g} {moved.unit}, and {element.name} was measured to {reach.max:.4g} "
            f"{reach.unit}: beyond that its laws are a guess"
        )
    return notes
