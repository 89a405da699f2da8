"""The model file: what is written comes back, readable, and nothing in it does anything."""

from __future__ import annotations

import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
import yaml
from dashpot.errors import BadInput
from dashpot.model import Oscillator, Parameter, Provenance, Range, Response, oscillator_with
from dashpot.model.file import dumps, load, loads, save
from dashpot.model.laws import LIBRARY
from dashpot.model.oscillator import HOLDS
from dashpot.recording.recording import HOLDS as RECORDED_HOLDS

RIG = {
    "mass": 0.27,
    "omega0": 2 * math.pi * 12.67,
    "cubic": 4.6e5,
    "preload": 0.02 / 0.27,
    "viscous": 5.0,
    "dry": 0.015,
}
WRITTEN = """\
# mass [x'' + viscous x' + dry sgn(x') + omega0² x + cubic x³ + preload sgn(x)] = F(t)
format: dashpot-model/1
name: technion-rig
mass:    {value: 0.27,     std: 0.0003, unit: kg}
omega0:  {value: 79.61,    std: 0.002,  unit: rad/s}
cubic:   {value: 460000.0, std: 5000.0, unit: 1/(m2.s2)}
preload: {value: 0.0741,   std: 0.0008, unit: m/s2}
viscous: {value: 5.0,      std: 0.002,  unit: 1/s}
dry:     {value: 0.015,    std: 0.0005, unit: m/s2}
terms: []
response: {quantity: displacement, unit: m}
excitation: {hold: zero}
valid:   # what the recordings covered
  amplitude: {min: 0.0002, max: 0.009, unit: m}
  frequency: {min: 5.0, max: 20.0, unit: Hz}
identified:
  recordings:
    - {file: sweep 1.csv, sha256: null, kind: sweep}
  method: maximum-likelihood
  software: dashpot 0.1.0
  parameters: [preload, dry]
  covariance:
    - [6.4e-07, 1.0e-07]
    - [1.0e-07, 2.5e-07]
  log_likelihood: -12.5
"""


def random_oscillator(random: np.random.Generator) -> Oscillator:
    """Any oscillator that a fit could give: odd numbers, names, units, terms, covariance."""
    effects = tuple(random.permutation(sorted(LIBRARY))[: random.integers(0, 4)].tolist())
    order = random.integers(0, 3)
    response = Response(
        ("displacement", "velocity", "acceleration")[order], str(random.choice(["m", "rad", "V", "m/s", "m/s2", "1"]))
    )
    names = ["mass"] * int(random.integers(0, 2)) + ["omega0", "cubic", "preload", "viscous", "dry"]
    names += [f"{effect}.{p.name}" for effect in effects for p in LIBRARY[effect].parameters]
    values = {name: float(random.normal() * 10.0 ** random.integers(-18, 18)) for name in names}
    values |= {name: abs(values[name]) for name in ("mass", "omega0") if name in values}
    for effect in effects:
        for p in LIBRARY[effect].parameters:
            name, drawn = f"{effect}.{p.name}", values[f"{effect}.{p.name}"]
            values[name] = float(np.clip(drawn if math.isinf(p.lower) else p.lower + abs(drawn), p.lower, p.upper))
    letters = "ab Z9_-.:#'\"\\{}[],&*!|>%@`~=?/ü漢😀;$<>"
    name = "".join(random.choice(list(letters), random.integers(1, 12)).tolist())
    o = oscillator_with(
        values, name=name, response=response, force_unit=str(random.choice(["N", "V", "N.m"])), effects=effects
    )
    stds = {n: replace(p, std=float(f"{random.exponential():.3e}")) for n, p in o.parameters().items()}
    kept = {n: p for n, p in stds.items() if random.random() < 0.8}
    spread = random.normal(size=(len(kept), len(kept) + 2))
    spread *= (np.array([p.std for p in kept.values()]) / np.linalg.norm(spread, axis=1))[:, None]
    provenance = Provenance(
        recordings=({"file": name, "kind": "decay"}, {"file": "b", "sha256": "0e1" * 21 + "f"}),
        method=str(random.choice(["", "no", "1e3", "null", "2024-01-01"])),
        parameters=tuple(kept),
        covariance=tuple(tuple(row) for row in (spread @ spread.T).tolist()) if kept else None,
        log_likelihood=float(random.normal() * 1e5),
    )
    amplitude = Range(0.0, float(random.exponential()), response.displacement_unit)
    return replace(o.with_parameters(kept), identified=provenance, amplitude=amplitude)


@pytest.mark.parametrize("seed", range(40))
def test_what_is_written_comes_back(seed):
    o = random_oscillator(np.random.default_rng(seed))
    text = dumps(o)
    assert loads(text) == o
    assert dumps(loads(text)) == text


@pytest.mark.parametrize("seed", range(5))
def test_other_yaml_readers_see_the_same_numbers_and_texts(seed):
    o = random_oscillator(np.random.default_rng(seed))
    data = yaml.safe_load(dumps(o))
    assert data["name"] == o.name
    assert data["cubic"]["value"] == o.cubic.value
    assert data["identified"]["recordings"][1]["sha256"] == "0e1" * 21 + "f"
    assert data["identified"].get("method", "") == o.identified.method


