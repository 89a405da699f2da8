"""Where in the library to begin: each law put on the measured motion itself, in one linear regression.

A fit that starts from a base model which has bent itself around a large effect ends in a false minimum. On the measured
motion there is none: with the law's onset or speed held at a probe, the equation of motion is linear in everything
else, and windows spare differentiating (weak form, as ``identify.weakform``). Noise biases the answer, so it is a place
to start from and never evidence.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace

import numpy as np

from ...model import Oscillator
from ...model.law import Law, Scales
from ...model.library import KNOWN, find
from ...model.terms import with_term
from ...recording.recording import WHOLE
from ..motion.blows import ContactForce
from ..motion.displacement import displacement
from ..motion.excitation import band_of
from ..problem.data import Data
from ..problem.equivalent import along_of
from ..problem.limits import SLACK
from ..problem.normal_equations import least_squares
from ..problem.segments import stretches
from ..signals.registry import budget, numerics
from ..signals.weakform import Windows, windows
from .limits import HALF
from .regression import smooth_motion

_HARMONICS = numerics(
    3.5, "harmonics of the excited band", why="that the windows reach: forces that are not linear show there"
)
_CYCLES = numerics(8.0, "cycles", why="the length of a window")
_PART = numerics(0.5, "part of a stretch", why="that a window has at most, half of it for a slide")
_FEWEST_CYCLES = numerics((1.5, 0.5), "cycles", why="that a window has at least; the second of a slide")
_BELOW_NYQUIST = numerics(0.4, "of the sampling frequency", why="above, a motion is not followed between samples")
_DENSEST = budget(4, "times the samples", why="beside which columns are made")
_LEAST_NOISE = numerics(1e-4, "part of the motion", why="interpolation is no better")
_OVERLAP = numerics(2, "windows", why="over each sample")
_DENSITY = numerics(30.0, "samples a cycle", why="of the motion beside which columns are made")
_STRIDE = numerics(0.3, "natural logarithm", why="the first steps of a search of a place by factors")
_NEAR = numerics(0.02, "natural logarithm", why="the last ones: the race goes on from there")
_TRIES = budget(40, "solutions a parameter", why="of a search of a place")
_FIRST = budget(10, "solutions a parameter", why="of many laws each")
_BASE = numerics(6, "columns of Eq. 17", why="force, viscous, stiffness, cubic, preload, dry")
_ABSURD = numerics(1e100, "largest number", why="what is larger is no value of a law")
_NOTHING = numerics(
    1e-6, "part of a force", why="less is left in the windows of a constant but for roundings and a first sample"
)


@dataclass(frozen=True, eq=False)
class _Rows:
    """One segment on a dense grid, with its windows and what does not depend on the law.

    ``own`` are columns whose coefficients belong to this segment alone: forces of unknown phase.
    """

    segment: int
    view: Windows
    motion: np.ndarray
    columns: np.ndarray
    own: np.ndarray
    target: np.ndarray
    std: np.ndarray


@dataclass(frozen=True)
class Guess:
    """Values of all parameters, base and law, from the regression.

    ``misfit`` is its weighted mean square, ``phases`` the phase of a periodic force in each segment, by its number.
    """

    effect: str
    values: Mapping[str, float]
    misfit: float
    phases: Mapping[int, float] = field(default_factory=dict)

    def put_into(self, model: Oscillator) -> Oscillator:
        """The model with the law, all parameters with the values found."""
        grown = model
        if self.effect in KNOWN:
            own = {p.name: self.values[f"{self.effect}.{p.name}"] for p in find(self.effect).parameters}
            grown = with_term(model, self.effect, own)
        known = grown.parameters()
        return grown.with_parameters(
            {name: replace(known[name], value=value) for name, value in self.values.items() if name in known}
        )

    def begun(self, initial: np.ndarray) -> np.ndarray:
        """(segments, states) initial states, with the phases, where there are any, behind them."""
        if not self.phases:
            return initial
        return np.hstack([initial, [[self.phases.get(i, 0.0)] for i in range(len(initial))]])


class Regression:
    """The equation of motion on windows of the measured motion.

    Args:
        data: recordings and segments.
        model: gives the frequency and damping that weigh the rows; its further terms, with their values, are on the
            left-hand side already.
    """

    def __init__(self, data: Data, model: Oscillator) -> None:
        self.data = data
        self.model = model
        self.present = [(t.law, {n: q.value for n, q in t.parameters.items()}) for t in model.terms]
        self.slack = data.segments[0].slide
        self.forced = any(segment.force is not None for segment in data.segments)
        # a blow is over before a window has opened to it, and says nothing of the mass there: that stays as it is; so
        # does that of a rig which its base drives
        struck = any(isinstance(segment.force, ContactForce) for segment in data.segments)
        self.known = struck or any(recording.base == WHOLE for recording in data.recordings)
        self.rows: list[_Rows] = []
        for joined in stretches(data.segments):
            i, segment, last = joined[0], data.segments[joined[0]], data.segments[joined[-1]]
            recording = data.recordings[segment.recording]
            x = displacement(recording).samples[segment.start : last.stop]
            force = None if segment.force is None else np.asarray(recording.force, float)[segment.start : last.stop]
            rows = self._prepare(i, x, force, recording.fs, segment.time, data.sensor[i], data.force[i])
            if rows is not None:
                self.rows.append(rows)

    def _prepare(
        self,
        number: int,
        x: np.ndarray,
        force: np.ndarray | None,
        fs: float,
        start: float,
        noise: float,
        force_noise: float,
    ) -> _Rows | None:
        model = self.model
        f = self.data.scales.omega / (2 * np.pi)
        seconds = min(_CYCLES / f, (_PART / 2 if self.slack else _PART) * x.size / fs)
        if seconds * f < _FEWEST_CYCLES[self.slack]:
            return None
        low, high = 0.3 * f, f
        if force is not None and (band := band_of(self.data.recordings[0])) is not None:
            high = max(f, min(band[1], 2 * f))
        view = windows(x.size, fs, seconds, low, min(_HARMONICS * high, _BELOW_NYQUIST * fs), _OVERLAP)
        factor = int(np.clip(np.ceil(_DENSITY * high / fs), 1, _DENSEST))
        dense, speed = smooth_motion(x, fs, high, factor)
        fine = view.upsampled(factor)
        time = start + np.arange(dense.size) / (fs * factor)
        along = None
        if force is not None:
            along = np.interp(np.arange(dense.size) / factor, np.arange(force.size), force)
        dt = 1 / (fs * factor)
        motion = np.column_stack([dense, speed, time, np.zeros_like(dense) if along is None else along])
        for law, values in self.present:
            if law.drive is not None:  # without a force too: an actuator of its own mass goes along
                motion[:, 3] = along_of(law)(values, motion, dt)[0]
        columns = [fine.project(motion[:, 3])]
        columns += [
            view.project(x, 1),
            view.project(x),
            fine.project(dense**3),
            _project(fine, _soft_sign(dense, speed, dt)),
            _project(fine, _soft_sign(speed, np.gradient(speed, dt), dt)),
        ]
        own = [np.zeros(view.starts.size * view.omega.size, complex)]
        for law, values in self.present:
            if along_of(law).phases:
                own += _quadratures(law, values, motion, fine, dt)
            elif law.force is not None:
                columns += [_project(fine, signal) for signal in along_of(law)(values, motion, dt)]
        w = view.omega
        gap = (model.omega0.value**2 - w**2) ** 2 + (model.viscous.value * w) ** 2 + (2 * w * view.width) ** 2
        mass = model.mass.value if model.mass is not None else 1.0
        scale = max(noise, _LEAST_NOISE * float(np.std(x)))
        quiet = scale**2 * gap + (force_noise / mass) ** 2
        std = np.sqrt(quiet * view.energy / fs)
        return _Rows(
            number,
            fine,
            motion,
            np.stack([c.ravel() for c in columns], axis=-1),
            np.stack(own, axis=-1),
            -view.project(x, 2).ravel(),
            np.tile(std, view.starts.size),
        )

    def _shown(self, view: Windows, bend: np.ndarray) -> np.ndarray:
        """What the equation of motion lacks where a sensor adds ``bend`` to the displacement: to first order."""
        omega, viscous = self.model.omega0.value, self.model.viscous.value
        return -(view.project(bend, 2) + viscous * view.project(bend, 1) + omega**2 * _project(view, bend))

    @property
    def _base(self) -> int:
        """Columns that are there whatever the law."""
        return self.rows[0].columns.shape[1]

    def best(self, law: Law) -> Guess | None:
        """The best place of a law, searched from all its probes; None where the regression cannot carry it."""
        return None if (guess := self._begun(law)) is None else self._refined(law, guess, _TRIES - _FIRST)

    def _begun(self, law: Law) -> Guess | None:
        """The best place of a law after a while, from the best of its probes."""
        probed = self._probed(law)
        return self._refined(law, probed[0], _FIRST) if probed else None

    def _probed(self, law: Law) -> list[Guess]:
        """Those of a law's probes that the regression can carry, the best first."""
        if (law.drive is not None and not self.forced) or not self.rows:
            return []
        if law.record is not None and not (law.learnt and all(not s.order for s in self.data.segments)):
            return []
        solved = [self.at(law, probe) for probe in probes(law, self.data.scales)]
        return sorted((guess for guess in solved if guess is not None), key=lambda guess: guess.misfit)

    def _refined(self, law: Law, guess: Guess, tries: int) -> Guess:
        """The best place around a guess: onsets, speeds and times move by factors (Nelder and Mead 1965).

        Strengths follow from each place by linear regression, so that one to three numbers are left, along which the
        misfit has corners. There steps by a gradient (BFGS) took a third more places and ended 1 % or more higher for
        five of 29 laws, the method of Powell a tenth more, and for one.
        """
        from scipy.optimize import minimize

        placed = [p for p in law.parameters if not (p.strength or p.shape or p.scale)]
        moving = [p for p in placed if guess.values[f"{law.name}.{p.name}"]]
        if not moving:
            return guess
        # strengths at zero, as in all probes: the derivatives of a contact are those of one that pushes
        places = {q.name: 0.0 if q.strength else guess.values[f"{law.name}.{q.name}"] for q in law.parameters}
        best = guess

        def misfit(factors: np.ndarray) -> float:
            nonlocal best
            here = dict(places)
            for p, factor in zip(moving, np.exp(factors), strict=True):
                here[p.name] = float(np.clip(places[p.name] * factor, p.lower, p.upper))
            trial = self.at(law, here)
            if trial is None:
                return _ABSURD
            best = min(best, trial, key=lambda candidate: candidate.misfit)
            return trial.misfit

        n = len(moving)
        minimize(
            misfit,
            np.zeros(n),
            method="Nelder-Mead",
            options={
                "initial_simplex": np.vstack([np.zeros(n), _STRIDE * np.eye(n)]),
                "maxfev": tries * n,
                "xatol": _NEAR,
                "fatol": 1e-4 * guess.misfit,
            },
        )
        return best

    def plain(self) -> float:
        """Misfit of the model's own family."""
        guess = self.family()
        return np.inf if guess is None else guess.misfit

    def family(self) -> Guess | None:
        """The best of the model's own family; its laws keep their onsets and speeds."""
        return self.at(Law("nothing", "", (), "", "", "", force=lambda motion, p: 0.0 * motion.x), {})

    def gain(self, plain: float, guess: Guess) -> float:
        """Gain of log-likelihood that a guess promises over the family's own misfit, windows being what they are."""
        count = sum(2 * rows.target.size for rows in self.rows) / _OVERLAP
        return 0.5 * count * float(np.log(plain / guess.misfit)) if guess.misfit > 0 else 0.0

    def guesses(self, laws: Sequence[Law]) -> list[Guess]:
        """The best place of each law, the smallest misfit first.

        All are searched for a while, then those that gain half of what the best does (successive halving: Jamieson and
        Talwalkar 2016).
        """
        known = {law.name: law for law in laws}
        plain = self.plain()
        with ThreadPoolExecutor(max_workers=2) as pool:
            guesses = [guess for guess in pool.map(self._begun, laws) if guess is not None]
            least = HALF * max((self.gain(plain, guess) for guess in guesses), default=0.0)

            def ended(guess: Guess) -> Guess:
                far = self.gain(plain, guess) < least
                return guess if far else self._refined(known[guess.effect], guess, _TRIES - _FIRST)

            guesses = list(pool.map(ended, guesses))
        return sorted(guesses, key=lambda guess: guess.misfit)

    def at(self, law: Law, probe: Mapping[str, float]) -> Guess | None:
        """All values where a law's onsets and speeds are a probe's; None where the law would do the opposite."""
        if not self.rows:  # every segment is too short for a window
            return None
        strengths = [p for p in law.parameters if p.strength]
        normal, right, power, count = 0.0, 0.0, 0.0, 0
        solutions: list[tuple[_Rows, np.ndarray, np.ndarray, np.ndarray]] = []
        along = along_of(law)
        values = {p.name: float(probe.get(p.name, 1.0)) for p in law.parameters}
        for p in strengths[:1] if law.drive is None else ():
            values[p.name] = 1.0  # a contact is there: its derivatives are those of one that pushes
        for rows in self.rows:
            columns, own = rows.columns, rows.own
            made = along(values, rows.motion, 1.0 / rows.view.fs)
            if not np.max(np.abs(made)) < _ABSURD:  # an unstable inner state, or none
                return None
            project = self._shown if law.record else _project
            projected = [project(rows.view, signal).ravel() for signal in made]
            if along.phases:
                own = np.column_stack([own, *_quadratures(law, values, rows.motion, rows.view, 1.0 / rows.view.fs)])
            elif law.drive is not None:
                columns = np.column_stack([columns, *projected[1:]])
                columns[:, 0] = projected[0]
            else:
                columns = np.column_stack([columns, *projected])
            a, b, own = (_real(c, rows.std) for c in (columns, rows.target[:, None], own))
            b = b[:, 0]
            if np.any(own):
                solutions.append((rows, own, a, b))
                a, b = a - own @ _many(own, a), b - own @ _many(own, b)
            normal, right, power, count = normal + a.T @ a, right + a.T @ b, power + float(b @ b), count + b.size
        matrix, vector = np.asarray(normal), np.asarray(right)
        if not (np.max(np.abs(matrix)) < _ABSURD and np.max(np.abs(vector)) < _ABSURD):  # a present law runs away
            return None
        used = np.diag(matrix) > 0
        solved = least_squares(matrix, vector, used)
        # what comes out beyond its bound, beside the law's first strength, stays at it: a contact without damping
        for place, p in zip(range(self._base + 1, self._base + len(strengths)), strengths[1:], strict=False):
            if law.force is not None and not p.lower <= solved[place] <= p.upper:
                used[place] = False
                solved = least_squares(matrix, vector, used)
        misfit = (power - float(vector @ solved)) / count
        if self.known and self.model.mass is not None:
            used[0], known = False, np.eye(used.size)[0] / -self.model.mass.value
            solved = known + least_squares(matrix, vector - matrix @ known, used)
            misfit = (power - float((2 * vector - matrix @ solved) @ solved)) / count
        stiffness = float(solved[2])
        if stiffness <= 0 and self.slack:
            stiffness = (SLACK / self.data.scales.duration) ** 2
        if not np.isfinite(misfit) or stiffness <= 0 or (self.forced and not -solved[0] > 0):
            return None
        values = {"omega0": float(np.sqrt(stiffness)), "viscous": float(solved[1]), "cubic": float(solved[3])}
        values |= {"preload": float(solved[4]), "dry": float(solved[5])}
        if self.forced and self.model.mass is not None:
            values["mass"] = -1.0 / float(solved[0])
        sizes = solved[self._base :] / (1.0 if law.drive is None else solved[0])  # what a drive adds is force too
        own = dict(probe) | {p.name: float(s) for p, s in zip(strengths, sizes, strict=False)}
        phases: dict[int, float] = {}
        if along.phases:
            own[strengths[0].name], phases = _amplitude(solutions, solved)
        if not all(p.lower <= own[p.name] <= p.upper for p in law.parameters) or solved[1] < 0:
            return None  # the law would do the opposite of what it stands for
        for p in law.parameters:
            values[f"{law.name}.{p.name}"] = own[p.name]
        place = _BASE
        for present, old in self.present:
            for p in present.parameters:
                values[f"{present.name}.{p.name}"] = old[p.name]
                if present.force is not None and p.strength and not along_of(present).phases:
                    values[f"{present.name}.{p.name}"] = float(np.clip(solved[place], p.lower, p.upper))
                    place += 1
        return Guess(law.name, values, misfit, phases)


