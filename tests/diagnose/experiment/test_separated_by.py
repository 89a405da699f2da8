"""What would tell an effect from its rivals: said of the effect that it is true of, and of no other."""

from __future__ import annotations

import pytest
from dashpot.diagnose.experiment.separated_by import separated_by
from dashpot.diagnose.result import Experiment
from dashpot.identify.signals.limits import CLEAR_OF_NOISE

PLAN = "Sweep from 5 to 20 Hz with 2 N peak, over 9 s: drag then differs."


def plan(*pairs, kind="sweep", sentence=PLAN):
    return Experiment(sentence, kind, 2.0, (5.0, 20.0), 9.0, pairs, None, 500.0)


def test_an_effect_without_rivals_needs_none():
    assert separated_by("quadratic-drag", (), plan(("quadratic-drag", "cubic-damping", 12.0))) == ""


@pytest.mark.parametrize("turned", [False, True])
def test_the_experiment_is_named_where_it_tells_the_effect_from_a_rival(turned):
    pair = ("cubic-damping", "quadratic-drag") if turned else ("quadratic-drag", "cubic-damping")
    assert separated_by("quadratic-drag", ("cubic-damping",), plan((*pair, 12.0))) == PLAN


def test_it_is_not_named_by_another_effect_of_the_same_diagnosis():
    """The drag's experiment says nothing of a stop that was found before it."""
    said = separated_by("one-sided-stop", ("quintic-stiffness",), plan(("quadratic-drag", "cubic-damping", 12.0)))
    assert PLAN not in said
    assert said == (
        "No experiment was worked out that would tell one-sided-stop from a spring whose stiffness changes with the "
        "fourth power of the displacement (quintic-stiffness)."
    )
    # nor where it tells the effect from something that is none of its rivals
    said = separated_by("one-sided-stop", ("quintic-stiffness",), plan(("one-sided-stop", "clearance", 12.0)))
    assert PLAN not in said


@pytest.mark.parametrize(("times", "tells"), [(0.99 * CLEAR_OF_NOISE, False), (CLEAR_OF_NOISE, True)])
def test_it_tells_from_five_times_the_noise_on(times, tells):
    said = separated_by("quadratic-drag", ("cubic-damping",), plan(("quadratic-drag", "cubic-damping", times)))
    assert (said == PLAN) is tells
    if not tells:
        assert said.startswith("The next experiment does not separate quadratic-drag from damping that grows")
        assert said.endswith("(cubic-damping) (at most 5 times the noise).")


def test_where_no_experiment_does_that_is_said():
    none = plan(("quadratic-drag", "cubic-damping", 1.2), ("quadratic-drag", "stribeck", 0.3), kind="none")
    said = separated_by("quadratic-drag", ("cubic-damping", "stribeck"), none)
    assert said.startswith("No experiment within 1.5 times the recorded levels was found that separates quadratic-drag")
    assert "(cubic-damping) or friction" in said
    assert "at most 1.2 times the noise" in said


def test_what_it_leaves_open_is_said_beside_it():
    pairs = (("quadratic-drag", "cubic-damping", 12.0), ("quadratic-drag", "stribeck", 1.0))
    rivals = ("cubic-damping", "stribeck", "asymmetric-friction")
    said = separated_by("quadratic-drag", rivals, plan(*pairs))
    assert said.startswith(PLAN)
    assert "stribeck" not in said  # the experiment was chosen for this effect: its own sentence says that
    assert said.endswith(
        "would tell quadratic-drag from friction that is larger in one direction (asymmetric-friction)."
    )
    other = separated_by(
        "cubic-damping", ("quadratic-drag", "stribeck"), plan(*pairs, ("cubic-damping", "stribeck", 1.0))
    )
    assert other == f"{PLAN} It does not tell cubic-damping from stribeck."


def test_variants_of_a_rival_count_as_the_nearest_of_them():
    pairs = (("stribeck", "stiffness-drift", 30.0), ("stribeck", "stiffness-drift/settling", 2.0))
    assert separated_by("stribeck", ("stiffness-drift",), plan(*pairs)).startswith("The next experiment does not")
    assert separated_by("stribeck", ("stiffness-drift",), plan(pairs[0])) == PLAN


def test_without_an_experiment_nothing_is_claimed():
    said = separated_by("quadratic-drag", ("cubic-damping",), None)
    assert said.startswith("No experiment was worked out that would tell quadratic-drag from")
