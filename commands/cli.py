"""The command line: recordings in, model, FMU, CasADi functions and reports out."""

from __future__ import annotations

import os
import shlex
import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .. import __version__
from ..errors import BadInput
from ..face.workflow import read_all
from ..files.exit_codes import ended
from ..files.made_by import line_of, typed
from . import element_commands
from .command_examples import epilog
from .command_groups import GROUPS, OTHERS
from .fleet_commands import COMMANDS as FLEET_COMMANDS
from .foresight_commands import COMMANDS as FORESIGHT_COMMANDS
from .model_commands import COMMANDS
from .options import (
    FILE,
    Above,
    added_to_files,
    law_names,
    most_left,
    with_figures,
    with_known_values,
    with_laws,
    with_mode,
    with_recordings,
    with_time_limit,
)
from .setup_commands import COMMANDS as SETUP_COMMANDS
from .several_values import CommandOfSeveral, SeveralValues
from .terminal import drawing, facts_shown, outputs_checked, print_json, progress_shown, quiet, say, stage, with_quiet
from .waiting import doing, waiting_shown

if TYPE_CHECKING:
    from ..model.fit_state import MostLeft
    from ..verify.verification import Verification


class _Commands(click.Group):
    """A group that shows the whole first sentence of each command, under a heading for each kind."""

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the lists of commands, each with its sentence."""
        grouped = [name for names in GROUPS.values() for name in names]
        for title, names in {**GROUPS, OTHERS: tuple(sorted(set(self.commands) - set(grouped)))}.items():
            rows = [(name, self.commands[name].get_short_help_str(1000)) for name in names if name in self.commands]
            if rows:
                with formatter.section(title):
                    formatter.write_dl(rows, col_max=12)


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.version_option(__version__, prog_name="dashpot")
def cli() -> None:
    """Recordings of a vibrating thing in; a model you can believe, an FMU and CasADi functions you can use, out."""


@cli.command()
@click.option("-o", "--output", type=FILE, default=Path("demo"), show_default=True, help="Folder for the files.")
@click.option(
    "--break", "broken_by", metavar="LAW", shell_complete=law_names, help="Break the rig by a law; is it named?"
)
@with_laws
def demo(output: Path, broken_by: str | None) -> None:
    """The whole story on the built-in rig, in under two minutes; with --break, a rig of which the model lacks a law.

    With --break, exit code 1 says that the law was not named.
    """
    if broken_by is not None:
        from ..face import demo_broken

        named = demo_broken.run(output, broken_by, click.echo, doing)
        say(demo_broken.next_lines(output))
        if not named:
            sys.exit(1)
        return
    from ..face.demo import run

    shown = [""]

    def tell(line: str) -> None:
        shown[0] = line
        if not quiet():
            click.echo(line)

    passed = run(output, tell, doing)
    if quiet():  # the last line is the result
        click.echo(shown[0])
    else:
        click.echo(
            f"Open {output / 'report.html'}. Next, with a recording of your own: dashpot look REC.csv, then\n"
            "dashpot identify REC.csv -o rig.yaml --report rig.html"
        )
    if not passed:
        sys.exit(1)


@cli.command()
@click.option("-o", "--output", type=FILE, default=Path("paper"), show_default=True, help="Folder for the page.")
def paper(output: Path) -> None:
    """The figures of the paper, 1 and 3 to 7, remade from the built-in rig."""
    from ..face.paper import run

    run(output, stage)


@cli.command()
@click.argument("files", nargs=-1, required=True, type=FILE)
@click.option("--page", type=FILE, metavar="OUT.html", help="HTML page to write: the recordings to look at by mouse.")
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
@with_recordings
def look(files: tuple[Path, ...], page: Path | None, as_json: bool, **options: Any) -> None:
    """What would be read of files: channels, units, rates, kinds of motion, a small picture; nothing else is done.

    --page draws them to be enlarged by mouse, finger or keys: pieces that a fit takes and leaves, with the reasons;
    two cursors that show the --part to paste, and modes to click that show the --mode.
    """
    from ..face.look import described
    from ..face.look import look as seen_in
    from ..face.looked import Look

    outputs_checked([page] if page else [], files)
    seen, refused = [], []
    for place, file in enumerate(files):
        try:
            seen += seen_in(file, options, place)
        except BadInput as problem:  # the other files are shown all the same
            refused.append(str(problem))
    entries = [one.entry for one in seen]
    if page is not None and any(one.read for one in seen):
        drawing()
        Look(seen).save(page)
        say(f"written: {page}")
    if as_json:
        print_json(entries)
    elif entries:
        click.echo("\n\n".join(described(entry) for entry in entries))
    if refused:
        raise BadInput("\n".join(refused))
    if any("refused" in recording for entry in entries for recording in entry["recordings"]):
        sys.exit(2)


@cli.command()
@click.argument("recordings", nargs=-1, required=True, type=FILE)
@click.option("-o", "--output", type=FILE, required=True, help="Folder for curves (CSV), laws (JSON) and the page.")
@click.option("--json", "as_json", is_flag=True, help="Print the laws as JSON.")
@with_figures
@with_mode
@with_recordings
def hilbert(
    recordings: tuple[Path, ...],
    output: Path,
    as_json: bool,
    figures: tuple[str, ...],
    mode: str | None,
    **options: Any,
) -> None:
    """FREEVIB and FORCEVIB as results: curves over time and amplitude, laws fitted to them, each with its error.

    With --mode all every mode is evaluated by itself, each into a folder of its own.
    """
    from ..face.hilbert import FILES, run

    outputs_checked([output / name for name in FILES], recordings)
    result, words = run(read_all(recordings, options, say), mode, output, say, figures, doing)
    if as_json:
        print_json(result)
    else:
        click.echo(words)


@cli.command()
@click.argument("recordings", nargs=-1, required=True, type=FILE)
@click.option("-o", "--output", type=FILE, required=True, help="Model file to write (YAML).")
@click.option("--name", help="Name of the rig; default: the output's name.")
@click.option("--report", type=FILE, help="HTML page to write beside it.")
@click.option("--json", "as_json", is_flag=True, help="Print the model as JSON too.")
@click.option(
    "--with",
    "effects",
    metavar="LAW",
    multiple=True,
    shell_complete=law_names,
    help="Law of the library to fit beside Eq. 17; several times.",
)
@with_known_values
@click.option(
    "--add-mass",
    metavar="FILE=0.5kg",
    multiple=True,
    callback=added_to_files,
    help="Known mass that was on the rig in that recording: beside one without, it tells the mass. Several times.",
)
@click.option(
    "--add-stiffness",
    metavar="FILE=200N/m",
    multiple=True,
    callback=added_to_files,
    help="Known stiffness that stood beside the spring in that recording; as --add-mass.",
)
@click.option(
    "--from",
    "start",
    type=FILE,
    metavar="MODEL.yaml",
    help="Model to start from, with its laws; or a damper measured by itself (identify --prescribed).",
)
@click.option(
    "--faults",
    is_flag=True,
    help="Ask what the measuring chain did to a recording (gains, delays, hum, zeros, clocks) where more than noise is "
    "left and the recordings do not contradict each other too, where it is asked anyway.",
)
@click.option(
    "--all",
    "every",
    is_flag=True,
    help="Keep cubic, preload and dry friction where the recordings do not tell them from none.",
)
@click.option(
    "--max-left",
    metavar="5%|3x",
    callback=most_left,
    help="Exit code 1 where the model leaves more of a recording than that share of the motion, noise aside, or than "
    "so many times the noise, instead of 5% beside noise. It always is where the simulation does not follow (30%).",
)
@with_figures
@with_mode
@with_laws
@with_recordings
def identify(
    recordings: tuple[Path, ...],
    output: Path,
    name: str | None,
    report: Path | None,
    as_json: bool,
    effects: tuple[str, ...],
    fix: dict[str, float | str],
    mass: float | None,
    add_mass: dict[str, str],
    add_stiffness: dict[str, str],
    start: Path | None,
    mode: str | None,
    faults: bool,
    every: bool,
    max_left: MostLeft | None,
    figures: tuple[str, ...],
    **options: Any,
) -> None:
    """Identify a model from recordings: decays, bursts, sweeps, multisines, hammer blows, in any mixture.

    The model is written whatever it leaves. Exit code 1 where it leaves 5 % of a motion beside noise, or more than
    --max-left, where modes are left, or where the measuring chain has done something to a recording.
    """
    from ..export import SUFFIXES
    from ..face.added import identified_with_added
    from ..face.workflow import identified, prescribed_beside, write_identification
    from ..model.fit_state import beyond, faults_of_recordings, left_over
    from ..model.show import as_json as model_json
    from ..model.show import describe

    outputs_checked([output] if report is None else [output, report], [*recordings, *([start] if start else [])])
    if output.suffix in (*SUFFIXES, ".csv", ".html"):
        raise BadInput(
            f"{output}: identify writes a model file; name it .yaml, and make others of it with dashpot export"
        )
    if prescribed_beside(recordings, options["prescribed"]) is not None:
        unusable = {"--fix": fix, "--mass": mass, "--from": start, "--mode": mode, "--faults": faults}
        unusable |= {"--add-mass": add_mass, "--add-stiffness": add_stiffness}
        element_commands.identify(
            recordings,
            output,
            report,
            figures,
            name=name,
            laws=effects,
            every=every,
            as_json=as_json,
            unusable={**unusable, "--max-left": max_left},
            options=options,
        )
        return
    with_added = partial(identified_with_added, masses=add_mass, stiffnesses=add_stiffness)
    identification = (with_added if add_mass or add_stiffness else identified)(
        lambda: read_all(recordings, options, say),
        name=name,
        otherwise=output.stem,
        laws=effects,
        fixed=fix,
        mass=mass,
        start=start,
        mode=mode,
        faults=faults,
        every=every,
        notes=say,
        progress=stage,
    )
    for note in identification.notes:
        say(f"note: {note}")
    drawing()
    drawn = write_identification(identification, output, report, figures, recordings)
    if as_json:
        print_json(model_json(identification.oscillator))
    else:
        click.echo(describe(identification.oscillator))
    say(f"written: {', '.join(str(path) for path in (output, report, *drawn) if path is not None)}")
    again = shlex.join(map(str, [output, *recordings]))
    asks = f"dashpot diagnose {again} -o diagnosis, read as here, asks what physics is missing"
    if left_over(identification.oscillator) and not (faults or identification.faults):
        say(f"{asks}; identify --faults, what the measuring chain may have done")
    elif left_over(identification.oscillator) and not identification.faults:
        say(asks)
    for sentence in faults_of_recordings(identification.oscillator):
        say(sentence, always=True)
    if identification.useless:
        say(f"{output}: {identification.useless}", always=True)
    if identification.modes_left:
        say(f"{output}: {identification.modes_left}", always=True)
    unexplained = identification.unexplained if max_left is None else None  # whoever says how much is content with less
    if unexplained:
        say(f"{output}: {unexplained}", always=True)
    exceeded = [] if max_left is None else beyond(identification.oscillator, max_left)
    for sentence in exceeded:
        say(f"{sentence} (--max-left)", always=True)
    if any((identification.useless, identification.faults, identification.modes_left, unexplained, exceeded)):
        sys.exit(1)


@cli.command(cls=CommandOfSeveral)
@click.argument("model", type=FILE)
@click.argument("recordings", nargs=-1, required=True, type=FILE)
@click.option(
    "--holdout",
    cls=SeveralValues,
    type=FILE,
    metavar="REC...",
    help="Recordings to judge by, of another level or kind: all up to the next option; may be given several times.",
)
@click.option("-o", "--output", type=FILE, required=True, help="Folder for diagnosis, mended model, FMU and report.")
@click.option("--json", "as_json", is_flag=True, help="Print the diagnosis as JSON.")
@click.option(
    "--seconds",
    type=Above(),
    default=None,
    metavar="SECONDS",
    help="After which the best answer is given that was found, and what was not tried is said; inf: no limit. "
    "(default: 60, or what DASHPOT_SECONDS says)",
)
@click.option(
    "--write-law",
    type=FILE,
    metavar="FILE.py",
    help="Law file to write: the closed form of a force that was learnt because no law of the library has its shape.",
)
@with_figures
@with_mode
@with_laws
@with_recordings
def diagnose(
    model: Path,
    recordings: tuple[Path, ...],
    holdout: tuple[Path, ...],
    output: Path,
    as_json: bool,
    seconds: float | None,
    write_law: Path | None,
    figures: tuple[str, ...],
    mode: str | None,
    **options: Any,
) -> None:
    """Find the physics that a model lacks and recordings show; exit code 1 where something stays unexplained."""
    from ..diagnose.files import DIAGNOSIS, EXPERIMENT, FMU, MODEL, REPORT, check_folder
    from ..face import learnt_law
    from ..face.element import is_element_file
    from ..face.workflow import diagnosed, seconds_allowed, write_diagnosis
    from ..model.file import load
    from ..report.diagnosis_text import describe

    allowed = seconds_allowed(seconds)
    if write_law is not None:
        learnt_law.law_name(write_law)
    if is_element_file(model):
        if write_law is not None:
            raise BadInput("--write-law is for oscillators; leave it out where the motion was prescribed")
        how = {"as_json": as_json, "seconds": allowed, "figures": figures, "options": options}
        element_commands.diagnose(model, recordings, holdout, output, **how)
        return
    check_folder(output)
    files = (DIAGNOSIS, MODEL, FMU, EXPERIMENT, REPORT)
    law = [] if write_law is None else [write_law]
    outputs_checked([*(output / name for name in files), *law], [model, *recordings, *holdout])
    oscillator = load(model)
    training, held = read_all(recordings, options, say), read_all(holdout, options, say)
    with progress_shown() as progress:
        how = {"mode": mode, "notes": say, "progress": progress, "seconds": allowed}
        diagnosis, fmu = diagnosed(oscillator, training, held, **how)
    drawing()
    written = write_diagnosis(output, diagnosis, fmu, figures)
    if as_json:
        print_json(diagnosis.as_json())
    else:
        click.echo(describe(diagnosis))
    say(f"written: {', '.join(str(path) for path in written)}")
    if write_law is not None:
        say(learnt_law.write_law(write_law, diagnosis))
    if diagnosis.verdict == "unexplained":
        sys.exit(1)


@cli.command()
@click.argument("fmu", type=FILE)
@click.argument("recordings", nargs=-1, required=True, type=FILE)
@click.option("--json", "json_file", type=FILE, metavar="OUT.json", help="File for the result; - prints it.")
@click.option("--report", type=FILE, metavar="OUT.html", help="HTML page to write, with pictures.")
@with_figures
@with_time_limit
@with_recordings
def verify(
    fmu: Path,
    recordings: tuple[Path, ...],
    json_file: Path | None,
    report: Path | None,
    figures: tuple[str, ...],
    time_limit: float,
    **options: Any,
) -> None:
    """Run an FMU under FMPy with recorded forces, compare response and parameters; exit code 1 where they differ.

    That of a force law by itself is run along the motion that --prescribed names, and its force is compared.
    """
    from ..face.element import verified
    from ..face.workflow import write_verification

    printed = json_file == Path("-")
    if figures and report is None and (printed or json_file is None):
        kinds, place = ",".join(figures), "name one with --report OUT.html or --json OUT.json"
        raise BadInput(f"--figures {kinds}: the pictures go into a folder beside a page or a result; {place}")
    outputs = [path for path in (None if printed else json_file, report) if path is not None]
    outputs_checked(outputs, [fmu, *recordings])

    def keep(result: Verification) -> None:
        drawing()
        drawn = write_verification(result, None if printed else json_file, report, figures)
        if outputs:
            say(f"written: {', '.join(str(path) for path in (*outputs, *drawn))}")
        if printed:
            print_json(result.as_json())
        else:
            click.echo(result.sentence())

    result = verified(fmu, read_all(recordings, options, say), limit=time_limit, progress=stage, keep=keep)
    if not result.passed:
        sys.exit(1)


for _command in (*COMMANDS, *FORESIGHT_COMMANDS, *FLEET_COMMANDS, *SETUP_COMMANDS):
    cli.add_command(_command)
for _name, _command in cli.commands.items():
    with_quiet(_command)
    _command.epilog = epilog(_name)


def main(arguments: list[str] | None = None) -> None:
    """Entry point: whatever happens ends with one of the codes of ``exit_codes``."""
    # the simulations have threads of their own; those of the linear algebra would only stand in their way
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    os.environ["MPLBACKEND"] = "agg"  # a command draws into files alone, whatever is set for windows

    def command() -> None:
        with waiting_shown(), facts_shown(), typed(line_of(sys.argv[1:] if arguments is None else arguments)):
            cli(arguments, prog_name="dashpot", standalone_mode=False)

    ended(command)


if __name__ == "__main__":
    main()
