"""Derivatives carried along a run against central differences of plain runs, across every kind of event."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.prediction import prediction_gain
from dashpot.model import Oscillator, Response, oscillator_with
from dashpot.model.laws import LIBRARY
from dashpot.simulate.core import core_of, internal_step
from dashpot.simulate.force import smooth_force, staircase, straight_lines
from dashpot.simulate.sides import Sides
from hypothesis import strategies as st

DT, N, START = 1e-3, 400, 0.4
T = np.arange(N) * DT
CHIRP = np.sin(2 * np.pi * (8 * T + 8 * T**2))
HOLDS = {
    "none": lambda size: None,
    "zero": lambda size: staircase(size * CHIRP),
    "linear": lambda size: straight_lines(size * CHIRP, DT),
    "smooth": lambda size: smooth_force(size * CHIRP, DT, 100.0),
}
UNITS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}
GAINS = {name: prediction_gain(3.0, TRUTH["omega0"], DT, name) for name in UNITS}


class Run:
    """A run of one model from one beginning: plain with one unknown moved, or with derivatives."""

    def __init__(self, model, begin, force, n=N, measured=None, step=None, initial_scales=None):
        self.core, self.n = core_of(model), n
        self.values, self.begin = np.array(list(model.values().values())), np.array(begin, float)
        self.step, self.force = step or internal_step(model, model.values(), 8e-3), force
        self.measured, self.gain = measured, None
        self.by = list(range(len(self.core.unknowns) - 2 * (measured is None)))
        if measured is not None:
            self.gain = np.zeros(self.core.states)
            self.gain[:2] = GAINS[model.response.quantity]
        #: Natural sizes of the unknowns.
        initial = [8e-3, 0.6, *(initial_scales or [1.0] * (self.core.states - 2))]
        self.scales = [*np.maximum(np.abs(self.values), 1e-3), *initial, 0.1, 8e-3, 2e-2]

    def plain(self, unknown=0, by=0.0, **more):
        values, begin, count = self.values.copy(), self.begin.copy(), self.values.size
        measured = self.measured
        if unknown < count:
            values[unknown] += by
        elif unknown < count + self.core.states:
            begin[unknown - count] += by
        elif unknown == count + self.core.states:
            more["load"] = by
        elif measured is not None:
            measured = measured + by * (1.0 if self.core.unknowns[unknown] == "measured" else T[: self.n])
        return self.core.record(
            values, begin, self.force, self.n, DT, self.step, start=START, measured=measured, gain=self.gain, **more
        )

    def carried(self, **more):
        arguments = (self.values, self.begin, self.force, self.n, DT, self.step)
        options = {"by": self.by, "start": START, "measured": self.measured, "gain": self.gain}
        return self.core.record_with_derivatives(*arguments, **options, **more)

    def errors(self, steps):
        """How far the derivatives are from the best of Richardson's differences with these steps, largest to largest.

        A sample that shows another side of an event in the neighbouring runs, and the one behind it, is left out: there
        the response jumps and has no derivative.
        """
        own = self.core.signs(self.n)
        response = self.plain(keep=own)
        shown, derivatives = self.carried()
        assert np.array_equal(shown, response, equal_nan=True)
        return {
            self.core.unknowns[unknown]: min(self._error(unknown, size, derivatives[k], own) for size in steps)
            for k, unknown in enumerate(self.by)
        }

    def _error(self, unknown, size, derivative, own):
        differences, same = [], np.ones(self.n, bool)
        for h in (size * self.scales[unknown], 0.5 * size * self.scales[unknown]):
            sides = []
            for by in (h, -h):
                signs = self.core.signs(self.n)
                sides.append(self.plain(unknown, by, keep=signs))
                same &= np.all(signs == own, axis=1)
            if not np.all(np.isfinite(sides)):  # so long a step that the motion grows beyond bounds
                return np.inf
            differences.append((sides[0] - sides[1]) / (2 * h))
        apart = np.abs((4 * differences[1] - differences[0]) / 3 - derivative)
        same[1:] &= same[:-1].copy()
        if np.mean(same) < 0.5:
            return np.inf
        felt = 1e-7 * np.max(np.abs(self.plain())) / self.scales[unknown]  # less is rounding in any difference
        return np.max(apart[same]) / max(np.max(np.abs(derivative)), felt)


def rig(quantity="displacement", **changed):
    return Oscillator.from_values(TRUTH | changed, response=Response(quantity, UNITS[quantity]))


@pytest.mark.parametrize("hold", HOLDS)
@pytest.mark.parametrize("quantity", UNITS)
def test_of_a_smooth_motion_they_are_those_of_fine_differences(quantity, hold):
    """Without dry friction and preload no surface is felt, and a difference by Richardson is good to 1e-9."""
    errors = Run(rig(quantity, dry=0.0, preload=0.0), (6e-3, 0.1), HOLDS[hold](1.0)).errors([3e-3, 1e-3, 3e-4])
    felt = {name: error for name, error in errors.items() if name not in ("dry", "preload")}  # which are felt in jumps
    assert max(felt.values()) < 1e-8, felt


@pytest.mark.parametrize("hold", HOLDS)
@pytest.mark.parametrize("quantity", UNITS)
def test_across_crossings_sticking_and_breaking_away(quantity, hold):
    run = Run(rig(quantity, dry=4.0, preload=1.0, viscous=60.0), (6e-3, 0.1), HOLDS[hold](1.5))
    signs = run.core.signs(N)
    run.plain(keep=signs)
    held = signs[:, -1] >= 0
    assert np.sum(held[1:] != held[:-1]) >= (1 if hold == "none" else 10)  # where it is driven it breaks away again
    errors = run.errors([1e-2, 1e-4, 1e-5, 1e-6])
    assert max(errors.values()) < 1e-7, errors


@pytest.mark.parametrize("quantity", UNITS)
def test_of_a_prediction_with_a_memory(quantity):
    measured = Run(rig(quantity, omega0=81.0), (5e-3, 0.0), HOLDS["smooth"](1.5)).plain()
    run = Run(rig(quantity, dry=2.0, preload=1.0), (6e-3, 0.1), HOLDS["smooth"](1.5), measured=measured)
    assert [run.core.unknowns[place] for place in run.by[-2:]] == ["measured", "drift"]
    errors = run.errors([1e-2, 1e-4, 1e-5, 1e-6])
    assert max(errors.values()) < 1e-7, errors


def test_they_go_where_they_are_asked_to_and_in_single_precision_too():
    run = Run(rig(dry=0.5, preload=1.0), (6e-3, 0.1), HOLDS["smooth"](1.0))
    derivatives = run.carried()[1]
    for kind in (float, np.float32):
        out = np.full((len(run.by) + 3, N), 7.0, kind)
        places = [1, *range(3, len(run.by) + 2)]
        assert run.carried(out=out, rows=places)[1] is out
        assert np.array_equal(out[places], derivatives.astype(kind))
        assert np.all(np.delete(out, places, axis=0) == 7.0)


@pytest.mark.parametrize("hold", HOLDS)
def test_the_other_sides_of_jumps_are_those_under_the_signs_of_their_neighbours(hold):
    """Against runs under other signs, the derivatives too, as the run itself gives them at each sample."""
    run, sides, bare = Run(rig("acceleration", dry=4.0, preload=3.0), (6e-3, 0.1), HOLDS[hold](3.0)), Sides(), Sides()
    signs = run.core.signs(N)
    assert np.array_equal(run.plain(keep=signs, sides=bare), run.carried(sides=sides)[0])
    assert np.array_equal(bare.at, sides.at)
    assert np.array_equal(bare.shown, sides.shown)
    before = np.flatnonzero(np.any(signs[1:] != signs[:-1], axis=1))
    assert {*sides.at} - {0} == {*before, *(before + 1)} - {0}
    assert before.size >= 4
    for there, beside in ((before, before + 1), (before + 1, before)):
        across = signs.copy()
        across[there] = signs[beside]
        response, derivatives = run.carried(signs=across)
        for at in there:
            same = np.flatnonzero((sides.at == at) & (sides.shown == response[at]))
            assert any(np.array_equal(sides.derivatives[:, place], derivatives[:, at]) for place in same)


@pytest.mark.parametrize(
    ("begin", "sign"), [((1e-6, 0.1), -1.0), ((-1e-6, -0.1), 1.0), ((2e-4, -0.1), 0.0), ((3e-4, 0.1), 0.0)]
)
def test_of_the_first_sample_those_that_the_motion_has_crossed_within_an_interval_before_it(begin, sign):
    """With the preload on its other side; 0.3 mm at 0.1 m/s would have been three intervals ago."""
    run, sides = Run(rig("acceleration", dry=0.0, preload=3.0), begin, None), Sides()
    response = run.plain(sides=sides)
    first = np.flatnonzero(sides.at == 0)
    assert first.size == (sign != 0.0)
    assert sides.shown[first] - response[0] == pytest.approx(np.full(first.size, -sign * 2 * 3.0), rel=1e-9)


def test_a_sample_between_two_jumps_is_there_in_every_way():
    """So few samples that friction turns and the preload is crossed about the same one."""
    run, sides = Run(rig("acceleration", dry=1.0, preload=3.0), (6e-3, 0.1), None), Sides()
    core, signs = run.core, run.core.signs(N)
    arguments = (run.values, run.begin, None, 40, 0.025, run.step)
    own = core.record(*arguments, keep=signs, sides=sides)
    between = 1 + np.flatnonzero(np.any(signs[2:40] != signs[1:39], axis=1) & np.any(signs[1:39] != signs[:38], axis=1))
    assert between.size >= 3
    for i in between:
        ways = []
        for beside in (signs[i - 1], signs[i + 1]):
            ways.append(beside)
            ways += [np.where(np.arange(signs.shape[1]) == k, beside, signs[i]) for k in range(signs.shape[1])]
        expected = set()
        for way in ways:
            across = signs.copy()
            across[i] = way
            expected.add(core.record(*arguments, signs=across)[i])
        assert {*sides.shown[sides.at == i], own[i]} == expected | {own[i]}


#: An inner state that decays within few internal steps is itself integrated to 1e-5: its derivatives are no better.
COARSE = 1e-4


def of_what_has_any(errors, model, hold):
    """The errors of derivatives that there are.

    A size that others are measured by is never fitted: as it moves the knots of a curve, it has kinks. Where nothing
    drives, a load on either side of zero is another side of a drive that asks for the sign of its force.
    """
    without = {f"{t.effect}.{p.name}" for t in model.terms for p in t.law.parameters if p.scale}
    if hold == "none" and any(term.effect == "actuator-quadratic" for term in model.terms):
        without.add("load")
    return {name: error for name, error in errors.items() if name not in without}


@pytest.mark.parametrize("hold", ["none", "smooth"])
@pytest.mark.parametrize("effect", LIBRARY)
def test_of_every_law(effect, hold, with_law, offsets):
    reach = {f"{effect}.signal": 20.0} if effect.startswith("free/sensor") else {}  # of an accelerometer, in m/s²
    model = with_law(effect, quantity="acceleration", dry=0.5, **reach)
    inner = offsets(model)
    run = Run(model, (6e-3, 0.1, *inner), HOLDS[hold](1.0), initial_scales=inner)
    errors = of_what_has_any(run.errors([100.0, 1.0, 1e-2, 1e-4, 1e-5, 1e-6]), model, hold)
    assert max(errors.values()) < COARSE, errors


def test_of_a_sensor_that_follows_the_acceleration_of_a_mass_at_rest(with_law, offsets):
    """While friction holds the mass, the sensor's state feels what each surface carries."""
    model = with_law("sensor-lag", quantity="acceleration", dry=4.0, viscous=60.0, **{"sensor-lag.time": 0.02})
    inner = offsets(model)
    run = Run(model, (1e-3, 0.02, *inner), HOLDS["smooth"](1.5))
    signs = run.core.signs(N)
    run.plain(keep=signs)
    assert 0.1 < np.mean(signs[:, -1] >= 0) < 0.9
    errors = run.errors([1e-3, 1e-4, 1e-5])
    assert max(errors.values()) < 1e-7, errors


