"""The laws fitted to curves: what a fit says where a law has nothing to fit."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.identify.hilbert.modal_fit import _Fit
from dashpot.identify.hilbert.modal_mass import MassFit


def test_a_parameter_that_changes_nothing_is_said_and_ends_in_no_singular_matrix():
    """As a preload far beyond the amplitudes of the motion: its derivative is zero to the last digit."""
    ones = np.ones(50)
    noise = SimpleNamespace(weigh=lambda values: values, count=50)

    def curve(second: np.ndarray) -> Any:
        columns = np.stack([ones, second])
        return SimpleNamespace(noise=noise, plain=columns, columns=columns, target=2.0 * ones)

    mass = MassFit(rows=(np.zeros(0),))
    assert _Fit((curve(np.linspace(0.0, 1.0, 50)),), mass).value == pytest.approx([2.0, 0.0])
    with pytest.raises(BadInput, match="does nothing at the amplitudes"):
        _Fit((curve(0.0 * ones),), mass)
