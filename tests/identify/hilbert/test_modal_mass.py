"""FORCEVIB's mass where the noise of force and motion is loud."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.rig import FORCE_NOISE, FS, SENSOR_NOISE, force, paper_stand
from dashpot.examples.truth import TRUTH
from dashpot.identify.hilbert.mass_by_laws import driven_mass
from dashpot.identify.hilbert.modal_mass import MassFit, agreed, mass_fit
from dashpot.identify.hilbert.modal_stretch import Stretch, forced_stretch
from dashpot.identify.signals.signals import Signal

DRIVEN, EACH = 1500, 5000


def bursts(times: float, seed: int) -> list[Stretch]:
    pieces = force("bursts")
    noise = np.random.default_rng(seed)
    x = paper_stand(pieces) + times * SENSOR_NOISE * noise.standard_normal(len(pieces))
    f = pieces[:, 0] + times * FORCE_NOISE * 1.15 * noise.standard_normal(len(pieces))
    parts = [slice(a, a + DRIVEN) for a in range(0, len(pieces), EACH)]
    return [forced_stretch(Signal(x[part], FS), Signal(f[part], FS)) for part in parts]


def test_a_loud_force_does_not_bend_it():
    masses = [mass_fit(stretch) for seed in range(6) for stretch in bursts(30, seed)]
    off = np.array([(mass.inverse * TRUTH["mass"] - 1) / (mass.std * TRUTH["mass"]) for mass in masses])
    # of what the columns share of the noise nothing taken off: -0.8
    assert abs(np.mean(off)) < 3 / np.sqrt(off.size)
    assert 0.7 < np.sqrt(np.mean(off**2)) < 1.3


def test_what_the_noise_hides_is_not_told():
    for stretch in bursts(400, 0):
        with pytest.raises(BadInput, match=r"hides the mass|hardly tells the mass|no positive mass|too little motion"):
            driven_mass(stretch)


def test_stretches_are_weighed_by_their_errors_at_one_mass():
    # by the force's noise alone a stretch whose 1/m comes out larger states an error that is as much larger
    row = (np.zeros(1),)
    both = agreed([MassFit(0.8, 0.08, 0.08, row), MassFit(1.2, 0.12, 0.12, row)])
    assert both.inverse == pytest.approx(1.0)
    assert both.std == pytest.approx(0.1 / np.sqrt(2))
    apart = agreed([MassFit(1.0, 0.1, 0.0, row), MassFit(1.2, 0.2, 0.0, row)])
    assert apart.inverse == pytest.approx((1.0 * 4 + 1.2) / 5)
