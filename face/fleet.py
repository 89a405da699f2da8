"""The calls over many rigs and many tests."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import BadInput
from ..files.arguments import number_of, path_of, several_of, shown, text_of
from .identified import identified_of
from .model import Model

if TYPE_CHECKING:
    from ..change.comparison import Comparison
    from ..change.life import Life
    from ..fleet.table import Row
    from ..model.identified import Identified
    from .element import ForceElement


def batch(
    manifest: str | Path,
    output: str | Path,
    *,
    jobs: int = 1,
    again: bool = False,
    progress: Callable[[str], None] | None = None,
) -> list[Row]:
    """Identify every rig of a manifest and diagnose what does not fit; what is done already is not done again.

    Args:
        manifest: YAML file of rigs, recordings and options, docs/fleets.md.
        output: folder for results, tables and the overview.
        jobs: processes at a time.
        again: whether what failed is tried again though its input is the same.
        progress: called with one line for each entry.

    Raises:
        BadInput: the manifest is none, one line a problem; the folder holds something else.

    Examples:
        >>> import dashpot, pathlib, tempfile
        >>> folder = pathlib.Path(tempfile.mkdtemp())
        >>> _ = (folder / "fleet.yaml").write_text("rigs: {}")
        >>> dashpot.batch(folder / "fleet.yaml", folder / "results")
        Traceback (most recent call last):
        ...
        dashpot.errors.BadInput: ...
    """
    from ..fleet.engine import local
    from ..fleet.manifest import read_manifest
    from .batch import MODULE, run

    manifest, output = path_of(manifest, "the manifest"), path_of(output, "a folder for the results")
    if not number_of(jobs, "jobs") >= 1 or int(jobs) != jobs:
        raise BadInput(f"jobs is a number of processes from 1, not {shown(jobs)}")
    say = progress or (lambda _: None)
    return run(read_manifest(manifest), output, local(MODULE, int(jobs)), again=again, say=say)


def compare(
    first: Model | ForceElement | Identified | str | Path,
    second: Model | ForceElement | Identified | str | Path,
    repeats: Sequence[Sequence[Model | ForceElement | Identified | str | Path]] = (),
) -> Comparison:
    """What changed from one model to another: the fewest parameters that explain it, and which law appeared.

    Args:
        first: model with the errors of its parameters, or a force law by itself, or the file of either.
        second: the model to compare with it.
        repeats: groups of models, each of one unchanged rig, from which it is learnt how far repeats lie apart.

    Raises:
        BadInput: the models have other units, no errors, or no parameter in common.

    Examples:
        >>> import dashpot
        >>> stand = dashpot.identify(dashpot.examples.recordings()["bursts"], part="0:15")
        >>> dashpot.compare(stand, stand).changed
        False
    """
    from ..change import compare as changed

    groups = [several_of(group, "a group of repeats") for group in several_of(repeats, "repeats")]
    known = [[identified_of(model) for model in group] for group in groups]
    return changed(identified_of(first), identified_of(second), known)


def watch(
    models: Sequence[Model | ForceElement | Identified | str | Path],
    *,
    name: str = "rig",
    repeats: Sequence[str | Path] = (),
) -> Life:
    """Which parameters moved over a rig's life, and when.

    Args:
        models: of one rig, or force laws of one specimen, in the order of time, or their files.
        name: of the rig.
        repeats: model files of one unchanged rig, or folders that ``batch`` wrote, to learn repeatability from.

    Raises:
        BadInput: there are fewer than two models, or they cannot be compared.

    Examples:
        >>> import dashpot
        >>> stand = dashpot.identify(dashpot.examples.recordings()["bursts"], part="0:15")
        >>> dashpot.watch([stand, stand, stand]).changed
        False
    """
    from ..change.life import Point
    from ..change.life import watch as watched
    from ..fleet.lives_of_rigs import repeats_of

    points = [Point(str(place), identified_of(model)) for place, model in enumerate(several_of(models, "models"), 1)]
    places = [path_of(place, "a file or folder of repeats") for place in several_of(repeats, "repeats")]
    return watched(points, text_of(name, "the name of the rig"), repeats_of(places))
