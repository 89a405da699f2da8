"""Start values from all recordings together."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.identify.hilbert.freevib import freevib
from dashpot.identify.identification import identify
from dashpot.identify.motion.displacement import displacement
from dashpot.identify.start.start import hilbert_start, plain_starts
from dashpot.recording.recording import Recording

DATA = Path(os.environ.get("DASHPOT_DATA", Path(__file__).parents[4] / "shared" / "data"))


def record(case, name="record", noise=0.0, seed=0):
    case = case.noisy(noise * 1e-6, noise * 1e-3, seed)
    return Recording(name, case.fs, case.x, case.force)


@pytest.fixture(scope="module")
def burst(rigs):
    return rigs.case(rigs.reference, rigs.bursts(1.0, 13.0, 1.0, 3.0), 1000.0, 8.0)


def test_reference_rig(rigs, burst, reference_sweeps):
    rig = rigs.reference
    records = [record(c, f"r{i}", 1.0, i) for i, c in enumerate((burst, *reference_sweeps))]
    estimate = hilbert_start(records)
    tolerances = {"mass": 1e-4, "omega0": 1e-4, "viscous": 1e-3, "cubic": 0.01, "preload": 3e-3, "dry": 0.01}
    for name, rel in tolerances.items():
        assert getattr(estimate, name) == pytest.approx(getattr(rig, name), rel=rel), name
    assert estimate.notes == ()
    assert [c.method for c in estimate.curves] == ["freevib", "freevib", "regression", "regression"]
    # the curve fits say the same without the regression
    assert estimate.backbone.omega0 == pytest.approx(rig.omega0, rel=1e-4)
    assert estimate.backbone.cubic == pytest.approx(rig.cubic, rel=0.02)
    assert estimate.backbone.preload == pytest.approx(rig.preload, rel=0.01)
    assert estimate.damping.viscous == pytest.approx(rig.viscous, rel=2e-3)
    assert estimate.damping.dry == pytest.approx(rig.dry, rel=0.02)


def test_without_any_force_the_mass_is_none(rigs, burst):
    estimate = hilbert_start([Recording("b", 1000.0, burst.noisy(1e-6, 0, 2).x)])
    assert estimate.mass is None
    assert estimate.omega0 == pytest.approx(rigs.reference.omega0, rel=1e-3)
    assert estimate.viscous == pytest.approx(rigs.reference.viscous, rel=0.01)


@pytest.mark.parametrize("quantity", ["velocity", "acceleration"])
def test_other_response_quantities(rigs, reference_sweeps, reference_decay, quantity):
    rig, records = rigs.reference, []
    for case in (reference_sweeps[1], reference_decay):
        drive = 0.0 if case.force is None else case.force / rig.mass
        y = case.v
        if quantity == "acceleration":
            spring = rig.omega0**2 * case.x + rig.cubic * case.x**3 + rig.preload * np.sign(case.x)
            y = drive - rig.viscous * case.v - rig.dry * np.sign(case.v) - spring
        records.append(Recording(quantity, case.fs, y + 0.02 * np.std(y), case.force, quantity))
    inner = slice(2000, -2000)
    assert np.max(np.abs(displacement(records[0]).samples - reference_sweeps[1].x)[inner]) < 2e-3 * 9e-3
    estimate = hilbert_start(records)
    assert estimate.mass == pytest.approx(rig.mass, rel=0.005)
    assert estimate.omega0 == pytest.approx(rig.omega0, rel=0.002)
    assert estimate.viscous == pytest.approx(rig.viscous, rel=0.02)
    assert estimate.cubic == pytest.approx(rig.cubic, rel=0.1)


@pytest.mark.parametrize("seed", range(4))
def test_other_rigs_from_one_hertz_to_two_hundred(rigs, seed):
    rng = np.random.default_rng(100 + seed)
    f0, mass, size = 10 ** rng.uniform(0, 2.3), 10 ** rng.uniform(-2, 2), 10 ** rng.uniform(-4, -1)
    w0, ratio, per_cycle = 2 * np.pi * f0, 10 ** rng.uniform(-2, -1), 10 ** rng.uniform(1, 2)
    rig = rigs.Rig(
        mass,
        w0,
        cubic=rng.uniform(-0.2, 0.5) * w0**2 / size**2,
        preload=rng.uniform(0, 0.5) * ratio * w0**2 * size,
        viscous=2 * ratio * w0,
        dry=rng.uniform(0, 0.1) * ratio * w0**2 * size,
    )
    fs, level = per_cycle * f0, 2 * ratio * w0**2 * mass * size
    kinds = {
        "sweep": rigs.sweep(level, 1.6 * f0, 0.4 * f0, 150 / f0, 5 / f0),
        "multisine": rigs.multisine(level, 0.4 * f0, 1.6 * f0, 40 / f0, seed),
    }
    kind = "sweep" if seed % 2 else "multisine"
    case = rigs.case(rig, kinds[kind], fs, 150 / f0, substeps=int(np.ceil(100 / per_cycle)))
    case = case.noisy(0.003 * np.std(case.x), 1e-3, seed)
    estimate = hilbert_start([Recording(kind, fs, case.x, case.force)])
    assert estimate.omega0 == pytest.approx(w0, rel=0.005)
    assert estimate.mass == pytest.approx(mass, rel=0.01)
    assert estimate.viscous + estimate.dry / (w0 * size) == pytest.approx(rig.viscous + rig.dry / (w0 * size), rel=0.05)


def test_low_amplitude_leaves_the_cubic_at_zero(rigs):
    case = rigs.case(rigs.reference, None, 1000.0, 2.0, x0=1e-3).noisy(1e-6, 0, 1)
    estimate = hilbert_start([Recording("small", 1000.0, case.x)])
    assert estimate.cubic == 0.0
    assert estimate.cubic_std > 4.6e5
    assert estimate.omega0 == pytest.approx(rigs.reference.omega0, rel=1e-3)


t = np.arange(3000) / 1000.0
ODD = {
    "zeros": np.zeros(1000),
    "two samples": np.array([0.0, 1.0]),
    "noise": np.random.default_rng(0).standard_normal(3000),
    "ramp": t,
    "sine": np.sin(80 * t),
    "growing": np.exp(t) * np.sin(80 * t),
    "too coarse": np.exp(-t) * np.sin(2 * np.pi * 400 * t),
    "short": np.sin(80 * t[:300]),
}


@pytest.mark.parametrize("force", [None, "zero", "constant", "unrelated"])
@pytest.mark.parametrize("quantity", ["displacement", "acceleration"])
@pytest.mark.parametrize("name", ODD)
def test_odd_records_give_numbers_or_one_sentence(name, quantity, force):
    x = ODD[name]
    column = {"zero": np.zeros(x.size), "constant": np.ones(x.size), "unrelated": np.cos(0.07 * np.arange(x.size))}
    records = [Recording(name, 1000.0, x, None if force is None else column[force], quantity)]
    if name in ("zeros", "two samples"):
        with pytest.raises(BadInput, match="oscillat"):
            hilbert_start(records)
        return
    estimate = hilbert_start(records)
    assert np.all(np.isfinite([estimate.omega0, estimate.cubic, estimate.preload, estimate.viscous, estimate.dry]))
    assert estimate.omega0 > 0 < estimate.viscous
    assert estimate.mass is None or estimate.mass > 0
    if force in (None, "zero", "constant"):
        assert estimate.mass is None


def test_no_recording_is_refused():
    with pytest.raises(BadInput):
        hilbert_start([])


def test_silverbox_multisines_and_arrow_agree():
    path = DATA / "silverbox_snls80mv.csv.gz"
    if not path.exists():
        pytest.skip("silverbox_snls80mv.csv.gz is not here; set DASHPOT_DATA to the folder that has it")
    table = np.genfromtxt(path, delimiter=",", skip_header=1)
    a, b = (
        hilbert_start([Recording("silverbox", 1e7 / 2**14, table[i:j, 1], table[i:j, 0], unit="V", force_unit="V")])
        for i, j in ((40650, 57000), (20000, 36000))
    )
    assert a.omega0 == pytest.approx(b.omega0, rel=2e-3)
    assert a.mass == pytest.approx(b.mass, rel=5e-3)
    assert a.cubic == pytest.approx(b.cubic, rel=0.05)


@pytest.mark.parametrize("fs", [500.0, 2000.0])
@pytest.mark.parametrize("changed", [{}, {"preload": 0.3}, {"cubic": 1.5e6}])
def test_curves_of_an_exact_accelerometer_decay_do_not_contradict_its_regression(recorded, changed, fs):
    """Integrated twice, the small end of a backbone drifts, and what it is extrapolated to at rest with it."""
    decay = recorded(TRUTH | changed, begin=(8e-3, 0.0), seconds=3.0, fs=fs, quantity="acceleration")
    estimate = hilbert_start([decay])
    assert estimate.curves
    assert not any("differ" in note for note in estimate.notes)


@pytest.mark.parametrize(("part", "told"), [(1.04, False), (1.06, True), (0.94, True)])
def test_a_backbone_elsewhere_over_most_amplitudes_is_told(recorded, monkeypatch, part, told):
    def elsewhere(signal):
        curve = freevib(signal)
        return replace(curve, omega0=part * curve.omega0)

    monkeypatch.setattr("dashpot.identify.start.start.freevib", elsewhere)
    estimate = hilbert_start([recorded(TRUTH, begin=(8e-3, 0.0), seconds=3.0)])
    assert any("differ by" in note for note in estimate.notes) == told


def test_four_swings_and_then_rest_where_friction_left_it_start_near_their_own_frequency():
    """The step from the release to the rest is larger than a tenth of the record's spectrum can tell from a line."""
    rig = {"mass": 1.0, "omega0": 65.0, "cubic": -2e7, "preload": 0.0, "viscous": 10.0, "dry": 0.44}
    x, _ = integrate_pieces(rig, np.zeros((490, 2)), 1 / 350.0, 4.3e-3, 0.0)
    seen = x + 1.6e-5 * np.random.default_rng(0).standard_normal(x.size)
    recording = Recording("stops", 350.0, seen)
    assert hilbert_start([recording]).omega0 == pytest.approx(65.0, rel=0.1)
    assert plain_starts(hilbert_start([recording]), [recording])[-1]["omega0"] == pytest.approx(65.0, rel=0.1)
    parameters = identify([recording]).oscillator.parameters()
    for name in ("omega0", "cubic", "viscous", "dry"):
        assert parameters[name].value == pytest.approx(rig[name], abs=3 * parameters[name].std)


