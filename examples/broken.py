"""The paper's stand with one law more: what `dashpot demo --break LAW` breaks, and what its sensors record of it.

The stand and its sizes are those of `truth.py`. The law and the motion come from the integrator of the concealed rigs,
which shares no code with the product; the law has the middle of the sizes that are drawn there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .concealed.base import Base
from .concealed.effects import EVERYTHING, PARTS_OF_FORCE, SINGLE
from .concealed.engine import Drive, simulate
from .concealed.make import write_recording
from .truth import TRUTH

#: How it is recorded: Hz; standard deviations of the sensors, m, and part of the peak force.
FS, SENSOR_NOISE, FORCE_NOISE = 500.0, 1e-6, 1e-3
#: m, where it is let go and what the strong sweep of the unbroken stand reaches; N, the strong sweep.
AMPLITUDE, STRONG = 8e-3, 1.0
TRAINING = ("sweep_high", "sweep_low", "ringdown")
HELD_OUT = ("holdout_multisine",)
#: Laws of the library that are one of several variants of an effect; of the others the first variant is taken.
_VARIANTS = {
    "softening-stiffness/sine": "sine",
    "asymmetric-friction": "viscous",
    "asymmetric-friction/dry": "dry",
    "actuator-saturation/soft": "smooth",
    "stiffness-drift/settling": "exponential",
}
#: Forces of the recordings, N: two sweeps of 5 to 20 Hz, a decay, a multisine as strong as a sine of 0.6 N.
_SWEEP = Drive("linear", STRONG, 6.0, 19.0, 24.0, 0.3)
_LINES = np.arange(130, 361) / 20.0


def _plans() -> dict[str, tuple[Drive, float, float]]:
    """Force, place of release m and length s of each recording."""
    phases = np.random.default_rng(20).uniform(0.0, 2 * np.pi, _LINES.size)
    lines = np.column_stack([_LINES, np.full(_LINES.size, 1 / np.sqrt(_LINES.size)), phases])
    weak = Drive("linear", 0.4 * STRONG, _SWEEP.start, _SWEEP.end, _SWEEP.length, _SWEEP.ramp)
    return {
        "sweep_high": (_SWEEP, 0.0, _SWEEP.length),
        "sweep_low": (weak, 0.0, weak.length),
        "ringdown": (Drive("none"), AMPLITUDE, 4.0),
        "holdout_multisine": (Drive("multisine", 0.6, length=20.0, ramp=0.3, lines=lines), 0.0, 20.0),
    }


class _Middle:
    """What draws sizes, in place of a random generator: the middle of every range."""

    def uniform(self, low: float = 0.0, high: float = 1.0) -> float:
        return 0.5 * (low + high)

    def choice(self, options: Sequence[Any]) -> Any:
        return options[len(options) // 2]

    def permutation(self, options: Sequence[Any]) -> Sequence[Any]:
        return options


def can_break(law: str) -> bool:
    """Whether the integrator of the concealed rigs has the law."""
    return law.partition("/")[0] in SINGLE


def sizes(law: str, strength: float = 1.0) -> dict[str, float]:
    """What is added to the stand, by the names of `concealed/rig.h`; limits of the force as parts of the strong sweep.

    Physics of no list goes too, by its name in `concealed/effects.py`. Raises ValueError for what the integrator does
    not have.
    """
    effect = EVERYTHING.get(law.partition("/")[0])
    if effect is None:
        raise ValueError(f"the integrator of the concealed rigs has no law {law!r}; it has {', '.join(EVERYTHING)}")
    drawn = effect.draw(_Middle(), _base(), _VARIANTS.get(law, effect.variants[0]), strength)  # type: ignore[arg-type]
    return {name: float(value) for name, value in drawn.items()}


def _base() -> Base:
    omega = TRUTH["omega0"]
    values = {name: TRUTH[name] for name in ("mass", "viscous", "cubic", "preload", "dry")}
    parameters = {**values, "omega2": omega**2, "omega": omega, "amplitude": AMPLITUDE}
    return Base(omega, AMPLITUDE, TRUTH["viscous"] / (2 * omega), parameters, FS, _SWEEP.length, SENSOR_NOISE)


@dataclass(frozen=True, eq=False)
class Record:
    """What the sensors show of one run: force N, None where nothing drives it, and displacement m, (n,) each."""

    name: str
    force: np.ndarray | None
    shown: np.ndarray

    @property
    def table(self) -> np.ndarray:
        """(n, 3) time s, force, displacement; (n, 2) without a force."""
        given = [] if self.force is None else [self.force]
        return np.column_stack([np.arange(self.shown.size) / FS, *given, self.shown])


def records(law: str = "", strength: float = 1.0, names: Sequence[str] = (), noise: bool = True) -> list[Record]:
    """The recordings of the stand with a law, or of the stand as it is where that is empty.

    Args:
        law: its name in the library.
        strength: times the middle of the sizes that are drawn in the blind proof.
        names: of recordings; none: all.
        noise: whether the sensors have any.

    Raises:
        ValueError: the integrator does not have the law; RuntimeError: there is no compiler.
    """
    rig: Mapping[str, float] = _base().parameters
    if law:
        more = {k: v * (STRONG if k in PARTS_OF_FORCE else 1.0) for k, v in sizes(law, strength).items()}
        rig = {**rig, **more}
    rig = {**rig, "force": STRONG / TRUTH["mass"]}
    made = []
    for name, (drive, x0, length) in _plans().items():
        if names and name not in names:
            continue
        run = simulate(rig, drive, x0, FS, round(length * FS))
        record = Record(name, run.force if drive.peak else None, run.shown)
        made.append(with_noise(record) if noise else record)
    return made


def with_noise(record: Record) -> Record:
    """The recording as the sensors show it; each has a seed of its own."""
    noise = np.random.default_rng([0, list(_plans()).index(record.name)])
    force = record.force
    if force is not None:
        force = force + FORCE_NOISE * float(np.abs(force).max()) * noise.standard_normal(force.size)
    return Record(record.name, force, record.shown + SENSOR_NOISE * noise.standard_normal(record.shown.size))


def make(law: str, folder: str | Path = ".", strength: float = 1.0, names: Sequence[str] = ()) -> list[Path]:
    """Write the recordings of the stand with a law into a folder, as `records` makes them; returns their paths."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for record in records(law, strength, names):
        path = folder / f"{record.name}.csv.gz"
        write_recording(path, record.table)
        paths.append(path)
    return paths
