"""Several recordings as a person hands them over: one that tells nothing is no reason to refuse the others."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput, TellsNothing
from dashpot.recording import recordings_of

FS, N = 200.0, 1000
TIMES = np.arange(N) / FS


def made(size=1.0, seed=0):
    """A response that follows its force at a hundredth of the force, or noise of a micrometre alone."""
    random = np.random.default_rng(seed)
    force = size * np.sin(2 * np.pi * (1.0 + TIMES) * TIMES)
    response = 0.01 * np.roll(force, 3) if size else 0.0
    force = force if size else 0.02 * np.sin(2 * np.pi * (1.0 + TIMES) * TIMES)
    return {"time_s": TIMES, "force_N": force, "x_m": response + 1e-6 * random.standard_normal(N)}


def at_rest():
    return made() | {"x_m": np.zeros(N)}


def short():
    return {name: column[:8] for name, column in made().items()}


def held():
    return made(0.0, 1)


@pytest.mark.parametrize(
    ("mute", "why"), [(at_rest, "the response is 0 m throughout"), (short, "has 8 samples"), (held, "does not reach")]
)
def test_of_several_one_that_tells_nothing_is_left_out_with_its_reason(mute, why):
    first, second = recordings_of(made(), mute(), made(2.0))
    assert (np.ptp(first.response), np.ptp(second.response)) == pytest.approx((0.02, 0.04), rel=0.01)
    (note,) = [note for note in first.notes if "left out" in note]
    assert note.startswith("recording 2: ")
    assert why in note
    with pytest.raises(TellsNothing, match=why):
        recordings_of(mute())
    with pytest.raises(TellsNothing, match=r"recording 1(.|\n)*recording 2"):
        recordings_of(mute(), mute())


def test_a_malformed_one_is_refused_beside_any():
    bad = made() | {"x_m": np.where(np.arange(N) == 500, np.inf, made()["x_m"])}
    with pytest.raises(BadInput, match="recording 2: the response has 1 value"):
        recordings_of(made(), bad)


def test_a_recording_that_was_read_takes_what_chooses_of_it_and_nothing_that_reads():
    (whole,) = recordings_of(made())
    (used,) = recordings_of(whole, part="1:3", hold="zero")
    assert (used.n, used.hold) == (400, "zero")
    assert np.array_equal(used.response, whole.response[200:600])
    assert recordings_of(whole, force="none")[0].force is None
    with pytest.raises(BadInput, match="was read already, and fs says how to read; give it to read"):
        recordings_of(whole, fs=500.0)
    assert len(recordings_of([whole, made(seed=1)], unit="m")) == 2
