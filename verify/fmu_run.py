"""An FMU held open under FMPy, in a process of its own, and run over recordings, one call a sample."""

from __future__ import annotations

import re
import shutil
import stat
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import mkdtemp
from types import TracebackType
from typing import Any

import numpy as np

from ..errors import BadInput
from ..export.description import OWN
from ..files.yaml_loader import MAX_CHARACTERS, read_yaml
from ..model.law import InnerState
from ..model.oscillator import HOLDS
from ..recording.recording import Recording
from ..simulate.force import Force
from ..simulate.imposed import spline_of
from .fmu_process import TIME_LIMIT, FmuProcess
from .model_inside import element_inside, model_inside
from .slave import MOTION
from .unpack import stated_version, unpack

#: Straight lines per sample where an FMU takes no higher derivatives of its input; their error falls with the square.
_LINES = 8


@dataclass(frozen=True)
class FmuVariable:
    """A variable as the FMU describes it; ``unit`` and ``start`` (as text) are None where it states none."""

    name: str
    reference: int
    causality: str
    variability: str
    unit: str | None
    description: str | None
    start: str | None


def _starts(variables: Iterable[FmuVariable]) -> list[str]:
    """Names of the start values that an FMU lets one set: x0, v0, then those of inner states in their order."""
    fixed = [v.name for v in variables if v.causality == "parameter" and v.variability == "fixed"]
    inner = [name for name in fixed if "." in name and name.endswith("0")]
    return [*(name for name in ("x0", "v0") if name in fixed), *inner]


def _inner(variables: Mapping[str, FmuVariable], name: str) -> InnerState:
    """What a start value is, from what the FMU says of it: its size by its unit, and whether each run has its own."""
    unit = variables[name].unit
    known = {variables[of].unit: template for of, template in (("F", "Q"), ("v0", "X/s"), ("x0", "X"))}
    free = str(variables[name].description or "").endswith(OWN)
    return InnerState(name, "rad" if free else known.get(unit, "1"), free=free)


def _hold(file: Path) -> str | None:
    """What a model file says of its force between samples; None where there is no such file, or it says nothing."""
    try:
        if not file.is_file() or file.stat().st_size > MAX_CHARACTERS:
            return None
        content = read_yaml(file.read_text(encoding="utf-8"), file.name).data
    except (OSError, UnicodeDecodeError, BadInput):
        return None  # an FMU of another make may hold anything under that name
    excitation = content.get("excitation") if isinstance(content, dict) else None
    hold = excitation.get("hold") if isinstance(excitation, dict) else None
    return hold if hold in HOLDS else None


class FmuStopped(BadInput):
    """An FMU that says of a step that it failed; ``reached`` (n,) has the output until then, and NaN from there on."""

    def __init__(self, message: str, reached: np.ndarray) -> None:
        super().__init__(message)
        self.reached = reached

    def of(self, n: int) -> np.ndarray:
        """(n,) output of a run of n samples until then, and NaN from there on; NaN alone where it gave back none."""
        return self.reached if self.reached.size == n else np.full(n, np.nan)


