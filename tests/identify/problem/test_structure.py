"""A structure over the segments of recordings: what of it is free, within which bounds, at which sizes and steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.descent import search
from dashpot.identify.problem.offset import Offset
from dashpot.identify.problem.structure import (
    Fitted,
    Structure,
    parameter_bounds,
    parameter_sizes,
    renamed,
    shapes_of,
    typical_sizes,
    without_states,
)
from dashpot.identify.signals.noise_spectrum import concentrated_likelihood, estimate
from dashpot.model import Oscillator, oscillator_with
from dashpot.model.law import Scales
from dashpot.model.library import find
from dashpot.recording import Recording
from dashpot.simulate.core import internal_step

LINEAR = {"mass": 0.3, "omega0": 60.0, "cubic": 0.0, "preload": 0.0, "viscous": 4.0, "dry": 0.0}
FIXED = ("cubic", "preload", "dry")
SCALES = Scales(length=2e-3, omega=50.0, force=1.0, response=2e-3, duration=4.0, mass=0.3, lines=(30.0,))
FS = 250.0


def with_laws(**values):
    """A model with the laws whose values are given as law__parameter."""
    named = {key.replace("__", ".").replace("_", "-"): value for key, value in values.items()}
    effects = tuple(dict.fromkeys(name.split(".")[0] for name in named))
    return oscillator_with(LINEAR | named, effects=effects)


STOPS = with_laws(
    one_sided_stop__stiffness=900.0, one_sided_stop__position=1e-3, one_sided_stop__damping=0.0,
    two_sided_stop__stiffness=900.0, two_sided_stop__position=1e-3, two_sided_stop__damping=0.0,
    two_sided_stop__offset=1e-4,
    stribeck__excess=0.1, stribeck__speed=0.01, stribeck__exponent=1.0,
    tonal_disturbance__amplitude=0.1, tonal_disturbance__frequency=30.0,
)  # fmt: skip


def fitted(model, initial=None, residuals=(), free=()):
    return Fitted(model, np.zeros((1, 2)) if initial is None else initial, residuals, 0.0, free)


# What the parameters of a structure are ------------------------------------------------------------------------------


def bounds_of(name, model=STOPS):
    return parameter_bounds(model, SCALES)[:, list(model.parameters()).index(name)]


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("mass", 0.3 / 1e3, 0.3 * 1e3),
        ("omega0", 0.1 / 4.0, np.inf),
        ("cubic", -np.inf, np.inf),
        ("one-sided-stop.stiffness", 0.0, np.inf),  # a strength has no fence
        ("one-sided-stop.position", -8.5 * 2e-3, 8.5 * 2e-3),
        ("two-sided-stop.position", 0.025 * 2e-3, 8.5 * 2e-3),
        ("two-sided-stop.offset", -2e-3, 2e-3),  # looked for at zero: within the motion
        ("stribeck.speed", 0.002 * 0.1, 5.0 * 0.1),
        ("stribeck.exponent", 0.5, 3.0),  # a shape keeps its own
        ("tonal-disturbance.frequency", 0.0, np.inf),  # a line of the spectrum is where it is
    ],
)
def test_bounds_lie_ten_times_beyond_where_a_law_is_looked_for(name, low, high):
    assert bounds_of(name) == pytest.approx([low, high])


@pytest.mark.parametrize(("times", "low", "high"), [(0.99, 0.0, 8.5), (1.01, 0.025, 8.5), (340.1, 0.025, np.inf)])
def test_beyond_those_bounds_a_search_may_begin_and_go_on(times, low, high):
    """From where each step threw it back it would rest at once, with all that a step would gain."""
    place = "two-sided-stop.position"
    outside = STOPS.with_parameters({place: replace(STOPS.parameters()[place], value=times * 0.025 * 2e-3)})
    own = {p.name: p for p in find("two-sided-stop").parameters}["position"]
    assert bounds_of(place, outside) == pytest.approx([max(low * 2e-3, own.lower), high * 2e-3])


def test_what_others_are_measured_by_is_never_free():
    laws = ["free/spring/6", "free/damping/6"]
    values = {f"{law}.{p.name}": 0.1 for law in laws for p in find(law).parameters}
    model = oscillator_with(LINEAR | values, effects=laws)
    free = structure_of(decay(), model=model).free
    assert [name for name in values if name not in free] == ["free/spring/6.reach", "free/damping/6.speed"]


def test_a_model_without_a_mass_has_bounds_for_the_rest():
    free = Oscillator.from_values({name: value for name, value in LINEAR.items() if name != "mass"})
    assert bounds_of("omega0", free) == pytest.approx([0.1 / 4.0, np.inf])
    assert parameter_bounds(free, SCALES).shape == (2, 5)


def test_shapes_are_what_waits_for_the_data():
    assert shapes_of(STOPS) == ("two-sided-stop.offset", "stribeck.exponent")
    assert shapes_of(Oscillator.from_values(LINEAR)) == ()


def test_typical_sizes_make_a_hundredth_of_the_force_of_inertia():
    """Each at full amplitude, and through the speed there; what is not known counts by its own size."""
    names = ("mass", "omega0", "cubic", "preload", "viscous", "dry", "other", "nothing")
    values = np.array([-0.3, 60.0, 0.0, 0.0, 0.0, 0.0, -7.0, 0.0])
    mass, omega0, cubic, preload, viscous, dry, other, nothing = typical_sizes(names, values, 2e-3, 50.0)
    inertia = 0.01 * 50.0**2 * 2e-3
    assert (mass, other, nothing) == pytest.approx((0.3, 7.0, 1e-12))
    assert omega0 == pytest.approx(0.01 * 50.0)
    assert cubic * 2e-3**3 == pytest.approx(inertia)
    assert viscous * 50.0 * 2e-3 == pytest.approx(inertia)
    assert (preload, dry) == pytest.approx((inertia, inertia))


def test_sizes_of_a_laws_parameters_are_a_hundredth_of_the_natural_ones():
    sizes = dict(zip(STOPS.parameters(), parameter_sizes(STOPS, SCALES), strict=True))
    assert sizes["one-sided-stop.stiffness"] == pytest.approx(0.01 * 50.0**2)
    assert sizes["one-sided-stop.position"] == pytest.approx(0.01 * 2e-3)
    assert sizes["stribeck.speed"] == pytest.approx(0.01 * 2e-3 * 50.0)
    assert sizes["stribeck.exponent"] == pytest.approx(0.01)
    assert sizes["cubic"] == pytest.approx(0.01 * 50.0**2 / 2e-3**2)


# Fitted models under other names -------------------------------------------------------------------------------------


def test_whether_a_model_simulates():
    assert fitted(STOPS, residuals=(np.zeros(3), np.ones(2))).finite
    assert not fitted(STOPS, residuals=(np.zeros(3), np.array([1.0, np.nan]))).finite


def test_a_law_under_the_name_of_a_more_general_one():
    """Parameters correspond in order, the further one is zero, and another law stays as it is."""
    one = with_laws(clearance__stiffness=900.0, clearance__gap=1e-3, quadratic_drag__coefficient=5.0)
    fit = fitted(one, free=("omega0", "clearance.gap"))
    other = renamed(fit, "clearance", find("two-sided-stop"))
    values = other.model.values()
    assert values["two-sided-stop.stiffness"] == 900.0
    assert values["two-sided-stop.position"] == 1e-3
    assert values["two-sided-stop.damping"] == values["two-sided-stop.offset"] == 0.0
    assert {term.effect for term in other.model.terms} == {"quadratic-drag", "two-sided-stop"}
    assert other.free == ("omega0", "two-sided-stop.position")
    back = renamed(other, "two-sided-stop", find("clearance"))
    assert back.model.values() == pytest.approx(one.values())
    assert back.free == fit.free


def test_states_of_a_law_go_with_it():
    model = with_laws(
        tonal_disturbance__amplitude=0.1, tonal_disturbance__frequency=30.0,
        viscoelastic__stiffness=9.0, viscoelastic__rate=2.0,
    )  # fmt: skip
    fit = fitted(model, np.array([[1.0, 2.0, 3.0, 4.0]]))
    phase_first = model.terms[0].effect == "tonal-disturbance"
    left = without_states(fit, "viscoelastic")
    assert np.array_equal(left, [[1.0, 2.0, 3.0 if phase_first else 4.0]])
    assert np.array_equal(without_states(fit, "quadratic-drag"), fit.initial)


# A structure over data -----------------------------------------------------------------------------------------------


def decay(offset=0.0, n=400):
    t = np.arange(n) / FS
    x = 6e-3 * np.exp(-2 * t) * np.cos(60.0 * t) + 2e-5 * np.random.default_rng(4).standard_normal(n)
    return Recording("decay", FS, x + offset, free=True)


def structure_of(*recordings, model=None, coarse=True, **more):
    model = model or Oscillator.from_values(LINEAR)
    return Structure(model, data_of(recordings, model, coarse=coarse), FIXED, **more)


@pytest.fixture(scope="module")
def sweep(recorded):
    return recorded(LINEAR, sweep=(0.4, 6.0, 13.0), fs=FS, seconds=2.0, offset=2e-3)


def test_free_motion_says_nothing_of_the_mass(sweep):
    assert structure_of(decay()).free == ("omega0", "viscous")
    both = structure_of(decay(), sweep)
    assert both.free == ("mass", "omega0", "viscous")
    names = list(both.model.parameters())
    assert both.problem.free == tuple(names.index(name) for name in both.free)


def test_steps_of_what_is_compared_are_so_many_times_as_long():
    fine = structure_of(decay(), coarse=False)
    step = internal_step(fine.model, fine.model.values(), 6e-3)
    assert fine.problem.max_step == pytest.approx(step)
    assert fine.problem.coarse_step == pytest.approx(3.75 * step)
    compared = structure_of(decay())
    assert compared.problem.max_step == compared.problem.coarse_step == pytest.approx(3.75 * step)
    # what is so fast that a sample would take more than forty steps is not followed
    for pace in (2e4, 1e5):
        fast = replace_omega0(fine, pace)
        step = internal_step(fast.model, fast.model.values(), 6e-3)
        assert fast.problem.coarse_step == pytest.approx(max(3.75 * step, 1 / FS / 40.0))
    assert 3.75 * step < 1 / FS / 40.0


def replace_omega0(structure, omega0):
    return Structure(Oscillator.from_values(LINEAR | {"omega0": omega0}), structure.data, FIXED)


def test_sizes_of_initial_states_are_those_of_the_motion():
    plain = structure_of(decay())
    length, pace = plain.data.scales.length, plain.data.scales.omega
    assert plain.problem.state_scale == pytest.approx([0.01 * length, 0.01 * length * pace])
    assert length == pytest.approx(6e-3, rel=0.05)


def test_offsets_are_those_of_the_data_unless_others_are_given():
    own = (Offset(0, "response", 1e-4, 5e-4),)
    model = Oscillator.from_values(LINEAR)
    data = replace(data_of([decay()], model), offsets=own)
    assert Structure(model, data).problem.offsets == own
    other = (Offset(0, "response", 1e-4, 7e-4), Offset(0, "drift", 1e-4, 0.0))
    assert Structure(model, data, (), other).problem.offsets == other
    assert Structure(model, data, (), ()).problem.offsets == ()


def test_a_start_is_completed():
    own = (Offset(0, "response", 1e-4, 5e-4),)
    model = with_laws(viscoelastic__stiffness=9.0, viscoelastic__rate=2.0)
    structure = Structure(model, data_of([decay(5e-4)], model), (), own)
    state = structure.state(np.array([[1.0, 2.0]]))
    assert np.array_equal(state.initial, [[1.0, 2.0, 0.0]])
    assert np.array_equal(state.offsets, [5e-4])
    assert np.array_equal(structure.state(None, np.array([9e-4])).offsets, [9e-4])
    assert np.array_equal(structure.state(None, np.array([9e-4, 1.0])).offsets, [5e-4])
    assert np.array_equal(structure.state(np.array([[1.0, 2.0, 3.0, 4.0]])).initial, [[1.0, 2.0, 3.0]])
    assert structure.state(None).initial[0, 0] == pytest.approx(6e-3, rel=0.03)  # the sensor's zero is taken off
    assert np.array_equal(state.values, list(model.values().values()))


def test_a_mass_at_rest_where_the_sensor_shows_another_place(sweep):
    """The law tells what the sensor shows at rest; without it the same beginning stands out of the noise."""
    moved = structure_of(decay(), sweep)
    assert [segment.rests for segment in moved.segments if segment.force is not None] == [False]
    still = structure_of(decay(2e-3), sweep, model=with_laws(sensor_offset__offset=2e-3))
    assert [segment.rests for segment in still.segments if segment.force is not None] == [True]
    assert not any(segment.rests for segment in still.segments if segment.force is None)
    state = still.state(np.ones((2, 2)))
    for segment, begin in zip(still.segments, state.initial, strict=True):
        assert np.array_equal(begin, [0.0, 0.0] if segment.rests else [1.0, 1.0])
    nowhere = structure_of(decay(2e-3), sweep, model=with_laws(sensor_offset__offset=np.nan))
    assert nowhere.segments is nowhere.data.segments


def watched(monkeypatch):
    asked = []

    def noted(problem, state, noise=None, **how):
        asked.append((state, noise, how))
        return search(problem, state, noise, **how)

    monkeypatch.setattr("dashpot.identify.problem.structure.search", noted)
    return asked


def test_a_fit_finds_the_rig_in_closed_form(monkeypatch):
    structure = structure_of(decay(), model=Oscillator.from_values(LINEAR | {"omega0": 57.0, "viscous": 6.0}))
    asked = watched(monkeypatch)
    fit = structure.fit()
    values = fit.model.values()
    assert values["omega0"] == pytest.approx(np.hypot(60.0, 2.0), rel=1e-3)
    assert values["viscous"] == pytest.approx(4.0, rel=0.02)
    assert fit.initial[0] == pytest.approx([6e-3, -2 * 6e-3], rel=0.05, abs=2e-3)
    assert fit.free == structure.free
    assert fit.likelihood == pytest.approx(concentrated_likelihood([estimate(fit.residuals[0])]))
    (begun,) = asked[0][2].pop("residuals")
    assert np.array_equal(begun, structure.problem.residuals(asked[0][0])[0])
    assert asked[0][1:] == (None, {"tolerance": 0.5, "most": 25, "informed": False, "tempered": False})
    # what the search begins with is settled where nobody says where it begins
    assert not np.array_equal(asked[0][0].initial, structure.state(None).initial)


@pytest.mark.parametrize("settle", [False, True])
def test_a_given_beginning_is_kept_unless_it_is_to_be_settled(settle, monkeypatch):
    structure = structure_of(decay())
    asked = watched(monkeypatch)
    structure.fit(np.array([[5e-3, 0.0]]), settle=settle, most=1, tolerance=2.0)
    assert np.array_equal(asked[0][0].initial, [[5e-3, 0.0]]) is not settle
    assert asked[0][2]["most"] == 1
    assert asked[0][2]["tolerance"] == 2.0


def test_what_does_not_simulate_is_refused():
    structure = structure_of(decay(), model=Oscillator.from_values(LINEAR | {"cubic": -1e12}))
    with pytest.raises(BadInput, match="does not simulate with its start values"):
        structure.fit()


def test_what_keeps_its_value_keeps_it_beyond_the_bounds_of_a_search():
    model = Oscillator.from_values(LINEAR)
    data, place = data_of([decay()], model, coarse=True), list(model.parameters()).index("omega0")
    assert Structure(model, data).problem.bounds[0][place] > 0.01
    assert Structure(model, data, ("omega0",)).problem.bounds[:, place].tolist() == [-np.inf, np.inf]
