"""A driven stretch that begins while the rig still rings, and one that does not."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.force import chirp
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.identify.hilbert.frequency_of_the_ringing import rung_in
from dashpot.identify.hilbert.modal_fit import spring_and_friction
from dashpot.identify.hilbert.modal_mass import mass_fit
from dashpot.identify.hilbert.modal_stretch import Stretch, forced_stretch
from dashpot.identify.signals.signals import Signal

FS, N = 500.0, 40_000


@pytest.fixture(scope="module")
def stretches() -> tuple[Stretch, Stretch]:
    """The whole of a sweep from rest, and what of it begins when the ringing has long died."""
    pieces = chirp(1.0, 5.0, 15 / 80, np.arange(N) / FS, 1 / FS)
    noise = np.random.default_rng(7)
    x = integrate_pieces(TRUTH, pieces[:-1], 1 / FS)[0][:N] + 1e-6 * noise.standard_normal(N)
    force = pieces[:, 0] + 1e-3 * noise.standard_normal(N)
    return tuple(forced_stretch(Signal(x[a:], FS), Signal(force[a:], FS)) for a in (0, 2500))  # type: ignore[return-value]


def test_the_ringing_is_left_out_and_no_more(stretches: tuple[Stretch, Stretch]):
    whole, later = (rung_in(stretch, mass_fit) for stretch in stretches)
    # exp(-2.5 t) is a thousandth, the noise beside the motion, after 2.8 s
    assert 1.5 < whole.rung_in / FS < 4.0
    assert later.rung_in / FS < 0.5  # one window at most, which noise alone leaves out once in 400


def test_what_is_left_is_noise(stretches: tuple[Stretch, Stretch]):
    whole = stretches[0]
    before, after = (
        spring_and_friction([stretch], mass_fit(stretch))[0].misfit for stretch in (whole, rung_in(whole, mass_fit))
    )
    assert before > 3.0
    assert after < 1.3
