"""The first motion of a stretch, and whether it begins at rest."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.first_motion import first_motion, starts_at_rest

FS, CYCLE = 200.0, 40
PACE = 2 * np.pi * FS / CYCLE


def test_a_parabola_has_its_own_beginning():
    t = np.arange(50) / FS
    motion, spread = first_motion(2.0 - 3.0 * t + 40.0 * t**2, 1 / FS, PACE)
    assert motion == pytest.approx([2.0, -3.0])
    # through six samples, a seventh of a cycle of 40: the first row of the least squares' inverse in closed form
    columns = np.vander(np.arange(6) / FS, 3, increasing=True)
    assert spread == pytest.approx(np.sqrt(np.diag(np.linalg.inv(columns.T @ columns))[:2]))
    assert first_motion(np.ones(5), 1 / FS, PACE)[1].size == 2
    few = np.vander(np.arange(4) / FS, 3, increasing=True)
    assert first_motion(np.ones(50), 1 / FS, 20 * PACE)[1] == pytest.approx(
        np.sqrt(np.diag(np.linalg.inv(few.T @ few))[:2])
    )


@pytest.mark.parametrize(("errors", "rests"), [(3.7, True), (3.74, False)])
@pytest.mark.parametrize("which", [0, 1])
@pytest.mark.parametrize("sign", [1, -1])
def test_at_rest_is_within_errors_that_are_decisive(errors, rests, which, sign):
    t = np.arange(50) / FS
    noise = 1e-5
    size = sign * errors * noise * first_motion(t, 1 / FS, PACE)[1][which]
    assert starts_at_rest(size * t**which, 1 / FS, PACE, noise) is rests
