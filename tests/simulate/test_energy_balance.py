"""The energy balance over whole runs: what is put in and what is dissipated are integrated by the engine itself.

Two further states keep the ledger, so that both powers are integrated with located events and to the same order as the
motion. Nothing but the integration's error is then left, and that falls with the fifth power of the step.
"""

from __future__ import annotations

import ctypes
import re
from dataclasses import replace

import casadi
import numpy as np
import pytest
from dashpot.model.equations import equations, signed
from dashpot.model.law import InnerState
from dashpot.model.laws import LIBRARY
from dashpot.simulate import core
from dashpot.simulate.compiler import shared_library
from dashpot.simulate.force import smooth_force
from dashpot.simulate.law_source import law_source

DT, N, START = 1e-3, 500, 0.4
TIME = START + np.arange(N) * DT
CHIRP = np.sin(2 * np.pi * (8 * (TIME - START) + 8 * (TIME - START) ** 2))
#: Every event at once: contacts that are hit hard and let go of, sliding, sticking, an actuator that rattles.
CROWD = ("two-sided-stop", "hysteresis", "viscoelastic", "attached-resonator", "actuator-backlash", "stiffness-drift")
HARD = {
    "two-sided-stop.stiffness": 2e5,
    "two-sided-stop.position": 1e-3,
    "two-sided-stop.damping": 300.0,
    "hysteresis.stiffness": 2e3,
    "viscoelastic.stiffness": 2e3,
    "attached-resonator.mass-ratio": 0.2,
    "actuator-backlash.gap": 4.8e-4,
    "actuator-backlash.mass": 0.0405,
}


def with_ledger(oscillator):
    """The equations with two more states: energy put in and energy dissipated since the start."""
    eq = equations(oscillator)
    z = casadi.SX.sym("z", eq.z.numel() + 2)
    zdot = casadi.vertcat(eq.zdot, eq.drive * eq.z[1], eq.dissipated)
    own = (zdot, eq.surfaces, eq.surface_rates, eq.y, eq.energy)
    zdot, surfaces, rates, y, energy = casadi.substitute(list(own), [eq.z], [z[:-2]])
    return replace(
        eq,
        z=z,
        zdot=zdot,
        surfaces=surfaces,
        surface_rates=rates,
        y=y,
        energy=energy,
        state_names=(*eq.state_names, "put-in", "dissipated"),
        inner=(*eq.inner, InnerState("put-in", "Q.X"), InnerState("dissipated", "Q.X")),
        reaches=casadi.vertcat(eq.reaches, 0, 0),
    )


@pytest.fixture
def balance(monkeypatch, offsets):
    """``balance(model, kind)``: energy, put in, dissipated (N,) and the states; ``finer`` divides the internal step."""

    def run(model, kind, finer=1, size=1.0):
        with monkeypatch.context() as patched:
            patched.setattr(core, "equations", with_ledger)
            ledger = core.Core(model)
        p = np.array(list(model.values().values()))
        begin = np.array([*([0.0, 0.0] if kind == "driven" else [6e-3, 0.1]), *offsets(model), 0.0, 0.0])
        force = smooth_force(size * CHIRP, DT, 1.0) if kind == "driven" else None
        step = core.internal_step(model, model.values(), 8e-3) / finer
        z = ledger.record(p, begin, force, N, DT, step, start=START, states=True)
        eq = ledger.equations
        plain = casadi.substitute(signed(eq, eq.energy), eq.p, casadi.DM(p))
        energy = casadi.Function("energy", [eq.z, eq.t, eq.u], [plain])(z.T, TIME[None], 0.0)
        return np.array(energy)[0], z[:, -2], z[:, -1], z

    return run


def unbalanced(energy, put_in, dissipated):
    """Largest gap of the balance, as a part of the largest energy."""
    return np.max(np.abs(energy - energy[0] - put_in + dissipated)) / np.max(np.abs(energy))


