"""No structure that a diagnosis ends with leaves more, in one run of whole recordings, than one whose laws it holds."""

from __future__ import annotations

import math
import os
from dataclasses import replace
from pathlib import Path

import pytest
from dashpot.diagnose.diagnosis import _searched
from dashpot.diagnose.family import cut_for
from dashpot.diagnose.limits import MATTERS
from dashpot.diagnose.recordings import split
from dashpot.diagnose.simplify import left_of, simplify
from dashpot.diagnose.time_allowed import TimeAllowed
from dashpot.examples.concealed.dirty import draw_dirty
from dashpot.examples.concealed.record import record
from dashpot.identify import identify
from dashpot.identify.problem.prediction import FREE
from dashpot.recording import Recording, read

pytestmark = pytest.mark.long

SHORT = (30.0, 40.0)  # natural cycles
FOLDER = Path(os.environ.get("DASHPOT_DATA") or Path(__file__).resolve().parents[3] / "shared" / "data")


def _most(training, held):
    """By how much more of the power, in logarithms, the best leaves than what it holds; None where nothing is held."""
    family = identify(training, every=False, doubted=False)
    allowed = TimeAllowed(math.inf)
    case, found, _ = _searched(family.oscillator, (list(training), list(held)), lambda *_: None, allowed)
    found = simplify(case, found, lambda *_: None, allowed)
    whole = replace(cut_for(case.family, case.uncut, case.model), memory=FREE)
    best = left_of(found.selected, whole)
    held = [
        other
        for laws, other in found.candidates.items()
        if set(laws) < set(found.selected.laws) and other.fit is not None and other.stage == "judged"
    ]
    return max((best - left_of(other, whole) for other in held), default=None)


@pytest.mark.parametrize("number", range(6))
def test_of_a_dirty_rig(number):
    rig = draw_dirty(17, number, SHORT)
    tables, _ = record(rig)

    def recordings(names):
        made = []
        for name in names:
            table = tables[name]
            force = table[:, 1] if table.shape[1] > 2 and table[:, 1].any() else None
            quantity = "acceleration" if rig.trial.quantity == "acceleration" else "displacement"
            rate = float(1.0 / (table[1, 0] - table[0, 0]))
            made.append(
                Recording(name, rate, table[:, -1], force, quantity, {"acceleration": "m/s2"}.get(quantity, "m"))
            )
        return made

    more = _most(recordings(rig.trial.plan.training), recordings(rig.trial.plan.held_out))
    assert more is None or more < math.log1p(MATTERS)


@pytest.mark.parametrize("name", ["pendulum_1", "sloshing_0", "bicycle_wheel_axial_decay", "leg_pendulum"])
def test_of_a_recording_at_hand(name):
    path = FOLDER / f"{name}.csv.gz"
    if not path.exists():
        pytest.skip(f"{path} is not there")
    recordings = [read(path)]
    model = identify(recordings, every=False, doubted=False).oscillator
    more = _most(*split(recordings, model))
    assert more is None or more < math.log1p(MATTERS)
