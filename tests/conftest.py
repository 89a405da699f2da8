"""What all tests share: a model with any law of the library, recordings of Eq. 17 by an integrator that is not the
product's, which tests are long, and how the test process ends."""

from __future__ import annotations

import os
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator

#: Tests run on all cores. Threads of the linear algebra besides those would wait for one another in a loop: the
#: matrices are small, and on busy cores a factorisation of 2400 x 22 takes a hundred times the time.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # is read when numpy is loaded


import numpy as np
import pytest
from dashpot.examples.force import chirp
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.model import Oscillator, Response
from dashpot.model.law import LawParameter, Scales
from dashpot.model.laws import LIBRARY, find
from dashpot.recording import Recording

#: The paper's stand, and the sizes of its motion.
STAND = {"mass": 0.27, "omega0": 79.6, "cubic": 4.6e5, "preload": 0.02 / 0.27, "viscous": 5.0, "dry": 0.015}
SCALES = Scales(length=8e-3, omega=79.6, force=1.0, response=8e-3, duration=1.0, mass=0.27, lines=(60.0,))
#: A law of each path, of each kind of surface, with and without states, time and a phase: where a test goes through the
#: library, `make test` takes these, and `make test-all` the whole of it (tests/test_lanes.py holds them complete).
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
UNITS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}


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
        return Oscillator.from_values({**STAND, **values, **changed}, effects=effects, response=response)

    return make


@pytest.fixture(scope="session")
def offsets() -> Callable[[Oscillator], list[float]]:
    """Start values of the inner states of a model, of a size that shows."""
    from dashpot.model.equations import equations

    def make(oscillator: Oscillator) -> list[float]:
        return [0.5 if state.free else 1e-4 * SCALES.of(state.unit) for state in equations(oscillator).inner]

    return make


def acceleration(values, x, v, force):
    """Of Eq. 17 at states (n,) under a force (n,), m/s²: zero where friction holds the mass."""
    v_zero, x_zero = v == 0.0, x == 0.0
    net = force / values["mass"] - values["omega0"] ** 2 * x - values["cubic"] * x**3
    net = net - values["preload"] * np.sign(x) - values["viscous"] * v
    grip = values["dry"] + np.where(x_zero, values["preload"], 0.0)
    held = np.sign(net) * np.maximum(np.abs(net) - grip, 0.0)
    return np.where(v_zero, held, net - values["dry"] * np.sign(v))


def taylor(
    values=TRUTH,
    *,
    sweep=None,
    begin=(0.0, 0.0),
    fs=500.0,
    seconds=6.0,
    quantity="displacement",
    noise=1e-6,
    offset=0.0,
    force_noise=0.0,
    seed=0,
    name="run",
):
    """A recording of Eq. 17 by the project's reference integrator.

    Args:
        values: of Eq. 17.
        sweep: (N, Hz, Hz) level, first and last frequency of a force that is smooth between its samples; None: free.
        begin: displacement and velocity at the first sample.
        fs, seconds: sampling.
        quantity: what is recorded.
        noise: standard deviation of the displacement's noise; of the others it is that times omega0 or omega0².
        offset: what the sensor shows at zero, in the quantity's unit.
        force_noise: standard deviation of the force channel's noise, N.
        seed: of both noises.
        name: the recording's.
    """
    random = np.random.default_rng(seed)
    n = round(seconds * fs)
    t = np.arange(n) / fs
    pieces = np.zeros((n, 1))
    if sweep is not None:
        level, first, last = sweep
        pieces = chirp(level, first, (last - first) / seconds, t, 1 / fs)
    x, v = integrate_pieces(values, pieces[:-1], 1 / fs, *begin)
    y = {"displacement": x, "velocity": v, "acceleration": acceleration(values, x, v, pieces[:, 0])}[quantity]
    size = noise * values["omega0"] ** list(UNITS).index(quantity)
    y = y + offset + size * random.standard_normal(n)
    force = None if sweep is None else pieces[:, 0] + force_noise * random.standard_normal(n)
    return Recording(name, fs, y, force, quantity, UNITS[quantity])


@pytest.fixture(scope="session")
def recorded() -> Callable[..., Recording]:
    """``recorded(values, sweep=(1.0, 5.0, 20.0))`` or ``recorded(begin=(8e-3, 0.0))``; see ``taylor``."""
    return taylor


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
    return KINDS


def laws_of(item: pytest.Item) -> set[str]:
    """The laws that a test is about by its parameters."""
    given = getattr(item, "callspec", None)
    values = [] if given is None else list(given.params.values())
    flat = [part for value in values for part in (value if isinstance(value, tuple | list) else [value])]
    return {value for value in flat if isinstance(value, str) and value in LIBRARY}


@pytest.hookimpl(tryfirst=True)  # before pytest leaves out what is long
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    whole: defaultdict[str, set[str]] = defaultdict(set)
    for item in items:
        whole[item.nodeid.partition("[")[0]] |= laws_of(item)
    for item in items:
        if len(whole[item.nodeid.partition("[")[0]]) >= MANY and laws_of(item) - set(KINDS):
            item.add_marker(pytest.mark.long)


_status = 0


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
