"""A recording of another rig is named where it agrees with a model of its own, and the others with theirs."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.lies import STANDS
from dashpot.identify.faults.stranger_among import KEPT, difference_in_words, of_one_rig, stranger_among
from dashpot.identify.fit.likelihood import maximum_likelihood
from dashpot.model import Oscillator

STAND = replace(STANDS["built-in"], cycles=60.0, fs=400.0)


@cache
def clean(higher):
    return STAND.clean(omega0=(1.0 + higher) * STAND.values["omega0"])


@cache
def records(higher, record=2):
    """A decay and two sweeps, one of them of a rig whose natural frequency is higher by that part."""
    return tuple(STAND.noisy([clean(higher if i == record else 0.0)[i] for i in range(3)]))


def fitted(recordings):
    """Eq. 17 of some of them, from near the truth: how a search finds it is not asked here."""
    return maximum_likelihood(Oscillator.from_values(dict(STAND.values)), recordings, doubted=False, near=True)


@pytest.mark.parametrize(("kept", "named"), [(1.5, True), (0.6, False)])
def test_another_rig_is_one_whose_frequency_no_lab_would_have_moved(kept, named):
    # both are known to a hundredth of that
    found = stranger_among(records(kept * KEPT), fitted)
    assert (found is not None) == named
    if found is not None:
        place, words = found
        assert place == 2
        assert words.startswith(
            "it agrees with one rig, 12.69 Hz, all others with another, 12.67 Hz, each to its noise"
        )


def test_any_of_them_may_be_the_stranger():
    place, _ = stranger_among(records(0.05, 0), fitted)
    assert place == 0


def test_two_that_disagree_do_not_say_which_is_the_stranger():
    assert stranger_among(records(0.05)[1:], fitted) is None


@pytest.mark.parametrize("poor", [1, 2], ids=["the others", "its own"])
def test_it_is_named_where_both_models_leave_no_more_than_noise(poor):
    def leaving(ratio):
        def of(recordings):
            fit = fitted(recordings)
            left = ratio if len(recordings) == (2 if poor == 1 else 1) else 1.0
            return replace(fit, segments=tuple(replace(s, over_noise=left) for s in fit.segments))

        return of

    assert stranger_among(records(0.05), leaving(1.09)) is not None
    assert stranger_among(records(0.05), leaving(1.11)) is None


def test_a_frequency_that_is_hardly_known_names_nothing():
    def unsure(recordings):
        fit = fitted(recordings)
        omega0 = fit.oscillator.omega0
        return replace(
            fit, oscillator=fit.oscillator.with_parameters({"omega0": replace(omega0, std=0.02 * omega0.value)})
        )

    assert stranger_among(records(0.05), fitted) is not None
    assert stranger_among(records(0.05), unsure) is None  # 1.7 errors apart


def test_where_the_others_move_as_far_friction_alone_makes_another_rig():
    rough = STAND.clean(viscous=1.3 * STAND.values["viscous"])
    lying = STAND.noisy([clean(0.0)[0], rough[1], clean(0.0)[2]])
    own = of_one_rig([lying[1]], fitted)
    assert difference_in_words(1, own, lying, fitted) is None  # what the family lacks might do that
    words = difference_in_words(1, own, lying, fitted, alike=True)
    assert words.startswith("it agrees with one rig, viscous 6.5")
    assert "1/s, all others with another, viscous" in words
    honest = records(0.0)
    assert difference_in_words(1, of_one_rig([honest[1]], fitted), honest, fitted, alike=True) is None


def test_where_nothing_fits_nothing_is_named():
    def refused(recordings):
        raise BadInput("nothing to fit")

    assert stranger_among(records(0.05), refused) is None
    silent = [*records(0.05)[:2], replace(records(0.05)[2], response=np.zeros(records(0.05)[2].n))]
    assert stranger_among(silent, fitted) is None
