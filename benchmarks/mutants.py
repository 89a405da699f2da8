"""Whether a file's own tests notice when the file is wrong: one-line mutants, and how many of them the tests kill.

    python -P benchmarks/mutants.py diagnose/verdict.py identify/problem/prediction.py [-n 20] [--seed 0]

A mutant is the file with one thing changed: a comparison turned round, a number doubled, plus and minus, `and` and
`or`, or min and max exchanged, a `not` left out, or a function that returns nothing at once (DeMillo, Lipton, Sayward
1978). Of all mutants of a file a fixed sample is drawn. Against each runs the one test file that mirrors the file
(`tests/`, the same folders, `test_` before the name), in a copy of the checkout; itself it is never touched. A mutant
dies where a test fails or takes ten times as long as without it. Exit code 1 where a file kills fewer than nine of ten.

Not drawn: numbers in annotations, zeros, and numbers below 1e-200, which only keep a quotient from dividing by zero. A
mutant that no test can tell from the original (a bisection with one more halving) counts as a survivor all the same.
"""

from __future__ import annotations

import argparse
import ast
import copy
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypeGuard

LEAST = 0.9
#: A number below this stands beside a divisor so that it is not zero: twice as much is the same program.
GUARD = 1e-200
LEFT_OUT = (".git", ".venv", "__pycache__", "build", "dist", ".pytest_cache", ".ruff_cache", "*.egg-info")

TURNED: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.GtE,
    ast.GtE: ast.Lt,
    ast.Gt: ast.LtE,
    ast.LtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
}
OTHER_NAME = {
    "min": "max",
    "max": "min",
    "minimum": "maximum",
    "maximum": "minimum",
    "argmin": "argmax",
    "argmax": "argmin",
}
#: Changes a node in place.
Change = Callable[[ast.AST], None]


@dataclass(frozen=True)
class Mutant:
    """One change of a file.

    Attributes:
        line: where.
        before, after: the changed expression.
        text: the whole file with it.
    """

    line: int
    before: str
    after: str
    text: str


def changes_of(node: ast.AST) -> Iterator[Change]:
    """What can be changed about one node, each by itself."""
    if isinstance(node, ast.Compare):
        for i in range(len(node.ops)):
            yield lambda n, i=i: n.ops.__setitem__(i, TURNED[type(n.ops[i])]())  # type: ignore[attr-defined]
    elif isinstance(node, ast.Constant) and _is_number(node.value) and abs(node.value) > GUARD:
        yield lambda n: setattr(n, "value", 2 * n.value)  # type: ignore[attr-defined]
    elif isinstance(node, ast.BinOp | ast.AugAssign) and isinstance(node.op, ast.Add | ast.Sub):
        other = ast.Sub if isinstance(node.op, ast.Add) else ast.Add
        yield lambda n: setattr(n, "op", other())
    elif isinstance(node, ast.BoolOp):
        joined = ast.Or if isinstance(node.op, ast.And) else ast.And
        yield lambda n: setattr(n, "op", joined())
    elif isinstance(node, ast.Name) and node.id in OTHER_NAME:
        yield lambda n: setattr(n, "id", OTHER_NAME[n.id])  # type: ignore[attr-defined]
    elif isinstance(node, ast.Attribute) and node.attr in OTHER_NAME:
        yield lambda n: setattr(n, "attr", OTHER_NAME[n.attr])  # type: ignore[attr-defined]
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        # a double `not` keeps the value a truth value
        yield lambda n: setattr(n, "operand", ast.UnaryOp(ast.Not(), n.operand))  # type: ignore[attr-defined]
    elif isinstance(node, ast.FunctionDef):
        yield lambda n: n.body.insert(1 if ast.get_docstring(n) else 0, ast.Return(None))  # type: ignore[attr-defined]


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _decide_nothing(tree: ast.AST) -> set[int]:
    """Identities of the nodes in annotations and imports for types."""
    passive: list[ast.AST | None] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            passive.append(node.returns)
        elif isinstance(node, ast.arg | ast.AnnAssign):
            passive.append(node.annotation)
        elif isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            passive.append(node)
    return {id(inner) for node in passive if node is not None for inner in ast.walk(node)}


def places(tree: ast.AST) -> list[tuple[int, int, ast.AST]]:
    """What can be changed: the place of a node in ``ast.walk``, which of the changes of this node, and the node."""
    passive = _decide_nothing(tree)
    nodes = ((place, node) for place, node in enumerate(ast.walk(tree)) if id(node) not in passive)
    return [(place, which, node) for place, node in nodes for which, _ in enumerate(changes_of(node))]


