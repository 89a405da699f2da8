"""The first recordings that a laboratory makes: is the plain answer right, or rightly refused?

    python benchmarks/first_recordings.py [--n 100] [--seed 0] [--kind KIND] [--jobs 2] [--json OUT.json]

Draws recordings (`first_population.py`), identifies each as a user does from its columns, and scores what comes out:

    right      every stated parameter within 3.5 of its errors, no error above 1.5 times the Cramér-Rao bound
    wide       within 3.5 errors, but an error above 1.5 times the bound
    told       a parameter beyond 3.5 errors, and the command ends with a word on what is left (exit code 1)
    noted      the same, with a note on what is left and that errors may not hold (exit code 0)
    wrong      the same without a word
    refused    rightly, where the bound says that frequency or damping is not known to a third of itself
    not taken  refused although the bound says that both are
    late       no answer in 30 s
    failed     an exception that is no refusal

Of two modes the one that was taken is compared by frequency and damping alone.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import signal
import time
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import numpy as np
from dashpot.errors import DashpotError
from dashpot.face.commands import identify
from dashpot.face.model import Model
from dashpot.model.fit_state import left_over
from first_bound import bound, plain_errors
from first_population import DRIVEN, FREE, NAMES, ON_REQUEST, Case, case

#: Of so many errors one in two thousand is exceeded by chance; errors so many times the bound are still its size.
FAR, WIDE = 3.5, 1.5
#: What is known to a third of itself is to be taken.
KNOWN = 1 / 3
#: Seconds that a command may take, and the bound of one recording.
LIMIT = 30.0
OUTCOMES = ("right", "wide", "told", "noted", "wrong", "refused", "not taken", "late", "failed")


class Late(BaseException):
    """The time is over; no handler of errors in between may take it for one."""


@dataclass(frozen=True)
class Score:
    """What became of one recording.

    Attributes:
        seed, kind, words: which, and what is peculiar to it.
        outcome: one of ``OUTCOMES``.
        z: (found - true) / error of each stated parameter.
        over_bound: its error over the bound; empty where no bound is known.
        known: least relative errors of frequency and damping that anybody could have.
        seconds, work: wall and processor time of the answer.
        said: the refusal, or what ended it.
    """

    seed: int
    kind: str
    words: tuple[str, ...]
    outcome: str
    z: Mapping[str, float]
    over_bound: Mapping[str, float]
    known: tuple[float, float]
    seconds: float
    work: float
    said: str = ""


@dataclass(frozen=True)
class Stated:
    """What a command stated: value and error by name, and what it is where one is far off: told, noted or wrong."""

    values: Mapping[str, tuple[float, float]]
    far: str


def judged(
    stated: Stated, truth: Mapping[str, float], least: Mapping[str, float]
) -> tuple[str, dict[str, float], dict[str, float]]:
    """Outcome, distances in errors, and errors over the bound, of what was stated.

    Args:
        stated: by the command.
        truth: values by name.
        least: bounds by name; none where they are not known.
    """
    z, over = {}, {}
    for name, (value, error) in stated.values.items():
        off = abs(value - truth[name])
        z[name] = float((value - truth[name]) / error) if error > 0 else (0.0 if off == 0 else float(np.inf))
        if np.isfinite(least.get(name, np.inf)) and least[name] > 0:
            over[name] = error / least[name]
    far = any(abs(score) > FAR for score in z.values())
    wide = any(ratio > WIDE for ratio in over.values())
    outcome = stated.far if far else "wide" if wide else "right"
    return outcome, z, over


def refusal(known: Sequence[float]) -> str:
    """Whether to refuse was right: frequency or damping cannot be known to a third."""
    return "refused" if not max(known) <= KNOWN else "not taken"


def stated_by(model: Model) -> Stated:
    """Parameters with a standard error, and whether the command ends with exit code 1 or has a note."""
    values = {name: (p.value, p.std) for name, p in model.parameters.items() if p.std is not None and name in NAMES}
    found = model.identification
    if found is not None and (found.useless or found.faults or found.modes_left or found.unexplained):
        return Stated(values, "told")
    return Stated(values, "noted" if left_over(model.oscillator) else "wrong")


def mode_taken(found: Case, stated: Stated) -> int:
    """Index of the mode whose frequency is nearest to the stated one; the first where none is stated."""
    if "omega0" not in stated.values:
        return 0
    omega = stated.values["omega0"][0]
    return int(np.argmin([abs(np.log(abs(omega) / mode["omega0"])) for mode in found.modes]))


@contextmanager
def at_most(seconds: float) -> Iterator[None]:
    """End what is within by ``Late`` once its time is over."""

    def over(*_: object) -> None:
        raise Late

    before = signal.signal(signal.SIGALRM, over)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def score(seed: int, kind: str | None = None) -> Score:
    """Draw a recording, identify it, and judge what came out."""
    warnings.simplefilter("ignore")
    drawn = case(seed, kind)
    columns = drawn.recorded()
    began, worked = time.monotonic(), _work()
    stated, outcome, said = None, "", ""
    try:
        with at_most(LIMIT):
            stated = stated_by(identify(columns))
    except Late:
        outcome = "late"
    except DashpotError as problem:
        said = str(problem)
    except Exception as problem:
        outcome, said = "failed", f"{type(problem).__name__}: {problem}"
    seconds, work = time.monotonic() - began, _work() - worked
    known, least = _bounds(drawn)
    z: dict[str, float] = {}
    over: dict[str, float] = {}
    if stated is not None:
        mode = mode_taken(drawn, stated)
        if len(drawn.modes) > 1:
            stated = Stated({n: v for n, v in stated.values.items() if n in ("omega0", "viscous")}, stated.far)
        outcome, z, over = judged(stated, drawn.modes[mode], least)
    outcome = outcome or refusal(known)
    return Score(seed, drawn.kind, drawn.words, outcome, z, over, known, seconds, work, said)


def _bounds(drawn: Case) -> tuple[tuple[float, float], dict[str, float]]:
    """What anybody could know: of frequency and damping, and of each parameter of a single mode without force noise."""
    try:
        with at_most(LIMIT), np.errstate(all="ignore"):
            known, least = plain_errors(drawn), {}
            if len(drawn.modes) == 1 and not drawn.force_noise:
                least = {n: float(b) for n, b in zip(NAMES, bound(drawn)[0], strict=True) if np.isfinite(b)}
            return known, least
    except Late:
        return (0.0, 0.0), {}


def _work() -> float:
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def table(scores: Sequence[Score]) -> str:
    """Outcomes by kind, and how long they took."""
    lines = [
        f"{'kind':12}{'n':>5}" + "".join(f"{name:>11}" for name in OUTCOMES) + f"{'median s':>10}{'longest s':>11}"
    ]
    kinds = [kind for kind in (*FREE, *DRIVEN, *ON_REQUEST) if any(s.kind == kind for s in scores)]
    for kind in [*kinds, "all"]:
        some = [s for s in scores if kind in (s.kind, "all")]
        count = Counter(s.outcome for s in some)
        seconds = [s.seconds for s in some]
        lines.append(
            f"{kind:12}{len(some):>5}"
            + "".join(f"{count[name]:>11}" for name in OUTCOMES)
            + f"{np.median(seconds):>10.2f}{max(seconds):>11.2f}"
        )
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> None:
    """Score a population, print the table, and write the JSON that was asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--n", type=int, default=100, help="recordings")
    parser.add_argument("--seed", type=int, default=0, help="of the first")
    parser.add_argument("--kind", choices=(*FREE, *DRIVEN, *ON_REQUEST), help="this kind alone")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--json", type=Path, help="where each score is written to")
    asked = parser.parse_args(arguments)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    scores = []
    with ProcessPoolExecutor(asked.jobs) as pool:
        for one in pool.map(partial(score, kind=asked.kind), range(asked.seed, asked.seed + asked.n)):
            scores.append(one)
            worst = max((abs(z) for z in one.z.values()), default=0.0)
            about = f"{one.seed} {one.kind} ({', '.join(one.words) or 'plain'})"
            print(f"{about}: {one.outcome}, {worst:.1f} errors off, {one.seconds:.1f} s; {one.said[:160]}", flush=True)
    print(table(scores))
    if asked.json is not None:
        asked.json.write_text(json.dumps([asdict(one) for one in scores], indent=1) + "\n")


if __name__ == "__main__":
    main()
