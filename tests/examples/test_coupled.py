"""Two rigs with a spring between them: co-simulation against one integration of both by scipy."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.system.coupled import Rig, coupled
from dashpot.examples.truth import TRUTH
from dashpot.export.fmu import export_fmu
from dashpot.export.platforms import own_platform
from dashpot.model import Oscillator
from scipy.integrate import solve_ivp

STIFFNESS, PAYLOAD, X0, SECONDS = 1000.0, 0.1, 5e-3, 1.0
SMOOTH = TRUTH | {"preload": 0.0, "dry": 0.0}  # so that a plain integrator is exact


@pytest.fixture(scope="module")
def fmu(tmp_path_factory):
    model = Oscillator.from_values(SMOOTH, name="stand")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("dashpot.export.fmu.further_contents", lambda *_: {})
        patch.setattr("dashpot.export.fmu.documentation", lambda *_: "")
        return export_fmu(model, tmp_path_factory.mktemp("fmu") / "rig.fmu", platforms=(own_platform(),))


@pytest.fixture(scope="module")
def truth():
    m, w, c, d = (SMOOTH[name] for name in ("mass", "omega0", "cubic", "viscous"))

    def rate(_t, z):
        spring = STIFFNESS * (z[1] - z[0])
        inner = [m * (w**2 * x + c * x**3 + d * v) for x, v in zip(z[:2], z[2:], strict=True)]
        return [z[2], z[3], (spring - inner[0]) / m, (-spring - inner[1]) / (m + PAYLOAD)]

    t = np.arange(round(SECONDS * 1000) + 1) * 1e-3
    return solve_ivp(rate, (0, SECONDS), [X0, 0, 0, 0], method="DOP853", t_eval=t, rtol=1e-11, atol=1e-14).y[:2].T


@pytest.mark.parametrize(
    ("way", "least", "most"),
    [("held", 0.1, 1.0), ("extrapolated", 0.0, 0.02), ("slope", 0.0, 0.01), ("curvature", 0.0, 4e-4)],
)
def test_a_force_that_is_told_well_is_right_at_a_millisecond_without_iteration(fmu, truth, way, least, most):
    rigs = (Rig(x0=X0), Rig(payload=PAYLOAD))
    motion = coupled(fmu, rigs, STIFFNESS, way=way, seconds=SECONDS)
    error = np.max(np.abs(motion - truth)) / X0
    assert least <= error < most
