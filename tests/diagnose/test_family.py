"""What laws are held against: the family at its best, whatever the model file says; by the reference integrator."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose import family as module
from dashpot.diagnose.family import (
    Family,
    _drifts,
    _is_known,
    _same_rig,
    _without_drift_and_force,
    cut_for,
    family_of,
    first_fit,
    less_offsets,
    stranger,
)
from dashpot.diagnose.measuring_chain import zeros
from dashpot.errors import BadInput
from dashpot.examples.force import chirp
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.identify.fit import climb
from dashpot.identify.problem.offset import FoundOffset
from dashpot.identify.problem.structure import Structure
from dashpot.identify.signals.signals import response_of
from dashpot.model import Oscillator, Provenance, oscillator_with
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
    family = family_of(MODEL, training(), [replace(record, hold=None) for record in held()])
    assert is_the_rig(family.model)
    assert family.memory == np.inf
    assert not family.free_zeros
    assert (family.notes, family.chain) == ((), ())
    assert family.holdout[0].hold is None  # nothing was found of it
    assert [r.name for r in (*family.recordings, *family.holdout)] == ["decay", "sweep", "held out"]


def test_a_useless_model_file_is_left_aside_and_said_to_be():
    family = family_of(scaled(1e4, 100.0), training(), held())
    assert is_the_rig(family.model)
    assert sum("were found anew" in note for note in family.notes) == 1


@pytest.mark.parametrize(("effects", "times"), [((), 1), (("quadratic-drag",), 2)])
def test_what_lacks_something_is_identified_once_and_its_laws_are_begun_anew(monkeypatch, effects, times):
    """Where the file's values explain little, one search begins at the recordings' own too."""
    asked, real = [], module.identify
    monkeypatch.setattr(module, "identify", lambda *given, **how: asked.append(1) or real(*given, **how))
    monkeypatch.setattr(module, "keeps_step", lambda *_: False)
    given = oscillator_with(TRUTH | {f"{effect}.coefficient": 0.1 for effect in effects}, effects=effects)
    assert is_the_rig(family_of(given, training(), held()).model)
    assert len(asked) == times


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


def test_one_zero_in_all_recordings_is_taken_off_as_well():
    """A law in its place, a load or a sensor that sits elsewhere, would take what is missing."""
    given = training(3e-3, 3e-3)
    family = family_of(MODEL, given, held(3e-3))
    assert family.free_zeros
    taken = [a.response - b.response for a, b in zip([*given, *held(3e-3)], _all(family), strict=True)]
    assert [float(t[0]) for t in taken] == pytest.approx([3e-3] * 3, abs=1e-6)


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


def test_a_drift_that_the_best_structure_gives_back_is_none():
    data = SimpleNamespace(offsets=_drifts(training(), [found("drift", 2e-3, middle=1.0)]))
    for given_back, left in ((-2e-3, []), (0.0, [("drift", 2e-3)])):
        facts = less_offsets(training(), {}, data, np.array([0.0, given_back]))[1]
        assert [(fact.what, fact.value) for fact in facts] == left


# --- each decision by itself, on either side of its limit


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize(("name", "limit"), [("omega0", 1.3), ("mass", 2.0)])
def test_another_rig_is_one_whose_frequency_or_mass_is_off_by_a_factor(name, limit, way):
    """Up or down; a file that claims to know them is refused, one that does not is told of."""
    for beyond in (0.99, 1.01):
        given = scaled((limit * beyond) ** way, None, (name,))
        assert bool(_same_rig(given, MODEL, slide=False)) is (beyond > 1)
        known = scaled((limit * beyond) ** way, 1e-3, (name,))
        if beyond > 1:
            with pytest.raises(BadInput, match="not of the model's rig"):
                _same_rig(known, MODEL, slide=False)
        else:
            assert _same_rig(known, MODEL, slide=False) == []


def test_a_slide_has_no_frequency_to_compare_and_free_motion_no_mass():
    assert _same_rig(scaled(9.0, 1e-3, ("omega0",)), MODEL, slide=True) == []
    with pytest.raises(BadInput, match="not of the model's rig"):
        _same_rig(scaled(9.0, 1e-3, ("mass",)), MODEL, slide=True)
    free = replace(MODEL, mass=None)
    assert _same_rig(scaled(9.0, 1e-3, ("mass",)), free, slide=False) == []
    (note,) = _same_rig(scaled(9.0, None, ("omega0",)), free, slide=False)
    assert "they show 12.67 Hz, the model has 114 Hz and 0.27 kg" in note


def test_what_has_the_other_sign_is_another_rig():
    """A negative frequency is nobody's."""
    assert _same_rig(scaled(-1.0, None, ("omega0",)), MODEL, slide=False)