def test_of_a_sensor_on_a_mass_that_breaks_away_from_time_to_time(with_law, offsets):
    """At the last stages before it does the forces are beyond what holds it by rounding, and the share that a surface
    carries has a slope there as well."""
    effects = ("quadratic-stiffness", "actuator-backlash", "sensor-lag")
    model = with_law(*effects, quantity="acceleration", dry=3.0, preload=0.07)
    inner = offsets(model)
    run = Run(model, (6e-3, 0.1, *inner), HOLDS["zero"](0.3), initial_scales=inner)
    signs = run.core.signs(N)
    run.plain(keep=signs)
    held = signs[:, -1] >= 0
    assert np.sum(held[1:] != held[:-1]) >= 10
    errors = run.errors([1.0, 1e-2, 1e-4, 1e-5, 1e-6])
    assert max(errors.values()) < 1e-6, errors


def test_of_an_event_that_another_brings_about_at_once(with_law, offsets):
    """The contact of a backlash begins with the force of its damper, which a saturation behind it takes in: the force
    is beyond the limit from the same instant on."""
    model = with_law("actuator-backlash", "actuator-saturation", dry=0.0, preload=0.0)
    inner = offsets(model)
    errors = Run(model, (6e-3, 0.1, *inner), None, initial_scales=inner).errors([1e-2, 1e-4, 1e-5, 1e-6])
    assert max(errors.values()) < 1e-6, errors