@pytest.mark.parametrize("kind", ["driven", "released"])
@pytest.mark.parametrize("effect", LIBRARY)
def test_the_energy_of_a_run_is_what_was_put_in_less_what_was_dissipated(effect, kind, with_law, balance):
    model = with_law(effect)
    energy, put_in, dissipated, _ = balance(model, kind)
    assert dissipated[-1] > 0.3 * np.max(energy)  # most of it has gone through the balance
    assert np.ptp(put_in) > 0.3 * np.max(energy) or kind == "released"
    # Dormand and Prince's method at 75 steps a period loses a few 1e-10 of the energy in each; there are 600 at most
    assert unbalanced(energy, put_in, dissipated) < 1e-7
    # four times finer: 4^5 times less, to which an event that made the energy jump would not fall
    assert unbalanced(*balance(model, kind, finer=4)[:3]) < 1e-10


@pytest.mark.parametrize("kind", ["driven", "released"])
def test_the_balance_holds_through_impacts_sticking_and_sliding(kind, with_law, balance):
    model = with_law(*CROWD, dry=2.0, **HARD)
    energy, put_in, dissipated, z = balance(model, kind, size=6.0)
    assert np.max(np.abs(z[:, 0])) > 1.2 * HARD["two-sided-stop.position"]
    assert np.count_nonzero(z[:, 1] == 0.0) > 10  # it sticks in between
    assert unbalanced(energy, put_in, dissipated) < 1e-7
    assert unbalanced(*balance(model, kind, size=6.0, finer=8)[:3]) < 1e-12


# The function of the generated C -------------------------------------------------------------------------------------

_CALL = """
__attribute__((visibility("default"))) void call(const double *z, double t, double u, const double *p, double *out) {
    double s[DP_NS + 1], f[DP_NZ], g[DP_NS + 1], g_rate[DP_NS + 1];
    int i;
    for (i = 0; i < DP_NS; ++i) s[i] = 1.0;
    dp_surface(z, t, u, 0.0, p, s, f, g, g_rate);
    for (i = 0; i < DP_NS; ++i) s[i] = g[i] < 0.0 ? -1.0 : 1.0;
    dp_power(z, t, u, p, s, out);
}
"""


def test_the_generated_function_gives_energy_and_dissipated_power(with_law):
    model = with_law(*CROWD, "softening-stiffness", **HARD)
    eq, p = equations(model), np.array(list(model.values().values()))
    path = shared_library({"law.c": law_source(eq, exported=True), "all.c": f'#include "law.c"\n{_CALL}'}, "all.c")
    doubles = ctypes.POINTER(ctypes.c_double)
    call = ctypes.CDLL(str(path)).call
    call.restype, call.argtypes = None, [doubles, ctypes.c_double, ctypes.c_double, doubles, doubles]
    powers = casadi.vertcat(eq.energy, eq.dissipated)
    expected = casadi.Function("f", [eq.z, eq.t, eq.u, eq.p], [signed(eq, powers)])
    random = np.random.default_rng(1)
    for _ in range(20):
        z, out = random.uniform(-5e-3, 5e-3, eq.z.numel()), np.full(2, np.nan)
        call(z.ctypes.data_as(doubles), 0.7, 0.3, p.ctypes.data_as(doubles), out.ctypes.data_as(doubles))
        assert out == pytest.approx(np.array(expected(z, 0.7, 0.3, p)).ravel(), rel=1e-12)


def test_what_a_fit_runs_does_not_change_with_it(with_law):
    """The functions are the same to the letter, and the further ones are there only where it was asked for."""

    def functions(source):
        code = re.sub(r"\s+", " ", source.partition("#undef CASADI_SYMBOL_EXPORT")[0])
        bodies = re.findall(r"DP_INLINE int casadi_f\d+\(.*?\) \{ (.*?return 0;) \}", code)
        return dict(zip(re.findall(r"CASADI_SYMBOL_EXPORT int (dp_law_[a-z]+)\(const", code), bodies, strict=True))

    eq = equations(with_law(*CROWD))
    without, extended = functions(law_source(eq)), functions(law_source(eq, exported=True))
    assert list(without) == ["dp_law_field", "dp_law_surface", "dp_law_output"]
    assert "dp_power" not in law_source(eq)
    assert extended.pop("dp_law_power").count("res[0][1]") == 1
    assert list(extended) == [*without, "dp_law_physical", "dp_law_tangent"]
    assert {name: extended[name] for name in without} == without