@pytest.mark.parametrize(("part", "known"), [(0.099, True), (0.101, False), (None, False)])
def test_a_value_known_to_a_tenth_is_known(part, known):
    assert _is_known(scaled(1.0, part), "omega0") is known
    assert _is_known(scaled(-1.0, None if part is None else -part), "omega0") is known  # of its size


def test_what_was_kept_in_an_identification_is_known_without_an_error():
    kept = replace(MODEL, identified=Provenance(recordings=({"file": "a"},), parameters=("viscous",)))
    assert _is_known(kept, "mass")
    assert not _is_known(kept, "viscous")  # it could not be identified
    assert not _is_known(MODEL, "mass")


def found(channel, value, recording=0, **more):
    return FoundOffset(recording, channel, value, 1e-3, **more)


def test_a_drift_is_taken_off_as_a_line_about_its_middle():
    given = training()
    corrected, taken = _without_drift_and_force(given, [found("drift", 2e-3, middle=1.0), found("response", 9.0)])
    line = 2e-3 * (np.asarray(given[0].time) - 1.0)
    assert given[0].response - corrected[0].response == pytest.approx(line, abs=1e-15)
    assert corrected[1] is given[1]
    assert [offset.channel for offset in taken] == ["drift"]


@pytest.mark.parametrize(("apart", "removed"), [(3.7e-3, False), (3.73e-3, True)])
def test_zeros_of_load_cells_are_taken_off_where_they_differ(apart, removed):
    """The same in all is a load on the mass as well: so many errors on either side of their mean settle it."""
    given = [record("sweep", 1.0, 8.0), record("other", 0.6, 6.0)]
    offsets = [found("force", 0.1), found("force", 0.1 + 2 * apart, 1)]
    corrected, taken = _without_drift_and_force(given, offsets)
    shown = [float(np.mean(a.force - b.force)) for a, b in zip(given, corrected, strict=True)]
    assert shown == pytest.approx([0.1, 0.1 + 2 * apart] if removed else [0.0, 0.0])
    assert len(taken) == 2 * removed


def test_the_zero_of_a_single_load_cell_is_taken_off():
    """One alone agrees with itself, and says nothing of a load; a decay beside it has none."""
    given = training()
    corrected, taken = _without_drift_and_force(given, [found("force", 0.1, 1)])
    assert given[1].force - corrected[1].force == pytest.approx(np.full(given[1].n, 0.1))
    assert len(taken) == 1


def family(**changed):
    plain = {"recordings": tuple(training()), "holdout": (), "free_zeros": True}
    return Family(**{"model": MODEL, "memory": 8.0, "drifts": (), "notes": (), **plain, **changed})


def test_a_drift_is_free_in_every_fit_with_the_zero_that_goes_with_it():
    given = training()
    zero, drift = _drifts(given, [found("drift", 2e-3, middle=1.0), found("response", 1.0, 1)])
    assert (zero.recording, zero.channel, zero.taken) == (0, "response", 0.0)
    assert (drift.recording, drift.channel, drift.middle, drift.taken) == (0, "drift", 1.0, 2e-3)
    size = float(np.std(given[0].response))
    assert (zero.scale / size, drift.scale * given[0].duration / size) == pytest.approx((0.01, 0.01))
    data = cut_for(family(drifts=(zero, drift), shown={0: 3e-3, 1: 4e-3}), given, MODEL)
    assert [(o.recording, o.channel, o.taken) for o in data.offsets] == [
        (1, "response", 4e-3),
        (0, "response", 3e-3),
        (0, "drift", 2e-3),
    ]
    assert data.offsets[0].scale == pytest.approx(0.01 * float(np.std(given[1].response)))
    assert data.memory == 8.0


