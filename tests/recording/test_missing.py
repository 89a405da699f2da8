"""Missing samples filled from their neighbours: closed forms, errors that are as stated, and forces that switch."""

import numpy as np
import pytest
from dashpot.recording.missing import cut_runs, filled, made_whole, runs_of, spans

N = 4000


def ringing(cycle, noise=0.0, seed=0):
    turns = np.arange(N) / cycle
    drawn = np.random.default_rng(seed).standard_normal(N)
    return 0.5 + np.exp(-0.02 * turns) * np.cos(2 * np.pi * turns) + noise * drawn


def lost(*gaps):
    mask = np.zeros(N, bool)
    for start, length in gaps:
        mask[start : start + length] = True
    return mask


@pytest.mark.parametrize("cycle", [4.1, 10.3, 100.0, 2000.0])
def test_ringing_is_filled_exactly(cycle):
    mask = lost((700, 1), (1500, 3), (2600, 8))
    made, errors = filled(np.where(mask, np.nan, ringing(cycle)), mask)
    np.testing.assert_allclose(made, ringing(cycle), rtol=0, atol=1e-10)
    assert list(errors) == [(700, 701), (1500, 1503), (2600, 2608)]


@pytest.mark.parametrize("cycle", [4.1, 60.0])
def test_the_error_is_as_stated_where_there_is_noise(cycle):
    mask = lost(*[(start, 3) for start in range(200, 3800, 40)])
    clean, noisy = ringing(cycle), ringing(cycle, 1e-2)
    made, errors = filled(np.where(mask, np.nan, noisy), mask)
    scores = [np.sqrt(np.mean((made - noisy)[a:b] ** 2)) / error for (a, b), error in errors.items()]
    assert 0.7 < np.sqrt(np.mean(np.square(scores))) < 1.6
    assert np.max(np.abs(made - clean)[mask]) < 5e-2


def test_a_switched_force_is_known_between_its_edges_and_not_across_one():
    force = np.sign(np.sin(2 * np.pi * np.arange(N) / 77.3))
    edge = int(np.flatnonzero(np.diff(force))[20])
    mask = lost((500, 2), (1001, 1), (edge, 2))
    made, errors = filled(np.where(mask, np.nan, force), mask)
    np.testing.assert_array_equal(made[[500, 501, 1001]], force[[500, 501, 1001]])
    assert errors[500, 502] < 1e-6
    assert errors[1001, 1002] < 1e-6
    assert errors[edge, edge + 2] > 0.1


def test_filled_samples_lie_on_the_levels_of_the_converter():
    mask = lost((500, 3), (1000, 5))
    signal = 1e-2 * np.round(ringing(60.0) / 1e-2)
    made, _ = filled(np.where(mask, np.nan, signal), mask)
    np.testing.assert_allclose(made / 1e-2, np.round(made / 1e-2), atol=1e-9)
    assert np.max(np.abs(made - signal)) < 2.5e-2


def test_the_motion_begins_anew_where_an_edge_of_its_force_is_lost():
    force = np.sign(np.sin(2 * np.pi * np.arange(N) / 77.3))
    edge = int(np.flatnonzero(np.diff(force))[20])
    columns = np.column_stack([ringing(60.0, 1e-3), force])
    columns[lost((500, 2), (edge, 2))] = np.nan
    whole = made_whole("rig.csv", columns, 100.0)
    assert whole.blank == tuple(sorted([(500, 502), (edge, edge + 2)]))
    assert whole.unknown == ((edge, edge + 2),)
    assert len(whole.notes) == 2
    assert "4 sample(s) are missing" in whole.notes[0]


def test_a_force_that_follows_from_the_motion_is_not_fitted_where_it_was_filled():
    columns = np.column_stack([ringing(60.0, 1e-3), ringing(60.0, 1e-3)])
    columns[lost((500, 200)), 1] = np.nan
    whole = made_whole("rig.csv", columns, 100.0, imposed=True)
    assert whole.blank == ((500, 700),)
    assert whole.unknown == ()
    assert len(whole.notes) == 1


@pytest.mark.parametrize(("length", "anew"), [(40, False), (200, True)])
def test_free_motion_begins_anew_after_a_gap_of_more_than_a_cycle(length, anew):
    column = ringing(60.0, 1e-3)
    column[1000 : 1000 + length] = np.nan
    whole = made_whole("rig.csv", column[:, None], 100.0)
    assert whole.unknown == (((1000, 1000 + length),) if anew else ())


def test_runs_are_cut_with_their_samples():
    mask = lost((3, 2), (10, 5))
    assert runs_of(mask) == [(3, 5), (10, 15)]
    assert cut_runs(runs_of(mask), 4, 12) == ((0, 1), (6, 8))


def test_spans_name_the_first_and_count_the_rest():
    assert spans([(1.0, 1.0), (2.0, 3.5)]) == "at 1, from 2 to 3.5 s"
    assert spans([(float(k), float(k)) for k in range(8)]).endswith("at 4 s and 3 more times")
