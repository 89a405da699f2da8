"""What becomes of forces that nobody wrote a law for: told by a free form, or taken for something with a name.

    python benchmarks/unwritten_laws.py [RIGS] [--seed N] [--json OUT.json]

The rigs are those of `examples/concealed` with a law of random shape over the displacement, over the velocity, or a
damping over the displacement. Printed are, of each, the verdict and what is named, the worst held-out error over its
noise floor before and after, and how far the mended model's whole force is off the true one over the visited range,
rms, as a part of what is not linear in it.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from blind_work import recording_of
from dashpot.diagnose import diagnose
from dashpot.diagnose.result import Diagnosis
from dashpot.examples.concealed.effects import UNWRITTEN
from dashpot.examples.concealed.record import record
from dashpot.examples.concealed.suite import Spec, specs
from dashpot.examples.concealed.unwritten import shape
from dashpot.examples.concealed.virtual import Virtual, draw
from dashpot.identify import identify
from dashpot.identify.problem.equivalent import along_of
from dashpot.model import Oscillator

#: Natural cycles of a sweep: a third of the blind test's, so that many rigs are tried in an hour.
CYCLES = (100.0, 150.0)


def model_force(model: Oscillator, x: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(n,) force per unit mass of a model at points of the motion, m/s², of all terms without memory and mass."""
    p = model.values()
    force = (
        p["omega0"] ** 2 * x + p["cubic"] * x**3 + p["preload"] * np.sign(x) + p["viscous"] * v + p["dry"] * np.sign(v)
    )
    motion = np.column_stack([x, v, 0 * x, 0 * x])
    for term in model.terms:
        if term.law.force is not None and term.law.path != "inertia":  # which no points without an order tell
            values = {name: parameter.value for name, parameter in term.parameters.items()}
            force = force + along_of(term.law).force(values, motion, 1.0)
    return force


def _eq17(p: Mapping[str, float], x: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(n,) force per unit mass of Eq. 17."""
    spring = p["omega2"] * x + p["cubic"] * x**3 + p["preload"] * np.sign(x)
    return spring + p["viscous"] * v + p["dry"] * np.sign(v)


def true_force(virtual: Virtual, x: np.ndarray, v: np.ndarray) -> np.ndarray:
    """The same of the virtual rig."""
    p = virtual.rig(virtual.trial.plan.training[-1], virtual.level)
    force = _eq17(p, x, v)
    over = int(p["unwritten_over"])
    return force + (shape(p, v) if over == 2 else shape(p, x) * (v if over == 3 else 1.0))


def off_the_truth(virtual: Virtual, model: Oscillator) -> float:
    """How far the force is off, rms along a cycle of several amplitudes, over what is not linear of the law."""
    turn = np.linspace(0.0, 2 * np.pi, 200, endpoint=False) + 0.01
    reach = max(np.ptp(r.x) / 2 for n, r in virtual.responses.items() if n in virtual.trial.plan.training)
    amplitude = reach * np.array([[0.25], [0.5], [0.75], [1.0]])
    x = (amplitude * np.cos(turn)).ravel()
    v = (-virtual.base.omega * amplitude * np.sin(turn)).ravel()
    p = virtual.rig(virtual.trial.plan.training[-1], virtual.level)
    law = true_force(virtual, x, v) - _eq17(p, x, v)
    base = np.column_stack([x, x**3, np.sign(x), v, np.sign(v)])
    beyond = law - base @ np.linalg.lstsq(base, law, rcond=None)[0]
    off = model_force(model, x, v) - true_force(virtual, x, v)
    return float(np.sqrt(np.mean(off**2) / np.mean(beyond**2)))


def ratios(told: Diagnosis, truth: dict) -> tuple[float, float]:
    """The worst held-out error over its floor, before and after."""
    rows = [(r, truth["recordings"][r.file]["noise_floor"]) for r in told.records if r.holdout]
    return max(r.nrmse_before / f for r, f in rows), max(r.nrmse_after / f for r, f in rows)


def tried(spec: Spec, seed: int) -> dict:
    """One rig, diagnosed."""
    virtual = draw(spec, seed, cycles=CYCLES)
    tables, truth = record(virtual)
    plan = virtual.trial.plan
    training, held = ([recording_of(name, tables[name]) for name in group] for group in (plan.training, plan.held_out))
    begun = time.process_time()
    found = identify(training, every=False)
    told = diagnose(found.oscillator, training, held)
    before, after = ratios(told, truth)
    return {
        "law": spec.effects[0],
        "number": spec.number,
        "verdict": told.verdict,
        "named": [effect.law for effect in told.effects],
        "forms": [form.text for form in told.forms],
        "before": before,
        "after": after,
        "off": off_the_truth(virtual, told.model),
        "seconds": time.process_time() - begun,
        "parameters": {name: value for name, value in truth["parameters"].items() if value},
    }


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rigs", type=int, nargs="?", default=12)
    parser.add_argument("--seed", type=int, default=46)
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    rows = []
    chosen = specs(given.seed, list(UNWRITTEN), -(-given.rigs // len(UNWRITTEN)))[: given.rigs]
    for number, spec in enumerate(chosen, start=1):
        rows.append(row := tried(spec, given.seed))
        print(
            f"{number:3d} {row['law'][10:]:19s} {row['before']:7.2f} -> {row['after']:6.2f} floors, off "
            f"{row['off']:6.3f}, {row['seconds']:5.0f} s  {row['verdict']}: {', '.join(row['named'])}"
            f"{''.join(f'; {form}' for form in row['forms'][:1])}",
            flush=True,
        )
        if given.json:
            given.json.write_text(json.dumps(rows), encoding="utf-8")
    close = np.mean([row["after"] <= 1.15 for row in rows])
    halved = np.mean([row["after"] - 1.0 <= 0.5 * (row["before"] - 1.0) or row["after"] <= 1.03 for row in rows])
    print(f"within 1.15 floors {100 * close:.0f} %, at least halved towards the floor {100 * halved:.0f} %")


if __name__ == "__main__":
    main()