def test_on_what_is_held_out_zeros_are_free_and_drifts_are_not():
    zero, drift = _drifts(training(), [found("drift", 2e-3)])
    held_out = family(drifts=(zero, drift), shown={0: 3e-3}, shown_elsewhere={0: 5e-3})
    data = cut_for(held_out, held(), MODEL, judged=True)
    assert [(o.recording, o.channel, o.taken) for o in data.offsets] == [(0, "response", 5e-3)]
    assert cut_for(replace(held_out, free_zeros=False), held(), MODEL, judged=True).offsets == ()


def test_a_drift_is_taken_off_with_the_zero_that_was_found():
    zero, drift = _drifts(training(), [found("drift", 2e-3, middle=1.0)])
    data = SimpleNamespace(offsets=(zero, drift))
    given = training()
    less, facts = less_offsets(given, {1: 4e-3}, data, np.array([1e-3, 2e-3]))
    assert given[0].response - less[0].response == pytest.approx(1e-3 + 2e-3 * (np.asarray(given[0].time) - 1.0))
    assert [(fact.what, fact.file, fact.value) for fact in facts] == [
        ("offset", "sweep", 4e-3),
        ("offset", "decay", 1e-3),
        ("drift", "decay", 4e-3),
    ]


@pytest.mark.parametrize("fails", [0, 1, 2, 99])
def test_the_family_is_simulated_from_the_plainest_start_that_runs_and_else_predicted(monkeypatch, fails):
    """From its own values, without what holds the mass, as a linear rig; then with ever shorter memory."""
    starts = []

    memories = []

    def best_of_family(start, data):
        starts.append(start)
        memories.append(data.memory)
        if len(starts) <= fails:
            raise BadInput("it does not simulate from there")
        return SimpleNamespace(finite=True)

    data = replace(cut_for(family(), training(), MODEL), memory=np.inf)
    monkeypatch.setattr("dashpot.diagnose.family.best_of_family", best_of_family)
    if fails == 99:
        with pytest.raises(BadInput, match="no model of this family"):
            first_fit(data, data, MODEL)
        assert memories[0] == np.inf
        assert memories[-1] == 1.0
        return
    _, near, holdout = first_fit(data, data, MODEL)
    assert [start.dry.value for start in starts] == [TRUTH["dry"], 0.0, 0.0][: fails + 1]
    assert [start.cubic.value for start in starts] == [TRUTH["cubic"], TRUTH["cubic"], 0.0][: fails + 1]
    assert holdout is not None
    assert near.memory == holdout.memory == np.inf


# --- held out, of another rig: what is left told beforehand


def judged_stranger(monkeypatch, here, there, again, *, names=None, slide=False, **moved):
    """``stranger`` where so many times the noise are left here, there, and there once fitted by itself."""
    names = names or [f"held {i}" for i in range(len(there))]
    left = [SimpleNamespace(file="run", ratio=ratio) for ratio in here]
    left += [SimpleNamespace(file=name, ratio=ratio) for name, ratio in zip(names, there, strict=True)]
    fitted = SimpleNamespace(model=moved.get("own", MODEL), finite=moved.get("finite", True))
    monkeypatch.setattr(module, "Structure", lambda *_: SimpleNamespace(fit=lambda **_: fitted))
    monkeypatch.setattr(module, "leftovers", lambda *_: [SimpleNamespace(ratio=again)])
    holdout = SimpleNamespace(recordings=[SimpleNamespace(name=name) for name in dict.fromkeys(names)])
    data = SimpleNamespace(segments=[SimpleNamespace(slide=slide)] * len(here))
    return stranger(SimpleNamespace(model=MODEL), data, holdout, left)


