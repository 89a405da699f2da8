"""Code within the lines of the documents: calls, options and names that are there, and CasADi's calls run.

What stands in blocks is run by tests/test_documented_commands.py, tests/test_readme.py and others.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import re
from pathlib import Path
from typing import Any

import dashpot
import numpy as np
import pytest
from dashpot.commands.cli import cli
from dashpot.model.element import Element
from dashpot.model.law import Law, Motion

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "examples/README.md", *sorted(ROOT.glob("docs/**/*.md"))]
#: What a name in a line stands for, as the pages use it.
STANDS_FOR: dict[str, Any] = {
    "dashpot": dashpot,
    "model": dashpot.Model,
    "Model": dashpot.Model,
    "diagnosis": dashpot.Diagnosis,
    "response": dashpot.Simulation,
    "recording": dashpot.Recording,
    "element": dashpot.ForceElement,
    "motion": Motion,
}
#: Attributes that only an object has, with the class of what they hold.
HELD = {"element.element": Element}
#: Objects whose methods are named without them, beside a call that gives one.
GIVEN = (
    *(dashpot.Model, dashpot.Diagnosis, dashpot.Simulation, dashpot.Recording, dashpot.ForceElement, dashpot.Hilbert),
    dashpot.LinearModel,
)
#: Calls of other languages, of mathematics and of files that dashpot writes; tests of their own run these.
OTHERS = {
    *("abs", "sign", "sgn", "tanh", "sin", "cos", "sqrt", "exp", "help", "Opti"),
    *("der", "event", "importFMU", "rig", "omega0", "read_tables", "raise"),
    *("xdot", "xdot_smooth", "output", "initial", "f", "step"),
}
#: Programs whose options are not those of dashpot.
OTHER_PROGRAMS = ("benchmarks/", "make ", "python ", "pip ", "pytest", "docs/site/", ".venv/", "dashpot.examples")
#: Pages of which the options are those of scripts, pytest and make.
OF_OTHER_PROGRAMS = {"CONTRIBUTING.md", "docs/limits.md"}
#: Files that are named like a piece of code.
_FILE = re.compile(r"[\w./<>*-]+\.(yaml|json|csv|fmu|html|png|md|py|c|h|m|mo|svg|js|css|casadi)")


def spans(page: Path) -> list[str]:
    """Code within the lines of a page."""
    text = re.sub(r"```.*?```|<!--.*?-->", "", page.read_text("utf-8"), flags=re.DOTALL)
    return re.findall(r"`([^`\n]+)`", text)


def all_spans() -> list[tuple[str, str]]:
    return [(page.relative_to(ROOT).as_posix(), span) for page in PAGES for span in spans(page)]


def options_of(span: str) -> set[str]:
    return set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", span))


def known_options(span: str) -> set[str]:
    """The options of the command that a span names; where it names none, of all."""
    words = span.removeprefix("dashpot ").split()
    named = cli.commands.get(words[0]) if words else None
    commands = list(cli.commands.values()) if named is None else [named]
    secondary = {"--help", "--version"}
    return secondary | {o for c in commands for p in c.params for o in (*p.opts, *p.secondary_opts)}


def test_there_is_code_in_lines():
    found = all_spans()
    assert sum(bool(options_of(span)) for _, span in found) > 150
    assert sum(called(span) is not None for _, span in found) > 40


def test_options_in_lines_exist():
    wrong = [
        f"{page}: `{span}`: {option}"
        for page, span in all_spans()
        if page not in OF_OTHER_PROGRAMS and not span.startswith(OTHER_PROGRAMS)
        for option in sorted(options_of(span) - known_options(span) - OF_THE_PROOF)
    ]
    assert wrong == []


#: Options of the concealed rigs, which examples and docs name without their program.
OF_THE_PROOF = {
    "--dirty",
    "--stability",
    "--kinds",
    "--count-per-effect",
    "--scale",
    "--experiment",
    "--sensor",
    "--short",
}


def test_commands_in_lines_exist():
    wrong = []
    for page, span in all_spans():
        words = span.split()
        if (
            words[:1] == ["dashpot"]
            and len(words) > 1
            and not words[1].startswith("-")
            and words[1] not in cli.commands
        ):
            wrong.append(f"{page}: `{span}`")
    assert wrong == []


def called(span: str) -> ast.expr | None:
    """The expression of a span that calls or names something of Python's, or None."""
    if _FILE.fullmatch(span) or not re.match(r"^[A-Za-z_][\w.]*(\(|$)", span.partition(" = ")[2] or span):
        return None
    if "(" not in span and not span.startswith("dashpot."):
        return None
    try:
        return ast.parse(span.partition(" = ")[2] or span, mode="eval").body
    except SyntaxError:
        return None


