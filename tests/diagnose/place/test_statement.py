"""The sentences that say where a mismatch lies, for forces put in by hand."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.place.free_form import _slider
from dashpot.diagnose.place.statement import how_far_off, in_which_recordings, what_it_follows
from dashpot.diagnose.place.what_it_follows import symptoms, with_kind
from dashpot.diagnose.result import RecordFit
from dashpot.model import Oscillator, Response

MODEL = Oscillator.from_values(
    {"mass": 0.5, "omega0": 20 * np.pi, "cubic": 0.0, "preload": 0.0, "viscous": 1.5, "dry": 0.0}
)
FULL = {"displacement": (-5e-3, 5e-3), "amplitude": (1e-3, 5e-3)}
TONE = 3.37


def said(stretch, force, *, kind=None, ranges=None, **more):
    signature = symptoms([stretch(force, cycles=200, **more)])
    assert kind is None or signature.kind == kind, signature.shares
    return what_it_follows(signature, MODEL, FULL | (ranges or {}))


@pytest.mark.parametrize(
    ("force", "side", "acts"),
    [
        (lambda s: 4e3 * np.maximum(s.x - 2e-3, 0.0), "beyond {} mm on the positive side", (2e-3, 5e-3)),
        (lambda s: -4e3 * np.maximum(-s.x - 2e-3, 0.0), "beyond -{} mm on the negative side", (-5e-3, -2e-3)),
        (
            lambda s: 4e3 * (np.maximum(s.x - 2e-3, 0.0) - np.maximum(-s.x - 2e-3, 0.0)),
            "beyond {} mm on both sides",
            (-5e-3, 5e-3),
        ),
    ],
)
def test_a_stop_is_told_with_its_place_and_side(force, side, acts, stretch):
    words, narrower = said(stretch, force, kind="displacement")
    place = re.search(r"beyond -?([\d.]+) mm", words)
    assert place is not None
    assert float(place[1]) == pytest.approx(2.0, abs=0.05)
    assert words.startswith(side.format(place[1]))
    assert "sets in there" in words
    assert narrower["displacement"] == pytest.approx(acts, abs=1e-4)


@pytest.mark.parametrize(
    ("force", "words"),
    [
        (lambda s: 4e4 * s.x**2, "not alike on both sides (stiffer on the positive one)"),
        (lambda s: -4e4 * s.x**2, "not alike on both sides (stiffer on the negative one)"),
        (lambda s: 1e12 * s.x**5, "alike on both sides: a spring that stiffens otherwise"),
        (lambda s: -1e12 * s.x**5, "alike on both sides: a spring that gives way otherwise"),
    ],
)
def test_a_smooth_spring_is_told_by_its_symmetry_and_sign(force, words, stretch):
    statement, narrower = said(stretch, force, kind="displacement")
    assert statement.startswith("at every displacement, more the larger it is")
    assert words in statement
    assert narrower["displacement"] == FULL["displacement"]


@pytest.mark.parametrize(
    ("part", "words"),
    [
        (0.8, "not alike on both sides (stiffer on the positive one)"),
        (1.25, "alike on both sides: a spring that stiffens"),
    ],
)
def test_a_spring_both_lopsided_and_stiffening_is_told_by_the_larger(part, words, stretch):
    """Of what the family cannot tell of either, the fifth power leaves this part of what the square leaves."""

    def left(force):
        rows = symptoms([stretch(force, cycles=200)]).rows
        return float(rows.left @ rows.left - rows.silent @ rows.silent)

    level = 4e4 * np.sqrt(left(lambda s: 1e12 * s.x**5) / left(lambda s: 4e4 * s.x**2) / part)
    statement, narrower = said(stretch, lambda s: 1e12 * s.x**5 + level * s.x**2, kind="displacement")
    assert words in statement
    assert ("not alike" in statement) is (part < 1)
    assert narrower["displacement"] == FULL["displacement"]


@pytest.mark.parametrize(
    ("force", "words"),
    [
        (lambda s: 60.0 * s.v * np.abs(s.v), "grows faster with speed than dry and viscous"),
        (lambda s: -60.0 * s.v * np.abs(s.v), "grows less with speed than dry and viscous"),
        (lambda s: 8.0 * np.abs(s.v), "larger when it moves upwards than back"),
        (lambda s: -8.0 * np.abs(s.v), "larger when it moves downwards than back"),
        (lambda s: 3.0 * np.sign(s.v) * np.exp(-np.abs(s.v) / 0.02), "more friction at speeds below about"),
        (lambda s: -3.0 * np.sign(s.v) * np.exp(-np.abs(s.v) / 0.02), "less friction at speeds below about"),
    ],
)
def test_a_resistance_is_told_by_how_it_grows(force, words, stretch):
    statement, narrower = said(stretch, force, kind="velocity")
    assert statement.startswith("at every displacement, ")
    assert words in statement
    assert narrower == {}


def test_the_speed_below_which_friction_changes_is_told(stretch):
    statement, _ = said(stretch, lambda s: 3.0 * np.sign(s.v) * np.exp(-np.abs(s.v) / 0.02))
    speed = float(statement.split("below about ")[1].split()[0]) * 1e-3
    assert statement.split("below about ")[1].split()[1] == "mm/s"
    assert 0.02 < speed < 0.08  # twice the speed, found to a factor of two


@pytest.mark.parametrize(
    ("force", "words"),
    [
        (lambda s: 2e6 * s.x**2 * s.v, "more far from the middle"),
        (lambda s: 5e3 * s.x * s.v, "on the positive side"),
        (lambda s: -5e3 * s.x * s.v, "on the negative side"),
    ],
)
def test_a_damping_by_position_is_told_by_where_it_is_larger(force, words, stretch):
    statement, _ = said(stretch, force, kind="damping by position")
    assert words in statement


def test_a_tone_is_told_with_its_frequency_and_size(stretch):
    statement, narrower = said(stretch, lambda s: 0.3 * np.cos(2 * np.pi * TONE * s.time), kind="tone")
    low, high = narrower["frequency_hz"]
    assert low == high == pytest.approx(TONE, abs=0.03)
    assert "whatever the motion" in statement
    assert "0.3" in statement or "0.29" in statement
    assert "m/s2 per unit mass" in statement


def test_what_rings_with_the_motion_is_told_as_a_second_body(stretch):
    def ringing(level):
        return lambda s: level * np.cos(2 * np.pi * TONE * s.time)

    signature = symptoms([stretch(ringing(0.5), name="loud"), stretch(ringing(0.2), name="quiet", seed=1)])
    statement, _ = what_it_follows(signature, MODEL, FULL)
    assert "a second body that rings" in statement


def test_a_constant_pull_is_told_with_its_size_and_what_it_shifts(stretch):
    """A pull of 2 m/s² shifts a rig of 10 Hz by 2 / (20 pi)² = 0.507 mm."""
    statement, _ = said(stretch, lambda s: np.full(s.n, 2.0), kind="constant")
    assert "a constant pull of -2 m/s2" in statement
    assert "-507 µm off" in statement or "-0.507 mm off" in statement


@pytest.mark.parametrize(("sign", "order"), [(1, "after"), (-1, "before")])
def test_a_delay_is_told_in_milliseconds_and_its_direction(sign, order, stretch):
    statement, _ = said(stretch, lambda s: sign * 5e-2 * s.drive_rate, kind="delay")
    assert f"50 ms {order} what the recorded force says" in statement


@pytest.mark.parametrize(("turns", "told"), [(0.9, True), (1.1, False)])
def test_what_exceeds_a_cycle_of_the_force_is_no_delay(turns, told, stretch):
    def late(s):
        return turns * 2 * np.pi * np.std(s.drive) / np.std(s.drive_rate) * s.drive_rate

    statement, _ = said(stretch, late, kind="delay")
    assert ("after what the recorded force says" in statement) == told
    assert ("by more than a delay could" in statement) != told


@pytest.mark.parametrize(("sign", "word"), [(1, "grows"), (-1, "falls")])
def test_a_drift_is_told_in_per_cent(sign, word, stretch):
    """A tenth of the stiffness in twenty seconds."""
    statement, _ = said(stretch, lambda s: sign * 0.1 * (20 * np.pi) ** 2 * s.x * s.time / 20.0, kind="time")
    assert f"the stiffness {word} by about 10 %" in statement
    assert "in 20 s" in statement


@pytest.mark.parametrize(
    ("force", "words"),
    [
        (lambda s: -0.5 * np.abs(s.drive) * s.drive, "more arrives than in proportion"),
        (lambda s: 0.5 * np.abs(s.drive) * s.drive, "less arrives than in proportion"),
        (
            lambda s: 0.5 * np.clip(s.drive_rate / (0.1 * np.std(s.drive_rate)), -1, 1),
            "holds back when the force turns",
        ),
    ],
)
def test_what_happens_to_the_force_is_told_by_its_shape(force, words, stretch):
    statement, _ = said(stretch, force, kind="force")
    assert statement.startswith("where a force acts")
    assert words in statement


def test_a_sensor_is_told_to_be_in_the_record(stretch):
    def bent(s):
        omega2 = -(s.x @ s.a) / (s.x @ s.x)
        return 2e4 * (6 * s.x * s.v**2 + 3 * s.x**2 * s.a + omega2 * s.x**3)

    assert "in the record, not in the motion" in said(stretch, bent, kind="sensor")[0]


def test_a_memory_is_told_with_its_parts_of_the_first_order(stretch):
    signature = symptoms([stretch(lambda s: 2e3 * _slider(s.x, 3e-4), cycles=200)])
    assert signature.kind == "memory"
    statement, _ = what_it_follows(replace(signature, first=(0.251, 0.126)), MODEL, FULL)
    assert "a force that remembers" in statement
    assert "order 1: 25 % with displacement, 13 % with velocity" in statement


def test_what_follows_nothing_is_told_by_step_and_amplitude(stretch):
    def strange(order):
        # in step with the motion, its sign another in each block, so that no coordinate makes it
        signs = np.random.default_rng(1).choice([-2.0, 2.0], 1000)
        return lambda s: signs[s.block] * np.cos(order * s.phase)

    statement, _ = said(stretch, strange(4), kind="unknown")
    assert "from 1 mm to 5 mm, most in order 4 of the motion" in statement
    random = np.random.default_rng(0)
    wide = {"amplitude": (0.5e-3, 5e-3)}
    statement, _ = said(stretch, lambda s: random.standard_normal(s.n), kind="unknown", ranges=wide)
    assert "in step with nothing" in statement


# --- in which recordings


def drag(s):
    return 60.0 * s.v * np.abs(s.v)


def test_every_recording_or_the_only_one(stretch):
    both = symptoms([stretch(drag, name="a"), stretch(drag, name="b", seed=1)])
    assert in_which_recordings(both, ["a", "b"]) == "in every recording"
    assert in_which_recordings(symptoms([stretch(drag, name="a")]), ["a"]) == "in a"


def test_a_recording_in_which_it_should_be_and_is_not(stretch):
    both = symptoms([stretch(lambda s: np.full(s.n, 2.0), name="a"), stretch(name="b", seed=1)])
    assert in_which_recordings(both, ["a", "b"]) in ("in a, not in b", "in every recording")
    even = symptoms([stretch(lambda s: np.cos(2 * s.phase), name="a"), stretch(name="b", seed=1)])
    assert in_which_recordings(even, ["a", "b"]) == "in a, not in b"


def test_a_recording_in_which_it_would_be_too_small_to_see(stretch):
    def lopsided(s):
        return 4e4 * s.x**2

    even = symptoms([stretch(lopsided, name="loud"), stretch(lopsided, name="quiet", size=2e-4, seed=1)])
    assert even.here == ("loud",)
    assert in_which_recordings(even, ["loud", "quiet"]) == "in loud; in quiet it would be too small to see"


@pytest.mark.parametrize(("part", "too_small"), [(0.4, True), (0.6, False)])
def test_too_small_to_see_is_less_than_half_of_the_noises_power(part, too_small, stretch):
    """The other recording does not have it: what it would have made there grows with the motion's fourth power."""

    def lopsided(s):
        return 4e4 * s.x**2

    def both(size):
        signature = symptoms([stretch(lopsided, name="loud"), stretch(name="quiet", size=size, seed=1)])
        rows, rest = signature.rows, with_kind(signature)
        made = rows.part(rows.left, 1) - rest.part(rest.left, 1)
        return signature, float(made @ made) / float(np.sum(rows.part(rows.silent, 1) ** 2))

    size = 2e-4
    for _ in range(3):
        size *= (part / both(size)[1]) ** 0.25
    signature, ratio = both(size)
    assert ratio == pytest.approx(part, abs=0.05)
    assert signature.here == ("loud",)
    words = "in loud; in quiet it would be too small to see" if too_small else "in loud, not in quiet"
    assert in_which_recordings(signature, ["loud", "quiet"]) == words


def test_a_delay_is_confirmed_by_decays_without_it(stretch):
    def late(s):
        return 5e-2 * s.drive_rate

    sweep, decay = stretch(late, name="sweep"), stretch(name="decay", driven=False, seed=1)
    told = in_which_recordings(symptoms([sweep, decay]), ["sweep", "decay"])
    assert told == "in the forced recordings (sweep); free decay (decay) agrees without it"
    told = in_which_recordings(symptoms([sweep]), ["sweep"])
    assert told == "in the forced recordings (sweep); free decay cannot tell"


# --- how far off


@pytest.mark.parametrize(
    ("times", "words"),
    [
        ((3.0, 12.0, 5.0), " (response off by up to 12 times the noise, in run1)"),
        ((np.inf, 5.0), " (response off by up to 5.00 times the noise, in run1)"),
        ((12.34,), " (response off by up to 12 times the noise, in run0)"),
        ((np.nan,), ""),
    ],
)
def test_the_worst_recording_that_simulates_is_told(times, words):
    records = [
        RecordFit(f"run{i}", False, factor * 2e-3, 0.0, 2e-3, *[np.zeros(0)] * 4, None, Response())
        for i, factor in enumerate(times)
    ]
    assert how_far_off(records) == words
