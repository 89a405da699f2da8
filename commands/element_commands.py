"""What commands do where a motion was prescribed: translated and printed, for ``cli`` and ``model_commands``."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from ..errors import BadInput
from ..face.workflow import read_all
from .terminal import drawing, outputs_checked, print_json, progress_shown, say, stage


def identify(
    recordings: tuple[Path, ...],
    output: Path,
    report: Path | None,
    figures: tuple[str, ...],
    *,
    name: str | None,
    laws: tuple[str, ...],
    every: bool,
    as_json: bool,
    unusable: Mapping[str, Any],
    options: dict[str, Any],
) -> None:
    """Identify an element and write it.

    Args:
        recordings, output, report, figures, name, laws, every, as_json, options: as of ``dashpot identify``.
        unusable: options by name that an element has no use for, and what was given.
    """
    from ..face.element import as_json as element_json
    from ..face.element import described, identified_element, write_element

    for option, given in unusable.items():
        if given:
            raise BadInput(
                f"{option} is of an oscillator, and --prescribed of the law by itself; leave one of them out"
            )
    fit = identified_element(
        lambda: read_all(recordings, options, say),
        name=name,
        otherwise=output.stem,
        laws=laws,
        every=every,
        notes=say,
    )
    said = {note for recording in fit.recordings for note in recording.notes}  # while they were read
    for note in fit.notes:
        if note not in said:
            say(f"note: {note}")
    drawing()
    drawn = write_element(fit, output, report, figures)
    if as_json:
        print_json(element_json(fit.element))
    else:
        click.echo(described(fit.element))
    say(f"written: {', '.join(str(path) for path in (output, report, *drawn) if path is not None)}")
    if fit.left:
        say(f"{output}: {fit.left}; dashpot diagnose asks which law is missing", always=True)
        sys.exit(1)


def diagnose(
    model: Path,
    recordings: tuple[Path, ...],
    holdout: tuple[Path, ...],
    output: Path,
    *,
    as_json: bool,
    seconds: float,
    figures: tuple[str, ...],
    options: dict[str, Any],
) -> None:
    """Ask which laws an element lacks, and write what was found; arguments as of ``dashpot diagnose``."""
    from ..diagnose.files import DIAGNOSIS, MODEL, REPORT, check_folder
    from ..face.element import diagnosed_element, fmu_of, load_element, write_element_diagnosis
    from ..recording.channel import of_part

    check_folder(output)
    outputs_checked([output / name for name in (DIAGNOSIS, MODEL, REPORT)], [model, *recordings, *holdout])
    name = load_element(model).name
    stated, count = options.get("channels") or (), len(recordings)
    parts = [of_part(stated, *span, count + len(holdout)) for span in ((0, count), (count, None))]
    training = read_all(recordings, options | {"channels": parts[0]}, say)
    held = read_all(holdout, options | {"channels": parts[1]}, say)
    with progress_shown() as progress:
        told = diagnosed_element(training, held, name=name, progress=progress, seconds=seconds)
    drawing()
    written = write_element_diagnosis(output, told.found, fmu_of(told.found.best.element), figures)
    if as_json:
        print_json(told.as_json)
    else:
        click.echo(told.text)
    say(f"written: {', '.join(str(path) for path in written)}")
    if told.verdict == "unexplained":
        sys.exit(1)


def show(model: Path, *, as_json: bool) -> None:
    """Print an element."""
    from ..face.element import as_json as element_json
    from ..face.element import described, load_element

    element = load_element(model).element
    if as_json:
        print_json(element_json(element))
    else:
        click.echo(described(element))


def simulate(model: Path, recording: Path, output: Path, options: dict[str, Any]) -> None:
    """Write the force of an element along the motion of a recording."""
    from ..face.element import load_element
    from ..face.element_force import along_recording
    from ..face.simulation import check_csv, write_columns

    element = load_element(model).element
    check_csv(output)
    outputs_checked([output], [model, recording])
    found = along_recording(element, read_all((recording,), options, say))
    write_columns(output, found.columns)
    for note in found.notes:
        say(f"note: {note}")
    if found.left is not None:
        say(f"the force differs from the recorded one by {100 * found.left:.3g} % of its standard deviation")
    say(f"written: {output}")


def export(
    model: Path, outputs: tuple[Path, ...], version: int, platform: str | None, unusable: Mapping[str, Any]
) -> None:
    """Write an element as FMU, CasADi functions or plain C.

    Args:
        model, outputs, version, platform: as of ``dashpot export``.
        unusable: options by name that an element has no use for, and what was given.
    """
    from ..export import element_files
    from ..export.platforms import parse_platforms
    from ..face.element import exported_element, load_element

    element = load_element(model).element
    for option, given in unusable.items():
        if given:
            raise BadInput(f"{option} is of an oscillator, and {model} is a force law by itself; leave it out")
    outputs_checked([file for output in outputs for file in element_files(output)], [model])
    platforms = None if platform is None else parse_platforms(platform)
    for path in exported_element(element, outputs, version=version, platforms=platforms, progress=stage):
        say(f"written: {path}")
