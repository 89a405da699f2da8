"""Each row of the table of zeros and drifts: what it shows, how large it may be, and what a user reads of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.offset import ROWS, FoundOffset, Offset, zeros_along
from dashpot.model import Oscillator
from dashpot.recording import Recording

FS = 200.0
T = np.arange(2000) / FS
RUN = Recording("run", FS, 2e-3 * np.sin(60 * T), 5.0 * np.sin(60 * T), force_unit="N", start=3.0)


@pytest.fixture(scope="module")
def segment():
    model = Oscillator.from_values(
        {"mass": 0.3, "omega0": 60.0, "cubic": 0.0, "preload": 0.0, "viscous": 2.0, "dry": 0.0}
    )
    return data_of([RUN], model, coarse=False).segments[0]


@pytest.mark.parametrize(("channel", "size"), [("response", 2e-5), ("drift", 2e-6), ("force", 5e-2)])
def test_it_is_felt_at_a_hundredth_of_its_channel(channel, size):
    assert Offset.of([RUN], 0, channel).scale == pytest.approx(size / np.sqrt(2), rel=0.01)
    assert Offset.of([replace(RUN, force=None)], 0, "force").scale == 0.0


def test_a_zero_is_shown_all_along_and_a_drift_about_its_middle(segment):
    times = segment.time + np.arange(segment.n) * segment.dt
    offsets = [
        Offset(0, "response", 1.0),
        Offset(0, "drift", 1.0, middle=5.0),
        Offset(0, "force", 1.0),
        Offset(1, "response", 1.0),  # of another recording
    ]
    shown, pushes = zeros_along(offsets, np.array([2e-4, 3e-5, 0.7, 9.0]), segment)
    assert shown == pytest.approx(2e-4 + 3e-5 * (times - 5.0))
    assert pushes == 0.7
    assert zeros_along(offsets[2:], np.array([0.7, 9.0]), segment)[0] == 0.0


@pytest.mark.parametrize("channel", ROWS)
def test_a_user_reads_of_which_channel_it_is_how_large_and_its_error(channel):
    sentence = FoundOffset(0, channel, 0.25, 0.011).sentence(RUN)
    unit = "N" if channel == "force" else "m"
    assert sentence.startswith("run: ")
    assert f"0.250 ± 0.011 {unit} " in sentence
    assert ("force sensor" in sentence) is (channel == "force")
    assert ("drifts" in sentence) is (channel == "drift")
