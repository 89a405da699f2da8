"""Two close modes of a rig under a hammer: listed with the decimals of their errors, and each taken where asked for."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.identification import identify
from dashpot.identify.motion.damped_modes import Modes
from dashpot.identify.motion.decays import find_free_motion, linear_modes
from dashpot.identify.motion.mode_lines import modes_of
from dashpot.identify.motion.modes import without_other_modes
from dashpot.recording import Recording
from scipy.signal import lsim

FS, BLOWS = 1000.0, (0.5, 4.5)
#: Frequency in Hz, damping ratio, and answer to the force, 1/kg: the sensor shows the second against the force.
MODES = ((30.0, 0.006, 0.5), (32.5, 0.005, -0.4))
NOISE = 2e-3


@pytest.fixture(scope="module")
def struck() -> Recording:
    """An accelerometer's record: each mode by the state-space solution for a force that is straight between samples."""
    time = np.arange(round(8.5 * FS)) / FS
    force = np.zeros(time.size)
    for begin in BLOWS:
        contact = (time > begin) & (time < begin + 5e-3)
        force[contact] += 80.0 * np.sin(np.pi * (time[contact] - begin) / 5e-3)
    response = np.zeros(time.size)
    for frequency, zeta, gain in MODES:
        omega = 2 * np.pi * frequency
        system = (
            [[0.0, 1.0], [-(omega**2), -2 * zeta * omega]],
            [[0.0], [gain]],
            [[-(omega**2), -2 * zeta * omega]],
            [[gain]],
        )
        response += lsim(system, force, time)[1]
    rng = np.random.default_rng(4)
    response += NOISE * np.std(response) * rng.standard_normal(time.size)
    return Recording("hits", FS, response, force=force, quantity="acceleration", unit="m/s2")


def test_both_are_listed_with_errors_that_hold(struck: Recording) -> None:
    assert len(find_free_motion(struck).blows) == len(BLOWS)
    assert linear_modes(struck) == ()  # nothing is asked behind blows unless it is wanted
    for mode, (frequency, zeta, _) in zip(modes_of([struck], struck=True), MODES, strict=True):
        assert mode.errors is not None
        assert abs(mode.frequency - frequency) < 3.5 * mode.errors[0] < 1e-4 * frequency
        assert abs(mode.damping_ratio - zeta) < 3.5 * mode.errors[1] < 1e-2 * zeta


@pytest.mark.parametrize(("wanted", "said"), [(30.0, False), (32.5, True)])
def test_the_model_is_of_the_wanted_mode_or_says_why_not(struck: Recording, wanted: float, said: bool) -> None:
    found = identify([struck], name="rig", wanted=wanted, doubted=False)
    model = found.oscillator.parameters()
    assert model["omega0"].value == pytest.approx(2 * np.pi * 30.0, rel=1e-5)
    assert model["mass"].value == pytest.approx(2.0, rel=5e-3)
    assert model["further-mode.frequency"].value == pytest.approx(2 * np.pi * 32.5, rel=1e-5)
    assert any("shows the mode at 32.5 Hz against the force" in note for note in found.notes) == said


@pytest.mark.parametrize("which", [0, 1])
def test_behind_each_blow_a_mode_is_left_alone(struck: Recording, which: int) -> None:
    modes = modes_of([struck], struck=True)
    alone = np.asarray(without_other_modes(struck, modes[which]).response)
    frequency, zeta, _ = MODES[which]
    omega = 2 * np.pi * frequency / FS
    for decay in find_free_motion(struck).decays:
        part = alone[decay.start : decay.stop]
        columns = Modes(np.array([omega]), np.array([zeta]), np.zeros((2, 2))).columns(part.size)
        left = part - columns @ np.linalg.lstsq(columns, part)[0]
        assert float(np.std(left)) == pytest.approx(NOISE * float(np.std(struck.response)), rel=0.1)
