"""Random mutants of a package of two functions: drawn, tried, and tried again after its files have moved."""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
sys.path.append(str(BENCHMARKS))

import random_mutants  # noqa: E402  (it lies beside the package, not in it)
from random_mutants import Known, drawn, fitting_tests, found_again, modules_imported, put  # noqa: E402

SOURCE = '''"""Two functions."""

MOST = 3


def clipped(value: float, most: float = MOST) -> float:
    """At most so much."""
    return min(value, most) if value > 0 else 0.0


def within(value: float, low: float, high: float) -> bool:
    """Between two others."""
    return low <= value and not value > high
'''
#: Of `within` it knows nothing; the second test is red whatever the file holds.
TEST = """from tiny.identify.door import clipped


def test_clipped():
    assert [clipped(v, 2.0) for v in (-1.0, 1.0, 3.0)] == [0.0, 1.0, 2.0]


def test_red():
    assert False
"""


def checkout(folder: Path, place: str = "identify/door.py", source: str = SOURCE, test: str = TEST) -> Path:
    """A package whose root is its checkout, with one module and its tests in the same folders."""
    root = folder / "somewhere"
    file, tests = root / place, root / "tests" / Path(place).parent / f"test_{Path(place).name}"
    for path in (file, tests):
        path.parent.mkdir(parents=True)
    (root / "pyproject.toml").write_text('[project]\nname = "tiny"\n')
    for above in [root, *(root / parent for parent in Path(place).parents)]:
        (above / "__init__.py").touch()
    file.write_text(source)
    tests.write_text(test)
    return root


