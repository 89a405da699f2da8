"""The free pieces of a recording whose rig is linear: those that the same modes explain down to the noise.

Short windows show modes (``subspace``). A set of modes is judged by all windows of the recording that it explains, each
with amplitudes and a constant of its own: runs of such windows are pieces, to which the modes are fitted together
(``damped_modes``). Of several sets that one is taken which is likeliest against a hand's smooth ways over the same
pieces. Nothing is asked of the number of cycles or of what stands around a piece.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..signals.odds import ABOVE_NOISE, BY_CHANCE, DECISIVE, SIGNIFICANT
from ..signals.registry import budget, numerics
from .damped_modes import Modes, fit_modes
from .hand import OF_MOVED, hand_leaves, to_place, to_state
from .limits import BEYOND, KNOWN, RINGS, SHARES
from .mode_shares import mode_shares
from .subspace import poles_of_windows

_A_CYCLE = numerics(24, "block means a cycle", why="a damped sine needs no more")
_FASTEST = numerics(np.pi / 3, "rad a block mean", why="what is faster is asked for in finer blocks")
_SHOWING = budget(
    (0.5, 1.0, 2.0, 4.0, 8.0, 16.0), "cycles", why="of windows that show modes, each length twice the next"
)
_ASKING = budget((8.0, 2.0, 0.5), "cycles", why="of windows that ask for modes, those that tell most first")
_WINDOWS, _POINTS = budget((32, 48), "windows, points", why="of each length")
_FOLLOWED = budget(2, "sets of modes", why="that windows of a length agree on")
_PATIENT = budget(6, "sets of modes", why="after which it is asked whether the matter is settled otherwise")
_ROUNDS = budget(2, "rounds", why="pieces and modes follow from one another; the best once more")
_MOST_MEANS = budget(2**16, "block means", why="whose windows are asked in a second")
_LEAST_SAMPLES = numerics(8, "samples", why="of a window beside those that its amplitudes take")
_SAME = numerics(0.003, "of ln omega and zeta", why="nearer modes lead to the same pieces")
_NEAR = numerics(0.1, "rad", why="windows of a cycle that differ by less show one set of modes")
_INSIDE = numerics((1 / 8, 1 / 4), "of a run, of a cycle", why="so far from its ends a run is free")
_GROWING = budget(8, "steps", why="of a piece that grows by as much again in each")
_SMALL = numerics(1e-9, "of the largest", why="columns, and a noise, that are none")


@dataclass(frozen=True, eq=False)
class SharedModes:
    """The free pieces of a recording and their modes.

    Attributes:
        pieces: (start, stop, audible) in samples; by the last it has come down to its noise, ``stop`` where it has not.
        omega, zeta: (K,) rad/s, and damping ratios, of those modes that stand out of the noise.
        main: which mode swings most.
        rate, rate_std: of its fall, 1/s.
        share: (K,) of the power of all pieces.
        errors: (3, K) standard errors of ln omega, zeta and share.
        evidence: logarithm of the odds that the pieces are free and not a hand's ways.
    """

    pieces: tuple[tuple[int, int, int], ...]
    omega: np.ndarray
    zeta: np.ndarray
    main: int
    rate: float
    rate_std: float
    evidence: float
    share: np.ndarray
    errors: np.ndarray


def shared_modes(
    x: np.ndarray,
    fs: float,
    noise: float,
    periods: Sequence[float],
    free: Sequence[tuple[int, int]] | None = None,
    settled: Callable[[float, int], bool] | None = None,
) -> SharedModes | None:
    """The free pieces of a response (n,) with so much white noise, and their modes; None if there are none.

    Args:
        x: samples.
        fs: their rate, Hz.
        noise: standard deviation of its white noise.
        periods: samples a cycle that it may have.
        free: start and stop of each piece, in samples, where they are known; None where they are to be found.
        settled: whether beside such evidence for so many modes no more need be sought.
    """
    best = _likeliest(x, noise, periods, free, settled)
    if best is None:
        return None
    search, found = best
    block = max(1, int(2 * np.pi / np.max(found.modes.omega) * search.block / _A_CYCLE))
    finer = _Search.of(x, noise, min(block, search.block))
    if finer is not None:  # edges as fine as the modes allow, and pieces that the first search was too coarse for
        again = finer.followed(found.modes.by_blocks(finer.block / search.block), found.share, free)
        if again is not None:
            search, found = finer, again
    return _in_samples(search, found, x.size, fs)


def _likeliest(
    x: np.ndarray,
    noise: float,
    periods: Sequence[float],
    free: Sequence[tuple[int, int]] | None,
    settled: Callable[[float, int], bool] | None,
) -> tuple[_Search, _Found] | None:
    """The set of modes with the most evidence, of all that windows show, or the first that leaves nothing to explain.

    With a hundredth of the motion to spare several modes explain a hand's way too.
    """
    best: tuple[_Search, _Found] | None = None
    every, tried = _Search.of(x, noise, 1), 0
    followed: list[tuple[float, Modes]] = []  # in radians a sample: what two lengths of window show is asked once
    for period in periods:
        search = _Search.of(x, noise, max(1, int(period / _A_CYCLE)))
        if search is None:
            continue
        for share, starts in zip(SHARES, search.starts(period / search.block), strict=True):
            for start in starts:
                left = share if start.count == 1 else 0.0
                if any(left == of and _is_near(start, modes, search.block) for of, modes in followed):
                    continue
                so_far = (best[1].evidence, best[1].modes.count) if best else (0.0, 0)
                if settled is not None and tried % _PATIENT == _PATIENT - 1 and settled(*so_far):
                    return best
                tried += 1
                found = search.followed(start, left, free)
                for modes in (start,) if found is None else (start, found.modes):
                    followed.append((left, modes.by_blocks(1 / search.block)))
                if found is not None and best is not None and found.modes.count > best[1].modes.count:
                    found = search.as_few(found, *best)
                if found is not None and (best is None or found.evidence > best[1].evidence):
                    best = search, found
                    by_sample = found.by(search.block)
                    if found.share == 0.0 and every is not None and every.is_explained(by_sample, search.block):
                        return best
    return best


@dataclass(frozen=True, eq=False)
class _Found:
    """Modes by the block mean, their pieces, the evidence for them, and what share of the motion they may leave."""

    modes: Modes
    pieces: list[tuple[int, int]]
    evidence: float
    share: float

    def by(self, block: int) -> _Found:
        """By the sample, where this is by means of so many."""
        modes = self.modes.by_blocks(1 / block)
        return replace(self, modes=modes, pieces=[(a * block, b * block) for a, b in self.pieces])


@dataclass(frozen=True, eq=False)
class _Search:
    """Block means (N,) about their median, their noise, and samples a block."""

    means: np.ndarray
    noise: float
    block: int

    @classmethod
    def of(cls, x: np.ndarray, noise: float, block: int) -> _Search | None:
        """Of samples (n,) with so much noise; None where there are too many or too few means."""
        count = x.size // block
        if not 2 * OF_MOVED <= count <= _MOST_MEANS:
            return None
        means = x[: count * block].reshape(count, block).mean(axis=1)
        return cls(means - np.median(means), max(noise / np.sqrt(block), _SMALL * float(np.ptp(x))), block)

    def starts(self, period: float) -> list[list[Modes]]:
        """Sets of modes that windows show: for each of ``SHARES``, of each length those that most others agree with."""
        starts: list[list[Modes]] = [[] for _ in SHARES]
        for cycles in _SHOWING[::-1]:
            length = round(cycles * period)
            thin = max(1, min(length // _POINTS, int(period * _FASTEST / (2 * np.pi))))
            length -= length % thin
            if length < 2 * OF_MOVED * thin or length > self.means.size or length // thin > 2**2 * _POINTS:
                continue
            places = np.unique(
                np.linspace(
                    0, self.means.size - length, min(_WINDOWS, 1 + 2**2 * (self.means.size - length) // length)
                ).astype(int)
            )
            windows = self.means[places[:, None] + np.arange(length)].reshape(places.size, -1, thin).mean(axis=2)
            for found, shown in zip(starts, poles_of_windows(windows, self.noise / np.sqrt(thin), SHARES), strict=True):
                for count in {omega.size for omega, _ in shown}:
                    some = [(omega / thin, zeta) for omega, zeta in shown if omega.size == count]
                    found += [s for s in _agreed(some, cycles) if self.block == 1 or np.max(s.omega) < _FASTEST]
        return starts

    def followed(self, modes: Modes, share: float, free: Sequence[tuple[int, int]] | None = None) -> _Found | None:
        """Pieces that modes explain, the modes that these share, and once more; of known pieces the modes alone."""
        pieces = [(-(-a // self.block), b // self.block) for a, b in free or ()]
        for _ in range(_ROUNDS if free is None else 1):
            if free is None:
                runs = self._runs(modes, share)
                pieces = [edges for run in runs if (edges := self._edges(modes, run, share)) is not None]
            if not pieces:
                return None
            modes = self._fitted(pieces, modes, share)
        evidence, kept = -modes.count * float(np.log(self.means.size)), []  # what the modes take to state
        for a, b in pieces:
            odds = self._odds(modes, a, b, share)
            if odds > DECISIVE:
                evidence, kept = evidence + odds, [*kept, (a, b)]
        if evidence < DECISIVE:
            return None
        modes = self._fit(kept, modes, share)
        return _Found(modes, kept, evidence, share) if _known(modes) else None

    def as_few(self, found: _Found, search: _Search, fewer: _Found) -> _Found:
        """What explains pieces likelier: the modes that were found, or the fewer that explain others of their own.

        An edge one block further on tells more than a mode: modes are weighed by the same samples.
        """
        pieces = [(a * self.block, b * self.block) for a, b in found.pieces]
        again = self.followed(fewer.modes.by_blocks(self.block / search.block), fewer.share, pieces)
        return found if again is None or again.evidence < found.evidence else again

    def _fitted(self, pieces: list[tuple[int, int]], modes: Modes, share: float) -> Modes:
        """The modes of pieces together; where they explain some alone, of those; none, of that which tells most.

        The other pieces are a hand's, or are none: they are asked again of better known modes.
        """
        fitted = self._fit(pieces, modes, share)
        theirs = [(a, b) for a, b in pieces if self._is_theirs(fitted, a, b, share)]
        if len(theirs) == len(pieces) or len(pieces) == 1:
            return fitted
        if theirs:
            return self._fit(theirs, fitted, share)
        alone = [self._fit([piece], modes, share) for piece in pieces]
        odds = [self._odds(own, a, b, share) for own, (a, b) in zip(alone, pieces, strict=True)]
        return alone[int(np.argmax(odds))]

    def _fit(self, pieces: list[tuple[int, int]], modes: Modes, share: float) -> Modes:
        parts = [self.means[a:b] for a, b in pieces]
        return fit_modes(parts, modes, [self.deviation(a, b, share) for a, b in pieces])[0]

    def _is_theirs(self, modes: Modes, a: int, b: int, share: float) -> bool:
        """Whether modes leave no more of a piece than they may."""
        from scipy.special import chdtri

        left, freedom = self._left(modes, a, b)
        most = float(chdtri(freedom, BY_CHANCE / (b - a))) if freedom > 0 else 0.0
        return freedom > 0 and left <= most * (ABOVE_NOISE * self.deviation(a, b, share)) ** 2

    def _steady(self, modes: Modes, a: int, b: int) -> np.ndarray:
        return self.means[a:b] - modes.drift * np.arange(b - a)

    def deviation(self, a: int, b: int, share: float) -> float:
        """Standard deviation of what modes may leave of the block means from a to b."""
        return float(np.hypot(self.noise, share * np.std(self.means[a:b])))

    def _runs(self, modes: Modes, share: float) -> list[tuple[int, int]]:
        """Runs of windows that the modes explain, those of many cycles first."""
        from scipy.special import chdtri

        runs: list[tuple[int, int]] = []
        taken = np.zeros(self.means.size, bool)
        sums, squares = (np.concatenate([[0.0], np.cumsum(self.means**power)]) for power in (1, 2))
        for cycles in _ASKING:
            length = max(round(cycles * modes.cycle), 2 * modes.count + _LEAST_SAMPLES)
            if length > self.means.size:
                continue
            columns = np.column_stack([modes.columns(length)[:, :-1], np.arange(length)])
            basis = _orthonormal(columns - np.mean(columns, axis=0))
            seen = np.stack([np.convolve(self.means, column[::-1], mode="valid") for column in basis.T])
            varied = squares[length:] - squares[:-length] - (sums[length:] - sums[:-length]) ** 2 / length
            left = varied - np.sum(seen**2, axis=0)
            freedom = length - 1 - basis.shape[1]
            unknown = min(2 * np.pi * modes.unknown * cycles, _NEAR)  # of the modes so far: radians over half a window
            limit = (
                self.noise**2 * float(chdtri(freedom, BY_CHANCE / self.means.size)) + (share**2 + unknown**2) * varied
            )
            fine = left < limit
            moves = varied > self.noise**2 * float(chdtri(length - 1, BY_CHANCE / self.means.size))
            for a, b in _runs_of(fine):
                for first, last in _runs_of(~taken[a : b + length - 1]) if np.any(moves[a:b]) else []:
                    if last - first >= length:
                        taken[a + first : a + last] = True
                        runs.append((a + first, a + last))
        return sorted(runs)

    def _edges(self, modes: Modes, run: tuple[int, int], share: float) -> tuple[int, int] | None:
        """First and last block mean of a run that its own fit explains; None where it explains too few.

        Where it explains few, the run holds more than one motion, for nearly known modes are asked for nearly only:
        the piece then grows from the part that the modes explain best, by as much again in a step.
        """
        a, b = run
        shy = round(min(_INSIDE[0] * (b - a), _INSIDE[1] * modes.cycle))
        edges = self._ends(modes, run, (a + shy, b - shy), share)
        seed = None if edges else self._seed(modes, run, share)
        for _ in range(_GROWING if seed else 0):
            assert seed is not None
            reach = (seed[1] - seed[0]) // 2
            around = (max(a, seed[0] - reach), min(b, seed[1] + reach))
            edges = self._ends(modes, around, seed, share)
            if edges is None or edges[1] - edges[0] <= seed[1] - seed[0]:
                break
            seed = edges
        return edges

    def _seed(self, modes: Modes, run: tuple[int, int], share: float) -> tuple[int, int] | None:
        """The short part of a run of which modes leave the smallest share; None where the run is as short."""
        length = max(round(_ASKING[-1] * modes.cycle), 2 * modes.count + _LEAST_SAMPLES)
        if length >= run[1] - run[0]:
            return None
        firsts = np.unique(np.linspace(run[0], run[1] - length, _WINDOWS).astype(int))
        windows = self.means[firsts[:, None] + np.arange(length)]
        basis = _orthonormal(np.column_stack([modes.columns(length), np.arange(length)]))
        left = np.sum((windows - (windows @ basis) @ basis.T) ** 2, axis=1)
        varied = np.sum((windows - np.mean(windows, axis=1, keepdims=True)) ** 2, axis=1)
        k = int(np.argmin(left / np.maximum(varied, length * self.noise**2)))
        return int(firsts[k]), int(firsts[k]) + length

    def _ends(
        self, modes: Modes, run: tuple[int, int], inside: tuple[int, int], share: float
    ) -> tuple[int, int] | None:
        """First and last block mean of a run that a fit to its inside explains; None where it explains too few.

        A block mean beyond two standard deviations is likelier something else's, where more such than others follow
        towards the edge; one more is left out, for what begins is smaller than the noise at first. By as much as the
        modes are unknown, what they make of the inside may turn or fall as time goes on.
        """
        a, b = run
        n, spread = b - a, self.deviation(*inside, share)
        first, last = inside[0] - a, inside[1] - a
        columns, steady = modes.columns(n), self._steady(modes, a, b)
        if modes.drift == 0.0:  # not known yet
            columns = np.column_stack([columns, np.arange(n)])
        size = 2 * float(np.std(steady[first:last]))
        omega = np.repeat(modes.omega, 2) * modes.unknown * size
        turning = modes.columns(n)[:, :-1] * (np.arange(n) - (first + last) / 2)[:, None] * omega / spread
        peaks = np.max(np.abs(modes.columns(n)[first:last, :-1]), axis=0)
        scale = np.linalg.norm(columns, axis=0)
        columns = np.hstack([columns / scale, turning / peaks])
        few = columns.shape[1] - scale.size
        known = np.hstack([np.zeros((few, scale.size)), np.eye(few)])
        basis, triangle = np.linalg.qr(np.vstack([columns[first:last], known]))
        if np.min(np.abs(np.diag(triangle))) < _SMALL:
            return None
        wide = np.linalg.solve(triangle.T, columns.T)  # what the fit to the inside does not know of the edges
        off = steady - wide.T @ (basis[: last - first].T @ steady[first:last])
        gain = BEYOND**2 - off**2 / (1.0 + np.sum(wide**2, axis=0)) / spread**2
        middle = (first + last) // 2
        before, after = np.cumsum(gain[middle::-1]), np.cumsum(gain[middle:])
        first, last = a + middle - int(np.argmax(before)), a + middle + int(np.argmax(after)) + 1
        first += first > 0
        last -= last < self.means.size
        least = 2 * modes.count + 4
        return (first, last) if last - first >= least else None

    def _odds(self, modes: Modes, a: int, b: int, share: float) -> float:
        """Logarithm of the odds that these modes made a piece and not a hand; minus infinity where neither did."""
        if not self._is_theirs(modes, a, b, share):
            return -np.inf
        spread = self.deviation(a, b, share)
        left, freedom = self._left(modes, a, b)
        piece = self._steady(modes, a, b) / spread
        odds = 0.5 * (hand_leaves(piece) - left / spread**2 - (b - a - freedom) * to_state(piece))
        return odds - to_place(self.means.size)

    def _left(self, modes: Modes, a: int, b: int) -> tuple[float, int]:
        """Sum of squares that modes leave of the block means from a to b, and its degrees of freedom."""
        piece, columns = self._steady(modes, a, b), _orthonormal(modes.columns(b - a))
        return float(np.sum((piece - columns @ (columns.T @ piece)) ** 2)), b - a - columns.shape[1]

    def is_explained(self, found: _Found, within: int) -> bool:
        """Whether modes leave of their pieces what the noise would, and nothing moves beside these and their edges."""
        from scipy.special import chdtri

        beside, left, freedom = np.ones(self.means.size - 1, bool), 0.0, 0
        for a, b in found.pieces:
            own, free = self._left(found.modes, a, b)
            left, freedom = left + own / self.noise**2, freedom + free
            beside[max(a - 1 - within, 0) : b + within] = False
        steps = np.diff(self.means)[beside]
        moved = float(np.sum(steps**2)) / (2.0 * self.noise**2)
        still = not steps.size or moved < float(chdtri(steps.size, BY_CHANCE)) * ABOVE_NOISE**2
        return still and freedom > 0 and left < float(chdtri(freedom, BY_CHANCE))

    def goes_on(self, modes: Modes, begun: int, weights: np.ndarray, a: int, b: int, share: float) -> bool:
        """Whether the block means from a to b are those of the motion that began before them, with such weights."""
        from scipy.special import chdtri

        expected = modes.columns(b - begun)[a - begun :, :-1] @ weights[:-1]
        off = self.means[a:b] - modes.drift * np.arange(b - a) - expected
        left = float(np.sum((off - np.mean(off)) ** 2)) / self.deviation(a, b, share) ** 2
        return left < float(chdtri(b - a, BY_CHANCE / (b - a))) * ABOVE_NOISE**2


def _known(modes: Modes) -> bool:
    """Whether all frequencies and the fall of one mode are known to a third: what falls by itself is free."""
    spread = np.sqrt(np.diag(modes.covariance))
    falls = spread[modes.count :] < KNOWN * modes.zeta
    # beside another mode, what is over within one sample is a sample of what was before, and no motion
    lasts = modes.count == 1 or bool(np.all((modes.zeta * modes.omega < 1.0) & (modes.zeta < RINGS)))
    known = lasts and np.any(falls) and np.all(spread[: modes.count] < KNOWN)
    return bool(known and np.all(modes.zeta > -spread[modes.count :]))


def _agreed(shown: list[tuple[np.ndarray, np.ndarray]], cycles: float) -> list[Modes]:
    """The sets of modes that most others are near, two at most."""
    from scipy.special import ndtri

    place = np.array([np.concatenate([np.log(omega), zeta]) for omega, zeta in shown])
    near = np.max(np.abs(place[:, None] - place[None]), axis=2) < _NEAR / max(cycles, 1.0)
    starts: list[Modes] = []
    open_ = np.ones(len(shown), bool)
    for _ in range(_FOLLOWED):
        votes = np.sum(near & open_[None], axis=1) * open_
        if not np.any(votes):
            break
        k = int(np.argmax(votes))
        some = place[near[k] & open_]
        middle = np.median(some, axis=0)
        scatter = np.median(np.abs(some - middle), axis=0) / ndtri(0.75)
        spread = np.maximum(scatter, _SAME / cycles)
        half = middle.size // 2
        starts.append(Modes(np.exp(middle[:half]), middle[half:], np.diag(spread**2)))
        open_ &= ~near[k]
    return starts


def _orthonormal(columns: np.ndarray) -> np.ndarray:
    """(n, r) orthonormal basis of the columns, those left out that the others hold."""
    scale = np.linalg.norm(columns, axis=0)
    left, sizes, _ = np.linalg.svd(columns[:, scale > 0] / scale[scale > 0], full_matrices=False)
    return left[:, sizes > _SMALL * sizes[0]]


def _runs_of(mask: np.ndarray) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _is_near(start: Modes, found: Modes, block: int) -> bool:
    """Whether modes by the block mean are those that were found, by the sample, as far as they are known."""
    if start.count != found.count:
        return False
    spread = 3 * np.sqrt(np.diag(start.covariance)) + _SAME
    apart = np.concatenate([np.log(start.omega / block / found.omega), start.zeta - found.zeta])
    return bool(np.all(np.abs(apart) < spread))


def _falls_otherwise(modes: Modes, seen: np.ndarray, main: int) -> bool:
    """Whether another mode is not told from the main one by its frequency: drag and friction bend a fall so.

    Two exponentials follow it, of one frequency but for what their damping takes off it.
    """
    apart = np.abs(np.log(modes.omega / modes.omega[main]))
    damped = np.abs(modes.zeta**2 - modes.zeta[main] ** 2)
    of_frequencies = modes.covariance[: modes.count, : modes.count]
    own = np.diag(of_frequencies)
    error = np.sqrt(np.maximum(own + own[main] - 2 * of_frequencies[main], 0.0))
    return bool(np.any((apart < damped + SIGNIFICANT * error)[seen & (np.arange(modes.count) != main)]))


def _in_samples(search: _Search, found: _Found, n: int, fs: float) -> SharedModes | None:
    """Pieces and modes by the sample and the second.

    A piece that is nowhere above its noise says nothing; one that goes on as the last one would have was not let go
    there: it is the rest of it.
    """
    modes, block = found.modes, search.block
    unit, rates = fs / block, modes.zeta * modes.omega
    floor = 2 * np.sqrt(2.0 * block) * search.noise
    edges, largest = [], np.zeros(modes.count)
    last = (0, np.zeros(0))  # where it began, and its weights
    for a, b in found.pieces:
        columns = modes.columns(b - a)
        scale = np.linalg.norm(columns, axis=0)
        weights = np.linalg.lstsq(columns / scale, search.means[a:b] - modes.drift * np.arange(b - a))[0] / scale
        sizes = np.hypot(*weights[:-1].reshape(-1, 2).T)
        goes_on = bool(edges) and search.goes_on(modes, *last, a, b, found.share)
        loud = np.flatnonzero(np.exp(-np.arange(b - a)[:, None] * rates) @ sizes > floor)
        if goes_on or (not loud.size and len(found.pieces) > 1):
            continue
        last = (a, weights)
        largest = np.maximum(largest, sizes)
        stop = n if b >= search.means.size else b * block
        audible = stop if not loud.size or loud[-1] == b - a - 1 else (a + int(loud[-1]) + 1) * block
        edges.append((a * block, stop, audible))
    if not edges:
        return None
    pieces = [search.means[a:b] for a, b in found.pieces]
    share, share_std = mode_shares(pieces, modes, [search.deviation(a, b, found.share) for a, b in found.pieces])
    main = int(np.argmax(np.nan_to_num(share)))  # not by its size at first: what is over at once has moved little
    rate_std = float(np.sqrt(modes.covariance[modes.count + main, modes.count + main]) * modes.omega[main]) * unit
    if not rate_std < KNOWN * rates[main] * unit:  # it may be driven, whatever rings beside it
        return None
    seen = (largest > floor) | (np.arange(modes.count) == main)
    if _falls_otherwise(modes, seen, main):
        return None
    omega, zeta, rate = modes.omega[seen] * unit, modes.zeta[seen], float(rates[main]) * unit
    main = int(np.count_nonzero(seen[:main]))
    errors = np.vstack([np.sqrt(np.diag(modes.covariance)).reshape(2, -1), share_std])[:, seen]
    return SharedModes(tuple(edges), omega, zeta, main, rate, rate_std, found.evidence, share[seen], errors)
