"""What all tests share: a model with any law of the library, recordings of Eq. 17 and of rigs with a concealed effect
by integrators that are not the product's, which tests are long, and how the test process ends."""

from __future__ import annotations

import os
import pickle
import signal
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

#: Tests run on all cores. Threads of the linear algebra besides those would wait for one another in a loop: the
#: matrices are small, and on busy cores a factorisation of 2400 x 22 takes a hundred times the time.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # is read when numpy is loaded
os.environ.setdefault("DASHPOT_SECONDS", "inf")  # what a diagnosis finds may not depend on the speed of the machine
os.environ.setdefault("HYPOTHESIS_STORAGE_DIRECTORY", str(Path(__file__).parents[1] / ".pytest_cache" / "hypothesis"))


import numpy as np
import pytest
from dashpot.errors import DashpotError
from dashpot.examples.concealed.record import record
from dashpot.examples.concealed.suite import Spec
from dashpot.examples.concealed.virtual import draw
from dashpot.examples.virtual_recording import UNITS, recording_of
from dashpot.identify import identify
from dashpot.model import Oscillator, Response, oscillator_with, user_laws
from dashpot.model.law import LawParameter, Scales
from dashpot.model.library import KNOWN, find
from dashpot.recording import Recording


@pytest.fixture
def library(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The laws as they are: what a test loads is forgotten after it."""
    before = dict(KNOWN)
    monkeypatch.setattr(user_laws, "_loaded", {})
    yield
    KNOWN.clear()
    KNOWN.update(before)


def _beside(name: str) -> ModuleType:
    """A module of this folder, which is no package."""
    spec = spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules[name] = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


lanes, sentences = _beside("lanes"), _beside("sentences")
reads = sentences.reads

#: The paper's stand, and the sizes of its motion.
STAND = {"mass": 0.27, "omega0": 79.6, "cubic": 4.6e5, "preload": 0.02 / 0.27, "viscous": 5.0, "dry": 0.015}
SCALES = Scales(length=8e-3, omega=79.6, force=1.0, response=8e-3, duration=1.0, mass=0.27, lines=(60.0,))
#: Of a rig with a concealed effect, what a model is identified from, and what is held out.
TRAINING = ("sweep_high", "sweep_low", "ringdown")
HOLDOUT = ("holdout_multisine", "holdout_sweep")
#: Set to a number, each test with ``every`` tries so many times as many inputs as it usually has, others each time:
#: DASHPOT_FUZZ=1000 .venv/bin/pytest -k any_
FUZZ = "DASHPOT_FUZZ"
#: What may pass without a result, s, and the longest sentence that anybody reads.
LONGEST_SECONDS, MOST_WORDS = 30.0, 1500


def typical(parameter: LawParameter) -> float:
    """A value at which the law matters: one of those at which it is looked for."""
    if parameter.probes == "lines":
        return SCALES.lines[0]
    probe = parameter.probes[len(parameter.probes) // 2] if parameter.probes else 1.0
    return (0.02 if parameter.strength else 1.0) * float(probe) * parameter.natural(SCALES)


@pytest.fixture(scope="session")
def with_law() -> Callable[..., Oscillator]:
    """``with_law("hysteresis", dry=0.0)``: the stand with that law at typical values, some others changed."""

    def make(*effects: str, quantity: str = "displacement", **changed: float) -> Oscillator:
        values = {f"{effect}.{p.name}": typical(p) for effect in effects for p in find(effect).parameters}
        response = Response(quantity, UNITS[quantity])
        return oscillator_with({**STAND, **values, **changed}, effects=effects, response=response)

    return make


@pytest.fixture(scope="session")
def offsets() -> Callable[[Oscillator], list[float]]:
    """Start values of the inner states of a model, of a size that shows."""
    from dashpot.model.equations import equations

    def make(oscillator: Oscillator) -> list[float]:
        return [0.5 if state.free else 1e-4 * SCALES.of(state.unit) for state in equations(oscillator).inner]

    return make


@pytest.fixture(scope="session")
def recorded() -> Callable[..., Recording]:
    """``recorded(values, sweep=(1.0, 5.0, 20.0))`` or ``recorded(begin=(8e-3, 0.0))``; see ``recording_of``."""
    return recording_of


@dataclass(frozen=True, eq=False)
class Case:
    """Recordings of one virtual rig, the model identified from them, and the truth."""

    model: Oscillator
    training: tuple[Recording, ...]
    holdout: tuple[Recording, ...]
    truth: dict


def concealed(kind: str, *effects: str, variants: tuple[str, ...] = (), noise: str = "white", seed: int = 7) -> Case:
    """A rig of about a hundred cycles a recording."""
    spec = Spec(kind, effects, variants or ("",) * len(effects), noise, 0)
    tables, truth = record(draw(spec, seed, cycles=(110.0, 130.0)))
    recordings = {
        name: Recording(
            name=name,
            fs=truth["fs_hz"],
            response=table[:, 2],
            force=table[:, 1] if np.any(table[:, 1]) else None,
        )
        for name, table in tables.items()
    }
    training = tuple(recordings[name] for name in TRAINING)
    model = identify(training, name="rig").oscillator
    return Case(model, training, tuple(recordings[name] for name in HOLDOUT), truth)


@pytest.fixture(scope="session")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Case]:
    """``rig(kind, *effects)`` makes a case, once per run: what one process identified the others read."""
    folder = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        folder = folder.parent
    made: dict[str, Case] = {}

    def get(*what: str, **more: object) -> Case:
        name = "-".join(["rig", *what, *(str(value) for _, value in sorted(more.items()))])
        if name not in made:
            made[name] = _kept(folder / f"{name}.pickle", lambda: concealed(*what, **more))  # type: ignore[arg-type]
        return made[name]

    return get


def _kept(path: Path, make: Callable[[], Case]) -> Case:
    """What a process of this run wrote to a file, or made and written there whole."""
    if not path.exists():
        case = make()
        unfinished = path.with_suffix(f".{os.getpid()}")
        unfinished.write_bytes(pickle.dumps(case))
        unfinished.replace(path)
    return pickle.loads(path.read_bytes())


@pytest.fixture(scope="session", autouse=True)
def this_platform_alone() -> Iterator[None]:
    """An FMU is built for this machine alone where a test does not ask for more; what is slow once is kept."""
    from dashpot.export.platforms import own_platform
    from dashpot.simulate.cache import cache_folder

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("dashpot.export.binaries.default_platforms", lambda: (own_platform(),))
        if "ZIG_GLOBAL_CACHE_DIR" not in os.environ:  # also for tests with a cache of their own
            patch.setenv("ZIG_GLOBAL_CACHE_DIR", str(cache_folder() / "zig"))
        yield


@pytest.fixture
def opened_fmu(tmp_path: Path) -> Iterator[Callable[[Path], tuple[dict[str, int], list[str], Any]]]:
    """``opened_fmu(path)``: value references by name, names of the start values, FMPy's object, in this process."""
    from dashpot.verify.fmu_run import FmuRun
    from dashpot.verify.slave import opened
    from dashpot.verify.unpack import unpack

    slaves, here = [], Path.cwd()

    def make(path: Path) -> tuple[dict[str, int], list[str], Any]:
        unpack(path, tmp_path / "unpacked")
        description, slave = opened(tmp_path / "unpacked", str(path))
        slaves.append(slave)
        with FmuRun(path) as run:
            return {v.name: v.valueReference for v in description.modelVariables}, run.starts, slave.fmu

    yield make
    for slave in slaves:
        slave.close()
    os.chdir(here)


@pytest.fixture
def no_zig(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine without the package ziglang."""
    monkeypatch.setattr("dashpot.simulate.zig.zig_version", lambda: None)


@pytest.fixture
def no_compiler(monkeypatch: pytest.MonkeyPatch, no_zig: None) -> None:
    """A machine without any C compiler."""
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CC", raising=False)


@pytest.fixture(scope="session")
def kinds() -> tuple[str, ...]:
    """The laws that stand for the library in `make test`."""
    return lanes.KINDS


@pytest.fixture(params=[pytest.param(0.2, id="a taste"), pytest.param(5, id="at length", marks=pytest.mark.nightly)])
def every(request: pytest.FixtureRequest) -> Callable[..., None]:
    """``every(strategy, holds, usual=100)`` calls ``holds`` with a fifth of so many inputs, or with five times as many.

    They are the same every time; see FUZZ.
    """
    from hypothesis import HealthCheck, Phase, given, seed, settings

    def run(strategy: Any, holds: Callable[[Any], None], usual: int = 100) -> None:
        more = float(os.environ.get(FUZZ) or 0.0)
        count = max(1, round(usual * (more or request.param)))
        how = settings(
            max_examples=count,
            derandomize=not more,
            database=None,
            deadline=None,
            suppress_health_check=list(HealthCheck),
            phases=[Phase.generate, Phase.shrink],
        )

        def in_time(given_input: Any) -> None:
            _tried[request.node.nodeid] += 1
            with _at_most(LONGEST_SECONDS):
                holds(given_input)

        # the seed of a run that is repeatable comes from what the function is called, so each has a name of its own
        in_time.__qualname__ = in_time.__name__ = request.node.originalname
        test = how(given(strategy)(in_time))
        (seed(int.from_bytes(os.urandom(4))) if more else lambda same: same)(test)()

    return run


class Hang(BaseException):
    """A call that did not end, which no code under test may take for something else."""


@contextmanager
def _at_most(seconds: float) -> Iterator[None]:
    def late(*_: object) -> None:
        raise Hang(f"nothing for {seconds:g} s")

    if not hasattr(signal, "setitimer"):
        yield
        return
    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@pytest.fixture(scope="session")
def unless_refused() -> Callable[..., Any]:
    """``unless_refused(function, *arguments)``: its result, or None where it is refused as a user may be told."""

    def call(function: Callable[..., Any], *arguments: Any, **options: Any) -> Any:
        try:
            return function(*arguments, **options)
        except DashpotError as problem:
            for sentence in str(problem).split("\n"):
                assert sentence.strip(), "refused without a word"
                assert len(sentence) < MOST_WORDS, f"no sentence: {sentence!r}"
                assert all(c.isprintable() for c in sentence), f"does not print: {sentence!r}"
            return None

    return call


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--write-durations", action="store_true", help="write what tests cost to tests/durations.json")
    parser.addoption("--within", type=float, metavar="SECONDS", help="begin no test after so many seconds")
    parser.addoption("--write-sentences", action="store_true", help="write what tests read to tests/sentences.yaml")


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(lanes.Lanes(), "lanes")
    if config.getoption("--within") is not None:
        config.pluginmanager.register(lanes.Within(config.getoption("--within")), "within")
    config.pluginmanager.register(lanes.Measured(config.getoption("--write-durations")), "measured")
    texts = sentences.Sentences(config.getoption("--write-sentences"), lanes.exists)
    config.pluginmanager.register(texts, "sentences")


_status = 0
_tried: Counter[str] = Counter()


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    if os.environ.get(FUZZ):  # so that runs can be counted together
        for name, count in _tried.items():
            terminalreporter.write_line(f"{count} inputs: {name}")


def pytest_sessionfinish(session, exitstatus):
    global _status
    _status = int(exitstatus)


def pytest_unconfigure(config):
    # PythonFMU's libraries stay in the process after their FMU is freed, and what they hold is torn down after Python
    # itself: the suspect of an abort that once followed a green summary. Only a run that used PythonFMU leaves early;
    # every other one ends in the ordinary way, so that damage done by the engine or the native FMU would show.
    if "pythonfmu" not in sys.modules:
        return
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(_status)
