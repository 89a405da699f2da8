"""The integration formula that the CasADi step and the C engine share: Dormand and Prince (1980), order five."""

from __future__ import annotations

from collections.abc import Callable

from ..model.law import Expression

NODES = (0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0)
WEIGHTS = (
    (1 / 5,),
    (3 / 40, 9 / 40),
    (44 / 45, -56 / 15, 32 / 9),
    (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
    (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
    (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
)


def dormand_prince(
    field: Callable[[Expression, Expression], Expression], z: Expression, tau: Expression, h: Expression
) -> Expression:
    """State after one step of length ``h`` from ``z`` at ``tau``; ``field(z, tau)`` is the right-hand side."""
    slopes = []
    stage = z
    for node, row in zip(NODES, WEIGHTS, strict=True):
        slopes.append(field(stage, tau + node * h))
        stage = z + h * sum(weight * slope for weight, slope in zip(row, slopes, strict=True))
    return stage
