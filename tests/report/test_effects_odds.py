"""The odds of an effect, in words."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from dashpot.diagnose.result import SURE, Diagnosis, Effect
from dashpot.report.effects import effect_blocks, lead_table


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


@pytest.mark.parametrize(("share", "words"), [(0.75, "75 % of what is left without it"), (None, "")])
def test_the_first_table_has_size_share_and_probability(with_law, share, words):
    model = with_law("quadratic-drag")
    given = model.parameters()["quadratic-drag.coefficient"]
    effect = Effect(
        "quadratic-drag", "quadratic-drag", "dissipation", {"coefficient": given}, (), odds=99.0, share=share
    )
    found: Any = SimpleNamespace(model=model, effects=(effect,))
    found.of_machine = lambda effect: Diagnosis.of_machine(found, effect)
    (table,) = lead_table(found)
    row = dict(zip(table.head, table.rows[0], strict=True))
    assert row["It takes"] == words
    assert row["Probability"] == "99 %"
    assert row["Its size"].startswith(f"coefficient {model.mass.value * given.value:.3g}"[:14])
    assert row["Its size"].endswith("N·s²/m²")
