"""The picture of a recording: its samples, its units, what is not shown."""

from __future__ import annotations

import numpy as np
from dashpot.recording import Recording

T = np.arange(200) / 100.0


def test_response_and_force_stand_over_time():
    recording = Recording("run", 100.0, 1e-3 * np.sin(T), np.cos(T), start=2.0, blank=((10, 20), (50, 60)))
    figure = recording.plot()
    response, force = figure.axes
    assert np.array_equal(response.lines[0].get_ydata(), recording.response)
    assert np.array_equal(force.lines[0].get_xdata(), recording.time)
    assert (response.get_ylabel(), force.get_ylabel()) == ("Displacement", "Force")
    assert response.yaxis.get_major_formatter()(1e-3) == "1 mm"
    assert len(response.patches) == 2
    assert [text.get_text() for text in response.get_legend().get_texts()] == ["not shown"]
    assert figure._repr_svg_().startswith("<svg")


def test_a_decay_has_one_axis_and_odd_units_stand_beside_it():
    (axes,) = Recording("run", 100.0, np.sin(T), unit="counts").plot().axes
    assert axes.get_ylabel() == "Displacement [counts]"
    assert axes.get_xlabel() == "Time [s]"


def test_a_long_recording_makes_a_small_picture():
    long = Recording("run", 1000.0, np.sin(np.arange(200_000)))
    assert len(long.plot()._repr_svg_()) < 400_000