def made(tree: ast.AST, place: int, which: int) -> Mutant:
    """The mutant with one of the changes of the node at that place."""
    other = copy.deepcopy(tree)  # walks in the same order
    node, changed = (next(inner for i, inner in enumerate(ast.walk(t)) if i == place) for t in (tree, other))
    list(changes_of(changed))[which](changed)
    whole = ast.unparse(ast.fix_missing_locations(other))
    before, after = (ast.unparse(n).splitlines()[0] for n in (node, changed))
    if isinstance(node, ast.FunctionDef):
        before, after = f"def {node.name}", "return"
    return Mutant(getattr(node, "lineno", 0), before, after, whole)


def mutants(text: str) -> list[Mutant]:
    """Every mutant of a file's text, in the order of its lines."""
    tree = ast.parse(text)
    every = [made(tree, place, which) for place, which, _ in places(tree)]
    return sorted(every, key=lambda mutant: (mutant.line, mutant.before, mutant.after))


def sample(every: list[Mutant], count: int, seed: int, file: Path) -> list[Mutant]:
    """So many mutants of a file, in the order of its lines; the same ones whatever else is tried."""
    drawn = random.Random(f"{seed} {file.as_posix()}").sample(range(len(every)), min(count, len(every)))
    return [every[i] for i in sorted(drawn)]


def own_test(file: Path) -> Path:
    """The test file that mirrors a file: ``identify/backbone.py`` has ``tests/identify/test_backbone.py``."""
    return Path("tests") / file.parent / f"test_{file.name}"


def run(copied: Path, test: Path, limit: float | None) -> tuple[str, float]:
    """``"passed"``, ``"failed"`` or ``"endless"``, and the seconds; what pytest printed where it ran no test at all."""
    environment = {**os.environ, "PYTHONPATH": str(copied.parent), "PYTHONDONTWRITEBYTECODE": "1"}
    how = ["-x", "-q", "-p", "no:cacheprovider", "-m", "not nightly"]
    command = [sys.executable, "-P", "-m", "pytest", *how, str(test)]
    begin = time.monotonic()
    try:
        done = subprocess.run(command, cwd=copied, env=environment, capture_output=True, text=True, timeout=limit)
    except subprocess.TimeoutExpired:
        return "endless", time.monotonic() - begin
    if done.returncode in (3, 4, 5):  # internal error, wrong usage, no tests
        raise SystemExit(f"{test}: pytest ran no test: {done.stdout[-500:]}{done.stderr[-500:]}")
    return "failed" if done.returncode else "passed", time.monotonic() - begin


def survey(root: Path, file: Path, count: int, seed: int) -> tuple[int, int]:
    """Tries a sample of a file's mutants against its own tests and prints each: the number killed and tried."""
    test = own_test(file)
    if not (root / test).exists():
        print(f"{file}: there is no {test}; write it", flush=True)
        return 0, count
    text = (root / file).read_text(encoding="utf-8")
    every = mutants(text)
    drawn = sample(every, count, seed, file)
    name = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]["name"]
    killed = 0
    with tempfile.TemporaryDirectory() as temporary:
        copied = Path(temporary) / name  # the root of the checkout is the package: its folder bears the name
        shutil.copytree(root, copied, ignore=shutil.ignore_patterns(*LEFT_OUT))
        (copied / file).write_text(ast.unparse(ast.parse(text)), encoding="utf-8")
        outcome, seconds = run(copied, test, None)
        if outcome != "passed":
            raise SystemExit(f"{test} fails without any mutant; mend it first")
        print(f"{file}: {len(drawn)} of {len(every)} mutants against {test} ({seconds:.0f} s)", flush=True)
        for mutant in drawn:
            (copied / file).write_text(mutant.text, encoding="utf-8")
            outcome, _ = run(copied, test, 10 * seconds + 10)
            killed += outcome != "passed"
            word = "SURVIVED" if outcome == "passed" else "killed"
            print(f"  {word:8}  line {mutant.line}: {mutant.before}  ->  {mutant.after}", flush=True)
    print(f"{file}: {killed} of {len(drawn)} killed", flush=True)
    return killed, len(drawn)


def main() -> int:
    parser = argparse.ArgumentParser(description="One-line mutants of source files against the files' own tests.")
    parser.add_argument("files", nargs="+", type=Path, help="source files, from the root of the checkout")
    parser.add_argument("-n", type=int, default=20, metavar="N", help="mutants a file (20)")
    parser.add_argument("--seed", type=int, default=0, help="of the sample (0)")
    parser.add_argument("--root", type=Path, default=Path(__file__).parent.parent, help="the checkout")
    options = parser.parse_args()
    root = options.root.resolve()
    files = [(root / file).resolve().relative_to(root) for file in options.files]
    results = {file: survey(root, file, options.n, options.seed) for file in files}
    print()
    for file, (killed, tried) in results.items():
        print(f"{killed:4} of {tried:3}  {file}")
    few = [file for file, (killed, tried) in results.items() if killed < LEAST * tried]
    if few:
        print(f"fewer than {LEAST:.0%} killed: {', '.join(map(str, few))}")
    return 1 if few else 0


if __name__ == "__main__":
    sys.exit(main())
