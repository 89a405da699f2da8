"""Model files from anywhere: each is a model that can be shown and written again, or is refused with its place."""

from __future__ import annotations

import copy
import json
import random
import re

import pytest
from dashpot.files.yaml_loader import read_yaml
from dashpot.model.file import dumps, load, loads
from dashpot.model.show import as_json, describe
from hypothesis import strategies as st

GOOD = """\
format: dashpot-model/1
name: rig
mass: {value: 0.27, std: 0.0003, unit: kg}
omega0: {value: 79.61, std: 0.002, unit: rad/s}
cubic: {value: 4.6e5, std: 5.0e3, unit: 1/(m2.s2)}
preload: {value: 0.0741, std: 8.0e-4, unit: m/s2}
viscous: {value: 5.0, std: null, unit: 1/s}
dry: {value: 0.015, std: 5.0e-4, unit: m/s2}
terms:
  - {effect: quadratic-drag, parameters: {coefficient: {value: 0.1, unit: 1/m}}}
  - effect: one-sided-stop
    parameters:
      stiffness: {value: 2.0e4, std: null, unit: 1/s2}
      gap: {value: 2.0e-3, std: null, unit: m}
response: {quantity: displacement, unit: m}
excitation: {unit: N, hold: zero}
valid:
  amplitude: {min: 2.0e-4, max: 9.0e-3, unit: m}
  frequency: {min: 5, max: 20, unit: Hz}
identified:
  recordings: [{file: a.csv, sha256: null, kind: sweep, level: 1.0, nrmse: 0.01, over_noise: 1.02}]
  method: output error
  software: dashpot 0.1.0
  band: {mode: 12.7, low: 5.0, high: 30.0, unit: Hz}
  parameters: [preload, dry]
  covariance: [[6.4e-7, 1.0e-7], [1.0e-7, 2.5e-7]]
  log_likelihood: -12.5
"""
#: What stands in a model file, and what should not.
WORDS = (
    "format", "name", "mass", "omega0", "cubic", "terms", "effect", "parameters", "value", "std", "unit",
    "response", "excitation", "hold", "valid", "amplitude", "min", "max", "identified", "covariance", "recordings",
    "band", "mode", "hysteresis", "one-sided-stop", "time-delay", "quadratic-drag", "dashpot-model/1",
    "dashpot-model/2", "kg", "rad", "displacement", "acceleration", "m/s2", "m", "V", "N", "N.m", "zero", "smooth",
    "<<", "=", "y", "no", "null", "~",
)  # fmt: skip
ODD = (
    "0", "-1", "1e308", "1e-320", "-0.0", ".nan", "-.inf", "1_000", "0x10", "0o7", "1:30", "2024-01-01", "9" * 5000,
    "!!python/object:os.system", "!!int 3", "!x", "&a", "*a", "&a [*a]", "|", ">", "|-", "? ", ": ", "- ", "---",
    "...", "%YAML 1.2", "{", "}", "[", "]", "{}", "[]", ",", '"', "'", "\\", '"\\UFFFFFFFF"', '"\\x00"', "#", "\t",
    "\n", "\r", "\0", "\x85", "\u2028", "\ufeff", "\ud7ff", "é", "\x1b[31m", "[" * 40, "{a: " * 40, "- " * 40,
    "x" * 300, "\u202e", "@", "`",
)  # fmt: skip


@st.composite
def damaged(draw):
    """A good file after some accidents: words exchanged, lines lost, repeated, moved, indented, odd pieces put in."""
    dice = random.Random(draw(st.integers(0, 2**32)))
    lines = GOOD.split("\n")
    for _ in range(draw(st.integers(1, 6))):
        at, kind = dice.randrange(len(lines)), dice.randrange(8)
        tokens = re.split(r"([\s{}\[\],:]+)", lines[at])
        k = dice.randrange(len(tokens))
        if kind < 4:
            tokens[k] = dice.choice(
                [dice.choice(ODD), dice.choice(WORDS), f"{dice.gauss(0, 1) * 10 ** dice.uniform(-9, 9):.6g}"]
            )
            lines[at] = "".join(tokens)
        elif kind == 4:
            lines.pop(at)
            lines = lines or [""]
        elif kind == 5:
            lines.insert(dice.randrange(len(lines)), lines[at])
        elif kind == 6:
            lines[at] = " " * dice.randrange(9) + lines[at].lstrip()
        else:
            del tokens[k]
            lines[at] = "".join(tokens)
    return "\n".join(lines)


SCALARS = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=20),
    st.sampled_from(WORDS),
    st.sampled_from(ODD),
)
TREES = st.recursive(
    SCALARS,
    lambda inner: st.one_of(st.lists(inner, max_size=4), st.dictionaries(st.sampled_from(WORDS), inner, max_size=6)),
    max_leaves=30,
)


TREE = read_yaml(GOOD, "good").data


@st.composite
def replaced(draw):
    """A good file, as JSON, in which one value is of whatever kind."""
    here = tree = copy.deepcopy(TREE)
    while True:
        key = draw(st.sampled_from(sorted(here) if isinstance(here, dict) else range(len(here))))
        if not isinstance(here[key], (dict, list)) or not here[key] or draw(st.integers(0, 4)) == 0:
            here[key] = draw(TREES)
            return json.dumps(tree)
        here = here[key]


@pytest.mark.parametrize(
    "kind",
    [damaged(), replaced(), TREES.map(json.dumps), st.text(max_size=200)],
    ids=["damaged", "one value", "trees", "text"],
)
def test_any_text_is_a_model_or_a_sentence(every, unless_refused, kind):
    def holds(text):
        model = unless_refused(loads, text, "m.yaml")
        if model is None:
            return
        again = loads(dumps(model))
        assert again.values() == model.values()
        assert dumps(again) == dumps(model)
        json.dumps(as_json(model), allow_nan=False)
        assert describe(model).strip()

    every(kind, holds)


def test_any_bytes_are_a_model_or_a_sentence(every, unless_refused, tmp_path):
    path = tmp_path / "m.yaml"

    @st.composite
    def bytes_of(draw):
        dice, content = random.Random(draw(st.integers(0, 2**32))), bytearray(GOOD.encode())
        for _ in range(dice.randrange(4)):
            at = dice.randrange(len(content))
            content[at : at + dice.randrange(3)] = bytes(dice.randrange(256) for _ in range(dice.randrange(4)))
        return bytes(content).decode("latin-1").encode(dice.choice(["latin-1", "utf-16", "utf-8-sig"]))

    def holds(content):
        path.write_bytes(content)
        unless_refused(load, path)

    every(bytes_of() | st.binary(max_size=300), holds)
