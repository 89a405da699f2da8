"""Which test tells which law, from the expected information: the tables of docs/which-test.md.

    python -P benchmarks/which_test.py [--write] [--laws NAME ...]

The rig is that of the law pages (`report/law_figure.py`), with each law at the size at which its page shows it. A
test is simulated, and so are its derivatives by all parameters of Eq. 17 and of the law, and by the initial state of
a decay. With a sensor of 1 µm that gives the expected information, and from it the covariance (Cramér and Rao). An
entry is the number of standard errors by which the law's strengths differ from none while everything else is free; of
a law without a strength (a lag, a limit), the size of what it changes in the response over that of the noise, less
what Eq. 17 can imitate. Below 4 nobody can name it, from some tens on anybody.

The second table has the factors by which these figures change, the median over all laws, where one thing of the test
does.

`--write` puts both behind the markers of the page.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from dashpot.examples.force import chirp, multisine
from dashpot.model import Oscillator
from dashpot.model.law import Law
from dashpot.model.laws import LIBRARY
from dashpot.model.oscillator import Response
from dashpot.report.law_figure import FORCE, LENGTH, OMEGA, RIG, SCALES, example
from dashpot.simulate.core import Core, core_of, internal_step
from dashpot.simulate.force import force_between

PAGE = Path(__file__).resolve().parents[1] / "docs/which-test.md"
#: m, of the displacement sensor; one for accelerations has it times OMEGA².
NOISE = 1e-6
#: Relative change of a parameter for its derivative.
STEP = 1e-4
#: N, of a sweep that reaches 8 mm, and of a multisine.
STRONG = 2.0 * FORCE
CYCLE = 2 * np.pi / OMEGA


@dataclass(frozen=True)
class Test:
    """How the rig is tried: from what part of 8 mm it is let go, and by what part of ``STRONG`` it is driven."""

    kind: str
    levels: tuple[float, ...] = (1.0,)
    cycles: float = 160.0
    rate: float = 40.0
    quantity: str = "displacement"

    __test__ = False  # no test of pytest


TESTS = {
    "decay from 8 mm": Test("decay"),
    "decay from 2 mm": Test("decay", (0.25,)),
    "sweep, high": Test("sweep"),
    "sweep, low": Test("sweep", (0.25,)),
    "sweeps, both": Test("sweep", (1.0, 0.25), 80.0),
    "multisine": Test("multisine"),
    "decay and sweep": Test("both", cycles=80.0),
}
#: What may change of a test, and how.
CHANGES: dict[str, Callable[[Test], Test]] = {
    "four times the level": lambda t: replace(t, levels=tuple(4 * level for level in t.levels)),
    "twice as long": lambda t: replace(t, cycles=2 * t.cycles),
    "twice the sampling rate": lambda t: replace(t, rate=2 * t.rate),
    "an accelerometer": lambda t: replace(t, quantity="acceleration"),
}


def forces(test: Test) -> list[tuple[np.ndarray | None, float]]:
    """Force (n,) N, or None, and place of release m, of each recording."""
    n, dt = round(test.cycles * test.rate), CYCLE / test.rate
    t, natural = np.arange(n) * dt, 1 / CYCLE
    made: list[tuple[np.ndarray | None, float]] = []
    for level in test.levels:
        if test.kind in ("decay", "both"):
            made.append((None, level * LENGTH))
        if test.kind in ("sweep", "both"):
            made.append((chirp(level * STRONG, 0.6 * natural, 0.8 * natural / t[-1], t, dt)[:, 0], 0.0))
        if test.kind == "multisine":
            lines = np.arange(0.6, 1.4, 1 / test.cycles) * natural
            phases = np.random.default_rng(1).uniform(0, 2 * np.pi, lines.size)
            made.append((multisine(level * STRONG / np.sqrt(lines.size), lines, phases, t, dt)[:, 0], 0.0))
    return made


def significance(law: Law, test: Test) -> float:
    """By how many standard errors the law's strengths differ from none."""
    model = example(law).having
    response = Response(test.quantity, {"displacement": "m", "acceleration": "m/s2"}[test.quantity])
    model = Oscillator.from_values(model.values(), laws=(law,), response=response)
    given = forces(test)
    kept = {f"{law.name}.{p.name}" for p in law.parameters if p.scale}
    kept |= set() if any(f is not None for f, _ in given) else {"mass"}
    free = [name for name in model.values() if name not in kept]
    scale = {name: abs(model.values()[name]) or _natural(law, name) for name in free}
    sizes = NOISE * (OMEGA**2 if test.quantity == "acceleration" else 1.0)
    core, base = core_of(model), model.values()
    n, dt = round(test.cycles * test.rate), CYCLE / test.rate

    def run(values: dict[str, float], force: np.ndarray | None, begin: np.ndarray) -> np.ndarray:
        return _run(core, model, values, force, begin, n, dt)

    states = sum(2 for force, _ in given if force is None)
    blocks, place = [], 0
    for force, x0 in given:
        begin = np.array([x0, 0.0])
        columns = np.zeros((n, len(free) + states))
        for j, name in enumerate(free):
            up, down = ({**base, name: base[name] + sign * STEP * scale[name]} for sign in (1, -1))
            columns[:, j] = (run(up, force, begin) - run(down, force, begin)) / (2 * STEP)
        if force is None:
            for j, size in enumerate((abs(x0), abs(x0) * OMEGA)):
                shift = np.eye(2)[j] * STEP * size
                slope = (run(base, force, begin + shift) - run(base, force, begin - shift)) / (2 * STEP)
                columns[:, len(free) + place + j] = slope
            place += 2
        blocks.append(columns / sizes)
    jacobian = np.vstack(blocks)
    if not np.isfinite(jacobian).all():
        return float("nan")
    strengths = [f"{law.name}.{p.name}" for p in law.parameters if p.strength]
    mine = [free.index(name) for name in strengths or [f"{law.name}.{p.name}" for p in law.parameters]]
    rest = jacobian[:, [j for j in range(jacobian.shape[1]) if j not in mine]]
    rest = rest / np.maximum(np.linalg.norm(rest, axis=0), 1e-300)
    left, singular, _ = np.linalg.svd(rest, full_matrices=False)
    left = left[:, singular > 1e-9 * singular[0]]
    if strengths:
        changed = jacobian[:, mine] @ np.array([base[name] / scale[name] for name in strengths])
    else:
        plain = Oscillator.from_values(example(law).without.values(), response=response)
        changed = np.concatenate(
            [
                (
                    run(base, force, np.array([x0, 0.0]))
                    - _run(core_of(plain), plain, plain.values(), force, np.array([x0, 0.0]), n, dt)
                )
                / sizes
                for force, x0 in given
            ]
        )
    return float(np.linalg.norm(changed - left @ (left.T @ changed)))


