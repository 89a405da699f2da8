"""The mended model shown on every recording: against the reference integrator, by the FMU that is delivered."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.repair_trial import exported, follows_any, no_finding, record_fits, takes_something, unmended
from dashpot.diagnose.result import RecordFit
from dashpot.examples.truth import TRUTH
from dashpot.model import Oscillator, Response

NOISE = 2e-5
BENT = TRUTH | {"viscous": 7.0, "dry": 0.0}
FAMILY, MENDED = Oscillator.from_values(BENT), Oscillator.from_values(TRUTH)
SWEEP = (1.0, 8.0, 18.0)
NOTHING = np.zeros(2)


def row(before=0.01, after=0.01, floor=0.01):
    return RecordFit("run", False, before, after, floor, NOTHING, NOTHING, NOTHING, NOTHING, None, Response())


@pytest.fixture(scope="module")
def sweep(recorded):
    """Driven from rest; its sensor shows a millimetre at zero."""
    return replace(recorded(sweep=SWEEP, seconds=3.0, noise=NOISE, offset=1e-3, name="sweep"), hold="smooth")


@pytest.fixture(scope="module")
def decay(recorded):
    return recorded(begin=(8e-3, 0.0), seconds=3.0, noise=NOISE, seed=1, name="decay")


@pytest.fixture(scope="module")
def fmu(tmp_path_factory):
    """The mended model, compiled for this machine; None where there is no compiler."""
    return exported(MENDED, tmp_path_factory.mktemp("mended") / "model.fmu")


# --- what each model makes of a recording


def test_the_true_model_leaves_the_noise_and_a_bent_one_what_it_is_off_by(sweep, recorded):
    (fit,) = record_fits(FAMILY, MENDED, [sweep], holdout=True)
    spread = float(np.std(sweep.response))
    noiseless = [recorded(values, sweep=SWEEP, seconds=3.0, noise=0.0).response for values in (BENT, TRUTH)]
    off = float(np.std(noiseless[0] - noiseless[1])) / spread  # but for a constant, which the sensor may show
    assert (fit.file, fit.holdout, fit.response) == ("sweep", True, Response("displacement", "m"))
    assert fit.nrmse_after == pytest.approx(NOISE / spread, rel=0.05)
    assert fit.noise_floor == pytest.approx(NOISE / spread, rel=0.05)
    assert fit.nrmse_before == pytest.approx(np.hypot(off, NOISE / spread), rel=0.02)
    assert fit.nrmse_before > 5 * fit.nrmse_after
    assert np.array_equal(fit.measured, sweep.response)
    assert fit.after == pytest.approx(noiseless[1] + 1e-3, abs=0.2 * NOISE)
    assert fit.before == pytest.approx(noiseless[0] + 1e-3, abs=0.3 * off * spread)
    assert fit.time == pytest.approx(np.arange(1500) / 500.0)
    assert fit.force is not None
    assert np.array_equal(fit.force, sweep.force)


def test_where_nothing_was_mended_the_family_stands_for_both(sweep):
    (fit,) = record_fits(MENDED, None, [sweep], holdout=False)
    assert not fit.holdout
    assert np.array_equal(fit.before, fit.after)
    assert fit.nrmse_before == fit.nrmse_after == pytest.approx(fit.noise_floor, rel=0.05)


def test_a_decay_is_told_where_it_is_free_and_has_no_force(decay):
    (fit,) = record_fits(FAMILY, MENDED, [decay], holdout=False)
    assert fit.force is None
    assert fit.time.size == fit.measured.size == fit.before.size == fit.after.size
    first = round(fit.time[0] * decay.fs)
    assert np.array_equal(fit.measured, decay.response[first : first + fit.time.size])
    assert fit.nrmse_after == pytest.approx(NOISE / float(np.std(fit.measured)), rel=0.1)
    assert fit.nrmse_before > 5 * fit.nrmse_after


def test_a_recording_without_anything_to_simulate_has_no_row(recorded, decay):
    """A sensor that shows nothing but its noise, and no force."""
    silent = recorded(seconds=3.0, noise=NOISE, name="silent")
    fits = record_fits(FAMILY, MENDED, [silent, decay], holdout=False)
    assert [fit.file for fit in fits] == ["decay"]


# --- the FMU


def test_what_is_held_out_is_shown_by_the_fmu_that_is_delivered(sweep, decay, fmu):
    """From the same state, with what the sensor shows at zero."""
    if fmu is None:
        pytest.skip("there is no compiler")
    shown = record_fits(FAMILY, MENDED, [sweep, decay], holdout=True, fmu=fmu)
    inside = record_fits(FAMILY, MENDED, [sweep, decay], holdout=True)
    for fit, same in zip(shown, inside, strict=True):
        assert fit.file == same.file
        assert np.array_equal(fit.before, same.before)
        assert fit.after == pytest.approx(same.after, abs=0.05 * NOISE)
        assert fit.nrmse_after == pytest.approx(same.nrmse_after, rel=0.01)


def test_the_fmu_speaks_and_not_the_model_that_it_was_made_from(sweep, fmu):
    """Were the FMU another model, that would show."""
    if fmu is None:
        pytest.skip("there is no compiler")
    (fit,) = record_fits(FAMILY, FAMILY, [sweep], holdout=True, fmu=fmu)
    (mended,) = record_fits(FAMILY, MENDED, [sweep], holdout=True)
    assert np.std(fit.after - mended.after) < NOISE
    assert fit.nrmse_before > 5 * fit.nrmse_after


def test_the_fmu_is_given_back_also_where_a_run_fails(sweep, fmu, monkeypatch):
    if fmu is None:
        pytest.skip("there is no compiler")
    ended = []

    class Run:
        def __init__(self, path):
            assert path == fmu

        def output_for(self, recording):
            raise RuntimeError(recording.name)

        def __enter__(self):
            return self

        def __exit__(self, *given):
            ended.append(given[0])

    monkeypatch.setattr("dashpot.diagnose.repair_trial.FmuRun", Run)
    with pytest.raises(RuntimeError, match="sweep"):
        record_fits(FAMILY, MENDED, [sweep], holdout=True, fmu=fmu)
    assert ended == [RuntimeError]


def test_a_mended_model_that_runs_away_from_what_was_held_out_leaves_a_row_without_an_end(sweep, tmp_path):
    """A cubic that softens has no way back beyond its largest force; the FMU stops there, and nothing else does."""
    cubic = -2.0 * TRUTH["omega0"] ** 2 / np.max(np.abs(sweep.response)) ** 2
    softening = Oscillator.from_values(TRUTH | {"cubic": cubic})
    path = exported(softening, tmp_path / "softening.fmu")
    (found,) = record_fits(Oscillator.from_values(TRUTH), softening, [sweep], holdout=True, fmu=path)
    assert found.nrmse_before < 2 * found.noise_floor
    assert not math.isfinite(found.nrmse_after)
    assert found.after is not None
    assert np.isfinite(found.after[0])
    assert np.isnan(found.after[-1])
    assert not follows_any([found])


def test_without_a_mended_model_no_fmu_is_asked_for(sweep, tmp_path):
    (fit,) = record_fits(MENDED, None, [sweep], holdout=True, fmu=tmp_path / "missing.fmu")
    assert np.array_equal(fit.before, fit.after)


def test_without_a_compiler_there_is_no_fmu_and_that_is_no_failure(no_compiler, tmp_path):
    assert exported(MENDED, tmp_path / "model.fmu") is None


def test_what_is_exported_runs_on_this_machine(monkeypatch, tmp_path):
    given = {}
    monkeypatch.setattr("dashpot.diagnose.repair_trial.export_fmu", lambda *what, **more: given.update(more) or what[1])
    monkeypatch.setattr("dashpot.diagnose.repair_trial.own_platform", lambda: "here")
    assert exported(MENDED, tmp_path / "model.fmu") == tmp_path / "model.fmu"
    assert given == {"backend": "native", "platforms": ("here",)}


# --- whether it follows anything


@pytest.mark.parametrize(
    ("after", "floor", "follows"), [(0.49, 0.01, True), (0.51, 0.01, False), (0.8, 0.75, True), (0.8, 0.7, False)]
)
def test_a_model_follows_a_recording_to_half_its_motion_or_to_its_noise(after, floor, follows):
    assert follows_any([row(2.0, 3.0), row(2.0, after, floor)]) is follows
    assert not follows_any([row(0.1, math.nan)])


def test_a_model_shown_nothing_follows_nothing():
    assert not follows_any([])


# --- whether it takes anything away


@pytest.mark.parametrize(("before", "takes"), [(1.2e-3, True), (0.51e-3, True), (0.49e-3, False), (math.inf, True)])
def test_a_mended_model_takes_nothing_away_where_most_records_have_less_than_their_noise(before, takes):
    records = [row(1e-6, 1e-9, 1e-3), row(before, 1e-9, 1e-3), row(before, 1e-9, 1e-3)]
    assert takes_something(records) is takes
    why = no_finding(records, 0.9)
    assert (why is None) is takes
    assert takes or "a sensor could have shown" in why


def test_what_follows_nothing_is_no_finding_whatever_it_takes_away():
    assert "follows no recording" in no_finding([row(5.0, 0.9, 1e-3)], 0.9)


# --- whether what was held out bears it out


def held(before, after, floor=1e-3):
    return replace(row(before, after, floor), holdout=True)


@pytest.mark.parametrize(("share", "named"), [(None, True), (0.011, True), (0.009, False), (0.0, False)])
def test_what_takes_away_less_than_a_hundredth_of_what_was_lacking_is_no_finding(share, named):
    assert (no_finding([row(0.5, 0.1)], share) is None) is named


@pytest.mark.parametrize(("after", "named"), [(0.49, True), (0.51, False), (math.nan, False)])
def test_what_follows_nothing_of_what_was_held_out_is_no_finding(after, named):
    """Even where it tells all it was fitted to: then the rig was another, or the law fits by chance."""
    why = no_finding([row(0.6, 0.01), held(1.0, after)], 0.9)
    assert (why is None) is named
    assert named or "nothing of what was held out" in why


def test_one_held_out_recording_that_is_followed_suffices():
    assert no_finding([row(0.6, 0.01), held(1.0, 0.9), held(0.9, 0.1)], 0.9) is None


@pytest.mark.parametrize(
    ("errors", "worse"),
    [
        ([(0.1, 0.101)], True),
        ([(0.1, 0.11), (0.2, 0.15)], False),
        ([(0.1, 0.2), (0.2, 0.18)], True),
        ([(1e-4, 9e-4)], False),
        ([(math.inf, 0.3)], False),
        ([(0.08, 0.043), (0.28, 0.41)], False),  # a quiet end does not outweigh the motion before it
        ([(0.08, 0.043), (0.28, 0.53)], True),
        ([(0.08, 0.04), (0.28, math.inf)], True),
    ],
)
def test_what_tells_held_out_motion_worse_is_no_finding(errors, worse):
    """Each recording by its factor, none below its noise, and not by less than what matters."""
    records = [row(0.6, 0.01), *(held(*pair) for pair in errors)]
    why = no_finding(records, 0.9)
    assert (why is not None) is worse
    assert not worse or "worse than the given family" in why


@pytest.mark.parametrize(
    ("before", "after", "named"),
    [(0.191, 0.184, False), (0.1, 0.0909, True), (0.1, 0.0911, False), (0.00105, 0.001, True), (0.1, 0.0011, True)],
)
def test_what_leaves_as_much_of_what_was_held_out_is_no_finding(before, after, named):
    """By less than the tenth to which noise is known, unless no more than noise is left."""
    why = no_finding([row(0.6, 0.01), held(before, after)], 0.9)
    assert (why is None) is named
    assert named or "as much of what was held out" in why


@pytest.mark.parametrize(("before", "after", "named"), [(0.009, 0.809, False), (0.009, 0.4, True), (0.6, 0.809, True)])
def test_what_loses_a_recording_that_the_family_follows_is_no_finding(before, after, named):
    why = no_finding([row(0.6, 0.01), row(before, after), held(1.0, 0.1)], 0.9)
    assert (why is None) is named
    assert named or "no longer follows run" in why


@pytest.mark.parametrize(("after", "worse"), [(0.0427, False), (0.0432, True), (0.239, True)])
def test_where_nothing_was_held_out_the_recordings_themselves_must_not_be_told_worse(after, worse):
    """A structure that suits pieces of a cycle each may not suit the whole: a limit of half a per cent of its size."""
    why = no_finding([row(0.0427, after, 1e-4)], 0.9)
    assert (why is not None) is worse
    assert not worse or "explains the recordings worse" in why


def test_where_nothing_is_mended_the_row_says_before_twice():
    record = unmended(row(0.5, 0.1))
    assert record.nrmse_after == 0.5
    assert record.after is record.before
