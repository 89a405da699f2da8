"""A linear model in words: what ``dashpot linearise`` prints, and the same as data for other programs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

    from .linear import LinearModel


def describe(linear: LinearModel, step: float | None = None) -> str:
    """The linear model as text; with a sample time ``step``, s, the discrete A and B too, which may raise BadInput."""
    states = ", ".join(f"{n} {u}" for n, u in zip(linear.state_names, linear.state_units, strict=True))
    outputs = ", ".join(f"{n} {u}" for n, u in zip(linear.output_names, linear.output_units, strict=True))
    parts = [_about(linear), f"z: {states}\nu: force {linear.input_unit}\ny: {outputs}"]
    parts += [_matrix(name, getattr(linear, name)) for name in "ABCD"]
    if step is not None:
        a, b = linear.discrete(step)
        parts += [_matrix(f"A, {step:g} s", a), _matrix(f"B, {step:g} s, the force held", b)]
    parts += [f"note: {note}" for note in linear.notes]
    return "\n\n".join(parts)


def as_json(linear: LinearModel, step: float | None = None) -> dict[str, Any]:
    """The same as plain data for ``json.dumps``."""
    about = {
        "amplitude": linear.amplitude,
        "frequency_hz": None if linear.omega is None else linear.omega / (2 * math.pi),
        "state": linear.state.tolist(),
        "force": linear.input,
        "output": linear.output.tolist(),
    }
    data: dict[str, Any] = {
        "format": "dashpot-linear/1",
        "about": about,
        **{name: getattr(linear, name).tolist() for name in "ABCD"},
        "states": _named(linear.state_names, linear.state_units),
        "input": {"name": "F", "unit": linear.input_unit},
        "outputs": _named(linear.output_names, linear.output_units),
        "notes": list(linear.notes),
    }
    if step is not None:
        a, b = linear.discrete(step)
        data["discrete"] = {"step_s": step, "hold": "zero", "A": a.tolist(), "B": b.tolist()}
    return data


def _named(names: tuple[str, ...], units: tuple[str, ...]) -> list[dict[str, str]]:
    return [{"name": name, "unit": unit} for name, unit in zip(names, units, strict=True)]


def _about(linear: LinearModel) -> str:
    if linear.amplitude is not None and linear.omega is not None:
        length, hertz = linear.state_units[0], linear.omega / (2 * math.pi)
        return f"about a motion of amplitude {linear.amplitude:g} {length} at {hertz:.6g} Hz"
    at = f"{linear.state[0]:.6g} {linear.state_units[0]}, held by {linear.input:.6g} {linear.input_unit}"
    return f"about the point {at}"


def _matrix(name: str, matrix: np.ndarray) -> str:
    cells = [[f"{value:.9g}" for value in row] for row in matrix]
    width = max(len(cell) for row in cells for cell in row)
    return f"{name} =\n" + "\n".join("  " + "  ".join(cell.rjust(width) for cell in row) for row in cells)
