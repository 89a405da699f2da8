"""The same recordings told a little differently: a diagnosis whose names change with that is not to be believed.

Each change takes the files of a rig in their order, and gives them in the order in which they are handed over.
"""

from __future__ import annotations

import gzip
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .answer import read_answer
from .dirty_score import share, target

SKIPPED = 5  # samples at the beginning
ENOUGH = 40.0  # samples a cycle, so that half of them still draw the curve

Change = Callable[[Path, list[str]], list[str]]


def _read(path: Path) -> tuple[str, np.ndarray]:
    with gzip.open(path, "rt", encoding="utf-8") as file:
        return file.readline(), np.loadtxt(file, delimiter=",", ndmin=2)


def _write(path: Path, header: str, table: np.ndarray, clock: str = "%.9f") -> None:
    lines = (",".join([clock % row[0], *(f"{value:.7g}" for value in row[1:])]) for row in table)
    path.write_bytes(gzip.compress((header + "\n".join(lines) + "\n").encode(), mtime=0))


def _clock(folder: Path, names: list[str]) -> list[str]:
    for name in names:
        header, table = _read(folder / name)
        _write(folder / name, header, table, "%.6f")
    return names


def _order(folder: Path, names: list[str]) -> list[str]:
    return names[::-1]


def _start(folder: Path, names: list[str]) -> list[str]:
    for name in names:
        header, table = _read(folder / name)
        _write(folder / name, header, table[SKIPPED:])
    return names


def samples_a_cycle(shown: np.ndarray) -> float:
    """Samples between every second crossing of the middle, on average."""
    crossings = np.count_nonzero(np.diff(np.sign(shown - np.median(shown))))
    return 2 * len(shown) / max(crossings, 1)


def _thinned(folder: Path, names: list[str]) -> list[str]:
    tables = {name: _read(folder / name) for name in names}
    if min(samples_a_cycle(table[:, -1]) for _, table in tables.values()) >= ENOUGH:
        for name, (header, table) in tables.items():
            _write(folder / name, header, table[::2])
    return names


CHANGES: dict[str, Change] = {
    "clock's last digits": _clock,
    "order of the files": _order,
    "shifted start": _start,
    "every second sample": _thinned,
}


def stability(results: Path, changed: Path, rigs: Sequence[str]) -> dict[str, Any]:
    """Count the rigs whose names stay, for each change and under all of them.

    `results` has their diagnoses, `changed` a folder of diagnoses for each change; rigs that lack one of both do not
    count for that change. The names of a diagnosis are those it names, in their order.
    """
    rows, steady = {}, dict.fromkeys(rigs, True)
    compared: set[str] = set()
    for change in CHANGES:
        same = []
        for rig in rigs:
            one, other = (read_answer(folder / rig / "diagnosis.json") for folder in (results, changed / change))
            if not one.problem and not other.problem:
                same.append((one.verdict, one.named) == (other.verdict, other.named))
                steady[rig] &= same[-1]
                compared.add(rig)
        rows[change] = share(sum(same), len(same))
    return {"changes": rows, "all": share(sum(steady[rig] for rig in compared), len(compared))}


def stability_target(found: dict[str, Any]) -> list[dict[str, Any]]:
    """Hold it against what is asked, as a line of the scoreboard."""
    return target("the same names under every change of the files", found["all"], 0.95)
