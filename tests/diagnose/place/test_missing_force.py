"""The missing force beside the named law, on rigs of another integrator."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose.place.missing_force import _loudest_first, latent_forces
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.structure import Structure
from dashpot.model import Oscillator
from dashpot.model.library import find
from dashpot.model.terms import with_term


def fits(case, effect: str, values: dict[str, float] | None = None):
    """The family's best, and the best with an effect, begun from nothing of it or from values."""
    data = data_of(case.training, case.model)
    family = Structure(case.model, data).fit(settle=True)
    start = with_term(family.model, effect, values or {p.name: 0.0 for p in find(effect).parameters})
    return data, family, Structure(start, data).fit(family.initial, most=30)


def agreement(force) -> float:
    """What part of the named force the smoother finds."""
    return float(force.named @ force.force / (force.named @ force.named))


def test_the_smoother_finds_the_drag_that_the_law_names(rig):
    data, family, mended = fits(rig("single", "quadratic-drag"), "quadratic-drag")
    forces = latent_forces(family, data, mended.model)
    assert {force.file for force in forces} == {"sweep_high", "sweep_low", "ringdown"}
    loudest = max(forces, key=lambda force: np.std(force.force))
    assert agreement(loudest) == pytest.approx(1.0, abs=0.1)
    assert np.corrcoef(loudest.force, loudest.named)[0, 1] > 0.9
    drag = mended.model.values()["quadratic-drag.coefficient"]
    assert loudest.named == pytest.approx(
        drag * loudest.velocity * np.abs(loudest.velocity), abs=0.1 * np.ptp(loudest.named)
    )


def test_a_disturbance_has_its_own_phase_in_each_recording(rig):
    case = rig("single", "tonal-disturbance")
    truth = case.truth["parameters"]
    values = {"amplitude": truth["tone"], "frequency": truth["tone_omega"]}
    data, family, mended = fits(case, "tonal-disturbance", values)
    for force in latent_forces(family, data, mended.model):
        assert np.corrcoef(force.force, force.named)[0, 1] > 0.9
        assert np.sqrt(2) * np.std(force.named) == pytest.approx(truth["tone"], rel=0.01)  # its peak has noise on it


def test_a_delay_is_the_difference_of_two_forces(rig):
    case = rig("single", "time-delay")
    (delay,) = (value for name, value in case.truth["parameters"].items() if name.endswith("_delay"))
    data, family, mended = fits(case, "time-delay", {"delay": delay})
    by_file = {force.file: force for force in latent_forces(family, data, mended.model)}
    assert np.corrcoef(by_file["sweep_high"].force, by_file["sweep_high"].named)[0, 1] > 0.8
    assert not np.any(by_file["ringdown"].named)


def test_nothing_is_named_where_the_sensor_is_to_blame_or_nobody(rig):
    data, family, mended = fits(rig("single", "constant-force"), "sensor-offset")
    assert all(force.named is None for force in latent_forces(family, data, mended.model))
    plain = latent_forces(family, data, None)
    assert all(force.named is None for force in plain)
    assert all(np.all(force.std > 0) and force.force.shape == force.time.shape for force in plain)


# --- which stretches are shown, and what the names make of a motion in closed form

NOISE, STEP, PARTS = 2e-6, 2e-3, 4
FAMILY = Oscillator.from_values(TRUTH)


