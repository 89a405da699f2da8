"""The model in Modelica: its text is of the grammar, its equations have CasADi's numbers, and it runs as the engine."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from importlib.util import find_spec

import casadi
import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.export import export
from dashpot.export.facts import Facts
from dashpot.export.modelica import modelica_model
from dashpot.export.program import program
from dashpot.model import Oscillator
from dashpot.model.laws import LIBRARY
from dashpot.simulate.core import core_of
from dashpot.simulate.force import smooth_force
from modelica_text import Model, Reader, Run
from written import of_model, points, same


def text_of(model: Oscillator) -> str:
    return modelica_model(program(Facts(model)), "rig")


def read(model: Oscillator) -> Model:
    return Reader(text_of(model)).model()


@pytest.mark.parametrize("part_of_library", range(3))
def test_every_law_has_the_numbers_of_casadi_between_events(with_law, part_of_library):
    for effect in list(LIBRARY)[part_of_library::3]:
        compared(with_law(effect))


def compared(model: Oscillator) -> None:
    """With the signs that the state shows, away from rest: the plain expression of the equations."""
    of, p = of_model(model)
    eq, written, symbols = of.eq, read(model), [state.symbol for state in of.states]
    plain = casadi.Function("plain", [eq.z, eq.u, eq.p, eq.t, eq.s], [casadi.densify(eq.zdot), eq.y[0]])
    got, wanted = [], []
    for z, u, t in points(model):
        z = np.where(z[:2].tolist() + [1.0] * (z.size - 2), z, 1e-3)  # nothing rests
        run = Run(written, lambda _, u=u: u, dict(zip(symbols, z, strict=True)))
        run.time, run.frozen = t, None
        rates = run.rates(dict(zip(symbols, map(float, z), strict=True)), t)
        signs = [run.value(f"s{i + 1}") for i in range(len(of.surfaces))]
        rate, shown = plain(z, u, p, t, signs)
        got.append([*(rates[name] for name in symbols), run.value("x")])
        wanted.append([*np.array(rate).ravel(), float(shown)])
        g = np.array(casadi.Function("g", [eq.z, eq.u, eq.p, eq.t, eq.s], [eq.surfaces])(z, u, p, t, signs)).ravel()
        assert signs == list(np.where(g > 0, 1.0, -1.0))
    same(got, np.array(wanted))


@pytest.mark.parametrize("effect", LIBRARY)
def test_pymoca_reads_it(with_law, effect):
    if find_spec("pymoca") is None:
        pytest.skip("pymoca, a compiler of Modelica, is not installed")
    from pymoca import parser

    tree = parser.parse(text_of(with_law(effect)))
    assert tree is not None
    assert "rig" in tree.classes


DT, N = 1e-3, 400


def engine(model: Oscillator, begin: list[float], force: np.ndarray) -> np.ndarray:
    """(N, states) as the engine runs it."""
    facts = Facts(model)
    p = np.array(list(facts.values.values()))
    pieces = smooth_force(force, DT, 1.0) if np.any(force) else None
    return core_of(model).record(p, np.array(begin), pieces, N, DT, facts.longest, states=True)


def modelica(model: Oscillator, begin: list[float], force: Callable[[float], float]) -> np.ndarray:
    """(N, states) as the text runs."""
    symbols = [state.symbol for state in of_model(model)[0].states]
    run = Run(read(model), force, dict(zip(symbols, begin, strict=True)))
    return np.array([list(run.until(k * DT, DT / 2).values()) for k in range(N)])


@pytest.mark.parametrize("effect", [None, "stribeck", "hysteresis", "two-sided-stop", "actuator-saturation"])
@pytest.mark.parametrize("kind", ["free", "driven"])
def test_it_runs_as_the_engine_does(with_law, effect, kind):
    """0.4 s with every change of a sign and every stop located; friction of 0.15 m/s2 holds the mass at times."""
    model = with_law(*([effect] if effect else []), dry=0.15)
    inner = [0.0] * (len(of_model(model)[0].states) - 2)
    level = 1.0 if kind == "driven" else 0.0
    begin = [0.0, 0.0, *inner] if kind == "driven" else [5e-3, 0.1, *inner]

    def force(t: float) -> float:
        return level * float(np.sin(2 * np.pi * (8 * t + 8 * t**2)))

    expected = engine(model, begin, np.array([force(k * DT) for k in range(N)]))
    got = modelica(model, begin, force)
    assert np.max(np.abs(got[:, :2] - expected[:, :2]) / np.max(np.abs(expected[:, :2]), axis=0)) < 2e-5


def test_bounces_on_the_seat_end(with_law):
    """A preload above the friction: infinitely many bounces in finite time, then rest on the seat for good."""
    model = with_law(preload=0.3, dry=0.1, viscous=20.0)
    run = Run(read(model), lambda t: 0.0, {"displacement": 1e-3})
    end = run.until(0.5, DT / 2)
    assert (end["displacement"], end["velocity"]) == (0.0, 0.0)
    assert run.discrete == {"lands": True, "seated": True, "mode": 0}
    assert engine(model, [1e-3, 0.0], np.zeros(N))[-1].tolist() == [0.0, 0.0]


def test_at_rest_it_waits_for_a_force_above_friction_and_preload(models):
    model = models["base"]()
    most = model.values()["mass"] * (model.dry.value + model.preload.value)
    for part, moves in ((0.99, False), (1.01, True)):
        run = Run(read(model), lambda t, part=part: part * most, {})
        assert bool(run.until(0.02, DT)["displacement"] > 0) is moves


def test_variables_carry_units_bounds_and_errors(models):
    text = text_of(models["base"]())
    assert 'parameter Real dry(unit = "m/s2", min = 0.0) = 0.015 "' in text
    assert 'parameter Real cubic(unit = "1/(m2.s2)") = 460000.0 "' in text
    assert 'input Real F(unit = "N")' in text
    assert "experiment(StartTime = 0.0, StopTime = 1.6, Interval = 0.0008, Tolerance = 1e-08)" in text


@pytest.mark.parametrize("name", ['"; end rig;', "a\\", "Prüfstand №5\n", "//", "/*"])
def test_names_of_any_kind_stay_words(models, name):
    written = read(replace(models["base"](), name=name))
    assert sorted(written.rates) == ["displacement", "velocity"]


def test_it_is_named_after_its_file_or_refused(models, tmp_path):
    (path,) = export(models["base"](), tmp_path / "rig_2.mo")
    assert path.read_text(encoding="ascii").startswith("model rig_2 ")
    with pytest.raises(BadInput, match="Modelica takes the name of what is in it from the file, and 'rig-2' is none"):
        export(models["base"](), tmp_path / "rig-2.mo")
