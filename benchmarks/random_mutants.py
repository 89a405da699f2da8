"""How many random one-line mutants of the package the tests kill, and which of the same mutants after a rebuilding.

    python -P benchmarks/random_mutants.py [-n 60] [--seed 0] [--root CHECKOUT] --record FILE.json
    python -P benchmarks/random_mutants.py --replay FILE.json [--root CHECKOUT] [--record OTHER.json]

The mutants (`mutants.py` says which there are) are drawn from all files of identify, diagnose, model, export and verify
together. Against each run the tests of `make test-all` that mirror its file, by name, then those that import its
module, until one fails. A test that fails also without the mutant kills nothing: it is left out. A mutant is killed,
survives, or runs out of time, which says nothing where the tests take long and is a kill where the mutant never ends.

A recorded mutant is known by the name of its file, the function, and the line before and after, in the form that
``ast.unparse`` gives, so that it is found again wherever file and function have gone; a line that is no longer there is
said to be gone. Results are written after each mutant. The exit code is 1 where one survives that was killed before.
"""

from __future__ import annotations

import argparse
import ast
import importlib.util
import json
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

# python -P does not look beside the script
sys.path.insert(0, str(Path(__file__).resolve().parent))

from mutants import LEFT_OUT, made, places

FOLDERS = ("identify", "diagnose", "model", "export", "verify")
#: No part of the package, or data that no test of a folder above judges.
OUTSIDE = {"tests", "benchmarks", "docs", "examples", "build", ".venv"}
KILLED, SURVIVED, TIMED_OUT, GONE = "killed", "survived", "timed out", "gone"
#: Bytes of memory that tests of a mutant may take: one that allocates without end must not take the machine with it.
MEMORY = 8 * 2**30
_FAILED = re.compile(r"^(?:FAILED|ERROR) (.+)$", re.MULTILINE)


@dataclass(frozen=True)
class Known:
    """A mutant as it is known from one tree to another.

    Attributes:
        file: where it was drawn from, from the root of that checkout.
        function: the innermost one in which it is; empty outside all.
        before, after: the changed expression.
        line, changed: the line before and after; of a function that returns at once its head and ``return``.
        occurrence: which of the equal ones of the file.
    """

    file: str
    function: str
    before: str
    after: str
    line: str
    changed: str
    occurrence: int = 0

    def is_like(self, other: Known) -> bool:
        """Whether it changes the same line of a function of the same name in the same way."""
        return self._key() == other._key()

    def _key(self) -> tuple[str, ...]:
        return self.function, self.before, self.after, self.line, self.changed


def functions_of(tree: ast.AST) -> dict[int, str]:
    """By the identity of each node the name of the innermost function around it; a function is around itself."""
    around: dict[int, str] = {}

    def descend(node: ast.AST, name: str) -> None:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            name = node.name
        around[id(node)] = name
        for child in ast.iter_child_nodes(node):
            descend(child, name)

    descend(tree, "")
    return around


def known_of(tree: ast.AST, place: int, which: int, node: ast.AST, function: str, file: Path) -> tuple[Known, str]:
    """A mutant as it is known, and the text of the file with it."""
    mutant = made(tree, place, which)
    if isinstance(node, ast.FunctionDef):
        head = next(line for line in ast.unparse(node).splitlines() if line.startswith("def "))
        return Known(file.as_posix(), function, mutant.before, mutant.after, head, "return"), mutant.text
    lines = ast.unparse(tree).splitlines(), mutant.text.splitlines()
    line, changed = next((a.strip(), b.strip()) for a, b in zip(*lines, strict=False) if a != b)
    return Known(file.as_posix(), function, mutant.before, mutant.after, line, changed), mutant.text


def sources(root: Path, folders: tuple[str, ...] = ()) -> list[Path]:
    """The files of some folders of the package, or of all, from its root, in order."""
    every = [path.relative_to(root) for path in root.rglob("*.py")]
    inside = [file for file in every if not OUTSIDE & set(file.parts)]
    return sorted(file for file in inside if not folders or file.parts[0] in folders)


def drawn(root: Path, count: int, seed: int) -> list[Known]:
    """So many mutants of the folders together, in the order of files and lines."""
    trees = {file: ast.parse((root / file).read_text(encoding="utf-8")) for file in sources(root, FOLDERS)}
    every = [(file, *change) for file, tree in trees.items() for change in places(tree)]
    chosen = random.Random(seed).sample(every, min(count, len(every)))
    result: list[Known] = []
    for file, place, which, node in sorted(chosen, key=lambda one: (one[0], getattr(one[3], "lineno", 0), *one[1:3])):
        tree = trees[file]
        around = functions_of(tree)
        known, _ = known_of(tree, place, which, node, around[id(node)], file)
        # others of the file like it, as far as this one
        alike = [k for k, at, of, _ in similar(tree, known, file) if (at, of) < (place, which)]
        result.append(Known(**{**asdict(known), "occurrence": len(alike)}))
    return result


