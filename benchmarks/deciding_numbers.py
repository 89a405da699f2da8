"""How many numbers decide what identify and diagnose answer: counted, listed, and held below what was counted last.

    python -P benchmarks/deciding_numbers.py [--list] [--wing NAME] [--page]

Read by the syntax tree, without running anything, of every module of identify/, diagnose/ and prescribed/:

- each number in a module constant, and
- each literal in a comparison or in ``min``, ``max``, ``clip``, ``minimum`` or ``maximum`` that is not 0, 1 or 2, not
  an exponent or index, and not below 1e-12, which is a machine's epsilon or a guard against a division by zero.

A number that decides is written ``decides(...)`` in the `limits.py` of its wing (those that all wings share stand in
`odds.py`), with unit, what it decides, and why; it is counted wherever it stands. One that changes no answer is not
counted where its constant says so with the reason, as a ``budget``, as ``numerics`` or as what is ``shown``: see
`identify/signals/registry.py`.

``--page`` prints the table of docs/limits.md. The exit code is 1 where there are more numbers than ``MOST``. Who needs
a new one takes one away.
"""

from __future__ import annotations

import argparse
import ast
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDERS = ("identify", "diagnose", "prescribed")
#: The one level of doubt, which all wings share.
ODDS = "identify/signals/odds.py"
#: As many as there were when they were counted last. It is only ever lowered.
MOST = 108
#: Below this a literal is a machine's epsilon or a guard against a division by zero.
EPSILON = 1e-12
PLAIN = (0, 1, 2)
BOUNDING = {"min", "max", "clip", "minimum", "maximum"}
#: What a constant is called with that says whether it decides.
NO_DECISION = ("budget", "numerics", "shown")
REGISTERED = {"decides", *NO_DECISION}


@dataclass(frozen=True)
class Number:
    """A number that decides.

    Attributes:
        file: below the root.
        line: in that.
        name: of the constant; empty for a literal.
        value: as it is written.
        kind: ``decides``, ``constant`` (without an entry in a registry), ``literal``, or one of ``NO_DECISION``.
    """

    file: str
    line: int
    name: str
    value: float
    kind: str

    @property
    def wing(self) -> str:
        """Folder below identify/, or the whole of diagnose/."""
        folder = Path(self.file).parent
        return "diagnose" if folder.is_relative_to("diagnose") else folder.as_posix()

    @property
    def counts(self) -> bool:
        """Whether it decides, as far as the code says."""
        return self.kind not in NO_DECISION


def numbers_of(file: str, text: str) -> Iterator[Number]:
    """Every number of a module that decides, or is registered as one that does not.

    Args:
        file: its path below the root.
        text: its source.
    """
    tree = ast.parse(text)
    for node in tree.body:
        yield from _of_constant(file, node)
    seen: set[int] = set()
    for node in ast.walk(tree):
        operands: Sequence[ast.expr] = ()
        if isinstance(node, ast.Compare):
            operands = [node.left, *node.comparators]
        elif isinstance(node, ast.Call) and _called(node) in BOUNDING:
            operands = node.args
        for literal in (literal for operand in operands for literal in _literals(operand)):
            value = float(literal.value)  # type: ignore[arg-type]
            if id(literal) not in seen and abs(value) not in PLAIN and abs(value) > EPSILON:
                seen.add(id(literal))
                yield Number(file, literal.lineno, "", value, "literal")


def _of_constant(file: str, node: ast.stmt) -> Iterator[Number]:
    """The numbers of a statement that gives values to constants; of a formula of other constants none."""
    if isinstance(node, ast.Assign) and len(node.targets) == 1:
        target, value = node.targets[0], node.value
    elif isinstance(node, ast.AnnAssign) and node.value is not None:
        target, value = node.target, node.value
    else:
        return
    targets = target.elts if isinstance(target, ast.Tuple) else [target]
    names = [one.id for one in targets if isinstance(one, ast.Name)]
    if not names or not all(name.strip("_").isupper() for name in names):
        return
    values = value.elts if len(names) > 1 and isinstance(value, ast.Tuple) else [value] * len(names)
    for name, one in zip(names, values, strict=True):
        kind = "constant"
        if isinstance(one, ast.Call) and _called(one) in REGISTERED:
            kind, one = str(_called(one)), one.args[0]
        literals = list(_literals(one))
        formula = any(isinstance(part, ast.Name) and part.id.strip("_").isupper() for part in ast.walk(one))
        if formula:
            literals = [literal for literal in literals if abs(float(literal.value)) not in PLAIN]  # type: ignore[arg-type]
        for literal in literals:
            yield Number(file, literal.lineno, name, float(literal.value), kind)  # type: ignore[arg-type]


