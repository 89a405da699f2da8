"""Whether identify and diagnose give the same numbers and sentences as at another commit, case by case.

    python -P benchmarks/golden.py [--base REV] [--exact | --tolerance 1e-10] [--numbers] [--only NAME ...]
    python -P benchmarks/golden.py --record FILE.json [--only NAME ...]
    python -P benchmarks/golden.py --compare A.json B.json

The cases stand in `golden_cases.py`. They run on the checkout in which this file lies, and on a copy of the base commit
(HEAD), on the same machine, for the last digits depend on the processor. What the base gives is kept in
``.golden/COMMIT.json``, until the cases or the libraries change. Numbers are kept as hexadecimal floats, so that none
is rounded. ``--exact`` compares them bit for bit; otherwise a relative tolerance is allowed (`golden_compare.py` says
relative to what). Words must be the same to the letter; ``--numbers`` compares no sentences. The exit code is 1 where a
case differs.
"""

from __future__ import annotations

import argparse
import hashlib
import io
import json
import os
import platform
import queue
import subprocess
import sys
import tarfile
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import Any

# python -P does not look beside the script
sys.path.insert(0, str(Path(__file__).resolve().parent))

from golden_compare import compare, plain

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
FORMAT = "dashpot-golden/1"
TOLERANCE = 1e-10
#: Processes beside each other: as many as the machine that checks has cores.
PROCESSES = 2


def stamp() -> str:
    """Changes where what the base has given must be made again: with the cases, the libraries, the machine."""
    versions = [f"{name} {version(name)}" for name in ("numpy", "scipy", "casadi")]
    made_of = [(HERE / "golden_cases.py").read_text(encoding="utf-8"), sys.version, platform.processor(), *versions]
    return hashlib.sha256("\n".join(made_of).encode()).hexdigest()


def work() -> None:
    """Run the cases whose names come in, a line each; what they give goes out, a line each."""
    out, sys.stdout = sys.stdout, sys.stderr
    from golden_cases import cases, dashpot

    assert dashpot.__file__ is not None
    known = cases()
    print(json.dumps({"file": dashpot.__file__, "cases": list(known)}), file=out, flush=True)
    for line in sys.stdin:
        began = time.process_time()
        try:
            result = known[line.strip()]()
        except dashpot.BadInput as refusal:
            result = {"refused": str(refusal)}
        except Exception as problem:  # the other cases run all the same
            result = {"error": f"{type(problem).__name__}: {problem}"}
        seconds = time.process_time() - began
        print(json.dumps({"result": plain(result), "seconds": round(seconds, 1)}), file=out, flush=True)


class Worker:
    """A process that runs cases of one tree, one after another."""

    def __init__(self, above: Path) -> None:
        own = {"PYTHONPATH": str(above), "OPENBLAS_NUM_THREADS": "1", "DASHPOT_SECONDS": "inf"}
        environment = {**os.environ, **own}
        command = [sys.executable, "-P", str(Path(__file__).resolve()), "--work"]
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True, env=environment, cwd=above)
        head = self._answer()
        found = Path(head["file"]).resolve().parent
        if found != (above / "dashpot").resolve():
            raise SystemExit(f"the cases run on {found}, not on {above / 'dashpot'}; unset PYTHONPATH and try again")
        self.names: list[str] = head["cases"]

    def _answer(self) -> dict[str, Any]:
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        if not line:
            raise ConnectionError(f"the process has ended with code {self.process.wait()}")
        return json.loads(line)

    def run(self, name: str) -> dict[str, Any]:
        """The result of a case and its seconds of processor; raises ConnectionError where the process ends."""
        assert self.process.stdin is not None
        self.process.stdin.write(name + "\n")
        self.process.stdin.flush()
        return self._answer()

    def end(self) -> None:
        """End the process."""
        self.process.kill()
        self.process.communicate()


def chosen(names: Sequence[str], only: Sequence[str]) -> list[str]:
    """The names that begin with one of those asked for; all where none is."""
    for asked in only:
        if not any(name.startswith(asked) for name in names):
            raise SystemExit(f"no case begins with {asked!r}; there are {', '.join(names)}")
    return [name for name in names if not only or name.startswith(tuple(only))]