def run(root: Path, *more: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-P", str(BENCHMARKS / "random_mutants.py"), "--root", str(root), *more]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def mutant(root: Path, line: str, changed: str) -> Known:
    (one,) = [known for known in drawn(root, 99, 0) if (known.line, known.changed) == (line, changed)]
    return one


WITHIN = ("return low <= value and (not value > high)", "return low > value and (not value > high)")


def test_a_sample_is_the_same_each_time_and_another_by_its_seed(tmp_path):
    root = checkout(tmp_path)
    every = drawn(root, 99, 0)
    assert len(every) == 9
    assert drawn(root, 4, 1) == drawn(root, 4, 1) != drawn(root, 4, 3)
    assert all(known in every for known in drawn(root, 4, 1))
    first = every[0]
    assert (first.file, first.function, first.line, first.changed) == ("identify/door.py", "", "MOST = 3", "MOST = 6")
    assert mutant(root, *WITHIN).function == "within"
    assert any(known.changed == "return" and known.line.startswith("def within(") for known in every)


def test_equal_mutants_of_a_function_are_told_apart_by_their_order(tmp_path):
    twice = "def f(a):\n    b = a + 1\n    b = a + 1\n    return b\n"
    root = checkout(tmp_path, source=twice)
    minus = [known for known in drawn(root, 99, 0) if known.changed == "b = a - 1"]
    assert [known.occurrence for known in minus] == [0, 1]
    texts = [found_again(root, known)[1] for known in minus]
    assert [ast.unparse(ast.parse(text)).splitlines().index("    b = a - 1") for text in texts] == [1, 2]


@pytest.mark.parametrize("place", ["identify/door.py", "identify/fit/door.py", "verify/hinge.py"])
def test_a_mutant_is_found_again_where_its_file_has_gone(tmp_path, place):
    known = mutant(checkout(tmp_path / "before"), *WITHIN)
    # other lines before it, another layout of the text
    moved = "import math\n\n" + SOURCE.replace("low <= value and", "(low <= value) and  # at least\\\n")
    moved = moved.replace("  # at least\\\n", "")
    file, text = found_again(checkout(tmp_path / "after", place, moved), known)
    assert file == Path(place)
    assert WITHIN[1] in text
    assert WITHIN[0] not in text


def test_a_line_that_is_another_is_gone(tmp_path):
    known = mutant(checkout(tmp_path / "before"), *WITHIN)
    root = checkout(tmp_path / "after", source=SOURCE.replace("low <= value", "low < value"))
    assert found_again(root, known) is None


def test_the_tests_are_those_of_its_name_and_those_that_import_it(tmp_path):
    texts = {
        "tests/identify/test_door.py": "import numpy",
        "tests/identify/fit/test_door.py": "",
        "tests/verify/test_door.py": "from dashpot.verify import door",
        "tests/test_all.py": "from dashpot.identify import door as d",
        "tests/test_more.py": "def test():\n    from dashpot.identify.door import clipped",
        "tests/test_none.py": "import dashpot.identify.doors",
    }
    imported = {}
    for name, text in texts.items():
        (tmp_path / "one.py").write_text(text)
        imported[Path(name)] = modules_imported(tmp_path / "one.py")
    chosen = [path.as_posix() for path in fitting_tests(tmp_path, Path("identify/door.py"), imported, "dashpot")]
    assert chosen == [
        "tests/identify/fit/test_door.py",
        "tests/identify/test_door.py",
        "tests/test_all.py",
        "tests/test_more.py",
    ]


def test_the_test_that_failed_is_read():
    assert random_mutants.failed_of("..F\nFAILED tests/a.py::test_b[1-2] - assert 1\n") == "tests/a.py::test_b[1-2]"
    assert random_mutants.failed_of("ERROR tests/a.py - ImportError: no\n") == "tests/a.py"
    assert random_mutants.failed_of("1 passed") is None


def test_of_two_texts_of_one_length_the_last_is_run(tmp_path):
    module = tmp_path / "door.py"
    put(module, "OPEN = 1\n")
    begun = module.stat().st_mtime_ns
    import_it = [
        sys.executable,
        "-P",
        "-c",
        f"import sys; sys.path.insert(0, {str(tmp_path)!r}); import door; print(door.OPEN)",
    ]
    assert subprocess.run(import_it, capture_output=True, text=True, check=True).stdout == "1\n"
    put(module, "OPEN = 2\n")
    os.utime(module, ns=(begun, begun))
    assert subprocess.run(import_it, capture_output=True, text=True, check=True).stdout == "2\n"


def test_what_is_killed_and_what_survives_is_recorded_and_what_was_lost_is_said(tmp_path):
    root, file = checkout(tmp_path), tmp_path / "made.json"
    before = {path: path.read_bytes() for path in root.rglob("*") if path.is_file()}
    done = run(root, "-n", "99", "--record", str(file), "--draw-only")
    assert done.returncode == 0, done.stderr
    every = json.loads(file.read_text())["mutants"]
    chosen = [m for m in every if m["changed"] in (WITHIN[1], "return max(value, most) if value > 0 else 0.0")]
    file.write_text(json.dumps({"mutants": chosen}))
    done = run(root, "--replay", str(file), "--record", str(file))
    assert done.returncode == 0, done.stderr
    assert "1 killed, 1 survived, 0 timed out, 50% of those that the tests decide" in done.stdout
    assert "left out, because they fail without a mutant: tests/identify/test_door.py::test_red" in done.stdout
    assert {path: path.read_bytes() for path in root.rglob("*") if path.is_file()} == before
    killed, survived = json.loads(file.read_text())["mutants"]
    assert (killed["outcome"], killed["by"]) == ("killed", "tests/identify/test_door.py::test_clipped")
    assert survived["outcome"] == "survived"

    # the same tests, but for the one that killed
    careless = checkout(tmp_path / "after", "identify/fit/door.py", test="def test_nothing():\n    pass\n")
    done = run(careless, "--replay", str(file))
    assert done.returncode == 1
    assert "0 killed, 2 survived" in done.stdout
    assert "killed before, and survive:\n  identify/fit/door.py, clipped" in done.stdout


def test_a_mutant_that_never_ends_runs_out_of_time(tmp_path):
    endless = "def f(n):\n    while n > 0:\n        n = n - 1\n    return n\n"
    test = "from tiny.identify.door import f\n\n\ndef test_f():\n    assert f(2) == 0\n"
    root, file = checkout(tmp_path, source=endless, test=test), tmp_path / "made.json"
    run(root, "-n", "99", "--record", str(file), "--draw-only")
    every = json.loads(file.read_text())["mutants"]
    file.write_text(json.dumps({"mutants": [m for m in every if m["changed"] == "n = n + 1"]}))
    done = run(root, "--replay", str(file), "--limit", "5")
    assert "0 killed, 0 survived, 1 timed out" in done.stdout
