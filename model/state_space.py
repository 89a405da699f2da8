"""A linear model as other packages have it, when somebody asks: scipy's and python-control's state spaces.

Both are loaded by their names: no command needs them, and one need not be there.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from ..errors import BadInput

if TYPE_CHECKING:
    from .linear import LinearModel


def of_scipy(linear: LinearModel) -> Any:
    """A ``scipy.signal.StateSpace``."""
    return import_module("scipy.signal").StateSpace(linear.A, linear.B, linear.C, linear.D)


def of_control(linear: LinearModel) -> Any:
    """A ``control.StateSpace`` with the names of states, input and outputs; raises BadInput without python-control."""
    try:
        control = import_module("control")
    except ImportError:
        raise BadInput(
            "to_control needs the package control (python-control), which is not installed; pip install control, or "
            "take to_scipy()"
        ) from None
    names = {"states": list(linear.state_names), "inputs": ["F"], "outputs": list(linear.output_names)}
    return control.ss(linear.A, linear.B, linear.C, linear.D, **names)
