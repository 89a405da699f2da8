"""The numbers that decide what noise, spectra and analytic signals are: unit, what, and why."""

from __future__ import annotations

from .registry import decides

# signals.py

SILENT = decides(
    0.7,
    "part of the standard deviation",
    "from which on white noise is all that is in a signal",
    why="half of the power: what is left is as likely noise as signal",
)
