"""The work of each command once: what is read goes to the fit, and what it gives to files.

The command line, a fleet's entries and the calls of Python translate their arguments into these functions, and show
what they return. Nothing here knows the objects of ``face.model``.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from ..errors import BadInput
from ..files.arguments import text_of
from ..recording.prescribed import refuse_channels
from .figures import FIGURES, beside, write_figures

if TYPE_CHECKING:
    from ..diagnose.result import Diagnosis
    from ..identify.hilbert.hilbert_result import HilbertAnalysis
    from ..identify.identification import Identification
    from ..model import Oscillator
    from ..model.element import Element
    from ..recording import Recording
    from ..report.blocks import Page
    from ..verify.verification import Verification

Say = Callable[[str], None]

#: The environment variable that says how long a diagnosis may take where nobody else does, and what it then may, s.
SECONDS, USUAL_SECONDS = "DASHPOT_SECONDS", 60.0

#: What is worked at when a result is there and its files are not.
WRITING = "drawing the page and writing the files"


def silent(_: str) -> None:
    """Say nothing."""


def seconds_allowed(asked: float | None) -> float:
    """What a diagnosis may take, s: as asked or, where nothing was, as the environment says, or a minute.

    Raises BadInput where the environment says no such number.
    """
    said = os.environ.get(SECONDS, "").strip()
    if asked is not None or not said:
        return USUAL_SECONDS if asked is None else asked
    try:
        seconds = float(said)
    except ValueError:
        seconds = math.nan
    if not seconds > 0.0:
        raise BadInput(f"the environment variable {SECONDS} is {said!r}; set it to a number of seconds, or to inf")
    return seconds


def read_all(files: tuple[Path, ...], options: dict[str, Any], say: Say) -> list[Recording]:
    """The recordings, all of a file that holds several, each note on them said."""
    from ..recording import recordings_of

    recordings = recordings_of(files, **options)
    for recording in recordings:
        for note in recording.notes:
            say(f"note: {note}")
    return recordings


def prescribed_beside(files: Sequence[Path], given: str | None) -> str | None:
    """The column of a motion that was imposed: as given or, where nothing is, as a file beside the recordings says."""
    from ..recording.beside import prescribed_beside as named_beside
    from ..recording.read import place_of

    return next((str(c) for file in files if (c := named_beside(place_of(file)[0], given)) is not None), None)


def identified(
    read: Callable[[], Sequence[Recording]],
    *,
    name: str | None = None,
    otherwise: str | None = None,
    laws: Sequence[str] = (),
    fixed: Mapping[str, float | str] | None = None,
    mass: float | str | None = None,
    start: Oscillator | Element | Path | None = None,
    mode: str | None = None,
    faults: bool = False,
    every: bool = False,
    notes: Say = silent,
    progress: Say = silent,
) -> Identification:
    """Identify a model from recordings; for arguments and errors see ``commands.identify``.

    Args:
        read: gives the recordings of one rig; called when all other arguments are known to be right.
        otherwise: name of the rig where neither ``name`` nor a file beside the recordings says one.
        notes: called with what was chosen before the fit, one sentence each.
    """
    from ..foresight.check import said_before
    from ..identify.identification import identify
    from ..identify.motion.modes import mode_beside
    from ..identify.of_base import of_base
    from ..model import Response
    from ..model.element import Element
    from ..model.element_file import is_element, load_element
    from ..model.file import check_name, load, text_at
    from ..model.known_values import known_values
    from ..model.library import find
    from ..model.limits import checked_value
    from ..model.quantity import plain, said
    from ..prescribed.looks_imposed import looks_imposed

    stated = {**(fixed or {}), **({} if mass is None else {"mass": mass})}
    for key, value in (*(fixed or {}).items(), *stated.items()):
        text_of(key, "the name of a parameter")
        if isinstance(value, str):
            said(value, f"the fixed {key}")
        else:
            checked_value(key, value)
    if mass is not None and not math.isclose(
        plain(held := (fixed or {}).get("mass", mass), "mass"), plain(mass, "mass")
    ):
        raise BadInput(f"the mass is fixed at {held} and given as {mass} kg; give it one value")
    if name is not None:
        check_name(name)
    effects = [find(law).name for law in laws]
    if twice := sorted({law for law in effects if effects.count(law) > 1}):
        raise BadInput(f"the law {twice[0]!r} is named twice; name each law once")
    if isinstance(start, Path):
        start = load_element(start) if is_element(text_at(start)) else load(start)
    element = start if isinstance(start, Element) else None
    begin = None if isinstance(start, Element) else start
    own = set() if element is None else {term.effect for term in element.terms}
    recordings = read()
    if element is not None and element.dependences:
        from ..identify.from_element import at_channels

        element, at = at_channels(element, recordings)
        for note in at:
            notes(f"note: {note}")
        recordings = [replace(recording, channels=()) for recording in recordings]
    refuse_channels(recordings)
    _each_once(recordings)  # the modes of thirty copies take a quarter of a minute
    known = known_values(
        stated,
        [*map(find, effects), *(term.law for term in (begin.terms if begin is not None else ()))],
        Response(recordings[0].quantity, recordings[0].unit) if recordings else Response(),
        next((r.force_unit for r in recordings if r.force is not None), "N"),
    )
    alone, band, wanted = mode_beside(recordings, mode, begin, notes)

    def answer(
        given: Sequence[Recording],
        start: Oscillator | None = begin,
        kept: Mapping[str, float] = MappingProxyType({}),
        doubted: bool = True,
    ) -> Identification:
        return identify(
            given,
            name=name or rig_of(recordings) or otherwise or _stem(recordings),
            effects=[law for law in effects if law not in own],
            fixed={**kept, **known},
            start=start,
            band=band,
            wanted=wanted,
            doubted=doubted,
            faults=faults,
            every=every,
            begun=lambda given, model: said_before(given, model, tuple(known), progress),
            progress=progress,
        )

    if element is not None:
        from ..identify.from_element import identify_from

        moved, of_element = any(recording.rides for recording in alone), known.get("mass")
        if moved:
            known.pop("mass", None)  # it divides the element's forces; what drives the rig is per unit mass
        found = identify_from(element, alone, partial(answer, alone), mass=of_element, freed=own.intersection(effects))
        return replace(found, oscillator=replace(found.oscillator, mass=None)) if moved else found
    found = answer(alone)
    if any(recording.rides for recording in recordings):
        return of_base(found, answer)
    note = None if any(recording.base for recording in recordings) else looks_imposed(found)
    return found if note is None else replace(found, notes=(note, *found.notes))


def _each_once(recordings: Sequence[Recording]) -> None:
    """Raises BadInput where a recording is there twice, whole or in part, before anything is computed of it."""
    from ..recording.checks import overlapping

    for problem in overlapping(recordings):
        raise BadInput(problem.sentence)


def rig_of(recordings: Sequence[Recording]) -> str:
    """The name that a file beside recordings gives their rig; "" where none does."""
    return next((recording.rig for recording in recordings if recording.rig), "")


def _stem(recordings: Sequence[Recording]) -> str:
    """A rig's name of its first recording's: without folder and suffixes."""
    name = recordings[0].name if recordings else ""
    return Path(name.partition("#")[0]).name.partition(".")[0] or "oscillator"


def write_identification(
    found: Identification,
    model: Path,
    report: Path | None = None,
    figures: Sequence[str] = (),
    typed: Sequence[Path] = (),
) -> list[Path]:
    """Write the model file, the page where a place is given for it, and the pictures in ``figures``' kinds, or none.

    Args:
        found: the identification.
        model: file to write, as a user typed it, which is how the page's commands have it.
        report: page to write.
        figures: kinds of pictures.
        typed: the recordings' files likewise; left out, the page has their names.

    Returns:
        The paths of the pictures, in a folder beside the model. Raises BadInput.
    """
    from ..files.writing import together, write
    from ..model.file import save

    drawn: list[Path] = []
    with together():
        if report is not None or figures:
            from ..report.page import identification_page

            page = identification_page(found, files=(str(model),), typed=tuple(map(str, typed)))
            if report is not None:
                write(report, page.html)
            drawn = write_figures(page, beside(model), figures)
        save(found.oscillator, model)
    return drawn


def diagnosed(
    oscillator: Oscillator,
    training: Sequence[Recording],
    held: Sequence[Recording],
    *,
    mode: str | None = None,
    notes: Say = silent,
    progress: Callable[[str, float], None] = lambda _what, _part: None,
    seconds: float = math.inf,
) -> tuple[Diagnosis, bytes | None]:
    """Find the physics that a model lacks; for arguments and errors see ``commands.diagnose``.

    Args:
        training: recordings to fit to.
        held: recordings to judge by.
        notes: called with what was chosen before the fit, one sentence each.

    Returns:
        What was found, and the mended model as an FMU; None where nothing was mended or nothing could be compiled.
    """
    from ..diagnose import diagnose
    from ..diagnose.files import FMU
    from ..identify.motion.modes import in_band_of, in_the_same_band, mode_alone
    from ..identify.of_base import taking_part
    from ..model.parameter import Parameter

    refuse_channels([*training, *held])
    _each_once([*training, *held])
    mass = oscillator.mass
    whole = any(r.rides for r in (*training, *held)) and (mass is None or not oscillator.takes_acceleration)
    if whole:
        oscillator = replace(oscillator, mass=Parameter(1.0, None, "1"))
    elif mass is not None:
        training, held = taking_part(training), taking_part(held)
    alone, band = mode_alone(training, mode, oscillator, notes)
    with TemporaryDirectory() as scratch:
        artefact = Path(scratch) / FMU
        others = in_the_same_band(held, band)
        found = diagnose(oscillator, alone, others, fmu=artefact, progress=progress, seconds=seconds)
        fmu = artefact.read_bytes() if artefact.exists() else None
    model = in_band_of(found.model, band)
    return replace(found, model=replace(model, mass=mass) if whole else model), fmu


def page_of_diagnosis(found: Diagnosis, fmu: bytes | None) -> Page:
    """The page of a diagnosis, with links to the files that stand beside it."""
    from ..diagnose.files import DIAGNOSIS, EXPERIMENT, FMU, MODEL, experiment_csv
    from ..report.diagnosis_page import diagnosis_page

    there = {FMU: fmu, EXPERIMENT: experiment_csv(found.experiment)}
    return diagnosis_page(found, files=(DIAGNOSIS, MODEL, *(name for name, content in there.items() if content)))


def write_diagnosis(folder: Path, found: Diagnosis, fmu: bytes | None, figures: Sequence[str] = ()) -> list[Path]:
    """Write a diagnosis, its page, pictures, model and FMU into a folder, all or none; returns the paths.

    ``figures`` are the kinds of files that each picture is drawn as. Raises BadInput.
    """
    from ..diagnose.files import write_folder
    from ..files.writing import together

    page = page_of_diagnosis(found, fmu)
    with together():
        return [*write_folder(folder, found, page.html, fmu), *write_figures(page, folder / FIGURES, figures)]


def analysed(recordings: Sequence[Recording], mode: str | None) -> tuple[HilbertAnalysis, list[Recording]]:
    """FREEVIB and FORCEVIB of one mode of recordings, and what was evaluated; raises BadInput where nothing can be."""
    from ..identify import hilbert_analysis
    from ..identify.motion.modes import mode_by_itself
    from ..recording.prescribed import refuse_prescribed

    refuse_prescribed(recordings)
    notes: list[str] = []
    alone, band = mode_by_itself(recordings, mode, notes.append)
    chosen = [note.removeprefix("note: ") for note in notes]
    return hilbert_analysis(alone).of_one_mode(chosen, band is not None), alone


def exported(
    oscillator: Oscillator,
    outputs: Sequence[Path],
    *,
    draws: int | None = None,
    notes: Say = silent,
    **options: Any,
) -> tuple[Path, ...]:
    """Write a model in the form of each output's suffix, all or none; returns all files written.

    ``options`` and errors are those of ``dashpot.export.export``. ``notes`` is called with what an SSP does not hold.
    """
    from ..export import export
    from ..export.ssp import note
    from ..files.writing import together

    written: list[Path] = []
    with together():
        for output in outputs:
            if output.suffix == ".ssp" and (remark := note(oscillator, draws)):
                notes(f"note: {remark}")
            written += export(oscillator, output, draws=draws, **options)
    return tuple(written)


def write_verification(
    found: Verification, data: Path | None, report: Path | None, figures: Sequence[str] = ()
) -> list[Path]:
    """Write what a verification says as JSON and as a page, where places are given, with the page's pictures as files.

    Returns:
        The paths of the pictures. Raises BadInput.
    """
    from ..files.writing import together, write

    with together():
        if data is not None:
            write(data, json.dumps(found.as_json(), indent=2, allow_nan=False) + "\n")
        place = report or data
        if place is not None and (report is not None or figures):
            from ..report.verification_page import verification_page

            page = verification_page(found)
            if report is not None:
                write(report, page.html)
            return write_figures(page, beside(place), figures)
    return []
