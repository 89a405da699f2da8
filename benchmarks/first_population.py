"""Random recordings as a laboratory first makes them, of rigs whose truth is known; `first_recordings.py` scores them.

Free motion: held or not, one to ten releases or plucks, damping ratio 0.0005 to 0.8, half a cycle to 500, stopped by
hand or not. Driven: steps, two levels, a chirp, tones in steps, a tone and its decay, bursts, hits, each hold. One mode
or two, linear or with any term of Equation 17. A sensor of displacement, velocity or acceleration with noise, offset,
drift and steps; a clock that jitters or loses samples; cut anywhere. Free linear motion is a closed form; everything
else is integrated by the Taylor series of the examples, which share no code with the package.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from dashpot.examples.force import chirp, multisine
from dashpot.examples.oscillator import integrate_pieces, linear_pieces

NAMES = ("mass", "omega0", "cubic", "preload", "viscous", "dry")
FREE = ("release", "releases", "plucks", "stopped")
DRIVEN = ("step", "two-level", "chirp", "stepped", "tone-decay", "bursts", "hits")
#: Every second recording is free: the list of what must work has as many lines of either.
IN_TURN = (*FREE, *FREE, *DRIVEN)
#: Drawn where they are asked for: with them in turn every seed would be another recording than it was.
ON_REQUEST = ("random",)
COLUMNS = {"displacement": "x_m", "velocity": "velocity_m_s", "acceleration": "acceleration_m_s2"}
#: Samples a recording has at most, linear and free, or integrated step by step in Python.
_MOST, _MOST_INTEGRATED = 40_000, 8_000
_FEWEST = 20


@dataclass(frozen=True, eq=False)
class Stretch:
    """Samples start to stop of a recording, in one kind of motion.

    Attributes:
        start, stop: samples.
        kind: free or driven; else held, moved, rest: where a hand or nothing acts.
        begin: displacement and velocity at its first sample, of each mode.
        pieces: force in N as polynomials over each step, (n, terms); None without one.
        path: (n, 3) displacement, velocity and acceleration where a hand moves it.
        known: whether ``begin`` is known to whoever identifies the rig, which rests.
    """

    start: int
    stop: int
    kind: str
    begin: tuple[tuple[float, float], ...] = ()
    pieces: np.ndarray | None = None
    path: np.ndarray | None = None
    known: bool = False


@dataclass(frozen=True, eq=False)
class Case:
    """A recording and the truth.

    Attributes:
        seed, kind: which; the same for the same seed.
        modes: parameters in SI of each mode, whose displacements add up.
        fs: Hz.
        quantity: what the sensor shows.
        stretches: the whole recording in order of time, before it is cut.
        cut: first sample that is kept, and the one after the last.
        noise, step: standard deviation of the sensor's white noise, and its resolution, in its unit.
        offset, drift: of the sensor, in its unit, and its unit per second.
        jitter: standard deviation of the stamps, in sample intervals; response and force are those at the stamps.
        lost: samples that are missing.
        force_noise: standard deviation on the force's samples, N.
        hold: how the force runs between its samples.
    """

    seed: int
    kind: str
    modes: tuple[Mapping[str, float], ...]
    fs: float
    quantity: str
    stretches: tuple[Stretch, ...]
    cut: tuple[int, int]
    noise: float
    step: float = 0.0
    offset: float = 0.0
    drift: float = 0.0
    jitter: float = 0.0
    lost: tuple[int, ...] = ()
    force_noise: float = 0.0
    hold: str = "smooth"
    words: tuple[str, ...] = field(default=())

    @property
    def n(self) -> int:
        """Samples before it is cut."""
        return self.stretches[-1].stop

    @property
    def is_linear(self) -> bool:
        """Whether no mode has a term beside mass, spring and viscous damping."""
        return not any(mode[name] for mode in self.modes for name in ("cubic", "preload", "dry"))

    def clean(self) -> np.ndarray:
        """(n, 3) displacement, velocity and acceleration, without anything of the sensor's."""
        return np.concatenate([moved(self.modes, stretch, self.fs) for stretch in self.stretches])

    def recorded(self) -> dict[str, np.ndarray]:
        """Columns by name, as ``dashpot.read`` takes them: time, force if any, response."""
        random = np.random.default_rng([self.seed, 1])
        time = np.arange(self.n) / self.fs
        late = np.clip(self.jitter * random.standard_normal(self.n), -0.4, 0.4)
        starts = [stretch.start for stretch in self.stretches]
        late[starts] = np.abs(late[starts])  # what begins there was not there before
        level = ("displacement", "velocity", "acceleration").index(self.quantity)
        parts = [moved(self.modes, s, self.fs, late[s.start : s.stop]) for s in self.stretches]
        shown = np.concatenate(parts)[:, level] + self.offset + self.drift * time
        shown = shown + self.noise * random.standard_normal(self.n)
        if self.step:
            shown = self.step * np.round(shown / self.step)
        columns = {"time_s": time + late / self.fs}
        driven = [stretch for stretch in self.stretches if stretch.pieces is not None]
        if driven:
            # what a sensor shows is the force at the stamp; what a converter holds is the row's number
            stamps = np.zeros(self.n) if self.hold == "zero" else late
            parts = [_force_at(s.pieces, stamps[s.start : s.stop]) for s in driven if s.pieces is not None]
            force = np.concatenate(parts)
            columns["force_N"] = force + self.force_noise * random.standard_normal(self.n)
        columns[COLUMNS[self.quantity]] = shown
        keep = np.setdiff1d(np.arange(*self.cut), self.lost)
        return {name: column[keep] for name, column in columns.items()}


