"""The cases of `golden.py`: recordings, made here or at hand, and what identify and diagnose give of each.

A case is a function without arguments that gives plain data: numbers, words, lists and dictionaries of them. The cases
run against two commits, so they use only the public names of the package and of its examples.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import dashpot
import numpy as np
from dashpot import Model, Recording
from dashpot.examples.concealed.engine import Drive, simulate
from dashpot.examples.concealed.record import record
from dashpot.examples.concealed.suite import Spec
from dashpot.examples.concealed.virtual import Trial, draw
from dashpot.examples.lies import STANDS, Stand, lies, told
from dashpot.examples.truth import TRUTH
from dashpot.examples.virtual_recording import recording_of

Run = Callable[[], dict[str, Any]]
#: Peak force N and first and last frequency, Hz, of the sweeps of the paper's rig.
SWEEP = (1.0, 8.0, 18.0)
SHOWN = {"displacement": "m", "acceleration": "m/s2"}


# What is kept of an answer.


def identified(*given: Any, **options: Any) -> dict[str, Any]:
    """Everything that an identification says: the model with its covariance, the notes, each segment, the zeros."""
    model = dashpot.identify(*given, **options)
    found = model.identification
    assert found is not None
    segments = [
        {"samples": s.segment.n, "initial": s.initial, "nrmse": s.nrmse, "over_noise": s.over_noise}
        for s in found.fit.segments
    ]
    zeros = [
        {"channel": z.channel, "recording": z.recording, "value": z.value, "std": z.std} for z in found.fit.offsets
    ]
    return {"model": shown(model), "notes": list(model.notes), "segments": segments, "zeros": zeros}


def diagnosed(model: Model, training: Sequence[Recording], held: Sequence[Recording] = ()) -> dict[str, Any]:
    """Everything that a diagnosis says: its file, and the mended model."""
    found = dashpot.diagnose(model, list(training), holdout=list(held))
    told = {key: value for key, value in found.as_json().items() if key != "work"}  # which a change may well change
    return {"diagnosis": told, "mended": shown(found.model)}


def shown(model: Model) -> dict[str, Any]:
    """The model as data, but for what made it."""
    data = model.as_json()
    for name in ("software", "commit", "versions", "command"):  # of who made it, and no result
        data["identified"].pop(name, None)
    return data


# Recordings.


def paper(kind: str, **options: Any) -> list[Recording]:
    """A recording of the built-in stand."""
    return dashpot.read(dashpot.examples.recordings()[kind], **options)


def with_zero_force(recording: Recording, zero: float) -> Recording:
    """The recording with a load cell that shows so much, N, at zero."""
    assert recording.force is not None
    return replace(recording, force=recording.force + zero)


def driven(
    drive: Drive,
    *,
    fs: float = 400.0,
    x0: float = 0.0,
    mass: float = 0.5,
    noise: float = 2e-6,
    seed: int = 0,
    name: str = "run",
    **parameters: float,
) -> Recording:
    """A recording of a rig of 8 Hz and 1 % damping that the examples' own engine simulates.

    `parameters` are those of ``rig.h``, per unit mass; `noise` m; the force is commanded, without noise.
    """
    omega = 2 * np.pi * 8.0
    rig = {"omega": omega, "omega2": omega**2, "viscous": 0.02 * omega, "amplitude": 3e-3, "mass": mass}
    samples = round(drive.length * fs)
    response = simulate(rig | {"force": drive.peak / mass} | parameters, drive, x0, fs, samples)
    x = response.x + noise * np.random.default_rng(seed).standard_normal(samples)
    return Recording(name, fs, x, None if drive.kind == "none" else response.force)


def held_force(seed: int, seconds: float, fs: float) -> Drive:
    """A force that stays at a random value, N, from each sample to the next."""
    levels = np.random.default_rng(seed).standard_normal(round(seconds * fs))
    return Drive("straight", 10.0, length=seconds, lines=np.column_stack([levels, np.zeros(levels.size)]))


def let_go(amplitudes: Sequence[float], **parameters: float) -> list[Recording]:
    """Decays of the rig of `driven` from those displacements, m."""
    drive = Drive("none", length=5.0)
    return [driven(drive, x0=x, seed=i, name=f"release {i + 1}", **parameters) for i, x in enumerate(amplitudes)]


def two_modes(second: float) -> Recording:
    """A decay of two modes, the second so many times as fast as the first, of 12 Hz; both begin with 0.3 m/s."""
    t = np.arange(8000) / 1000.0
    x = 2e-6 * np.random.default_rng(3).standard_normal(t.size)
    for omega, zeta in ((2 * np.pi * 12.0, 0.004), (2 * np.pi * 12.0 * second, 0.006)):
        x += 0.3 / omega * np.exp(-zeta * omega * t) * np.sin(omega * t)
    return Recording("two modes", 1000.0, x)


def concealed(
    effect: str, variant: str = "", *, seed: int = 1, experiment: str = "shaker", quantity: str = "displacement"
) -> tuple[Model, list[Recording], list[Recording]]:
    """The base of a virtual rig as a model, its recordings, and those held out; sweeps of 60 to 100 cycles."""
    single = Spec("single", (effect,), (variant,), "white", 0) if effect else Spec("none", (), (), "white", 0)
    trial = Trial(experiment, quantity)
    virtual = draw(single, seed, cycles=(60.0, 100.0), trial=trial)
    tables, _ = record(virtual)
    names = trial.plan.training, trial.plan.held_out
    training, held = ([_of_table(name, tables[name], quantity) for name in group] for group in names)
    known = virtual.base.parameters
    values = {name: known[name] for name in ("mass", "cubic", "preload", "viscous", "dry")}
    model = Model.from_values(values | {"omega0": virtual.base.omega}, quantity=quantity, unit=SHOWN[quantity])
    return model, training, held


def _of_table(name: str, table: np.ndarray, quantity: str) -> Recording:
    """A recording of a virtual rig, (n, 3)."""
    force = table[:, 1] if np.any(np.abs(table[:, 1]) > 0) else None
    return Recording(name, float(1 / (table[1, 0] - table[0, 0])), table[:, 2], force, quantity, SHOWN[quantity])


def of_the_chain(name: str, stand: Stand) -> list[Recording]:
    """The recordings of a stand, one of them with that fault of the measuring chain."""
    return told(stand, next(lie for lie in lies(stand) if lie.name == name))


# The cases.


def _paper_rig() -> dict[str, Run]:
    """Eq. 17 by quantity and kind of drive."""

    def decay(quantity: str) -> Run:
        return lambda: identified(recording_of(begin=(9e-3, 0.0), seconds=4.0, quantity=quantity, noise=2e-6))

    def sweep(quantity: str) -> Run:
        return lambda: identified(recording_of(sweep=SWEEP, seconds=12.0, quantity=quantity, force_noise=1e-3))

    def both() -> dict[str, Any]:
        free = recording_of(begin=(8e-3, 0.0), seconds=4.0, name="decay")
        return identified(free, recording_of(sweep=SWEEP, seconds=10.0, force_noise=1e-3, name="sweep"))

    def zeros() -> dict[str, Any]:
        sweep = recording_of(sweep=SWEEP, seconds=12.0, offset=3e-4, force_noise=1e-3)
        return identified(with_zero_force(sweep, 0.05))

    def with_mass() -> dict[str, Any]:
        return identified(recording_of(begin=(9e-3, 0.0), seconds=4.0), mass=TRUTH["mass"])

    def fixed() -> dict[str, Any]:
        sweep = recording_of(sweep=SWEEP, seconds=10.0, force_noise=1e-3, seed=4)
        return identified(sweep, fixed={"preload": TRUTH["preload"], "dry": TRUTH["dry"]})

    def started() -> dict[str, Any]:
        sweep = recording_of(sweep=SWEEP, seconds=10.0, force_noise=1e-3, seed=5)
        return identified(sweep, start=Model.from_values(TRUTH | {"omega0": 81.0, "viscous": 6.0}))

    quantities = "displacement", "velocity", "acceleration"
    made = {f"decay {quantity}": decay(quantity) for quantity in quantities}
    made |= {f"sweep {quantity}": sweep(quantity) for quantity in quantities}
    return made | {
        "decay and sweep": both,
        "zeros of sensor and load cell": zeros,
        "decay of three cycles": lambda: identified(recording_of(begin=(9e-3, 0.0), seconds=0.24)),
        "decay of a known mass": with_mass,
        "two parameters fixed": fixed,
        "from another model": started,
        "stand: bursts": lambda: identified(paper("bursts", part="0:12")),
        "stand: multisine": lambda: identified(paper("multisine", part="0:8")),
    }


def _other_drives() -> dict[str, Run]:
    """Held forces, hammer, random force, releases, laws, a long record."""

    def held(hold: str | None) -> Run:
        def run() -> dict[str, Any]:
            recording = driven(held_force(1, 20.0, 120.0), fs=120.0, cubic=4e7)
            return identified(recording if hold is None else replace(recording, hold=hold))

        return run

    def hammer(quantity: str) -> Run:
        return lambda: identified(concealed("", experiment="hammer", quantity=quantity)[1][0])

    def random() -> dict[str, Any]:
        return identified(concealed("", experiment="random", quantity="acceleration", seed=2)[1][:1])

    def with_law() -> dict[str, Any]:
        return identified(let_go((3e-3, 1.5e-3), drag=20.0), laws=["quadratic-drag"])

    def long() -> dict[str, Any]:
        drive = Drive("linear", 0.3, 6.0, 10.0, 800.0, 1.0)
        recording = driven(drive, fs=330.0, seed=7, name="long")
        return identified(with_zero_force(recording, 0.02))

    return {
        "held force, found": held(None),
        "held force, said": held("zero"),
        "held force, taken for lines": held("linear"),
        "hammer, displacement": hammer("displacement"),
        "hammer, accelerometer": hammer("acceleration"),
        "random force, accelerometer": random,
        "three releases": lambda: identified(let_go((3e-3, 2e-3, 1e-3), dry=0.02)),
        "releases with a law": with_law,
        "264,000 samples and a zero of the load cell": long,
        "mode 1 of 2": lambda: identified(two_modes(3.4), mode=1),
        "mode 2 of 2": lambda: identified(two_modes(3.4), mode=2),
        "two close modes": lambda: identified(two_modes(1.04)),
    }


def _faults() -> dict[str, Run]:
    """The measuring chain, with --faults."""

    def asked(stand: str, name: str) -> Run:
        return lambda: identified(of_the_chain(name, STANDS[stand]), faults=True)

    kinds = (
        ("slow", "response x0.8"),
        ("slow", "late by 0.06 cycles"),
        ("slow", "zero steps by 5 %"),
        ("slow", "clock 2 % fast"),
        ("slow", "clipped at 80 %"),
        ("built-in", "force hum in the band, 5 %"),
        ("built-in", "a block lost"),
        ("built-in", "another rig, 10 %"),
        ("fast", "walk of 5 %"),
    )
    return {f"fault: {name}": asked(stand, name) for stand, name in kinds}


def _diagnoses() -> dict[str, Run]:
    """Concealed effects, and nothing concealed."""

    def of(effect: str, variant: str = "", held_out: int = 1, **options: Any) -> Run:
        def run() -> dict[str, Any]:
            model, recordings, held = concealed(effect, variant, **options)
            return diagnosed(model, recordings, held[:held_out])

        return run

    def backlash() -> dict[str, Any]:
        stand = dashpot.examples.recordings("paper-stand-backlash")
        return diagnosed(Model.from_values(TRUTH), dashpot.read(stand["bursts"], part="0:8"))

    def decays(**parameters: float) -> Run:
        def run() -> dict[str, Any]:
            values = {"omega0": 50.0, "cubic": 0.0, "preload": 0.0, "viscous": 1.0, "dry": 0.0}
            return diagnosed(Model.from_values(values), let_go((3e-3, 2e-3, 1e-3), **parameters))

        return run

    return {
        "diagnosis: nothing concealed": of(""),
        "diagnosis: quadratic drag": of("quadratic-drag"),
        "diagnosis: two-sided stop": of("two-sided-stop", "mirrored"),
        "diagnosis: hysteresis": of("hysteresis", "dahl"),
        "diagnosis: actuator lag": of("actuator-lag"),
        "diagnosis: stribeck": of("stribeck", "gaussian"),
        "diagnosis: softening": of("softening-stiffness", "sine"),
        "diagnosis: resonator": of("attached-resonator"),
        "diagnosis: sensor": of("sensor-nonlinearity", "square"),
        "diagnosis: drifting stiffness": of("stiffness-drift", "linear"),
        "diagnosis: a tone": of("tonal-disturbance"),
        "diagnosis: hammer, quintic": of("quintic-stiffness", experiment="hammer"),
        "diagnosis: accelerometer, random, drag": of("quadratic-drag", experiment="random", quantity="acceleration"),
        "diagnosis: nothing held out": of("cubic-damping", held_out=0),
        "diagnosis: stand with backlash": backlash,
        "diagnosis: decays, drag": decays(drag=20.0),
        "diagnosis: decays, nothing": decays(),
    }


def _refusals() -> dict[str, Run]:
    """What cannot be used, and the sentence that says so."""
    sine = np.sin(2 * np.pi * 5.0 * np.arange(2000) / 400.0)

    def still() -> dict[str, Any]:
        return identified(Recording("still", 400.0, np.zeros(1000)))

    def noise() -> dict[str, Any]:
        return identified(Recording("noise", 400.0, np.random.default_rng(0).standard_normal(2000)))

    def mixed() -> dict[str, Any]:
        decay = recording_of(begin=(9e-3, 0.0), seconds=3.0)
        return identified(decay, replace(decay, name="other", unit="rad", response=2.0 * decay.response))

    def no_such_parameter() -> dict[str, Any]:
        return identified(recording_of(begin=(9e-3, 0.0), seconds=3.0), fixed={"drry": 1.0})

    def other_unit() -> dict[str, Any]:
        decay = recording_of(begin=(9e-3, 0.0), seconds=3.0)
        return diagnosed(Model.from_values(TRUTH), [replace(decay, unit="rad")])

    def no_force_moves_it() -> dict[str, Any]:
        return identified(Recording("constant", 400.0, sine, 0.0 * sine))

    return {
        "refused: a still sensor": still,
        "refused: noise": noise,
        "refused: a steady sine": lambda: identified(Recording("sine", 400.0, sine)),
        "refused: two units": mixed,
        "refused: a parameter that is none": no_such_parameter,
        "refused: no such law": lambda: identified(recording_of(begin=(9e-3, 0.0), seconds=3.0), laws=["quadratic"]),
        "refused: a model in m, a recording in rad": other_unit,
        "refused: a force that moves nothing": no_force_moves_it,
        "refused: no recording": lambda: identified(),
    }


def data_folder() -> Path:
    """Where the recordings of other people are: $DASHPOT_DATA, or shared/data beside the checkout."""
    return Path(os.environ.get("DASHPOT_DATA") or Path(__file__).resolve().parents[2] / "shared" / "data")


def _at_hand() -> dict[str, Run]:
    """Recordings of other people, where they are there."""

    def of(*files: str, **options: Any) -> Run:
        return lambda: identified([data_folder() / file for file in files], **options)

    def sloshing() -> dict[str, Any]:
        recordings = dashpot.read(data_folder() / "sloshing_0.csv.gz")
        return diagnosed(dashpot.identify(recordings), recordings)

    given: Mapping[str, tuple[tuple[str, ...], dict[str, Any]]] = {
        "bicycle wheel": (("bicycle_wheel_axial_decay.csv.gz",), {}),
        "torsion pendulum": (("torsion_lab_decay_01rad.csv.gz",), {"force": "none", "response": "angle_V"}),
        "leg": (("leg_pendulum.csv.gz",), {}),
        "sloshing": (("sloshing_0.csv.gz",), {}),
        "held sweep": (("held_sweep_drag_2N.csv.gz",), {}),
        "flexible link": (
            ("flexible_link_swept1_0_10hz.csv.gz",),
            {"force": "motor_counts", "response": "hub_counts", "quantity": "displacement"},
        ),
        "six releases": (("releases_six.csv.gz",), {}),
        "plucks": (("plucks_regular.csv.gz",), {}),
    }
    at_hand = {
        f"at hand: {name}": of(*files, **options)
        for name, (files, options) in given.items()
        if all((data_folder() / file).is_file() for file in files)
    }
    if "at hand: sloshing" in at_hand:
        at_hand["at hand: diagnosis of the sloshing"] = sloshing
    return at_hand


def cases() -> dict[str, Run]:
    """All cases by name; those at hand only where their files are."""
    groups = (_paper_rig, _other_drives, _faults, _diagnoses, _refusals, _at_hand)
    return {name: run for group in groups for name, run in group().items()}