def _run(
    core: Core,
    model: Oscillator,
    values: Mapping[str, float],
    force: np.ndarray | None,
    begin: np.ndarray,
    n: int,
    dt: float,
) -> np.ndarray:
    """(n,) of what is recorded, noiseless."""
    numbers = np.array([values[name] for name in core.parameter_names])
    smooth = None if force is None else force_between(np.append(force, force[-1]), dt, "smooth", 0.5 / dt)
    return core.record(numbers, begin, smooth, n, dt, internal_step(model, dict(values), LENGTH))


def _natural(law: Law, name: str) -> float:
    by_name = {f"{law.name}.{p.name}": p for p in law.parameters}
    if name in by_name:
        return float(by_name[name].natural(SCALES))
    return {"preload": 0.05, "dry": 0.05, "cubic": 1e6, "viscous": 1.0}.get(name, max(abs(RIG.get(name, 0.0)), 1.0))


def table(laws: Sequence[Law]) -> tuple[str, str]:
    """Both tables, in Markdown."""
    found = {law.name: {name: significance(law, test) for name, test in TESTS.items()} for law in laws}
    head = ["| law | " + " | ".join(TESTS) + " |", "|---" * (1 + len(TESTS)) + "|"]
    rows = [
        f"| `{law.name}` | "
        + " | ".join(_cell(found[law.name][name], max(found[law.name].values())) for name in TESTS)
        + " |"
        for law in laws
    ]
    kinds = {"decay": TESTS["decay from 2 mm"], "sweep": TESTS["sweep, low"]}
    lines = ["| what changes | " + " | ".join(f"{kind} at a low level" for kind in kinds) + " |", "|---" * 3 + "|"]
    for change, made in CHANGES.items():
        cells = []
        for test in kinds.values():
            asked = [law for law in laws if made(test).quantity == test.quantity or law.path != "measurement"]
            pairs = [(significance(law, test), significance(law, made(test))) for law in asked]
            factors = [after / before for before, after in pairs if before > 1.0 and np.isfinite(after)]
            low, middle, high = np.quantile(factors, [0.1, 0.5, 0.9])
            cells.append(f"{middle:.2g} ({low:.2g} to {high:.2g})")
        lines.append(f"| {change} | " + " | ".join(cells) + " |")
    return "\n".join([*head, *rows]), "\n".join(lines)


def _cell(value: float, best: float) -> str:
    if not np.isfinite(value):
        return "–"
    text = "0" if value < 0.5 else f"{float(f'{value:.2g}'):,.0f}".replace(",", "\u202f")
    return f"**{text}**" if value > 0.7 * best and value > 4 else text


def main() -> None:
    """Print the tables, and put them into the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--laws", nargs="+", metavar="NAME")
    given = parser.parse_args()
    names = given.laws or [name for name in LIBRARY if not name.startswith("free/")]
    tables = table([LIBRARY[name] for name in names])
    print("\n\n".join(tables))
    if given.write:
        text = PAGE.read_text("utf-8")
        for number, made in enumerate(tables, start=1):
            mark = f"<!-- table {number} of benchmarks/which_test.py -->"
            text = re.sub(re.escape(mark) + r"\n\n(\|.*\n)*", lambda _, m=mark, t=made: f"{m}\n\n{t}\n", text)
        PAGE.write_text(text, "utf-8")


if __name__ == "__main__":
    main()
