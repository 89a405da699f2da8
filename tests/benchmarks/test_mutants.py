"""The mutants of a package of two functions: which are made, which its tests kill, and that nothing is changed."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
sys.path.append(str(BENCHMARKS))

from mutants import mutants, own_test, sample  # noqa: E402  (it lies beside the package, not in it)

SOURCE = '''"""Two functions."""


def clipped(value: float, most: float) -> float:
    """At most so much."""
    return min(value, most) if value > 0 else 0.0


def within(value: float, low: float, high: float) -> bool:
    """Between two others."""
    return low <= value and not value > high
'''
THOROUGH = """from tiny.rooms.door import clipped, within


def test_clipped():
    assert [clipped(v, 2.0) for v in (-1.0, 1.0, 3.0)] == [0.0, 1.0, 2.0]


def test_within():
    assert [within(v, 1.0, 2.0) for v in (0.5, 1.5, 2.5)] == [False, True, False]
"""
CARELESS = "from tiny.rooms.door import clipped\n\n\ndef test_clipped():\n    assert clipped(1.0, 2.0) == 1.0\n"


def checkout(folder: Path, test: str | None) -> Path:
    """A package whose root is its checkout, with one module and the tests of it."""
    root = folder / "somewhere"
    (root / "rooms").mkdir(parents=True)
    (root / "pyproject.toml").write_text('[project]\nname = "tiny"\n')
    (root / "__init__.py").touch()
    (root / "rooms" / "__init__.py").touch()
    (root / "rooms" / "door.py").write_text(SOURCE)
    if test is not None:
        (root / "tests" / "rooms").mkdir(parents=True)
        (root / "tests" / "rooms" / "test_door.py").write_text(test)
    return root


def survey(root: Path, *more: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-P", str(BENCHMARKS / "mutants.py"), "rooms/door.py", "--root", str(root), *more]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    ("source", "changed"),
    [
        ("a < b", ["a >= b"]),
        ("a < b <= c", ["a >= b <= c", "a < b > c"]),
        ("a is None", ["a is not None"]),
        ("a not in b", ["a in b"]),
        ("2.5", ["5.0"]),
        ("-1", ["-2"]),
        ("0.0", []),
        ("1e-300", []),
        ("True", []),
        ("'text'", []),
        ("a + b", ["a - b"]),
        ("a - b", ["a + b"]),
        ("a * b", []),
        ("a -= b", ["a += b"]),
        ("a and b", ["a or b"]),
        ("a or b", ["a and b"]),
        ("min(a)", ["max(a)"]),
        ("np.maximum(a)", ["np.minimum(a)"]),
        ("not a", ["not not a"]),
        ('def f():\n    "Words."\n    return a', ['def f():\n    """Words."""\n    return\n    return a']),
        (
            "def f(n: Literal[3]) -> Literal[4]:\n    g(n)",
            ["def f(n: Literal[3]) -> Literal[4]:\n    return\n    g(n)"],
        ),
    ],
)
def test_each_kind_of_change_is_made_once(source, changed):
    assert sorted(mutant.text for mutant in mutants(source)) == sorted(changed)


def test_a_mutant_says_where_it_is():
    made = mutants(SOURCE)
    assert len(made) == 8
    assert (made[0].line, made[0].before, made[0].after) == (4, "def clipped", "return")
    assert (made[-1].line, made[-1].before, made[-1].after) == (11, "value > high", "value <= high")
    assert len({mutant.text for mutant in made}) == len(made)


def test_tests_mirror_folders():
    assert own_test(Path("identify/backbone.py")) == Path("tests/identify/test_backbone.py")


def test_thorough_tests_kill_every_mutant_and_the_checkout_stays_as_it_is(tmp_path):
    root = checkout(tmp_path, THOROUGH)
    before = {path: path.read_bytes() for path in root.rglob("*") if path.is_file()}
    done = survey(root)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "rooms/door.py: 8 of 8 killed" in done.stdout
    assert {path: path.read_bytes() for path in root.rglob("*") if path.is_file()} == before


def test_careless_tests_are_told_so(tmp_path):
    done = survey(checkout(tmp_path, CARELESS), "-n", "3", "--seed", "1")
    assert done.returncode == 1
    assert "killed    line 6: value > 0  ->  value <= 0" in done.stdout
    assert "SURVIVED  line 11: low <= value  ->  low > value" in done.stdout
    assert "rooms/door.py: 1 of 3 killed" in done.stdout
    assert "fewer than 90% killed: rooms/door.py" in done.stdout


def test_a_sample_is_the_same_each_time_and_another_by_its_seed():
    every = mutants(SOURCE)
    first, again, other = (sample(every, 3, seed, Path("rooms/door.py")) for seed in (0, 0, 1))
    assert first == again != other
    assert all(mutant in every for mutant in first)
    assert sample(every, 99, 0, Path("rooms/door.py")) == every


@pytest.mark.parametrize(
    ("test", "words"),
    [
        (None, "there is no tests/rooms/test_door.py"),
        ("def test_wrong():\n    assert False\n", "fails without any mutant"),
        ("", "pytest ran no test"),
    ],
)
def test_what_is_no_test_of_the_file_kills_nothing(tmp_path, test, words):
    done = survey(checkout(tmp_path, test), "-n", "2")
    assert done.returncode == 1
    assert words in done.stdout + done.stderr
