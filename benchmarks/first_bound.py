"""The Cramér-Rao bound of a recording of `first_population.py`, from the sensitivities of its true model.

Where each stretch begins, the sensor's offset and its drift where it has one are unknown too, and how a driving force
runs between its samples, which nobody says: where another hold explains the recording as well with other parameters,
no one can know which of them is the rig's. Noise on a recorded force is not counted: the bound is then lower than what
can be reached.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from dashpot.examples.oscillator import linear_pieces
from first_population import NAMES, Case, Stretch, moved
from scipy.interpolate import CubicSpline

#: Steps of the differences, as a part of what moves the rig by all of itself.
_STEP = 1e-5
#: What rings on below this part of the noise adds nothing, and friction that is tried there stops it again and again.
_UNSEEN = 0.03
#: Odds of a thousand to one rule a hold out.
_RULED_OUT = np.log(1000.0)


def bound(case: Case, names: Sequence[str] = NAMES) -> np.ndarray:
    """(modes, 6) least standard deviations of the named parameters of each mode, in SI; infinite where it tells none.

    Without a force there is no mass, and its row is infinite.
    """
    covariance = _covariance(case, names)
    return np.sqrt(np.maximum(np.diagonal(covariance), 0.0)).reshape(len(case.modes), len(NAMES))


def plain_errors(case: Case) -> tuple[float, float]:
    """Least relative standard deviations of frequency and damping of the first mode, amid its amplitudes.

    Those parameters are unknown that the rig has; the equivalent linear spring and damper at half the largest
    displacement (describing functions) are the frequency and the damping.
    """
    truth = case.modes[0]
    names = [name for name in NAMES if truth[name] or name == "viscous"]
    covariance = _covariance(case, names)[: len(NAMES), : len(NAMES)]
    size = 0.5 * float(np.max(np.abs(case.clean()[slice(*case.cut), 0])))
    if size == 0.0:  # what moved it was cut away
        return np.inf, np.inf

    def logarithms(values: np.ndarray) -> np.ndarray:
        p = dict(zip(NAMES, values, strict=True))
        spring = p["omega0"] ** 2 + 0.75 * p["cubic"] * size**2 + 4 * p["preload"] / (np.pi * size)
        damper = p["viscous"] + 4 * p["dry"] / (np.pi * size * np.sqrt(abs(spring)))
        return np.log([np.sqrt(abs(spring)), abs(damper)])

    at = np.array([truth[name] for name in NAMES])
    slopes = np.zeros((2, len(NAMES)))
    for name in names:
        k = NAMES.index(name)
        h = 1e-6 * _size(truth, name, 2 * size)
        up, down = (at + sign * h * (np.arange(len(NAMES)) == k) for sign in (1, -1))
        slopes[:, k] = (logarithms(up) - logarithms(down)) / (2 * h)
    used = [NAMES.index(name) for name in names if np.isfinite(covariance[NAMES.index(name), NAMES.index(name)])]
    if NAMES.index("omega0") not in used or NAMES.index("viscous") not in used:
        return np.inf, np.inf
    spread = slopes[:, used] @ covariance[np.ix_(used, used)] @ slopes[:, used].T
    return float(np.sqrt(spread[0, 0])), float(np.sqrt(spread[1, 1]))


def _size(truth: Mapping[str, float], name: str, size: float) -> float:
    """What changes the motion by all of itself."""
    omega = truth["omega0"]
    sizes = {"cubic": omega**2 / size**2, "preload": omega**2 * size, "dry": omega**2 * size, "viscous": omega}
    return sizes.get(name, truth[name])


def _covariance(case: Case, names: Sequence[str]) -> np.ndarray:
    """(6 modes, 6 modes) infinite on the diagonal for what the recording does not tell or is not asked."""
    level = ("displacement", "velocity", "acceleration").index(case.quantity)
    stretches = [part for part in (_kept(case, s) for s in case.stretches) if part is not None]
    places = [(m, name) for m in range(len(case.modes)) for name in names]
    infinite = np.diag(np.full(len(NAMES) * len(case.modes), np.inf))
    driven = any(stretch.pieces is not None for stretch in stretches)
    places = [(m, name) for m, name in places if driven or name != "mass"]
    if not stretches:
        return infinite
    noise = float(np.hypot(case.noise, case.step / np.sqrt(12)))
    rows, fine = [], []
    for index, stretch in enumerate(stretches):
        table, smooth = _sensitivity(case, stretch, places, level, index, len(stretches))
        rows.append(table[smooth])
        fine.append(smooth)
    jacobian = np.concatenate(rows) / noise
    scale = np.linalg.norm(jacobian, axis=0)
    keep = scale > 0
    asked = keep[: len(places)]
    _, sizes, right = np.linalg.svd(jacobian[:, keep] / scale[keep], full_matrices=False)
    if sizes.size == 0 or jacobian.shape[0] < np.count_nonzero(keep):
        return infinite
    inverse = right.T / np.maximum(sizes, 1e-9 * sizes[0]) ** 2 @ right / np.outer(scale[keep], scale[keep])
    inverse += _hold_unknown(case, stretches, jacobian[:, keep], inverse, fine, noise)
    result = infinite
    spots = [m * len(NAMES) + NAMES.index(name) for (m, name), told in zip(places, asked, strict=True) if told]
    result[np.ix_(spots, spots)] = inverse[: len(spots), : len(spots)]
    return result


def _hold_unknown(
    case: Case,
    stretches: Sequence[Stretch],
    jacobian: np.ndarray,
    covariance: np.ndarray,
    fine: Sequence[np.ndarray],
    noise: float,
) -> np.ndarray | float:
    """(k, k) mean square of how far the unknowns lie under each hold that the recording does not rule out.

    The law of total variance over models that are equally probable beforehand (Hoeting et al. 1999, equation 3). A
    hammer's force is what its sensor shows.
    """
    if case.kind == "hits" or not any(stretch.pieces is not None for stretch in stretches):
        return 0.0
    level = ("displacement", "velocity", "acceleration").index(case.quantity)
    moves = [np.zeros(len(covariance))]
    for hold in ("zero", "linear", "smooth"):
        if hold == case.hold:
            continue
        apart = []
        for stretch, smooth in zip(stretches, fine, strict=True):
            pieces = None if stretch.pieces is None else _held(stretch.pieces[:, 0], hold)
            there, here = (moved(case.modes, s, case.fs) for s in (replace(stretch, pieces=pieces), stretch))
            apart.append((there - here)[smooth, level] / noise)
        differs = np.concatenate(apart)
        step = covariance @ (jacobian.T @ differs)
        left = differs - jacobian @ step
        if 0.5 * float(left @ left) < _RULED_OUT:
            moves.append(step)
    steps = np.array(moves)
    return steps.T @ steps / len(steps)


def _held(force: np.ndarray, hold: str) -> np.ndarray:
    """Polynomials over each step, (n, terms), of a force under a hold."""
    if hold == "zero":
        return force[:, None]
    if hold == "linear":
        return np.vstack([linear_pieces(force), [[force[-1], 0.0]]])
    pieces = CubicSpline(np.arange(force.size), force).c[::-1].T
    return np.vstack([pieces, [[force[-1], 0.0, 0.0, 0.0]]])


def _kept(case: Case, stretch: Stretch) -> Stretch | None:
    """The part of a free or driven stretch that is left after the cut, beginning where it does."""
    first, last = max(stretch.start, case.cut[0]), min(stretch.stop, case.cut[1])
    if stretch.kind not in ("free", "driven") or last - first < 2:
        return None
    if stretch.pieces is None:
        level = ("displacement", "velocity", "acceleration").index(case.quantity)
        motion = np.abs(moved(case.modes, replace(stretch, stop=last), case.fs)[first - stretch.start :, level])
        seen = np.flatnonzero(motion > _UNSEEN * np.hypot(case.noise, case.step))
        if seen.size < 2:
            return None
        last = first + int(seen[-1]) + 1
    if first == stretch.start:
        pieces = None if stretch.pieces is None else stretch.pieces[: last - first]
        return replace(stretch, stop=last, pieces=pieces)
    before = replace(stretch, stop=first + 1)
    if stretch.pieces is not None:
        before = replace(before, pieces=stretch.pieces[: first + 1 - stretch.start])
    begin = []
    for mode, state in zip(case.modes, stretch.begin, strict=True):
        end = moved([mode], replace(before, begin=(state,)), case.fs)[-1]
        begin.append((float(end[0]), float(end[1])))
    pieces = None if stretch.pieces is None else stretch.pieces[first - stretch.start : last - stretch.start]
    return Stretch(first, last, stretch.kind, tuple(begin), pieces)


def _sensitivity(
    case: Case, stretch: Stretch, places: Sequence[tuple[int, str]], level: int, index: int, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """(n, parameters + states of all stretches + offset and drift) derivatives of what the sensor shows; (n,) where.

    Samples at which preload or friction point the other way after the step are no derivatives.
    """
    n, modes = stretch.stop - stretch.start, len(case.modes)
    here = moved(case.modes, stretch, case.fs)
    sides = np.sign(here[:, :2])
    size = max(float(np.max(np.abs(here[:, 0]))), 1e-12)
    table = np.zeros((n, len(places) + 2 * modes * count + 2))
    fine = np.ones(n, bool)
    has = {name for mode in case.modes for name in ("preload", "dry") if mode[name]} | {name for _, name in places}
    sharp = bool(has & {"preload", "dry"})
    for k, (m, name) in enumerate(places):
        h = _STEP * _size(case.modes[m], name, size)
        changed = [dict(mode) for mode in case.modes]
        changed[m][name] += h
        there = moved(changed, stretch, case.fs)
        table[:, k] = (there - here)[:, level] / h
        fine &= np.all(np.sign(there[:, :2]) == sides, axis=1) | (not sharp)
    if not stretch.known:
        for m in range(modes):
            for j in range(2):
                h = _STEP * size * (case.modes[m]["omega0"] if j else 1.0)
                begin = [list(state) for state in stretch.begin]
                begin[m][j] += h
                shifted = replace(stretch, begin=tuple((x, v) for x, v in begin))
                there = moved(case.modes, shifted, case.fs)
                table[:, len(places) + 2 * modes * index + 2 * m + j] = (there - here)[:, level] / h
                fine &= np.all(np.sign(there[:, :2]) == sides, axis=1) | (not sharp)
    table[:, -2] = 1.0 if case.offset else 0.0
    table[:, -1] = (np.arange(stretch.start, stretch.stop) - case.n / 2) / case.n if case.drift else 0.0
    return table, fine