def moved(
    modes: Sequence[Mapping[str, float]], stretch: Stretch, fs: float, late: np.ndarray | None = None
) -> np.ndarray:
    """(n, 3) displacement, velocity and acceleration over a stretch, at its samples or ``late`` (n,) samples later."""
    n = stretch.stop - stretch.start
    late = late if late is not None and np.any(late) else None
    if stretch.path is not None:
        if late is None:
            return stretch.path
        (x, v, a), by = stretch.path.T, late / fs
        return np.column_stack([x + v * by + a * by**2 / 2, v + a * by, a])
    total = np.zeros((n, 3))
    for mode, begin in zip(modes, stretch.begin, strict=True):
        made = _mode_moved(mode, begin, stretch.pieces, n, fs)
        total += made if late is None else _later(mode, made, stretch.pieces, late, fs)
    return total


def _mode_moved(
    mode: Mapping[str, float], begin: tuple[float, float], pieces: np.ndarray | None, n: int, fs: float
) -> np.ndarray:
    linear = not any(mode[name] for name in ("cubic", "preload", "dry"))
    half = mode["viscous"] / 2
    if pieces is None and linear and half < mode["omega0"]:
        t, ringing = np.arange(n) / fs, np.sqrt(mode["omega0"] ** 2 - half**2)
        x0, v0 = begin
        wave = (x0 - 1j * (v0 + half * x0) / ringing) * np.exp((1j * ringing - half) * t)
        x, v = wave.real, ((1j * ringing - half) * wave).real
        return np.column_stack([x, v, -mode["viscous"] * v - mode["omega0"] ** 2 * x])
    force = np.zeros((n, 1)) if pieces is None else pieces
    x, v = (y[:n] for y in integrate_pieces(mode, force, 1 / fs, *begin))
    spring = mode["omega0"] ** 2 * x + mode["cubic"] * x**3 + mode["preload"] * np.sign(x)
    net = force[:, 0] / mode["mass"] - spring
    a = net - mode["viscous"] * v - mode["dry"] * np.sign(v)
    # at rest friction takes what it can, and in the middle the preload too: the mass stays, or sets off against it
    still = (v == 0) & (np.arange(n) > 0)
    most = mode["dry"] + mode["preload"] * (x == 0)
    return np.column_stack([x, v, np.where(still, np.sign(net) * np.maximum(np.abs(net) - most, 0.0), a)])


