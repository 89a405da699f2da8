"""One structure of an element fitted to prescribed motions: strengths by linear least squares, the rest around them.

All strengths and members are linear in the force, so that only places, limits, speeds and exponents are searched for
(variable projection: Golub, Pereyra 1973). Each recording has a constant of its own, as load cells are set to zero anew
for each test. Recordings count by what is left in each of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..identify.problem.limits import FENCE
from ..identify.signals.noise_spectrum import concentrated_likelihood, estimate
from ..identify.signals.registry import budget, numerics
from ..model.element import INERTIA, MEMBERS
from ..model.law import Law, LawParameter, Scales
from .channels import Span, Way, column_of
from .columns import TURN, of_law, of_members
from .motion import Imposed

#: Members that may be fitted beside a constant, in the order of the file.
FITTED = (INERTIA, *(p.name for law in MEMBERS[:-1] for p in law.parameters))
#: Those that cannot be negative: no mass is, and nothing passive feeds the motion.
POSITIVE = frozenset((INERTIA, "viscous", "dry"))
_TRIES = budget(60, "evaluations", why="of each search around the strengths: three to six numbers settle in thirty")
_STEP = numerics(1e-4, "of a logarithm, or a natural size", why="of a difference quotient of columns")
_INSIDE = numerics(1e-6, "of a logarithm, or a natural size", why="a search between bounds begins within them")
_SETTLED = numerics(1e-5, "part of the power", why="the search is over: a thousandth of a decision")
_FARTHEST = numerics(300.0, "of a logarithm", why="beyond it a number overflows")
_ENOUGH = budget(6000, "samples", why="by which laws are compared at their probes; all are fitted to all")
_FINEST = numerics(1e-12, "of a column", why="rounding")
_LOST = numerics(10.0, "times what is left", why="where a law makes no force: the search turns back")
_KEPT = budget(6, "columns", why="of a law along a motion, which a search comes back to")
_ROUNDS = numerics(2, "times", why="recordings are weighed anew: levels then stay within a hundredth")


@dataclass(frozen=True)
class Shape:
    """What a fit looks for.

    Attributes:
        members: names of members beside the constant.
        laws: further laws.
        freed: names EFFECT.PARAMETER of shapes that are fitted too.
        ways: in which strengths depend on channels, one for each pair of those at most.
    """

    members: tuple[str, ...] = FITTED
    laws: tuple[Law, ...] = ()
    freed: frozenset[str] = frozenset()
    ways: tuple[Way, ...] = ()

    @property
    def causes(self) -> int:
        """Laws and dependences: what was named beside the members."""
        return len(self.laws) + len(self.ways)

    def strengths(self) -> list[str]:
        """Names of members and of the laws' strengths, in the order of the columns."""
        return [*self.members, *(f"{law.name}.{p.name}" for law in self.laws for p in law.parameters if p.strength)]

    def linear(self) -> list[str]:
        """Names of everything that the force is linear in: strengths, then slopes by channels."""
        return [*self.strengths(), *(way.name for way in self.ways if way.how == "linear")]

    def placed(self) -> list[tuple[str, LawParameter]]:
        """Parameters that are searched for, with their names."""
        made = []
        for law in self.laws:
            for p in law.parameters:
                name = f"{law.name}.{p.name}"
                if not (p.strength or p.scale) and (not p.shape or name in self.freed):
                    made.append((name, p))
        return made + [(way.name, p) for way in self.ways if (p := way.placed()) is not None]


@dataclass(frozen=True, eq=False)
class Fitted:
    """A structure fitted.

    Attributes:
        shape: its structure.
        values: members but the load, and parameters, by name.
        constants: (recordings,) of each recording.
        residuals: of each recording (n,), zero where nothing is told.
        likelihood: log-likelihood concentrated over the noise spectra (Whittle 1953).
        power: mean of the squares that are left, each recording by its part of its own force.
    """

    shape: Shape
    values: Mapping[str, float]
    constants: tuple[float, ...]
    residuals: tuple[np.ndarray, ...]
    likelihood: float
    power: float
    held: tuple[np.ndarray, ...] = field(default=())

    @property
    def names(self) -> tuple[str, ...]:
        """The laws' names, and what depends on channels."""
        return (*(law.name for law in self.shape.laws), *map(str, self.shape.ways))

    @property
    def count(self) -> int:
        """Parameters that were fitted, constants not among them."""
        return len(self.shape.linear()) + len(self.shape.placed())


