"""The walk over an expression and what it writes: values and parentheses, names for what is shared."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.export.assignments import Node, assignments, walk
from dashpot.export.languages import MATLAB, MODELICA, PYTHON


def function(expression, *symbols):
    return ca.Function("f", [ca.vertcat(*symbols)], [ca.densify(expression)])


def evaluated(made, names: list[str], values: list[float]) -> list[float]:
    """The Python text of a function of one input, run."""
    lines, (texts,) = assignments(made, [names], PYTHON)
    known = {"xp": np, "zero": np.zeros(()), "INFINITY": math.inf, **dict(zip(names, np.array(values), strict=True))}
    for line in lines:
        exec(line, known)
    return [float(eval(text, known)) for text in texts]


def random_expression(random, symbols, depth: int):
    if depth == 0:
        return symbols[random.integers(len(symbols))] if random.random() < 0.8 else ca.SX(float(random.normal()))
    a, b, c = (random_expression(random, symbols, depth - 1) for _ in range(3))
    return [
        lambda: a + b,
        lambda: a - b,
        lambda: a * b,
        lambda: a / (b * b + 1),
        lambda: -a,
        lambda: -(a - b),
        lambda: a - (b - c),
        lambda: a / (b + 3) / (c + 3),
        lambda: a / ((b * b + 1) * (c * c + 1)),
        lambda: (a + b) ** 2,
        lambda: (a * a + 0.1) ** (b - c),
        lambda: ca.if_else(a < b, b, c),
        lambda: ca.if_else(ca.logic_and(a <= b, ca.logic_not(b <= c)), a, -b),
        lambda: ca.fmax(a, b),
        lambda: ca.fmin(-a, 2 * b),
        lambda: ca.tanh(a),
        lambda: ca.sign(a) * ca.fabs(b),
        lambda: (a < b) * c,
        lambda: 1 / (a * a + 1) * b,
    ][random.integers(19)]()


@pytest.mark.parametrize("seed", range(60))
def test_any_expression_has_its_value(seed):
    random = np.random.default_rng(seed)
    symbols = [ca.SX.sym(name) for name in "abc"]
    made = function(ca.vertcat(*(random_expression(random, symbols, 4) for _ in range(3))), *symbols)
    for _ in range(5):
        values = random.normal(size=3).tolist()
        wanted = np.array(made(values)).ravel()
        assert evaluated(made, ["a", "b", "c"], values) == pytest.approx(wanted, rel=1e-12, abs=1e-12, nan_ok=True)


def test_what_is_shared_has_a_name_and_what_is_not_needed_none():
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    shared = ca.sin(x * y)
    lines, (texts,) = assignments(function(ca.vertcat(shared + 1, shared / 2), x, y), [["x", "y"]], PYTHON)
    assert lines == ["a1 = xp.sin(x * y)"]
    assert texts[0] in ("a1 + 1.0", "1.0 + a1")


@pytest.mark.parametrize(
    ("language", "wanted"),
    [
        (PYTHON, "xp.where(x < y, x ** 2, -(x - y))"),
        (MATLAB, "choose(x < y, x .^ 2, -(x - y))"),
        (MODELICA, "(if x < y then x ^ 2 else -(x - y))"),
    ],
)
def test_a_choice_reads_as_one(language, wanted):
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    lines, ((text,),) = assignments(function(ca.if_else(x < y, x**2, -(x - y)), x, y), [["x", "y"]], language)
    assert (lines, text) == ([], wanted)


def test_equal_operations_are_one_node():
    x = ca.SX.sym("x")
    walked = walk(function(ca.vertcat(ca.cos(x), ca.cos(x) * 2), x))
    assert [node.op for node in walked.nodes].count("COS") == 1
    assert walked.nodes[0] == Node("INPUT", (0, 0))


@pytest.mark.parametrize("language", [PYTHON, MATLAB, MODELICA])
def test_an_operation_that_a_language_has_not_is_refused(language):
    x = ca.SX.sym("x")
    with pytest.raises(BadInput, match=f"uses the operation erf, which the export to {language.name} does not know"):
        assignments(function(ca.erf(x), x), [["x"]], language)
