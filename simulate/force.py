"""The recorded force between its samples: its hold.

A wrong hold is the largest error of all: straight lines through 77 samples a cycle lose 0.055 % of the force, which
is fifty standard errors of a mass. What an amplifier or a shaker puts out is smooth, and its samples are the
band-limited image of it: up-sampled first where they are few, then joined by a cubic spline. What a converter puts out
is held from sample to sample, and what many simulations were driven by runs in straight lines. All three are cubics,
which the engine integrates exactly.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

#: With at least this many samples a cycle a cubic spline errs by less than 1e-5 of the force.
SAMPLES_A_CYCLE = 30.0
#: Pieces of a spline that are made at once, and points beside them: each counts 3.7 times less than the one before, so
#: that what lies beyond them is below rounding.
_AT_ONCE = 2**16
_BESIDE = 40
#: Samples beyond each end by which a force is continued where it is up-sampled.
_REFLECTED = 512
#: A force of so many samples is up-sampled in parts too, with as many beside them as make their ends felt no more: what
#: lies beyond tells less than one part in so many of the highest frequencies, where there is noise.
_LONG = 2**18
_NEIGHBOURS = 1024


@dataclass(frozen=True)
class Force:
    """A force as cubics.

    Attributes:
        pieces: (m, 4) coefficients of 1, tau, tau², tau³, tau from the piece's start; one more than the intervals
            between samples where the last sample's value is not the end of the piece before it. Those of a long force
            are in single precision, good to 6e-8 of it where a spline is to 1e-5.
        fine: pieces a sample interval.
        hold: what they make of the samples: ``zero``, ``linear`` or ``smooth``.
        joined: so many of them are taken as one, with the values and slopes at its ends.
    """

    pieces: np.ndarray
    fine: int = 1
    hold: str = "smooth"
    joined: int = 1

    def coarser(self, times: int, dt: float) -> Force:
        """The same force in up to so many times fewer pieces, each with the values and slopes of the old at its ends.

        With 30 samples a cycle left, a sine errs by 5e-6 between them (Hermite: the fourth power of its turn over 384).
        """
        fewer = max(k for k in range(1, times + 1) if self.fine % k == 0)
        if fewer == 1:
            return self
        if self.pieces.shape[0] >= _LONG:
            return replace(self, joined=fewer)  # by whoever takes them, without a copy
        count = self.pieces.shape[0] // fewer * fewer
        first, last = self.pieces[:count:fewer], self.pieces[fewer - 1 : count : fewer]
        short = dt / self.fine
        long = fewer * short
        rise = last @ short ** np.arange(4) - first[:, 0]
        slope = last[:, 1] + short * (2.0 * last[:, 2] + 3.0 * short * last[:, 3])
        pieces = first.copy()
        pieces[:, 2] = (3.0 * rise / long - 2.0 * first[:, 1] - slope) / long
        pieces[:, 3] = (first[:, 1] + slope - 2.0 * rise / long) / long**2
        return replace(self, pieces=pieces, fine=self.fine // fewer)

    def shifted(self, by: float) -> Force:
        """The same force with a constant added."""
        pieces = self.pieces.copy()
        pieces[:, 0] += by
        return replace(self, pieces=pieces)

    def part(self, begin: int, end: int) -> Force:
        """The force over the samples from ``begin`` to ``end``, as Python slices them."""
        last = max(end - 1, begin) * self.fine + (1 if self.hold == "zero" else 0)
        return replace(self, pieces=self.pieces[begin * self.fine : last])

    def disturbed(self, std: float, random: np.random.Generator, dt: float) -> Force:
        """The same force with white noise of that standard deviation on its samples, ``dt`` apart."""
        count = self.pieces.shape[0] // self.fine
        return self.with_added(std * random.standard_normal(count + 1), dt)

    def with_added(self, samples: np.ndarray, dt: float) -> Force:
        """The same force with something added to its samples, ``dt`` apart, that changes from each to the next.

        It runs between samples as the force does; but for a smooth force it is joined as cheaply as its pieces allow,
        in straight lines or (where they are finer than samples) held, which at 30 samples a cycle moves a rig as much
        to 0.4 %. Of ``samples`` (n,) those are taken that the force has; the last one stays.
        """
        step = dt / self.fine
        noise = np.repeat(samples, self.fine)[: self.pieces.shape[0] + 1]
        noise = np.pad(noise, (0, self.pieces.shape[0] + 1 - noise.size), mode="edge")
        pieces = self.pieces.copy()
        pieces[:, 0] += noise[:-1]
        if self.hold != "zero" and self.fine == 1:
            pieces[:, 1] += np.diff(noise) / step
        return replace(self, pieces=pieces)


def force_between(samples: np.ndarray, dt: float, hold: str, highest: float) -> Force:
    """The force that (n,) samples ``dt`` apart stand for.

    Args:
        samples: recorded force.
        dt: sample interval, s.
        hold: ``zero``: held from each sample to the next; ``linear``: straight lines; ``smooth``: band-limited.
        highest: as in ``smooth_force``.
    """
    kind = np.float32 if samples.size >= _LONG else float
    if hold == "zero":
        return staircase(samples, kind)
    return straight_lines(samples, dt, kind) if hold == "linear" else smooth_force(samples, dt, highest, kind)


def staircase(samples: np.ndarray, kind: type = float) -> Force:
    """Zero-order hold of (n,) samples: each stays until the next, as behind a digital-to-analogue converter."""
    pieces = np.zeros((samples.size, 4), kind)
    pieces[:, 0] = samples
    return Force(pieces, hold="zero")


def straight_lines(samples: np.ndarray, dt: float, kind: type = float) -> Force:
    """First-order hold of (n,) samples ``dt`` apart: what an FMU does with its input."""
    pieces = np.zeros((max(samples.size - 1, 0), 4), kind)
    pieces[:, 0] = samples[:-1]
    pieces[:, 1] = np.diff(samples) / dt
    return Force(pieces, hold="linear")


def smooth_force(samples: np.ndarray, dt: float, highest: float, kind: type = float) -> Force:
    """The force behind (n,) samples, as a band-limited signal.

    Args:
        samples: recorded force.
        dt: sample interval, s.
        highest: highest frequency that moves the rig noticeably, Hz; decides how finely to up-sample.
        kind: of the pieces' numbers.
    """
    fine = int(np.clip(np.ceil(SAMPLES_A_CYCLE * highest * dt), 1, 16))
    points = upsample(samples, fine) if fine > 1 else samples
    return Force(_spline(points, dt / fine, kind), fine)


def _spline(points: np.ndarray, step: float, kind: type) -> np.ndarray:
    """(n - 1, 4) pieces of the cubic spline through (n,) points; of a long one in parts that overlap."""
    from scipy.interpolate import CubicSpline

    pieces = np.empty((points.size - 1, 4), kind)
    for begin in range(0, points.size - 1, _AT_ONCE):
        end = min(begin + _AT_ONCE, points.size - 1)
        first = max(0, begin - _BESIDE)
        part = points[first : end + 1 + _BESIDE]
        coefficients = CubicSpline(np.arange(part.size) * step, part).c
        pieces[begin:end] = coefficients[::-1, begin - first : end - first].T
    return pieces


def upsample(samples: np.ndarray, factor: int) -> np.ndarray:
    """(n,) band-limited samples at ``factor`` times the rate: ((n - 1) * factor + 1,), the given ones among them.

    The ends are continued by point reflection, so that no step appears there; the Fourier interpolation is then exact
    for what lies below half the sampling frequency.
    """
    return _upsampled_in_parts(samples, factor) if samples.size >= _LONG else _upsampled(samples, factor)


def _upsampled(samples: np.ndarray, factor: int) -> np.ndarray:
    n = samples.size
    pad = min(n - 1, _REFLECTED)
    left = 2.0 * samples[0] - samples[pad:0:-1]
    right = 2.0 * samples[-1] - samples[-2 : -pad - 2 : -1]
    wide = np.concatenate([left, samples, right])
    window = np.hanning(2 * pad)  # the two far ends meet at zero slope difference
    trend = np.linspace(wide[0], wide[-1], wide.size)
    flat = wide - trend
    flat[:pad] *= window[:pad]
    flat[-pad:] *= window[pad:]
    spectrum = np.fft.rfft(flat)
    if flat.size % 2 == 0 and factor > 1:  # half the sampling frequency stands in it once, and for two lines
        spectrum[-1] *= 0.5
    fine = factor * np.fft.irfft(spectrum, wide.size * factor)
    fine = fine[pad * factor : (pad + n - 1) * factor + 1]
    ramp = np.interp(np.arange(fine.size) / factor + pad, np.arange(wide.size), trend)
    return fine + ramp


def _upsampled_in_parts(samples: np.ndarray, factor: int) -> np.ndarray:
    """``upsample`` of a long force, in parts that overlap."""
    last = samples.size - 1
    fine = np.empty(last * factor + 1)
    count = _AT_ONCE - 2 * (_NEIGHBOURS + _REFLECTED)
    for begin in range(0, last, count):
        end = min(begin + count, last)
        first = max(0, begin - _NEIGHBOURS)
        part = _upsampled(samples[first : min(end + _NEIGHBOURS, last) + 1], factor)
        fine[begin * factor : end * factor + 1] = part[(begin - first) * factor : (end - first) * factor + 1]
    return fine
