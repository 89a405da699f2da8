"""Whether a missing force is said to depend on what it does depend on, and how far the errors of the shares hold.

    python benchmarks/dependence.py [RIGS] [--seed N] [--json OUT.json]

The rigs are those of `examples/concealed`: with a law of random shape, with such a law and one of the library beside
it, and with one law of the library. Only the place of what is missing is worked out, so that a rig costs seconds.
Printed are, of each, what its force depends on, the kind that is named first, its share with its error, and, where the
force is a function of displacement and velocity, the share that this kind has of the true force along the same motion.
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from blind_work import recording_of
from dashpot.diagnose.case import prepare
from dashpot.diagnose.family import first_fit
from dashpot.diagnose.place.equation_error import equation_error
from dashpot.diagnose.place.free_form import KINDS, Rows, explained, rows_of, solve
from dashpot.diagnose.place.shares_by_blocks import SAID, depends_on
from dashpot.diagnose.place.what_it_follows import symptoms
from dashpot.diagnose.search.weigh import judged
from dashpot.examples.concealed.record import record
from dashpot.examples.concealed.suite import LAW, Spec
from dashpot.examples.concealed.unwritten import shape
from dashpot.examples.concealed.virtual import Virtual, draw
from dashpot.identify import identify
from dashpot.identify.problem.prediction import FREE

#: Natural cycles of a sweep: a third of the blind test's, so that many rigs are tried in an hour.
CYCLES = (100.0, 150.0)
X, V, BOTH, BY_POSITION = "displacement", "velocity", "displacement and velocity", "damping by position"
#: Effects of a rig, and the kinds that are right for it.
RIGHT: dict[tuple[str, ...], tuple[str, ...]] = {
    ("unwritten-spring",): (X,),
    ("unwritten-resistance",): (V,),
    ("unwritten-damping-by-position",): (BY_POSITION, BOTH),
    ("unwritten-spring", "quadratic-drag"): (BOTH, X, V),
    ("unwritten-resistance", "quadratic-stiffness"): (BOTH, X, V),
    ("unwritten-damping-by-position", "quintic-stiffness"): (BOTH, X, BY_POSITION),
    ("one-sided-stop",): (X, BOTH),
    ("clearance",): (X,),
    ("quadratic-drag",): (V,),
    ("stribeck",): (V,),
    ("displacement-dependent-damping",): (BY_POSITION, BOTH),
    ("hysteresis",): ("memory",),
    ("viscoelastic",): ("memory",),
    ("actuator-saturation",): ("force",),
    ("stiffness-drift",): ("time",),
    ("tonal-disturbance",): ("tone",),
}
#: Laws of one number whose force is written here, by the name of that number.
_WRITTEN = {
    "drag": lambda x, v: v * np.abs(v),
    "quadratic": lambda x, v: x**2,
    "quintic": lambda x, v: x**5,
    "x2_damping": lambda x, v: x**2 * v,
}
_STATIC = {"quadratic-drag", "quadratic-stiffness", "quintic-stiffness", "displacement-dependent-damping"}


def concealed_force(virtual: Virtual, x: np.ndarray, v: np.ndarray) -> np.ndarray | None:
    """(n,) what Eq. 17 lacks at points of the motion, m/s²; None where it is no function that is written here."""
    if not all(name in _STATIC or name.startswith("unwritten") for name in virtual.spec.effects):
        return None
    p = virtual.rig(virtual.trial.plan.training[-1], virtual.level)
    over = int(p.get("unwritten_over", 0))
    force = np.zeros(x.shape)
    if over:
        force = shape(p, v) if over == 2 else shape(p, x) * (v if over == 3 else 1.0)
    return force + sum(p[name] * law(x, v) for name, law in _WRITTEN.items() if name in p)


def true_share(rows: Rows, force: np.ndarray, kind: str) -> float:
    """The share that a kind has of a force (n,) without noise, beyond what the family tells of it."""
    target = force * rows.weight
    left = target - rows.base @ solve(rows.base, target)
    exact = replace(rows, target=target, left=left, noise=0 * target, silent=0 * target)
    columns = (KINDS | SAID)[kind](rows) * rows.weight[:, None]
    return explained(exact, columns) / float(left @ left)


def tried(spec: Spec, seed: int) -> dict:
    """One rig: what it is said to depend on."""
    virtual = draw(spec, seed, cycles=CYCLES)
    tables, _ = record(virtual)
    plan = virtual.trial.plan
    training, held = ([recording_of(name, tables[name]) for name in group] for group in (plan.training, plan.held_out))
    found = identify(training, every=False)
    case = prepare(found.oscillator, training, held, lambda _what, _part: None)
    fitted, data, _ = first_fit(case.data, case.judged, case.family.model)
    data = replace(data, memory=FREE)
    stretches, _ = equation_error(judged(fitted.model, data).model, data)
    signature = symptoms(stretches)
    begun = time.process_time()
    depends = depends_on(signature)
    row = {"effects": spec.effects, "number": spec.number, "follows": signature.kind}
    row["seconds"] = time.process_time() - begun
    if depends is None:
        return row | {"first": None}
    row |= {"first": depends.first.kind, "share": depends.first.share, "std": depends.first.std}
    row |= {"right": depends.first.kind in RIGHT[spec.effects], "sentence": depends.sentence}
    rows = rows_of(stretches)
    force = concealed_force(virtual, rows.joined(lambda s: s.x), rows.joined(lambda s: s.v))
    if force is not None:
        known = [share for share in depends.shares if share.kind in KINDS | SAID]
        row["true"] = {s.kind: [s.share, s.std, true_share(rows, force, s.kind)] for s in known}
    return row


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rigs", type=int, nargs="?", default=32)
    parser.add_argument("--seed", type=int, default=46)
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    kinds, rows = list(RIGHT), []
    for i in range(given.rigs):
        effects = kinds[i % len(kinds)]
        spec = Spec(LAW, effects, ("",) * len(effects), "white", i // len(kinds))
        rows.append(row := tried(spec, given.seed))
        if row["first"] is None:
            print(f"{i + 1:3d} {' + '.join(effects)}: nothing is said", flush=True)
            continue
        true = row.get("true", {}).get(row["first"])
        beside = "" if true is None else f" (true {100 * true[2]:.1f})"
        print(
            f"{i + 1:3d} {'+' if row['right'] else '-'} {' + '.join(effects)}: {row['sentence']}{beside} "
            f"[{row['follows']}], {row['seconds']:.1f} s",
            flush=True,
        )
        if given.json:
            given.json.write_text(json.dumps(rows), encoding="utf-8")
    said = [row for row in rows if row["first"]]
    print(f"named rightly {sum(row['right'] for row in said)} of {len(rows)}")
    first = [row["true"][row["first"]] for row in said if row["first"] in row.get("true", {})]
    every = [share for row in said for share in row.get("true", {}).values()]
    for what, shares in (("of the first kind", first), ("of all kinds", every)):
        off = np.array([abs(share - true) / max(std, 1e-12) for share, std, true in shares])
        near = np.array([abs(share - true) for share, _, true in shares])
        within = f"within 2 errors {100 * np.mean(off <= 2.0):.0f} %, within 2 errors or 0.02 "
        within += f"{100 * np.mean((off <= 2.0) | (near <= 0.02)):.0f} %, off by {np.median(near):.3f} in the median"
        print(f"shares {what} ({len(shares)}): {within}")


if __name__ == "__main__":
    main()
