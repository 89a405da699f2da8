"""The commands over many rigs and many tests: batch, compare, watch."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from ..errors import BadInput
from .options import FILE, Above, with_laws
from .several_values import CommandOfSeveral, SeveralValues
from .terminal import drawing, outputs_checked, print_json, say, stage


def _share(context: click.Context, parameter: click.Parameter, text: str) -> tuple[int, int]:
    """``k/n`` as two numbers."""
    first, sign, second = text.partition("/")
    try:
        k, n = int(first), int(second)
    except ValueError:
        k, n, sign = 0, 0, ""
    if not sign or not 1 <= k <= n:
        raise click.BadParameter(f"'{text}' is not k/n, such as 2/8: the second of eight runs that share the work")
    return k, n


def _cores() -> int:
    """Those that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@click.command()
@click.argument("manifest", type=FILE)
@click.option("-o", "--output", type=FILE, required=True, help="Folder for results, tables and the overview.")
@click.option(
    "--jobs",
    type=click.IntRange(min=1, max=1024),
    metavar="N",
    help="Processes at a time on this machine; default: as many as it has cores.",
)
@click.option("--scheduler", metavar="ADDRESS", help="A Dask cluster that does the work instead, tcp://host:8786.")
@click.option(
    "--shard", default="1/1", metavar="K/N", callback=_share, help="Do every Nth entry from the Kth on: for queues."
)
@click.option(
    "--time-limit",
    type=Above(),
    default=3600.0,
    show_default=True,
    metavar="S",
    help="Longest time of one identification or diagnosis.",
)
@click.option(
    "--memory-limit",
    type=Above(),
    metavar="MB",
    help="Most address space of one process, not on Windows; default: what there is.",
)
@click.option("--again", is_flag=True, help="Try again what failed, though its input is the same.")
@click.option("--parquet", is_flag=True, help="Write the table as Parquet too.")
@click.option("--json", "as_json", is_flag=True, help="Print fleet.json.")
def batch(
    manifest: Path,
    output: Path,
    jobs: int | None,
    scheduler: str | None,
    shard: tuple[int, int],
    time_limit: float,
    memory_limit: float | None,
    again: bool,
    parquet: bool,
    as_json: bool,
) -> None:
    """Identify every rig of a manifest and diagnose what does not fit; what is done already is not done again.

    Exit code 1 where a row is not done, or not believed.
    """
    from ..face.batch import CSV, MODULE, PAGE, PARQUET, run
    from ..fleet.engine import dask, local
    from ..fleet.manifest import read_manifest
    from ..fleet.outcome import BELIEVED
    from ..fleet.store import FLEET
    from ..fleet.table import as_json as rows_json
    from ..fleet.table import counts, need_parquet

    asked = read_manifest(manifest)
    if parquet:
        need_parquet()
    if memory_limit is not None and sys.platform == "win32":
        raise BadInput("--memory-limit needs a system that limits processes, which Windows does not; leave it out")
    tables = [output / name for name in (FLEET, CSV, PAGE, *([PARQUET] if parquet else []))]
    outputs_checked(tables, [manifest])
    engine = dask(MODULE, scheduler, say) if scheduler else local(MODULE, jobs or _cores())
    how = {"limit": time_limit, "memory": memory_limit, "again": again, "with_parquet": parquet}
    rows = run(asked, output, engine, shard=shard, say=stage, **how)
    if as_json:
        print_json(rows_json(rows))
    else:
        there = counts(rows)
        for row in rows:
            if row.outcome.state not in BELIEVED:
                click.echo(f"{row.entry.name}: {row.outcome.state}: {row.outcome.sentence}")
        click.echo(f"{len(rows)} rows: {', '.join(f'{count} {state}' for state, count in there.items())}")
    say(f"written: {', '.join(str(path) for path in tables)}")
    if any(row.outcome.state not in BELIEVED for row in rows):
        sys.exit(1)


def _with_repeats(command: Callable[..., Any]) -> Callable[..., Any]:
    """The option that says what repeatability is learnt from."""
    return click.option(
        "--repeats",
        cls=SeveralValues,
        type=FILE,
        metavar="MODEL...",
        help="Models of one unchanged rig, or the results of a fleet with repeats, from which it is learnt how far "
        "repeats lie apart: all up to the next option.",
    )(command)


@click.command(cls=CommandOfSeveral)
@click.argument("first", type=FILE)
@click.argument("second", type=FILE)
@_with_repeats
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
@with_laws
def compare(first: Path, second: Path, repeats: tuple[Path, ...], as_json: bool) -> None:
    """What changed from one model to another: the fewest parameters that explain it, and which law appeared.

    Exit code 1 where something did.
    """
    from ..change.wording import as_json as comparison_json
    from ..change.wording import describe
    from ..face.fleet import compare as changed
    from ..fleet.lives_of_rigs import repeats_of

    found = changed(first, second, repeats_of(repeats))
    if as_json:
        print_json(comparison_json(found))
    else:
        click.echo(describe(found))
    if found.changed:
        sys.exit(1)


@click.command(cls=CommandOfSeveral)
@click.argument("models", nargs=-1, required=True, type=FILE)
@_with_repeats
@click.option("--rig", metavar="NAME", help="Of a fleet's results, this rig alone.")
@click.option("--report", type=FILE, metavar="OUT.html", help="HTML page to write, with pictures over time.")
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
@with_laws
def watch(
    models: tuple[Path, ...], repeats: tuple[Path, ...], rig: str | None, report: Path | None, as_json: bool
) -> None:
    """Which parameters moved over a rig's life, and when: models in order, or the folder that batch wrote.

    Exit code 1 where something did.
    """
    from ..change.life_wording import as_json as life_json
    from ..change.life_wording import describe
    from ..fleet.lives_of_rigs import lives_of

    if report is not None:
        outputs_checked([report], [*models, *repeats])
    lives = lives_of(models, rig, say, repeats)
    if report is not None:
        from ..files.writing import write
        from ..report.life_page import life_page

        drawing()
        write(report, life_page(lives).html)
    if as_json:
        print_json([life_json(life) for life in lives])
    else:
        click.echo("\n\n".join(describe(life) for life in lives))
    if report is not None:
        say(f"written: {report}")
    if any(life.changed for life in lives):
        sys.exit(1)


COMMANDS = (batch, compare, watch)