def problem(expression: ast.expr) -> str:
    """What is wrong with a call, in words; empty where nothing is."""
    for node in ast.walk(expression):
        if isinstance(node, ast.Call) and (wrong := wrong_call(node)):
            return wrong
    if isinstance(expression, ast.Attribute) and resolved(expression) is None:
        return f"there is no {ast.unparse(expression)}"
    return ""


def wrong_call(node: ast.Call) -> str:
    name = ast.unparse(node.func)
    if isinstance(node.func, ast.Name):
        if name in OTHERS or name in Law.__dataclass_fields__:
            return ""
        targets = [getattr(owner, name) for owner in (dashpot, *GIVEN) if hasattr(owner, name)]
        if not targets:
            return f"nothing of dashpot is called {name}"
    else:
        root = name.partition(".")[0]
        if root not in STANDS_FOR:
            return ""
        target = resolved(node.func)
        if target is None:
            return f"there is no {name}"
        targets = [target]
    keywords = {keyword.arg for keyword in node.keywords if keyword.arg}
    return "" if any(keywords <= accepted(target) for target in targets) else f"{name} takes no {sorted(keywords)}"


def accepted(target: Any) -> set[str]:
    """Keywords that a call takes, those of ``dashpot.recording.Reading`` where it takes more, and any of a channel."""
    from dashpot.recording import Reading

    parameters = inspect.signature(target).parameters
    more = any(p.kind is inspect.Parameter.VAR_KEYWORD for p in parameters.values())
    return {*parameters, *(Reading.__annotations__ if more else ()), *(("current",) if more else ())}


def resolved(node: ast.expr) -> Any:
    """What a dotted name stands for, or None."""
    root, *rest = ast.unparse(node).split(".")
    found, path = STANDS_FOR.get(root), root
    for name in rest:
        path = f"{path}.{name}"
        if path in HELD:
            found = HELD[path]
        elif hasattr(found, name):
            found = getattr(found, name)
        elif name in getattr(found, "__dataclass_fields__", {}) or name in getattr(found, "__annotations__", {}):
            return found  # an attribute of its objects
        elif inspect.ismodule(found):
            try:
                found = importlib.import_module(path)
            except ImportError:
                return None
        else:
            return None
    return found


#: Groups of entry points and extras that look like modules.
GROUPS = {"dashpot.laws", "dashpot.readers"}


def test_calls_in_lines_exist_and_take_what_is_given():
    wrong = []
    for page, span in all_spans():
        expression = called(span)
        if expression is not None and span not in GROUPS and (words := problem(expression)):
            wrong.append(f"{page}: `{span}`: {words}")
    assert wrong == []


@pytest.mark.parametrize(
    ("span", "words"),
    [
        ("dashpot.identify(files, masse=0.2)", "takes no"),
        ("dashpot.model.no_such.thing", "there is no"),
        ("model.predict(x)", "there is no"),
        ("predict(x)", "nothing of dashpot"),
        ("model.simulate(force=f, rate=3)", "takes no"),
    ],
)
def test_the_checker_catches_a_call_that_does_not_exist(span, words):
    expression = called(span)
    assert expression is not None
    assert words in problem(expression)


@pytest.fixture(scope="module")
def functions(tmp_path_factory):
    """What docs/control.md speaks of, with arguments of the shapes that it states."""
    import casadi
    from dashpot.examples.truth import TRUTH
    from dashpot.export import export
    from dashpot.model import Oscillator

    folder = tmp_path_factory.mktemp("casadi")
    export(Oscillator.from_values(TRUTH), folder / "rig.casadi")
    names = {"f": "rig.casadi", "step": "rig.step.casadi", "output": "rig.output.casadi"}
    loaded = {name: casadi.Function.load(str(folder / file)) for name, file in names.items()}
    x0, n = np.array([1e-3, 0.0]), 4
    arguments = {"x": x0, "x0": x0, "u": 0.5, "p": np.zeros(6), "N": n, "U": np.full((2, n), 0.5)}
    return {**loaded, **arguments, "opti": casadi.Opti()}


def test_the_calls_of_casadi_run(functions):
    """Each line of docs/control.md that calls one of the functions; of one without arguments, that it is there."""
    run = []
    for span in spans(ROOT / "docs/control.md"):
        code = span.partition(" = ")[2] or span
        root = re.match(r"(f|step|output|opti)\b[.(]", code)
        if root is None:
            continue
        if "..." in code or "(" not in code:
            assert hasattr(functions[root[1]], code.partition(".")[2].partition("(")[0]), span
        else:
            eval(code, {}, dict(functions))
        run.append(span)
    assert len(run) > 6
    many = functions["step"].mapaccum(4)(x=functions["x0"], u=functions["U"])["x_next"]
    assert many.shape == (2, 4)
    with pytest.raises(Exception, match="x0"):
        functions["step"].mapaccum(4)(x0=functions["x0"])
