"""Where a value steps: the row of states cut into stretches in each of which it keeps one value.

The cuts are those that make the squares about the stretches' means least, each paid for with what chance alone would
take away (optimal partitioning: Jackson et al. 2005).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

#: States that a line is held against; through fewer nearly anything passes.
_ENOUGH = 4


@dataclass(frozen=True)
class Step:
    """A parameter's step.

    Attributes:
        parameter: its name.
        state: the first state behind the step.
        before, after: values of the stretches on either side.
        error: standard error of their difference.
    """

    parameter: str
    state: int
    before: float
    after: float
    error: float


def steps_of(name: str, values: np.ndarray, errors: np.ndarray, freedom: float, level: float) -> tuple[Step, ...]:
    """The steps of a parameter.

    Args:
        name: of the parameter.
        values, errors: (m,) in each state, with standard errors.
        freedom: degrees of freedom of the errors.
        level: how often chance alone may make a step in the whole row.
    """
    from scipy.special import stdtrit

    m = len(values)
    # the square of Student's t is F of one degree of freedom
    price = float(stdtrit(min(freedom, 1e6), 0.5 * level / max(1, m - 1))) ** 2
    weight = 1.0 / errors**2
    sums = [np.concatenate([[0.0], np.cumsum(weight * values**p)]) for p in (0, 1, 2)]
    best, last = np.full(m + 1, np.inf), np.zeros(m + 1, int)
    best[0] = -price
    for end in range(1, m + 1):
        w, s, q = (total[end] - total[:end] for total in sums)
        cost = best[:end] + np.maximum(q - s**2 / w, 0.0) + price
        last[end] = int(np.argmin(cost))
        best[end] = cost[last[end]]
    edges = [m]
    while edges[0] > 0:
        edges.insert(0, int(last[edges[0]]))
    means = [(sums[1][b] - sums[1][a]) / (sums[0][b] - sums[0][a]) for a, b in pairwise(edges)]
    variances = [1.0 / (sums[0][b] - sums[0][a]) for a, b in pairwise(edges)]
    return tuple(
        Step(name, edges[i + 1], float(means[i]), float(means[i + 1]), float(np.sqrt(variances[i] + variances[i + 1])))
        for i in range(len(means) - 1)
    )


def drift_of(values: np.ndarray, errors: np.ndarray, level: float) -> tuple[float, float] | None:
    """Change from state to state and its error where a straight line tells the row; None where it does not."""
    from scipy.special import chdtrc

    m = len(values)
    if m < _ENOUGH:
        return None
    place, weight = np.arange(m) - (m - 1) / 2, 1.0 / errors**2
    rows = np.column_stack([np.ones(m), place])
    normal = rows.T @ (weight[:, None] * rows)
    line = np.linalg.solve(normal, rows.T @ (weight * values))
    left = float(np.sum(weight * (values - rows @ line) ** 2))
    if chdtrc(m - 2, left) <= level:
        return None
    return float(line[1]), float(np.sqrt(np.linalg.inv(normal)[1, 1]))
