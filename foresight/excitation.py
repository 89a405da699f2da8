"""What a laboratory can play: sweeps, multisines, random and stepped forces, bursts of one frequency, and releases."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..identify.signals.registry import numerics
from ..model.display import scale_of

#: In words.
KINDS = {
    "decay": "release",
    "sweep": "sweep",
    "random": "random force",
    "stepped": "stepped sine",
    "multisine": "multisine",
    "sine": "sine",
}

_LINES = numerics(40, "lines of a multisine", why="enough to look like noise, few enough for each to stand above it")
_SEED = numerics(1, "of the phases", why="any seed gives a multisine of as low a crest")
STEPS = numerics(12, "frequencies of a stepped sine", why="five lie within a resonance that fills half its band")


@dataclass(frozen=True, eq=False)
class Excitation:
    """One thing to play.

    Attributes:
        kind: one of KINDS.
        level: largest force, or the displacement of the release.
        relative: level in units of the largest recorded, where there is such.
        band_hz: from where to where, as played (a sweep downwards begins high).
        seconds: length.
        repeats: how often a release is made, each a recording by itself.
    """

    kind: str
    level: float
    relative: float
    band_hz: tuple[float, float]
    seconds: float
    repeats: int = 1

    def signal(self, fs: float) -> np.ndarray:
        """(n,) force at ``fs`` Hz: zero in a decay; ramped up and down over a twentieth of its length."""
        n = max(round(self.seconds * fs), 2)
        t = np.arange(n) / fs
        low, high = self.band_hz
        if self.kind == "decay":
            return np.zeros(n)
        if self.kind == "sweep":
            phase = 2 * np.pi * (low * t + (high - low) * t**2 / (2 * self.seconds))
            wave = np.sin(phase)
        elif self.kind == "sine":  # on for the first half: the second shows how it dies away
            wave = np.where(t < self.seconds / 2, np.sin(2 * np.pi * low * t), 0.0)
        elif self.kind == "stepped":
            wave = np.sin(2 * np.pi * np.cumsum(self._held(t)) / fs)
        elif self.kind == "random":
            wave = _random(low, high, self.seconds, t)
        else:
            lines = np.unique(np.round(np.linspace(low, high, _LINES) * self.seconds)) / self.seconds
            phases = np.random.default_rng(_SEED).uniform(0.0, 2 * np.pi, lines.size)
            wave = np.cos(2 * np.pi * lines[:, None] * t + phases[:, None]).sum(axis=0)
            wave /= np.max(np.abs(wave))
        ramp = 0.05 * self.seconds
        gate = np.clip(np.minimum(t, self.seconds - t) / ramp, 0.0, 1.0)
        return self.level * wave * np.sin(0.5 * np.pi * gate) ** 2

    def _held(self, t: np.ndarray) -> np.ndarray:
        """(n,) frequency of a stepped sine, Hz: each held for the same time, evenly spread over the band."""
        low, high = self.band_hz
        step = np.minimum((t / self.seconds * STEPS).astype(int), STEPS - 1)
        return np.linspace(low, high, STEPS)[step]

    def sentence(self, length: str = "m", force: str = "N") -> str:
        """What to do, for a person; ``length`` and ``force`` are the units of displacement and force."""
        low, high = self.band_hz
        scale = scale_of(length if self.kind == "decay" else force, self.level)
        level, long = f"{scale.factor * self.level:.3g} {scale.unit}", f"{self.seconds:.3g} s"
        if self.kind == "decay":
            often = "" if self.repeats == 1 else f", {self.repeats} times"
            return f"release it from {level} and record {long}{often}"
        if self.kind == "sine":
            return f"drive it at {low:.4g} Hz with {level} peak for {long} and stop at half time to let it ring down"
        way = f"from {low:.4g} to {high:.4g} Hz with {level} peak over {long}"
        if self.kind == "stepped":
            return f"step a sine {way}, {STEPS} frequencies of {self.seconds / STEPS:.3g} s"
        return {"sweep": "sweep", "random": "play random force", "multisine": "play a multisine"}[self.kind] + f" {way}"


def _random(low: float, high: float, seconds: float, t: np.ndarray) -> np.ndarray:
    """(n,) every line of the band with a phase of its own: nearly Gaussian (Pintelon and Schoukens 2012); peak 1."""
    first, last = max(int(np.ceil(low * seconds)), 1), max(int(np.floor(high * seconds)), 1)
    turn = np.zeros(t.size // 2 + 1, complex)
    phases = np.random.default_rng(_SEED).uniform(0.0, 2 * np.pi, max(last - first + 1, 1))
    size = min(phases.size, turn.size - first)
    turn[first : first + size] = np.exp(1j * phases[:size])
    wave = np.fft.irfft(turn, t.size)
    return wave / max(float(np.max(np.abs(wave))), np.finfo(float).tiny)
