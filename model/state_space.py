"""A linear model as other packages have it, when somebody asks: scipy's and python-control's state spaces.

Both are loaded by their names: no command needs them, and one need not be there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any

import numpy as np

from ..errors import BadInput


def of_scipy(matrices: Sequence[np.ndarray]) -> Any:
    """A ``scipy.signal.StateSpace`` of A, B, C, D."""
    return import_module("scipy.signal").StateSpace(*matrices)


def of_control(matrices: Sequence[np.ndarray], names: Mapping[str, list[str]]) -> Any:
    """A ``control.StateSpace`` of A, B, C, D with names of ``states``, ``inputs`` and ``outputs``.

    Raises BadInput where python-control is not installed.
    """
    try:
        control = import_module("control")
    except ImportError:
        raise BadInput(
            "to_control needs the package control (python-control), which is not installed; pip install control, or "
            "take to_scipy()"
        ) from None
    return control.ss(*matrices, **names)
