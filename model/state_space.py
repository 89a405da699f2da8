"""A linear model as other packages have it, when somebody asks: scipy's and python-control's state spaces."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..errors import BadInput

if TYPE_CHECKING:
    from .linear import LinearModel


def of_scipy(linear: LinearModel) -> Any:
    """A ``scipy.signal.StateSpace``."""
    from scipy.signal import StateSpace

    return StateSpace(linear.A, linear.B, linear.C, linear.D)


def of_control(linear: LinearModel) -> Any:
    """A ``control.StateSpace`` with the names of states, input and outputs; raises BadInput without python-control."""
    try:
        import control
    except ImportError:
        raise BadInput(
            "to_control needs the package control (python-control), which is not installed; pip install control, or "
            "take to_scipy()"
        ) from None
    names = {"states": list(linear.state_names), "inputs": ["F"], "outputs": list(linear.output_names)}
    return control.ss(linear.A, linear.B, linear.C, linear.D, **names)
