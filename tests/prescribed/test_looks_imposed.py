"""What is said where a test machine's recording is taken for a rig's, and never of a rig that a force drives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.specimens import Specimen, motion, recorded
from dashpot.face.workflow import identified
from dashpot.prescribed.looks_imposed import Along, along_motions, told
from dashpot.recording import Recording
from scipy.integrate import solve_ivp

FS = 100.0
STRUT = Specimen({"inertia": 0.5, "stiffness": 9e3, "viscous": 700.0, "dry": 35.0, "load": 120.0})


def imposed(specimen: Specimen = STRUT, kind: str = "sweep") -> Recording:
    """Not said to be: as a file that nobody asked about."""
    made = recorded(specimen, motion(kind, 6e-3, 2.0, FS, 6.0), FS, noise=3e-3, motion_noise=2e-5, seed=1)
    return replace(made, name="strut.csv", prescribed=False)


def driven(drag: float, seed: int = 0) -> Recording:
    """A mass on a spring with drag, driven by a sweep through its resonance."""
    t = np.arange(6000) / 400.0

    def push(at: float) -> float:
        return 60.0 * np.sin(2 * np.pi * (4.0 * at + 0.2 * at**2))

    def rates(at: float, z: np.ndarray) -> list[float]:
        return [z[1], (push(at) - 3e4 * z[0] - 65.0 * z[1] - drag * z[1] * abs(z[1])) / 12.0]

    x = solve_ivp(rates, (0.0, t[-1]), [0.0, 0.0], t_eval=t, rtol=1e-9, atol=1e-12, max_step=1e-2).y[0]
    noise = np.random.default_rng(seed).standard_normal((2, t.size))
    force = np.array([push(float(at)) for at in t]) + 0.05 * noise[1]
    return Recording("rig.csv", 400.0, x + 1e-5 * noise[0], force)


def test_inertia_takes_little_along_an_imposed_motion_and_much_in_a_rig() -> None:
    machine, rig = along_motions([imposed()]), along_motions([driven(260.0)])
    assert machine is not None
    assert rig is not None
    assert machine.left == pytest.approx(3e-3, rel=0.2)
    assert machine.inertia < 0.05
    assert machine.heavy > 10 * machine.left
    assert rig.inertia > 1.5


def test_a_machines_recording_is_told_from_a_rigs() -> None:
    found = identified(lambda: [imposed()])
    said = [note for note in found.notes if "imposed" in note]
    assert len(said) == 1
    assert said[0].startswith("the motion looks imposed, as a test machine does: as an oscillator ")
    assert "--prescribed with the column of the motion finds the force law by itself" in said[0]


def test_nothing_is_said_of_a_rig_with_missing_physics() -> None:
    found = identified(lambda: [driven(800.0)])
    assert max(part.over_noise for part in found.fit.segments) > 1.5
    assert not [note for note in found.notes if "imposed" in note]


@pytest.mark.parametrize(
    ("along", "left", "said"),
    [
        (Along(0.05, 0.1, 0.5), 0.2, True),
        (Along(0.05, 0.1, 0.5), 0.06, False),  # the oscillator is no worse
        (Along(0.05, 1.1, 0.5), 0.2, False),  # a mass that matters
        (Along(0.05, 0.1, 0.06), 0.2, False),  # one frequency: the mass is not told
    ],
)
def test_all_of_it_must_hold(along: Along, left: float, said: bool) -> None:
    assert told(along, left) is said


def test_what_no_machine_can_have_imposed_is_not_asked() -> None:
    one = imposed()
    assert along_motions([replace(one, force=None)]) is None
    assert along_motions([replace(one, base="whole")]) is None
    assert along_motions([replace(one, quantity="acceleration", unit="m/s2")]) is None
