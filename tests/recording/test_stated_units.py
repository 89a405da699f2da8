"""Units beyond doubt: rotation by many turns where the user says so, counts, pixels, a command in counts."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import read
from dashpot.recording.checks import check
from dashpot.recording.clipping import clipping
from dashpot.recording.recording import Recording

FS = 500.0
TIME = np.arange(2000) / FS
SWING = np.exp(-0.8 * TIME) * np.sin(2 * np.pi * 4.0 * TIME)


def written(folder, header, *columns):
    path = folder / "rig.csv"
    np.savetxt(path, np.column_stack([TIME, *columns]), "%.9g", ",", header=header, comments="")
    return path


def test_a_torsion_wire_turns_many_times_where_the_user_says_so(tmp_path):
    path = written(tmp_path, "time_s,phi_rad", 49.0 * SWING)
    with pytest.raises(BadInput, match="turns; the unit is probably deg"):
        read(path)
    assert read(path, unit="rad").unit == "rad"


def test_a_stated_unit_of_length_is_still_held_against_what_solids_bear(tmp_path):
    with pytest.raises(BadInput, match="m/s"):
        read(written(tmp_path, "time_s,x", 49.0 * SWING), unit="m")


@pytest.mark.parametrize(
    ("header", "unit"), [("time_s,x_px", "px"), ("time_s,angle_V", "V"), ("time_s,angle_counts", "counts")]
)
def test_what_a_camera_a_transducer_and_an_encoder_give_out(tmp_path, header, unit):
    recording = read(written(tmp_path, header, 400.0 * SWING))
    assert (recording.quantity, recording.unit) == ("displacement", unit)
    assert np.max(recording.response) == pytest.approx(np.max(400.0 * SWING), rel=1e-6)


def swept(limit, step):
    """A command that is cut at its limit, jagged by its converter; a response of few steps follows it."""
    from scipy.signal import lsim

    command = 200.0 * np.sin(2 * np.pi * (1.0 * TIME + 0.8 * TIME**2))
    command = np.clip(command + 1.5 * np.random.default_rng(3).standard_normal(TIME.size), -limit, limit)
    position = lsim(([1.0], [1.0, 2.0, 900.0]), command, TIME)[1]
    return Recording("swept.csv", FS, np.round(100.0 * position / step) * step, np.round(command), unit="counts")


def clippings(recording):
    return [problem.severity for problem in check(recording) if "clipped" in problem.sentence]


def test_a_force_that_hides_less_than_the_noise_of_the_response_is_said_and_used():
    assert clippings(swept(196.0, 8.0)) == ["note"]


def test_a_force_that_hides_more_than_the_noise_of_the_response_is_refused():
    assert clippings(swept(196.0, 0.02)) == ["error"]
    assert clippings(swept(180.0, 8.0)) == ["error"]


@pytest.mark.parametrize("share", [0.95, 0.8, 0.6])
def test_what_a_cut_sine_hides_is_estimated(share):
    whole = np.sin(2 * np.pi * 2.0 * TIME)
    cut = np.clip(whole, -share, share)
    rails = clipping(cut)
    a_peak = float(np.sum((whole - cut) ** 2)) / 16  # of two each in eight cycles
    hidden = sum(rail.hidden for rail in rails) / sum(rail.visits for rail in rails)
    assert a_peak / 3 < hidden < 1.5 * a_peak
