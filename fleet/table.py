"""A fleet's results as tables: one row an entry, as CSV or Parquet, and as the JSON that ``watch`` reads."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import BadInput, printable
from .manifest import Entry
from .outcome import STATES, Outcome
from .store import FORMAT

_FIRST = ("name", "rig", "state", "when", "result", "sentence")
_LAST = ("nrmse", "over_noise", "verdict", "effects", "seconds", "attempts", "model", "recordings")


@dataclass(frozen=True)
class Row:
    """An entry, what became of it, and its folder below that of the results; None where it has none."""

    entry: Entry
    outcome: Outcome
    folder: Path | None

    @property
    def model(self) -> str | None:
        """The model's file below the folder of the results."""
        return (
            None
            if self.folder is None or self.outcome.model is None
            else f"{self.folder.as_posix()}/{self.outcome.model}"
        )

    def worst(self, name: str) -> float | None:
        """The largest ``nrmse`` or ``over_noise`` that the identified model leaves of a recording."""
        return max((r[name] for r in self.outcome.recordings if r.get(name) is not None), default=None)


def counts(rows: Sequence[Row]) -> dict[str, int]:
    """How many rows stand in each state, those that there are."""
    found = Counter(row.outcome.state for row in rows)
    return {state: found[state] for state in STATES if found[state]}


def columns(rows: Sequence[Row]) -> dict[str, list[Any]]:
    """The table by columns; value, std and unit of each parameter that any model has."""
    names = list(dict.fromkeys(name for row in rows for name in row.outcome.parameters))
    table: dict[str, list[Any]] = {name: [] for name in _FIRST}
    for name in names:
        table |= {name: [], f"{name}.std": [], f"{name}.unit": []}
    table |= {name: [] for name in _LAST}
    for row in rows:
        entry, outcome = row.entry, row.outcome
        cells: dict[str, Any] = {
            **{"name": entry.name, "rig": entry.rig, "state": entry.state},
            **{
                "when": entry.when,
                "result": outcome.state,
                "sentence": printable(outcome.sentence).replace("\n", "; "),
            },
            **{"nrmse": row.worst("nrmse"), "over_noise": row.worst("over_noise")},
            **{"verdict": outcome.verdict, "effects": "; ".join(outcome.effects)},
            **{"seconds": round(sum(outcome.seconds.values()), 3), "attempts": outcome.attempts, "model": row.model},
            "recordings": "; ".join(Path(name).name for name in entry.recordings),
        }
        for name, parameter in outcome.parameters.items():
            cells |= {name: parameter["value"], f"{name}.std": parameter["std"], f"{name}.unit": parameter["unit"]}
        for name, column in table.items():
            column.append(cells.get(name))
    return table


def csv_text(rows: Sequence[Row]) -> str:
    """The table as CSV; what is not known is empty."""
    table = columns(rows)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(table)
    writer.writerows(["" if cell is None else cell for cell in line] for line in zip(*table.values(), strict=True))
    return text.getvalue()


def parquet(rows: Sequence[Row]) -> bytes:
    """The table as Parquet; raises BadInput where pyarrow is not installed."""
    need_parquet()
    import pyarrow  # pyright: ignore[reportMissingImports]
    import pyarrow.parquet  # pyright: ignore[reportMissingImports]

    table = columns(rows)
    if any(isinstance(when, str) for when in table["when"]):
        table["when"] = [None if when is None else str(when) for when in table["when"]]
    # a column that holds nothing yet has the type that it will have, so that tables of several runs fit together
    numbers, counted = {"nrmse", "over_noise", "seconds"}, {"attempts"}
    names = {name.removesuffix(".unit") for name in table if name.endswith(".unit")}
    numbers |= names | {f"{name}.std" for name in names}
    if not any(isinstance(when, str) for when in table["when"]):
        numbers.add("when")
    types = {
        name: pyarrow.float64() if name in numbers else pyarrow.int64() if name in counted else pyarrow.string()
        for name in table
    }
    out = io.BytesIO()
    pyarrow.parquet.write_table(pyarrow.table(table, schema=pyarrow.schema(types.items())), out)
    return out.getvalue()


def need_parquet() -> None:
    """Raises BadInput where what writes Parquet is not installed."""
    from importlib.util import find_spec

    if find_spec("pyarrow") is None:
        raise BadInput(
            "--parquet needs pyarrow, which is not installed; pip install 'dashpot[parquet]', or use the CSV"
        )


def as_json(rows: Sequence[Row]) -> dict[str, Any]:
    """``fleet.json``: the entries in the manifest's order, each with its place in life and its model's file."""
    return {
        "format": FORMAT,
        "counts": counts(rows),
        "entries": [
            {
                **{"name": row.entry.name, "rig": row.entry.rig, "state": row.entry.state, "when": row.entry.when},
                **{"result": row.outcome.state, "sentence": row.outcome.sentence, "model": row.model},
                **{"key": row.outcome.key, "seconds": dict(row.outcome.seconds)},
            }
            for row in rows
        ],
    }