class FmuRun:
    """A co-simulation FMU (FMI 2.0 or 3.0), unpacked once and instantiated once, in its own process.

    It has an input ``F``, or the inputs of a motion that is given and the output ``F``.

    Args:
        fmu: the file.
        limit: longest time, s, without a step that it finished.

    Raises:
        BadInput: where the file is not such an FMU or cannot be loaded on this machine.
    """

    def __init__(self, fmu: Path, *, limit: float = TIME_LIMIT) -> None:
        self.path = fmu
        try:
            mode = fmu.stat().st_mode
        except OSError as error:
            reason = "there is no such file" if isinstance(error, FileNotFoundError) else error.strerror
            raise BadInput(f"{fmu}: {reason}; name an FMU, for example one made by dashpot export") from None
        if not stat.S_ISREG(mode):
            kind = "a folder" if stat.S_ISDIR(mode) else "a pipe or a device"
            raise BadInput(f"{fmu}: is {kind}; name an FMU, for example one made by dashpot export")
        self._folder = Path(mkdtemp(prefix="fmu-"))
        self._process: FmuProcess | None = None
        try:
            self._process = FmuProcess(self._folder, str(fmu), limit)  # which starts while the archive is unpacked
            unpack(fmu, self._folder)
            version = stated_version(self._folder)
            if version is not None and version.partition(".")[0] not in ("2", "3"):
                raise BadInput(f"{fmu}: verify runs FMUs of FMI 2.0 and 3.0; this one is of FMI {version[:20]}")
            found = self._ask({"do": "open"}, doing="while it was loaded")[0]
            variables = [FmuVariable(**entry) for entry in found["variables"]]
            self._orders = int(found["orders"])
        except BaseException:
            self.__exit__(None, None, None)
            raise
        self.variables = {variable.name: variable for variable in variables}
        #: Names of the start values: x0, v0, then those of the inner states.
        self.starts = _starts(variables)
        #: What the start values of the inner states are.
        self.inner = tuple(_inner(self.variables, name) for name in self.starts[2:])
        #: Unit of the input ``F``; None where the FMU states none.
        self.force_unit = self.variables["F"].unit
        #: Units of the outputs in their order, by name; None where the FMU states none.
        self.outputs = {v.name: v.unit for v in variables if v.causality == "output"}
        #: How the force ran between the samples that the model inside was identified from; None where it holds none.
        self.hold = _hold(self._folder / "resources" / "model.yaml")
        #: The model inside; None where it holds none.
        self.model = model_inside(self._folder / "resources" / "model.yaml")
        #: The element inside, of an FMU whose motion is given; None where it holds none.
        self.element = element_inside(self._folder / "resources" / "element.yaml")
        #: Whether its motion is given.
        inputs = [v.name for v in variables if v.causality == "input"]
        self.moved = set(inputs).issuperset(MOTION)
        #: Names of further inputs of such an FMU, in their order: channels that its force depends on.
        self.channels = [name for name in inputs if name not in (*MOTION, f"{MOTION[-1]}_rate")] if self.moved else []
        self._said: list[str] = []

    def _ask(self, head: dict[str, Any], numbers: bytes = b"", *, doing: str) -> tuple[dict[str, Any], bytes]:
        assert self._process is not None
        answer = self._process.ask(head, numbers, doing=doing)
        if "failed" in answer[0]:
            raise FmuStopped(
                f"{self.path}: the FMU stopped ({answer[0]['failed']}) {doing}; check the units",
                np.frombuffer(answer[1], float).copy(),
            )
        return answer

    def __enter__(self) -> FmuRun:
        """The run itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Ends the FMU and removes what was unpacked."""
        try:
            if self._process is not None:
                self._process.close()
        finally:
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
        kinds = {re.sub(r"[-+.\d]+(e[-+]?\d+)?", "#", text): text for text in reversed(self._said)}
        self._said.clear()
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

        Raises:
            FmuStopped: where the FMU ends the run, as with a motion that grows beyond bounds.
            BadInput: where it cannot be run so, or does not keep to its interface.
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
        pieces, step = self._points(force, n, dt)
        width = 1 + self._orders
        rows = np.empty(0) if pieces is None else np.ascontiguousarray(pieces[:, :width] * FACTORIAL[:width], float)
        jumps = np.empty(0)
        if force is not None and force.hold == "zero":
            jumps = np.ascontiguousarray(force.pieces[1:n, 0], float)
        head = {
            "output": output or next(iter(self.outputs)),
            "given": given,
            "time": start,
            "n": n,
            "step": step,
            "per_sample": 1 if pieces is None else round(dt / step),
            "pushed": pieces is not None,
            "jumps": jumps.size,
        }
        return self._recorded(head, rows.tobytes() + jumps.tobytes(), dt)

    def force_along(
        self, displacement: np.ndarray, dt: float, start: float = 0.0, channels: Sequence[np.ndarray] = ()
    ) -> np.ndarray:
        """(n,) the output F along the cubic spline through a displacement (n,), which is given to it.

        ``channels`` are (n,) each, in the order of its further inputs; each is held over a step. Raises as ``record``.
        """
        velocity, acceleration = spline_of(displacement, dt)
        slopes = [np.diff(acceleration) / dt] if self._orders else []
        given = (displacement, velocity, *channels, acceleration)
        rows = np.column_stack([*(signal[:-1] for signal in given), *slopes])
        rows = np.hstack([rows, np.zeros((len(rows), max(self._orders - 1, 0)))])
        names = (*MOTION[:-1], *self.channels, MOTION[-1])
        head = {
            "output": "F",
            "given": {name: float(signal[0]) for name, signal in zip(names, given, strict=True)},
            "time": start,
            "n": displacement.size,
            "step": dt,
            "per_sample": 1,
            "pushed": True,
            "jumps": 0,
        }
        return self._recorded(head, rows.tobytes(), dt)

    def _recorded(self, head: dict[str, Any], rows: bytes, dt: float) -> np.ndarray:
        """(n,) what comes of a run at samples ``dt`` apart."""
        n, start = head["n"], head["time"]
        head, numbers = self._ask({"do": "record", **head}, rows, doing="while it ran")
        self._said += head["said"]
        out = np.frombuffer(numbers, float).copy()
        if out.size != n:
            raise BadInput(
                f"{self.path}: the FMU gave {out.size} values where {n} were due; such an FMU cannot be used"
            )
        if (bad := np.flatnonzero(~np.isfinite(out))).size:
            raise BadInput(
                f"{self.path}: the FMU gives {out[bad[0]]} at {start + bad[0] * dt:.4g} s and says that all is well; "
                "check its parameters and the units"
            )
        return out

    def _points(self, force: Force | None, n: int, dt: float) -> tuple[np.ndarray | None, float]:
        """Cubics per communication step, or straight lines fine enough to stand for them."""
        if force is None:
            return None, dt
        pieces = force.pieces[: (n - 1) * force.fine]
        step = dt / force.fine
        if self._orders == 3 or force.hold == "zero":  # what is held needs no derivatives
            return pieces, step
        tau = np.arange(_LINES + 1) * (step / _LINES)
        points = pieces @ np.vander(tau, 4, increasing=True).T
        lines = np.zeros((pieces.shape[0] * _LINES, 4))
        lines[:, 0] = points[:, :-1].ravel()
        lines[:, 1] = np.diff(points, axis=1).ravel() / (step / _LINES)
        return lines, step / _LINES


#: The factors between the coefficients of a polynomial and its derivatives.
FACTORIAL = np.array([1.0, 1.0, 2.0, 6.0])
