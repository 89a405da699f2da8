"""What the exact law leaves of a dirty recording: base and effect alone, their values fitted to first order.

The true values are no measure: a clock that is off by 300 ppm shifts a sweep's phase by a radian, and a natural
frequency that is off by as much takes it away. So parameters, each recording's zero and the place of release are
fitted to the training recordings by Gauss-Newton steps with the derivatives at the true values; what is left is then
measured on a simulation. It is what the law can reach, or a little more.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from .engine import Response
from .recordings import Plan, Rig, run
from .virtual import Virtual

CHANGE = 1e-4  # relative, for derivatives
STEPS = 3
BELIEVED = 0.3  # standard deviation of a parameter's relative change before the fit: what steps may take it to
#: Sizes for tolerances, switches, exponents and phases are no parameters.
FIXED = {
    *("amplitude", "omega", "force", "accelerometer", "sensor_play", "bouc_power", "stribeck_power"),
    *("tone_phase", "modulation_phase"),
}


@dataclass(frozen=True)
class Dirty:
    """A recording without its sensor's noise: the response, how much recorded force the mass was not driven by, N,
    and until which sample the rig is free."""

    response: Response
    astray: np.ndarray | None
    free: int


@dataclass(frozen=True)
class ExactLaw:
    """The law of a rig, with derivatives of what its sensor shows, one column a parameter, by recording."""

    virtual: Virtual
    rig: Rig
    names: tuple[str, ...]
    columns: dict[str, np.ndarray]
    own: dict[str, np.ndarray]


def without_effect(virtual: Virtual) -> Rig:
    """The base alone."""

    def rig(recording: str, level: float) -> dict[str, float]:
        kept = {*virtual.base.parameters, "force"}
        return {name: value for name, value in virtual.rig(recording, level).items() if name in kept}

    return rig


def _changed(rig: Rig, names: Sequence[str], by: np.ndarray) -> Rig:
    def changed(recording: str, level: float) -> dict[str, float]:
        values = rig(recording, level)
        return values | {name: values[name] * (1.0 + part) for name, part in zip(names, by, strict=True)}

    return changed


def exact_law(virtual: Virtual, rig: Rig) -> ExactLaw:
    """Give the law of a rig tried as the virtual one, its derivatives by finite differences.

    Raises RuntimeError where a run diverges.
    """
    training = virtual.trial.plan.training
    values = rig(training[0], virtual.level)
    undriven = all(virtual.plans[name].drive.kind == "none" for name in training)
    fixed = FIXED | ({"mass"} if undriven else set())
    names = tuple(name for name, value in values.items() if value != 0.0 and name not in fixed)
    columns, own = {}, {}
    for record, plan in virtual.plans.items():
        shown = _shown(virtual, rig, record, plan)
        own[record] = np.ones((len(shown), 1))
        if plan.x0:
            moved = _shown(virtual, rig, record, replace(plan, x0=plan.x0 * (1 + CHANGE)))
            own[record] = np.column_stack([own[record], (moved - shown) / CHANGE])
        if record in training:
            each = [_changed(rig, (name,), np.array([CHANGE])) for name in names]
            columns[record] = np.column_stack([(_shown(virtual, one, record, plan) - shown) / CHANGE for one in each])
    return ExactLaw(virtual, rig, names, columns, own)


def _shown(virtual: Virtual, rig: Rig, record: str, plan: Plan, astray: np.ndarray | None = None) -> np.ndarray:
    return run(rig, virtual.base, record, plan, virtual.level, astray).shown


@dataclass(frozen=True)
class Left:
    """What the exact law leaves: rms over all training recordings, m or m/s²; `changes` its parameters' shares."""

    rms: float
    changes: np.ndarray
    released: dict[str, float]


def _rest(law: ExactLaw, changes: np.ndarray, record: str, x0: float, dirty: Dirty) -> np.ndarray:
    """What is left of a recording while the rig is free, its zero taken away."""
    plan = law.virtual.plans[record]
    rig = _changed(law.rig, law.names, changes)
    model = _shown(law.virtual, rig, record, replace(plan, x0=plan.x0 * (1.0 + x0)), dirty.astray)
    rest = (dirty.response.shown - model)[: dirty.free]
    return rest - rest.mean()


def left(law: ExactLaw, recordings: Mapping[str, Dirty], noise: float) -> Left:
    """Fit the law to training recordings and measure what it leaves; raises RuntimeError where no run succeeds.

    `noise`, m or m/s², weighs what was believed of the parameters.
    """
    changes, released = np.zeros(len(law.names)), dict.fromkeys(recordings, 0.0)
    best: Left | None = None
    for _ in range(STEPS + 1):
        try:
            rests = {name: _rest(law, changes, name, released[name], d) for name, d in recordings.items()}
        except RuntimeError:
            break
        rms = float(np.sqrt(np.mean(np.concatenate(list(rests.values())) ** 2)))
        if best is not None and not rms < 0.97 * best.rms:
            best = best if best.rms <= rms else Left(rms, changes, released)
            break
        best = Left(rms, changes, released)
        step, places = _step(law, rests, recordings, noise)
        changes = np.clip(changes + step, -0.9, 3.0)
        released = {name: released[name] + places[name] for name in released}
    if best is None:
        raise RuntimeError("the law runs away where it should be fitted")
    return best


def _step(
    law: ExactLaw, rests: Mapping[str, np.ndarray], recordings: Mapping[str, Dirty], noise: float
) -> tuple[np.ndarray, dict[str, float]]:
    """The Gauss-Newton step of the parameters, and of each recording's place of release; zeros are eliminated."""
    normal = np.eye(len(law.names)) * (noise / BELIEVED) ** 2
    right = np.zeros(len(law.names))
    kept = {}
    for name, rest in rests.items():
        own, columns = law.own[name][: recordings[name].free], law.columns[name][: recordings[name].free]
        share = np.linalg.lstsq(own, np.column_stack([columns, rest]), rcond=1e-9)[0]
        columns, rest = columns - own @ share[:, :-1], rest - own @ share[:, -1]
        normal += columns.T @ columns
        right += columns.T @ rest
        kept[name] = share
    scale = np.sqrt(np.diag(normal))
    step = np.linalg.lstsq(normal / np.outer(scale, scale), right / scale, rcond=1e-12)[0] / scale
    places = {
        name: float(share[1, -1] - share[1, :-1] @ step) if len(share) > 1 else 0.0 for name, share in kept.items()
    }
    return step, places


def held_out(law: ExactLaw, fitted: Left, record: str, dirty: Dirty) -> float:
    """Give the rms that the fitted law leaves of a recording held out, m or m/s².

    Zero and place of release are the recording's own. Raises RuntimeError where the run diverges.
    """
    own, place, rms = law.own[record][: dirty.free], 0.0, np.inf
    for _ in range(2):
        rest = _rest(law, fitted.changes, record, place, dirty)
        if not np.sqrt(np.mean(rest**2)) < rms:
            break
        rms = float(np.sqrt(np.mean(rest**2)))
        if own.shape[1] == 1:
            break
        place += float(np.linalg.lstsq(own, rest, rcond=1e-9)[0][1])
    return rms
