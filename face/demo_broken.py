"""The built-in rig, broken by a law of the library, and whether the law is named: ``demo --break LAW``."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import BadInput
from ..files.writing import check_ours, together, writable, write
from .workflow import Say, silent

if TYPE_CHECKING:
    from ..diagnose.result import Diagnosis, Effect
    from ..examples.broken import Record
    from ..model.law import Law

_NAME, _MODEL, _DIAGNOSIS = "broken-stand", "rig.yaml", "diagnosis"


def run(folder: Path, law: str, say: Say, stage: Say = silent) -> bool:
    """Break the rig, record it, identify and diagnose it as a user would; returns whether the law is named.

    Args:
        folder: where recordings, model and diagnosis go; made where it does not exist.
        law: its name in the library, which Eq. 17 does not have already.
        say: called with one line per step.
        stage: called with what is worked at from now on, more often than ``say``.

    Raises:
        BadInput: there is no such law, or the folder cannot be written or holds recordings of somebody else.
        ToolchainMissing: where there is no C compiler.
    """
    from ..diagnose.files import check_folder
    from ..examples.broken import HELD_OUT, TRAINING, sizes
    from ..model.effect_words import phrase_of
    from ..model.file import save
    from ..recording import read
    from .workflow import WRITING, diagnosed, identified, seconds_allowed, write_diagnosis

    began = time.perf_counter()

    def step(text: str) -> None:
        say(f"[{time.perf_counter() - began:5.1f} s] {text}")
        stage(text)

    chosen = breaking(law)
    paths = {name: folder / f"{name}.csv.gz" for name in (*TRAINING, *HELD_OUT)}
    model = folder / _MODEL
    check_ours(model, f"name: {_NAME}".encode(), "a broken demo")
    if not model.exists() and (strange := [path for path in paths.values() if path.exists()]):
        raise BadInput(f"{strange[0]}: is there and was not made by a demo; choose another folder")
    for place in (*paths.values(), model):
        writable(place)
    check_folder(folder / _DIAGNOSIS)

    independent = _is_independent(chosen)
    step(f"the paper's stand with {phrase_of(chosen)}")
    if independent:
        step(f"by an integrator that shares no code with dashpot: {_words(sizes(chosen.name))}, SI, per unit mass")
        made = _by_the_concealed_rigs(chosen)
    else:
        step(f"by dashpot's own engine, for the independent integrator has no such law: {_words(_shown_sizes(chosen))}")
        made = _by_the_engine(chosen)
    with together():
        for record in made:
            write(paths[record.name], _as_csv(record))
    train, held = ([read(paths[name]) for name in names] for names in (TRAINING, HELD_OUT))
    found = identified(lambda: train, name=_NAME, notes=silent, progress=step)
    save(found.oscillator, model)
    step("which physics does it lack?")
    how = {"progress": lambda what, _part: stage(what), "seconds": seconds_allowed(None)}
    diagnosis, fmu = diagnosed(found.oscillator, train, held, **how)
    stage(WRITING)
    write_diagnosis(folder / _DIAGNOSIS, diagnosis, fmu)
    step(diagnosis.sentence)
    for effect in diagnosis.effects:
        for line in _sizes_found(diagnosis, effect):
            say(f"          {line}")
    named, sentence = _judged(chosen, diagnosis)
    step(sentence)
    return named


def next_lines(folder: Path) -> str:
    """What to open and to type after a broken demo."""
    from ..examples.broken import HELD_OUT, TRAINING

    files, held = (" ".join(f"{name}.csv.gz" for name in names) for names in (TRAINING, HELD_OUT))
    return (
        f"Open {folder / _DIAGNOSIS / 'report.html'}. The same by hand, in {folder}:\n"
        f"dashpot identify {files} -o mine.yaml\n"
        f"dashpot diagnose mine.yaml {files} --holdout {held} -o mine"
    )


def breaking(name: str) -> Law:
    """The law that the rig is to be broken by; raises BadInput where there is none, or Eq. 17 has it."""
    from ..model.law import Law
    from ..model.laws import BASE, LIBRARY
    from ..model.library import find

    if name in (law.name for law in BASE):
        raise BadInput(f"the law {name!r} is one of Eq. 17, which the stand has already; break it with another")
    law = find(name)
    if not isinstance(law, Law) or law.name.startswith("free/") or law.name.startswith("further-mode"):
        named = ", ".join(other for other in LIBRARY if not other.startswith("free/"))
        raise BadInput(f"the law {name!r} is no physics to break a rig with; take one of {named}")
    return law


def _is_independent(law: Law) -> bool:
    from ..examples.broken import can_break
    from ..model.laws import LIBRARY

    return law.name in LIBRARY and can_break(law.name)


def _by_the_concealed_rigs(law: Law) -> Sequence[Record]:
    from ..errors import ToolchainMissing
    from ..examples.broken import records

    try:
        return records(law.name)
    except RuntimeError as problem:
        raise ToolchainMissing(str(problem)) from problem


def _shown_sizes(law: Law) -> Mapping[str, float]:
    """Sizes of a law at which it shows, by the names of a model."""
    from ..report.law_figure import size_that_shows

    return {f"{law.name}.{p.name}": size_that_shows(law, p) for p in law.parameters}


def _by_the_engine(law: Law) -> Sequence[Record]:
    """The same recordings by the product's own engine."""
    from ..examples.broken import AMPLITUDE, FS, Record, records, with_noise
    from ..examples.truth import TRUTH
    from ..model import Oscillator
    from .model import Model

    model = Model(Oscillator.from_values({**TRUTH, **_shown_sizes(law)}, laws=(law,)))
    made = []
    for record in records(noise=False):
        if record.force is None:
            seconds = record.shown.size / FS
            shown = model.simulate(initial=(AMPLITUDE, 0.0), seconds=seconds, fs=FS).response
        else:
            shown = model.simulate(force=record.force, fs=FS).response
        made.append(with_noise(Record(record.name, record.force, shown)))
    return made


def _as_csv(record: Record) -> bytes:
    from ..examples.concealed.make import csv_of

    return csv_of(record.table)


def _words(sizes: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {value:.4g}" for name, value in sizes.items())


def _sizes_found(diagnosis: Diagnosis, effect: Effect) -> list[str]:
    """Each parameter of a law as the machine has it, and per unit mass, as what was hidden is stated."""
    from ..model.display import quantity_text
    from ..report.effects import size_text

    machine = diagnosis.of_machine(effect)
    lines = []
    for name, value in effect.parameters.items():
        besides = f" ({quantity_text(value)} per unit mass)" if name in machine else ""
        lines.append(f"{effect.law}.{name}  {size_text(diagnosis, effect, name)}{besides}")
    return lines


def _judged(law: Law, diagnosis: Diagnosis) -> tuple[bool, str]:
    """Whether the law is among what is named, and a sentence on it."""
    root = law.name.partition("/")[0]
    for effect in diagnosis.effects:
        if root in (effect.effect, effect.law.partition("/")[0]):
            alone = "" if not effect.indistinguishable_from else ", beside what these recordings cannot tell from it"
            return True, f"{law.name} was hidden, and is named{alone}"
        if root in (other.partition("/")[0] for other in effect.indistinguishable_from):
            return (
                True,
                f"{law.name} was hidden, and is in the group of {effect.effect}: the next experiment tells them",
            )
    named = " and ".join(effect.effect for effect in diagnosis.effects) or "nothing"
    return False, f"{law.name} was hidden, and is not named: {named} is"
