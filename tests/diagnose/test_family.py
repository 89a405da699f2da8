"""What laws are held against: the family at its best, whatever the model file says; by the reference integrator."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from dashpot.diagnose.family import _agree, cut_for, family_of, less_offsets, stranger
from dashpot.diagnose.measuring_chain import zeros
from dashpot.diagnose.search.residual_test import leftovers
from dashpot.diagnose.search.search import Search
from dashpot.diagnose.search.weigh import judged as judged_by
from dashpot.errors import BadInput
from dashpot.examples.force import chirp
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.identify import climb
from dashpot.identify.offset import FoundOffset
from dashpot.identify.signals import response_of
from dashpot.model import Oscillator, Provenance
from dashpot.recording import Recording

FS, NOISE = 500.0, 2e-6
MODEL = Oscillator.from_values(TRUTH)


@cache
def motion(values, level, seconds, x0=0.0):
    """Displacement and force (n,), by Taylor series under a force that is smooth between its samples."""
    t = np.arange(round(seconds * FS)) / FS
    pieces = chirp(level, 5.0, 15.0 / seconds, t, 1 / FS) if level else np.zeros((t.size, 1))
    return integrate_pieces(dict(values), pieces[:-1], 1 / FS, x0)[0], pieces[:, 0] if level else None


def record(name, level, seconds, x0=0.0, offset=0.0, **changed):
    x, force = motion(tuple((TRUTH | changed).items()), level, seconds, x0)
    noise = NOISE * np.random.default_rng(len(name)).standard_normal(x.size)
    return Recording(name, FS, x + noise + offset, force, hold=None if force is None else "smooth")


def training(*offsets, **changed):
    decay, sweep = (*offsets, 0.0, 0.0)[:2]
    return [
        record("decay", None, 2.5, 8e-3, decay, **changed),
        record("sweep", 1.0, 8.0, offset=sweep, **changed),
    ]


def held(offset=0.0, **changed):
    return [record("held out", 0.6, 6.0, offset=offset, **changed)]


def scaled(factor, part, names=TRUTH):
    """The true model with values that many times off, which it claims to know to that part."""
    known = MODEL.parameters()
    return MODEL.with_parameters(
        {
            name: replace(p, value=p.value * factor, std=None if part is None else part * factor * abs(p.value))
            for name, p in known.items()
            if name in names
        }
    )


def is_the_rig(model):
    rel = {"mass": 1e-3, "omega0": 1e-4, "viscous": 1e-3, "cubic": 0.05, "preload": 0.02, "dry": 0.05}
    return all(model.parameters()[n].value == pytest.approx(TRUTH[n], rel=r) for n, r in rel.items())


def test_the_rigs_own_model_is_found_and_nothing_is_said():
    family = family_of(MODEL, training(), held())
    assert is_the_rig(family.model)
    assert family.memory == np.inf
    assert not family.free_zeros
    assert family.notes == ()
    assert [r.name for r in (*family.recordings, *family.holdout)] == ["decay", "sweep", "held out"]


def test_a_useless_model_file_is_left_aside_and_said_to_be():
    family = family_of(scaled(100.0, 100.0), training(), held())
    assert is_the_rig(family.model)
    assert sum("were found anew" in note for note in family.notes) == 1


def test_values_that_only_lie_off_lead_there_by_themselves():
    family = family_of(scaled(1.25, 0.5), training(), held())
    assert is_the_rig(family.model)
    assert family.notes == ()


@pytest.mark.parametrize("names", [("omega0",), ("mass",)])
def test_another_rig_is_refused_with_both_their_figures(names):
    """30 % of a frequency, twice a mass: more than a change of temperature or a screw does."""
    factor = 1.35 if names == ("omega0",) else 2.1
    with pytest.raises(BadInput, match=r"not of the model's rig: they show 12\.67 Hz and 0\.27 kg, the model has"):
        family_of(scaled(factor, 1e-3, names), training(), held())


@pytest.mark.parametrize(("names", "factor"), [(("omega0",), 100.0), (("mass",), 0.01)])
def test_a_file_that_states_no_errors_claims_no_rig(names, factor):
    """Written by hand, a hundred times off: the recordings answer, and it is said."""
    family = family_of(scaled(factor, None, names), training(), held())
    assert is_the_rig(family.model)
    assert any("far from the model file" in note and "12.67 Hz and 0.27 kg" in note for note in family.notes)


def test_a_mass_that_was_kept_while_the_rest_was_identified_is_known():
    """It was weighed, and has no standard error for that."""
    identified = Provenance(recordings=({"file": "decay"},), parameters=("omega0", "viscous"))
    model = replace(scaled(2.1, None, ("mass",)), identified=identified)
    with pytest.raises(BadInput, match="not of the model's rig"):
        family_of(model, training(), held())


@pytest.mark.parametrize("names", [("omega0",), ("mass",)])
def test_the_same_rig_is_not(names):
    factor = 1.25 if names == ("omega0",) else 1.9
    assert is_the_rig(family_of(scaled(factor, 1e-3, names), training(), held()).model)


@pytest.mark.parametrize(("part", "refused"), [(0.09, True), (0.11, False)])
def test_only_a_model_that_knows_its_rig_can_tell_that_it_is_another(part, refused):
    model = scaled(1.35, part, ("omega0",))
    if refused:
        with pytest.raises(BadInput, match="not of the model's rig"):
            family_of(model, training(), held())
    else:
        assert is_the_rig(family_of(model, training(), held()).model)


def test_zeros_that_differ_are_the_sensors_and_are_taken_off():
    family = family_of(MODEL, training(3e-3, -2e-3), held(5e-3))
    assert is_the_rig(family.model)
    assert family.free_zeros
    for recording in family.recordings[1:]:
        assert float(np.mean(recording.response)) == pytest.approx(0.0, abs=1e-4)
    taken = [r.response - s.response for r, s in zip([*training(3e-3, -2e-3), *held(5e-3)], _all(family), strict=True)]
    assert [float(np.ptp(t)) for t in taken] == pytest.approx([0.0] * 3, abs=1e-15)
    assert [float(t[0]) for t in taken] == pytest.approx([3e-3, -2e-3, 5e-3], abs=1e-6)
    assert [fact.sentence.split(";")[0] for fact in zeros(family.holdout, family.shown_elsewhere)] == [
        "held out: its sensor shows 5 mm at zero",
    ]
    data = cut_for(family, family.recordings, family.model)
    assert [(o.recording, o.channel) for o in data.offsets] == [(0, "response"), (1, "response")]
    less, facts = less_offsets(family.recordings, family.shown, data, np.array([1e-3, 0.0]))
    assert [fact.sentence.split(";")[0] for fact in facts] == [
        "decay: its sensor shows 4 mm at zero",
        "sweep: its sensor shows -2 mm at zero",
    ]
    taken = [a.response - b.response for a, b in zip(family.recordings, less, strict=True)]
    assert [float(np.max(np.abs(t - t[0]))) for t in taken] == pytest.approx([0.0] * 2, abs=1e-15)
    assert [float(t[0]) for t in taken] == pytest.approx([1e-3, 0.0], abs=1e-12)


@pytest.mark.parametrize(("times", "said"), [(0.9, False), (1.1, True)])
def test_a_zero_is_told_of_where_it_exceeds_the_noise(times, said):
    assert bool(zeros(training()[:1], {0: times * response_of(training()[0]).noise})) == said


def test_one_zero_in_all_recordings_is_left_to_the_laws():
    """A load, a sensor that sits elsewhere: a constant force or an offset that the model itself may have."""
    given = training(3e-3, 3e-3)
    family = family_of(MODEL, given, held(3e-3))
    assert not family.free_zeros
    assert all(np.array_equal(a.response, b.response) for a, b in zip(family.recordings, given, strict=True))
    assert not family.shown
    assert cut_for(family, family.recordings, family.model).offsets == ()


def test_of_a_single_recording_it_is_taken_off():
    """Nothing but the motion says what is its zero."""
    family = family_of(MODEL, training(3e-3)[:1], held(1e-3))
    assert family.free_zeros
    assert float(np.mean(family.recordings[0].response[-200:])) == pytest.approx(0.0, abs=1e-5)
    assert zeros(family.recordings, family.shown)
    assert zeros(family.holdout, family.shown_elsewhere)


def _all(family):
    return (*family.recordings, *family.holdout)


@pytest.mark.parametrize("known", [True, False])
def test_a_model_identified_from_these_recordings_is_gone_on_with(monkeypatch, known):
    """Nothing has to lead to where it is: the way from prediction to simulation is not gone again."""
    given = [replace(recording, sha256=f"{i}") for i, recording in enumerate(training())]
    provenance = Provenance(recordings=({"file": "a", "sha256": "0"}, {"file": "b", "sha256": "1"}))
    model = replace(MODEL, identified=provenance if known else Provenance())
    gone, real = [], climb.from_prediction
    monkeypatch.setattr(climb, "from_prediction", lambda *given: gone.append(1) or real(*given))
    family = family_of(model, given, [])
    assert bool(gone) is not known
    assert is_the_rig(family.model)


def test_a_model_identified_from_these_recordings_is_never_of_another_rig():
    """Whatever the fit then makes of them: a file that is refused on its own recordings helps nobody."""
    given = [replace(recording, sha256=f"{i}") for i, recording in enumerate(training())]
    provenance = Provenance(recordings=({"file": "a", "sha256": "0"}, {"file": "b", "sha256": "1"}))
    model = replace(scaled(1.35, 1e-3, ("omega0",)), identified=provenance)
    assert family_of(model, given, []).notes == ()


@pytest.mark.parametrize(("apart", "one_cause"), [(7.9, True), (8.1, False)])
def test_zeros_within_four_errors_of_their_mean_have_one_cause(apart, one_cause):
    zeros_found = [FoundOffset(i, "response", value, 1.0) for i, value in enumerate((5.0, 5.0 + apart))]
    assert _agree(zeros_found, 2) is one_cause
    assert not _agree(zeros_found, 3)  # a recording without one has none


# --- held out, of another rig


def told_apart(*, told_training=None, told_elsewhere=None, **changed):
    """What ``stranger`` says where the held-out recording is of a rig with some values changed.

    The times of the noise that are left in training and in held-out recordings may be given.
    """
    family = family_of(MODEL, training(), held(**changed))
    data, judged = (cut_for(family, group, MODEL) for group in (family.recordings, family.holdout))
    search = Search(data, judged)
    final = search.best_of_family(family.model)
    here, there = leftovers(final, data), leftovers(judged_by(final.model, judged), judged)
    left = [replace(stretch, ratio=told_training or stretch.ratio) for stretch in here]
    left += [replace(stretch, ratio=told_elsewhere or stretch.ratio) for stretch in there]
    return stranger(final, search, left, len(data.segments))


@pytest.mark.parametrize(
    ("told_training", "told_elsewhere", "another"), [(1.49, 2.26, True), (1.51, 2.26, False), (1.49, 2.24, False)]
)
def test_of_another_rig_is_what_is_told_badly_where_the_rest_is_told_well(told_training, told_elsewhere, another):
    said = told_apart(told_training=told_training, told_elsewhere=told_elsewhere, omega0=1.02 * TRUTH["omega0"])
    assert (said is not None) is another


def test_a_held_out_recording_of_another_rig_is_told():
    said = told_apart(omega0=1.02 * TRUTH["omega0"])
    assert "held out" in said
    assert "12.92 Hz instead of 12.67 Hz" in said


@pytest.mark.parametrize("changed", [{}, {"omega0": 1.0000001 * TRUTH["omega0"]}])
def test_a_held_out_recording_of_the_same_rig_is_not(changed):
    assert told_apart(**changed) is None


def test_friction_that_differs_makes_no_other_rig():
    """Frequency and mass are what a rig keeps."""
    assert told_apart(viscous=1.3 * TRUTH["viscous"]) is None