def run_tree(above: Path, only: Sequence[str], known: dict[str, Any], what: str) -> dict[str, Any]:
    """Run the cases on the tree ``above/dashpot``; those in `known`, a file as this gives it, are not run again."""
    first = Worker(above)
    names = chosen(first.names, only)
    waiting: queue.SimpleQueue[str] = queue.SimpleQueue()
    kept = known.get("cases", {})
    missing = [name for name in names if name not in kept]
    seconds: dict[str, float] = dict(known.get("seconds", {}))
    # the longest first: the last to end decides how long all take
    for name in sorted(missing, key=lambda name: "diagnosis" not in name):
        waiting.put(name)
    results: dict[str, Any] = dict(kept)

    def drain(worker: Worker) -> None:
        while not waiting.empty():
            try:
                name = waiting.get_nowait()
            except queue.Empty:
                break
            try:
                answer = worker.run(name)
            except (ConnectionError, BrokenPipeError) as problem:
                answer = {"result": {"error": str(problem)}, "seconds": 0.0}
                worker.end()
                worker = Worker(above)
            results[name], seconds[name] = answer["result"], answer["seconds"]
            print(f"\r{what}: {len(results) - len(kept)} of {len(missing)} cases ", end="", file=sys.stderr, flush=True)
        worker.end()

    count = min(PROCESSES, max(len(missing), 1))
    workers = [first, *(Worker(above) for _ in range(count - 1))]
    threads = [threading.Thread(target=drain, args=(worker,)) for worker in workers]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if missing:
        spent = sum(seconds[name] for name in missing)
        print(f"\r{what}: {len(missing)} cases, {spent:.0f} s of processor", file=sys.stderr)
    # in the order of the cases, whichever ended first
    order = [name for name in first.names if name in results]
    return {
        "format": FORMAT,
        "stamp": stamp(),
        "cases": {name: results[name] for name in order},
        "seconds": {name: seconds[name] for name in order if name in seconds},
    }


@contextmanager
def folder_above(root: Path) -> Iterator[Path]:
    """A folder in which that checkout is named ``dashpot``, whatever its own folder is named."""
    with tempfile.TemporaryDirectory() as temporary:
        above = Path(temporary)
        (above / "dashpot").symlink_to(root, target_is_directory=True)
        yield above


@contextmanager
def copy_of(commit: str) -> Iterator[Path]:
    """A folder in which the files of that commit are named ``dashpot``."""
    with tempfile.TemporaryDirectory() as temporary:
        archive = subprocess.run(["git", "archive", "--format=tar", commit], cwd=ROOT, capture_output=True, check=True)
        with tarfile.open(fileobj=io.BytesIO(archive.stdout)) as files:
            files.extractall(Path(temporary) / "dashpot", filter="data")
        yield Path(temporary)


def commit_of(revision: str) -> str:
    """The full name of a commit."""
    asked = ["git", "rev-parse", "--verify", "--quiet", f"{revision}^{{commit}}"]
    done = subprocess.run(asked, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"--base {revision}: there is no such commit in {ROOT}")
    return done.stdout.strip()


def of_base(revision: str, only: Sequence[str]) -> dict[str, Any]:
    """What the base gives, kept from the last time where nothing has changed since."""
    commit = commit_of(revision)
    file = ROOT / ".golden" / f"{commit}.json"
    known = load(file) if file.is_file() else {}
    if known.get("stamp") != stamp():
        known = {}
    with copy_of(commit) as above:
        made = {"commit": commit, **run_tree(above, only, known, f"base {commit[:10]}")}
    if made != known:
        save(file, made)
    return {**made, "cases": {name: made["cases"][name] for name in chosen(list(made["cases"]), only)}}


def of_tree(only: Sequence[str]) -> dict[str, Any]:
    """What the checkout in which this file lies gives."""
    with folder_above(ROOT) as above:
        return {"commit": "working tree", **run_tree(above, only, {}, "working tree")}


def save(file: Path, made: dict[str, Any]) -> None:
    """Write a file of results."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(made, indent=1) + "\n", encoding="utf-8")


def load(file: Path) -> dict[str, Any]:
    """Read a file of results; SystemExit where it is none."""
    try:
        made = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as problem:
        raise SystemExit(f"{file}: cannot be read ({problem}); record it again") from problem
    if not isinstance(made, dict) or made.get("format") != FORMAT:
        raise SystemExit(f"{file}: is no file of this program; record it with --record")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what is asked for; the exit code."""
    parser = argparse.ArgumentParser(description="Compare identify and diagnose with another commit, case by case.")
    parser.add_argument("--base", default="HEAD", metavar="REV", help="commit to compare with (HEAD)")
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="cases whose names begin so")
    parser.add_argument("--exact", action="store_true", help="compare bit for bit")
    parser.add_argument("--tolerance", type=float, default=TOLERANCE, help=f"relative, of numbers ({TOLERANCE:g})")
    parser.add_argument("--numbers", action="store_true", help="compare no sentences")
    parser.add_argument("--record", type=Path, metavar="FILE", help="run this checkout alone and write what it gives")
    parser.add_argument("--compare", nargs=2, type=Path, metavar=("A", "B"), help="compare two recorded files")
    parser.add_argument("--work", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args(arguments)
    if given.work:
        work()
        return 0
    if given.record:
        save(given.record, of_tree(given.only))
        return 0
    tolerance = 0.0 if given.exact else given.tolerance
    if given.compare:
        before, after = (load(file) for file in given.compare)
    else:
        before, after = of_base(given.base, given.only), of_tree(given.only)
    return 0 if compare(before, after, tolerance, given.numbers) else 1


if __name__ == "__main__":
    sys.exit(main())
