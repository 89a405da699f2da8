"""The force that a model lacks, over time, by a smoother that knows no law.

The missing force per unit mass f is a third state beside displacement and velocity, an Ornstein-Uhlenbeck process
whose strength and memory are those that make the recording most likely (latent forces: Alvarez, Luengo, Lawrence
2009; for restoring forces Rogers, Worden, Cross 2020):

    x'' + g(x, v) + f = F / m,   f' = -f / memory + white noise

The model's own force g is linearised along the measured motion (extended Kalman smoother). Instead of running the
Rauch-Tung-Striebel recursions sample by sample, the same posterior is found as the penalised least-squares problem
that it is: the precision matrix of all states is block tridiagonal, one banded Cholesky factor solves it and gives
the likelihood (Rue and Held 2005, section 2.4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...files.computed_once import computed_once
from ...identify.motion.displacement import displacement
from ...identify.problem.data import Data
from ...identify.signals.registry import budget, numerics
from ...identify.signals.signals import resting
from ...model import Oscillator
from ...model.oscillator import QUANTITIES
from ...recording.smoothing import weights_of_polynomials, with_polynomials
from ..limits import LASTING_SIGN
from .model_force import OwnForce, term_force
from .penalised_states import Change, PenalisedStates

_SHORTEST = numerics(7, "samples", why="of a filter of third order")

_STRETCH = budget(3000, "samples", why="on which strength and memory of the latent force are found")
_DENSE = numerics(
    64.0, "samples a cycle", why="recordings with twice as many are averaged to about this: no harmonic is lost"
)
_KNOTS = numerics(
    14.0,
    "points a cycle",
    why="of the spline along the measured motion, which only has to be near it: five harmonics pass",
)
_PARTS = numerics(
    4,
    "parts of a sample interval",
    why="at which the force of the model is evaluated, so that the instant of a sign change counts",
)
_LEAST_NOISE = numerics(1e-4, "part of the signal", why="rounding and interpolation are not nothing")
_TOGETHER = budget(16, "forces", why="smoothed at once, so that long recordings fit into memory")
_PLACES = numerics(24, "places", why="standard deviations are found there and interpolated: they change slowly")
_TRIALS = budget(20, "values of strength and memory", why="a search in two unknowns with a smooth likelihood")
_RUINED = numerics(1e30, "log-likelihood", why="of what the numbers do not carry: no search goes there")
_TINY = numerics(1e-30, "of a squared unit", why="a variance that is none")
_ENDS = numerics(1e-5, "of the log-likelihood", why="a step that gains less changes no strength by its error")
_NONE = numerics(
    3e-5, "of the force of the spring", why="below this is none: of a weaker one the precision is lost to rounding"
)


@dataclass(frozen=True, eq=False)
class Smoothed:
    """What the smoother found in one segment, or in a part of it.

    Attributes:
        time: (n,) s.
        displacement, velocity: (n,) smoothed motion, in the model's units.
        force, std: (n,) missing force per unit mass, positive where it opposes a positive motion, and its standard
            deviation; the uncertainty of the model's parameters is not in it.
        noise: (n,) what the smoother would make of a recording with nothing but its noise.
        drive: (n,) recorded force per unit mass, zero in a free decay.
        moving: (n,) whether the mass moves; at rest friction takes any value, and signs mean nothing.
        strength: standard deviation of the latent force that is most likely.
        memory: its correlation time, s.
    """

    time: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    force: np.ndarray
    std: np.ndarray
    noise: np.ndarray
    drive: np.ndarray
    moving: np.ndarray
    strength: float
    memory: float


class Smoother:
    """The smoother of one segment.

    Args:
        model: the family's model with its values; its terms count as known. Laws on the sensor's path are ignored.
        data: recordings, segments and their noise.
        index: of the segment.
    """

    def __init__(self, model: Oscillator, data: Data, index: int) -> None:
        segment = data.segments[index]
        recording = data.recordings[segment.recording]
        self.model = model
        self.period = 2 * np.pi / segment.pace
        self.order = QUANTITIES.index(recording.quantity)
        mass = 1.0 if model.mass is None else model.mass.value
        driven = segment.force is not None and recording.force is not None
        cut = slice(segment.start, segment.stop)
        thin = max(int(self.period / segment.dt / _DENSE), 1)
        self.dt, self.n = segment.dt * thin, segment.n // thin
        self.time = segment.time + 0.5 * (thin - 1) * segment.dt + np.arange(self.n) * self.dt
        self.response = _thinned(np.asarray(segment.response, float), thin)
        self.drive = np.zeros(self.n)
        if driven:
            self.drive = _thinned(np.asarray(recording.force, float)[cut], thin) / mass
        self.force_noise = data.force[index] / mass / np.sqrt(thin) if driven else 0.0
        least = _LEAST_NOISE * float(np.std(self.response))
        self.sensor = max(data.sensor[index] / np.sqrt(thin), least, np.finfo(float).tiny)
        self._follow(_thinned(displacement(recording).samples[cut], thin))
        self.scale = float(np.std(self.x)) * segment.pace**2
        self._balance(mass)
        still = resting(self.response, self.sensor, max(int(self.period / self.dt), 2))
        self.moving = ~still

    def _follow(self, raw: np.ndarray) -> None:
        """A spline along the measured displacement, and its derivatives on a finer grid."""
        from scipy.interpolate import make_interp_spline

        step = max(int(self.period / self.dt / _KNOTS), 1)
        noise = np.array([1.0, 1.0 / self.dt])
        span = max(2 * step + 1, _SHORTEST)
        if step > 1 and self.n > 2 * span:  # a quartic over two steps loses nothing that one knot a step can follow
            raw = with_polynomials(raw, span, 4)
            gains = [weights_of_polynomials(span, 4, k)[span // 2] / self.dt**k for k in (0, 1)]
            noise = np.array([np.sqrt(np.sum(gain**2)) for gain in gains])
        self.spread = noise * self.sensor * (self.period / (2 * np.pi)) ** self.order
        points = np.unique(np.r_[np.arange(0, self.n - step // 2, step), self.n - 1])
        spline = make_interp_spline(points * self.dt, raw[points], k=5)
        fine = np.arange((self.n - 1) * _PARTS + 1) * (self.dt / _PARTS)
        self.x, self.v, self.a = (np.asarray(spline(fine, k)) for k in range(3))
        self.fine = fine

    def _balance(self, mass: float) -> None:
        """What the equation of motion lacks along the spline, and the slopes of the model's force there."""
        motion, step = self.along(mass)
        drive = motion[:, 3] / mass
        for term in self.model.terms:
            if term.law.drive is not None:
                drive = term_force(term, np.column_stack([motion[:, :3], drive * mass]), step) / mass
        own = OwnForce(self.model)
        force, self.stiffness, self.damping = own(motion, step)
        self.unsure = self._unsure(own, motion)
        self.known = drive - force
        self.excess = self.known - self.a

    def along(self, mass: float) -> tuple[np.ndarray, float]:
        """(m, 4) displacement, velocity, time and recorded force along the measured motion, and their step in s."""
        from scipy.interpolate import CubicSpline

        drive = np.zeros(self.fine.size)
        if np.any(self.drive):
            drive = np.asarray(CubicSpline(np.arange(self.n) * self.dt, self.drive)(self.fine))
        return np.column_stack([self.x, self.v, self.time[0] + self.fine, drive * mass]), self.dt / _PARTS

    def _unsure(self, own: OwnForce, motion: np.ndarray) -> np.ndarray:
        """(n - 1,) variance of the speed that a sample adds where noise hides the sign of displacement or velocity.

        There friction and preload take any value between their two; at rest they do so for long.
        """
        motion = motion[::_PARTS][:-1]
        total = np.zeros(motion.shape[0])
        for i in (0, 1):
            sides = []
            for sign in (-1.0, 1.0):
                beside = motion.copy()
                beside[:, i] = sign * 1e-9 * float(np.max(np.abs(motion[:, i])))
                sides.append(own(beside, self.dt)[0])
            doubt = np.exp(-0.5 * (motion[:, i] / self.spread[i]) ** 2)
            total += ((sides[1] - sides[0]) * self.dt * doubt) ** 2
        return total * max(LASTING_SIGN * self.period / self.dt, 1.0)

    @computed_once
    def input(self) -> np.ndarray:
        """(n - 1, 3) what the excess adds to displacement and velocity deviation over a sample, exact to order dt³."""
        weights = np.array([7.0, 32.0, 12.0, 32.0, 7.0]) / 90.0  # Boole's rule
        ahead = 1.0 - np.arange(_PARTS + 1) / _PARTS
        view = np.lib.stride_tricks.sliding_window_view(self.excess, _PARTS + 1)[::_PARTS]
        moment = [view @ (weights * ahead**k) * self.dt ** (k + 1) for k in range(4)]
        k, c = self.stiffness[:-1:_PARTS], self.damping[:-1:_PARTS]
        x = moment[1] - c * moment[2] / 2 - k * moment[3] / 6
        v = moment[0] - c * moment[1] - (k - c**2) * moment[2] / 2
        return np.column_stack([x, v, np.zeros_like(x)])

    def _blocks(self, memory: float, first: int, last: int) -> tuple[np.ndarray, np.ndarray]:
        """(n - 1, 3, 3) transition over a sample, states scaled by powers of dt, and its derivative by log(memory)."""
        mid = slice(first * _PARTS + _PARTS // 2, (last - 1) * _PARTS, _PARTS)
        a = np.zeros((last - first - 1, 3, 3))
        a[:, 0, 1] = 1.0
        a[:, 1, 0] = -self.stiffness[mid] * self.dt**2
        a[:, 1, 1] = -self.damping[mid] * self.dt
        a[:, 1, 2] = -1.0
        a[:, 2, 2] = -self.dt / memory
        phi = np.tile(np.eye(3), (a.shape[0], 1, 1))
        slopes = np.zeros_like(phi)
        term, change = phi, slopes
        by_memory = np.diag([0.0, 0.0, self.dt / memory])
        for k in range(1, 7):
            term, change = term @ a / k, (change @ a + term @ by_memory) / k
            phi, slopes = phi + term, slopes + change
        return phi, slopes

    def _slopes(self, strength: float, memory: float, first: int, last: int) -> tuple[float, np.ndarray]:
        """Log-likelihood of a stretch, and its derivatives by the logarithms of strength and memory."""
        phi, by_memory = self._blocks(memory, first, last)
        spread, begin = self._spread(strength, memory), self._begin(strength)
        by_strength = np.array([0.0, 0.0, 2.0 if begin[2] > _TINY else 0.0])
        changes = Change(0.0, 2.0 * spread, by_strength), Change(by_memory, -spread, np.zeros(3))
        return self._system(strength, memory, first, last).slopes(phi, begin, changes)

    def _spread(self, strength: float, memory: float) -> np.ndarray:
        """(3, 3) covariance of what the latent force adds to the states over a sample."""
        spread = 2.0 * strength**2 / memory * self.dt**5 / (self.sensor * self.dt**self.order) ** 2
        return spread * np.array([[1 / 20, 1 / 8, -1 / 6], [1 / 8, 1 / 3, -1 / 2], [-1 / 6, -1 / 2, 1.0]])

    def _begin(self, strength: float) -> np.ndarray:
        """(3,) variance of the states at the first sample before anything is seen."""
        unit = self.sensor * self.dt**self.order
        reach = 0.1 * float(np.max(np.abs(self.x))) / unit
        rate = 2 * np.pi * self.dt / self.period
        return np.array([reach**2, (reach * rate) ** 2, max((strength * self.dt**2 / unit) ** 2, _TINY)])

    def _system(self, strength: float, memory: float, first: int, last: int) -> PenalisedStates:
        """States are in units of the displacement that the noise of one sample amounts to, time in samples."""
        dt, n = self.dt, last - first
        unit = self.sensor * (dt**self.order)
        phi, _ = self._blocks(memory, first, last)
        noise = self.force_noise * dt**2 / unit
        kick = noise**2 + self.unsure[first : last - 1, None, None] * (dt / unit) ** 2
        q = np.tile(self._spread(strength, memory), (n - 1, 1, 1))
        q[:, :2, :2] += kick * np.array([[1 / 3, 1 / 2], [1 / 2, 1.0]])
        inverse = np.linalg.inv(q)
        begin = self._begin(strength)
        indices = slice(first * _PARTS, (last - 1) * _PARTS + 1, _PARTS)
        h = np.zeros((n, 3))
        along = (self.x, self.v, self.known)[self.order][indices]
        if self.order < 2:
            h[:, self.order] = 1.0
        else:
            h[:] = np.column_stack([-self.stiffness[indices] * dt**2, -self.damping[indices] * dt, -np.ones(n)])
        carried = np.einsum("kba,kbc->kac", phi, inverse)  # phi' Q^-1
        diagonal = h[:, :, None] * h[:, None, :]
        diagonal[1:] += inverse
        diagonal[:-1] += carried @ phi
        diagonal[0] += np.diag(1.0 / begin)
        band = np.zeros((6, 3 * n))
        for i in range(3):
            for j in range(3):
                if i >= j:
                    band[i - j, j::3] = diagonal[:, i, j]
                band[3 + i - j, j : 3 * (n - 1) : 3] = -carried[:, j, i]
        return PenalisedStates(
            band,
            carried,
            inverse,
            h,
            (self.response[first:last] - along) / self.sensor,
            self.input[first : last - 1] * np.array([1.0, dt, 0.0]) / unit,
            noise,
            float(np.sum(np.linalg.slogdet(inverse)[1]) - np.sum(np.log(begin))),
        )

    def log_likelihood(self, strength: float, memory: float, first: int, last: int) -> float:
        """Logarithm of the likelihood of the samples from ``first`` to ``last``, but for a constant."""
        return self._system(strength, memory, first, last).log_likelihood()

    def most_likely(self, first: int, last: int) -> tuple[float, float]:
        """Strength and memory of the latent force that make a stretch most likely (quasi-Newton: Byrd et al. 1995)."""
        from scipy.optimize import minimize

        bounds = (np.log(_NONE), np.log(10.0)), (np.log(3 * self.dt), np.log(20 * self.period))

        def cost(point: np.ndarray) -> tuple[float, np.ndarray]:
            s, m = np.exp(point)
            value, slopes = self._slopes(self.scale * s, m, first, last)
            return (-value if np.isfinite(value) else _RUINED), -slopes

        start = np.array([np.log(0.01), np.log(self.period / 6)])
        how = {"maxfun": _TRIALS, "ftol": _ENDS}
        s, m = np.exp(minimize(cost, start, jac=True, method="L-BFGS-B", bounds=bounds, options=how).x)
        return self.scale * float(s), float(m)

    def evidence(self, strength: float, memory: float, first: int, last: int) -> float:
        """Gain of log-likelihood of a stretch over that without a missing force."""
        none = self.log_likelihood(_NONE * self.scale, memory, first, last)
        if not np.isfinite(none):
            return 0.0
        return max(self.log_likelihood(strength, memory, first, last) - none, 0.0)

    def loudest(self, samples: int = _STRETCH) -> tuple[int, int]:
        """First and last of the samples that move most."""
        if self.n <= samples:
            return 0, self.n
        power = np.concatenate([[0.0], np.cumsum(self.x[::_PARTS] ** 2)])
        inside = power[samples:] - power[:-samples]
        first = int(np.argmax(inside))
        return first, first + samples

    def smooth(self, first: int = 0, last: int | None = None, prior: tuple[float, float] | None = None) -> Smoothed:
        """The missing force from sample ``first`` to ``last``; with another strength and memory where given."""
        from scipy.linalg import cho_solve_banded, cholesky_banded

        last = self.n if last is None else last
        strength, memory = self.most_likely(*self.loudest()) if prior is None else prior
        system = self._system(strength, memory, first, last)
        factor = cholesky_banded(system.band, lower=True, check_finite=False)
        right = np.column_stack([system.right(system.seen, system.given), system.noise(first)])
        solved = cho_solve_banded((factor, True), right, check_finite=False)
        states = solved[:, 0].reshape(-1, 3)
        unit = self.sensor * self.dt**self.order
        n = last - first
        indices = np.unique(np.linspace(0, n - 1, min(_PLACES, n)).astype(int))
        probes = np.zeros((3 * n, indices.size))
        probes[3 * indices + 2, np.arange(indices.size)] = 1.0
        inverse = cho_solve_banded((factor, True), probes, check_finite=False)
        variance = np.maximum(inverse[3 * indices + 2, np.arange(indices.size)], 0.0)
        std = np.interp(np.arange(n), indices, np.sqrt(variance)) * unit / self.dt**2
        here = slice(first * _PARTS, (last - 1) * _PARTS + 1, _PARTS)
        return Smoothed(
            time=self.time[first:last],
            displacement=self.x[here] + states[:, 0] * unit,
            velocity=self.v[here] + states[:, 1] * unit / self.dt,
            force=states[:, 2] * unit / self.dt**2,
            std=std,
            noise=solved[2::3, 1] * unit / self.dt**2,
            drive=self.drive[first:last],
            moving=self.moving[first:last],
            strength=strength,
            memory=memory,
        )

    def makes_of(self, forces: np.ndarray, prior: tuple[float, float]) -> np.ndarray:
        """(n, m) what ``smooth`` with that prior would find of missing forces (n, m): what noise hides is not in it.

        Of states z that obey z[k + 1] = phi[k] z[k] + w[k] with a w of the force alone, the smoother finds all but
        what its prior asks to be smaller: the solution for that w.
        """
        from scipy.linalg import cho_solve_banded, cholesky_banded

        strength, memory = prior
        system = self._system(strength, memory, 0, self.n)
        factor = cholesky_banded(system.band, lower=True, check_finite=False)
        lasts = self._blocks(memory, 0, self.n)[0][:, 2, 2]
        found = np.empty(forces.shape)
        for first in range(0, forces.shape[1], _TOGETHER):
            force = forces[:, first : first + _TOGETHER]
            kick = force[1:] - lasts[:, None] * force[:-1]
            asked = np.zeros((self.n, 3, force.shape[1]))
            asked[1:] += system.inverse[:, :, 2, None] * kick[:, None]
            asked[:-1] -= system.carried[:, :, 2, None] * kick[:, None]
            asked[0, 2] += force[0] / self._begin(strength)[2]
            hidden = cho_solve_banded((factor, True), asked.reshape(3 * self.n, -1), check_finite=False)
            found[:, first : first + _TOGETHER] = force - hidden[2::3]
        return found


def _thinned(signal: np.ndarray, factor: int) -> np.ndarray:
    """(n // factor,) means of ``factor`` samples each."""
    return signal[: signal.size // factor * factor].reshape(-1, factor).mean(axis=1) if factor > 1 else signal