def _project(view: Windows, force: np.ndarray) -> np.ndarray:
    """Products with the windows, which let no constant pass: one leaves zeros, not a remainder of roundings."""
    products = view.project(force - force[0])
    whole = view.length / view.fs * float(np.max(np.abs(force)))
    return products if np.max(np.abs(products), initial=0.0) > _NOTHING * whole else np.zeros_like(products)


def probes(law: Law, scales: Scales) -> list[dict[str, float]]:
    """Where to look for a law: every combination of its parameters' probes, strengths at zero."""
    axes = []
    for p in law.parameters:
        if p.strength:
            axes.append([(p.name, 0.0)])
        elif p.probes == "lines":
            axes.append([(p.name, line) for line in scales.lines])
        else:
            axes.append([(p.name, float(probe) * p.natural(scales)) for probe in p.probes])
    return [dict(combination) for combination in itertools.product(*axes)]


def _real(columns: np.ndarray, std: np.ndarray) -> np.ndarray:
    """(2 n, m) weighed real and imaginary parts of (n, m)."""
    weighed = columns / std[:, None]
    return np.concatenate([weighed.real, weighed.imag])


def _many(columns: np.ndarray, target: np.ndarray) -> np.ndarray:
    return np.linalg.lstsq(columns, target, rcond=1e-10)[0]


