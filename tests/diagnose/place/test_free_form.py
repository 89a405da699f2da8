"""Which coordinate a missing force follows: forces put in by hand along a motion in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.place.free_form import (
    _FORCE_PIECES,
    _PIECES,
    KINDS,
    _slider,
    explained,
    family,
    hats,
    idle,
    nodes_of,
    rows_of,
    shares,
    solve,
)
from scipy.signal import lfilter

SIZE = 5e-3

#: A force of each kind, of a size far beyond the noise.
FORCES = {
    "constant": lambda s: np.full(s.n, 2.0),
    "displacement": lambda s: 4e3 * np.maximum(s.x - 2e-3, 0.0),
    "velocity": lambda s: 60.0 * s.v * np.abs(s.v),
    "damping by position": lambda s: 2e6 * s.x**2 * s.v,
    "delay": lambda s: 5e-2 * s.drive_rate,
    "force": lambda s: 3.0 * np.clip(s.drive, -0.8, 0.8),
    "time": lambda s: 3e2 * s.x * s.time / s.time[-1],
    "memory": lambda s: 2e3 * _slider(s.x, 0.06 * SIZE),
}


def test_hats_interpolate_straight_lines_and_sum_to_one():
    nodes = np.linspace(-2.0, 3.0, 6)
    values = np.random.default_rng(2).uniform(-2.0, 3.0, 40)
    assert hats(values, nodes) @ nodes == pytest.approx(values)
    assert hats(np.array([-9.0, *values, 9.0]), nodes).sum(axis=1) == pytest.approx(np.ones(42))
    assert hats(nodes, nodes) == pytest.approx(np.eye(6))
    assert hats(np.array([-9.0, 9.0]), nodes) == pytest.approx(np.eye(6)[[0, -1]])  # beyond the ends: the end


def test_nodes_span_the_values_and_a_constant_gets_room():
    assert nodes_of(np.array([3.0, -1.0, 2.0]), 4) == pytest.approx([-1.0, 0.0, 1.0, 2.0, 3.0])
    assert nodes_of(np.array([2.0, 2.0]), 2) == pytest.approx([2.0, 2.5, 3.0])
    assert nodes_of(np.zeros(3)).size == _PIECES + 1 != _FORCE_PIECES + 1


def test_a_solution_is_that_of_least_squares_and_an_empty_column_takes_no_part():
    random = np.random.default_rng(0)
    plain, units = random.standard_normal((60, 3)), np.array([1.0, 1e-6, 1e5])
    columns = np.column_stack([plain * units, np.zeros(60)])
    target = random.standard_normal(60)
    expected = np.linalg.lstsq(plain, target)[0] / units
    assert solve(columns, target)[:3] == pytest.approx(expected, rel=1e-9)
    assert solve(columns, target)[3] == 0.0


def test_a_slider_is_a_spring_up_to_its_reach_and_holds_there():
    x = np.array([0.0, 0.5, 1.0, 3.0, 2.5, 1.5, 0.0, -4.0, -3.5])
    assert _slider(x, 1.0) == pytest.approx([0.0, 0.5, 1.0, 1.0, 0.5, -0.5, -1.0, -1.0, -0.5])
    assert _slider(x + 7.0, 1.0) == pytest.approx(_slider(x, 1.0))  # begins unstretched wherever it begins


def test_the_family_can_bend_its_own_terms(stretch):
    """What Eq. 17 with other values would do is no missing force."""
    own = stretch(lambda s: 30.0 * s.x + 4e5 * s.x**3 + 1.2 * s.v - 0.4 * s.drive)
    rows = rows_of([own])
    assert rows.left @ rows.left == pytest.approx(rows.silent @ rows.silent, rel=0.2)
    assert family(own)[:, [0, 1, 3, 5]] == pytest.approx(np.column_stack([own.x, own.x**3, own.v, own.drive]))
    signs = family(own)[:, [2, 4]]
    far = np.abs(own.x) > 0.06 * np.std(own.x)
    assert np.array_equal(signs[far, 0], np.sign(own.x[far]))
    assert np.all(np.abs(signs) <= 1.0)
    near = np.abs(own.v) < 0.05 * np.std(own.v)
    assert signs[near, 1] == pytest.approx(own.v[near] / (0.05 * np.std(own.v)))


def test_rows_are_weighed_by_the_noise_of_their_stretch(stretch):
    quiet, loud = stretch(noise=0.01, cycles=40), stretch(noise=0.5, cycles=60, seed=1)
    rows = rows_of([quiet, loud])
    assert rows.weight[0] == pytest.approx(1.0 / np.std(quiet.noise))
    assert rows.weight[-1] == pytest.approx(1.0 / np.std(loud.noise))
    assert rows.target == pytest.approx(np.r_[quiet.missing, loud.missing] * rows.weight)
    assert rows.noise == pytest.approx(np.r_[quiet.noise, loud.noise] * rows.weight)
    assert rows.base @ solve(rows.base, rows.target) == pytest.approx(rows.target - rows.left)
    assert rows.base @ solve(rows.base, rows.noise) == pytest.approx(rows.noise - rows.silent)
    assert np.array_equal(rows.part(rows.target, 1), loud.missing * rows.part(rows.weight, 1))
    assert rows.part(rows.target, 0).size == quiet.n


def test_blocks_of_the_next_stretch_are_others(stretch):
    rows = rows_of([stretch(cycles=8), stretch(cycles=12)])
    assert np.array_equal(np.unique(rows.part(rows.block, 0)), [0, 1])
    assert np.array_equal(np.unique(rows.part(rows.block, 1)), [2, 3, 4])
    assert np.array_equal(np.bincount(rows.block), np.full(5, 64))


@pytest.mark.parametrize("kind", FORCES)
def test_a_force_is_explained_by_the_coordinate_that_it_follows(kind, stretch):
    fractions = shares(rows_of([stretch(FORCES[kind]), stretch(FORCES[kind], name="decay", driven=False, seed=1)]))
    assert fractions[kind] == pytest.approx(1.0, abs=0.12)
    strangers = {
        "constant": ("delay", "time", "damping by position"),
        "displacement": ("constant", "velocity", "delay", "time", "force"),
        "velocity": ("constant", "displacement", "delay", "time", "force"),
        "damping by position": ("constant", "displacement", "delay", "time", "force"),
        "delay": ("constant", "displacement", "velocity", "time"),
        "force": ("constant", "displacement", "velocity", "time"),
        "time": ("constant", "displacement", "velocity", "force"),
        "memory": ("constant", "delay", "time", "force"),
    }[kind]
    assert all(fractions[name] < 0.6 for name in strangers), fractions


def test_a_sensor_that_bends_is_explained_as_one(stretch):
    """y = x + k x³ leaves e'' + omega0² e with e = k x³ in the equation of a linear oscillator."""

    def bent(s):
        omega2 = -(s.x @ s.a) / (s.x @ s.x)
        return 2e4 * (6 * s.x * s.v**2 + 3 * s.x**2 * s.a + omega2 * s.x**3)

    def lopsided(s):
        omega2 = -(s.x @ s.a) / (s.x @ s.x)
        return 60.0 * (2 * s.v**2 + 2 * s.x * s.a + omega2 * s.x**2)

    for force in (bent, lopsided):
        assert shares(rows_of([stretch(force)]))["sensor"] == pytest.approx(1.0, abs=0.1)


def test_a_damper_behind_a_spring_is_a_memory(stretch):
    def relaxing(s):
        step = s.time[1] - s.time[0]
        turn = np.sqrt(np.mean(s.v**2) / np.mean(s.x**2))
        return 3e3 * lfilter([1.0, -1.0], [1.0, -np.exp(-step * turn)], s.x - s.x[0])

    # nearly all of it is a spring and a damping that the family bends; what is left must be told
    fractions = shares(rows_of([stretch(relaxing)]))
    assert fractions["memory"] > 0.8


def test_memories_reach_from_a_fiftieth_to_half_of_the_motion_and_from_slow_to_fast(stretch):
    """A slider holds at its reach; a damper behind a spring keeps of a sampled sine a part in closed form."""
    own = stretch(cycles=200)
    columns = KINDS["memory"](rows_of([own]))
    assert np.max(np.abs(columns[:, :4]), axis=0) == pytest.approx(np.array([0.02, 0.06, 0.18, 0.5]) * SIZE, rel=0.02)
    # in step with the displacement, and with the velocity a quarter of a cycle ahead of it
    step = own.time[1] - own.time[0]
    quarters = np.column_stack([own.x, own.v * step * 16 / (2 * np.pi)])
    parts = np.array([1.0, 1.0j]) @ np.linalg.lstsq(quarters, columns[:, 4:])[0]
    turn = 2 * np.pi / 16
    poles = np.exp(-turn * np.array([0.2, 1.0, 5.0]))
    assert parts == pytest.approx((1 - np.exp(-1j * turn)) / (1 - poles * np.exp(-1j * turn)), rel=0.05)


def test_a_constant_is_one_column(stretch):
    """Two alike would be charged for chance twice and explain no more."""
    rows = rows_of([stretch(cycles=8), stretch(cycles=12, driven=False)])
    assert np.array_equal(KINDS["constant"](rows), np.ones((20 * 16, 1)))


def test_a_path_that_lags_or_holds_back_at_turns_follows_the_force(stretch):
    for force in (
        lambda s: 0.2 * s.drive_bend / np.std(s.drive_bend),
        lambda s: 0.3 * np.clip(s.drive_rate / (0.1 * np.std(s.drive_rate)), -1, 1),
    ):
        assert shares(rows_of([stretch(force)]))["force"] == pytest.approx(1.0, abs=0.15)


def test_where_nothing_drives_no_force_is_followed(stretch):
    free = shares(rows_of([stretch(driven=False)]))
    assert set(free) == set(KINDS) - {"force", "delay"}
    assert set(shares(rows_of([stretch()]))) == set(KINDS)
    # of a driven and a free one only the driven has columns
    rows = rows_of([stretch(cycles=8), stretch(cycles=8, driven=False)])
    columns = KINDS["force"](rows)
    assert np.any(rows.part(columns, 0))
    assert not np.any(rows.part(columns, 1))


def test_idle_columns_explain_what_chance_would(stretch):
    rows = rows_of([stretch(cycles=80)])
    assert idle(rows, 3) == pytest.approx(3 * (rows.left @ rows.left) / (8 * 20))
    random = np.random.default_rng(4)
    gained = np.mean([explained(rows, random.standard_normal((rows.target.size, 3))) for _ in range(30)])
    assert 0.0 < gained < idle(rows, 3)  # white columns have more than eight chances a block


def test_what_columns_explain_is_what_least_squares_takes_away(stretch):
    rows = rows_of([stretch(FORCES["velocity"], cycles=40)])
    columns = KINDS["velocity"](rows) * rows.weight[:, None]
    whole = np.hstack([rows.base, columns])
    residual = rows.target - whole @ np.linalg.lstsq(whole, rows.target)[0]
    assert explained(rows, columns) == pytest.approx(rows.left @ rows.left - residual @ residual, rel=1e-6)


def test_a_share_is_at_most_all(stretch):
    rows = rows_of([stretch(FORCES["velocity"], noise=1e-6)])
    louder = replace(rows, silent=0.99 * rows.left)
    assert max(shares(rows).values()) <= 1.0
    assert max(shares(louder).values()) == 1.0