class Problem:
    """Prescribed motions and what is fitted to their forces.

    Args:
        motions: to fit to.
        held: motions that nothing is fitted to.
        origin: displacement that laws count from.
        turn: how far inner states go in a step, see ``columns``.
        spans: of the channels, by name.
    """

    def __init__(
        self,
        motions: Sequence[Imposed],
        held: Sequence[Imposed],
        origin: float,
        turn: float = TURN,
        spans: Mapping[str, Span] | None = None,
    ) -> None:
        self.spans = dict(spans or {})
        self.motions, self.held, self.origin, self.turn = tuple(motions), tuple(held), origin, turn
        self._members: dict[int, np.ndarray] = {}
        self._laws: dict[tuple[str, int], dict[tuple[float, ...], np.ndarray]] = {}
        self._doubted: dict[int, Imposed] = {}
        length = max(float(np.max(np.abs(m.displacement - origin))) for m in motions)
        pace = float(np.median([m.pace for m in motions]))
        force = max(float(np.max(np.abs(m.force))) for m in motions)
        self.scales = Scales(length, pace, force, length, max(m.n * m.dt for m in motions))
        self._sizes = np.array([float(np.std(m.force[m.told])) for m in motions])

    def doubted(self, i: int) -> Imposed:
        """A motion as polynomials of another order have it."""
        if i not in self._doubted:
            self._doubted[i] = self.motions[i].doubted()
        return self._doubted[i]

    @property
    def points(self) -> int:
        """Samples that are fitted."""
        return sum(int(np.count_nonzero(m.told)) for m in self.motions)

    def fit(self, shape: Shape, begun: Mapping[str, float]) -> Fitted | None:
        """The best of a structure next to where its places begin; None where no force comes of it.

        Args:
            shape: its structure.
            begun: EFFECT.PARAMETER of every law's parameters but its strengths, and of a dependence that is placed.
        """
        placed = shape.placed()
        known = {name: value for name, value in begun.items() if "." in name}
        place = np.array([_inward(p, known[name], self.scales) for name, p in placed])
        weights, found = 1.0 / self._sizes, None
        for _ in range(_ROUNDS):
            place = self._searched(shape, known, placed, place, weights) if placed else place
            found = self._solved(shape, self._at(known, placed, place), weights)
            if found is None:
                return None
            left = [float(np.sqrt(np.mean(r[m.told] ** 2))) for r, m in zip(found.residuals, self.motions, strict=True)]
            weights = 1.0 / np.maximum(left, [m.noise for m in self.motions])
            if len(weights) == 1:
                break
        return found

    def probed(
        self, shape: Shape, values: Mapping[str, float], law: Law, probes: Sequence[Mapping[str, float]]
    ) -> Iterator[tuple[Mapping[str, float], float]]:
        """The power that a structure with one law more leaves at probes of that, everything linear free.

        Of what is there the columns are made once. Of a long motion some samples tell enough.

        Args:
            shape: what is there.
            values: of its places.
            law: one more.
            probes: its parameters by name.
        """
        places = [np.flatnonzero(m.told)[:: max(1, m.n * len(self.motions) // _ENOUGH)] for m in self.motions]
        weights = 1.0 / self._sizes
        there, wanted = [], []
        for motion, place, weight in zip(self.motions, places, weights, strict=True):
            columns = self.columns(shape, values, motion)[:, place]
            there.append(weight * (columns - columns.mean(axis=1, keepdims=True)))
            wanted.append(weight * (motion.force[place] - motion.force[place].mean()))
        basis, force = basis_of(np.concatenate(there, axis=1)), np.concatenate(wanted)
        force = force - basis @ (basis.T @ force)
        bounded = np.array([p.lower >= 0.0 for p in law.parameters if p.strength])
        for probe in probes:
            own = []
            for motion, place, weight in zip(self.motions, places, weights, strict=True):
                columns = of_law(law, probe, motion, self.origin, self.turn)[:, place]
                own.append(weight * (columns - columns.mean(axis=1, keepdims=True)))
            rows = np.concatenate(own, axis=1)
            with np.errstate(over="ignore", invalid="ignore"):
                finite = np.isfinite(np.sum(rows**2))
            if not finite:
                continue
            rows = rows - (rows @ basis) @ basis.T
            left = force - _bounded(rows @ rows.T, rows @ force, bounded) @ rows
            yield probe, float(np.mean(left**2))

    def _at(
        self, known: Mapping[str, float], placed: Sequence[tuple[str, LawParameter]], place: np.ndarray
    ) -> dict[str, float]:
        return dict(known) | {
            name: _outward(p, float(where), self.scales) for (name, p), where in zip(placed, place, strict=True)
        }

    def _searched(
        self,
        shape: Shape,
        known: Mapping[str, float],
        placed: Sequence[tuple[str, LawParameter]],
        place: np.ndarray,
        weights: np.ndarray,
    ) -> np.ndarray:
        """Where the places leave the least, by steps of Gauss and Newton on the projected residual."""
        from scipy.optimize import least_squares

        size = sum(int(np.count_nonzero(m.told)) for m in self.motions)

        def left(where: np.ndarray) -> np.ndarray:
            found = self._solved(shape, self._at(known, placed, where), weights)
            if found is None:
                return np.full(size, _LOST)
            parts = zip(found.residuals, self.motions, weights, strict=True)
            return np.concatenate([w * r[m.told] for r, m, w in parts])

        ends = np.array([[_inward(p, end, self.scales) for end in _limits(p, self.scales)] for _, p in placed]).T
        inside = np.clip(place, ends[0] + _INSIDE, ends[1] - _INSIDE)
        how = {"diff_step": _STEP, "xtol": 1e-6, "ftol": _SETTLED, "max_nfev": _TRIES, "bounds": (ends[0], ends[1])}
        outcome = least_squares(left, inside, **how)
        return outcome.x if np.all(np.isfinite(outcome.x)) else place

    def columns(self, shape: Shape, values: Mapping[str, float], motion: Imposed) -> np.ndarray:
        """(members + strengths, n) along a motion; without the constant."""
        if id(motion) not in self._members:
            self._members[id(motion)] = of_members(motion, FITTED, self.origin)
        rows = [self._members[id(motion)][[FITTED.index(name) for name in shape.members]]]
        for law in shape.laws:
            own = {p.name: values[f"{law.name}.{p.name}"] for p in law.parameters if not p.strength}
            rows.append(self._of_law(law, own, motion))
        return self._by_channels(shape, values, motion, np.vstack(rows))

    def _of_law(self, law: Law, own: Mapping[str, float], motion: Imposed) -> np.ndarray:
        """Columns of a law, the latest kept: a search moves one number of one law at a time."""
        known = self._laws.setdefault((law.name, id(motion)), {})
        at = tuple(own.values())
        if at not in known:
            if len(known) >= _KEPT:
                del known[next(iter(known))]
            known[at] = of_law(law, own, motion, self.origin, self.turn)
        return known[at]

    def _by_channels(self, shape: Shape, values: Mapping[str, float], motion: Imposed, rows: np.ndarray) -> np.ndarray:
        """(linear, n) of the columns (strengths, n), as they depend on channels."""
        names, slopes = shape.strengths(), []
        for way in sorted(shape.ways, key=lambda way: way.how == "linear"):  # factors are those of slopes too
            plain = np.ones(motion.n) if way.of == "load" else rows[names.index(way.of)]
            made = column_of(way, self.spans[way.channel], plain, motion, values.get(way.name, 0.0))
            if way.how == "linear":
                slopes.append(made)
            else:
                rows[names.index(way.of)] = made
        return np.vstack([rows, *slopes])

    def apart(
        self, shape: Shape, values: Mapping[str, float], asked: Sequence[tuple[str, str]]
    ) -> list[tuple[float, tuple[str, str]]]:
        """The power that is left where a strength may change with a channel and its square, of each such pair.

        Args:
            shape: what is there.
            values: of its places.
            asked: strengths, and the channel for each.
        """
        names, weights = shape.strengths(), 1.0 / self._sizes
        places = [np.flatnonzero(m.told)[:: max(1, m.n * len(self.motions) // _ENOUGH)] for m in self.motions]
        there, wanted, plain = [], [], []
        for motion, place, weight in zip(self.motions, places, weights, strict=True):
            columns = self.columns(shape, values, motion)[:, place]
            there.append(weight * (columns - columns.mean(axis=1, keepdims=True)))
            wanted.append(weight * (motion.force[place] - motion.force[place].mean()))
            plain.append(columns)
        basis, force = basis_of(np.concatenate(there, axis=1)), np.concatenate(wanted)
        force = force - basis @ (basis.T @ force)
        made = []
        for of, channel in asked:
            own, span = [], self.spans[channel]
            for motion, place, weight, columns in zip(self.motions, places, weights, plain, strict=True):
                apart = (motion.channels[channel][place] - span.reference) / span.half
                column = np.ones(apart.size) if of == "load" else columns[names.index(of)]
                both = np.array([column * apart, column * apart**2])
                own.append(weight * (both - both.mean(axis=1, keepdims=True)))
            rows = np.concatenate(own, axis=1)
            size = np.linalg.norm(rows, axis=1)
            rows = rows - (rows @ basis) @ basis.T
            rows = rows[np.linalg.norm(rows, axis=1) > _FINEST * np.maximum(size, np.finfo(float).tiny)]
            more = basis_of(rows) if len(rows) else np.zeros((force.size, 0))
            made.append((float(np.mean((force - more @ (more.T @ force)) ** 2)), (of, channel)))
        return sorted(made)

    def _solved(self, shape: Shape, values: Mapping[str, float], weights: np.ndarray) -> Fitted | None:
        """The strengths that leave the least at these places; those at a bound that they would leave stay there."""
        parts = [self.columns(shape, values, motion) for motion in self.motions]
        with np.errstate(over="ignore"):
            finite = all(np.isfinite(np.sum(columns**2)) for columns in parts)
        if not finite:  # a law ran away, or to where none of its strength is of any size
            return None
        names = shape.linear()
        lower = {f"{law.name}.{p.name}": p.lower for law in shape.laws for p in law.parameters if p.strength}
        bounded = [name in POSITIVE or lower.get(name, -math.inf) >= 0.0 for name in names]
        normal, gradient, centred = np.zeros((len(names),) * 2), np.zeros(len(names)), []
        for columns, motion, weight in zip(parts, self.motions, weights, strict=True):
            told = motion.told
            mean, force = columns[:, told].mean(axis=1), motion.force[told]
            own = weight * (columns[:, told] - mean[:, None])
            normal += own @ own.T
            gradient += own @ (weight * (force - force.mean()))
            centred.append((mean, float(force.mean())))
        strengths = _bounded(normal, gradient, np.array(bounded, bool))
        constants = tuple(middle - float(strengths @ mean) for mean, middle in centred)
        residuals = []
        for columns, motion, constant in zip(parts, self.motions, constants, strict=True):
            left = motion.force - strengths @ columns - constant
            left[~motion.told] = 0.0
            residuals.append(left)
        made = dict(values) | dict(zip(names, map(float, strengths), strict=True))
        power = float(np.mean([np.mean(r[m.told] ** 2) / s**2 for r, m, s in self._each(residuals)]))
        return Fitted(shape, made, constants, tuple(residuals), math.nan, power)

    def _each(self, residuals: Sequence[np.ndarray]) -> list[tuple[np.ndarray, Imposed, float]]:
        return list(zip(residuals, self.motions, self._sizes.tolist(), strict=True))

    def weighed(self, fitted: Fitted) -> Fitted:
        """The same with its likelihood, and what it leaves of the motions that nothing was fitted to."""
        spectra = [
            estimate(r, None, float(np.mean(m.told))) for r, m in zip(fitted.residuals, self.motions, strict=True)
        ]
        held = []
        for motion in self.held:
            strengths = self.strengths(fitted)
            left = motion.force - strengths @ self.columns(fitted.shape, fitted.values, motion)
            left -= float(np.mean(left[motion.told]))
            left[~motion.told] = 0.0
            held.append(np.where(np.isfinite(left), left, np.inf))
        return replace(fitted, likelihood=concentrated_likelihood(spectra), held=tuple(held))

    def strengths(self, fitted: Fitted) -> np.ndarray:
        """(linear,) in the order of the columns."""
        return np.array([fitted.values[name] for name in fitted.shape.linear()])


def basis_of(rows: np.ndarray) -> np.ndarray:
    """(n, m) orthonormal basis of rows (k, n)."""
    size = np.linalg.norm(rows, axis=1)
    rows = rows[size > 0.0] / size[size > 0.0, None]
    if not rows.size:
        return np.zeros((rows.shape[1], 0))
    values, vectors = np.linalg.eigh(rows @ rows.T)
    kept = values > _FINEST * values[-1]
    return rows.T @ (vectors[:, kept] / np.sqrt(values[kept]))


def _bounded(normal: np.ndarray, gradient: np.ndarray, bounded: np.ndarray) -> np.ndarray:
    """(k,) least squares with some unknowns not below zero (active set: Lawson, Hanson 1974)."""
    size = np.sqrt(np.maximum(np.diag(normal), np.finfo(float).tiny))
    scaled, wanted = normal / np.outer(size, size), gradient / size
    kept = np.ones(size.size, bool)
    values = np.zeros(size.size)
    for _ in range(2 * size.size + 1):
        values = np.zeros(size.size)
        if np.any(kept):
            values[kept] = np.linalg.lstsq(scaled[np.ix_(kept, kept)], wanted[kept], rcond=1e-12)[0]
        below = kept & bounded & (values < 0.0)
        if not np.any(below):
            break
        kept[np.argmin(np.where(below, values, 0.0))] = False
    return values / size


def _is_logged(p: LawParameter) -> bool:
    """Whether a place is searched for by its logarithm: one that can only be positive."""
    probes = () if isinstance(p.probes, str) else p.probes
    return p.lower >= 0.0 and bool(probes) and min(probes) > 0.0


def _inward(p: LawParameter, value: float, scales: Scales) -> float:
    """A place as it is searched for: its logarithm, or in its natural size."""
    return math.log(max(value, np.finfo(float).tiny)) if _is_logged(p) else value / p.natural(scales)


def _limits(p: LawParameter, scales: Scales) -> tuple[float, float]:
    """The law's own bounds; of onsets and speeds ten times beyond its probes at most: see ``Structure``."""
    low, high = p.lower, p.upper
    if not p.shape and p.unit != "1" and not isinstance(p.probes, str) and p.probes:
        size = p.natural(scales)
        least, most = min(map(abs, p.probes)) * size / FENCE, max(map(abs, p.probes)) * size * FENCE
        low, high = (max(low, least), min(high, most)) if _is_logged(p) else (max(low, -most), min(high, most))
    return low, high


def _outward(p: LawParameter, where: float, scales: Scales) -> float:
    """Back, within the limits."""
    low, high = _limits(p, scales)
    value = math.exp(min(where, _FARTHEST)) if _is_logged(p) else where * p.natural(scales)
    return float(min(max(value, low), high))
