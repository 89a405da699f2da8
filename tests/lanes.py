"""Lanes by measured cost: which tests `make test`, `make test-all` and `make nightly` run.

``tests/durations.json`` holds what each test costs in seconds of processor time, of its process and of the processes it
waited for: on a busy machine that stays nearly the same, where the time on the clock does not. ``--write-durations``
measures it. A test that the file does not name costs next to nothing or is new: it runs in every lane, and the
end of a run names those of them that cost more than a test of the fast lane may.

- fast (`make test`): what costs at most ``FAST``, and what ``ALWAYS`` names;
- long (`make test-all`; CI runs as many as its time allows): those, and what costs at most ``LONG``;
- nightly (`make nightly`): the rest.

Where functions of a file each go through the library of laws, the fast lane takes a law of each kind once and each
function once, the long one a law of each kind in each function and every law once, the nightly one every law in each
function. A mark ``long`` by hand holds where the file of durations names nothing. A test named on the command line
(``file.py::test``) runs whatever its lane.
"""

from __future__ import annotations

import json
import os
import re
import time
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from dashpot.model.laws import LIBRARY

ROOT = Path(__file__).parents[1]
DURATIONS = Path(__file__).with_name("durations.json")
#: The most that a test of a lane costs, s of processor time. `make test` is to end within five minutes on two cores.
FAST, LONG = 0.75, 20.0
#: The most that the tests of the fast lane in the file cost together, s. Two cores have 600 in five minutes; the
#: collection, the tests that cost less and the compiler of a first run take the rest.
MOST = 350.0
#: What costs less than this is not worth a line in the file, s.
CHEAP = 0.2
#: A new measurement replaces an old one from which it differs by more than this part: a machine's load shows less.
CHANGED = 0.3
#: Of each workflow as a whole one test, and of each kind of finding, that runs in every lane whatever it costs.
ALWAYS = (
    "commands/test_cli.py::test_from_recordings_to_a_proven_fmu",
    "commands/test_fleet_commands.py::test_a_fleet_is_identified_then_watched_and_compared",
    "diagnose/place/test_missing_force.py::test_nothing_is_named_where_the_sensor_is_to_blame_or_nobody",
    "diagnose/place/test_missing_force.py::test_the_smoother_finds_the_drag_that_the_law_names",
    "diagnose/test_diagnosis.py::test_a_concealed_effect_is_named_and_mended[quadratic-drag]",
    "diagnose/test_diagnosis.py::test_noise_is_not_physics[white]",
    "diagnose/test_family.py::test_a_useless_model_file_is_left_aside_and_said_to_be",
    "diagnose/test_hold.py::test_nothing_is_named_for_a_hold[zero]",
    "export/glue/test_glue.py::test_no_call_does_damage[3-ModelExchange-1]",
    "export/test_plain_c.py::test_every_law_repeats_the_core[kinds]",
    "fleet/test_runs.py::test_killed_in_the_middle_and_run_again_nothing_is_done_twice_and_nothing_lost",
    "identify/faults/test_faults_found.py::test_where_physics_is_missing_besides_nothing_is_said",
    "identify/faults/test_inconsistent_recording.py::test_what_no_kind_explains_is_told_with_its_place",
    "identify/faults/test_inconsistent_recording.py::test_without_being_asked_a_lie_is_named_and_covered[clipped]",
    "identify/fit/test_hold.py::test_a_hold_is_found_told_and_kept[zero-25-random]",
    "identify/hilbert/test_mass_by_laws.py::test_below_the_resonance_the_laws_tell_the_mass",
    "identify/problem/test_long_records.py::test_a_long_record_gives_what_it_gives_as_a_short_one[displacement-sweep0-begin0]",
    "identify/test_accelerometer.py::test_a_decay_and_a_sweep[acceleration-500.0]",
    "model/test_any_law.py::test_any_law_is_taken_or_refused[a taste]",
    "report/test_diagnosis_page.py::test_every_verdict_has_its_page_in_order[missing-physics]",
    "report/test_page.py::test_the_page_is_well_formed_and_stands_alone[stand-True]",
    "simulate/test_derivatives.py::test_of_any_structure[a taste]",
    "test_readme.py::test_the_block_runs[README.md]",
    "verify/test_hostile_fmus.py::test_a_command_that_waits_for_an_fmu_hears_a_signal",
    "verify/test_score.py::test_the_true_model_passes_but_for_one_in_many",
    "verify/test_verification.py::test_a_right_model_passes_and_the_noise_floor_is_the_noise",
    "verify/test_verification.py::test_a_wrong_model_fails[changed0]",
)

