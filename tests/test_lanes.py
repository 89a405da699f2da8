"""What `make test` leaves out is what `make test-all` runs: the library is stood for by a law of each kind."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from dashpot.model.equations import SurfaceKind, equations
from dashpot.model.laws import LIBRARY

HERE = Path(__file__).parent


def kinds_of(with_law, effect: str) -> set[object]:
    """What makes a law one of its kind: its path, what it acts on, its surfaces and states, and time."""
    import casadi as ca

    law, eq, plain = LIBRARY[effect], equations(with_law(effect)), equations(with_law())
    added = list(eq.kinds)
    for kind in plain.kinds:
        added.remove(kind)
    time = ["time"] if ca.depends_on(ca.vertcat(eq.zdot, eq.y), eq.t) else []
    force = ["force on a surface"] if ca.depends_on(eq.surfaces, eq.u) else []
    states = [f"{'own' if state.free else 'led'} by {state.follows}" for state in eq.inner]
    acts = "force" if law.force else "drive" if law.drive else "record"
    return {law.path, acts, *(kind for kind in added if kind is not SurfaceKind.VELOCITY), *time, *force, *states}


def test_a_law_of_each_kind_is_among_those_that_stand_for_the_library(with_law, kinds):
    whole = set().union(*(kinds_of(with_law, effect) for effect in LIBRARY))
    chosen = set().union(*(kinds_of(with_law, effect) for effect in kinds))
    assert whole - chosen == set()
    assert len(whole) > 12
    # none of them could be spared
    for effect in kinds:
        others = set().union(*(kinds_of(with_law, other) for other in kinds if other != effect))
        assert whole - others, f"{effect} is not needed: others are of its kinds"


@pytest.mark.parametrize(("lane", "whole"), [((), False), (("-m", ""), True)], ids=["test", "test-all"])
def test_each_lane_takes_the_laws_that_it_should(kinds, lane, whole):
    file = HERE / "simulate" / "test_renderings.py"
    run = subprocess.run(
        [sys.executable, "-P", "-m", "pytest", "--collect-only", "-v", *lane, str(file)],
        cwd=HERE.parent,
        capture_output=True,
        text=True,
        check=True,
    )
    laws = set(re.findall(r"test_the_native_fmu\w*\[(.+)\]", run.stdout))
    assert laws == (set(LIBRARY) if whole else set(kinds))