def _later(
    mode: Mapping[str, float], made: np.ndarray, pieces: np.ndarray | None, late: np.ndarray, fs: float
) -> np.ndarray:
    """(n, 3) a mode's motion ``late`` (n,) samples after each sample, where the force of that side acts.

    A cubic: exact to the fourth power of what the motion turns until then.
    """
    x, v, a = made.T
    late = np.where((v == 0) & (a == 0), 0.0, late)  # what is held stays
    by = late / fs
    pieces = np.zeros((len(x), 1)) if pieces is None else pieces
    side = np.where(late < 0, 0.0, 1e-9)

    def acceleration(x: np.ndarray, v: np.ndarray, at: np.ndarray) -> np.ndarray:
        spring = mode["omega0"] ** 2 * x + mode["cubic"] * x**3 + mode["preload"] * np.sign(x)
        return _force_at(pieces, at) / mode["mass"] - spring - mode["viscous"] * v - mode["dry"] * np.sign(v)

    a = acceleration(x, v, side - 1e-9 * (late < 0))
    slope = (_force_at(pieces, late) - _force_at(pieces, side - 1e-9 * (late < 0))) / np.where(by, by, np.inf)
    jerk = slope / mode["mass"] - (mode["omega0"] ** 2 + 3 * mode["cubic"] * x**2) * v - mode["viscous"] * a
    x, v = x + v * by + a * by**2 / 2 + jerk * by**3 / 6, v + a * by + jerk * by**2 / 2
    return np.column_stack([x, v, np.where(by == 0, made[:, 2], acceleration(x, v, late))])


def _force_at(pieces: np.ndarray, late: np.ndarray) -> np.ndarray:
    """(n,) force ``late`` (n,) samples after each sample: before it that of the piece before."""
    index = np.arange(len(late)) - (late < 0)
    first = index < 0
    place = np.where(first, 0.0, late + (late < 0))
    return np.sum(pieces[np.maximum(index, 0)] * place[:, None] ** np.arange(pieces.shape[1]), axis=1)


def softened(pieces: np.ndarray) -> np.ndarray:
    """Polynomials over each step, (n, 11), of the same force as a chain passes it on that ends below half the rate.

    A force that begins or ends within a sample is not told by its samples: between them lies what aliases. A Gaussian
    of 1.37 samples leaves 1e-4 at half the sampling rate, and rings nowhere.
    """
    fine, width = 10, 1.37
    nodes = np.arange(fine) / fine
    raw = (pieces @ nodes ** np.arange(pieces.shape[1])[:, None]).ravel()
    reach = round(8 * width * fine)
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / (width * fine)) ** 2)
    soft = np.convolve(np.pad(raw, (reach, reach + 1)), kernel / kernel.sum(), "valid")
    steps = np.arange(len(pieces))[:, None] * fine + np.arange(fine + 1)
    inverse = np.linalg.inv((np.arange(fine + 1) / fine)[:, None] ** np.arange(fine + 1))
    return soft[steps] @ inverse.T


def case(seed: int, kind: str | None = None) -> Case:
    """The recording of a seed: of the kind whose turn it is, or of a given one."""
    random = np.random.default_rng([seed, 0])
    kind = kind or IN_TURN[seed % len(IN_TURN)]
    if kind not in (*IN_TURN, *ON_REQUEST):
        raise ValueError(f"{kind!r} is no kind of recording; there are {', '.join((*FREE, *DRIVEN, *ON_REQUEST))}")
    return _free(seed, kind, random) if kind in FREE else _driven(seed, kind, random)


def _between(random: np.random.Generator, low: float, high: float) -> float:
    """A number drawn evenly in its logarithm."""
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def _modes(random: np.random.Generator, zeta: float, amplitude: float, frequency: float) -> tuple[list[dict], float]:
    """One mode, linear or not, or two linear ones; and the second's part of the amplitude."""
    omega = 2 * np.pi * frequency
    first = dict.fromkeys(NAMES, 0.0) | {
        "mass": _between(random, 0.1, 10),
        "omega0": omega,
        "viscous": 2 * zeta * omega,
    }
    drawn = random.random()
    if drawn < 0.35:
        acts = random.random(3) < 0.5
        first["cubic"] = float(acts[0]) * random.uniform(-0.3, 0.6) * omega**2 / amplitude**2
        first["preload"] = float(acts[1]) * _between(random, 0.003, 0.05) * omega**2 * amplitude
        first["dry"] = float(acts[2]) * _between(random, 0.001, 0.02) * omega**2 * amplitude
    elif drawn < 0.5:
        ratio = 1 + _between(random, 0.02, 3.0)
        ratio = ratio if random.random() < 0.7 else 1 / ratio
        part = np.sqrt(_between(random, 0.01, 0.5))
        second = first | {"omega0": omega * ratio, "mass": first["mass"] / part / ratio}
        second["viscous"] = first["viscous"] * ratio * random.uniform(0.6, 1.6)
        return [first, second], float(part)
    return [first], 0.0


