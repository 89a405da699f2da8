"""Under which heading each command stands in ``dashpot -h``, in the order in which they are wanted."""

from __future__ import annotations

GROUPS = {
    "Begin": ("demo", "paper", "look", "check", "plan"),
    "From recordings to a model": ("identify", "diagnose", "hilbert", "prove-on"),
    "Use a model": ("show", "simulate", "linearise", "export", "verify"),
    "Many rigs, many tests": ("batch", "compare", "watch"),
    "The installation": ("doctor", "completion"),
}
OTHERS = "Further"