#: A law of each path, of each kind of surface, with and without states, time and a phase: they stand for the library
#: where a test goes through it (tests/test_lanes.py holds them complete).
KINDS = (
    "one-sided-stop",
    "quadratic-drag",
    "hysteresis",
    "attached-resonator",
    "actuator-saturation",
    "sensor-lag",
    "time-delay",
    "stiffness-drift",
    "tonal-disturbance",
)
#: A test of so many laws goes through the library; one of fewer has chosen them itself.
MANY = 12

FIXTURE = "fixture "
LANES = ("fast", "long", "nightly")


# --- what a test costs ---


def known(path: Path = DURATIONS) -> dict[str, float]:
    """Seconds by node id, and by ``<file>::fixture <name>`` for what a file shares."""
    if not path.exists():
        return {}
    files: Mapping[str, Mapping[str, float]] = json.loads(path.read_text(encoding="utf-8"))
    return {f"{file}::{name}": seconds for file, tests in files.items() for name, seconds in tests.items()}


def costs(items: Iterable[pytest.Item], seconds: Mapping[str, float]) -> dict[str, float]:
    """What each item costs: its own time, and its part of what it shares with others of its file."""
    items = list(items)
    users: defaultdict[str, list[str]] = defaultdict(list)
    cost = {item.nodeid: seconds.get(item.nodeid, 0.0) for item in items}
    for item in items:
        for name in getattr(item, "fixturenames", ()):
            key = f"{file_of(item.nodeid)}::{FIXTURE}{name}"
            if key in seconds:
                users[key].append(item.nodeid)
    for key, sharing in users.items():
        for nodeid in sharing:
            cost[nodeid] += seconds[key] / len(sharing)
    return cost


def lane_by_cost(cost: float, nodeid: str) -> str:
    """The first lane that runs a test: "fast", "long" or "nightly"."""
    if cost <= FAST or nodeid.removeprefix("tests/") in ALWAYS:
        return "fast"
    return "long" if cost <= LONG else "nightly"


def lanes_by_law(items: Iterable[pytest.Item]) -> dict[str, str]:
    """The first lane of each case of a test that goes through the library of laws, by its node id."""
    cases: defaultdict[str, list[tuple[str, set[str]]]] = defaultdict(list)
    for item in items:
        cases[item.nodeid.partition("[")[0]].append((item.nodeid, laws_of(item)))
    found: dict[str, str] = {}
    functions: defaultdict[str, int] = defaultdict(int)  # of each file, those that go through the library so far
    through = [name for name, own in cases.items() if len(set().union(*(laws for _, laws in own))) >= MANY]
    for name in through:
        place = functions[file_of(name)]
        functions[file_of(name)] += 1
        for nodeid, laws in cases[name]:
            lanes = [_lane_of_law(law, place, file_of(name), through) for law in laws]
            found[nodeid] = max(lanes, key=LANES.index, default="fast")
    return found


def _lane_of_law(law: str, place: int, file: str, through: list[str]) -> str:
    turns = sum(file_of(name) == file for name in through)
    if law in KINDS:
        return "fast" if (KINDS.index(law) - place) % min(turns, len(KINDS)) == 0 else "long"
    return "long" if (list(LIBRARY).index(law) - place) % turns == 0 else "nightly"


def laws_of(item: pytest.Item) -> set[str]:
    """The laws that a test is about by its parameters."""
    given = getattr(item, "callspec", None)
    values = [] if given is None else list(given.params.values())
    flat = [part for value in values for part in (value if isinstance(value, tuple | list) else [value])]
    return {value for value in flat if isinstance(value, str) and value in LIBRARY}


def file_of(nodeid: str) -> str:
    """The file of a test."""
    return nodeid.partition("::")[0]


def dearest_first(items: list[pytest.Item], cost: Mapping[str, float]) -> None:
    """Sort by file, the file that costs most first, so that no process is left with one when the others are done."""
    whole: defaultdict[str, float] = defaultdict(float)
    for item in items:
        whole[file_of(item.nodeid)] += cost[item.nodeid]
    items.sort(key=lambda item: (-whole[file_of(item.nodeid)], file_of(item.nodeid)))