def _free(seed: int, kind: str, random: np.random.Generator) -> Case:
    frequency = _between(random, 0.2, 200)
    amplitude = min(_between(random, 3e-4, 3e-2), 300 / (2 * np.pi * frequency) ** 2)
    modes, part = _modes(random, _between(random, 5e-4, 0.8), amplitude, frequency)
    most = _MOST if not any(modes[0][name] for name in ("cubic", "preload", "dry")) else _MOST_INTEGRATED
    count = 1 if kind in ("release", "stopped") else int(random.integers(2, 11))
    if kind == "plucks" and random.random() < 0.3:
        count = 1
    samples = _between(random, 4, 5000)
    cycles = float(np.clip(_between(random, 0.5, 500), _FEWEST / samples, max(most / samples / count / 2, 0.5)))
    samples = float(np.clip(samples, 4, max(4, most / cycles / count / 2)))
    fs = samples * frequency
    stretches: list[Stretch] = []
    state = [(0.0, 0.0)] * len(modes)

    def add(kind: str, n: int, path: np.ndarray | None = None) -> None:
        nonlocal state
        start = stretches[-1].stop if stretches else 0
        stretch = Stretch(start, start + n, kind, tuple(state), path=path)
        stretches.append(stretch)
        if path is None:
            longer = [_mode_moved(m, s, None, n + 1, fs)[-1] for m, s in zip(modes, state, strict=True)]
            state = [(float(end[0]), float(end[1])) for end in longer]

    def hold(at: float, low: float, high: float, kind: str) -> None:
        n = max(1, min(round(_between(random, low, high) * samples), most // 8))
        add(kind, n, np.tile([at, 0.0, 0.0], (n, 1)))

    def carried(to: float, low: float, high: float) -> None:
        n = max(2, min(round(_between(random, low, high) * samples), most // 8))
        now = stretches[-1] if stretches else None
        last = moved(modes, now, fs)[-1] if now is not None else np.zeros(3)
        add("moved", n, _quintic(last, to, n, fs))

    for k in range(count):
        size = amplitude * random.uniform(0.5, 1.0) * random.choice([-1, 1])
        length = max(2, round(cycles * samples * (1.0 if count == 1 else random.uniform(0.6, 1.4))))
        if kind == "plucks":
            if k == 0 and random.random() < 0.7:
                hold(0.0, 0.1, 20, "rest")
            kicks = [size, size * part * random.choice([-1, 1])][: len(modes)]
            state = [(x, v + kick * m["omega0"]) for (x, v), kick, m in zip(state, kicks, modes, strict=True)]
        else:
            if k > 0:
                carried(size, 0.3, 3)
            if k > 0 or random.random() < 0.7:
                hold(size, 0.1, 20 if k == 0 else 5, "held")
            second = random.choice([-1, 1]) * part * size
            state = [(size, 0.0)] if len(modes) == 1 else [(size - second, 0.0), (second, 0.0)]
        add("free", length)
    if kind == "stopped":
        carried(amplitude * random.choice([0.0, random.uniform(-0.5, 0.5)]), 0.1, 0.6)
        hold(float(stretches[-1].path[-1, 0]) if stretches[-1].path is not None else 0.0, 0.5, 20, "held")
    return _sensed(seed, kind, modes, fs, tuple(stretches), random)


def _quintic(begin: np.ndarray, to: float, n: int, fs: float) -> np.ndarray:
    """(n, 3) of a hand's way from a state to rest at a place: the polynomial of degree five that joins them."""
    length = (n + 1) / fs
    powers = np.arange(6)
    end = np.array([powers**0.0, powers, powers * (powers - 1.0)])
    known = np.array([begin[0], begin[1] * length, begin[2] * length**2 / 2])
    rest = np.array([to, 0.0, 0.0]) - end[:, :3] @ known
    weights = np.concatenate([known, np.linalg.solve(end[:, 3:], rest)])
    s = np.arange(1, n + 1) / (n + 1)
    polynomial = np.polynomial.Polynomial(weights)
    return np.column_stack([polynomial.deriv(k)(s) / length**k if k else polynomial(s) for k in range(3)])


def _driven(seed: int, kind: str, random: np.random.Generator) -> Case:
    frequency = _between(random, 0.5, 200)
    amplitude = min(_between(random, 3e-4, 3e-2), 300 / (2 * np.pi * frequency) ** 2)
    zeta = _between(random, 2e-3, 0.3)
    modes, _ = _modes(random, zeta, amplitude, frequency)
    samples = _between(random, 10, 200)
    cycles = min(_between(random, 15, 300), _MOST_INTEGRATED / samples)
    fs, n = samples * frequency, round(cycles * samples)
    dt, times = 1 / fs, np.arange(n) / fs
    stiffness = modes[0]["mass"] * modes[0]["omega0"] ** 2
    resonant = stiffness * amplitude * max(2 * zeta, 0.02)
    hold = str(random.choice(["smooth", "zero", "linear"]))
    if kind in ("step", "two-level"):
        hold = "zero"
        dwell = 0.3 * n if kind == "step" else max(2.0, samples * random.uniform(0.15, 0.8))
        edges = np.cumsum(random.uniform(0.4, 1.6, size=max(2, 3 * n)) * dwell).astype(int)
        edges = edges[edges < n]
        levels = np.repeat(random.uniform(-1, 1, edges.size + 1), np.diff([0, *edges, n]))
        flips = np.repeat(random.choice([-1.0, 1.0], edges.size + 1), np.diff([0, *edges, n]))
        pieces = 0.5 * stiffness * amplitude * (levels if kind == "step" else flips)[:, None]
        if kind == "step":
            pieces[: edges[0] if edges.size else 1] = 0.0
    elif kind == "chirp":
        low, high = frequency * random.uniform(0.2, 0.8), frequency * random.uniform(1.2, 2.0)
        pieces = chirp(2 * resonant, low, (high - low) * fs / n, times, dt)
    elif kind == "stepped":
        pieces, rest = [], n
        for tone in np.linspace(random.uniform(0.5, 0.8), random.uniform(1.2, 1.6), int(random.integers(4, 10))):
            length = min(rest, round(np.ceil(n / 7 / samples * tone) * samples / tone))
            pieces.append(chirp(resonant, tone * frequency, 0.0, np.arange(length) / fs, dt))
            rest -= length
        pieces = np.concatenate([*pieces, np.zeros((rest, 11))])
    elif kind == "random":
        pieces, hold = _random_force(2 * resonant, samples, n, hold, random)
    elif kind in ("tone-decay", "bursts"):
        count = 1 if kind == "tone-decay" else int(random.integers(2, 6))
        pieces, tone = np.zeros((n, 11)), frequency * random.uniform(0.85, 1.15)
        for block in np.array_split(np.arange(n), count):
            length = round(block.size * random.uniform(0.2, 0.6))
            pieces[block[:length]] = chirp(resonant, tone, 0.0, np.arange(length) / fs, dt)
    else:
        hold, pieces = "smooth", np.zeros((n, 11))
        width = max(4, round(samples * random.uniform(0.03, 0.25)))
        impulse = modes[0]["mass"] * modes[0]["omega0"] * amplitude
        for block in np.array_split(np.arange(n), int(random.integers(1, 11))):
            if block.size < 4 * width:
                continue
            first = block[0] + int(random.integers(0, max(1, block.size // 4)))
            twice = [0, 2 * width] if random.random() < 0.2 else [0]
            for late in twice:
                hit = multisine(-1.0, np.array([fs / width]), np.array([np.pi / 2]), np.arange(width) / fs, dt)
                hit[:, 0] += 1.0
                if first + late + width <= n:
                    pieces[first + late : first + late + width] = hit * impulse * random.uniform(0.3, 1) * fs / width
    if hold == "smooth":
        pieces = softened(pieces)
    else:
        force = pieces[:, 0]
        pieces = force[:, None] if hold == "zero" else np.vstack([linear_pieces(force), [[force[-1], 0.0]]])
    whole = Stretch(0, n, "driven", ((0.0, 0.0),) * len(modes), pieces, known=True)
    if modes[0]["cubic"] < 0 and not np.all(np.isfinite(moved(modes, whole, fs))):
        modes[0]["cubic"] *= -1  # a spring that gave way is no rig that anybody recorded
    peak = float(np.max(np.abs(pieces[:, 0])))
    force_noise = 1e-3 * peak if random.random() < 0.5 else 0.0
    return _sensed(seed, kind, modes, fs, (whole,), random, force_noise=force_noise, hold=hold)


def _random_force(
    size: float, samples: float, n: int, hold: str, random: np.random.Generator
) -> tuple[np.ndarray, str]:
    """Random forces that labs use: white or of two levels, drawn anew every so many samples, or a band of noise.

    Args:
        size: standard deviation, N, where half of the band is the resonance's neighbourhood.
        samples: per cycle of the rig.
        n: samples in all.
        hold: how it runs between them; what a band ends below half the rate may be smooth.
        random: drawn from.

    Returns:
        Polynomials over each step, (n, terms), and how the force runs.
    """
    every = int(random.choice([1, 1, 2, max(1, round(samples / 8))]))
    if (shape := random.choice(["white", "levels", "band"])) == "band":
        spectrum = np.exp(2j * np.pi * random.random(n // 2 + 1))
        spectrum[0] = 0.0
        spectrum[np.arange(n // 2 + 1) / n > random.uniform(1.5, 4.0) / samples] = 0.0
        drawn = np.fft.irfft(spectrum, n)
        return (size * drawn / np.std(drawn))[:, None], hold
    drawn = random.standard_normal(n) if shape == "white" else random.choice([-1.0, 1.0], n)
    drawn = np.repeat(drawn[: -(-n // every)], every)[:n]
    leaps = hold == "smooth" or every > 1 or shape == "levels"
    return (size * np.sqrt(samples / every) / 2 * drawn)[:, None], "zero" if leaps else hold


def _sensed(
    seed: int,
    kind: str,
    modes: Sequence[Mapping[str, float]],
    fs: float,
    stretches: tuple[Stretch, ...],
    random: np.random.Generator,
    **more: Any,
) -> Case:
    """A motion as a sensor shows it, cut somewhere."""
    quantity = str(random.choice(list(COLUMNS), p=[0.5, 0.25, 0.25]))
    level, n = list(COLUMNS).index(quantity), stretches[-1].stop
    motion = np.concatenate([moved(modes, stretch, fs)[:, level] for stretch in stretches])
    size = float(np.ptp(motion)) / 2
    noise = 1e-3 if random.random() < 0.5 else _between(random, 3e-4, 1e-2)
    how: dict[str, Any] = {"noise": noise * size}
    words = []
    if quantity == "displacement" and random.random() < 0.25:
        how["step"] = size / random.uniform(100, 300)
        words.append("steps")
    if random.random() < 0.5:
        how["offset"] = size * random.uniform(-1, 1)
        words.append("offset")
    if random.random() < 0.15:
        how["drift"] = size * random.uniform(0.02, 0.1) * fs / n
        words.append("drift")
    if random.random() < 0.15:
        how["jitter"] = random.uniform(0.02, 0.15)
        words.append("jitter")
    if random.random() < 0.1:
        places = random.integers(n // 10, max(n // 10 + 1, n - n // 10), int(random.integers(1, 4)))
        how["lost"] = tuple(sorted({int(p) + j for p in places for j in range(int(random.integers(1, 4)))}))
        words.append("lost")
    cut = [0, n]
    if random.random() < 0.3:
        cut = [int(n * random.uniform(0, 0.3)), n - int(n * random.uniform(0, 0.3))]
        words.append("cut")
    if cut[1] - cut[0] < _FEWEST:
        cut = [0, n]
    words += ["two modes"] * (len(modes) == 2)
    words += [name for name in ("cubic", "preload", "dry") if modes[0][name]]
    return Case(seed, kind, tuple(modes), fs, quantity, stretches, (cut[0], cut[1]), words=tuple(words), **how, **more)
