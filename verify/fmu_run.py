"""An FMU held open under FMPy and run over recordings, one call a sample."""

from __future__ import annotations

import os
import re
import shutil
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import mkdtemp
from types import TracebackType
from typing import Any

import numpy as np

from ..errors import BadInput
from ..export.description import OWN
from ..export.platforms import library_for_here
from ..model.law import InnerState
from ..model.oscillator import HOLDS
from ..model.yaml_loader import read_yaml
from ..recording.recording import Recording
from ..simulate.force import Force
from .slave import FACTORIAL, SLAVES, Slave

#: Straight lines per sample where an FMU takes no higher derivatives of its input; their error falls with the square.
_LINES = 8


def _fmi_version(fmu: Path) -> str | None:
    """The FMI version that an FMU states; None where it states none that can be read."""
    try:
        with zipfile.ZipFile(fmu) as archive:
            text = archive.read("modelDescription.xml").decode("utf-8", errors="replace")
    except (OSError, zipfile.BadZipFile, KeyError, EOFError, zlib.error, NotImplementedError, RuntimeError):
        return None
    match = re.search(r"""<fmiModelDescription\b[^>]*?\bfmiVersion\s*=\s*["']([^"']*)["']""", text)
    return match.group(1) if match else None


def _short(problem: Exception) -> str:
    """What another library says, on one line: FMPy lists every finding of its XML schema."""
    words = " ".join(str(problem).split()).rstrip(".")
    return words if len(words) <= 200 else f"{words[:200]} ..."


def _starts(variables: Sequence[Any]) -> list[str]:
    """Names of the start values that an FMU lets one set: x0, v0, then those of inner states in their order."""
    fixed = [v.name for v in variables if v.causality == "parameter" and v.variability == "fixed"]
    inner = [name for name in fixed if "." in name and name.endswith("0")]
    return [*(name for name in ("x0", "v0") if name in fixed), *inner]


def _inner(variables: Mapping[str, Any], name: str) -> InnerState:
    """What a start value is, from what the FMU says of it: its size by its unit, and whether each run has its own."""
    unit = _unit(variables[name])
    known = {_unit(variables[of]): template for of, template in (("F", "Q"), ("v0", "X/s"), ("x0", "X"))}
    free = str(variables[name].description or "").endswith(OWN)
    return InnerState(name, "rad" if free else known.get(unit, "1"), free=free)


def _hold(file: Path) -> str | None:
    """What a model file says of its force between samples; None where there is no such file, or it says nothing."""
    try:
        content = read_yaml(file.read_text(encoding="utf-8"), file.name).data
    except (OSError, UnicodeDecodeError, BadInput):
        return None  # an FMU of another make may hold anything under that name
    excitation = content.get("excitation") if isinstance(content, dict) else None
    hold = excitation.get("hold") if isinstance(excitation, dict) else None
    return hold if hold in HOLDS else None


def _unit(variable: Any) -> str | None:
    """Unit of a variable; None where the FMU states none."""
    return variable.unit or (variable.declaredType.unit if variable.declaredType else None)


