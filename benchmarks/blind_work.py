"""How often identify and diagnose simulate the recordings of blind rigs, and the processor that takes.

    python benchmarks/blind_work.py [RIGS] [--seed N] [--experiment NAME]

The rigs are those of the blind test (`examples/concealed`), one after another, with its training and held-out
recordings. Printed are, of each rig, how many times the recordings were simulated and the seconds of processor, for
either command, and the verdict beside what was concealed; at the end the median, the quantile of 95 % and the worst.
Counts do not depend on the load of the machine.
"""

from __future__ import annotations

import argparse

import numpy as np
from dashpot.diagnose import diagnose
from dashpot.examples.concealed.record import record
from dashpot.examples.concealed.recordings import EXPERIMENTS
from dashpot.examples.concealed.suite import Spec, specs
from dashpot.examples.concealed.virtual import Trial, draw
from dashpot.identify import identify
from dashpot.recording import Recording

#: At most: times of identify where the model fits and where physics is missing; of diagnose in the median, the worst.
AIMS = "identify 150 and 250 times, diagnose 300 times in the median, 600 at worst, 15 s in the median, 60 s in 95 %"


def recording_of(name: str, table: np.ndarray) -> Recording:
    """A recording of a virtual rig, (n, 3): time, force, displacement; without a force (n, 2)."""
    force = table[:, 1] if table.shape[1] > 2 and np.any(table[:, 1]) else None
    return Recording(name, float(1 / (table[1, 0] - table[0, 0])), table[:, -1], force)


def measured(spec: Spec, seed: int, trial: Trial) -> tuple[list[float], str]:
    """Times the recordings and seconds of both commands, and what was found of what was concealed."""
    tables, _ = record(draw(spec, seed, trial=trial))
    training, held = (
        [recording_of(name, tables[name]) for name in group] for group in (trial.plan.training, trial.plan.held_out)
    )
    found = identify(training, every=False)
    told = diagnose(found.oscillator, training, held)
    assert found.work is not None
    assert told.work is not None
    numbers = [found.work.times, found.work.seconds, told.work.times, told.work.seconds]
    return numbers, f"{told.verdict}: {', '.join(e.law for e in told.effects)} [{', '.join(spec.effects)}]"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rigs", type=int, nargs="?", default=30)
    parser.add_argument("--seed", type=int, default=404)
    parser.add_argument("--experiment", choices=list(EXPERIMENTS), default="shaker")
    given = parser.parse_args()
    print(f"at most: {AIMS}\n     rig identify:       s diagnose:       s")
    rows = []
    for number, spec in enumerate(specs(given.seed, short=given.rigs), start=1):
        numbers, said = measured(spec, given.seed, Trial(given.experiment))
        rows.append(numbers)
        shown = " ".join(f"{value:9.1f}" for value in numbers)
        print(f"{number:8}{shown}  {said}", flush=True)
    for what, part in (("median", 0.5), ("95 %", 0.95), ("worst", 1.0)):
        print(f"{what:>8}" + " ".join(f"{v:9.1f}" for v in np.quantile(np.array(rows), part, axis=0)))


if __name__ == "__main__":
    main()
