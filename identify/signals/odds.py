"""What is believed: the one level of doubt at which all that recordings decide is decided.

A thousand to one: a structure leads another, a force is taken for held, a sensor's zero for moved, a line of a spectrum
for no chance. Jeffreys (1961, appendix B) calls a hundred decisive; of several tens of laws, or recordings, or
lines that are tried beside each other one would pass at that by chance.
"""

from __future__ import annotations

import math

import numpy as np

from .registry import decides

DECISIVE = decides(math.log(1000.0), "log-odds", "when something is settled", why="odds: a thousand to one, as above")
BY_CHANCE = decides(
    1e-3, "chance", "how often a test that knows no rival may pass", why="error rate: the same level of doubt"
)
#: So many standard errors from zero a value is a thousand times as likely as zero is.
BEYOND_ERRORS = math.sqrt(2.0 * DECISIVE)
ONE_ERROR = decides(
    0.5, "log-likelihood", "what promises less is at rest", why="the gain by a step of one standard error"
)
SIGNIFICANT = decides(
    3.0,
    "standard errors",
    "from which on anything is more than its noise",
    why="error rate: once in 370; of what is compared by tens the level of doubt above decides",
)
ABOVE_NOISE = decides(
    1.1,
    "times the noise",
    "what residuals are more than noise",
    why=("physical limit: the estimate of the noise comes from the highest frequencies alone and is good to a tenth"),
)
HALF_AGAIN = decides(
    1.5,
    "times the noise",
    "what moves, or is no noise, where its level alone is asked",
    why="physical limit: the noise is known to a tenth; half as much again is no error of its estimate",
)


def is_noise(squares: np.ndarray, worth: np.ndarray) -> bool:
    """Whether means of squares (s,) over the noise's are those of so many independent values (s,) of noise.

    The level is an estimate itself, good to a tenth; beyond that chance has its part: a chi-squared variable passes
    this limit less often than the odds say (Laurent and Massart 2000, lemma 1).
    """
    chance = 1.0 + 2.0 * np.sqrt(DECISIVE / worth) + 2.0 * DECISIVE / worth
    return bool(np.all(squares <= ABOVE_NOISE**2 * chance))
