"""Members of Eq. 17 that the recordings do not tell from none."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate_pieces
from dashpot.identify import identify
from dashpot.identify.fit.plainest import at_least, likely_absent
from dashpot.recording.recording import Recording

NAMES = ("omega0", "cubic", "viscous")


def test_what_is_within_its_error_is_absent():
    covariance = np.diag([1e-4, 1e-8, 1e-4])
    absent = likely_absent(NAMES, np.array([10.0, 1e-4, 0.5]), covariance, np.ones(3))
    assert absent is not None
    assert absent.names == ("cubic",)
    # the odds of two normal densities at the estimate, by hand
    assert absent.log_odds == pytest.approx(0.5 * np.log(1 + 1e8) - 0.5 * 1e-8 * (1e8 - 1 / (1 + 1e-8)), rel=1e-9)


def test_what_stands_out_of_its_error_stays():
    assert likely_absent(NAMES, np.array([10.0, 6e-3, 0.5]), np.diag([1e-4, 1e-6, 1e-4]), np.ones(3)) is None


def test_of_members_that_nothing_is_known_of_nothing_is_said():
    covariance = np.full((3, 3), 5e33)  # of two that are found as one, as good as without bound
    assert likely_absent(("omega0", "preload", "dry"), np.array([10.0, 13.4, 0.1]), covariance, np.ones(3)) is None


def test_frequency_and_viscous_damping_are_never_left_out():
    covariance = np.diag([1.0, 1e-6, 1.0])
    absent = likely_absent(NAMES, np.zeros(3), covariance, np.ones(3))
    assert absent is not None
    assert absent.names == ("cubic",)


def test_that_it_may_be_there_is_in_the_errors_of_what_it_moves():
    """The estimate beside it would be nine times as far away, and no better known than the member itself."""
    covariance = np.array([[1e-4, 0.9e-5], [0.9e-5, 1e-6]])
    absent = likely_absent(NAMES[:2], np.array([10.0, 2e-3]), covariance, np.array([1.0, 36.0]))
    assert absent is not None
    there = 1.0 / (1e6 + 36.0**-2)
    mean = there * 1e6 * 2e-3
    likely = 1 / (1 + np.exp(absent.log_odds))
    assert absent.spread[0, 0] == pytest.approx(likely * 81 * (mean**2 + there), rel=1e-4)


def test_what_is_not_decisively_absent_stays():
    covariance = np.array([[1e-4, 0.9e-5], [0.9e-5, 1e-6]])
    assert likely_absent(NAMES[:2], np.array([10.0, 2e-3]), covariance, np.array([1.0, 0.1])) is None


@pytest.fixture(scope="module", params=[0.0, 0.02], ids=["linear", "preload"])
def decay(request):
    rig = {"mass": 1.0, "omega0": 12.0, "cubic": 0.0, "viscous": 0.6, "dry": 0.0}
    rig["preload"] = request.param * rig["omega0"] ** 2
    x = integrate_pieces(rig, np.zeros((600, 1)), 0.01, 1.0, 0.0)[0][:600]
    x = x + 1e-3 * np.random.default_rng(4).standard_normal(600)
    return rig, identify([Recording("decay", 100.0, x)], every=False)


def test_members_that_act_stay_and_the_others_are_zero(decay):
    rig, found = decay
    known = found.oscillator.parameters()
    assert (known["preload"].std is None) is (rig["preload"] == 0.0)
    assert (known["cubic"].value, known["cubic"].std) == (0.0, None)
    for name in set(found.fit.names):
        assert abs(known[name].value - rig[name]) < 3.5 * known[name].std


def test_it_is_said(decay):
    assert any("left at zero" in note for note in decay[1].notes)


def test_a_step_to_one_side_does_not_tell_the_mass_from_a_preload():
    """Both say how far the force moves it, and nothing else; a preload may be a hundredth of the force.

    Under a constant force F on one side of rest, x'' + viscous x' + omega0^2 x = F / m - preload.
    """
    rig = {"mass": 2.0, "omega0": 40.0, "cubic": 0.0, "preload": 0.0, "viscous": 3.0, "dry": 0.0}
    force = np.repeat([0.0, 1.0], [300, 1200])
    x = integrate_pieces(rig, force[:, None], 2e-3, 0.0, 0.0)[0][: force.size]
    x = x + 1e-3 * np.ptp(x) * np.random.default_rng(2).standard_normal(force.size)
    mass = identify([Recording("step", 500.0, x, force)], every=False).oscillator.mass
    assert abs(mass.value - 2.0) < 3.5 * mass.std
    assert 0.002 < mass.std / mass.value < 0.03


def test_errors_are_those_of_the_fit_without_where_these_are_larger():
    """Correlations stay."""
    covariance, own = np.array([[4.0, 1.0], [1.0, 1.0]]), np.array([[1.0, 0.2], [0.2, 9.0]])
    np.testing.assert_allclose(at_least(covariance, own), [[4.0, 3.0], [3.0, 9.0]])
