"""The odds of an effect, in words."""

from __future__ import annotations

import pytest
from dashpot.diagnose.result import SURE, Effect
from dashpot.report.effects import effect_blocks


@pytest.mark.parametrize(
    ("odds", "rivals", "share", "words"),
    [
        (250.0, (), None, "That it is this: 250 to 1 against all that was tried instead."),
        (SURE, (), None, "That it is this: more than 1,000,000 to 1 against all that was tried instead."),
        (40.0, ("cubic-damping",), None, "That it is one of these: 40 to 1 against all that was tried instead."),
        (
            40.0,
            (),
            0.75,
            "That it is this: 40 to 1 against all that was tried instead. It takes 75 % of what is left without it.",
        ),
    ],
)
def test_odds_stand_with_the_effect(odds, rivals, share, words):
    effect = Effect("quadratic-drag", "quadratic-drag", "dissipation", {}, rivals, odds=odds, share=share)
    table = effect_blocks(effect)[0]
    assert ("Odds", words) in table.rows  # type: ignore[union-attr]
