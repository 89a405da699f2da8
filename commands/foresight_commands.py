"""The commands that come before a fit: check, plan, prove-on."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from ..face.workflow import read_all
from ..files.writing import write
from .options import FILE, Above, with_known_values, with_laws, with_mode, with_recordings
from .terminal import outputs_checked, print_json, say, stage


@click.command()
@click.argument("recordings", nargs=-1, required=True, type=FILE)
@with_known_values
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
@with_mode
@with_recordings
def check(
    recordings: tuple[Path, ...],
    fix: dict[str, float | str],
    mass: float | None,
    as_json: bool,
    mode: str | None,
    **options: Any,
) -> None:
    """What recordings tell of the equation and how well, before anything is fitted.

    Noise, resolution, sampling, what is used of each recording; then the standard error that a fit is expected to state
    of every parameter, from the Fisher information along the motion. Exit code 1 where the errors are rough.
    """
    from ..face.foresight import checked

    found = checked(
        lambda: read_all(recordings, options, lambda _: None),
        fixed=fix,
        mass=mass,
        mode=mode,
        notes=say,
        progress=stage,
    )
    _shown(found, as_json)
    if not found.follows:
        sys.exit(1)


def _shown(found: Any, as_json: bool) -> None:
    if as_json:
        print_json(found.as_json())
    else:
        click.echo(found)


_NOISE = (
    click.option("--noise", metavar="1um", help="Standard deviation of the sensor's noise, with its unit."),
    click.option("--force-noise", metavar="1mN", help="The same of the recorded force."),
    click.option(
        "--like",
        type=FILE,
        metavar="REC",
        multiple=True,
        help="Recording with the same sensors, whose noise is taken; several times. Default: those that the model was "
        "identified from, where they lie beside it.",
    ),
)


def _with_noise(command: Any) -> Any:
    for option in reversed(_NOISE):
        command = option(command)
    return command


@click.command()
@click.argument("model", type=FILE)
@click.option(
    "--want",
    metavar="'NAME 1%'",
    multiple=True,
    required=True,
    help="What is to be known and how well: 'cubic 1%', 'dry 0.001 m/s2', 'friction 5%'; several times.",
)
@click.option("--most-amplitude", metavar="5mm", help="How far the rig may move. Default: as far as it was identified.")
@click.option("--most-force", metavar="10N", help="Largest force. Default: what the stroke allows.")
@click.option("--most-seconds", type=Above(1e6), default=600.0, show_default=True, metavar="S", help="Longest test.")
@click.option(
    "--test",
    "tests",
    type=click.Choice(["decay", "sweep", "random", "stepped"]),
    multiple=True,
    help="Kind of test that can be made; several times. Default: all.",
)
@click.option("--at", type=Above(1e9), metavar="HZ", help="Samples a second to be recorded. Default: sixty a cycle.")
@click.option(
    "--tries", type=click.IntRange(0, 100), default=3, show_default=True, help="Simulated and identified so often."
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Of the noise in these.")
@click.option("-o", "--output", type=FILE, metavar="OUT.csv", help="CSV file for the force to play.")
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
@_with_noise
@with_laws
@with_recordings
def plan(
    model: Path,
    want: tuple[str, ...],
    like: tuple[Path, ...],
    noise: str | None,
    force_noise: str | None,
    at: float | None,
    output: Path | None,
    as_json: bool,
    **options: Any,
) -> None:
    """The test that would tell a parameter so well: release, sweep, random or stepped force, its level and length.

    Chosen by the expected information, within the limits of stroke and force, and tried by simulating and identifying.
    Exit code 1 where no test within the limits tells what is wanted.
    """
    from ..face.foresight import planned
    from ..model.file import load

    outputs_checked([] if output is None else [output], [model, *like])
    own = {
        name: options.pop(name) for name in ("most_amplitude", "most_force", "most_seconds", "tests", "tries", "seed")
    }
    found = planned(
        load(model),
        want,
        like=read_all(like, options, say) if like else (),
        beside=model.parent,
        noise=noise,
        force_noise=force_noise,
        fs=at,
        progress=stage,
        **own,
    )
    if output is not None:
        write(output, found.csv())
    _shown(found, as_json)
    if output is not None:
        say(f"written: {output}")
    if not found.passed:
        sys.exit(1)


@click.command("prove-on")
@click.argument("model", type=FILE)
@click.option("--runs", type=click.IntRange(1, 10000), metavar="N", help="How often. Default: 20, with --hide 3.")
@click.option("--most-amplitude", metavar="5mm", help="How far it is moved. Default: as far as it was identified.")
@click.option("--hide", metavar="LAW", help="A law of the model that the identification is not told of, to be named.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Of the noise.")
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
@_with_noise
@with_laws
@with_recordings
def prove_on(
    model: Path,
    runs: int | None,
    like: tuple[Path, ...],
    noise: str | None,
    force_noise: str | None,
    most_amplitude: str | None,
    hide: str | None,
    seed: int,
    as_json: bool,
    **options: Any,
) -> None:
    """One's own rig simulated with its noise, identified again, and the stated errors counted.

    A rig of Eq. 17 is simulated by an integrator that shares no code with the engine, one with further laws by the
    engine. Exit code 1 where the errors do not hold, or the hidden law is not named in more than half of the runs. A
    diagnosis of it takes as long as it needs, or what DASHPOT_SECONDS says.
    """
    from ..face.foresight import proved
    from ..model.file import load

    found = proved(
        load(model),
        like=read_all(like, options, say) if like else (),
        beside=model.parent,
        noise=noise,
        force_noise=force_noise,
        amplitude=most_amplitude,
        hide=hide,
        runs=runs,
        seed=seed,
        progress=stage,
    )
    _shown(found, as_json)
    if not found.passed:
        sys.exit(1)


COMMANDS = (check, plan, prove_on)