@pytest.fixture
def smoothed(monkeypatch):
    """``smoothed(*forces)``: what is left over in each segment where the smoother finds these; and what it was asked.

    The motion is a sine of 5 mm at 10 Hz under a force of 2 N that is in phase with its velocity; a force that is None
    is of a segment that cannot be smoothed.
    """

    def make(*forces, recordings=None, times=None, moving=None, stds=None):
        asked = SimpleNamespace(segments=[], families=[], parts=[])

        class Found:
            dt = STEP

            def __init__(self, family, data, index):
                asked.segments.append(index)
                asked.families.append(tuple(term.effect for term in family.terms))
                if forces[index] is None:
                    raise BadInput("it does not oscillate")
                self.all = np.asarray(forces[index], float)
                self.std = 1.0 if stds is None else stds[index]
                self.n = self.all.size

            def most_likely(self, first, last):
                asked.parts.append((first, last))
                return "prior"

            def smooth(self, first=0, last=None, prior=None):
                assert (prior is None) is (last is None)  # a first look has none
                cut = slice(first, last)
                time = np.arange(self.n)[cut] * STEP
                still = np.ones(self.n, bool) if moving is None else moving
                flat = np.zeros(time.size)
                return SimpleNamespace(
                    time=time,
                    displacement=flat,
                    velocity=flat,
                    force=self.all[cut],
                    std=flat + self.std,
                    moving=still[cut],
                )

            def along(self, mass):
                time = np.arange((self.n - 1) * PARTS + 1) * STEP / PARTS
                turn = 2 * np.pi * 10.0 * time
                motion = [5e-3 * np.cos(turn), -5e-3 * 20 * np.pi * np.sin(turn), time, -2.0 * np.sin(turn)]
                return np.column_stack(motion), STEP / PARTS

        monkeypatch.setattr("dashpot.diagnose.place.missing_force.Smoother", Found)
        count = len(forces)
        where = recordings or range(count)
        data = SimpleNamespace(
            segments=[SimpleNamespace(recording=i) for i in where],
            recordings=[SimpleNamespace(name=f"run {i}") for i in range(count)],
            sensor=[NOISE] * count,
        )
        left = [np.full(100, NOISE * factor) for factor in (times or range(count, 0, -1))]
        return SimpleNamespace(model=FAMILY, residuals=left), data, asked

    return make


def test_the_three_recordings_that_show_it_best_are_shown_in_their_order(smoothed):
    before, data, _ = smoothed(*(np.full(50, size) for size in (1.0, 4.0, 2.0, 3.0)))
    assert [force.file for force in latent_forces(before, data, None)] == ["run 1", "run 2", "run 3"]


def test_of_a_recording_the_clearest_stretch_is_shown(smoothed):
    before, data, _ = smoothed(np.full(50, 1.0), np.full(50, 4.0), np.full(50, 2.0), recordings=(0, 0, 1))
    forces = latent_forces(before, data, None)
    assert [(force.file, force.force[0]) for force in forces] == [("run 0", 4.0), ("run 1", 2.0)]


@pytest.mark.parametrize(("forces", "stds", "clearer"), [((3.0, 8.0), (1.0, 2.0), 1), ((2.0, 3.0), (0.5, 1.0), 0)])
def test_the_clearest_is_what_is_most_of_its_standard_deviation(smoothed, forces, stds, clearer):
    before, data, asked = smoothed(*(np.full(50, force) for force in forces), recordings=(0, 0), stds=stds)
    (shown,) = latent_forces(before, data, None)
    assert shown.force[0] == forces[clearer]
    assert asked.parts == [(0, 50), (0, 50)]  # the prior is that of what is shown


def test_the_six_segments_that_leave_most_of_their_noise_are_looked_at(smoothed):
    """What does not simulate at all leaves most, and what cannot be smoothed is left out."""
    times = (1.0, 9.0, np.nan, 2.0, 8.0, 7.0, 6.0, 5.0, 4.0)
    before, data, asked = smoothed(None, *(np.full(50, 1.0) for _ in times[1:]), times=times)
    assert len(latent_forces(before, data, None)) == 3
    assert asked.segments == [2, 1, 4, 5, 6, 7]
    before, data, asked = smoothed(None, np.full(50, 1.0))
    assert [force.file for force in latent_forces(before, data, None)] == ["run 1"]


@pytest.mark.parametrize(("samples", "first"), [(4000, 0), (4001, 1), (9000, 5000)])
def test_of_a_long_segment_four_thousand_samples_are_shown_where_the_force_is_largest(smoothed, samples, first):
    """At rest friction takes any value, and what is missing there says nothing."""
    force, moving = np.full(samples, 0.1), np.ones(samples, bool)
    force[-1] = 3.0
    force[:500], moving[:500] = 10.0, samples == 4000
    before, data, asked = smoothed(force, moving=moving)
    (shown,) = latent_forces(before, data, None)
    assert shown.time == pytest.approx((first + np.arange(4000)) * STEP)
    assert shown.force == pytest.approx(force[first : first + 4000])
    assert asked.parts == [(first, first + 4000)]


def test_a_force_in_the_middle_of_a_long_segment_is_shown_from_the_first_window_that_holds_it(smoothed):
    force = np.zeros(9000)
    force[4500] = 3.0
    before, data, _ = smoothed(force)
    (shown,) = latent_forces(before, data, None)
    assert shown.time[0] == pytest.approx(501 * STEP)


