"""What is believed: the one level of doubt at which all that recordings decide is decided.

A thousand to one: a structure leads another, a force is taken for held, a sensor's zero for moved, a line of a spectrum
for no chance. Jeffreys (1961, appendix B) calls a hundred decisive; of several tens of laws, or recordings, or
lines that are tried beside each other one would pass at that by chance.
"""

from __future__ import annotations

import math

#: Natural logarithm of the odds, and of a ratio of likelihoods, at which something is settled.
DECISIVE = math.log(1000.0)
#: The same of a test that knows no rival: how often chance alone may pass.
BY_CHANCE = 1e-3
#: The same of a value with a standard error: so many errors from zero it is a thousand times as likely as zero is.
BEYOND_ERRORS = math.sqrt(2.0 * DECISIVE)
