"""Each lane takes what it should: by measured cost, and of the library of laws each law and each function."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from dashpot.model.equations import SurfaceKind, equations
from dashpot.model.laws import LIBRARY

HERE = Path(__file__).parent


@pytest.fixture
def lanes():
    """The module that decides."""
    return sys.modules["lanes"]


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


class Item:
    """As much of a test as its lane needs."""

    def __init__(self, nodeid: str, *fixtures: str, law: str | None = None) -> None:
        self.nodeid, self.fixturenames = nodeid, fixtures
        self.callspec = SimpleNamespace(params={} if law is None else {"effect": law})


@pytest.mark.parametrize("functions", [1, 4, 12])
def test_of_the_library_each_lane_takes_each_law_and_each_function(lanes, kinds, functions):
    cases = {f"a.py::test_{i}[{law}]": (i, law) for i in range(functions) for law in LIBRARY}
    few = [Item("a.py::test_of_few[sensor-lag]", law="sensor-lag"), Item("a.py::test_of_none")]
    found = lanes.lanes_by_law([*(Item(name, law=law) for name, (_, law) in cases.items()), *few])
    assert set(found) == set(cases)  # a test of few laws has chosen them itself
    fast = [cases[name] for name, lane in found.items() if lane == "fast"]
    long = [cases[name] for name, lane in found.items() if lane != "nightly"]
    assert {law for _, law in fast} == set(kinds)
    assert {i for i, _ in fast} == set(range(functions))
    assert len(fast) == max(len(kinds), functions)
    assert {law for _, law in long} == set(LIBRARY)
    assert {case for case in cases.values() if case[1] in kinds} <= set(long)


def test_the_lanes_are_what_pytest_takes(kinds):
    run = subprocess.run(
        [sys.executable, "-P", "-m", "pytest", "--collect-only", "-v", str(HERE / "simulate" / "test_renderings.py")],
        cwd=HERE.parent,
        capture_output=True,
        text=True,
        check=True,
    )
    laws = re.findall(r"(test_the_\w+)\[([\w-]+?)(?:-driven|-released)?\]", run.stdout)
    of_all = {pair for pair in laws if not pair[0].startswith("test_the_python_fmu")}
    assert sorted(law for _, law in of_all) == sorted(kinds)
    assert len({function for function, _ in of_all}) == 4


def test_a_test_runs_in_the_first_lane_that_has_the_time_for_it(lanes):
    assert lanes.lane_by_cost(0.0, "tests/a.py::test_new") == "fast"
    assert lanes.lane_by_cost(lanes.FAST, "tests/a.py::test") == "fast"
    assert lanes.lane_by_cost(1.1 * lanes.FAST, "tests/a.py::test") == "long"
    assert lanes.lane_by_cost(1.1 * lanes.LONG, "tests/a.py::test") == "nightly"
    assert lanes.lane_by_cost(1.1 * lanes.LONG, f"tests/{lanes.ALWAYS[0]}") == "fast"


def test_what_runs_always_is_there(lanes):
    assert [name for name in lanes.ALWAYS if not lanes.exists(f"tests/{name}")] == []


def test_what_the_fast_lane_is_known_to_cost_leaves_time_for_the_rest(lanes):
    known = lanes.known()
    fast = [seconds for name, seconds in known.items() if lanes.lane_by_cost(seconds, name) == "fast"]
    assert sum(fast) < lanes.MOST


def test_what_tests_of_a_file_share_each_of_them_pays_a_part_of(lanes):
    items = [Item("a.py::one", "made"), Item("a.py::two", "made"), Item("a.py::three"), Item("b.py::one", "made")]
    seconds = {"a.py::one": 1.0, "a.py::fixture made": 3.0}
    assert lanes.costs(items, seconds) == {"a.py::one": 2.5, "a.py::two": 1.5, "a.py::three": 0.0, "b.py::one": 0.0}


def test_the_file_that_costs_most_comes_first_and_stays_together(lanes):
    items = [Item("a.py::one"), Item("b.py::one"), Item("c.py::one"), Item("b.py::two")]
    cost = {"a.py::one": 1.0, "b.py::one": 0.7, "b.py::two": 0.7, "c.py::one": 0.0}
    lanes.dearest_first(items, cost)
    assert [item.nodeid for item in items] == ["b.py::one", "b.py::two", "a.py::one", "c.py::one"]


def test_a_run_adds_what_it_measured_and_drops_what_is_gone_or_cheap(lanes):
    here = "tests/test_lanes.py::test_what_runs_always_is_there"
    before = {here: 2.0, f"{here}[a]": 2.0, "tests/test_lanes.py::test_gone": 2.0, "tests/gone.py::test": 2.0}
    measured = {here: 2.4, f"{here}[b]": 3.14159, f"{here}[c]": 0.01}
    after = {here: 2.0, f"{here}[a]": 2.0, f"{here}[b]": 3.1}
    assert lanes.updated(before, measured) == after
    assert lanes.updated(after, {here: 0.01, f"{here}[a]": 4.0}) == {f"{here}[a]": 4.0, f"{here}[b]": 3.1}


PROGRAM = """
import pytest

@pytest.fixture(scope="module")
def made():
    return sum(i for i in range(3_000_000))

def test_works(made):
    assert sum(i for i in range(6_000_000)) > made

def test_is_not_for_this_machine():
    pytest.skip("another")
"""


def test_what_a_test_costs_is_measured_and_what_it_shares_apart(lanes, tmp_path):
    file = tmp_path / "test_work.py"
    file.write_text(PROGRAM)
    run = lanes.Measured(write=False)
    assert pytest.main(["-q", "-c", "/dev/null", "-p", "no:cacheprovider", str(file)], plugins=[run]) == 0
    assert [name.rpartition("::")[2] for name in sorted(run.seconds)] == ["fixture made", "test_works"]
    assert min(run.seconds.values()) > 0.0


def test_the_file_reads_back_as_it_was_written(lanes, tmp_path):
    seconds = {"tests/a.py::TestThis::test[x::y]": 0.5, "tests/a.py::fixture made": 2.0, "tests/b.py::test": 1.0}
    path = tmp_path / "durations.json"
    path.write_text(lanes.as_text(seconds), encoding="utf-8")
    assert lanes.known(path) == seconds
    assert list(json.loads(path.read_text())) == ["tests/a.py", "tests/b.py"]
    assert lanes.known(tmp_path / "none.json") == {}


def test_a_new_test_that_takes_long_is_named_at_the_end(lanes):
    run = lanes.Measured(write=False)
    run.before, run.seconds = {"old": 5.0}, {"old": 5.0, "new": 5.0, "cheap": 0.5 * lanes.FAST}
    assert run.unknown() == {"new": 5.0}


@pytest.mark.parametrize(("seconds", "begun"), [(0.0, 0), (60.0, 2)])
def test_when_the_time_is_over_no_test_begins(lanes, tmp_path, seconds, begun):
    file = tmp_path / f"test_begun_{begun}.py"
    file.write_text("def test_one(): pass\n\ndef test_other(): pass\n")
    within, run = lanes.Within(seconds), lanes.Measured(write=False)
    given = ["-q", "-c", "/dev/null", "-p", "no:cacheprovider", str(file)]
    assert pytest.main(given, plugins=[within, run]) == 0
    assert len(run.seconds) == begun
