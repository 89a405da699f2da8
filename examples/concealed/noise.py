"""Sensor noise: white, coloured as AR(1), like 1/f, or the steps of a coarse converter."""

from __future__ import annotations

import numpy as np

KINDS = ("white", "ar1", "pink", "quantised")


def draw_noise(rng: np.random.Generator, kind: str, size: float) -> dict[str, str | float]:
    """Draw what describes a noise of `kind` with standard deviation `size` m."""
    described: dict[str, str | float] = {"kind": kind, "std": size}
    if kind == "ar1":
        described["memory"] = rng.uniform(0.7, 0.97)  # correlation from one sample to the next
    if kind == "quantised":  # nearly all of the noise is the steps'; a little white noise precedes the converter
        described["step"] = size * np.sqrt(12)
        described["white"] = 0.2 * size
    return described


def measured(rng: np.random.Generator, described: dict[str, str | float], clean: np.ndarray) -> np.ndarray:
    """Give what the noisy sensor records of `clean`, (n,) m."""
    kind, size = described["kind"], float(described["std"])
    white = rng.standard_normal(len(clean))
    if kind == "white":
        return clean + size * white
    if kind == "ar1":
        memory = float(described["memory"])
        noise = np.empty(len(white))
        last = white[0]
        for i, shock in enumerate(np.sqrt(1 - memory**2) * white):
            last = noise[i] = memory * last + shock
        return clean + size * noise
    if kind == "pink":  # power falls as 1/f down to one line, the mean is left alone
        lines = np.fft.rfft(white)
        lines[1:] /= np.sqrt(np.arange(1, len(lines)))
        lines[0] = 0.0
        noise = np.fft.irfft(lines, len(white))
        return clean + size * noise / noise.std()
    step = float(described["step"])
    return step * np.round((clean + float(described["white"]) * white) / step)