class FmuRun:
    """A co-simulation FMU (FMI 2.0 or 3.0) with input ``F``, unpacked once and instantiated once.

    Raises:
        BadInput: where the file is not such an FMU or cannot be loaded on this machine.
    """

    def __init__(self, fmu: Path) -> None:
        self.path = fmu
        if fmu.is_dir():
            raise BadInput(f"{fmu}: is a folder; name an FMU, for example one made by dashpot export")
        if not fmu.is_file():
            raise BadInput(f"{fmu}: there is no such file; name an FMU, for example one made by dashpot export")
        version = _fmi_version(fmu)
        if version is not None and version.partition(".")[0] not in SLAVES:
            raise BadInput(f"{fmu}: verify runs FMUs of FMI 2.0 and 3.0; this one is of FMI {version[:20]}")
        self._folder = mkdtemp()
        here = Path.cwd()  # FMPy goes to the library's folder to load it, and stays there when that fails
        try:
            description = self._described()
            self._slave = self._loaded(description)
        except BaseException:
            os.chdir(here)
            shutil.rmtree(self._folder, ignore_errors=True)
            raise
        self.variables = {variable.name: variable for variable in description.modelVariables}
        #: Names of the start values: x0, v0, then those of the inner states.
        self.starts = _starts(description.modelVariables)
        #: What the start values of the inner states are.
        self.inner = tuple(_inner(self.variables, name) for name in self.starts[2:])
        #: Units of the outputs in their order, by name; None where the FMU states none.
        self.outputs = {v.name: _unit(v) for v in description.modelVariables if v.causality == "output"}
        #: How the force ran between the samples that the model inside was identified from; None where it holds none.
        self.hold = _hold(Path(self._folder) / "resources" / "model.yaml")

    def _described(self) -> Any:
        """What the FMU says of itself, read where it was unpacked: FMPy leaves an archive open that it cannot read."""
        import fmpy

        fmu = self.path
        try:
            fmpy.extract(str(fmu), self._folder)
            description = fmpy.read_model_description(self._folder)
        except Exception as problem:  # a damaged archive, or one that would unpack outside its folder, or damaged XML
            raise BadInput(f"{fmu}: not a readable FMU ({self._said(problem)}); export it again") from problem
        if description.coSimulation is None:
            raise BadInput(f"{fmu}: verify runs FMUs for co-simulation; this one is for model exchange alone")
        names = [variable.name for variable in description.modelVariables]
        if "F" not in names or not any(variable.causality == "output" for variable in description.modelVariables):
            raise BadInput(f"{fmu}: the FMU needs an input named F and an output; found {', '.join(names[:8])}")
        return description

    def _loaded(self, description: Any) -> Slave:
        """The FMU's binary for this machine, with an instance of it."""
        library = library_for_here(Path(self._folder), description.coSimulation.modelIdentifier or "")
        try:
            return SLAVES[str(description.fmiVersion).partition(".")[0]](description, self._folder, library)
        except Exception as problem:
            raise BadInput(
                f"{self.path}: it does not load on this machine ({self._said(problem)}); export it here again"
            ) from problem

    def _said(self, problem: Exception) -> str:
        """What another library says, with the FMU's name in place of the folder that it was unpacked into."""
        return _short(problem).replace(self._folder, self.path.name)

    def __enter__(self) -> FmuRun:
        """The run itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Ends the FMU and removes what was unpacked."""
        self._slave.close()
        shutil.rmtree(self._folder, ignore_errors=True)

    def output_for(self, recording: Recording) -> str:
        """Name of the output that shows what a recording does: the first of its unit.

        Raises:
            BadInput: where there is none.
        """
        for name, unit in self.outputs.items():
            if unit in (None, recording.unit):
                return name
        listed = ", ".join(f"{name} in {unit}" for name, unit in self.outputs.items())
        raise BadInput(
            f"{recording.name}: records {recording.quantity} in {recording.unit}; {self.path} gives {listed}; "
            "name a recording of one of them, or say what the column is with --response and --unit"
        )

    def heard(self) -> list[str]:
        """What the FMU has said since the last time; of messages that differ by their numbers alone, the first."""
        kinds = {re.sub(r"[-+.\d]+(e[-+]?\d+)?", "#", text): text for text in reversed(self._slave.said)}
        self._slave.said.clear()
        return list(reversed(kinds.values()))

    def record(
        self,
        force: Force | None,
        n: int,
        dt: float,
        initial: np.ndarray | None = None,
        start: float = 0.0,
        output: str | None = None,
    ) -> np.ndarray:
        """(n,) an output, the first where none is named, at samples ``dt`` apart, the first of them at ``start``.

        ``initial`` holds displacement and velocity at the start, (2,), or behind them also the start values of the
        inner states, in the order of the FMU's variables, (states,); None: at rest.
        """
        given: dict[str, float] = {}
        if initial is not None and np.any(initial):
            if not {"x0", "v0"} <= set(self.variables):
                raise BadInput(
                    f"{self.path}: the recording does not start at rest, and the FMU has no x0 and v0 to set"
                )
            if np.any(initial[len(self.starts) :]):
                raise BadInput(
                    f"{self.path}: {len(initial)} start values where the FMU has {len(self.starts)} to set "
                    f"({', '.join(self.starts)}); export the model again"
                )
            given = dict(zip(self.starts, (float(value) for value in initial), strict=False))
        given["F"] = float(force.pieces[0, 0]) if force is not None else 0.0
        self._slave.show(output or next(iter(self.outputs)))
        self._slave.start(start, given)
        out = np.empty(n)
        out[0] = self._slave.read()
        try:
            self._steps(force, n, dt, start, out)
        except Exception as problem:
            said = self._slave.said[-1] if self._slave.said else problem
            raise BadInput(f"{self.path}: the FMU stopped ({said}); check the units of the force") from problem
        finally:
            self._slave.stop()
        return out

    def _steps(self, force: Force | None, n: int, dt: float, start: float, out: np.ndarray) -> None:
        slave = self._slave
        pieces, step = self._points(force, n, dt)
        rows = iter([] if pieces is None else (pieces[:, : 1 + slave.orders] * FACTORIAL[: 1 + slave.orders]).tolist())
        per_sample = 1 if pieces is None else round(dt / step)
        jumps = force is not None and force.hold == "zero"
        for i in range(1, n):
            for k in range((i - 1) * per_sample, i * per_sample):
                if pieces is not None:
                    slave.push(next(rows))
                slave.step(start + k * step, step)
            if jumps and force is not None and i < force.pieces.shape[0]:
                slave.push([float(force.pieces[i, 0]), 0.0, 0.0, 0.0][: 1 + slave.orders])  # it acts on this sample
            out[i] = slave.read()

    def _points(self, force: Force | None, n: int, dt: float) -> tuple[np.ndarray | None, float]:
        """Cubics per communication step, or straight lines fine enough to stand for them."""
        if force is None:
            return None, dt
        pieces = force.pieces[: (n - 1) * force.fine]
        step = dt / force.fine
        if self._slave.orders == 3 or force.hold == "zero":  # what is held needs no derivatives
            return pieces, step
        tau = np.arange(_LINES + 1) * (step / _LINES)
        points = pieces @ np.vander(tau, 4, increasing=True).T
        lines = np.zeros((pieces.shape[0] * _LINES, 4))
        lines[:, 0] = points[:, :-1].ravel()
        lines[:, 1] = np.diff(points, axis=1).ravel() / (step / _LINES)
        return lines, step / _LINES
