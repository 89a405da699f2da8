"""Elements identified from specimens with known numbers, and the laws that they hide."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.specimens import Specimen, motion, recorded
from dashpot.prescribed.element_fit import diagnose_element, identify_element
from dashpot.recording import Recording

FS = 120.0
MEMBERS = {"inertia": 4.0, "stiffness": 9e3, "viscous": 700.0, "dry": 35.0, "load": 120.0}
HOW = {"noise": 3e-3, "motion_noise": 2e-5}


def recordings(specimen: Specimen, kinds: tuple[str, ...] = ("sweep", "sines")) -> list[Recording]:
    return [
        recorded(specimen, motion(kind, 6e-3 * (1.0 - 0.3 * i), 2.0, FS, 12.0, i), FS, **HOW, seed=i)
        for i, kind in enumerate(kinds)
    ]


def test_members_are_those_of_the_specimen_and_the_others_are_left_at_zero() -> None:
    fit = identify_element(recordings(Specimen(MEMBERS)), name="strut")
    known = fit.element.parameters()
    for name, value in MEMBERS.items():
        std = known[name].std
        assert std is not None
        assert std < 0.02 * value
        assert abs(known[name].value - value) < 3.5 * std
    assert known["cubic"].std is None
    assert known["preload"].std is None
    assert fit.left is None
    assert all(record.over_noise < 1.1 for record in fit.records)
    assert any("left at zero" in note for note in fit.notes)
    assert [entry["kind"] for entry in fit.element.identified.recordings] == ["prescribed", "prescribed"]


def test_errors_cover_the_truth_over_many_draws() -> None:
    specimen, off = Specimen(MEMBERS), []
    x = motion("sines", 6e-3, 2.0, FS, 12.0)
    for seed in range(20):
        known = identify_element([recorded(specimen, x, FS, **HOW, seed=seed)]).element.parameters()
        off += [
            (known[name].value - value) / std for name, value in MEMBERS.items() if (std := known[name].std) is not None
        ]
    assert np.mean(np.abs(off) < 2.0) > 0.88
    assert np.max(np.abs(off)) < 4.5


def test_load_cells_that_are_set_to_zero_anew_are_noted() -> None:
    one, other = recordings(Specimen(MEMBERS))
    moved = Recording(other.name, FS, other.response, np.asarray(other.force) + 30.0, prescribed=True)
    fit = identify_element([one, moved])
    assert any("differs between the recordings" in note for note in fit.notes)
    assert fit.element.parameters()["load"].value == pytest.approx(135.0, abs=2.0)
    assert fit.element.parameters()["viscous"].value == pytest.approx(700.0, rel=0.02)


def test_a_stroke_that_is_counted_from_an_end_has_its_origin_in_the_middle() -> None:
    x = motion("sines", 6e-3, 2.0, FS, 12.0)
    made = recorded(Specimen(MEMBERS | {"cubic": 2e8}), x, FS, **HOW)
    aside = Recording("aside", FS, np.asarray(made.response) + 50e-3, made.force, prescribed=True)
    element = identify_element([aside], every=True).element
    assert element.origin == pytest.approx(50e-3, abs=1e-4)
    cubic = element.parameters()["cubic"]
    assert cubic.std is not None
    assert abs(cubic.value - 2e8) < 4.0 * cubic.std


HIDDEN = {
    "hysteresis": {"stiffness": 4e5, "limit": 2e-4, "exponent": 1.0, "loading": 0.5},
    "stribeck": {"excess": 40.0, "speed": 5e-3, "exponent": 1.0},
    "quadratic-drag": {"coefficient": 1.5e4},
    "two-sided-stop": {"stiffness": 8e4, "position": 3.5e-3},
    "digressive-damping": {"force": 60.0, "speed": 8e-3},
    "viscoelastic": {"stiffness": 2e4, "rate": 20.0},
}


@pytest.mark.parametrize("law", HIDDEN)
def test_a_hidden_law_is_named_and_its_numbers_hold(law: str) -> None:
    one, other, held = recordings(Specimen(MEMBERS, law, HIDDEN[law]), ("sweep", "sines", "random"))
    found = diagnose_element([one, other], [held])
    assert [named.law.name for named in found.found.named] == [law]
    assert found.after is not None
    assert max(record.over_noise for record in found.after.records) < 1.5
    assert max(record.nrmse for record in found.held_after) < 0.5 * max(record.nrmse for record in found.held_before)
    known = found.after.element.parameters()
    for name, value in HIDDEN[law].items():
        p = known[f"{law}.{name}"]
        if p.std:
            assert abs(p.value - value) < max(4.5 * p.std, 0.05 * abs(value)), name


def test_nothing_is_named_where_nothing_is_hidden() -> None:
    for seed in range(4):
        x = motion("sweep", 6e-3, 2.0, FS, 12.0)
        found = diagnose_element([recorded(Specimen(MEMBERS), x, FS, **HOW, seed=seed)])
        assert found.after is None
        assert found.in_pieces


def test_a_law_that_is_asked_for_is_fitted() -> None:
    fit = identify_element(
        recordings(Specimen(MEMBERS, "quadratic-drag", HIDDEN["quadratic-drag"])), laws=["quadratic-drag"]
    )
    drag = fit.element.parameters()["quadratic-drag.coefficient"]
    assert drag.unit == "N.s2/m2"
    assert drag.std is not None
    assert abs(drag.value - 1.5e4) < 4.0 * drag.std


def test_what_does_not_belong_together_is_refused() -> None:
    one, _ = recordings(Specimen(MEMBERS))
    with pytest.raises(BadInput, match="given twice"):
        identify_element([one, one])
    with pytest.raises(BadInput, match="nobody says that its motion was prescribed"):
        identify_element([Recording("r", FS, one.response, one.force)])
    with pytest.raises(BadInput, match="is no force"):
        identify_element([one], laws=["sensor-lag"])
    with pytest.raises(BadInput, match="no recording was given"):
        identify_element([])
    other = Recording("volts", FS, np.asarray(one.response) * 2.0, one.force, force_unit="V", prescribed=True)
    with pytest.raises(BadInput, match="different units"):
        identify_element([one, other])


def test_a_search_without_time_says_what_it_did_not_try() -> None:
    one, _ = recordings(Specimen(MEMBERS, "quadratic-drag", HIDDEN["quadratic-drag"]))
    found = diagnose_element([one], seconds=1e-9)
    assert found.after is None
    assert found.found.untried


def test_progress_never_falls() -> None:
    said: list[float] = []
    one, other = recordings(Specimen(MEMBERS, "quadratic-drag", HIDDEN["quadratic-drag"]))
    diagnose_element([one], [other], progress=lambda _what, part: said.append(part))
    assert np.all(np.diff(said) >= 0.0)
    assert said[-1] == 1.0


def test_what_runs_away_along_a_held_out_motion_has_no_odds() -> None:
    from dataclasses import replace

    from dashpot.prescribed.fit import Problem, Shape
    from dashpot.prescribed.judge import Judge, probability
    from dashpot.prescribed.motion import imposed

    one, other = (imposed(recording) for recording in recordings(Specimen(MEMBERS)))
    problem = Problem([one], [other], 0.0)
    fitted = problem.fit(Shape(), {})
    assert fitted is not None
    kept = problem.weighed(fitted)
    lost = replace(kept, held=(np.full(other.n, np.inf),))
    judge = Judge(problem)
    assert np.all(judge.odds(kept, lost, 5) > 1e3)
    assert np.all(judge.odds(lost, kept, 5) < -1e3)
    assert probability([np.zeros(6), judge.odds(lost, kept, 5)]) == pytest.approx([1.0, 0.0])
