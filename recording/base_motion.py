"""A rig that is shaken at its base: its motion relative to the base, and what drives that.

Seen from the base, ``z = x - u``, a mass on springs and dampers between the two obeys the same equation, with minus the
base's acceleration as the force per unit mass: ``z'' + ... = -u''`` (Den Hartog 1956, 2.13). So the mass itself is not
told.

What the base moves may also be one end of a spring, or of a damper, while all else stands between mass and ground. The
response is then that over the ground, ``x'' + ... = (k/m) u`` or ``(c/m) u'``, and the base's displacement or velocity
takes the place of the force; what identification calls the mass is m/k, or m/c.

Of a base's displacement or velocity what does not stand out of its noise is taken away, and the rest differentiated
through polynomials over windows (Savitzky, Golay 1964): noise would be amplified. An acceleration is taken as it is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import BadInput
from .recording import QUANTITIES, SPRING, THROUGH, WHOLE
from .smoothing import weights_of_polynomials, with_polynomials

_ORDER = 6  # of the polynomials
_LONGEST = 201  # samples
_TRUE = 1e-6  # of a derivative: beside it no record of a million samples tells that
_NEARLY = 1e-3  # of the signal: as the ends of a record may be off, where noise is more
_WINDOW, _STANDS_OUT = 512, 10.0  # samples; of so many samples as often one line stands out by chance alone
_BANDS, _OUT = 128, 8.0  # bands of a spectrum, and by how much a band with a signal is above the noise
_LINE, _SLOWEST = 1e-2, 2  # of the strongest line: what is asked lies there; and which line is a drift
#: By how many times one reading must leave less than the other, and what counts as nothing left, as of a sine by both.
_CLEARER, _TOLD = 4.0, 1e-4


@dataclass(frozen=True, eq=False)
class Seen:
    """A rig as its base sees it.

    Attributes:
        response: (n,) relative to the base.
        force: (n,) minus the base's acceleration; its displacement or velocity, where that drives through one thing.
        noise: standard deviation of white noise on that which has, where the rig answers, the density of what it has.
        said: what is to be said.
        per_time: what the unit of the force has behind that of length or angle.
        base: as ``Recording.base`` has it.
    """

    response: np.ndarray
    force: np.ndarray
    noise: float
    said: str
    per_time: str = "/s2"
    base: str = WHOLE


def derivative(signal: np.ndarray, fs: float, order: int, highest: float = 0.5) -> np.ndarray:
    """(n,) the derivative of that order, 0 to 2, of a signal (n,) up to a frequency, in cycles a sample."""
    if order == 0:
        return signal
    if signal.size <= _ORDER:  # no recording of so few samples is identified: what checks it says so
        return np.zeros(signal.size)
    return with_polynomials(signal, _span(signal.size, order, highest, _TRUE), _ORDER, order) * fs**order


def _span(n: int, order: int, highest: float, off: float) -> int:
    """The longest window of polynomials by which a derivative is off by no more than a part, at a frequency."""
    span = _ORDER + 1 | 1
    while span + 2 <= min(_LONGEST, n) and _off(span + 2, order, 2 * np.pi * highest) < off:
        span += 2
    return span


def denoised(signal: np.ndarray, highest: float) -> np.ndarray:
    """(n,) what stands out of the white noise on a signal (n,), in windows that overlap and lines of each.

    A base is mostly driven at few frequencies at a time. Noise at all others is on the response too, or not at all, but
    moves no mass: left in, it looks as if the rig answered it in another way than it answers its base. At either end,
    where no window is whole, polynomials smooth it up to the highest frequency that stands out, cycles a sample.
    """
    size = min(_WINDOW, 4 * (signal.size // 8))
    step = size // 4
    if step < 2:
        return signal
    window, least = np.hanning(size + 1)[:-1], np.log(_STANDS_OUT * signal.size) * _noise(signal) ** 2
    begins = range(0, signal.size - size + 1, step)
    lines = np.fft.rfft(np.stack([window * signal[i : i + size] for i in begins]), axis=1)
    lines[np.abs(lines) ** 2 < least * np.sum(window**2)] = 0.0
    made, weight = np.zeros(signal.size), np.zeros(signal.size)
    for i, part in zip(begins, np.fft.irfft(lines, size, axis=1), strict=True):
        made[i : i + size] += window * part
        weight[i : i + size] += window**2
    whole = float(np.sum(window**2)) / step
    smooth = with_polynomials(signal, _span(signal.size, 0, highest, _NEARLY), _ORDER)
    return (made + np.maximum(whole - weight, 0.0) * smooth) / np.maximum(weight, whole)


def _spectrum(signal: np.ndarray) -> tuple[np.ndarray, float]:
    """Mean power of bands of lines, and that of noise: the median of the highest quarter of them."""
    lines = np.abs(np.fft.rfft(np.hanning(signal.size) * (signal - np.mean(signal)))) ** 2
    size = max(lines.size // _BANDS, 1)
    bands = np.mean(lines[: lines.size // size * size].reshape(-1, size), axis=1)
    return bands, float(np.median(bands[-(len(bands) // 4) - 1 :]))


def _noise(signal: np.ndarray) -> float:
    """Standard deviation of white noise on a signal (n,)."""
    return float(np.sqrt(_spectrum(signal)[1] / np.sum(np.hanning(signal.size) ** 2)))


def _pace(motion: np.ndarray, shown: int, fs: float) -> float:
    """Frequency at which a rig mostly moves, rad/s, by its displacement."""
    turn = 2 * np.pi * np.fft.rfftfreq(motion.size, 1.0 / fs)[_SLOWEST + 1 :]
    power = np.abs(np.fft.rfft(motion - np.mean(motion)))[_SLOWEST + 1 :] ** 2 / turn ** (2 * shown)
    return float(turn[int(np.argmax(power))])


def highest_of(signal: np.ndarray) -> float:
    """Highest frequency, cycles a sample, at which a signal stands out of its noise."""
    bands, floor = _spectrum(signal)
    out = np.flatnonzero(bands > _OUT * floor)
    return 0.5 * (float(out[-1]) + 1.0) / len(bands) if out.size else 0.5


def _off(span: int, order: int, turn: float) -> float:
    """By which part of itself the derivative through polynomials over a window is off, at a frequency, rad a sample."""
    row = weights_of_polynomials(span, _ORDER, order)[span // 2]
    place = np.arange(span) - span // 2
    return abs(complex(row @ np.exp(1j * turn * place)) / (1j * turn) ** order - 1.0)


def seen_from_base(
    where: str, fs: float, response: np.ndarray, quantity: str, base: np.ndarray, of_base: str, relative: bool | None
) -> Seen:
    """The response relative to the base, and what drives it.

    Args:
        where: name for messages.
        fs: Hz.
        response, base: (n,), in SI units of one kind.
        quantity, of_base: what they measure.
        relative: whether the response is relative to the base already; None where nobody says.

    Raises:
        BadInput: the base does not move, cannot be brought to the response's quantity, or whether the response is
            relative is not told.
    """
    _moves(where, response, base)
    shown, moved = QUANTITIES.index(quantity), QUANTITIES.index(of_base)
    recorded = base
    noise, highest = 0.0, 0.5  # an acceleration drives as it is, and shows its noise itself
    if moved < 2:
        noise, highest = _noise(base), highest_of(base)
        base = denoised(base, highest)
    force = -derivative(base, fs, 2 - moved, highest)

    def seen(motion: np.ndarray, said: str) -> Seen:
        said = f"{said}; what drives it is minus the base's acceleration, which tells no mass"
        return Seen(motion, force, noise * _pace(motion, shown, fs) ** (2 - moved), said)

    if relative is True:
        return seen(response, "the response is relative to the moving base, as stated")
    if shown < moved:
        raise BadInput(
            f"{where}: whether the {quantity} is relative to a base of which the {of_base} was recorded is not told by "
            f"the signals; state --relative where it is, and where it is over the ground give the base's {quantity}"
        )
    same = response - derivative(base, fs, shown - moved, highest)
    if relative is False:
        return seen(same, "the response was taken relative to the moving base")
    over_ground, already = (_left(one, shown, force, fs) for one in (same, response))
    through = _left(response, shown, recorded, fs, scaled=True) if moved == 0 else np.inf
    if _CLEARER * max(through, _TOLD) < min(over_ground, already):
        return driven_through(where, fs, response, recorded, of_base, SPRING)
    if max(over_ground, already) < _CLEARER * max(min(over_ground, already), _TOLD):
        raise BadInput(
            f"{where}: whether the response is relative to its base is not told by the signals; state --relative or "
            "--absolute or, where the base moves one end of a spring or damper and nothing else, --through"
        )
    if over_ground < already:
        return seen(same, "the response is over the ground, by the signals, and was taken relative to the moving base")
    return seen(response, "the response is relative to the moving base, by the signals")


def driven_through(where: str, fs: float, response: np.ndarray, base: np.ndarray, of_base: str, through: str) -> Seen:
    """The response over the ground, and what drives it through a spring or a damper whose other end the base moves.

    Args:
        where: name for messages.
        fs: Hz.
        response, base: (n,), in SI units.
        of_base: what the latter measures.
        through: "spring" or "damper".

    Raises:
        BadInput: the base does not move, or what was recorded of it cannot be brought to what drives.
    """
    _moves(where, response, base)
    moved, wanted = QUANTITIES.index(of_base), THROUGH.index(through)
    if moved > wanted:
        raise BadInput(
            f"{where}: a {through} passes on the {QUANTITIES[wanted]} of its end, and its {of_base} was recorded; give "
            f"a column of its {' or its '.join(QUANTITIES[: wanted + 1])} with --base"
        )
    if moved < wanted:
        highest = highest_of(base)
        base = derivative(denoised(base, highest), fs, 1, highest)
    said = (
        f"the base moves one end of a {through}, and all else stands between the thing and the ground; the "
        f"{QUANTITIES[wanted]} of the base is in place of a force, and mass is what this {through} moves, over its "
        f"{'stiffness' if through == SPRING else 'damping'}"
    )
    return Seen(response, base, 0.0, said, ("", "/s")[wanted], through)


def _moves(where: str, response: np.ndarray, base: np.ndarray) -> None:
    """Raises BadInput where base or response do not move, or are one and the same."""
    with np.errstate(over="ignore"):
        finite = bool(np.isfinite(np.sum(base**2)))
    if not finite:
        raise BadInput(
            f"{where}: the base holds values that are not a number, or larger than any motion; choose another column "
            "with --base"
        )
    if not np.ptp(base) > 0.0:
        raise BadInput(f"{where}: the base does not move; choose another column with --base, or leave it out (none)")
    if not np.ptp(response) > 0.0:
        raise BadInput(f"{where}: the response is {response[0]:g} throughout; check the sensor, or choose --response")
    if np.array_equal(response, base):
        raise BadInput(f"{where}: the response is the motion of the base; choose another column with --response")


def _left(response: np.ndarray, shown: int, force: np.ndarray, fs: float, *, scaled: bool = False) -> float:
    """Part of a force that Eq. 17 leaves whose relative response this is: lines of the force's band.

    By a regression on the motion, its velocity, its cube and its signs, as of FORCEVIB. Nothing is left, as nothing is
    told, where the force has no line but those of a drift. ``scaled``: the force may count by any factor.
    """
    window = np.hanning(response.size)
    turn = 2j * np.pi * np.fft.rfftfreq(response.size, 1.0 / fs)
    f = np.fft.rfft(window * (force - np.mean(force)))
    power = np.abs(f) ** 2
    used = (power > _LINE * np.max(power)) & (np.arange(power.size) > _SLOWEST)
    if not np.any(used):
        return 0.0
    lowest = int(np.flatnonzero(used)[0])
    motion = np.fft.rfft(response - np.mean(response))
    motion[: lowest // 2] = 0.0
    z, v, a = (
        np.fft.irfft(np.append(0.0, motion[1:] * turn[1:] ** (order - shown)), response.size) for order in (0, 1, 2)
    )
    forces = (z, v, z**3, np.sign(z), np.sign(v), *((a,) if scaled else ()))
    laws = np.stack([np.fft.rfft(window * law)[used] for law in forces], axis=1)
    wanted = f[used] - (0.0 if scaled else np.fft.rfft(window * a)[used])
    columns, values = (np.concatenate([part.real, part.imag]) for part in (laws, wanted))
    size = np.linalg.norm(columns, axis=0)
    columns = columns / np.where(size > 0.0, size, 1.0)
    left = values - columns @ np.linalg.lstsq(columns, values)[0]
    return float(np.sum(left**2) / np.sum(np.abs(f[used]) ** 2))