def similar(tree: ast.AST, known: Known, file: Path) -> Iterator[tuple[Known, int, int, str]]:
    """The mutants of a file that are like a known one, with their places and texts."""
    around = functions_of(tree)
    for place, which, node in places(tree):
        if around[id(node)] != known.function:
            continue
        before = f"def {node.name}" if isinstance(node, ast.FunctionDef) else ast.unparse(node).splitlines()[0]
        if before != known.before:
            continue
        other, text = known_of(tree, place, which, node, known.function, file)
        if other.is_like(known):
            yield other, place, which, text


def found_again(root: Path, known: Known) -> tuple[Path, str] | None:
    """The file and its text with a known mutant, in whichever folder it is now; None where its line is gone."""
    files = sources(root)
    # where it was, then a file of its name, in a folder that is the same as far as possible; then any other
    was = Path(known.file)
    files.sort(key=lambda file: (file != was, file.name != was.name, file.parts[0] != was.parts[0]))
    for file in files:
        text = (root / file).read_text(encoding="utf-8")
        if known.function not in text:
            continue
        tree = ast.parse(text)
        if not any(line.strip() == known.line for line in ast.unparse(tree).splitlines()):
            continue
        alike = list(similar(tree, known, file))
        if alike:
            return file, alike[min(known.occurrence, len(alike) - 1)][3]
    return None


def modules_imported(file: Path) -> set[str]:
    """Every module that a file may import: ``from a import b`` gives ``a`` and ``a.b``."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found |= {node.module, *(f"{node.module}.{name.name}" for name in node.names)}
    return found


def fitting_tests(root: Path, file: Path, imported: dict[Path, set[str]], package: str) -> list[Path]:
    """The test files that mirror a file, by name and first folder, then those that import its module."""
    parts = file.with_suffix("").parts
    parts = parts[:-1] if parts[-1] == "__init__" else parts
    module = ".".join((package, *parts))
    tests = sorted(imported)
    mirrors = [t for t in tests if t.name == f"test_{parts[-1]}.py" and t.parts[1:2] == parts[:1]]
    return mirrors + [t for t in tests if t not in mirrors and module in imported[t]]


class Judge:
    """Runs tests against mutants, in a copy of a checkout."""

    def __init__(self, copied: Path, limit: float) -> None:
        self.copied = copied
        self.limit = limit
        #: Older checkouts have no lane of the night; to leave it out is then an error of usage.
        self.has_nightly = "nightly" in (copied / "pyproject.toml").read_text(encoding="utf-8")
        #: Tests that fail without any mutant, and that do not.
        self.red: set[str] = set()
        self.green: set[str] = set()

    def _pytest(self, asked: list[str], seconds: float) -> tuple[int | None, str]:
        """The exit code of pytest and what it printed; None where it took longer."""
        environment = {**os.environ, "PYTHONPATH": str(self.copied.parent), "OPENBLAS_NUM_THREADS": "1"}
        how = ["-x", "-p", "no:cacheprovider", "-rfE", "--tb=no", "-m", "not nightly" if self.has_nightly else ""]
        command = [sys.executable, "-P", "-m", "pytest", *how, *asked]
        process = subprocess.Popen(
            command,
            cwd=self.copied,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY)),
        )
        try:
            out, _ = process.communicate(timeout=max(seconds, 1.0))
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)  # what the tests started too
            process.communicate()
            return None, ""
        return process.returncode, out

    def judge(self, file: Path, text: str, tests: list[Path]) -> tuple[str, str]:
        """Whether a file's text is killed, and by which test."""
        if not tests:
            return SURVIVED, "no test mirrors or imports it"
        target = self.copied / file
        original = target.read_text(encoding="utf-8")
        end = time.monotonic() + self.limit
        try:
            while True:
                put(target, text)
                left_out = [f"--deselect={name}" for name in sorted(self.red)]
                code, out = self._pytest([*map(str, tests), *left_out], end - time.monotonic())
                if code is None:
                    return TIMED_OUT, f"after {self.limit:.0f} s"
                if code in (0, 5):
                    return SURVIVED, ""
                name = failed_of(out)
                if code == 4:
                    sys.exit(f"pytest cannot be called as it is here:\n{out}")
                if name is None:  # the process itself ended
                    return KILLED, f"pytest ended with code {code}"
                # as the mutant is written, and nothing changed
                put(target, ast.unparse(ast.parse(original)))
                if self._passes(name):
                    return KILLED, name
                self.red.add(name)
        finally:
            put(target, original)

    def _passes(self, name: str) -> bool:
        """Whether a test passes now; where there is no test of that name, all of its file."""
        if name not in self.green:
            code, _ = self._pytest([name], self.limit)
            if code == 4:
                code, _ = self._pytest([name.partition("::")[0]], self.limit)
            if code != 0:
                return False
            self.green.add(name)
        return True


def put(source: Path, text: str) -> None:
    """Write a module's text, without what was compiled of the text before.

    Compiled code is held to be that of a source of its size and second: two texts of one length within a second would
    be taken for one.
    """
    source.write_text(text, encoding="utf-8")
    Path(importlib.util.cache_from_source(str(source))).unlink(missing_ok=True)


