"""The law of the library that comes nearest to a learnt curve: where it lies within the band, which way it departs.

A law is fitted to the curve between two places, beside what Eq. 17 has of the same variable, by the curve's covariance
(generalised least squares, Aitken 1935; laws with a place or a width inside by variable projection, Golub and Pereyra
1973). Beyond a place the curve departs from it by a power of the distance, or by several: a spline rings about a bend,
and what it makes of one beyond a place shows before that place too. Of all laws and places between which the curve does
not contradict the law, that of the shortest description is the nearest (Rissanen 1978); Eq. 17 by itself is one of
them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..law import Scales
from ..parameter import Parameter
from ..units import compose
from .curve import LearntCurve
from .law_columns import Column, columns_for
from .search import contradicts, whitener_of

_POWERS = ((1,), (2,), (3,), (1, 2, 3))  # of the distance from a place: a bend, a parabola, a cubic, any of these
_NEAR = 24  # fits whose constants and places are sought beyond a grid, the shortest first
_STEP = 1e-4  # of a constant, for its derivative
_SHOWS = 2.0  # errors of the curve: less of a law within a range tells nothing of it
_RARELY = 0.03  # of the mean density: so often at least was the motion anywhere within the range
_NODES = 15  # of a density over the range of a curve, about as many as knots
_ALIKE = 1e-10  # of the power of a column: what it has beside others that say the same


@dataclass(frozen=True)
class NearestLaw:
    """The nearest law of a learnt curve.

    Attributes:
        effect: the learnt term.
        variable, times: as of ``LearntCurve``.
        law: its name in the library; empty where Eq. 17 by itself comes as near.
        low, high: between which it lies within the curve's band, in the variable's unit.
        reach: the largest value that was recorded, on both sides.
        below, above: ``more`` or ``less`` of a force than the law's beyond them; empty where nothing is beyond.
        parameters: of the law, fitted to the curve between.
    """

    effect: str
    variable: str
    times: str
    law: str
    low: float
    high: float
    reach: float
    below: str
    above: str
    parameters: Mapping[str, Parameter]

    @property
    def whole(self) -> bool:
        """Whether it lies within the band wherever something was recorded."""
        return not (self.below or self.above)


@dataclass(frozen=True, eq=False)
class _Target:
    """A curve in coordinates in which its errors are one each, and Eq. 17's columns over it."""

    at: np.ndarray
    whitener: np.ndarray
    value: np.ndarray
    std: np.ndarray
    base: np.ndarray
    scales: Scales

    @classmethod
    def of(cls, curve: LearntCurve) -> _Target:
        whitener = _as_recorded(curve.at, whitener_of(curve.covariance))
        reach = float(np.max(np.abs(curve.at)))
        scales = Scales(reach, 1.0, reach, reach, 1.0)  # of a speed the same: its unit of time is the second
        return cls(curve.at, whitener, whitener @ curve.value, curve.std, base_columns(curve), scales)

    def beyond(self, ends: tuple[int, int], powers: tuple[int, ...]) -> np.ndarray:
        """(n, k) what may depart beyond either end: powers of the distance from it; none where nothing is beyond."""
        depths = [np.maximum(self.at[ends[0]] - self.at, 0.0)] if ends[0] > 0 else []
        depths += [np.maximum(self.at - self.at[ends[1]], 0.0)] if ends[1] < self.at.size - 1 else []
        columns = [(depth / self.scales.length) ** power for depth in depths for power in powers]
        return np.column_stack(columns) if columns else np.zeros((self.at.size, 0))

    def pairs(self, knots: int) -> list[tuple[int, int]]:
        """Points between which a law may lie: all, and with either end or both inside, half a knot apart.

        Of what departs within the last knots nothing is told.
        """
        end, middle = self.at.size - 1, self.at.size // 2
        up = [end, *range(middle + knots, end - knots + 1, max(knots // 2, 1))]
        return [(end - low, high) for low in up for high in up]


def _as_recorded(at: np.ndarray, whitener: np.ndarray) -> np.ndarray:
    """(rank, n) a whitener that takes of a function what the fit of the curve did.

    A spline is fitted to a bend where the motion was, and rings about it accordingly. How often the motion was where
    follows from the covariance, whose inverse is the sum over that of the products of the spline's columns: a density
    (n,) that is straight between nodes and nowhere below zero makes it (Lawson and Hanson 1974, chapter 23).
    """
    from scipy.optimize import nnls

    errors = np.linalg.pinv(whitener)  # (n, rank): the curve's errors in its coordinates of one each
    nodes = np.linspace(at[0], at[-1], _NODES)
    straight = np.column_stack([np.interp(at, nodes, unit) for unit in np.eye(_NODES)])
    sums = np.einsum("nk,ni,nj->ijk", straight, errors, errors)
    weight, _ = nnls(sums.reshape(-1, _NODES), np.eye(errors.shape[1]).ravel())
    density = straight @ weight
    density = np.maximum(density, _RARELY * np.mean(density))  # else a law might do anything there
    # exactly the whitener for what the spline has, and for the rest as the density says
    inner = errors.T * density
    return np.linalg.solve(inner @ errors, inner)


def base_columns(curve: LearntCurve) -> np.ndarray:
    """(n, 1 or 2) what Eq. 17 has of the variable: a straight line and the cubic, or a viscous damping."""
    if curve.times:
        return np.ones((curve.at.size, 1))
    return np.column_stack([curve.at, curve.at**3]) if curve.variable == "x" else curve.at[:, None]


@dataclass(frozen=True, eq=False)
class _Fit:
    """A law fitted between two points of a curve, which departs beyond them.

    Attributes:
        column: the law.
        ends: the points.
        powers: of the distance, by which the curve departs.
        members: of Eq. 17 beside the law, the straight line first.
        inside: the law's constants but for its strength.
        left: squared distance from the curve in its covariance, of ``freedom`` degrees of freedom.
        length: of the description, in natural units of information.
    """

    column: Column
    ends: tuple[int, int]
    powers: tuple[int, ...]
    members: int
    inside: np.ndarray
    left: float
    freedom: int
    length: float

    @property
    def within(self) -> bool:
        """Whether the curve does not contradict it."""
        return not contradicts(self.left, self.freedom)


def nearest_law(curve: LearntCurve, unit: str) -> NearestLaw | None:
    """The nearest law of a learnt curve; None where no law, nor Eq. 17, lies within its band anywhere.

    Args:
        curve: a learnt curve with its covariance.
        unit: of the displacement.
    """
    target = _Target.of(curve)
    laws = [(column, column.grid(target.scales)) for column in columns_for(curve)]
    columns = [(column, grid, _whitened(target, column, grid)) for column, grid in laws]
    knots = max(round(curve.spacing / float(curve.at[1] - curve.at[0])), 1)
    tried = []
    for ends in target.pairs(knots):
        for powers in _POWERS if ends != (0, curve.at.size - 1) else ((),):
            for members in range(1, target.base.shape[1] + 1):
                tried += _tried(target, columns, ends, powers, members)
    near = sorted(tried, key=lambda fit: fit.length)
    kinds: dict[tuple[str, int, tuple[int, ...]], _Fit] = {}
    for fit in near:  # the best places of each law and kind of departure
        kinds.setdefault((fit.column.law.name if fit.column.law else "", fit.members, fit.powers), fit)
    finer = (_finer(target, fit, max(knots // 2, 1)) for fit in list(kinds.values())[:_NEAR])
    found = [fit for fit in finer if fit.within and _shows(target, fit) and _proper(target, fit)]
    return _told(curve, min(found, key=lambda fit: fit.length), unit, target) if found else None


def _whitened(target: _Target, column: Column, grid: np.ndarray) -> np.ndarray:
    """(rank, m) a law at each size of its grid (m, inside)."""
    made = np.column_stack([column.made(inside) for inside in grid])
    return target.whitener @ np.where(np.all(np.isfinite(made), axis=0), made, 0.0)


def _tried(
    target: _Target,
    columns: Sequence[tuple[Column, np.ndarray, np.ndarray]],
    ends: tuple[int, int],
    powers: tuple[int, ...],
    members: int,
) -> Iterator[_Fit]:
    """Each law at the best size of its grid, of a sign that it may have."""
    fixed = target.whitener @ np.hstack([target.base[:, :members], target.beyond(ends, powers)])
    basis = np.linalg.qr(fixed / np.maximum(np.linalg.norm(fixed, axis=0), 1e-300))[0]
    value = target.value - basis @ (basis.T @ target.value)
    end = target.at.size - 1
    # two ends that are alike are one constant, and how it departs is a further one
    places = len({ends[0], end - ends[1]} - {0}) + bool(powers)
    each = 0.5 * math.log(max(float(target.value @ target.value), math.e))  # told as finely as the curve
    for column, grid, white in columns:
        many = fixed.shape[1] + column.constants + places
        freedom = target.value.size - many
        if freedom <= 0:
            continue
        left, inside = float(value @ value), grid[0]
        if column.strength is not None:
            rest = white - basis @ (basis.T @ white)
            power, along = np.sum(rest**2, axis=0), rest.T @ value
            good = power > _ALIKE * np.sum(white**2, axis=0)
            if column.strength.lower >= 0.0:
                good &= along > 0.0
            gain = np.where(good, along**2 / np.where(good, power, 1.0), 0.0)
            best = int(np.argmax(gain))
            left, inside = left - float(gain[best]), grid[best]
        yield _Fit(column, ends, powers, members, inside, left, freedom, 0.5 * left + each * many)


def _finer(target: _Target, fit: _Fit, room: int) -> _Fit:
    """The constants inside solved for, and the ends moved point by point within ``room``, as near as they come."""
    whole = target.at.size - 1
    alike = fit.ends[0] == whole - fit.ends[1]
    best = _solved(target, fit)
    moved = [side for side in (0, 1) if fit.ends[side] not in (0, whole)]
    if alike and moved:
        steps = [(shift, -shift) for shift in range(-room, room + 1)]
    else:
        shifts = [range(-room, room + 1) if side in moved else (0,) for side in (0, 1)]
        steps = [(low, high) for low in shifts[0] for high in shifts[1]]
    grid = best.column, best.inside[None], _whitened(target, best.column, best.inside[None])
    near: list[_Fit] = []
    for low, high in steps:
        ends = fit.ends[0] + low, fit.ends[1] + high
        if 0 <= ends[0] < ends[1] <= whole and (not moved or ends != (0, whole)):
            near += _tried(target, [grid], ends, fit.powers, fit.members)
    return _solved(target, min([best, *near], key=lambda one: one.left))


def _solved(target: _Target, fit: _Fit) -> _Fit:
    """The same with the constants inside solved for."""
    from scipy.optimize import least_squares

    column = fit.column
    if not column.inside:
        return fit
    natural = np.array([p.natural(target.scales) for p in column.inside])
    low, high = (np.array([getattr(p, which) for p in column.inside]) for which in ("lower", "upper"))

    def left(inside: np.ndarray) -> np.ndarray:
        white, factors = _factors(target, replace(fit, inside=inside))
        return target.value - white @ factors

    most = {"bounds": (low, high), "x_scale": natural, "diff_step": _STEP, "max_nfev": 40}
    inside = least_squares(left, np.clip(fit.inside, low + 1e-9 * natural, high), **most).x
    found = replace(fit, inside=inside, left=float(np.sum(left(inside) ** 2)))
    return replace(found, length=fit.length + 0.5 * (found.left - fit.left)) if found.left < fit.left else fit


def _factors(target: _Target, fit: _Fit) -> tuple[np.ndarray, np.ndarray]:
    """Whitened columns of base, departure and law (rank, k), and their factors (k,)."""
    parts = [target.base[:, : fit.members], target.beyond(fit.ends, fit.powers)]
    if fit.column.strength is not None:
        parts.append(fit.column.made(fit.inside)[:, None])
    white = target.whitener @ np.hstack(parts)
    size = np.where((norm := np.linalg.norm(white, axis=0)) > 0, norm, 1.0)
    return white, np.linalg.lstsq(white / size, target.value, rcond=1e-10)[0] / size


def _force(target: _Target, fit: _Fit) -> np.ndarray:
    """(n,) the law by itself, without Eq. 17's part."""
    if fit.column.strength is None:
        return np.zeros(target.at.size)
    return _factors(target, fit)[1][-1] * fit.column.made(fit.inside)


def _shows(target: _Target, fit: _Fit) -> bool:
    """Whether anything of the law is seen between its ends that Eq. 17 does not have."""
    if fit.column.law is None:
        return True
    here = slice(fit.ends[0], fit.ends[1] + 1)
    base, force = target.base[here], _force(target, fit)[here]
    force = force - base @ np.linalg.lstsq(base, force, rcond=None)[0]
    return bool(np.any(np.abs(force) > _SHOWS * target.std[here]))


def _proper(target: _Target, fit: _Fit) -> bool:
    """Whether the law's values are what its name stands for, where another law has the same equation."""
    law, factors = fit.column.law, _factors(target, fit)[1]
    if law is None or law.proper is None or fit.column.strength is None:
        return True
    values = {parameter.name: 0.0 for parameter in law.parameters} | {fit.column.strength.name: float(factors[-1])}
    values |= {p.name: float(value) for p, value in zip(fit.column.inside, fit.inside, strict=True)}
    return law.proper(values, {"omega0": math.sqrt(max(float(factors[0]), 0.0))})


def _told(curve: LearntCurve, best: _Fit, unit: str, target: _Target) -> NearestLaw:
    at, law, low = curve.at, best.column.law, float(curve.at[best.ends[0]])
    made = target.base[:, : best.members] @ _factors(target, best)[1][: best.members] + _force(target, best)
    grows = (curve.value - made) * (1.0 if curve.times else np.sign(at))

    def way(where: slice) -> str:
        return "" if not at[where].size else "more" if float(np.sum(grows[where])) > 0 else "less"

    return NearestLaw(
        curve.effect,
        curve.variable,
        curve.times,
        "" if law is None else law.name,
        low,
        -low if best.ends[0] == at.size - 1 - best.ends[1] else float(at[best.ends[1]]),
        float(np.max(np.abs(at))),
        way(slice(0, best.ends[0])),
        way(slice(best.ends[1] + 1, at.size)),
        _parameters(target, best, unit),
    )


def _parameters(target: _Target, best: _Fit, unit: str) -> dict[str, Parameter]:
    """The law's constants with their errors by the curve's covariance."""
    column = best.column
    if column.strength is None:
        return {}
    white, factors = _factors(target, best)
    slopes = []
    for parameter, one in zip(column.inside, np.eye(len(column.inside)), strict=True):
        step = _STEP * parameter.natural(target.scales)
        more, less = (column.made(best.inside + sign * step * one) for sign in (1, -1))
        slopes.append(target.whitener @ (factors[-1] * (more - less) / (2 * step)))
    whole = np.column_stack([white, *slopes])
    size = np.where((norm := np.linalg.norm(whole, axis=0)) > 0, norm, 1.0)
    errors = np.sqrt(np.maximum(np.diag(np.linalg.pinv((whole / size).T @ (whole / size))), 0.0)) / size
    values = np.array([factors[-1], *best.inside])
    return {
        p.name: Parameter(float(value), float(error), compose(p.unit, unit))
        for p, value, error in zip((column.strength, *column.inside), values, errors[factors.size - 1 :], strict=True)
    }
