"""Parts of recordings by the amplitude of their motion, where that is known in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import Recording, from_data, read, read_records, recordings_of
from dashpot.recording.by_amplitude import amplitudes_of, of_amplitude

FS, OMEGA, H, PEAK = 1000.0, 2 * np.pi * 12.0, 1.25, 8e-3
T = np.arange(4000) / FS
RELEASE = PEAK * np.exp(-H * T) * np.cos(OMEGA * T)


def decay(*, zero=0.0, noise=1e-7, before=0, after=0):
    quiet = np.concatenate([np.zeros(before), RELEASE, np.zeros(after)])
    return Recording("decay.csv", FS, zero + quiet + noise * np.random.default_rng(0).standard_normal(quiet.size))


def instant(amplitude):
    """When the envelope has fallen to an amplitude, s."""
    return math.log(PEAK / amplitude) / H


@pytest.mark.parametrize("zero", [0.0, 3e-3])
@pytest.mark.parametrize(
    ("text", "begin", "end"),
    [
        ("5mm", instant(5e-3), 4.0),
        ("1mm..5mm", instant(5e-3), instant(1e-3)),
        ("1..5mm", instant(5e-3), instant(1e-3)),
        ("1000um..0.5 cm", instant(5e-3), instant(1e-3)),
        ("2mm..", 0.0, instant(2e-3)),
        ("..2 mm", instant(2e-3), 4.0),
    ],
)
def test_a_decay_is_cut_where_its_envelope_says(text, begin, end, zero):
    (part,) = of_amplitude(decay(zero=zero), amplitudes_of(text))
    cycle = 2 * np.pi / OMEGA
    assert part.start == pytest.approx(begin, abs=0.6 * cycle)
    assert part.start + part.duration == pytest.approx(end, abs=0.6 * cycle)
    first = round(part.start * FS)
    np.testing.assert_array_equal(part.response, decay(zero=zero).response[first : first + part.n])
    assert part.name == "decay.csv"
    assert any("are used, where the amplitude is" in note for note in part.notes)


def test_rest_before_a_release_is_no_small_motion():
    (part,) = of_amplitude(decay(before=1500), amplitudes_of("5mm"))
    assert part.start == pytest.approx(1.5 + instant(5e-3), abs=0.05)


def test_several_releases_are_several_parts(tmp_path):
    pulled = PEAK * 0.5 * (1 - np.cos(np.pi * np.arange(200) / 200))
    signal = np.concatenate([pulled, RELEASE[:3800], RELEASE[3799] + (1 - RELEASE[3799] / PEAK) * pulled, RELEASE])
    both = Recording("two.csv", FS, signal + 1e-7 * np.random.default_rng(1).standard_normal(signal.size))
    parts = of_amplitude(both, amplitudes_of("1mm..4mm"))
    assert [part.start for part in parts] == pytest.approx([0.2 + instant(4e-3), 4.2 + instant(4e-3)], abs=0.05)
    assert len({part.name for part in parts}) == 2
    assert {part.name.partition("#")[0] for part in parts} == {"two.csv"}
    path = tmp_path / "two.csv"
    rows = zip(np.arange(signal.size) / FS, both.response, strict=True)
    path.write_text("time_s,x_m\n" + "\n".join(f"{t:.3f},{x:.9g}" for t, x in rows))
    assert len(read_records(path, amplitude="1mm..4mm")) == len(recordings_of(path, amplitude="1mm..4mm")) == 2
    with pytest.raises(BadInput, match=r"two\.csv: has 2 parts of such an amplitude; read_records gives all"):
        read(path, amplitude="1mm..4mm")


def test_a_cycle_is_one_of_the_motion_not_one_release_of_many():
    decay_rate, noise = 6.0, np.random.default_rng(3)
    held = np.concatenate([0.5 * (1 - np.cos(np.pi * np.arange(100) / 100)), np.ones(300)])
    freed = np.exp(-decay_rate * T[:1600]) * np.cos(OMEGA * T[:1600])
    once = PEAK * np.concatenate([held, freed])
    many = Recording("many.csv", FS, np.tile(once, 7) + 1e-7 * noise.standard_normal(7 * once.size))
    parts = of_amplitude(many, amplitudes_of("0.2mm..5mm"))
    begun = 0.4 + 2.0 * np.arange(7)
    cycle = 2 * np.pi / OMEGA
    for amplitude, at in ((5e-3, [p.start for p in parts]), (2e-4, [p.start + p.duration for p in parts])):
        np.testing.assert_allclose(at, begun + math.log(PEAK / amplitude) / decay_rate, atol=0.6 * cycle)


def test_the_free_parts_of_a_driven_recording_are_decays(tmp_path):
    """Between bursts the force is noise, which by itself would be refused as one that moves nothing."""
    dice, count = np.random.default_rng(2), 8000
    force = np.where(np.arange(count) % 4000 < 600, np.sin(OMEGA * np.arange(count) / FS), 0.0)
    state, moved, step = 0j, [], np.exp((-H + 1j * OMEGA) / FS)
    for push in force.tolist():
        state = step * state - 1j * push / FS / OMEGA
        moved.append(state.real)
    noisy = force + 1e-3 * dice.standard_normal(count), moved + 1e-8 * dice.standard_normal(count)
    rows = zip(np.arange(count) / FS, *noisy, strict=True)
    path = tmp_path / "bursts.csv"
    path.write_text("time_s,force_N,x_m\n" + "\n".join(f"{t:.3f},{f:.6f},{x:.10g}" for t, f, x in rows))
    largest = np.abs(moved).max()
    parts = recordings_of(path, amplitude=(0.05 * largest, 0.7 * largest))
    free = [part for part in parts if part.force is None]
    assert [round(part.start + part.duration) for part in free] == [3, 7]
    assert all(part.force is not None for part in parts if part.start % 4 < 0.5)


def test_numbers_are_in_the_unit_of_the_response():
    held = of_amplitude(decay(), amplitudes_of((1e-3, 5e-3)))[0].response
    np.testing.assert_array_equal(held, of_amplitude(decay(), amplitudes_of("1mm..5mm"))[0].response)
    made = from_data({"fs": FS, "x_mm": 1e3 * decay().response}, amplitude=5e-3)
    assert made.n < T.size


def test_all_of_it_is_the_recording_itself():
    recording = decay()
    assert of_amplitude(recording, amplitudes_of("1m")) == [recording]
    assert of_amplitude(recording, None) == [recording]
    assert amplitudes_of("") is amplitudes_of(None) is None


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ("five", "is not understood; write such as 5mm"),
        ("..", "is not understood"),
        ("mm", "is not understood"),
        ("1mm..5mm..9mm", "is not known"),
        ("5 furlong", "unit 'furlong' is not known"),
        ("5mm..1mm", "holds none; .* the smaller one first"),
        ("1V..5mm", "is from V to mm"),
        (0.0, "holds none"),
        ((5e-3, 1e-3), "holds none"),
        ((1, 2, 3), "amplitude, .*must be|amplitude must be|not"),
        ("2g", "--amplitude is in g, and the response is a displacement in m; give it in m, or a unit of the same"),
        ("50mm..90mm", r"moves with amplitudes from .* to 7\.\d+ mm, and nowhere for 3 cycles with 50 to 90 mm"),
    ],
)
def test_what_is_no_amplitude_is_one_sentence(given, says):
    with pytest.raises(BadInput, match=says):
        of_amplitude(decay(), amplitudes_of(given))