def failed_of(out: str) -> str | None:
    """The first test that pytest says has failed; None where it says of none."""
    match = _FAILED.search(out)
    return None if match is None else match[1].partition(" - ")[0].strip()


def try_all(root: Path, entries: list[dict[str, Any]], options: argparse.Namespace) -> list[dict[str, Any]]:
    """Try each of the recorded mutants and print it; the same entries with what came out."""
    package = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]["name"]
    end = time.monotonic() + 60 * options.minutes
    results: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as temporary:
        copied = Path(temporary) / package  # the root of the checkout is the package: its folder bears the name
        shutil.copytree(root, copied, ignore=shutil.ignore_patterns(*LEFT_OUT))
        imported = {t.relative_to(copied): modules_imported(t) for t in (copied / "tests").rglob("test_*.py")}
        judge = Judge(copied, options.limit)
        for entry in entries:
            if time.monotonic() > end:
                break
            known = Known(**{name: entry[name] for name in Known.__dataclass_fields__})
            where = found_again(copied, known)
            outcome, by, began = GONE, "", time.monotonic()
            if where is not None:
                outcome, by = judge.judge(*where, fitting_tests(copied, where[0], imported, package))
            now = {"file_now": str(where[0]) if where else "", "seconds": round(time.monotonic() - began, 1)}
            before = {"outcome_before": entry["outcome"]} if "outcome" in entry else {}
            results.append({**asdict(known), **now, "outcome": outcome, "by": by, **before})
            lost = " (was killed)" if before.get("outcome_before") == KILLED and outcome == SURVIVED else ""
            print(
                f"{outcome:9}{lost}  {known.file}, {known.function or 'outside'}: {known.line}  ->  {known.changed}",
                f"  [{by}]" if by else "",
                flush=True,
            )
            if options.record:
                save(options.record, results, entries)
    if judge.red:
        print(f"left out, because they fail without a mutant: {', '.join(sorted(judge.red))}")
    return results


def save(file: Path, results: list[dict[str, Any]], entries: list[dict[str, Any]]) -> None:
    """Write what has been tried, and what has not."""
    whole = [*results, *entries[len(results) :]]
    file.write_text(json.dumps({"format": "dashpot-mutants/1", "mutants": whole}, indent=1) + "\n", encoding="utf-8")


def report(results: list[dict[str, Any]], asked: int) -> bool:
    """Print how many were killed, and the survivors; whether one survives that was killed before."""
    counts = Counter(entry["outcome"] for entry in results)
    judged = counts[KILLED] + counts[SURVIVED]
    share = f", {counts[KILLED] / judged:.0%} of those that the tests decide" if judged else ""
    print(f"\n{counts[KILLED]} killed, {counts[SURVIVED]} survived, {counts[TIMED_OUT]} timed out{share}")
    if counts[GONE]:
        print(f"{counts[GONE]} of the lines are gone")
    if len(results) < asked:
        print(f"{asked - len(results)} not tried: the time is over")
    lost = [e for e in results if e["outcome"] == SURVIVED and e.get("outcome_before") == KILLED]
    for title, entries in (
        ("survivors", [e for e in results if e["outcome"] == SURVIVED and e not in lost]),
        ("killed before, and survive", lost),
    ):
        if entries:
            print(f"\n{title}:")
        for e in entries:
            print(f"  {e['file_now']}, {e['function'] or 'outside'}: {e['line']}  ->  {e['changed']}")
    return bool(lost)


def main(arguments: list[str] | None = None) -> int:
    """Draw or read the mutants and try them; the exit code."""
    parser = argparse.ArgumentParser(description="Random one-line mutants of the package against its fast tests.")
    parser.add_argument("-n", type=int, default=60, metavar="N", help="mutants (60)")
    parser.add_argument("--seed", type=int, default=0, help="of the sample (0)")
    parser.add_argument("--root", type=Path, default=Path(__file__).parent.parent, help="the checkout")
    parser.add_argument("--record", type=Path, metavar="FILE", help="write the mutants and what came out")
    parser.add_argument("--replay", type=Path, metavar="FILE", help="try the mutants of a recorded file")
    parser.add_argument("--limit", type=float, default=150.0, metavar="S", help="seconds for the tests of one (150)")
    parser.add_argument("--minutes", type=float, default=1e6, metavar="M", help="begin no further one after that")
    parser.add_argument("--draw-only", action="store_true", help="with --record: draw, and try none")
    options = parser.parse_args(arguments)
    root = options.root.resolve()
    if options.replay:
        entries = json.loads(options.replay.read_text(encoding="utf-8"))["mutants"]
    else:
        entries = [asdict(known) for known in drawn(root, options.n, options.seed)]
    if options.record:
        save(options.record, [], entries)
    if options.draw_only:
        return 0
    return 1 if report(try_all(root, entries, options), len(entries)) else 0


if __name__ == "__main__":
    sys.exit(main())
