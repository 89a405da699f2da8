"""No file of the package imports, by whatever way, a file that imports it: lazy and type-only imports count."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

ROOT = Path(__file__).parent.parent
OUTSIDE = {"tests", "benchmarks", "docs", "build"}


def modules(root: Path) -> dict[str, Path]:
    """Every file of the package by its dotted name.

    The package's own is left out: it hands on names of others when they are asked for, and the others ask it for the
    version alone.
    """
    found = {}
    for path in sorted(root.rglob("*.py")):
        parts = path.relative_to(root).with_suffix("").parts
        if parts[0] not in OUTSIDE and not any(part.startswith(".") for part in parts):
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    found.pop("", None)
    return found


def imported(name: str, path: Path, known: Mapping[str, Path]) -> set[str]:
    """The files of the package that a file imports, inside functions and for types alone too."""
    parts = name.split(".")
    package = parts if path.name == "__init__.py" else parts[:-1]
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.ImportFrom) or not node.level:
            continue
        base = [*package[: len(package) - node.level + 1], *(node.module.split(".") if node.module else [])]
        for alias in node.names:
            whole = ".".join([*base, alias.name])
            found.add(whole if whole in known else ".".join(base))
    return (found & set(known)) - {name}


def circles(root: Path) -> set[frozenset[str]]:
    """Sets of files that reach one another (strongly connected components of more than one)."""
    known = modules(root)
    names = list(known)
    arrows = [(names.index(a), names.index(b)) for a in names for b in imported(a, known[a], known)]
    rows, columns = np.array(arrows, dtype=int).reshape(-1, 2).T
    graph = csr_array((np.ones(rows.size), (rows, columns)), shape=(len(names), len(names)))
    _, label = connected_components(graph, connection="strong")
    groups = [frozenset(names[i] for i in np.flatnonzero(label == k)) for k in np.unique(label)]
    return {group for group in groups if len(group) > 1}


def test_there_is_no_circle() -> None:
    assert circles(ROOT) == set()


def test_a_circle_is_found(tmp_path: Path) -> None:
    (tmp_path / "wing").mkdir()
    (tmp_path / "__init__.py").write_text("from .door import open\n")
    (tmp_path / "door.py").write_text("def open():\n    from .wing import hinge\n")
    (tmp_path / "wing" / "__init__.py").write_text("")
    (tmp_path / "wing" / "hinge.py").write_text(
        "import typing\nif typing.TYPE_CHECKING:\n    from ..door import open\n"
    )
    (tmp_path / "floor.py").write_text("from .wing.hinge import turn\n")
    assert circles(tmp_path) == {frozenset({"door", "wing.hinge"})}