def test_of_a_prediction_that_rests_on_the_seat_of_a_preload():
    """What was measured there would move it off, but that the preload pushes it back at once."""
    measured = 1.02 * Run(rig(dry=3.0, preload=5.0), (6e-3, 0.1), None).plain()
    run = Run(rig(dry=3.0, preload=5.0), (6e-3, 0.1), None, measured=measured)
    response, derivatives = run.carried()
    assert np.all(response[-100:] == 0.0)
    assert np.all(derivatives[:, -100:] == 0.0)
    errors = run.errors([1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
    assert max(errors.values()) < 1e-6, errors


structures = st.fixed_dictionaries(
    {
        "effects": st.lists(st.sampled_from(list(LIBRARY)), min_size=0, max_size=3, unique=True),
        "quantity": st.sampled_from(list(UNITS)),
        "dry": st.sampled_from([0.0, 0.015, 0.5, 3.0, 8.0]),
        "preload": st.sampled_from([0.0, 0.07, 1.0, 5.0]),
        "hold": st.sampled_from(list(HOLDS)),
        "size": st.sampled_from([0.3, 1.0, 2.0]),
        "predicts": st.booleans(),
    }
)


def test_of_any_structure(every, with_law, offsets):
    def holds(drawn):
        signal = {"displacement": 8e-3, "velocity": 0.6, "acceleration": 20.0}[drawn["quantity"]]
        reach = {f"{name}.signal": signal for name in drawn["effects"] if name.startswith("free/sensor")}
        own = {"dry": drawn["dry"], "preload": drawn["preload"], **reach}
        model = with_law(*drawn["effects"], quantity=drawn["quantity"], **own)
        inner, force = offsets(model), HOLDS[drawn["hold"]](drawn["size"])
        begin, measured = (6e-3, 0.1, *inner), None
        if drawn["predicts"]:
            measured = 1.02 * Run(model, begin, force).plain()
        fine = 0.25 * internal_step(model, model.values(), 8e-3)  # a lag that decays in one step and a half is coarse
        run = Run(model, begin, force, measured=measured, initial_scales=inner, step=fine)
        if np.all(np.isfinite(run.plain())):
            # the short ones for a motion that nearly grazes a surface: beyond, it does in the neighbouring run
            errors = run.errors([100.0, 1.0, 1e-2, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8])
            errors = of_what_has_any(errors, model, drawn["hold"])
            assert max(errors.values()) < COARSE, errors

    every(structures, holds, usual=60)


def test_under_signs_that_were_kept_a_sample_has_the_derivative_of_its_side():
    """Beside a jump of the acceleration a sample under the signs of the other side has the derivative of that side."""
    run = Run(rig("acceleration", preload=3.0), (6e-3, 0.1), None)
    signs = run.core.signs(N)
    run.plain(keep=signs)
    across = signs.copy()
    before = np.flatnonzero(np.any(signs[1:] != signs[:-1], axis=1))
    assert before.size >= 4
    across[before] = signs[before + 1]
    response, derivatives = run.carried(signs=across)
    assert np.array_equal(response, run.plain(signs=across))
    place, h = run.core.unknowns.index("preload"), 1e-6
    quotient = (run.plain(place, h, signs=across) - run.plain(place, -h, signs=across)) / (2 * h)
    assert np.max(np.abs(quotient - derivatives[place])) < 1e-5 * np.max(np.abs(quotient))
    own = run.carried()[1][place]
    assert np.max(np.abs((own - derivatives[place])[before])) > 1.0  # of sgn x one each side


def test_at_rest_they_rest():
    """A mass that friction holds keeps what it came to rest with, and has no velocity by any unknown."""
    run = Run(rig("velocity", dry=8.0, preload=0.0), (6e-3, 0.0), None)
    response, derivatives = run.carried()
    rests = np.flatnonzero(response != 0.0)[-1] + 1
    assert rests < N - 50
    assert np.all(derivatives[:, rests:] == 0.0)
    run = Run(rig("displacement", dry=8.0, preload=0.0), (6e-3, 0.0), None)
    derivatives = run.carried()[1]
    assert np.all(derivatives[:, rests:] == derivatives[:, rests : rests + 1])
    assert np.any(derivatives[:, rests])


def test_a_motion_at_rest_that_nothing_holds_is_moved_by_a_load():
    """Without friction a rig at rest under no force rests by balance alone: a load moves it as a linear rig."""
    model = rig(dry=0.0, preload=0.0, cubic=0.0, viscous=0.0, mass=2.0)
    run = Run(model, (0.0, 0.0), np.zeros(N))
    response, derivatives = run.carried()
    assert np.all(response == 0.0)
    w = model.values()["omega0"]
    expected = (1 - np.cos(w * T)) / (2.0 * w**2)
    assert derivatives[run.core.unknowns.index("load")] == pytest.approx(expected, abs=1e-7 * np.max(expected))
    place = run.core.unknowns.index("initial displacement")
    assert derivatives[place] == pytest.approx(np.cos(w * T), abs=1e-7)


def test_a_bounce_mirrors_them():
    """At a stop so stiff that its contact takes no time, displacement and derivative go back as they came."""
    values = {"omega0": 10.0, "cubic": 0.0, "preload": 0.0, "viscous": 0.0, "dry": 0.0}
    stop = {"one-sided-stop.stiffness": 1e10, "one-sided-stop.position": -1e-9, "one-sided-stop.damping": 0.0}
    model = oscillator_with({**values, **stop}, effects=("one-sided-stop",))
    run = Run(model, (8e-3, 0.0), None, step=1e-6)
    response, derivatives = run.carried()
    expected = np.abs(np.cos(10.0 * T))
    away = expected > 0.05
    assert np.max(np.abs(response - 8e-3 * expected)[away]) < 1e-3 * 8e-3
    assert np.max(np.abs(derivatives[run.core.unknowns.index("initial displacement")] - expected)[away]) < 1e-3


def test_near_a_grazing_contact_they_grow_with_the_root_of_the_distance():
    """A motion reaches the seat of a preload at its turning point, where the force jumps at no velocity: how long it is
    beyond goes with the root of how far, and the derivative with the inverse of that."""
    values = {"mass": 1.0, "omega0": 80.0, "cubic": 0.0, "preload": 5.0, "viscous": 0.0, "dry": 0.0}
    middle, sizes = 5e-3, []
    for beyond in (1e-2, 1e-4, 1e-6):
        force = np.full(N, middle * 80.0**2 + 5.0)
        run = Run(Oscillator.from_values(values), (2 * middle * (1 + beyond), 0.0), force)
        sizes.append(np.max(np.abs(run.carried()[1][run.core.unknowns.index("initial displacement")])))
    assert sizes[1] / sizes[0] == pytest.approx(10.0, rel=0.1)
    assert sizes[2] / sizes[1] == pytest.approx(10.0, rel=0.1)


def test_a_simulation_that_fails_has_no_derivatives_from_there_on():
    run = Run(rig(cubic=-4.6e8), (1e-2, 0.0), None)
    response, derivatives = run.carried()
    assert np.isnan(response[-1])
    assert np.array_equal(np.isnan(derivatives), np.broadcast_to(np.isnan(response), derivatives.shape))


def test_more_unknowns_than_go_side_by_side_and_fewer():
    run = Run(rig(dry=0.5, preload=1.0), (6e-3, 0.1), HOLDS["smooth"](1.0))
    derivatives = run.carried()[1]
    run.by = [*run.by, *run.by, *run.by[::-1]]
    assert np.array_equal(run.carried()[1], np.concatenate([derivatives, derivatives, derivatives[::-1]]))
    run.by = [3]
    assert np.array_equal(run.carried()[1], derivatives[3:4])
    run.by = []
    assert run.carried()[1].shape == (0, N)


def test_threads_do_not_meet():
    run = Run(rig("acceleration", dry=2.0, preload=1.0), (6e-3, 0.1), HOLDS["smooth"](1.5))
    alone = run.carried()
    with ThreadPoolExecutor(4) as pool:
        for response, derivatives in pool.map(lambda _: run.carried(), range(16)):
            assert np.array_equal(response, alone[0])
            assert np.array_equal(derivatives, alone[1])