def _quadratures(
    law: Law, values: Mapping[str, float], motion: np.ndarray, view: Windows, dt: float
) -> list[np.ndarray]:
    """A periodic force of unit amplitude as a cosine and as a sine from the segment's start."""
    shifts = (0.0, -0.5 * np.pi)
    return [view.project(signal).ravel() for shift in shifts for signal in along_of(law)(values, motion, dt, shift)]


def _amplitude(
    solutions: Sequence[tuple[_Rows, np.ndarray, np.ndarray, np.ndarray]], solved: np.ndarray
) -> tuple[float, dict[int, float]]:
    """Amplitude of a periodic force over all segments, and its phase in each."""
    parts = {rows.segment: _many(own, b - a @ solved)[-2:] for rows, own, a, b in solutions}
    weights = {rows.segment: float(np.sum(own[:, -2:] ** 2)) for rows, own, _, _ in solutions}
    power = sum(weights[i] * float(part @ part) for i, part in parts.items()) / max(sum(weights.values()), 1e-300)
    return float(np.sqrt(power)), {i: float(np.arctan2(-part[1], part[0])) for i, part in parts.items()}


def _soft_sign(y: np.ndarray, slope: np.ndarray, dt: float) -> np.ndarray:
    """Mean of sgn over each sample's interval, so that the instant of a sign change counts."""
    reach = np.abs(slope) * dt / 2
    return np.clip(y / np.where(reach > 0, reach, 1e-300), -1, 1)
