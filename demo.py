"""The whole story on the built-in rig: recordings, model, FMU, CasADi functions, proof, report."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from .writing import replacing, writable

if TYPE_CHECKING:
    from .model import Parameter

#: Recordings to learn from; the multisine is held out and seen by the verification alone.
_TRAIN = ("bursts", "sweep_low", "sweep_high")
_HELD_OUT = ("multisine",)


def run(folder: Path, say: Callable[[str], None]) -> bool:
    """Make everything into ``folder``; returns whether the FMU reproduces all recordings, the held-out one included.

    Args:
        folder: where the files go; made where it does not exist.
        say: called with one line per step.

    Raises:
        BadInput: where the folder cannot be written.
        ToolchainMissing: where there is no C compiler for the native FMU.
    """
    from .examples import recordings as built_in
    from .examples.truth import TRUTH
    from .export import export
    from .identify import identify
    from .model.file import save
    from .recording import read
    from .report.page import identification_page
    from .verify.verification import verify

    began = time.perf_counter()

    def step(text: str) -> None:
        say(f"[{time.perf_counter() - began:5.1f} s] {text}")

    writable(folder / "model.yaml")
    files = built_in()
    step("the paper's stand: four bursts with free decays, two sweeps; a multisine held out")
    train = [read(files[kind]) for kind in _TRAIN]
    held_out = [read(files[kind]) for kind in _HELD_OUT]
    identification = identify(train, name="paper-stand", progress=step)
    model = folder / "model.yaml"
    save(identification.oscillator, model)
    step(f"written: {model}")
    say(comparison(identification.oscillator.parameters(), TRUTH))
    fmu = folder / "rig.fmu"
    written = [model]
    for output in (fmu, folder / "rig.casadi"):
        made = export(identification.oscillator, output, progress=step)
        written += made
        step(f"written: {', '.join(path.name for path in made)}")
    step("the FMU under FMPy, with the force of every recording")
    proof = verify(fmu, [*train, *held_out], progress=step)
    page = folder / "report.html"
    with replacing(page) as temporary:
        text = identification_page(identification, proof, TRUTH, files=tuple(path.name for path in written))
        temporary.write_text(text, encoding="utf-8")
    step(f"written: {page}")
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