OTHER = scaled(1.02, None, ("omega0",))


@pytest.mark.parametrize(
    ("here", "there", "again", "another"),
    [
        ((1.0, 1.49), (2.3, 9.0), 1.0, True),
        ((1.0, 1.51), (2.3, 9.0), 1.0, False),  # the training is told badly too
        ((1.0,), (1.51, 2.26), 1.0, True),
        ((1.0,), (1.51, 2.24), 1.0, False),  # nothing held out is told badly
        ((1.0,), (1.49, 9.0), 1.0, False),  # one of them is of this rig
        ((1.0,), (4.0, 4.0), 1.9, True),
        ((1.0,), (4.0, 4.0), 2.1, False),  # a model of their own does no better
    ],
)
def test_another_rig_shows_in_all_that_is_held_out_and_has_a_model_of_its_own(monkeypatch, here, there, again, another):
    assert bool(judged_stranger(monkeypatch, here, there, again, own=OTHER)) is another


def test_of_several_stretches_of_a_recording_the_worst_counts(monkeypatch):
    said = judged_stranger(monkeypatch, (1.0,), (9.0, 1.0), 1.0, names=["held", "held"], own=OTHER)
    assert "(held) agree with a model of their own (12.92 Hz instead of 12.67 Hz, 0.27 kg instead of" in str(said)
    assert judged_stranger(monkeypatch, (1.0,), (9.0, 1.0), 1.0, own=OTHER) is None


@pytest.mark.parametrize("name", ["omega0", "mass"])
@pytest.mark.parametrize(("factor", "another"), [(1.0009, False), (1.0011, True), (1 / 1.0011, True), (-1.0, True)])
def test_a_rig_keeps_its_frequency_and_mass_to_a_thousandth(monkeypatch, name, factor, another):
    own = scaled(factor, None, (name,))
    assert bool(judged_stranger(monkeypatch, (1.0,), (9.0,), 1.0, own=own)) is another
    on_a_slide = judged_stranger(monkeypatch, (1.0,), (9.0,), 1.0, own=own, slide=True)
    assert bool(on_a_slide) is (another and name == "mass")


def test_what_no_model_of_its_own_tells_is_no_other_rig(monkeypatch):
    assert judged_stranger(monkeypatch, (1.0,), (9.0,), 1.0, own=OTHER, finite=False) is None
    data = SimpleNamespace(segments=[SimpleNamespace(slide=False)])
    assert stranger(SimpleNamespace(model=MODEL), data, None, [SimpleNamespace(ratio=9.0)]) is None


def struck(name, seed, factor):
    """A decay of the built-in rig, its frequency times a factor."""
    x, _ = motion(tuple((TRUTH | {"omega0": factor * TRUTH["omega0"]}).items()), 0.0, 2.0, 5e-3)
    return Recording(name, FS, x + NOISE * np.random.default_rng(seed).standard_normal(x.size))


def test_what_differs_in_a_recording_held_out_is_taken_with_it():
    factors = (1.0, 1.008)
    before, after = (struck(f"{i}", i, factor) for i, factor in enumerate(factors))
    best = family_of(MODEL, [before], [after])
    own = [dict(recording.differs)["omega0"] for recording in (*best.recordings, *best.holdout)]
    assert own[1] - own[0] == pytest.approx(0.008 * TRUTH["omega0"], rel=0.02)
    assert any("differs by" in note for note in best.notes)
    data = cut_for(best, best.holdout, MODEL, judged=True)
    left = Structure(best.model, data, tuple(best.model.parameters())).fit(settle=True)
    assert np.std(left.residuals[0]) < 1.2 * NOISE


def test_where_nothing_differs_recordings_held_out_stay_as_they_are():
    best = family_of(MODEL, [struck("0", 0, 1.0)], [struck("1", 1, 1.0)])
    assert not any(recording.differs for recording in (*best.recordings, *best.holdout))
