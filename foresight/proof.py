"""A user's own rig proved on: simulated with noise, identified again, and the stated errors counted.

Of errors that hold, 68.3 % of the estimates lie within one, 95.4 % within two and 99.7 % within three of them. So few
within that chance would show it less than once in a thousand, over all that is counted, and the errors do not hold.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import BadInput, DashpotError
from ..identify.identification import identify
from ..identify.signals.odds import BY_CHANCE
from ..identify.signals.registry import numerics
from ..model import Oscillator
from ..model.show import columns_text
from ..recording.recording import Recording
from .excitation import Excitation
from .virtual import DENSITY, Integrator, Noise, natural_hz, recordings_of_plan, simulated, without_errors

_WITHIN = (1, 2, 3)
_CYCLES = numerics(90.0, "natural cycles", why="as long as a proposed experiment is")
_BAND = numerics((0.6, 1.6), "times the natural frequency", why="a resonance with its flanks")
_NEAR = numerics(0.9, "of the stroke", why="to which a sweep is brought")
_ROUNDS = numerics(5, "simulations", why="in which its level is found")


@dataclass(frozen=True)
class Coverage:
    """How one parameter came out.

    Attributes:
        name: of the parameter.
        truth: in ``unit``.
        unit: of the parameter.
        runs: in which it was identified with an error.
        left_out: runs that left it at zero.
        within: share of the runs within one, two and three stated errors of the truth.
        mean: of the errors, in stated ones; rms of them beside it.
        rms: should be one.
        std: median of the stated errors.
    """

    name: str
    truth: float
    unit: str
    runs: int
    left_out: int
    within: tuple[float, float, float]
    mean: float
    rms: float
    std: float


@dataclass(frozen=True, eq=False, repr=False)
class Proof:
    """What came of it.

    Attributes:
        name: of the rig.
        tests: what was played.
        fs: samples a second.
        noise: of the sensors.
        simulated_by: what made the recordings, in words.
        asked: how many runs.
        failed: sentences of runs that no model came of.
        parameters: one a parameter.
        hidden: the law that was concealed; None without one.
        named: by run what the diagnosis named.
        doubts: sentences on errors that do not hold, or names that are wrong.
    """

    name: str
    tests: tuple[Excitation, ...]
    fs: float
    noise: Noise
    simulated_by: str
    asked: int
    failed: tuple[str, ...]
    parameters: tuple[Coverage, ...]
    hidden: str | None
    named: tuple[tuple[str, ...], ...]
    doubts: tuple[str, ...]

    @property
    def passed(self) -> bool:
        """Whether the errors hold, and what was concealed was named."""
        return not self.doubts

    def __repr__(self) -> str:
        return describe(self)

    def as_json(self) -> dict[str, Any]:
        """The same as plain data for ``json.dumps``."""
        return {
            "format": "dashpot-proof/1",
            "name": self.name,
            "tests": [test.sentence() for test in self.tests],
            "fs": self.fs,
            "noise": {"response": self.noise.sensor, "force": self.noise.force},
            "simulated_by": self.simulated_by,
            "runs": self.asked,
            "failed": list(self.failed),
            "parameters": {
                c.name: {
                    "truth": c.truth,
                    "unit": c.unit,
                    "runs": c.runs,
                    "left_out": c.left_out,
                    "within": list(c.within) if c.runs else None,
                    "mean": _finite(c.mean),
                    "rms": _finite(c.rms),
                    "std": _finite(c.std),
                }
                for c in self.parameters
            },
            "hidden": self.hidden,
            "named": [list(names) for names in self.named],
            "passed": self.passed,
            "doubts": list(self.doubts),
        }


#: Names the laws that recordings show beyond a model; the model is what was identified of them.
Diagnosing = Callable[[Oscillator, Sequence[Recording]], Sequence[str]]


def prove(
    model: Oscillator,
    tests: Sequence[Excitation],
    noise: Noise,
    *,
    fs: float,
    runs: int = 20,
    seed: int = 0,
    integrator: tuple[str, Integrator] | None = None,
    hidden: str | None = None,
    diagnosing: Diagnosing | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Proof:
    """Simulate a rig with noise, identify it again, and count the stated errors that hold.

    Args:
        model: the rig.
        tests: what is played.
        noise: of the sensors.
        fs: samples a second.
        runs: how often.
        seed: of the noise.
        integrator: what simulates, with its name in words; the engine that also identifies where None.
        hidden: a law of the model that the identification is not told of.
        diagnosing: says what a model lacks that recordings show; needed with ``hidden``.
        progress: called with one line a run.

    Raises:
        BadInput: the rig has no such law, or does not simulate.
    """
    model = without_errors(model)
    effects = [term.effect for term in model.terms]
    if hidden is not None and hidden not in effects:
        there = f"it has {', '.join(effects)}" if effects else "it has none: add one to the model file"
        raise BadInput(f"{model.name}: there is no law {hidden!r} in it to hide; {there}")
    if hidden is not None:
        hidden, effect = next((t.law.effect, t.effect) for t in model.terms if t.effect == hidden)
        effects = [other for other in effects if other != effect]
    words, simulate = integrator or ("the engine that also identifies", simulated)
    progress(f"simulated by {words}")
    clean = [simulate(model, test, fs) for test in tests]
    fixed = {} if model.mass is None or any(test.kind != "decay" for test in tests) else {"mass": model.mass.value}
    found: list[Oscillator] = []
    failed: list[str] = []
    named: list[tuple[str, ...]] = []
    for run in range(runs):
        progress(f"run {run + 1} of {runs}")
        given = recordings_of_plan(model, tests, clean, fs, noise, (seed, run))
        try:
            again = identify(given, effects=effects, fixed=fixed, every=False).oscillator
            if hidden is not None and diagnosing is not None:
                named.append(tuple(diagnosing(again, given)))
            found.append(again)
        except DashpotError as problem:
            failed.append(f"run {run + 1}: {problem}")
    compared = (
        ()
        if hidden is not None
        else tuple(_coverage(name, model, found) for name in model.parameters() if name not in fixed)
    )
    return Proof(
        name=model.name,
        tests=tuple(tests),
        fs=fs,
        noise=noise,
        simulated_by=words,
        asked=runs,
        failed=tuple(failed),
        parameters=compared,
        hidden=hidden,
        named=tuple(named),
        doubts=tuple(_doubts(compared, failed, hidden, named, runs)),
    )


def usual_tests(model: Oscillator, amplitude: float, *, force: bool) -> tuple[tuple[Excitation, ...], float]:
    """A release and, where a force can be played, a sweep, up to an amplitude; and the samples a second for them.

    Raises:
        BadInput: where nothing simulates.
    """
    low, high = natural_hz(model, amplitude)
    fs = float(f"{DENSITY * high:.2g}")
    seconds = float(f"{_CYCLES / low:.2g}")
    release = Excitation("decay", amplitude, 1.0, (low, high), seconds)
    if not force or model.mass is None:
        return (release,), fs
    stiff = model.mass.value * (2 * np.pi * high) ** 2 * amplitude
    sweep = Excitation("sweep", stiff, 1.0, (_BAND[0] * low, _BAND[1] * high), seconds)
    scale = model.omega0.value ** ("displacement", "velocity", "acceleration").index(model.response.quantity)
    level, most = 0.1 * stiff, 0.0
    for _ in range(_ROUNDS):
        try:
            peak = float(np.max(np.abs(simulated(model, Excitation("sweep", level, 1.0, sweep.band_hz, seconds), fs))))
        except BadInput:
            level *= 0.5
            continue
        if peak <= amplitude * scale:
            most = max(most, level)
        level *= float(np.clip(_NEAR * amplitude * scale / max(peak, np.finfo(float).tiny), 0.2, 5.0))
    if not most > 0:
        return (release,), fs
    return (release, Excitation("sweep", float(f"{most:.3g}"), 1.0, sweep.band_hz, seconds)), fs


def _coverage(name: str, model: Oscillator, found: Sequence[Oscillator]) -> Coverage:
    truth = model.parameters()[name]
    known = [again.parameters().get(name) for again in found]
    told = [p for p in known if p is not None and p.std is not None and p.std > 0]
    z = np.array([(p.value - truth.value) / p.std for p in told if p.std])
    within = tuple(float(np.mean(np.abs(z) <= k)) if z.size else math.nan for k in _WITHIN)
    return Coverage(
        name=name,
        truth=truth.value,
        unit=truth.unit,
        runs=len(told),
        left_out=len(known) - len(told),
        within=(within[0], within[1], within[2]),
        mean=float(np.mean(z)) if z.size else math.nan,
        rms=float(np.sqrt(np.mean(z**2))) if z.size else math.nan,
        std=float(np.median([p.std for p in told if p.std])) if told else math.nan,
    )


def _doubts(
    parameters: Sequence[Coverage],
    failed: Sequence[str],
    hidden: str | None,
    named: Sequence[Sequence[str]],
    runs: int,
) -> list[str]:
    doubts = []
    asked = max(len(parameters) * len(_WITHIN), 1)
    for c in parameters:
        for k, share in zip(_WITHIN, c.within, strict=True):
            if not c.runs or by_chance(round(share * c.runs), c.runs, math.erf(k / math.sqrt(2))) > BY_CHANCE / asked:
                continue
            doubts.append(
                f"the errors of {c.name} do not hold: {round(share * c.runs)} of {c.runs} lie within {k} of them, "
                f"where {100 * math.erf(k / math.sqrt(2)):.3g} % should"
            )
            break
    if failed:
        doubts.append(f"{len(failed)} of {runs} runs gave no model: {failed[0]}")
    if hidden is not None:
        right = sum(hidden in names for names in named)
        if 2 * right <= runs:
            others = sorted({other for names in named for other in names if other != hidden})
            doubts.append(
                f"{hidden} was named in {right} of {runs} runs"
                + (f"; named were {', '.join(others)}" if others else "")
            )
    return doubts


def by_chance(within: int, runs: int, share: float) -> float:
    """How probable so few or fewer of so many are where each is within with that probability (binomial)."""
    return sum(math.comb(runs, k) * share**k * (1 - share) ** (runs - k) for k in range(within + 1))


def describe(proof: Proof) -> str:
    """The proof as text: what was done, a table of parameters, what does not hold."""
    lines = [f"{proof.name}, {proof.asked} times simulated by {proof.simulated_by}, at {proof.fs:g} Hz:"]
    lines += [f"  {test.sentence()}" for test in proof.tests]
    if proof.parameters:
        cells: list[tuple[str, ...]] = [
            ("parameter", "truth", "stated error", "within 1, 2, 3 of it", "mean", "rms", "")
        ]
        for c in proof.parameters:
            shares = " ".join(f"{100 * share:.0f}" for share in c.within) + " %" if c.runs else "left at zero"
            out = f"left at zero {c.left_out} times" if c.left_out and c.runs else ""
            numbers = (f"{c.std:.2g} {c.unit}", shares, f"{c.mean:+.2f}", f"{c.rms:.2f}", out)
            cells.append((c.name, f"{c.truth:.6g}", *(numbers if c.runs else ("", shares, "", "", out))))
        lines += ["", *columns_text(cells), "  of errors that hold 68, 95 and 99.7 % lie within"]
    if proof.hidden is not None:
        right = sum(proof.hidden in names for names in proof.named)
        lines += ["", f"{proof.hidden}, which the model was not told of, was named in {right} of {proof.asked} runs"]
        lines += [f"  run {i + 1}: {', '.join(names) or 'nothing'}" for i, names in enumerate(proof.named)]
    lines += ["", *(proof.doubts or ("The errors hold." if proof.hidden is None else "What was concealed was named.",))]
    return "\n".join(lines)


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
