"""A free piece grown as far as its own fit foretells what lies beside it.

What the fit foretells of the samples that follow, with what it does not know of them, is held against what was
measured; so is, with time reversed, what came before. Each time the fit is made anew, and it decides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from ..signals.registry import budget, numerics
from .limits import BEYOND
from .rig_fit import LEAST_SAMPLES, Piece, Record, Rig, fit_piece, holds, prior, state_after

_ROUNDS = budget(8, "rounds", why="each as long again as the piece so far")
_INSIDE = numerics((1 / 8, 1 / 4), "of a piece, of a cycle", why="so far from its ends a piece is free")
_LEAST = numerics(4, "samples", why="that are foretold at once, at least")


def grown(record: Record, piece: Piece, share: float, limits: tuple[int, int], rig: Rig | None = None) -> Piece:
    """A piece as far as its own fit foretells what lies beside it, within limits; its edges as the middle says."""
    for _ in range(_ROUNDS):
        longer = _backwards(record, _forwards(record, piece, share, limits[1], rig), share, limits[0], rig)
        if (longer.a, longer.b) == (piece.a, piece.b):
            break
        piece = longer
    shy = round(min(_INSIDE[0] * (piece.b - piece.a), _INSIDE[1] * 2 * np.pi / record.pace))
    a, b = piece.a + shy * (piece.a > 0), piece.b - shy * (piece.b < record.x.size)
    inner = _fit_from(record, piece, a, b, share, rig)
    if inner is None or not holds(inner):
        return piece
    inner = _forwards(record, inner, share, limits[1], rig)
    return _backwards(record, inner, share, limits[0], rig)


def _fit_from(record: Record, piece: Piece, a: int, b: int, share: float, rig: Rig | None) -> Piece | None:
    """A fit from a to b that begins as another says; None where there is none."""
    start: np.ndarray | None = piece.values
    if a > piece.a:
        z = state_after(record, piece.values, a - piece.a)
        zero = piece.values[7] + piece.values[8] * (a - piece.a) / record.x.size
        start = None if z is None else np.concatenate([piece.values[:5], z, [zero, piece.values[8]]])
    elif a < piece.a:
        back = _turned(record, piece)
        start = None if back is None else _moved_to(record, back, a)
    return None if start is None else fit_piece(record, a, b, start, share, rig)


def _forwards(record: Record, piece: Piece, share: float, limit: int, rig: Rig | None) -> Piece:
    for _ in range(_ROUNDS):
        further = _foretold(record, piece, share, limit) - piece.b
        if further < 0:
            again = _fit_from(record, piece, piece.a, piece.b + further, share, rig)
            return again if again is not None and holds(again) else piece
        again = _longest(partial(_forwards_by, record, piece, share, rig), further)
        if again is None:
            break
        piece = again
    return piece


def _backwards(record: Record, piece: Piece, share: float, limit: int, rig: Rig | None) -> Piece:
    n, turned = record.x.size, record.reversed
    for _ in range(_ROUNDS):
        back = _turned(record, piece) if piece.a > limit else None
        if back is None:
            break
        further = _foretold(turned, back, share, n - limit, piece.b - piece.a) - back.b
        if further < 0:
            again = _fit_from(record, piece, piece.a - further, piece.b, share, rig)
            return again if again is not None and holds(again) else piece
        again = _longest(partial(_backwards_by, record, piece, back, share, rig), further)
        if again is None:
            break
        piece = again
    return piece


def _longest(fitted: Callable[[int], Piece | None], further: int) -> Piece | None:
    """The piece that is longer by so many samples, or by half as many and so on, where its fit holds."""
    while further > 0:
        again = fitted(further)
        if again is not None and holds(again):
            return again
        further //= 2
    return None


def _forwards_by(record: Record, piece: Piece, share: float, rig: Rig | None, further: int) -> Piece | None:
    return _fit_from(record, piece, piece.a, piece.b + further, share, rig)


def _backwards_by(
    record: Record, piece: Piece, back: Piece, share: float, rig: Rig | None, further: int
) -> Piece | None:
    start = _moved_to(record, back, piece.a - further)
    return None if start is None else fit_piece(record, piece.a - further, piece.b, start, share, rig)


def _turned(record: Record, piece: Piece) -> Piece | None:
    """The first cycle of a piece with time reversed, its rig known as from all of it.

    Not all of it: where friction held the mass in the end nothing says how it came there.
    """
    n, turned = record.x.size, record.reversed
    length = min(piece.b - piece.a, max(round(2 * np.pi / record.pace), LEAST_SAMPLES))
    z = state_after(record, piece.values, length - 1)
    if z is None:
        return None
    sign = -1.0 if record.quantity == "velocity" else 1.0
    zero = piece.values[7] + piece.values[8] * (length - 1) / n
    values = np.concatenate([piece.values[:5], [z[0], -z[1], sign * zero, -sign * piece.values[8]]])
    a, b = n - piece.a - length, n - piece.a
    rows = turned.made(values, length, turned.x[a:b])[1]
    information = rows @ rows.T / piece.spread**2 + prior(values, piece.rig)[1]
    if not np.all(np.isfinite(information)):  # backwards in time what is damped runs away
        return None
    covariance = np.linalg.pinv(information, hermitian=True)
    return replace(piece, a=a, b=b, values=values, covariance=covariance)


def _moved_to(record: Record, back: Piece, first: int) -> np.ndarray | None:
    """Values (9,) at an earlier sample, from a piece with time reversed."""
    n = record.x.size
    steps = n - back.a - 1 - first
    z = state_after(record.reversed, back.values, steps)
    if z is None:
        return None
    sign = -1.0 if record.quantity == "velocity" else 1.0
    zero = back.values[7] + back.values[8] * steps / n
    return np.concatenate([back.values[:5], [z[0], -z[1], sign * zero, -sign * back.values[8]]])


def _foretold(record: Record, piece: Piece, share: float, limit: int, most: int = 0) -> int:
    """The sample up to which what follows a piece is as foretold, at most twice its length away."""
    a, b = piece.a, piece.b
    stop = min(limit, b + max(b - a, most, _LEAST))
    shown = record.x[a:stop]
    left, rows = record.made(piece.values, stop - a, shown)
    if not np.all(np.isfinite(left)) or not np.all(np.isfinite(rows)):
        good = np.flatnonzero(~(np.isfinite(left) & np.all(np.isfinite(rows), axis=0)))
        stop = a + int(good[0])
        left, rows = left[: stop - a], rows[:, : stop - a]
        if stop <= b:
            return b
    unknown = np.einsum("in,ij,jn->n", rows, piece.covariance, rows)
    unknown[: b - a] = 0.0
    gain = BEYOND**2 - left**2 / (piece.spread**2 + unknown)
    middle = (b - a) // 2
    after = np.cumsum(gain[middle:])
    last = a + middle + int(np.argmax(after)) + 1
    return last - 1 if last < stop or (last == limit and last < record.x.size) else last
