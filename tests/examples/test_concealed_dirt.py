"""Every imperfection does what its row says: against closed forms, on the integrator and on recordings made by hand."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest
from dashpot.examples.concealed.base import Base
from dashpot.examples.concealed.dirty import IMPERFECTIONS
from dashpot.examples.concealed.engine import Drive, Response, simulate
from dashpot.examples.concealed.imperfection import Imperfection, Scene
from dashpot.examples.concealed.recordings import Plan

W, A, M, FS = 2 * np.pi * 10.0, 5e-3, 2.0, 800.0
N = 8000  # samples: a hundred cycles
SPRING, SPEED, ZETA = W**2 * A, W * A, 0.01
PLAIN = {"mass": M, "omega2": W**2, "viscous": 0.0, "omega": W, "amplitude": A, "force": SPRING}
BASE = Base(W, A, ZETA, PLAIN, FS, N / FS, 1e-5)
REST = Drive("none")
T = np.arange(N) / FS


def scene(
    x0: float = 0.0, own: int = 2, held_out: bool = False, values: Mapping[str, float] = MappingProxyType({})
) -> Scene:
    rngs = np.random.default_rng(1), np.random.default_rng(own)
    return Scene(BASE, Plan(REST, x0, N), PLAIN | dict(values), held_out, A, *rngs)


def moved(values: dict[str, float], x0: float, rest: np.ndarray | None = None, fs: float = FS) -> np.ndarray:
    return simulate(PLAIN | values, REST, x0, fs, round(N * fs / FS), rest=rest).shown


def taken(row: Imperfection, size: float, **values: float) -> dict[str, float]:
    assert row.rig is not None
    return values | row.rig(scene(values=values), size)


def pulled(values: dict[str, float], x0: float) -> float:
    """Acceleration right after a release at x0, m/s²."""
    return moved(values | {"accelerometer": 1.0}, x0)[0]


def frequency(x: np.ndarray) -> float:
    """Angular frequency from the first to the last upward crossing, rad/s."""
    up = np.flatnonzero((x[:-1] < 0) & (x[1:] >= 0))
    at = up - x[up] / (x[up + 1] - x[up])
    return 2 * np.pi * (len(at) - 1) / (at[-1] - at[0]) * FS


def leaning(values: dict[str, float]) -> np.ndarray:
    """Displacement under a constant force that bends the spring to A/2: what the spring does, without inertia."""
    return moved(values | {"viscous": 2 * W}, A / 2, np.full(N, M * SPRING / 2))


def second_mode(row: Imperfection, size: float) -> None:
    taking = taken(row, size)
    ratio = taking["resonator_omega"] ** 2
    matrix = [[W**2 + size * ratio, -size * ratio], [-ratio, ratio]]
    assert frequency(moved(taking, A)) == pytest.approx(np.sqrt(min(np.linalg.eigvals(matrix))), rel=1e-5)


def breathing(row: Imperfection, size: float) -> None:
    taking = taken(row, size)
    stiffness = 1 + size * np.cos(taking["modulation_omega"] * T + taking["modulation_phase"])
    assert np.ptp(leaning(taking)[800:] * stiffness[800:]) < 0.4 * np.ptp(leaning(taking)[800:])
    assert 0.02 * W <= taking["modulation_omega"] <= 0.15 * W


def moving_mass(row: Imperfection, size: float) -> None:
    assert pulled(taken(row, size), A) == pytest.approx(-SPRING / (1 + size), rel=1e-9)


def presliding(row: Imperfection, size: float) -> None:
    assert pulled(taken(row, size), A) == pytest.approx(-SPRING * (1 + size), rel=1e-8)


def warming_spring(row: Imperfection, size: float) -> None:
    taking = taken(row, size)
    stiffness = 1 - size * -np.expm1(-T / taking["drift_time"])
    assert np.abs(leaning(taking) * stiffness / (A / 2) - 1).max() < 0.02 * size


def run_in(row: Imperfection, size: float) -> None:
    taking = taken(row, size) | {"friction_time": 1e-3}
    x = moved(taking, A)
    half = round(FS * np.pi / W)
    peaks = np.abs(x[half::half])[:30]
    assert -np.diff(peaks) == pytest.approx(2 * size * A, rel=0.01)  # Coulomb: 2 f/k each half-cycle


def air(row: Imperfection, size: float) -> None:
    falling = taken(row, size) | {"omega2": 1e-12}
    x = moved(falling, 0.0, np.full(N, M * size * SPRING))
    speed = SPEED * np.tanh(size * W * (T[-1] - 0.5 / FS))  # it falls until drag, at peak speed, has that force
    assert np.diff(x[-2:])[0] * FS == pytest.approx(speed, rel=1e-3)


def sagging(row: Imperfection, size: float) -> None:
    taking = taken(row, size)
    assert abs(pulled(taking, A) + pulled(taking, -A)) == pytest.approx(2 * size * SPRING, rel=1e-6)


def creep(row: Imperfection, size: float) -> None:
    taking = taken(row, size)
    assert frequency(moved(taking, A)) / W - 1 == pytest.approx(size / 2, rel=0.05)
    assert pulled(taking, A) == pytest.approx(-SPRING, rel=1e-9)  # a slow pull leaves no force in it


def warming_damper(row: Imperfection, size: float) -> None:
    viscous = 2 * ZETA * W / 3
    x = moved(taken(row, size, viscous=viscous), A)
    late = np.abs(x[-160:]).max() / A
    t = T[-160 + int(np.argmax(np.abs(x[-160:])))]
    assert np.log(late) == pytest.approx(-viscous / 2 * t * (1 - size * t / (2 * N / FS)), rel=2e-3)


def force_factor(row: Imperfection, size: float) -> None:
    lines = np.tile([1.0, 0.0], (N, 1))
    values = PLAIN | taken(row, size) | {"accelerometer": 1.0}
    shown = simulate(values, Drive("straight", M, ramp=0.0, lines=lines), A, FS, N).shown
    assert shown[0] == pytest.approx((1 - size) - SPRING, rel=1e-9)


def remounted(row: Imperfection, size: float) -> None:
    assert row.rig is not None
    values = [row.rig(scene(own=own, values={"viscous": 1.0}), size) for own in range(40)]
    changes = np.array([frequency(moved({"omega2": one["omega2"]}, A)) for one in values[:3]]) / W - 1
    assert changes == pytest.approx([(one["omega2"] / W**2 - 1) / 2 for one in values[:3]], abs=size**2)
    spread = np.abs([[one["omega2"] / W**2 - 1, (one["viscous"] - 1) / 10] for one in values]).max(axis=0) / size
    assert np.all((spread > 0.8) & (spread <= 1.0))


def play(row: Imperfection, size: float) -> None:
    response = simulate(PLAIN | taken(row, size), REST, A, FS, N)
    assert np.abs(response.shown - response.x).max() == pytest.approx(size * A, rel=1e-6)


def clock(row: Imperfection, size: float) -> None:
    taking = taken(row, size)
    assert abs(taking["sensor_clock"]) == size
    cosine = A * np.cos(W * T * (1 + taking["sensor_clock"]))
    assert np.abs(moved(taking, A) - cosine).max() < 1e-6 * A


def skew(row: Imperfection, size: float) -> None:
    delayed = moved(taken(row, size), A)[1:]
    assert np.abs(delayed - A * np.cos(W * (T[1:] - size / FS))).max() < 1e-6 * A


def caught(row: Imperfection, size: float) -> None:
    assert row.rig is not None
    taking = row.rig(scene(), size)
    x, free = moved(taking, A), moved({}, A)
    at = int(taking["hand_at"] * FS)
    assert 1 - size <= at / N <= 1 - size / 2 + 1 / N
    assert np.abs(x[: at + 1] - free[: at + 1]).max() < 1e-7 * A  # the steps of the integrator differ
    assert np.abs(x[at + 320 :]).max() < 0.2 * A
    assert row.rig(scene(held_out=True), size) == {}


def power_within(force: np.ndarray, low: float, high: float) -> float:
    f = np.fft.rfftfreq(N, 1 / FS)
    lines = np.abs(np.fft.rfft(force)) ** 2
    return float(np.sum(lines[(f >= low) & (f < high)]) / np.sum(lines))


def resting(row: Imperfection, size: float, x0: float = 0.0, own: int = 2) -> np.ndarray:
    assert row.rest is not None
    return row.rest(scene(x0, own), size)


RESONANT = M * 2 * ZETA * SPRING


def pink(row: Imperfection, size: float) -> None:
    force = resting(row, size)
    assert np.sqrt(np.mean(force**2)) == pytest.approx(size * RESONANT)
    assert power_within(force, 3, 30) == pytest.approx(power_within(force, 30, 300), rel=0.4)  # as much each decade


def hum_force(row: Imperfection, size: float) -> None:
    force = resting(row, size)
    assert np.sqrt(2 * np.mean(force**2)) == pytest.approx(size * RESONANT, rel=0.02)
    peak = np.argmax(np.abs(np.fft.rfft(force))) * FS / N
    assert power_within(force, peak - 0.5, peak + 0.5) > 0.9
    assert not 8.0 < peak < 13.0


def knocks(row: Imperfection, size: float) -> None:
    for own in range(5):
        force = resting(row, size, own=own)
        gained = np.sum(np.abs(force)) / FS / M / SPEED
        assert 0.3 * size <= gained <= 4 * size
        assert np.mean(force != 0.0) < 4 * 0.012


def sway(row: Imperfection, size: float) -> None:
    force = resting(row, size)
    assert np.sqrt(np.mean(force**2)) == pytest.approx(size * M * SPRING)
    assert power_within(force, 0.0, 1.001) > 0.999


def slow_release(row: Imperfection, size: float) -> None:
    force = resting(row, size, A)
    assert pulled({}, A) * M + force[0] == pytest.approx(0.0, abs=1e-9)
    x = moved({}, A, force)
    assert A - x[1] == pytest.approx(SPRING / (size / 10) / FS**3 / 6, rel=0.02)  # x''' constant at first
    assert np.all(force[size * 0.1 < T] == 0.0)
    assert not resting(row, size).any()


SINE = Response(np.sin(W * T) * 3.0, A * np.sin(W * T + 0.3), A * np.sin(W * T + 0.3), 0, 0)


def recorded(row: Imperfection, size: float, response: Response = SINE, own: int = 2) -> Response:
    assert row.record is not None
    return row.record(scene(own=own), size, response)


def phasor(signal: np.ndarray) -> complex:
    """Amplitude and phase at W, late in the recording, in parts of those of sin(W t)."""
    late = slice(4000, 7200)
    return 2j * complex(np.mean(signal[late] * np.exp(-1j * W * T[late])))


def passes(row: Imperfection, size: float, expected: Callable[[Scene], complex]) -> None:
    gain = phasor(recorded(row, size).shown) / phasor(SINE.shown)
    assert abs(gain - expected(scene())) < 1e-3 * abs(expected(scene()) - 1) + 2e-5


def fixture(row: Imperfection, size: float) -> None:
    added = recorded(row, size).force - SINE.force
    assert phasor(added) == pytest.approx(-size * M * W**2 * phasor(SINE.x), rel=0.01)


def curved_cell(row: Imperfection, size: float) -> None:
    driven = np.abs(SINE.force) > 0.01
    relative = recorded(row, size).force[driven] / SINE.force[driven] - 1
    assert np.abs(relative).max() == pytest.approx(size, rel=1e-3)
    assert np.abs(relative) == pytest.approx(size * np.abs(SINE.force[driven]) / 3.0, rel=1e-2)


def charge(row: Imperfection, size: float) -> None:
    step = replace(SINE, force=np.where(T > 1.0, 1.0, 0.0))
    leaked = recorded(row, size, step).force
    after = (T > 1.05) & (T < 4.0)
    assert leaked[after] == pytest.approx(np.exp(-size * W * (T[after] - 1.0)), abs=5e-3)


def crosstalk(row: Imperfection, size: float) -> None:
    added = recorded(row, size).shown - SINE.shown
    assert np.abs(added).max() == pytest.approx(size * A, rel=1e-3)
    assert abs(np.corrcoef(added, SINE.force)[0, 1]) == pytest.approx(1.0)


def bent(row: Imperfection, size: float) -> None:
    added = recorded(row, size).shown - SINE.shown
    assert np.abs(added) == pytest.approx(size * SINE.shown**2 / A)


def drift(row: Imperfection, size: float) -> None:
    added = recorded(row, size).shown - SINE.shown
    assert np.abs(added - np.polyval(np.polyfit(T, added, 2), T)).max() < 1e-9 * A
    assert 0.05 * size * A < np.abs(added).max() <= 3 * size * A
    assert recorded(row, size, own=3).shown[0] != recorded(row, size, own=4).shown[0]


def gain(row: Imperfection, size: float) -> None:
    gains = [phasor(recorded(row, size, own=own).shown) / phasor(SINE.shown) for own in range(30)]
    assert 0.8 * size < max(abs(one - 1) for one in gains) <= size * (1 + 1e-9)


def jitter(row: Imperfection, size: float) -> None:
    added = recorded(row, size).shown - SINE.shown
    assert added.std() == pytest.approx(size * SPEED / np.sqrt(2) / FS, rel=0.05)


def anti_alias(row: Imperfection, size: float) -> None:
    passes(row, size, lambda _: 1 / (1 - size**2 + 1j * np.sqrt(2) * size))


def hum_shown(row: Imperfection, size: float) -> None:
    added = recorded(row, size).shown - SINE.shown
    assert np.sqrt(2 * np.mean(added**2)) == pytest.approx(size * A, rel=0.02)


def repeated(row: Imperfection, size: float) -> None:
    shown = recorded(row, size).shown
    assert np.mean(np.diff(shown) == 0.0) == pytest.approx(size, rel=0.5)
    other = np.flatnonzero(shown != SINE.shown)
    assert len(other)
    assert np.array_equal(shown[other], shown[other - 1])


def lens(row: Imperfection, size: float) -> None:
    added = recorded(row, size).shown - SINE.shown
    assert np.abs(added) == pytest.approx(size * np.abs(SINE.shown) ** 3 / A**2)


def stand(low: float, high: float) -> Callable[[Imperfection, float], None]:
    def check(row: Imperfection, size: float) -> None:
        def expected(one: Scene) -> complex:
            ratio, zeta = one.common.uniform(low, high), one.common.uniform(0.02, 0.1)
            return 1 - size / (ratio**2 - 1 + 2j * zeta * ratio)

        passes(row, size, expected)

    return check


def mount(row: Imperfection, size: float) -> None:
    passes(row, size, lambda one: 1 / (1 - size**2 + 2j * one.common.uniform(0.02, 0.1) * size))


def coupled(row: Imperfection, size: float) -> None:
    assert row.record is not None
    step = replace(SINE, shown=np.where(T > 1.0, A, 0.0))
    leaked = row.record(scene(values={"accelerometer": 1.0}), size, step).shown
    after = (T > 1.05) & (T < 4.0)
    assert leaked[after] / A == pytest.approx(np.exp(-size * W * (T[after] - 1.0)), abs=5e-3)


CHECKS: dict[str, Callable[[Imperfection, float], None]] = {
    "second-mode": second_mode,
    "breathing-stiffness": breathing,
    "moving-mass": moving_mass,
    "pre-sliding": presliding,
    "warming-spring": warming_spring,
    "friction-wears-in": run_in,
    "air-drag": air,
    "sagging-spring": sagging,
    "creeping-rubber": creep,
    "warming-damper": warming_damper,
    "force-factor": force_factor,
    "remounted": remounted,
    "sensor-play": play,
    "clock-of-motion": clock,
    "skewed-channels": skew,
    "caught": caught,
    "pink-force": pink,
    "hum-force": hum_force,
    "knocks": knocks,
    "sway": sway,
    "slow-release": slow_release,
    "fixture-behind-the-cell": fixture,
    "curved-load-cell": curved_cell,
    "charge-amplifier": charge,
    "crosstalk": crosstalk,
    "bent-sensor": bent,
    "zero-and-drift": drift,
    "gain-by-file": gain,
    "timing-jitter": jitter,
    "anti-alias-filter": anti_alias,
    "hum-in-the-sensor": hum_shown,
    "repeated-frames": repeated,
    "lens": lens,
    "soft-base": stand(0.1, 0.3),
    "shaky-stand": stand(2.5, 6.0),
    "mounted-resonance": mount,
    "coupled-accelerometer": coupled,
}


@pytest.mark.parametrize("name", IMPERFECTIONS)
def test_an_imperfection_does_what_its_row_says(name):
    row = IMPERFECTIONS[name]
    assert 0 < row.low < row.high
    assert row.does
    assert row.reason
    assert sum(stage is not None for stage in (row.rig, row.rest, row.record)) == 1
    CHECKS[name](row, row.high)
    CHECKS[name](row, np.sqrt(row.low * row.high))


def test_there_are_twenty_kinds_and_more_and_each_is_checked():
    assert len(IMPERFECTIONS) >= 20
    assert set(CHECKS) == set(IMPERFECTIONS)
