"""The force that every importer is given, the answer it is held against, and the process in which it runs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate_pieces, linear_pieces

FOLDER = Path(__file__).parent
NOT_HERE = 77  # what play.py ends with where an importer is not installed
SECONDS = 900  # a first compilation for a foreign machine takes minutes on a busy one
DT = 1e-3


@pytest.fixture(scope="session")
def play(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., np.ndarray]:
    """``play("fmpy_slave", fmu, force, dt, parameters, hold)``: that importer's output, in a process of its own."""
    folder = tmp_path_factory.mktemp("play")

    def run(
        module: str,
        fmu: Path,
        force: np.ndarray,
        dt: float,
        parameters: dict[str, float],
        hold: str,
        function: str = "run",
        **further: Any,
    ) -> np.ndarray:
        job, out, signal = folder / "job.json", folder / "out.npy", folder / "force.npy"
        out.unlink(missing_ok=True)
        np.save(signal, force)
        arguments = {"fmu": str(fmu), "dt": dt, "parameters": parameters, "hold": hold, **further}
        text = {"module": module, "function": function, "arguments": arguments, "force": str(signal)}
        job.write_text(json.dumps(text), encoding="utf-8")
        done = subprocess.run(
            [sys.executable, "-P", str(FOLDER / "play.py"), str(job), str(out)],
            cwd=folder,
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
            capture_output=True,
            text=True,
            check=False,
            timeout=SECONDS,
        )
        if done.returncode == NOT_HERE:
            pytest.skip(done.stdout.strip())
        assert done.returncode == 0, (
            f"{module} ended with {done.returncode}: {done.stdout[-500:]} {done.stderr[-2000:]}"
        )
        return np.load(out)

    return run


@pytest.fixture(scope="session")
def sweep() -> np.ndarray:
    """A force through the resonance that also rests for a while, so that the motion sticks and breaks away."""
    t = np.arange(1500) * DT
    force = np.sin(2 * np.pi * (5.0 * t + 7.5 * t**2 / t[-1]))
    force[600:900] = 0.01
    return force


@pytest.fixture(scope="session")
def reference() -> Callable[..., np.ndarray]:
    """``reference(values, force, hold, x0, v0)``: (n,) displacement by an integrator of its own."""

    def of(values: dict[str, float], force: np.ndarray, hold: str, x0: float, v0: float) -> np.ndarray:
        pieces = linear_pieces(force) if hold == "first" else force[:-1, None]
        return integrate_pieces(values, pieces, DT, x0, v0)[0]

    return of
