"""What is believed: the one level of doubt at which all that recordings decide is decided.

A thousand to one: a structure leads another, a force is taken for held, a sensor's zero for moved, a line of a spectrum
for no chance. Jeffreys (1961, appendix B) calls a hundred decisive; of several tens of laws, or recordings, or
lines that are tried beside each other one would pass at that by chance.
"""

from __future__ import annotations

import math

import numpy as np

#: Natural logarithm of the odds, and of a ratio of likelihoods, at which something is settled.
DECISIVE = math.log(1000.0)
#: The same of a test that knows no rival: how often chance alone may pass.
BY_CHANCE = 1e-3
#: The same of a value with a standard error: so many errors from zero it is a thousand times as likely as zero is.
BEYOND_ERRORS = math.sqrt(2.0 * DECISIVE)
#: Gain of log-likelihood by a step of one standard error: what promises less is at rest.
ONE_ERROR = 0.5
#: Physical limit: residuals this many times the noise are more than its own estimate leaves open, which comes from the
#: highest frequencies alone and is good to a tenth.
ABOVE_NOISE = 1.1


def is_noise(squares: np.ndarray, worth: np.ndarray) -> bool:
    """Whether means of squares (s,) over the noise's are those of so many independent values (s,) of noise.

    The level is an estimate itself, good to a tenth; beyond that chance has its part: a chi-squared variable passes
    this limit less often than the odds say (Laurent and Massart 2000, lemma 1).
    """
    chance = 1.0 + 2.0 * np.sqrt(DECISIVE / worth) + 2.0 * DECISIVE / worth
    return bool(np.all(squares <= ABOVE_NOISE**2 * chance))
