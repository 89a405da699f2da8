"""How often does `verify` err? Right models that fail, wrong models that pass; prints both over noises.

    python benchmarks/verify_errors.py [COUNT [LARGEST]]

COUNT recordings (200) of the built-in rig, in turn two bursts, a sweep and a free decay of 5 to 10 s, at 1 to LARGEST
(100) times the rig's noise. Each is held against the true model, which states no errors of its own, and every third
time against one identified from another draw of the same recording, with its covariance; then against each of these
with one parameter off by five standard errors, the parameters in turn: those that a fit to the recording would state,
or those that the identified model states. The core of the model runs in the FMU's place: the same function, which
tests/benchmarks/test_verify_errors.py checks.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from dashpot.errors import DashpotError
from dashpot.examples.force import chirp
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.rig import DT, FORCE_NOISE, FS, SENSOR_NOISE, force
from dashpot.examples.truth import TRUTH
from dashpot.identify import identify
from dashpot.model import Oscillator
from dashpot.model.law import InnerState
from dashpot.recording import Recording
from dashpot.simulate.core import core_of, internal_step
from dashpot.simulate.force import Force
from dashpot.verify import verification
from dashpot.verify.score import standard_errors

#: How many of its standard errors a wrong parameter is off by.
OFF = 5.0
#: Noises, evenly on a logarithmic scale.
LEVELS = 10
KINDS = ("bursts", "sweep", "decay")
NAMES = tuple(TRUTH)


@dataclass(frozen=True, eq=False)
class CoreRun:
    """What ``verify`` asks of an FMU, answered by the core of its model."""

    model: Oscillator
    inner: tuple[InnerState, ...] = ()
    hold: str = "smooth"
    force_unit: str = "N"

    def output_for(self, recording: Recording) -> str:
        """The output's name: what the recording shows of the motion."""
        return recording.quantity

    def record(
        self,
        pushed: Force | None,
        n: int,
        dt: float,
        initial: np.ndarray | None = None,
        start: float = 0.0,
        output: str | None = None,
    ) -> np.ndarray:
        """(n,) response, as ``FmuRun.record``."""
        core, values = core_of(self.model), self.model.values()
        state = np.zeros(core.states) if initial is None else initial
        step = internal_step(self.model, values, 1e-2)
        quantity = output or "displacement"
        return core.record(np.array([*values.values()]), state, pushed, n, dt, step, start=start, quantity=quantity)


@cache
def clean(kind: str) -> tuple[np.ndarray | None, np.ndarray]:
    """(n,) true force and (n,) displacement of a kind of recording, by the integrator of the examples."""
    if kind == "decay":
        return None, integrate_pieces(TRUTH, np.zeros((4999, 1)), DT, 8e-3, 0.1)[0]
    pieces = force("bursts")[:10_000] if kind == "bursts" else chirp(1.0, 8.0, 1.0, np.arange(10_000) / FS, DT)
    return pieces[:, 0], integrate_pieces(TRUTH, pieces[:-1], DT)[0]


def recorded(kind: str, times: float, seed: int) -> Recording:
    """A kind of recording at so many times the rig's noise."""
    random = np.random.default_rng([seed, KINDS.index(kind)])
    true, x = clean(kind)
    response = x + times * SENSOR_NOISE * random.standard_normal(x.size)
    if true is not None:
        true = true + times * FORCE_NOISE * np.max(np.abs(true)) * random.standard_normal(x.size)
    return Recording(name=f"{kind}.csv", fs=FS, response=response, force=true)


@cache
def identified(kind: str, times: float) -> Oscillator:
    """A model from another draw of the same recording."""
    return identify([recorded(kind, times, 999_999)]).oscillator


def passes(model: Oscillator, record: Recording) -> bool:
    """Whether ``verify`` passes an FMU of the model."""
    check = verification._check  # pyright: ignore[reportPrivateUsage]
    return check(CoreRun(model), record, verification.NOISE_RATIO).passed  # pyright: ignore[reportArgumentType]


def off(model: Oscillator, name: str, by: float) -> Oscillator:
    """The model with one parameter moved, and what it states of its errors as it was."""
    old = model.parameters()[name]
    return model.with_parameters({name: replace(old, value=old.value + by)})


def main(arguments: Sequence[str]) -> None:
    """Print one line a recording, and the rates."""
    count, largest = (int(text) for text in (list(arguments) + ["200", "100"][len(arguments) :])[:2])
    rates: dict[tuple[str, str], list[bool]] = defaultdict(list)
    truth = Oscillator.from_values(TRUTH)
    for seed in range(count):
        kind = KINDS[seed % 3]
        times = float(largest) ** (seed // 3 * 7 % LEVELS / (LEVELS - 1))
        record = recorded(kind, times, seed)
        error = standard_errors(truth, record)
        name = NAMES[1:][seed // 3 % 5] if kind == "decay" else NAMES[seed // 3 % 6]
        by = OFF * error[name] * (1 if seed % 2 else -1)
        models = {"true": truth}
        if seed // 3 % 3 == 0:
            try:
                models["identified"] = identified(kind, times)
            except DashpotError as problem:
                print(f"{kind} at {times:.3g} times the noise was not identified: {problem}", flush=True)
        for of, model in models.items():
            if model.mass is None:
                name = "omega0" if name == "mass" else name
            own = by if of == "true" else OFF * (model.parameters()[name].std or 0.0) * np.sign(by)
            right, wrong = passes(model, record), passes(off(model, name, own), record)
            rates["right", of].append(right)
            rates["wrong", of].append(wrong)
            print(f"{seed} {kind} x{times:.3g} {of}: right {right}, {name} off {wrong}", flush=True)
    for (what, of), passed in sorted(rates.items()):
        share = np.mean(passed) if what == "right" else 1.0 - np.mean(passed)
        print(f"{what} models ({of}): {100 * share:.1f} % of {len(passed)} {'pass' if what == 'right' else 'fail'}")


if __name__ == "__main__":
    main(sys.argv[1:])
