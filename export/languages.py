"""The operators of the languages that a model is written out in; see ``assignments``."""

from __future__ import annotations

from .assignments import ATOM, COMPARISON, POWER, PRODUCT, SUM, Language

#: What is written alike everywhere.
_ARITHMETIC = {
    "ADD": ("{0} + {1}", SUM),
    "SUB": ("{0} - {1}", SUM),
    "NEG": ("-{0}", SUM),
    "MUL": ("{0} * {1}", PRODUCT),
    "DIV": ("{0} / {1}", PRODUCT),
    "TWICE": ("2.0 * {0}", PRODUCT),
    "INV": ("1.0 / {0}", PRODUCT),
    "LT": ("{0} < {1}", COMPARISON),
    "LE": ("{0} <= {1}", COMPARISON),
}
#: Functions of one argument: CasADi's name, that of MATLAB and Modelica, that of the array API.
_FUNCTIONS = (
    ("SQRT", "sqrt", "sqrt"),
    ("EXP", "exp", "exp"),
    ("LOG", "log", "log"),
    ("SIN", "sin", "sin"),
    ("COS", "cos", "cos"),
    ("TAN", "tan", "tan"),
    ("ASIN", "asin", "asin"),
    ("ACOS", "acos", "acos"),
    ("ATAN", "atan", "atan"),
    ("SINH", "sinh", "sinh"),
    ("COSH", "cosh", "cosh"),
    ("TANH", "tanh", "tanh"),
    ("FABS", "abs", "abs"),
    ("SIGN", "sign", "sign"),
    ("FLOOR", "floor", "floor"),
    ("CEIL", "ceil", "ceil"),
)
_TWO = (("FMIN", "min", "minimum"), ("FMAX", "max", "maximum"), ("ATAN2", "atan2", "atan2"))


def _calls(column: int, before: str = "") -> dict[str, tuple[str, int]]:
    one = {row[0]: (f"{before}{row[column]}({{0}})", ATOM) for row in _FUNCTIONS}
    return one | {row[0]: (f"{before}{row[column]}({{0}}, {{1}})", ATOM) for row in _TWO}


#: Arrays of any package that follows the array API standard, under the name ``xp``; ``zero`` is one of its arrays.
PYTHON = Language(
    name="Python",
    operators=_ARITHMETIC
    | _calls(2, "xp.")
    | {
        "EQ": ("{0} == {1}", COMPARISON),
        "NE": ("{0} != {1}", COMPARISON),
        "NOT": ("xp.logical_not({0})", ATOM),
        "AND": ("xp.logical_and({0}, {1})", ATOM),
        "OR": ("xp.logical_or({0}, {1})", ATOM),
        "IF_ELSE_ZERO": ("xp.where({0}, {1}, zero)", ATOM),
        "IF_ELSE": ("xp.where({0}, {1}, {2})", ATOM),
        "SQ": ("{0} ** 2", POWER),
        "POW": ("{0} ** {1}", POWER),
        "CONSTPOW": ("{0} ** {1}", POWER),
    },
    truth="({0} != 0)",
    number="xp.where({0}, zero + 1.0, zero)",
    assignment="{0} = {1}",
    argument="zero + {0}",
    infinity="INFINITY",
)
MATLAB = Language(
    name="MATLAB",
    operators=_ARITHMETIC
    | _calls(1)
    | {
        "MUL": ("{0} .* {1}", PRODUCT),
        "DIV": ("{0} ./ {1}", PRODUCT),
        "TWICE": ("2.0 .* {0}", PRODUCT),
        "INV": ("1.0 ./ {0}", PRODUCT),
        "EQ": ("{0} == {1}", COMPARISON),
        "NE": ("{0} ~= {1}", COMPARISON),
        "NOT": ("not({0})", ATOM),
        "AND": ("and({0}, {1})", ATOM),
        "OR": ("or({0}, {1})", ATOM),
        "IF_ELSE_ZERO": ("choose({0}, {1}, 0.0)", ATOM),
        "IF_ELSE": ("choose({0}, {1}, {2})", ATOM),
        "SQ": ("{0} .^ 2", POWER),
        "POW": ("{0} .^ {1}", POWER),
        "CONSTPOW": ("{0} .^ {1}", POWER),
    },
    truth="({0} ~= 0)",
    number="double({0})",
    assignment="{0} = {1};",
    infinity="Inf",
)
MODELICA = Language(
    name="Modelica",
    operators=_ARITHMETIC
    | _calls(1)
    | {
        "EQ": ("{0} == {1}", COMPARISON),
        "NE": ("{0} <> {1}", COMPARISON),
        "NOT": ("(not ({0}))", ATOM),
        "AND": ("(({0}) and ({1}))", ATOM),
        "OR": ("(({0}) or ({1}))", ATOM),
        "IF_ELSE_ZERO": ("(if {0} then {1} else 0.0)", ATOM),
        "IF_ELSE": ("(if {0} then {1} else {2})", ATOM),
        "SQ": ("{0} ^ 2", POWER),
        "POW": ("{0} ^ {1}", POWER),
        "CONSTPOW": ("{0} ^ {1}", POWER),
    },
    truth="({0} <> 0)",
    number="(if {0} then 1.0 else 0.0)",
    assignment="{0} = {1};",
    infinity="1e300",
)
