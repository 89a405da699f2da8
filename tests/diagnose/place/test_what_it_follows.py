"""The plainest coordinate that explains a missing force: its thresholds on either side, and forces put in by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.place.free_form import _slider, rows_of
from dashpot.diagnose.place.what_it_follows import _kind, symptoms, with_kind

NOTHING = dict.fromkeys(
    (
        "constant",
        "delay",
        "time",
        "displacement",
        "velocity",
        "damping by position",
        "sensor",
        "force",
        "displacement and velocity",
        "memory",
    ),
    0.0,
)
TONE = 3.37


def kind(**shares):
    return _kind(NOTHING | {name.replace("_", " "): share for name, share in shares.items()})


def test_the_plainest_that_explains_nine_tenths_of_the_best_is_taken():
    assert kind(constant=0.79, displacement=0.9) == "displacement"
    assert kind(constant=0.82, displacement=0.9) == "constant"
    assert kind(displacement=0.75, memory=0.85) == "memory"
    assert kind(displacement=0.78, memory=0.85) == "displacement"


def test_a_memory_must_be_better_than_both_coordinates_by_a_quarter():
    assert kind(displacement_and_velocity=0.69, velocity=0.6, memory=0.85) == "velocity"
    assert kind(displacement_and_velocity=0.67, velocity=0.6, memory=0.85) == "memory"


def test_of_both_coordinates_the_one_that_explains_more():
    for name in ("displacement", "velocity", "damping by position"):
        assert kind(displacement_and_velocity=0.9, **{name.replace(" ", "_"): 0.5}) == name


@pytest.mark.parametrize("name", ["tone", "ringing"])
def test_a_line_is_taken_where_it_explains_as_much_as_anything(name):
    assert kind(**{name: 0.78}, memory=0.85) == name
    assert kind(**{name: 0.75}, memory=0.85) == "memory"
    assert kind(**{name: 0.36}) == name
    assert kind(**{name: 0.34}, velocity=0.30) == "unknown"


def test_less_than_a_third_tells_only_where_no_stranger_tells_as_much():
    assert kind(velocity=0.36, time=0.32) == "velocity"
    assert kind(velocity=0.34, time=0.25) == "unknown"
    assert kind(velocity=0.34, time=0.24) == "velocity"
    assert kind(velocity=0.34, displacement_and_velocity=0.33) == "velocity"  # a relative
    assert kind(velocity=0.13) == "velocity"
    assert kind(velocity=0.11) == "unknown"


# --- forces put in by hand


@pytest.mark.parametrize(
    ("name", "path", "force"),
    [
        ("constant", "restoring", lambda s: np.full(s.n, 2.0)),
        ("displacement", "restoring", lambda s: 4e3 * np.maximum(s.x - 2e-3, 0.0)),
        ("velocity", "dissipation", lambda s: 60.0 * s.v * np.abs(s.v)),
        ("damping by position", "dissipation", lambda s: 2e6 * s.x**2 * s.v),
        ("delay", "excitation", lambda s: 5e-2 * s.drive_rate),
        ("force", "excitation", lambda s: 3.0 * np.clip(s.drive, -0.8, 0.8)),
        ("time", "environment", lambda s: 3e2 * s.x * s.time),
        ("tone", "environment", lambda s: 0.3 * np.cos(2 * np.pi * TONE * s.time)),
    ],
)
def test_a_force_is_followed_to_its_path(name, path, force, stretch):
    signature = symptoms([stretch(force, name="sweep"), stretch(force, name="decay", driven=name != "delay", seed=1)])
    assert signature.kind == name, signature.shares
    assert signature.path == path
    assert "sweep" in signature.here


def test_a_tone_that_rings_with_the_motion_is_a_second_body(stretch):
    def ringing(level):
        return lambda s: level * np.cos(2 * np.pi * TONE * s.time)

    signature = symptoms([stretch(ringing(0.5), name="loud"), stretch(ringing(0.2), name="quiet", seed=1)])
    assert signature.kind == "ringing"
    assert signature.path == "inertia"
    assert signature.line is not None
    assert not signature.line.steady


def test_noise_follows_nothing_and_is_nowhere(stretch):
    signature = symptoms([stretch(), stretch(name="other", seed=1)])
    assert signature.here == ()
    assert signature.line is None


def test_each_recording_is_named_once_and_only_where_it_is(stretch):
    def even(s):  # no odd term of the family can bend itself to it
        return np.cos(2 * s.phase)

    signature = symptoms([stretch(even, name="a"), stretch(even, name="a", seed=1), stretch(name="b", seed=2)])
    assert signature.here == ("a",)


@pytest.mark.parametrize(("part", "name"), [(0.25, "unknown"), (0.5, "memory")])
def test_a_memory_keeps_step_with_the_motion(part, name, stretch):
    """Beside a force that remembers, one that keeps step with nothing: two fifths of the power must be in step."""

    def both(s):
        remembers = rows_of([replace(s, missing=2e3 * _slider(s.x, 3e-4))]).left
        wanders = np.random.default_rng(3).standard_normal(s.n)
        return np.sqrt(part) * remembers / np.std(remembers) + np.sqrt(1 - part) * wanders

    signature = symptoms([stretch(both, cycles=400)])
    assert max(signature.shares, key=lambda kind: signature.shares[kind]) == "memory"
    assert signature.shares["memory"] == pytest.approx(part, abs=0.05)
    assert (sum(signature.orders.values()) > 0.4) == (name == "memory")
    assert signature.kind == name


def test_the_rest_is_without_what_the_kind_explains(stretch):
    signature = symptoms([stretch(lambda s: 60.0 * s.v * np.abs(s.v))])
    rest = with_kind(signature)
    assert signature.kind == "velocity"
    assert rest.left @ rest.left < 1.5 * (rest.silent @ rest.silent) < 0.2 * (signature.rows.left @ signature.rows.left)
    assert np.array_equal(rest.target, signature.rows.target)
