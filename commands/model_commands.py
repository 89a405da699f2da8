"""The commands that begin from a model: show, simulate, export, linearise."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from ..errors import BadInput
from ..face.workflow import read_all
from . import element_commands
from .options import FILE, with_laws, with_recordings
from .terminal import outputs_checked, print_json, say, stage


@click.command()
@click.argument("model", type=FILE)
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
@with_laws
def show(model: Path, as_json: bool) -> None:
    """Parameters with their errors, equation and validity."""
    from ..face.element import is_element_file
    from ..model.file import load
    from ..model.show import as_json as model_json
    from ..model.show import describe

    if is_element_file(model):
        element_commands.show(model, as_json=as_json)
        return
    oscillator = load(model)
    if as_json:
        print_json(model_json(oscillator))
    else:
        click.echo(describe(oscillator))


@click.command()
@click.argument("model", type=FILE)
@click.argument("recording", type=FILE)
@click.option("-o", "--output", type=FILE, required=True, help="CSV file to write (.csv or .csv.gz).")
@with_laws
@with_recordings
def simulate(model: Path, recording: Path, output: Path, **options: Any) -> None:
    """Response of a model to the force of a recording, event-exact."""
    from ..face.element import is_element_file
    from ..face.simulation import along, check_csv
    from ..model.file import load

    if is_element_file(model):
        element_commands.simulate(model, recording, output, options)
        return
    oscillator = load(model)
    check_csv(output)
    outputs_checked([output], [model, recording])
    if len(options["response"]) > 1:
        raise BadInput("simulate writes one response; name one column with --response")
    given = read_all((recording,), options, say)
    if len(given) > 1:
        raise BadInput(f"simulate writes one response, {recording} holds {len(given)} records; name {given[0].name}")
    simulation = along(oscillator, given)
    simulation.save(output)
    say(f"written: {output}")
    if simulation.beyond:
        say(f"note: {simulation.beyond}: beyond that it is an extrapolation")
    if simulation.lost is not None:
        note = f"the simulation runs away; from {simulation.lost:.4g} s on {output} holds nan"
        say(f"{model}: {note}: check units and parameters", always=True)
        sys.exit(1)


@click.command()
@click.argument("model", type=FILE)
@click.argument("outputs", nargs=-1, required=True, type=FILE)
@click.option(
    "--fmi",
    "version",
    type=click.Choice(["2", "3"]),
    default="2",
    show_default=True,
    callback=lambda _context, _option, value: int(value),
    help="Version of FMI.",
)
@click.option(
    "--backend",
    type=click.Choice(["native", "python"]),
    help="Of an FMU; default: native, in Python where no C compiler is.",
)
@click.option(
    "--platform",
    metavar="NAMES",
    help="What an FMU is compiled for: all, or some of linux64, linux-arm64, win64, darwin-x64, darwin-arm64, "
    "with commas between them; default: all that can be built here.",
)
@click.option(
    "--step", type=float, default=1e-3, show_default=True, metavar="S", help="Sample time of the CasADi step."
)
@click.option(
    "--draws", type=click.IntRange(min=0), metavar="N", help="Of an SSP: parameters drawn from their covariance; 20."
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Of the draws.")
@click.option(
    "--as",
    "form",
    type=click.Choice(["mujoco", "urdf", "hydrodyn"]),
    help="A model of that program, whatever the file's name is.",
)
@click.option(
    "--dof",
    type=click.Choice(["surge", "sway", "heave", "roll", "pitch", "yaw"]),
    help="For HydroDyn: which motion of the platform the model is of.",
)
@with_laws
def export(
    model: Path,
    outputs: tuple[Path, ...],
    platform: str | None,
    draws: int | None,
    form: str | None,
    **options: Any,
) -> None:
    """Write the model as an FMU (.fmu), CasADi functions (.casadi), plain C (.c), or FMU with uncertainty (.ssp).

    Or as text of a program: Python over any arrays (.py), a MATLAB function (.m), a Modelica model (.mo). Or as a joint
    of MuJoCo (.mjcf) or URDF (.urdf), or as damping of a platform in HydroDyn (.hydrodyn); what these cannot express is
    said.
    """
    from ..export import files
    from ..export.platforms import parse_platforms
    from ..face.element import is_element_file
    from ..face.workflow import exported
    from ..model.file import load

    if is_element_file(model):
        unusable = {
            "--as": form,
            "--dof": options["dof"],
            "--draws": draws,
            "--backend python": options["backend"] == "python",
        }
        element_commands.export(model, outputs, options["version"], platform, unusable)
        return
    oscillator = load(model)
    platforms = None if platform is None else parse_platforms(platform)
    if not 0 < options["step"] < float("inf"):
        raise BadInput(f"--step {options['step']}: the sample time must be a positive number of seconds")
    outputs_checked([file for output in outputs for file in files(output, form)], [model])
    how = {"platforms": platforms, "draws": draws, "form": form, "progress": stage, **options}
    for path in exported(oscillator, outputs, notes=say, **how):
        say(f"written: {path}")


@click.command()
@click.argument("model", type=FILE)
@click.option(
    "--amplitude", metavar="A", help="Of the motion to linearise about: 1mm, or a number in the model's unit."
)
@click.option("--frequency", metavar="HZ", help="Of that motion; default: the natural frequency at this amplitude.")
@click.option("--displacement", metavar="X", help="Of a point to linearise about, as 2mm; its force is found.")
@click.option("--force", metavar="F", help="That holds a point, as 3N; its displacement is found.")
@click.option("--step", type=float, metavar="S", help="Sample time; adds the discrete A and B, the force held.")
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
@with_laws
def linearise(model: Path, step: float | None, as_json: bool, **about: str | None) -> None:
    """A, B, C, D of the linear model about a motion (--amplitude) or about a point, the middle by default."""
    from ..model.file import load
    from ..model.linear import as_json as linear_json
    from ..model.linear import describe
    from ..model.linear import linearise as linear

    found = linear(load(model), **about)
    if as_json:
        print_json(linear_json(found, step))
    else:
        click.echo(describe(found, step))


COMMANDS = (show, simulate, export, linearise)
