"""FMUs against independent integrators: the error stays below what is promised at any amplitude and any steps.

The force is a straight line between communication points. FMI 2 is told its slope by fmi2SetRealInputDerivatives, FMI 3
by the input F_rate. The stand is held against the Taylor series of ``examples``; other laws against that of the
actuator with backlash and against the integrator of the concealed rigs, none of which share code with the product.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from dashpot.examples.actuator_backlash import integrate_with_backlash
from dashpot.examples.concealed.engine import Drive, simulate
from dashpot.examples.oscillator import integrate_pieces, linear_pieces
from dashpot.examples.truth import TRUTH as STAND
from dashpot.export.fmu import export_fmu
from dashpot.model import oscillator_with

#: Of the peak, as promised.
CLOSE = 1e-6
SECONDS = 6.0
VERSIONS = (2, 3)


def points(pattern: str) -> np.ndarray:
    """Communication points, s: every 1 ms, every 10 ms, or after 0.1 to 15 ms each."""
    if pattern == "irregular":
        steps = np.random.default_rng(3).uniform(1e-4, 15e-3, round(SECONDS / 7.55e-3))
        return np.concatenate([[0.0], np.cumsum(steps)])
    step = {"1 ms": 1e-3, "10 ms": 1e-2}[pattern]
    return np.arange(round(SECONDS / step) + 1) * step


def sweep(t: np.ndarray, amplitude: float) -> np.ndarray:
    """5 to 20 Hz, through the resonance."""
    return amplitude * np.sin(2 * np.pi * (5.0 + 7.5 * t / SECONDS) * t)


@pytest.fixture(scope="module")
def run() -> Callable[..., np.ndarray]:
    """``run(fmu, t, force)``: (n,) first output at the points t, the force in straight lines between them."""
    import shutil

    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave
    from fmpy.fmi3 import FMU3Slave

    def of(path: Path, t: np.ndarray, force: np.ndarray) -> np.ndarray:
        known = read_model_description(str(path))
        two = known.fmiVersion == "2.0"
        at = {v.name: v.valueReference for v in known.modelVariables}
        folder = extract(str(path))
        fmu = (FMU2Slave if two else FMU3Slave)(
            guid=known.guid if two else known.instantiationToken,
            unzipDirectory=folder,
            modelIdentifier=known.coSimulation.modelIdentifier,
            instanceName="rig",
        )
        fmu.instantiate()
        if two:
            fmu.setupExperiment(startTime=t[0])
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        put, take = (fmu.setReal, fmu.getReal) if two else (fmu.setFloat64, fmu.getFloat64)
        x = [take([at["x"]])[0]]
        steps = np.diff(t)
        slopes = (np.diff(force) / steps).tolist()
        for now, dt, value, slope in zip(t.tolist(), steps.tolist(), force.tolist(), slopes, strict=False):
            put([at["F"]], [value])
            if two:
                fmu.setRealInputDerivatives([at["F"]], [1], [slope])
            else:
                put([at["F_rate"]], [slope])
            fmu.doStep(now, dt)
            x.append(take([at["x"]])[0])
        fmu.terminate()
        fmu.freeInstance()
        shutil.rmtree(folder, ignore_errors=True)
        return np.array(x)

    return of


def reference(values: dict[str, float], t: np.ndarray, force: np.ndarray) -> np.ndarray:
    """(n,) displacement by Taylor series, step by step, whatever their lengths."""
    x, v, displacements = 0.0, 0.0, [0.0]
    for dt, now, then in zip(np.diff(t).tolist(), force[:-1], force[1:], strict=True):
        (_, x), (_, v) = integrate_pieces(values, np.array([[now, then - now]]), dt, float(x), float(v))
        displacements.append(x)
    return np.array(displacements)


def error(x: np.ndarray, exact: np.ndarray) -> float:
    assert x.shape == exact.shape
    return np.max(np.abs(x - exact)) / np.max(np.abs(exact))


@pytest.mark.parametrize("pattern", ["1 ms", "10 ms", "irregular"])
@pytest.mark.parametrize("amplitude", [1.0, 0.1, 0.03])
def test_the_stand(run, fmu_of, models, amplitude, pattern):
    t = points(pattern)
    force = sweep(t, amplitude)
    values = models["base"]().values()
    exact = reference(values, t, force)
    for version in VERSIONS:
        assert error(run(fmu_of(version), t, force), exact) < CLOSE


@pytest.mark.parametrize("version", VERSIONS)
def test_results_do_not_depend_on_the_step(run, fmu_of, version):
    """The same force, whose knots are 10 ms apart, in steps of 10 ms, of 1 ms, and irregular ones."""
    knots = points("10 ms")
    force = sweep(knots, 1.0)
    coarse = run(fmu_of(version), knots, force)
    between = np.random.default_rng(5).uniform(0.0, knots[-1], 3 * knots.size)
    for t in (points("1 ms"), np.union1d(knots, between)):
        t[np.searchsorted(t, knots - 1e-9)] = knots
        fine = run(fmu_of(version), t, np.interp(t, knots, force))[np.searchsorted(t, knots)]
        assert error(fine, coarse) < CLOSE


#: A law, what it is given beside the stand's parameters, and the same in the concealed rigs' own words.
A, W2 = 7e-3, STAND["omega0"] ** 2
LAWS = {
    "two-sided-stop": (
        {"stiffness": 5 * W2, "position": 0.6 * A, "damping": 20.0, "offset": 0.05 * A},
        {"up_stiffness": 5 * W2, "up_at": 0.65 * A, "up_damping": 20.0}
        | {"down_stiffness": 5 * W2, "down_at": 0.55 * A, "down_damping": 20.0},
    ),
    "clearance": (
        {"stiffness": 0.5 * W2, "gap": 0.5 * A},
        {"clearance_stiffness": 0.5 * W2, "clearance_gap": 0.5 * A},
    ),
    "stribeck": (
        {"excess": 0.3, "speed": 0.03, "exponent": 1.0},
        {"stribeck_excess": 0.3, "stribeck_speed": 0.03, "stribeck_power": 1.0},
    ),
    "hysteresis": (
        {"stiffness": 0.2 * W2, "limit": 0.2 * A, "exponent": 1.0, "loading": 0.6},
        {"bouc_stiffness": 0.2 * W2, "bouc_power": 1.0, "bouc_beta": 3 / A, "bouc_gamma": 2 / A},
    ),
}
BACKLASH = {"gap": 4e-5, "mass": 0.04, "stiffness": 6e4, "damping": 25.0, "guide": 0.0}


def exact_with(law: str, t: np.ndarray, force: np.ndarray) -> np.ndarray:
    """(n,) displacement of the stand with one law more."""
    dt = float(t[1] - t[0])
    if law == "actuator-backlash":
        total = STAND["mass"] + BACKLASH["mass"]  # there the mass is that of both parts
        values = {name: value * STAND["mass"] / total for name, value in STAND.items()}
        values |= {"mass": total, "omega0": STAND["omega0"] * (STAND["mass"] / total) ** 0.5}
        names = dict(zip(BACKLASH, ("half_gap", "moving_mass", "contact_stiffness", "contact_damping"), strict=False))
        actuator = {new: BACKLASH[old] for old, new in names.items()} | {"guide_friction": 0.0}
        return integrate_with_backlash(values, actuator, linear_pieces(force), dt)[:, 0]
    drive = Drive("straight", 1.0, ramp=0.0, lines=np.column_stack([force[:-1], np.diff(force)]))
    values = {name: value for name, value in STAND.items() if name != "omega0"}
    sizes = {"omega2": W2, "omega": STAND["omega0"], "amplitude": A, "force": 1.0}
    return simulate(values | sizes | LAWS[law][1], drive, 0.0, 1 / dt, t.size, 1e-13, 300.0).x


@pytest.mark.long
@pytest.mark.parametrize("law", [*LAWS, "actuator-backlash"])
def test_further_laws(run, law, tmp_path):
    """In steps of 1 ms and of 10 ms; the law is no small part of the motion."""
    given = BACKLASH if law == "actuator-backlash" else LAWS[law][0]
    values = STAND | {f"{law}.{name}": value for name, value in given.items()}
    model = oscillator_with(values, effects=(law,))
    fmus = [export_fmu(model, tmp_path / f"{version}.fmu", version=version) for version in VERSIONS]
    fine = points("1 ms")[:3001]
    for every in (1, 10):
        t = fine[::every]
        force = sweep(t, 1.0)
        samples = np.interp(fine, t, force)
        exact = exact_with(law, fine, samples)[::every]
        assert error(reference(STAND, fine, samples)[::every], exact) > 1e4 * CLOSE
        for fmu in fmus:
            assert error(run(fmu, t, force), exact) < CLOSE
