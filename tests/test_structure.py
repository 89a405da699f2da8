"""The rules of the house that a machine can check: imports, sizes, names, docstrings, packaging, documents."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from fnmatch import fnmatch
from graphlib import TopologicalSorter
from pathlib import Path

import dashpot
import pytest

ROOT = Path(__file__).parent.parent
OUTSIDE = {"tests", "benchmarks", "docs"}  # folders that use the package and are no part of it
MADE = {"build", "dist", "demo", "recorded", "site", "__pycache__"}  # folders that the commands make
LONGEST = 500
SOURCES = {".py", ".c", ".h", ".j2", ".txt", ".md", ".toml", ".yaml", ".css", ".js"}
HEAVY = ("scipy.signal", "scipy.integrate", "scipy.optimize", "casadi", "fmpy", "pythonfmu", "matplotlib")


def files(folder: Path = ROOT) -> Iterator[Path]:
    """Every file that belongs to the project, as a path below `folder`."""
    for path in sorted(folder.iterdir()):
        if path.is_dir():
            hidden = path.name.startswith(".") and path.name != ".ci"
            if not hidden and path.name not in MADE and path.suffix != ".egg-info":
                yield from files(path)
        elif path.suffix != ".pyc":
            yield path


FILES = [path.relative_to(ROOT) for path in files()]
MODULES = [path for path in FILES if path.suffix == ".py" and path.parts[0] not in OUTSIDE]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


# Which folder may import which ---------------------------------------------------------------------------------------


def read_table(text: str) -> dict[str, set[str]]:
    """Read the table of docs/house.md: folder (or cli) to the folders it may import."""
    table: dict[str, set[str]] = {}
    unbounded = []
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) != 3 or not (name := re.fullmatch(r"`(\w+)(?:/|\.py)`", cells[0])):
            continue
        table[name[1]] = set(re.findall(r"`(\w+)`", cells[2]))
        if cells[2].startswith("everything"):
            unbounded.append(name[1])
        elif not table[name[1]] and cells[2] != "nothing":
            raise ValueError(f"docs/house.md: the row of {name[1]} allows '{cells[2]}', which is no list of folders")
    for name in unbounded:
        table[name] = set(table) - {name}
    return table


#: Files of the root that import what stands above them, in functions alone.
REACHES_UP = {
    "__main__": {"commands"},
    "__init__": {"face", "model", "recording", "verify", "examples"},  # the names that it hands on
}
FOR_ALL = {"errors", "files"}
#: The wings of identify/, from the lowest: each may import those before it.
WINGS = ("signals", "motion", "hilbert", "problem", "start", "fit", "faults")
TABLE = read_table((ROOT / "docs/house.md").read_text(encoding="utf-8"))


def imported(path: Path, tree: ast.AST) -> Iterator[tuple[int, tuple[str, ...]]]:
    """Yield line and full module name of everything that a file imports, inside functions too.

    `path` is the file below the root. Names of our modules in plain strings, as `importlib` takes them, count as well.
    """
    package = ("dashpot", *path.parent.parts)
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield node.lineno, tuple(alias.name.split("."))
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            base += tuple(node.module.split(".")) if node.module else ()
            for alias in node.names:
                yield node.lineno, (*base, alias.name)
        elif isinstance(node, ast.Constant) and re.fullmatch(r"dashpot(\.\w+)+", str(node.value)):
            yield node.lineno, tuple(str(node.value).split("."))


def violations(path: Path, text: str) -> list[str]:
    """Return what a file imports against the table, one sentence each."""
    here = path.parts[0] if len(path.parts) > 1 else path.stem
    allowed = FOR_ALL | REACHES_UP.get(here, TABLE.get(here, set()))
    sentences = []
    for line, name in imported(path, ast.parse(text)):
        where = f"{path}:{line}"
        if name[0] in TABLE:
            sentences.append(
                f"{where} imports '{'.'.join(name)}' from the current folder; write it relative to the package"
            )
        elif name[0] == "dashpot" and len(name) > 1 and name[1] in TABLE and name[1] != here and name[1] not in allowed:
            sentences.append(f"{where}: {here} imports {name[1]}, which the table of docs/house.md does not allow")
        elif name[:2] == ("dashpot", "identify") and here == "identify" and len(path.parts) == 3 and len(name) > 2:
            wing = WINGS.index(path.parts[1])
            if name[2] not in WINGS[: wing + 1]:
                sentences.append(f"{where}: the wing {path.parts[1]} imports {name[2]}, which stands above it")
    return sentences


@pytest.mark.parametrize("folder", [*sorted(TABLE), "root"])
def test_imports_go_downwards(folder: str) -> None:
    mine = [path for path in MODULES if path.parts[0] == folder or (folder == "root" and len(path.parts) == 1)]
    sentences = [sentence for path in mine for sentence in violations(path, (ROOT / path).read_text(encoding="utf-8"))]
    assert not sentences, "\n".join(sentences)


@pytest.mark.parametrize(
    ("path", "text"),
    [
        ("identify/made_up.py", "from ..export import fmu"),
        ("identify/made_up.py", "from .. import errors, commands"),
        ("identify/made_up.py", "import numpy\nimport dashpot.report.page as page"),
        ("model/made_up.py", "def f():\n    if True:\n        from dashpot.simulate import core\n"),
        ("model/laws/made_up.py", "from ...identify.freevib import freevib"),
        ("model/laws/made_up.py", "from ... import recording"),
        ("recording/made_up.py", "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from ..model import Law"),
        ("recording/__init__.py", "from ..model import Oscillator"),
        ("identify/made_up.py", "import importlib\nimportlib.import_module('dashpot.report')"),
        ("identify/made_up.py", "from model import Oscillator"),
        ("errors.py", "from .model import Oscillator"),
        ("identify/motion/made_up.py", "from ..start import start"),
        ("identify/signals/made_up.py", "def f():\n    from ..fit.hold import with_hold"),
        ("__init__.py", "from .identify import identify"),
    ],
)
def test_the_checker_catches_a_violation(path: str, text: str) -> None:
    assert len(violations(Path(path), text)) == 1


@pytest.mark.parametrize(
    ("path", "text"),
    [
        ("identify/made_up.py", "from ..model import Oscillator\nfrom . import hilbert\nfrom .. import __version__"),
        ("model/laws/made_up.py", "from ...errors import BadInput\nfrom ..law import Law\nfrom . import preload"),
        ("export/made_up.py", "from importlib import resources\nresources.files('dashpot.templates')"),
        (
            "commands/cli.py",
            "from ..verify import verify\nfrom ..report import page\nfrom .. import errors",
        ),
        ("__main__.py", "from .commands.cli import main"),
    ],
)
def test_the_checker_lets_the_allowed_pass(path: str, text: str) -> None:
    assert violations(Path(path), text) == []


def test_the_table_has_no_circle_and_a_bottom() -> None:
    # Examples may use everything and the command line shows them, so they stand outside.
    order = list(TopologicalSorter({name: TABLE[name] - {"examples"} for name in TABLE}).static_order())
    assert TABLE["model"] == TABLE["recording"] == TABLE["templates"] == set()
    assert (
        order.index("commands")
        > order.index("face")
        > order.index("report")
        > order.index("export")
        > order.index("identify")
    )


def test_every_module_has_a_place_in_the_table() -> None:
    places = {path.parts[0] if len(path.parts) > 1 else path.stem for path in MODULES}
    assert places == {*TABLE, *REACHES_UP, "errors"}, f"no row in docs/house.md, or a row of nothing: {sorted(places)}"


def test_the_built_in_stands_share_no_code_with_the_product() -> None:
    seen: set[Path] = set()
    todo = [Path("examples/rig.py"), Path("examples/__init__.py")]
    while todo:
        path = todo.pop()
        seen.add(path)
        for line, name in imported(path, ast.parse((ROOT / path).read_text(encoding="utf-8"))):
            if name[0] == "dashpot":
                assert name[1] == "examples", f"{path}:{line} imports {'.'.join(name)}"
                beside = Path("examples", f"{name[2]}.py")
                if beside in MODULES and beside not in seen:
                    todo.append(beside)
    assert len(seen) > 2


@pytest.mark.parametrize(
    "module", ["dashpot", "dashpot.errors", "dashpot.commands.cli", "dashpot.model", "dashpot.recording"]
)
def test_import_is_light(module: str, tmp_path: Path) -> None:
    program = f"import sys, {module}; print(*[name for name in {HEAVY} if name in sys.modules])"
    # -P and another folder: the installed package is meant, not the folders that lie here.
    run = subprocess.run(
        [sys.executable, "-P", "-c", program], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout.split() == [], f"import {module} loads {run.stdout.strip()}; import it where it is used"


def test_no_command_needs_scipy_signal() -> None:
    """It takes a quarter of a second to import, as scipy.stats does that comes with it."""
    slow = {("scipy", "signal"), ("scipy", "stats")}
    own = [path for path in MODULES if path.parts[0] != "examples"]
    trees = {path: ast.parse((ROOT / path).read_text(encoding="utf-8")) for path in own}
    assert [str(path) for path, tree in trees.items() if slow & {name[:2] for _, name in imported(path, tree)}] == []


# Sizes, names, docstrings --------------------------------------------------------------------------------------------


def test_no_file_is_long() -> None:
    sources = [path for path in FILES if path.suffix in SOURCES or path.name in {"Makefile", "run", "setup"}]
    lengths = {path: len((ROOT / path).read_text(encoding="utf-8").splitlines()) for path in sources}
    assert len(lengths) > 20
    assert {str(path): lines for path, lines in lengths.items() if lines > LONGEST} == {}


def test_no_property_takes_a_lock_that_a_fork_would_find_taken() -> None:
    """That of functools does in Python 3.11: see files/computed_once.py."""
    assert [path for path in MODULES if "cached_" + "property" in (ROOT / path).read_text(encoding="utf-8")] == []


def test_nothing_is_named_after_nothing() -> None:
    vague = {"utils", "util", "helpers", "helper", "common", "misc"}
    named = [path for path in FILES if vague & {*path.parts[:-1], path.stem}]
    assert named == []


def undocumented(path: Path, body: list[ast.stmt], owner: str = "") -> Iterator[str]:
    """Yield the public functions, classes and methods without a docstring."""
    for node in body:
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef) or node.name.startswith("_"):
            continue
        if not ast.get_docstring(node):
            yield f"{path}:{node.lineno}: {owner}{node.name}"
        if isinstance(node, ast.ClassDef):
            yield from undocumented(path, node.body, f"{node.name}.")


def test_every_public_function_and_class_has_a_docstring() -> None:
    trees = {path: ast.parse((ROOT / path).read_text(encoding="utf-8")) for path in MODULES}
    missing = [name for path, tree in trees.items() for name in undocumented(path, tree.body)]
    missing += [str(path) for path, tree in trees.items() if path.name != "__init__.py" and not ast.get_docstring(tree)]
    assert not missing, "without a docstring:\n" + "\n".join(missing)


def test_a_missing_docstring_is_found() -> None:
    text = 'class A:\n    "Words."\n    def f(self): ...\n    def _g(self): ...\ndef h():\n    "Words."\n'
    assert list(undocumented(Path("m.py"), ast.parse(text).body)) == ["m.py:3: A.f"]


def test_test_folders_mirror_the_package() -> None:
    folders = {path.parts[1] for path in FILES if path.parts[0] == "tests" and len(path.parts) > 2}
    assert folders <= {*TABLE, "benchmarks", "docs"}


# Numbers that decide -------------------------------------------------------------------------------------------------

sys.path.append(str(ROOT / "benchmarks"))

import deciding_numbers  # noqa: E402  (it lies beside the package, not in it)

DECIDING = deciding_numbers.all_numbers(ROOT)


def test_no_more_numbers_decide_than_before() -> None:
    count = sum(number.counts for number in DECIDING)
    assert count <= deciding_numbers.MOST, "take a number away, or say in a registry why it decides nothing"


def test_registries_hold_all_that_is_registered_to_decide() -> None:
    registries = {n.file for n in DECIDING if Path(n.file).name == "limits.py"} | {deciding_numbers.ODDS}
    elsewhere = [n for n in DECIDING if n.kind == "decides" and n.file not in registries]
    others = [n for n in DECIDING if n.kind != "decides" and Path(n.file).name == "limits.py" and n.counts]
    assert (elsewhere, others) == ([], [])


def test_the_page_prints_the_registries() -> None:
    text = (ROOT / "docs/limits.md").read_text(encoding="utf-8")
    table = text.partition("<!-- the numbers -->\n\n")[2].rstrip()
    assert table == deciding_numbers.page(ROOT), "docs/limits.md: put behind its marker what --page prints"


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("_A = 3", [3]),
        ("_A: float = 1 / 8", [8]),
        ("A, _B = 1.5, 4", [1.5, 4]),
        ("_A = budget(64, 's', why='b')", []),
        ("_A = decides(0.5, 'm', 'c', why='b')", [0.5]),
        ("_A = 2.0 * OTHER", []),
        ("name = 3", []),
        ("def f(x):\n    return x > 0.3 * x.y[5] ** 3 or x < 1", [0.3]),
        ("def f(x):\n    return max(min(x, 7), 1e-300)", [7]),
        ("def f(x):\n    return np.clip(x, -1.0, 4.0)", [4]),
        ("def f(x):\n    return 5 * x", []),
    ],
)
def test_a_number_that_decides_is_counted(text: str, values: list[float]) -> None:
    counted = [number for number in deciding_numbers.numbers_of("diagnose/m.py", text) if number.counts]
    assert sorted(number.value for number in counted) == sorted(values)


# Packaging and documents ---------------------------------------------------------------------------------------------


def test_every_package_is_listed() -> None:
    # An editable install finds unlisted folders too; a wheel would lack them.
    packages = {".".join(["dashpot", *path.parent.parts]) for path in MODULES}
    assert set(PROJECT["tool"]["setuptools"]["packages"]) == packages


def test_every_data_file_is_packaged() -> None:
    patterns = PROJECT["tool"]["setuptools"]["package-data"]
    for path in FILES:
        if path.parts[0] in TABLE and path.suffix not in {".py", ".md"}:
            packages = [(f"dashpot.{parent.as_posix().replace('/', '.')}", parent) for parent in path.parents]
            assert any(
                fnmatch(path.relative_to(parent).as_posix(), pattern)
                for package, parent in packages
                for pattern in patterns.get(package, [])
            ), f"{path} matches no package-data in pyproject.toml, so an installed dashpot would lack it"


def test_every_dependency_states_its_reason() -> None:
    lines = (ROOT / "pyproject.toml").read_text(encoding="utf-8").splitlines()
    requirements = [line for line in lines if re.match(r'\s+"[a-z]\S*[<>=]=?[\d.]+\S*",', line)]
    assert len(requirements) >= len(PROJECT["project"]["dependencies"])
    assert [line for line in requirements if not re.search(r"#\s*\w+", line)] == []


@pytest.mark.parametrize("name", ["README.md", "LICENSE", "CHANGELOG.md", "CONTRIBUTING.md", "Makefile", ".ci/run"])
def test_public_file_is_there(name: str) -> None:
    assert (ROOT / name).read_text(encoding="utf-8").strip()


def test_the_version_is_the_same_everywhere() -> None:
    version = PROJECT["project"]["version"]
    assert dashpot.__version__ == version
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    newest = re.search(r"^## (\S+)", changelog, re.MULTILINE)
    assert newest is not None
    assert newest[1] == version


DOCUMENTS = [path for path in FILES if path.suffix == ".md"]


@pytest.mark.parametrize("path", DOCUMENTS, ids=str)
def test_links_and_commands_of_documents_exist(path: Path) -> None:
    text = (ROOT / path).read_text(encoding="utf-8")
    links = [link for link in re.findall(r"\]\(([^)#\s]+)", text) if "://" not in link]
    assert [link for link in links if not (ROOT / path.parent / link).exists()] == []
    targets = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    assert set(re.findall(r"`make ([a-z]+)", text)) <= targets
