"""The calls over many rigs and many tests."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .model import Model, oscillator_of

if TYPE_CHECKING:
    from ..change.comparison import Comparison
    from ..change.life import Life
    from ..fleet.table import Row
    from ..model import Oscillator


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

    say = progress or (lambda _: None)
    return run(read_manifest(Path(manifest)), Path(output), local(MODULE, jobs), again=again, say=say)


def compare(
    first: Model | Oscillator | str | Path,
    second: Model | Oscillator | str | Path,
    repeats: Sequence[Sequence[Model | Oscillator | str | Path]] = (),
) -> Comparison:
    """What changed from one model to another: the fewest parameters that explain it, and which law appeared.

    Args:
        first, second: models with the errors of their parameters, or their files.
        repeats: groups of models, each of one unchanged rig, from which it is learnt how far repeats lie apart.

    Raises:
        BadInput: the models have other units, no errors, or no parameter in common.

    >>> import dashpot
    >>> stand = dashpot.identify(dashpot.examples.recordings()["bursts"], part="0:15")
    >>> dashpot.compare(stand, stand).changed
    False
    """
    from ..change import compare as changed

    known = [[oscillator_of(model) for model in group] for group in repeats]
    return changed(oscillator_of(first), oscillator_of(second), known)


def watch(
    models: Sequence[Model | Oscillator | str | Path], *, name: str = "rig", repeats: Sequence[str | Path] = ()
) -> Life:
    """Which parameters moved over a rig's life, and when.

    Args:
        models: of one rig in the order of time, or their files.
        name: of the rig.
        repeats: model files of one unchanged rig, or folders that ``batch`` wrote, to learn repeatability from.

    Raises:
        BadInput: there are fewer than two models, or they cannot be compared.

    >>> import dashpot
    >>> stand = dashpot.identify(dashpot.examples.recordings()["bursts"], part="0:15")
    >>> dashpot.watch([stand, stand, stand]).changed
    False
    """
    from ..change.life import Point
    from ..change.life import watch as watched
    from ..fleet.lives_of_rigs import repeats_of

    points = [Point(str(place), oscillator_of(model)) for place, model in enumerate(models, 1)]
    return watched(points, name, repeats_of([Path(place) for place in repeats]))
