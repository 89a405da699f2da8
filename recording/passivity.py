"""Whether a force makes the motion, and with a sign that a passive thing can have: by an autoregressive model.

The response is predicted from its own past, with and without the force (ARX, Ljung 1999, section 4.2). What was stored
before the record began and the swings after each edge of the force are then the past's, and not the force's, so that a
few steps tell as much as a sweep does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .recording import QUANTITIES

ORDER = 8  # of the model: a mode, a hold, an offset, and four more for what noise on the response adds
PER_CYCLE = 16  # samples of the dominant cycle that are kept: closer ones only tell the noise
MOST = 4096  # samples compared: enough for one part in a thousand
SHIFTS = 99  # unrelated forces of the same shape: the recorded one is the best of a hundred by chance in one of them


@dataclass(frozen=True, eq=False)
class Driven:
    """What a force adds to the prediction of a response from its own past.

    Attributes:
        own: (m, k) orthonormal: the response's past, an offset and a drift.
        response: (m,) the response, and ``force`` (m, ORDER + 1) what each of its samples may be driven by.
        share: part of the response's innovations that the force explains.
        cosine: of the phase between force and velocity, averaged over the response that the force makes: the sign of
            the work that the force does. No passive thing has a negative one.
    """

    own: np.ndarray
    response: np.ndarray
    force: np.ndarray
    share: float
    cosine: float

    def is_related(self) -> bool:
        """Whether the force explains more than it does backwards and from any other instant on."""
        shifts = np.linspace(0.0, len(self.force), SHIFTS + 2)[1:-1].astype(int)
        turned = self.force[::-1]
        return self.cosine > 0.0 and all(
            _explained(self.own, self.response, np.roll(turned, shift, axis=0)) < self.share for shift in shifts
        )


def driven(force: np.ndarray, response: np.ndarray, fs: float, frequency: float, quantity: str) -> Driven | None:
    """Compare force and response, both (n,) at ``fs`` Hz, about the dominant ``frequency`` in Hz.

    None where there are too few samples for it, or one of both is constant.
    """
    fold = max(1, min(int(fs / (frequency * PER_CYCLE)), len(force) // (8 * ORDER)), len(force) // MOST)
    n = len(force) // fold
    f, y = (signal[: n * fold].reshape(n, fold).mean(axis=1) for signal in (force, response))
    if n < 4 * ORDER or not (np.ptp(f) > 0 and np.ptp(y) > 0):
        return None
    f, y = ((signal - signal.mean()) / np.std(signal) for signal in (f, y))
    past = [y[ORDER - k : n - k] for k in range(1, ORDER + 1)]
    past = np.column_stack([*past, np.ones(n - ORDER), np.linspace(-1.0, 1.0, n - ORDER)])
    acting = np.column_stack([f[ORDER - k : n - k] for k in range(ORDER + 1)])
    own = np.linalg.qr(past)[0]
    model = np.linalg.lstsq(np.column_stack([past, acting]), y[ORDER:], rcond=None)[0]
    turn = np.pi * np.arange(1, n // 2) / (n // 2)  # radians per kept sample
    delays = np.exp(-1j * np.outer(turn, np.arange(ORDER + 1)))
    gain = delays @ model[ORDER + 2 :] / (1.0 - delays[:, 1:] @ model[:ORDER])
    # the force's power at those frequencies, its ends tapered
    power = np.abs(np.fft.rfft(f * np.hanning(n), 2 * (n // 2))[1 : n // 2]) ** 2 * np.abs(gain) ** 2
    velocity = gain * (1j * turn) ** (1 - QUANTITIES.index(quantity))
    cosine = float(power @ (velocity.real / np.abs(velocity)) / np.sum(power))
    return Driven(own, y[ORDER:], acting, _explained(own, y[ORDER:], acting), cosine)


def _explained(own: np.ndarray, response: np.ndarray, force: np.ndarray) -> float:
    """Part of what the orthonormal ``own`` (m, k) leave of a response (m,) that a force (m, l) explains."""
    rest, more = (signal - own @ (own.T @ signal) for signal in (response, force))
    fitted = more @ np.linalg.lstsq(more, rest, rcond=None)[0]
    return float(fitted @ fitted / max(rest @ rest, np.finfo(float).tiny))