def test_the_file_looks_as_designed():
    o = loads(WRITTEN)
    assert dumps(o) == WRITTEN
    assert o.cubic == Parameter(4.6e5, 5e3, "1/(m2.s2)")
    assert o.amplitude == Range(2e-4, 9e-3, "m")
    assert o.hold == "zero"
    assert o.identified.covariance == ((6.4e-7, 1e-7), (1e-7, 2.5e-7))


def test_a_file_that_says_nothing_of_the_hold_means_smooth_and_one_that_says_nonsense_is_refused():
    silent = WRITTEN.replace("excitation: {hold: zero}\n", "")
    assert loads(silent).hold == "smooth"
    assert loads(dumps(loads(WRITTEN.replace("{hold: zero}", "{unit: N, hold: linear}")))).hold == "linear"
    with pytest.raises(BadInput, match=r"\$\.excitation\.hold: must be 'zero', 'linear' or 'smooth', not 'first'"):
        loads(WRITTEN.replace("hold: zero", "hold: first"))


def test_recordings_and_models_know_the_same_holds():
    assert set(HOLDS) == set(RECORDED_HOLDS)


def test_the_standard_error_is_written_to_four_digits():
    o = Oscillator.from_values(RIG).with_parameters({"dry": Parameter(1 / 3, 0.000123456, "m/s2")})
    assert loads(dumps(o)).dry == Parameter(1 / 3, 0.0001235, "m/s2")


def test_without_a_mass_the_file_says_null():
    o = Oscillator.from_values({k: v for k, v in RIG.items() if k != "mass"}, response=Response("displacement", "rad"))
    assert "mass:    null   # none was given" in dumps(o)
    assert loads(dumps(o)) == o


def test_numbers_and_words_are_read_as_written():
    text = dumps(Oscillator.from_values(RIG, name="no")).replace("value: 460000.0", "value: 1e-3")
    o = loads(text)
    assert o.name == "no"
    assert o.cubic.value == 1e-3
    assert loads(text.replace("1e-3", "2.0e9")).cubic.value == 2.0e9
    assert loads(text.replace("1e-3", "-3")).cubic.value == -3.0
    assert loads(text.replace('"no"', "on")).name == "on"


def test_the_parameters_of_the_covariance_are_by_default_those_with_an_error():
    text = WRITTEN.replace("  parameters: [preload, dry]\n", "")
    for name in ("0.0003", "0.002,  unit: rad", "5000.0", "0.002,  unit: 1/s"):
        text = text.replace(f"std: {name}", "std: null" + name[len(name.split(",")[0]) :])
    assert loads(text).identified.parameters == ("preload", "dry")


def test_negative_friction_and_damping_are_read():
    o = loads(dumps(Oscillator.from_values(RIG | {"dry": -1.0, "viscous": -2.0, "preload": -3.0, "cubic": -4.0})))
    assert [o.dry.value, o.viscous.value, o.preload.value, o.cubic.value] == [-1.0, -2.0, -3.0, -4.0]


@pytest.mark.parametrize(
    "name", ['"; system("x"); //', "../../etc/passwd", "/etc/passwd", "<a>&amp;", "${HOME}", "%s%n"]
)
def test_a_name_is_only_a_name(name, tmp_path):
    o = Oscillator.from_values(RIG, name=name)
    save(o, tmp_path / "model.yaml")
    assert load(tmp_path / "model.yaml") == o
    assert [path.name for path in tmp_path.iterdir()] == ["model.yaml"]


def test_characters_that_do_not_print_are_replaced_on_writing():
    assert loads(dumps(Oscillator.from_values(RIG, name="a\nb\x1b[2J\u202e\udc80"))).name == "a�b�[2J��"


def test_a_model_that_could_not_be_read_again_is_not_written(tmp_path):
    target = tmp_path / "model.yaml"
    target.write_text("before")
    sound = Oscillator.from_values(RIG)
    with pytest.raises(BadInput, match=r"model\.yaml: line \d+: \$\.dry\.value: must be a finite number"):
        save(sound.with_parameters({"dry": replace(sound.dry, value=math.nan)}), target)
    assert target.read_text() == "before"
    assert list(tmp_path.iterdir()) == [target]


def test_saving_replaces_the_file_and_leaves_nothing_beside_it(tmp_path):
    target = tmp_path / "model.yaml"
    target.write_text("before")
    save(Oscillator.from_values(RIG), target)
    assert load(target) == Oscillator.from_values(RIG)
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("place", ["folder", "folder/file/model.yaml", "nul\0l.yaml"])
def test_a_place_that_cannot_be_written_is_said(place, tmp_path):
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder/file").touch()
    with pytest.raises(BadInput, match=r"cannot be written|is a folder"):
        save(Oscillator.from_values(RIG), tmp_path / place)
    assert [path.name for path in tmp_path.iterdir()] == ["folder"]


@pytest.mark.parametrize("place", ["missing.yaml", ".", "nul\0l.yaml"])
def test_a_place_that_cannot_be_read_is_said(place, tmp_path):
    with pytest.raises(BadInput, match="cannot be read"):
        load(f"{tmp_path}/{place}")


def test_reading_the_package_loads_nothing_heavy(tmp_path):
    heavy = ("casadi", "scipy", "pydantic", "yaml", "numpy")
    modules = "dashpot.model, dashpot.model.file, dashpot.model.show"
    program = f"import sys, {modules}; print(*[name for name in {heavy} if name in sys.modules])"
    run = subprocess.run(
        [sys.executable, "-P", "-c", program], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert run.stdout.split() == []