def named(smoothed, force, *effects: str, mass: float | None = TRUTH["mass"], **values: float):
    """What laws make of the sine."""
    before, data, asked = smoothed(force)
    before.model = Oscillator.from_values({n: v for n, v in (TRUTH | {"mass": mass}).items() if v is not None})
    mended = before.model
    for effect in effects:
        mended = with_term(mended, effect, {p.name: values[p.name] for p in find(effect).parameters})
    (shown,) = latent_forces(before, data, mended)
    assert asked.families == [()]
    return shown.named


def test_a_named_law_is_evaluated_on_the_measured_motion(smoothed):
    speed = -5e-3 * 20 * np.pi * np.sin(2 * np.pi * 10.0 * np.arange(200) * STEP)
    force = named(smoothed, np.ones(200), "cubic-damping", coefficient=30.0)
    assert force == pytest.approx(30.0 * speed**3, abs=1e-9)


def test_what_the_family_has_itself_is_not_missing(smoothed):
    before, data, asked = smoothed(np.ones(200))
    before.model = with_term(FAMILY, "cubic-damping", {"coefficient": 30.0})
    (shown,) = latent_forces(before, data, before.model)
    assert shown.named is None
    (shown,) = latent_forces(before, data, with_term(before.model, "quadratic-drag", {"coefficient": 4.0}))
    speed = -5e-3 * 20 * np.pi * np.sin(2 * np.pi * 10.0 * np.arange(200) * STEP)
    assert shown.named == pytest.approx(4.0 * speed * np.abs(speed), abs=1e-9)
    assert asked.families == [("cubic-damping",)] * 2


@pytest.mark.parametrize("mass", [None, 0.5])
def test_what_an_actuator_keeps_back_is_named_per_unit_mass(smoothed, mass):
    drive = -2.0 * np.sin(2 * np.pi * 10.0 * np.arange(200) * STEP)
    force = named(smoothed, np.ones(200), "actuator-saturation", mass=mass, limit=1.5)
    assert force == pytest.approx((drive - np.clip(drive, -1.5, 1.5)) / (mass or 1.0), abs=1e-9)


@pytest.mark.parametrize("phase", [0.7, -2.0])
def test_a_tone_has_the_phase_that_the_smoother_found_and_its_own_size(smoothed, phase):
    turn = 2 * np.pi * 25.0 * np.arange(200) * STEP  # ten whole cycles
    force = named(smoothed, 3.0 * np.cos(turn + phase), "tonal-disturbance", amplitude=0.4, frequency=2 * np.pi * 25.0)
    assert force == pytest.approx(0.4 * np.cos(turn + phase), abs=1e-6)
    # where nothing of it is found it has the phase zero
    still = named(smoothed, np.zeros(200), "tonal-disturbance", amplitude=0.4, frequency=2 * np.pi * 25.0)
    assert still == pytest.approx(-0.4 * np.cos(turn), abs=1e-6)


def test_a_force_beside_a_tone_is_none_of_the_tones_phase(smoothed):
    """What another law makes is taken off before the phase is sought."""
    turn, speed = 2 * np.pi * 10.0 * np.arange(200) * STEP, -5e-3 * 20 * np.pi
    drag = 30.0 * (speed * np.sin(turn)) ** 3
    tone = 0.01 * np.cos(turn + 0.7)
    values = {"coefficient": 30.0, "amplitude": 0.01, "frequency": 2 * np.pi * 10.0}
    force = named(smoothed, drag + tone, "cubic-damping", "tonal-disturbance", **values)
    assert force == pytest.approx(drag + tone, abs=1e-6)


@pytest.mark.parametrize("effects", [("sensor-offset",), ("cubic-damping", "sensor-offset")])
def test_a_sensors_fault_is_no_force(smoothed, effects):
    assert named(smoothed, np.ones(200), *effects, coefficient=30.0, offset=1e-3) is None


def test_what_has_no_noise_or_runs_away_is_looked_at_first():
    """A recording of few digits, or one that is exact, has a noise of zero: nothing is divided by it."""
    quiet, loud, lost = np.full(100, 1e-3), np.full(100, 1e-2), np.array([1e-3, np.inf])
    assert _loudest_first([quiet, loud, quiet], [1e-4, 1e-2, 1e-6]) == [2, 0, 1]
    assert _loudest_first([quiet, loud, quiet], [1e-4, 1e-2, 0.0])[0] == 2
    assert _loudest_first([quiet, loud, lost], [1e-4, 1e-2, 1e-4])[0] == 2