def _called(node: ast.Call) -> str | None:
    """The last name of what is called."""
    return node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", None)


def _literals(node: ast.expr) -> Iterator[ast.Constant]:
    """The numbers in an expression, but for exponents, indices and options."""
    if isinstance(node, ast.Constant):
        if isinstance(node.value, int | float) and not isinstance(node.value, bool):
            yield node
    elif isinstance(node, ast.BinOp):
        if isinstance(node.left, ast.Constant) and isinstance(node.right, ast.Constant):  # a fraction is one number
            yield from _literals(node.right if isinstance(node.op, ast.Div) else node.left)
            return
        yield from _literals(node.left)
        if not isinstance(node.op, ast.Pow):
            yield from _literals(node.right)
    elif isinstance(node, ast.Subscript):
        yield from _literals(node.value)
    elif isinstance(node, ast.Lambda | ast.JoinedStr):
        return
    elif isinstance(node, ast.Call):
        for part in node.args:
            yield from _literals(part)
    else:
        for part in ast.iter_child_nodes(node):
            if isinstance(part, ast.expr):
                yield from _literals(part)


def all_numbers(root: Path = ROOT) -> list[Number]:
    """The numbers of identify/ and diagnose/ below a root, in order of files and lines."""
    files = sorted(path for folder in FOLDERS for path in (root / folder).rglob("*.py"))
    return [
        number
        for path in files
        for number in numbers_of(path.relative_to(root).as_posix(), path.read_text(encoding="utf-8"))
    ]


def table(numbers: Sequence[Number]) -> str:
    """Counts of each wing, and of all."""
    kinds = ("decides", "constant", "literal", *NO_DECISION)
    lines = [f"{'wing':20s}{'deciding':>9s}" + "".join(f"{kind:>10s}" for kind in kinds)]
    for wing in [*sorted({number.wing for number in numbers}), "all"]:
        mine = [number for number in numbers if wing in (number.wing, "all")]
        by = Counter(number.kind for number in mine)
        lines.append(
            f"{wing:20s}{sum(number.counts for number in mine):9d}" + "".join(f"{by[kind]:10d}" for kind in kinds)
        )
    return "\n".join(lines)


def page(root: Path = ROOT) -> str:
    """The table of docs/limits.md: every number in a registry, by wing."""
    blocks = []
    paths = [root / ODDS, *sorted(path for folder in FOLDERS for path in (root / folder).rglob("limits.py"))]
    for path in paths:
        rows = ["| number | value | unit | decides | why |", "|---|---|---|---|---|"]
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call) and _called(node.value) == "decides":
                cells = [*node.value.args, *(keyword.value for keyword in node.value.keywords)]
                value, *words = (ast.unparse(cells[0]), *(str(ast.literal_eval(cell)) for cell in cells[1:]))
                rows.append(" | ".join([f"| `{ast.unparse(node.targets[0])}`", value, *words]) + " |")
        where = path.relative_to(root) if path == root / ODDS else path.parent.relative_to(root)
        blocks.append(f"## {where.as_posix()}\n\n" + "\n".join(rows))
    return "\n\n".join(blocks)


def main() -> None:
    """Print the table; see the module."""
    parser = argparse.ArgumentParser(description="Count the numbers that decide in identify/ and diagnose/.")
    parser.add_argument("--list", action="store_true", help="print each number")
    parser.add_argument("--wing", help="of this wing alone")
    parser.add_argument("--page", action="store_true", help="print the table of docs/limits.md")
    options = parser.parse_args()
    if options.page:
        print(page())
        return
    numbers = all_numbers()
    count = sum(number.counts for number in numbers)
    if options.wing:
        numbers = [number for number in numbers if number.wing == options.wing]
    if options.list:
        for number in numbers:
            print(f"{number.file}:{number.line}: {number.kind} {number.name} {number.value:g}")
    print(table(numbers))
    if count > MOST:
        sys.exit(f"{count} numbers decide, {MOST} were allowed: take one away, or register a budget with its reason")


if __name__ == "__main__":
    main()
