"""An FMU held open under FMPy and run over recordings, one call a sample."""

from __future__ import annotations

import ctypes
import os
import re
import shutil
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from ..errors import BadInput
from ..model.law import InnerState
from ..simulate.force import Force
from .description import OWN
from .platforms import library_for_here

#: Straight lines per sample where an FMU takes no higher derivatives of its input; their error falls with the square.
_LINES = 8


def _fmi_version(fmu: Path) -> str | None:
    """The FMI version that an FMU states; None where it states none that can be read."""
    try:
        with zipfile.ZipFile(fmu) as archive:
            text = archive.read("modelDescription.xml").decode("utf-8", errors="replace")
    except (OSError, zipfile.BadZipFile, KeyError, EOFError, zlib.error, NotImplementedError, RuntimeError):
        return None
    found = re.search(r"""<fmiModelDescription\b[^>]*?\bfmiVersion\s*=\s*["']([^"']*)["']""", text)
    return found.group(1) if found else None


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


def _unit(variable: Any) -> str | None:
    """Unit of a variable; None where the FMU states none."""
    return variable.unit or (variable.declaredType.unit if variable.declaredType else None)


class FmuRun:
    """A co-simulation FMU (FMI 2.0) with input ``F``, unpacked once and instantiated once.

    Raises:
        BadInput: where the file is not such an FMU or cannot be loaded on this machine.
    """

    def __init__(self, fmu: Path) -> None:
        import fmpy
        from fmpy.fmi2 import FMU2Slave

        self.path = fmu
        if fmu.is_dir():
            raise BadInput(f"{fmu}: is a folder; name an FMU, for example one made by dashpot export")
        if not fmu.is_file():
            raise BadInput(f"{fmu}: there is no such file; name an FMU, for example one made by dashpot export")
        version = _fmi_version(fmu)
        if version is not None and version != "2.0":
            raise BadInput(f"{fmu}: verify runs FMI 2.0 co-simulation FMUs; this one is of FMI {version[:20]}")
        try:
            description = fmpy.read_model_description(str(fmu))
        except Exception as problem:  # FMPy raises whatever its XML reader raises
            raise BadInput(f"{fmu}: not a readable FMU ({_short(problem)}); export it again") from problem
        if description.fmiVersion != "2.0" or description.coSimulation is None:
            raise BadInput(f"{fmu}: verify runs FMI 2.0 co-simulation FMUs; this one is FMI {description.fmiVersion}")
        variables = {variable.name: variable for variable in description.modelVariables}
        outputs = [variable for variable in description.modelVariables if variable.causality == "output"]
        if "F" not in variables or not outputs:
            raise BadInput(
                f"{fmu}: the FMU needs an input named F and an output; found {', '.join(list(variables)[:8])}"
            )
        self.variables = variables
        #: Names of the start values: x0, v0, then those of the inner states.
        self.starts = _starts(description.modelVariables)
        #: What the start values of the inner states are.
        self.inner = tuple(_inner(variables, name) for name in self.starts[2:])
        self._output = outputs[0].valueReference
        #: Unit of the first output; None where the FMU states none.
        self.unit: str | None = _unit(outputs[0])
        self._force = variables["F"].valueReference
        self._slope = variables["F_rate"].valueReference if "F_rate" in variables else None
        self._cubic = "dashpot" in (description.generationTool or "") and bool(
            description.coSimulation.canInterpolateInputs
        )
        self._lines = bool(description.coSimulation.canInterpolateInputs)
        try:
            self._folder = fmpy.extract(str(fmu))
        except Exception as problem:  # a damaged archive, or one that would unpack outside its folder
            raise BadInput(f"{fmu}: cannot be unpacked ({_short(problem)}); export it again") from problem
        here = Path.cwd()  # FMPy goes to the library's folder to load it, and stays there when that fails
        try:
            identifier = description.coSimulation.modelIdentifier
            library = library_for_here(Path(self._folder), identifier or "")
            self._fmu: Any = FMU2Slave(
                guid=description.guid,
                unzipDirectory=self._folder,
                modelIdentifier=identifier,
                instanceName="verify",
                libraryPath=None if library is None else str(library),
            )
            self._fmu.instantiate()
        except Exception as problem:
            os.chdir(here)
            shutil.rmtree(self._folder, ignore_errors=True)
            raise BadInput(
                f"{fmu}: it does not load on this machine ({_short(problem).replace(str(self._folder), fmu.name)}); "
                "export it here again"
            ) from problem
        self._fresh = True

    def __enter__(self) -> FmuRun:
        """The run itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Ends the FMU and removes what was unpacked."""
        self._fmu.freeInstance()
        shutil.rmtree(self._folder, ignore_errors=True)

    def record(
        self, force: Force | None, n: int, dt: float, initial: np.ndarray | None = None, start: float = 0.0
    ) -> np.ndarray:
        """(n,) first output at samples ``dt`` apart, the first of them at ``start``.

        ``initial`` holds displacement and velocity at the start, (2,), or behind them also the start values of the
        inner states, in the order of the FMU's variables, (states,); None: at rest.
        """
        fmu = self._fmu
        if not self._fresh:
            fmu.reset()
        self._fresh = False
        fmu.setupExperiment(startTime=start)
        fmu.enterInitializationMode()
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
            fmu.setReal([self.variables[name].valueReference for name in given], list(given.values()))
        fmu.setReal([self._force], [float(force.pieces[0, 0]) if force is not None else 0.0])
        fmu.exitInitializationMode()
        out = np.empty(n)
        out[0] = fmu.getReal([self._output])[0]
        try:
            self._steps(force, n, dt, start, out)
        except Exception as problem:
            raise BadInput(f"{self.path}: the FMU stopped ({problem}); check the units of the force") from problem
        finally:
            fmu.terminate()
        return out

    def _steps(self, force: Force | None, n: int, dt: float, start: float, out: np.ndarray) -> None:
        fmu = self._fmu
        pieces, step = self._points(force, n, dt)
        per_sample = 1 if pieces is None else round(dt / step)
        component, do_step = fmu.component, fmu.fmi2DoStep
        value = (ctypes.c_double * 1)()
        here, there = (ctypes.c_uint * 1)(self._force), (ctypes.c_uint * 1)(self._output)
        orders = 3 if self._cubic else 1
        references = (ctypes.c_uint * orders)(*[self._force] * orders)
        order = (ctypes.c_int * orders)(*range(1, orders + 1))
        slopes = (ctypes.c_double * orders)()
        factorial = np.array([1.0, 2.0, 6.0])[:orders]
        rows = (
            None if pieces is None else np.column_stack([pieces[:, 0], pieces[:, 1 : 1 + orders] * factorial]).tolist()
        )
        k = 0
        for i in range(1, n):
            for _ in range(per_sample):
                if rows is not None:
                    row = rows[k]
                    value[0] = row[0]
                    fmu.fmi2SetReal(component, here, 1, value)
                    if self._lines:
                        slopes[:] = row[1:]
                        fmu.fmi2SetRealInputDerivatives(component, references, orders, order, slopes)
                    elif self._slope is not None:
                        fmu.setReal([self._slope], [row[1]])
                do_step(component, start + k * step, step, 1)
                k += 1
            fmu.fmi2GetReal(component, there, 1, value)
            out[i] = value[0]

    def _points(self, force: Force | None, n: int, dt: float) -> tuple[np.ndarray | None, float]:
        """Cubics per communication step, or straight lines fine enough to stand for them."""
        if force is None:
            return None, dt
        pieces = force.pieces[: (n - 1) * force.fine]
        step = dt / force.fine
        if self._cubic:
            return pieces, step
        tau = np.arange(_LINES + 1) * (step / _LINES)
        points = pieces @ np.vander(tau, 4, increasing=True).T
        lines = np.zeros((pieces.shape[0] * _LINES, 4))
        lines[:, 0] = points[:, :-1].ravel()
        lines[:, 1] = np.diff(points, axis=1).ravel() / (step / _LINES)
        return lines, step / _LINES
