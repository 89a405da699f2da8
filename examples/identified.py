"""The paper's stand as it is identified from its bursts, and its FMU: where the examples of its use begin."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..model import Oscillator
from . import recordings


def identified(folder: Path) -> tuple[Oscillator, Path]:
    """The model and its FMU for this machine, ``rig.yaml`` and ``rig.fmu`` in ``folder``."""
    from ..export.fmu import export_fmu
    from ..export.platforms import own_platform
    from ..identify import identify
    from ..model.file import save
    from ..recording import read

    model = identify([read(recordings()["bursts"])], name="rig").oscillator
    folder.mkdir(parents=True, exist_ok=True)
    save(model, folder / "rig.yaml")
    return model, export_fmu(model, folder / "rig.fmu", platforms=(own_platform(),))


def folder_named(arguments: list[str], name: str, about: str) -> Path:
    """The folder that a program is told on its command line, ``name`` where it is told none."""
    parser = argparse.ArgumentParser(prog=f"python -m dashpot.examples.{name}", description=about)
    parser.add_argument("folder", nargs="?", type=Path, default=Path(name), help=f"for the files; default: {name}")
    return parser.parse_args(arguments).folder
