"""The whole story on the built-in rig: recordings, model, FMU, CasADi functions, proof, report."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from ..files.writing import check_ours, together, writable, write
from .workflow import WRITING, Say, silent

if TYPE_CHECKING:
    from ..model import Parameter

#: Recordings to learn from; the multisine is held out and seen by the verification alone.
_TRAIN = ("bursts", "sweep_low", "sweep_high")
_HELD_OUT = ("multisine",)


def run(folder: Path, say: Say, stage: Say = silent) -> bool:
    """Make everything into ``folder``; returns whether the FMU reproduces all recordings, the held-out one included.

    Args:
        folder: where the files go; made where it does not exist.
        say: called with one line per step.
        stage: called with what is worked at from now on.

    Raises:
        BadInput: where the folder cannot be written.
        ToolchainMissing: where there is no C compiler for the native FMU.
    """
    from ..examples import recordings as built_in
    from ..examples.truth import TRUTH
    from ..export import export
    from ..export import files as export_files
    from ..identify import identify
    from ..model.file import save
    from ..recording import read
    from ..report.page import identification_page
    from ..verify.verification import verify

    began = time.perf_counter()

    def step(text: str) -> None:
        say(f"[{time.perf_counter() - began:5.1f} s] {text}")
        stage(text)

    model, fmu, functions, page = (folder / name for name in ("model.yaml", "rig.fmu", "rig.casadi", "report.html"))
    for place in (model, fmu, *export_files(functions), page):
        writable(place)
    check_ours(model, b"name: paper-stand", "a demo")
    files = built_in()
    step("the paper's stand: four bursts with free decays, two sweeps; a multisine held out")
    train = [read(files[kind]) for kind in _TRAIN]
    held_out = [read(files[kind]) for kind in _HELD_OUT]
    identification = identify(train, name="paper-stand", progress=step)
    say(comparison(identification.oscillator.parameters(), TRUTH))
    with TemporaryDirectory() as scratch:
        artefact = Path(scratch) / fmu.name
        export(identification.oscillator, artefact, progress=step)
        step("the FMU under FMPy, with the force of every recording")
        proof = verify(artefact, [*train, *held_out], progress=step)
        with together():
            save(identification.oscillator, model)
            write(fmu, artefact.read_bytes())
            written = [model, fmu, *export(identification.oscillator, functions, progress=step)]
            names = tuple(path.name for path in written)
            stage(WRITING)
            write(page, identification_page(identification, proof, TRUTH, files=names).html)
    step(f"written: {', '.join(str(path) for path in (*written, page))}")
    step(proof.sentence())
    return proof.passed


def comparison(identified: Mapping[str, Parameter], truth: Mapping[str, float]) -> str:
    """Table of true and identified values, with the distance in standard errors."""
    lines = [f"{'':10}{'true':>14}{'identified':>16}{'±':>12}  {'unit':12}{'off by':>10}{'in ±':>8}"]
    for name, parameter in identified.items():
        true, std = truth[name], parameter.std or float("nan")
        lines.append(
            f"{name:10}{true:14.6g}{parameter.value:16.6g}{std:12.2g}  {parameter.unit:12}"
            f"{100 * (parameter.value / true - 1):9.3f}%{(parameter.value - true) / std:8.2f}"
        )
    return "\n".join(lines)