@pytest.mark.parametrize("quantity", ["displacement", "velocity"])
def test_a_switched_force_is_not_the_frequency_of_the_motion(quantity):
    """From one rest to the next it goes farther than it rings, as a command in steps is largest at no frequency."""
    force = np.repeat([0.0, 1.0, 1.4], [700, 500, 800])
    rig = {"mass": 2.0, "omega0": 40.0, "cubic": 0.0, "preload": 0.0, "viscous": 12.0, "dry": 0.0}
    moved = integrate_pieces(rig, force[:, None], 2e-3, 0.0, 0.0)[0 if quantity == "displacement" else 1][: force.size]
    shown = moved + 1e-3 * np.ptp(moved) * (np.random.default_rng(2).standard_normal(force.size) + 5.0)
    start = hilbert_start([Recording("steps", 500.0, shown, force, quantity=quantity)])
    assert start.omega0 == pytest.approx(rig["omega0"], rel=0.1)


def test_what_rings_between_steps_of_force_is_the_rig_whatever_a_regression_makes_of_it():
    """An acceleration shows of a step its ringing alone; integrated twice it drifts, and a regression finds a slide."""
    rig = {"mass": 0.56, "omega0": 28.7, "cubic": 0.0, "preload": 0.0, "viscous": 6.67, "dry": 0.0}
    fs, n = 75.0, 2288
    force = np.repeat([0.0, 0.68, -0.46, 0.06], [1030, 530, 400, n - 1960])
    x, v = (y[:n] for y in integrate_pieces(rig, force[:, None], 1 / fs))
    shown = force / rig["mass"] - rig["omega0"] ** 2 * x - rig["viscous"] * v
    shown = shown + 4e-3 * np.random.default_rng(0).standard_normal(n)
    record = Recording("steps", fs, shown, force, quantity="acceleration", unit="m/s2")
    assert hilbert_start([record]).omega0 == pytest.approx(rig["omega0"], rel=0.02)