class Lanes:
    """Marks each test with its lane."""

    @pytest.hookimpl(tryfirst=True)  # before pytest leaves out what -m does not ask for
    def pytest_collection_modifyitems(self, config: pytest.Config, items: list[pytest.Item]) -> None:
        seconds = known()
        cost, by_law = costs(items, seconds), lanes_by_law(items)
        if hasattr(config, "workerinput"):  # of several processes; one alone keeps the order that it was asked for
            dearest_first(items, cost)
        if any("::" in str(given) for given in config.args):
            for item in items:
                item.own_markers[:] = [mark for mark in item.own_markers if mark.name not in LANES]
            return
        for item in items:
            found = max(lane_by_cost(cost[item.nodeid], item.nodeid), by_law.get(item.nodeid, "fast"), key=LANES.index)
            if item.nodeid in seconds:
                item.own_markers[:] = [mark for mark in item.own_markers if mark.name not in LANES]
            if found != "fast":
                item.add_marker(found)


# --- the time that there is ---


class Within:
    """Leaves out the tests that have not begun when the time is over: a slow machine says how far it came."""

    def __init__(self, seconds: float) -> None:
        self.seconds, self.ends = seconds, time.monotonic() + seconds

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_setup(self) -> None:
        if time.monotonic() > self.ends:
            pytest.skip(f"not begun within {self.seconds:g} s: this machine is too slow for all tests")


# --- measuring ---


class Measured:
    """What the tests of this run cost."""

    def __init__(self, write: bool) -> None:
        self.write = write
        self.before = known()
        self.began, self.skipped = 0.0, False
        self.shared: dict[str, float] = {}  # of the present test: what was made for others too
        self.seconds: dict[str, float] = {}

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self) -> Iterator[None]:
        self.began, self.skipped = processor_time(), False
        self.shared.clear()
        return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[Any]) -> Iterator[None]:
        began, inner = processor_time(), sum(self.shared.values())
        try:
            return (yield)
        finally:
            if fixturedef.scope != "function":
                within = sum(self.shared.values()) - inner
                self.shared[fixturedef.argname] = processor_time() - began - within

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, call: pytest.CallInfo[None]) -> Iterator[None]:
        report: Any = yield
        self.skipped |= report.skipped  # which says nothing of what it costs elsewhere
        if call.when == "teardown" and not self.skipped:  # the report goes to the process that writes
            report.cost = processor_time() - self.began - sum(self.shared.values())
            report.shared = dict(self.shared)
        return report

    def pytest_runtest_logreport(self, report: Any) -> None:
        if hasattr(report, "cost"):
            self.seconds[report.nodeid] = report.cost
            for name, seconds in report.shared.items():
                self.seconds[f"{file_of(report.nodeid)}::{FIXTURE}{name}"] = seconds

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        if self.write:
            DURATIONS.write_text(as_text(updated(self.before, self.seconds)), encoding="utf-8")
        else:
            for nodeid, seconds in sorted(self.unknown().items(), key=lambda pair: -pair[1]):
                terminalreporter.write_line(f"{seconds:.1f} s of processor time, and not in {DURATIONS.name}: {nodeid}")

    def unknown(self) -> dict[str, float]:
        """What costs more than the fast lane allows, and the file does not say so."""
        return {
            nodeid: seconds for nodeid, seconds in self.seconds.items() if seconds > FAST and nodeid not in self.before
        }


def updated(before: Mapping[str, float], measured: Mapping[str, float]) -> dict[str, float]:
    """The costs known so far with those of a run; what is cheap now, or no longer there, is left out."""
    after = {name: seconds for name, seconds in before.items() if name not in measured and exists(name)}
    for name, seconds in measured.items():
        if name in before and abs(seconds - before[name]) <= CHANGED * before[name]:
            after[name] = before[name]
        elif seconds >= CHEAP:
            after[name] = float(f"{seconds:.2g}")
    return after


def exists(name: str, root: Path = ROOT) -> bool:
    """Whether the file of a test still has a function of its name."""
    file, _, test = name.partition("::")
    function = test.removeprefix(FIXTURE).partition("[")[0].rpartition("::")[2]
    path = root / file
    return path.exists() and (
        test.startswith(FIXTURE) or re.search(rf"\bdef {re.escape(function)}\(", path.read_text("utf-8")) is not None
    )


def as_text(seconds: Mapping[str, float]) -> str:
    """The file of durations: by file and test, a line each."""
    files: defaultdict[str, dict[str, float]] = defaultdict(dict)
    for name, value in sorted(seconds.items()):
        file, _, test = name.partition("::")
        files[file][test] = value
    return json.dumps(files, indent=1, ensure_ascii=False) + "\n"


def processor_time() -> float:
    """Seconds of processor time of this process and of those it waited for."""
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system
