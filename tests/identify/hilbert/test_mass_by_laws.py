"""FORCEVIB's mass where smooth functions of the amplitude do not tell it."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.force import chirp
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.identify import hilbert_analysis
from dashpot.identify.hilbert.mass_by_laws import driven_mass, mass_beside_harmonics, rung_in
from dashpot.identify.hilbert.modal_fit import spring_and_friction
from dashpot.identify.hilbert.modal_mass import mass_fit
from dashpot.identify.hilbert.modal_stretch import Stretch, forced_stretch
from dashpot.identify.signals.signals import Signal
from dashpot.recording import Recording

FS = 1000.0


def swept(
    first: float, last: float, seconds: float, seed: int = 1, values: dict[str, float] = TRUTH
) -> tuple[np.ndarray, np.ndarray]:
    """Displacement and force of the built-in stand, or one of these values, from rest, with the stand's noises."""
    n = round(seconds * FS)
    pieces = chirp(1.0, first, (last - first) / seconds, np.arange(n) / FS, 1 / FS)
    noise = np.random.default_rng(seed)
    x = integrate_pieces(values, pieces[:-1], 1 / FS)[0][:n] + 1e-6 * noise.standard_normal(n)
    return x, pieces[:, 0] + 1e-3 * noise.standard_normal(n)


def stretch_of(x: np.ndarray, force: np.ndarray) -> Stretch:
    return forced_stretch(Signal(x, FS), Signal(force, FS))


def test_below_the_resonance_the_laws_tell_the_mass():
    whole = stretch_of(*swept(5.0, 12.0, 24.0))
    alone, found = mass_fit(whole), driven_mass(whole)
    assert abs(1 / alone.inverse - TRUTH["mass"]) > 5 * alone.std / alone.inverse**2  # confident, and wrong
    assert found.by_laws
    assert found.hold
    assert abs(found.mass.inverse - 1 / TRUTH["mass"]) < 3 * found.mass.std
    assert found.mass.std < 0.02 / TRUTH["mass"]


def test_through_the_resonance_no_law_is_asked_for():
    found = driven_mass(stretch_of(*swept(7.0, 18.0, 15.0)))
    assert (found.by_laws, found.hold) == (False, True)
    assert abs(found.mass.inverse - 1 / TRUTH["mass"]) < 3 * found.mass.std


def test_friction_and_preload_do_not_bend_the_mass():
    """Their harmonics meet the rig differently below and above its resonance, where the amplitude is the same."""
    rough = {**TRUTH, "dry": 0.2, "preload": 0.2}
    for seed in (1, 2):
        stretch = stretch_of(*swept(7.0, 18.0, 12.0, seed, rough))
        alone, beside = mass_fit(stretch), mass_beside_harmonics(stretch)
        assert abs(alone.inverse * TRUTH["mass"] - 1) > 5 * alone.std * TRUTH["mass"]
        assert abs(beside.inverse * TRUTH["mass"] - 1) < 3 * beside.std * TRUTH["mass"]
        assert beside.std < 2 * alone.std


def test_far_below_it_the_mass_is_told_with_a_large_error_or_not_at_all():
    said = []
    for seed in (1, 2):
        try:
            mass = driven_mass(stretch_of(*swept(5.0, 9.5, 24.0, seed))).mass
        except BadInput as problem:
            said.append("drive it through the resonance" in str(problem))
        else:
            said.append(0.05 / TRUTH["mass"] < mass.std > abs(mass.inverse - 1 / TRUTH["mass"]) / 3)
    assert all(said)


@pytest.mark.parametrize("seconds", [2.0, 6.0])
def test_a_sweep_that_leaves_the_rig_ringing_says_so_and_how_fast_it_may_be(seconds: float):
    x, force = swept(5.0, 20.0, seconds)
    analysis = hilbert_analysis([Recording("fast", FS, x, force)])
    fit = analysis.forcevib
    assert fit is not None
    assert fit.misfit > 4
    assert any("sweep no faster than 2." in note for note in analysis.notes)  # 2.5² / pi Hz/s
    assert not fit.has_errors
    assert all(np.isinf(std) for std in (*fit.stds.values(), *fit.derived_std.values()))
    assert abs(fit.values["mass"] / TRUTH["mass"] - 1) < 1e-3


def test_a_sweep_as_slow_as_that_is_followed():
    x, force = swept(5.0, 20.0, 12.0)
    analysis = hilbert_analysis([Recording("slow", FS, x, force)])
    assert analysis.notes == ()
    assert analysis.forcevib is not None
    assert analysis.forcevib.misfit < 1.3


# A driven stretch that begins while the rig still rings, and one that does not.

RATE, SAMPLES = 500.0, 40_000


@pytest.fixture(scope="module")
def stretches() -> tuple[Stretch, Stretch]:
    """The whole of a sweep from rest, and what of it begins when the ringing has long died."""
    pieces = chirp(1.0, 5.0, 15 / 80, np.arange(SAMPLES) / RATE, 1 / RATE)
    noise = np.random.default_rng(7)
    x = integrate_pieces(TRUTH, pieces[:-1], 1 / RATE)[0][:SAMPLES] + 1e-6 * noise.standard_normal(SAMPLES)
    force = pieces[:, 0] + 1e-3 * noise.standard_normal(SAMPLES)
    return tuple(forced_stretch(Signal(x[a:], RATE), Signal(force[a:], RATE)) for a in (0, 2500))  # type: ignore[return-value]


def test_the_ringing_is_left_out_and_no_more(stretches: tuple[Stretch, Stretch]):
    whole, later = (rung_in(stretch, mass_fit) for stretch in stretches)
    # exp(-2.5 t) is a thousandth, the noise beside the motion, after 2.8 s
    assert 1.5 < whole.rung_in / RATE < 4.0
    assert later.rung_in / RATE < 0.5  # one window at most, which noise alone leaves out once in a thousand


def test_what_is_left_is_noise(stretches: tuple[Stretch, Stretch]):
    whole = stretches[0]
    before, after = (
        spring_and_friction([stretch], mass_fit(stretch))[0].misfit for stretch in (whole, rung_in(whole, mass_fit))
    )
    assert before > 2.0  # how much more depends on how the harmonics, which run wild there, are drawn between instants
    assert after < 1.3
