"""Structures next to a fitted one: with one law less, with a shape free, with laws that are learnt."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ...identify.problem.data import Data
from ...identify.problem.structure import Fitted, shapes_of, without_states
from ...identify.start.measured_motion import probes
from ...model import Oscillator
from ...model.law import Law
from ...model.laws.free_curves import heights
from ...model.library import find
from ...model.terms import with_term, without_term
from .candidate import Candidate, key
from .race import PATIENCE, Entry, Start
from .starts import by_motion, generalised, without, without_anew


def kept(fitted: Fitted, model: Oscillator) -> tuple[str, ...]:
    """What keeps its value in a neighbour of a fitted model: what it kept there, and the shape of a new law."""
    own = fitted.model.parameters()
    fixed = {name for name in own if name not in fitted.free}
    new = {name for name in shapes_of(model) if name not in own}
    return tuple(name for name in model.parameters() if name in fixed or name in new)


def dropped(leader: Candidate, data: Data, names: Sequence[str], *, anew: bool = False) -> list[Entry]:
    """The leader with one law less, each of some; ``anew``: as a fit finds it that knows nothing."""
    assert leader.fit is not None
    begun = without_anew if anew else without
    return [
        Entry(
            key([law for law in leader.laws if law != name]),
            model,
            initial,
            leader.fit.offsets,
            kept(leader.fit, model),
            patience=PATIENCE,
        )
        for name in names
        for model, initial in begun(leader.fit, data, name)
    ]


def entered_again(known: Sequence[Candidate], data: Data) -> list[Entry]:
    """Fitted structures on recordings that are almost the same, begun as they were where there are as many segments.

    A state that no sensor shows, as a phase, is not found again from nothing.
    """
    fits = [(one.laws, one.fit) for one in known if one.fit is not None]
    return [
        Entry(laws, fit.model, fit.initial if len(fit.initial) == len(data.segments) else None) for laws, fit in fits
    ]


def more_general(leader: Candidate) -> list[Entry]:
    """The leader with one law exchanged for that of which it is a case."""
    assert leader.fit is not None
    return [
        Entry(
            key([general if law == name else law for law in leader.laws]),
            wider.model,
            wider.initial,
            wider.offsets,
            patience=PATIENCE,
        )
        for name, general, wider in generalised(leader.fit, leader.laws)
    ]


def finer(leader: Candidate) -> list[Entry]:
    """The leader with one learnt curve exchanged for that with knots between, where it is the same."""
    assert leader.fit is not None
    fit, entries = leader.fit, []
    for name in leader.laws:
        if (other := find(name).finer) is None:
            continue
        (old,) = [term for term in fit.model.terms if term.effect == name]
        own = {p: q.value for p, q in old.parameters.items()}
        law = find(other)
        places = [p.name for p in law.parameters if p.strength]
        values = own | dict(zip(places, heights(own), strict=True))
        model = with_term(without_term(fit.model, name), other, {p.name: values[p.name] for p in law.parameters})
        fixed = tuple(p for p in model.parameters() if p not in fit.free and p.partition(".")[0] != other)
        scales = tuple(f"{other}.{p.name}" for p in law.parameters if p.scale)
        laws = key([other if one == name else one for one in leader.laws])
        entries.append(Entry(laws, model, fit.initial, fit.offsets, (*fixed, *scales), patience=PATIENCE))
    return entries


def with_shapes(start: Start) -> Entry | None:
    """A start with the shapes of its laws free too; None where there are none that it keeps."""
    fixed = [name for name in shapes_of(start.model) if name not in start.structure.free]
    if not fixed:
        return None
    others = [name for name in start.model.parameters() if name not in start.structure.free and name not in fixed]
    return Entry(start.laws, start.model, start.fitted.initial, start.fitted.offsets, others)


def each_learnt(leader: Candidate, laws: Sequence[Law], data: Data) -> list[Entry]:
    """The leader with each learnt spring and damping; where none with a cause leads, with both; maps of its paths."""
    smooth = [law for law in laws if _is_smooth(law)]
    together = [] if leader.laws or not smooth else [tuple(law for law in smooth if law.effect != "free/surface")]
    entries = [with_learnt(leader, put, data, PATIENCE * len(put)) for put in (*zip(smooth), *together)]
    return entries + [entry for law in laws if _of_its_path(leader, law) for entry in _in_place(leader, law, data)]


def asked_by_motion(leader: Candidate, law: Law) -> bool:
    """Whether a learnt law is put beside the leader only where the measured motion speaks for it."""
    return not _is_smooth(law) and not _of_its_path(leader, law)


def _is_smooth(law: Law) -> bool:
    return law.path in ("restoring", "dissipation")


def _of_its_path(leader: Candidate, law: Law) -> list[str]:
    """What the leader has on the path of a learnt map, which holds that within it: beside it neither is told."""
    known = {name: find(name) for name in leader.laws}
    same = [name for name, one in known.items() if (one.drive and law.drive) or (one.record and law.record)]
    return [name for name in same if not known[name].lags]


def _in_place(leader: Candidate, law: Law, data: Data) -> list[Entry]:
    """The leader with a learnt map in the place of what it has on that path, where the measured motion puts it."""
    assert leader.fit is not None
    smaller, dropped_laws = leader.fit, _of_its_path(leader, law)
    for name in dropped_laws:
        less = without_term(smaller.model, name)
        smaller = replace(smaller, model=less, initial=without_states(smaller, name))
    laws = key([name for name in leader.laws if name not in dropped_laws] + [law.name])
    return [
        Entry(laws, one.model, one.initial, one.offsets, kept(leader.fit, one.model), patience=PATIENCE)
        for one in by_motion(smaller, data, [law])
    ]


def with_learnt(beside: Candidate, laws: Sequence[Law], data: Data, patience: int) -> Entry:
    """A fitted structure with laws that are learnt, at nothing: what they are linear in, the first step finds."""
    assert beside.fit is not None
    fit, model = beside.fit, beside.fit.model
    for law in laws:
        model = with_term(model, law.name, probes(law, data.scales)[0])
    structure = key((*beside.laws, *(law.name for law in laws)))
    return Entry(structure, model, fit.initial, fit.offsets, kept(fit, model), patience=patience, adds=True)
