"""The Cramér-Rao bound of Eq. 17's parameters, by an integrator and a filter that share no code with the package.

Noise on the recorded force drives no rig: the motion is that of the true force, which is a nuisance at every sample.
Eliminated, it leaves the sensor's white noise and that of the force as the rig passes it on along its motion. A Kalman
filter of the linearised rig makes that white, event by event, so that the bound holds at every amplitude of a sweep.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH

NAMES = tuple(TRUTH)
#: Steps of the differences, as a part of what moves the rig by all of itself; the integrator is exact to rounding.
_STEP = 1e-5


@dataclass(frozen=True, eq=False)
class Record:
    """A record of a rig: force in N as polynomials over each step, (n, terms), and the motion that it begins with.

    ``rests``: whether that is known to whoever identifies the rig.
    """

    name: str
    pieces: np.ndarray
    begin: tuple[float, float]
    fs: float
    driven: bool
    rests: bool = False


def motion(truth: Mapping[str, float], record: Record) -> tuple[np.ndarray, np.ndarray]:
    """Displacement and velocity, both (n,) in SI, exact."""
    n = len(record.pieces)
    x, v = integrate_pieces(truth, record.pieces, 1 / record.fs, *record.begin)
    return x[:n], v[:n]


def acceleration(truth: Mapping[str, float], record: Record, x: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(n,) m/s² of a motion; 0 where it turns or is held."""
    spring = truth["omega0"] ** 2 * x + truth["cubic"] * x**3 + truth["preload"] * np.sign(x)
    moving = record.pieces[:, 0] / truth["mass"] - spring - truth["viscous"] * v - truth["dry"] * np.sign(v)
    return np.where(v == 0.0, 0.0, moving)


def shown(truth: Mapping[str, float], record: Record, quantity: str) -> np.ndarray:
    """(n,) of the motion, exact, in SI."""
    x, v = motion(truth, record)
    return {"displacement": x, "velocity": v}.get(quantity, acceleration(truth, record, x, v))


def bound(
    truth: Mapping[str, float],
    records: Sequence[Record],
    noise: float,
    names: Sequence[str] = NAMES,
    *,
    quantity: str = "displacement",
    force_noise: Sequence[float] | None = None,
) -> np.ndarray:
    """(6,) least standard deviations of the named parameters, in SI; 0 for others.

    All that a fit estimates are named, also those that are zero in truth: which they are it does not know.

    Args:
        truth: parameters in SI.
        records: of the rig.
        noise: standard deviation of the sensor's white noise.
        names: of what is estimated.
        quantity: what the records show.
        force_noise: standard deviation of the noise on the samples of each record's force, N; none where None.
    """
    information = np.zeros((len(NAMES), len(NAMES)))
    for record, disturbed in zip(records, force_noise or [0.0] * len(records), strict=True):
        information += _information(truth, record, quantity, noise, disturbed)
    known = [NAMES.index(name) for name in names]
    scale = np.sqrt(np.diag(information)[known])
    found = np.zeros(len(NAMES))
    found[known] = np.sqrt(np.diag(np.linalg.inv(information[np.ix_(known, known)] / np.outer(scale, scale)))) / scale
    return found


def _information(
    truth: Mapping[str, float], record: Record, quantity: str, noise: float, force_noise: float
) -> np.ndarray:
    """(6, 6) what a record says of the parameters, the motion that it begins with eliminated where it is unknown."""
    x, v = motion(truth, record)
    size = max(float(abs(x).max()), 1e-12)
    largest = {"cubic": 0.1 * truth["omega0"] ** 2 / size**2, "mass": truth["mass"]}
    sizes = [largest.get(name, abs(truth[name]) or 1e-3 * truth["omega0"] ** 2 * size) for name in NAMES]
    steps = _STEP * np.array([*sizes, size, size * truth["omega0"]])

    def moved(k: int, by: float) -> tuple[np.ndarray, np.ndarray]:
        there, begin = dict(truth), list(record.begin)
        if k < len(NAMES):
            there[NAMES[k]] += by
        else:
            begin[k - len(NAMES)] += by
        changed = replace(record, begin=(begin[0], begin[1]))
        x, v = motion(there, changed)
        return shown(there, changed, quantity), np.sign(x) + 2 * np.sign(v)

    # forwards only: preload and friction may be zero, and not less
    here, sides = moved(0, 0.0)
    ways = [moved(k, h) for k, h in enumerate(steps)]
    jacobian = np.column_stack([(way[0] - here) / h for way, h in zip(ways, steps, strict=True)])
    if record.driven and force_noise:
        if quantity != "displacement":
            raise ValueError("the bound with noise on the force is that of a displacement")
        jacobian = _whitened(jacobian, _transitions(truth, record, x, v), truth["mass"], record.fs, noise, force_noise)
    else:  # a sample that falls on the other side of a jump is no derivative
        jacobian = jacobian[np.all([way[1] == sides for way in ways], axis=0)] / noise
    full = jacobian.T @ jacobian
    own = full[6:, :6] * (not record.rests)
    return full[:6, :6] - own.T @ np.linalg.pinv(full[6:, 6:]) @ own


def _transitions(truth: Mapping[str, float], record: Record, x: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(n, 2, 2) by how much a small change of the state at each sample is one at the next.

    The linearised equation between events; at an event the saltation matrix (Aizerman and Gantmacher 1958).
    """
    dt = 1 / record.fs
    along = np.zeros((x.size, 2, 2))
    along[:, 0, 1] = dt
    along[:, 1, 0] = -dt * (truth["omega0"] ** 2 + 3 * truth["cubic"] * x**2)
    along[:, 1, 1] = -dt * truth["viscous"]
    matrix, term = np.eye(2) + along, along
    for k in range(2, 6):
        term = term @ along / k
        matrix = matrix + term
    a = np.abs(acceleration(truth, record, x, v))
    crossed = np.flatnonzero(x[1:] * x[:-1] < 0)
    jump = np.tile(np.eye(2), (crossed.size, 1, 1))
    jump[:, 1, 0] = -2 * truth["preload"] / np.abs(v[crossed])
    matrix[crossed] = jump @ matrix[crossed]
    turned = np.flatnonzero(v[1:] * v[:-1] < 0)
    matrix[turned, 1] *= (np.maximum(a[turned] - 2 * truth["dry"], 0.0) / a[turned])[:, None]
    matrix[v == 0.0, 1] = 0.0  # held
    return matrix


def _whitened(
    rows: np.ndarray, along: np.ndarray, mass: float, fs: float, noise: float, force_noise: float
) -> np.ndarray:
    """(n, k) derivatives of a displacement, each less what those before say of it, over its standard deviation."""
    push = force_noise / mass * np.array([0.5 / fs**2, 1 / fs])
    pushed = np.outer(push, push)
    state, spread = np.zeros((2, rows.shape[1])), np.zeros((2, 2))
    white = np.empty_like(rows)
    for i, row in enumerate(rows):
        variance = spread[0, 0] + noise**2
        gain = spread[:, 0] / variance
        left = row - state[0]
        white[i] = left / np.sqrt(variance)
        state = along[i] @ (state + np.outer(gain, left))
        spread = along[i] @ (spread - np.outer(gain, spread[0])) @ along[i].T + pushed
    return white
