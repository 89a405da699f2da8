"""The default experiment of an FMU: how long an importer runs it that is told nothing, in which steps, how exactly.

FMI 2.0.5 (section 2.2.5) and FMI 3.0.2 (section 2.4.5) leave its values to the exporter. An importer that finds none
takes its own, and those know nothing of the motion: ten milliseconds a step, a relative tolerance of 1e-5.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

#: Cycles of the natural frequency that it lasts, and communication steps that a cycle takes.
CYCLES, STEPS = 20, 100
#: For an importer that integrates. Model exchange under FMPy's CVode is with it as exact as with any smaller one.
TOLERANCE = 1e-8
#: Steps come in so many, so that the stop is as short a number as the step.
_STEPS_AT_ONCE = 100


@dataclass(frozen=True)
class Experiment:
    """From 0 to ``stop`` in steps of ``step``, s, with a relative ``tolerance``."""

    stop: float
    step: float
    tolerance: float = TOLERANCE


def experiment(frequency: float) -> Experiment:
    """Twenty cycles of a frequency, rad/s, in steps of a hundredth of a cycle, both rounded to readable numbers.

    The step is rounded to one digit, so that a cycle takes 67 to 150 of them; the stop is rounded up. A motion that has
    no frequency is given a cycle of a second.
    """
    cycle = 2.0 * math.pi / frequency if 0.0 < frequency < math.inf else 1.0
    step = float(f"{cycle / STEPS:.0e}")
    count = math.ceil(CYCLES * cycle / step / _STEPS_AT_ONCE) * _STEPS_AT_ONCE
    return Experiment(float(f"{count * step:.12g}"), step)
