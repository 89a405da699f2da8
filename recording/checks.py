"""What can be wrong with a recording, each found by one function that returns a list of problems."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from hashlib import sha256
from typing import Literal

import numpy as np

from .as_recorded import said_of, signals_of
from .clipping import Clipping, clipping, measured, noise_of
from .continuity import folded, in_both, leaps, noise_beside, repeated, wrapped
from .oscillation import Oscillation, is_one_decay, is_white, oscillation_of
from .passivity import driven
from .recording import QUANTITIES, Recording
from .relation import lasting, reach
from .resolution import converter_step
from .units import STANDARD_GRAVITY, parse_unit

FORCED_CYCLES = 4  # the force says where each cycle comes from, so slightly fewer do
SCANT_CYCLES = 10
FORCE_IS_NOISE = "the force is unrelated noise and the response a free decay; the force is left out"
LEAST_SAMPLES = 4  # a cycle; Hilbert envelopes and the third harmonic alias below
SCANT_SAMPLES = 10
NOISY_STEPS = 2.0  # noise of so many steps of a converter leaves one sample in five as it was, sixteen of sixteen never
SAME = 1e-6  # of the range: what a file of six digits leaves of one signal that stands in it twice
LEVELS = 256  # of eight bits; fewer, and rounding keeps step with the motion instead of averaging out


@dataclass(frozen=True)
class Problem:
    """One thing wrong: an "error" makes the recording useless (``mute``: whole as it is), a "note" is worth knowing."""

    severity: Literal["error", "note"]
    sentence: str
    mute: bool = False


def check(recording: Recording, *, stated: bool = False) -> list[Problem]:
    """Return everything wrong with a recording, errors first; an empty list means that nothing was found.

    A signal of a few samples, that holds no numbers or never moves, is judged no further. Where the unit of the
    response was `stated` by the user, a rotation by many turns is what it is: a shaft turns so far, and a torsion wire.
    """
    problems = too_few(recording) or not_a_number(recording) or out_of_range(recording) or constant(recording)
    if not problems:
        motion = oscillation_of(recording)
        for judge in (written_twice, one_signal) if recording.prescribed else _JUDGES:
            problems += judge(recording, motion)
        if stated and recording.unit in ROTATIONS:
            problems = [p for p in problems if p not in wrong_unit(recording, motion)]
    return sorted(problems, key=lambda problem: problem.severity != "error")


def too_few(recording: Recording) -> list[Problem]:
    """Find what no judge can judge: fewer samples than the fewest cycles have."""
    least = FORCED_CYCLES * LEAST_SAMPLES
    if recording.n >= least:
        return []
    sentence = f"has {recording.n} samples; at least {least} are needed, and many more are better"
    return [_error(recording, sentence, mute=True)]


def not_a_number(recording: Recording) -> list[Problem]:
    """Find NaN and infinity in the response and the force."""
    problems = []
    for signal, name, _ in signals_of(recording):
        bad = np.flatnonzero(~np.isfinite(signal))
        if len(bad):
            at = recording.start + bad[0] / recording.fs
            problems.append(
                _error(
                    recording,
                    f"the {name} has {len(bad)} value(s) that are not a number, the first at {at:.6g} s; "
                    "cut that part out or record again",
                )
            )
    return problems


def out_of_range(recording: Recording) -> list[Problem]:
    """Find values that no sensor gives."""
    problems = []
    for signal, name, said in signals_of(recording):
        if (found := impossible(signal)) is not None:
            at = recording.start + found[0] / recording.fs
            sentence = f"the {name} is {said(signal[found[0]], 3)} at {at:.6g} s, {found[1]}"
            problems.append(_error(recording, f"{sentence}; mend or cut out that sample"))
    return problems


def constant(recording: Recording) -> list[Problem]:
    """Find a response that never moves by more than rounding."""
    if np.ptp(response := recording.response) > 1e-12 * np.max(np.abs(response)):
        return []
    what, option = ("motion", "prescribed") if recording.prescribed else ("response", "response")
    size = said_of(recording, response[0])
    sentence = f"the {what} is {size} throughout; check the sensor, or name another column with --{option}"
    return [_error(recording, sentence, mute=True)]


def leaping(recording: Recording, motion: Oscillation) -> list[Problem]:
    """Find places where a displacement goes further in one sample than anything with mass does."""
    if recording.quantity != "displacement":
        return []  # an impact turns a velocity round within a sample
    found = leaps(recording.response, recording.fs / motion.frequency)
    if not found or wrapping(recording, motion):
        return []
    first, at = found[0], recording.start + found[0].first / recording.fs
    there_and_back = first.back and 0 < first.first < recording.n - 2
    what = (
        f"the response jumps by {said_of(recording, first.size, 3)} within one sample at {at:.6g} s"
        f"{', and back' if there_and_back else ''}, {first.times:.2g} times as far as in any other of that cycle"
    )
    if len(found) > 1:
        what += f", and {len(found) - 1} more time(s)"
    if all(leap.back for leap in found):
        return [_error(recording, f"{what}: no motion does that; mend that sample or cut it out with --part FROM:TO")]
    return [
        _error(
            recording,
            f"{what}: samples are missing or held there, or the sensor slipped; use the parts before and after as "
            "recordings of their own (--part FROM:TO)",
        )
    ]


def wrapping(recording: Recording, _: Oscillation) -> list[Problem]:
    """Find a signal that goes on at the other end of its range: an angle in one turn, or a converter's overflow."""
    problems = []
    for signal, name, said in signals_of(recording):
        angle = name == "response" and recording.quantity == "displacement" and recording.unit == "rad"
        turns = wrapped(signal) if angle else np.zeros(0, int)
        places = turns if turns.size else folded(signal)
        if not places.size:
            continue
        at = recording.start + places[0] / recording.fs
        sentence = (
            f"the angle jumps by a full turn {places.size} time(s), first at {at:.6g} s: it was wrapped into one turn "
            "(±180°, ±pi); unwrap it in the file, as numpy.unwrap does, so that it runs on"
            if turns.size
            else f"the {name} wraps {places.size} time(s) from one end of its range to the other, by "
            f"{said(float(np.ptp(signal)))}, first at {at:.6g} s: its converter or its counter overflows; unwrap it in "
            "the file by that range, or record with more"
        )
        problems.append(_error(recording, sentence))
    return problems


def written_twice(recording: Recording, _: Oscillation) -> list[Problem]:
    """Find a block of samples that the recorder wrote twice: with noise on a signal nothing is the same again."""
    if not _is_noisy(recording.response):
        return []
    signals = np.vstack([signal for signal, _, _ in signals_of(recording)])
    for a, b in recording.blank:  # what was filled is the same in every cycle
        signals[0, a:b] = np.nan
    if (found := repeated(signals)) is None:
        return []
    later, earlier, length = found
    times = [recording.start + place / recording.fs for place in (later, earlier)]
    return [
        _error(
            recording,
            f"the {length} samples from {times[0]:.6g} s on are those from {times[1]:.6g} s on once more: the recorder "
            "wrote a block twice, and what follows is late; use the part before it (--part FROM:TO), or record again",
        )
    ]


def overlapping(recordings: Sequence[Recording]) -> list[Problem]:
    """Find what is there twice among several recordings: one of them again, or a block that two of them hold.

    What is computed, or rounded so that its noise does not show, may well repeat in part.
    """
    seen: set[tuple[float, bytes]] = set()
    for recording in recordings:  # one look at each, before anything is computed of any
        signals = b"".join(signal.tobytes() for signal, _, _ in signals_of(recording))
        key = (recording.start, sha256(signals).digest())
        if key in seen:
            why = "which would make the standard errors too small; name each recording once"
            return [Problem("error", f"{recording.name} is given twice, {why}")]
        seen.add(key)
    asked = [r for r in recordings if r.n >= LEAST_SAMPLES and _is_noisy(r.response, SAME)]
    for channels in (1, 2):
        alike = [r for r in asked if len(signals_of(r)) == channels]
        found = in_both([np.vstack([signal for signal, _, _ in signals_of(r)]) for r in alike])
        if found is None:
            continue
        one, other, first, second, length = found
        earlier, later = alike[one], alike[other]
        sentence = (
            f"the {length} samples from {later.start + second / later.fs:.6g} s on are those of {earlier.name} from "
            f"{earlier.start + first / earlier.fs:.6g} s on: one run would count twice and the standard errors be too "
            "small; name one of them, or only what the other does not have (--part FROM:TO)"
        )
        return [_error(later, sentence)]
    return []


def _is_noisy(response: np.ndarray, least: float = 0.0) -> bool:
    """Whether a response (n,) has noise that no two runs share, more than so much of its range."""
    if not np.all(np.isfinite(response)) or not measured(response):
        return False
    return noise_beside(response) >= NOISY_STEPS * max(converter_step(response), least * float(np.ptp(response)))


def coarse(recording: Recording, _: Oscillation) -> list[Problem]:
    """Find signals of so few levels that their rounding keeps step with the motion."""
    notes = []
    for signal, name, said in signals_of(recording):
        step = converter_step(signal)
        if step and (levels := float(np.ptp(signal)) / step) < LEVELS:
            notes.append(
                _note(
                    recording,
                    f"the {name} has only {levels:.0f} levels, {said(step, 3)} apart: what rounding does to it "
                    "repeats with the motion and is a large part of the parameters' errors; use a smaller range",
                )
            )
    return notes


def clipped(recording: Recording, motion: Oscillation) -> list[Problem]:
    """Find signals cut off at the end of the measuring range.

    A force cut off without any noise was commanded so. Where the peaks hide less of the force than the response's noise
    is of the motion, the loss does not show in the recording.
    """
    problems = []
    for signal, name, said in signals_of(recording):
        rails = clipping(signal)
        if not rails:
            continue
        first = recording.start + min(rail.first for rail in rails) / recording.fs
        last = recording.start + max(rail.last for rail in rails) / recording.fs
        levels = " and ".join(said(rail.level) for rail in rails)
        what = (
            f"the {name} is clipped: it stays exactly at {levels} on {sum(rail.visits for rail in rails)} peaks "
            f"({sum(rail.samples for rail in rails)} samples), from {first:.4g} to {last:.4g} s"
        )
        if name == "force" and not measured(signal):
            problems.append(_note(recording, f"{what}; if it was measured and not commanded so, record again"))
        elif name == "force" and (share := _hidden(rails, signal)) < _noise_share(recording.response):
            lost = f"{100 * share:.2g} % of the force, which the noise of the response exceeds"
            problems.append(_note(recording, f"{what}; that hides about {lost}"))
        else:
            again = "record again with a larger measuring range or a lower level"
            problems.append(_error(recording, f"{what}; use a part without it (--part FROM:TO), or {again}"))
    return problems


def _hidden(rails: list[Clipping], signal: np.ndarray) -> float:
    """Rms of what lies beyond the rails over that of the signal."""
    return float(np.sqrt(sum(rail.hidden for rail in rails) / (len(signal) * np.var(signal))))


def _noise_share(response: np.ndarray) -> float:
    return noise_of(response) / float(np.std(response))


def undersampled(recording: Recording, motion: Oscillation) -> list[Problem]:
    """Find too few samples in a cycle of the dominant frequency."""
    samples = recording.fs / motion.frequency
    if samples >= SCANT_SAMPLES or is_white(recording.response):
        return []  # the strongest line of mere noise is no oscillation
    what = f"only {samples:.2g} samples a cycle at the dominant {motion.frequency:.4g} Hz"
    if samples < LEAST_SAMPLES:
        return [_error(recording, f"{what}; record again at {_round_up(20 * motion.frequency)} Hz or more")]
    return [_note(recording, f"{what}; 20 or more would show harmonics, {_round_up(20 * motion.frequency)} Hz")]


def too_few_cycles(recording: Recording, motion: Oscillation) -> list[Problem]:
    """Find a record in which the response swings only a few times beyond its noise."""
    if any(problem.severity == "error" for problem in undersampled(recording, motion)):
        return []  # the cycles are not in the samples: said already
    what = f"only {motion.cycles:g} oscillation cycles stand out of the noise in {recording.duration:.4g} s"
    if motion.cycles < SCANT_CYCLES:
        return [_note(recording, f"{what}; {SCANT_CYCLES} or more would give better estimates")]
    return []


def wrong_unit(recording: Recording, motion: Oscillation) -> list[Problem]:
    """Find a response too large or too small by orders of magnitude for its unit."""
    doubt = implausible(recording.quantity, recording.unit, motion.amplitude, motion.frequency)
    if doubt is None:
        return []
    advice = "state the right unit with --unit"
    if doubt.probable:
        turns = f", --unit {recording.unit} if it does turn so far" if recording.unit in ROTATIONS else ""
        advice = f"the unit is probably {doubt.probable}: pass --unit {doubt.probable} if so{turns}"
    sentence = f"the response of {doubt.reason}; {advice}; a wrong unit of the time looks so too"
    return [_error(recording, sentence) if doubt.impossible else _note(recording, sentence)]


def no_reach(recording: Recording, motion: Oscillation) -> list[Problem]:
    """Find a force that varies and to which the response shows no relation in the force's own band."""
    if recording.force is None or _free(recording) or not lasting(recording.force):
        return []
    if (relation := reach(recording.force, recording.response)) is None or relation.related:
        return []
    is_noise = is_white(recording.force)
    if is_noise and is_one_decay(recording.response, recording.fs, motion.frequency):
        return [_note(recording, FORCE_IS_NOISE)]
    found = driven(recording.force, recording.response, recording.fs, motion.frequency, recording.quantity)
    if found is not None and found.is_related():
        return []
    size = said_of(recording, float(np.std(recording.force)), 2, force=True)
    what = (
        f"the force column holds nothing but white noise, {size} rms, and of the response it explains"
        if is_noise
        else "the force does not reach the response: in the force's own frequency band it explains"
    )
    sentence = (
        f"{what} no more than chance would (coherence {relation.coherence:.2f}); check the columns, the cable "
        "and that both belong to one run, or leave the force out with --force none if this is a free decay"
    )
    return [_error(recording, sentence, mute=True)]


def one_signal(recording: Recording, _: Oscillation) -> list[Problem]:
    """Find a force that is the response times a number: two sensors have noises of their own."""
    force, response = recording.force, recording.response - np.mean(recording.response)
    if force is None or not np.ptp(force) > 0:
        return []
    times = float(response @ (force - np.mean(force))) / float(response @ response)
    if np.max(np.abs(force - np.mean(force) - times * response)) > SAME * np.ptp(force):
        return []
    return [
        _error(
            recording,
            f"the force is the response times {times:.6g} {recording.force_unit}/{recording.unit}, sample by sample: "
            "one signal stands in both columns; choose others with --force and --response",
        )
    ]


def reversed_force(recording: Recording, motion: Oscillation) -> list[Problem]:
    """Find a force that takes work out of the thing all the time: its sign is wrong, or it is half a cycle late."""
    force = recording.force
    if force is None or _free(recording) or not lasting(force):
        return []
    if power_cosine(force, recording.response, recording.fs, recording.quantity) > REVERSED:
        return []
    found = driven(force, recording.response, recording.fs, motion.frequency, recording.quantity)
    if found is None or found.cosine > REVERSED:  # what was stored before the record, or before each edge, rings
        return []
    if wrapping(recording, motion):
        return []
    if no_reach(recording, motion):
        return []  # unrelated signals have no phase
    drives = "the moving base" if recording.base else "the force"
    return [
        _note(
            recording,
            f"{drives} takes work out of the motion instead of putting any in: its sign or that of the response is "
            f"wrong, or it is recorded about half a cycle late, or the response is no {recording.quantity}, or each is "
            "the other; turn the response with --calibration response=-1, state --quantity, or exchange the columns",
        )
    ]


_JUDGES: tuple[Callable[[Recording, Oscillation], list[Problem]], ...] = (
    leaping,
    wrapping,
    written_twice,
    coarse,
    clipped,
    undersampled,
    too_few_cycles,
    wrong_unit,
    no_reach,
    one_signal,
    reversed_force,
)


def _free(recording: Recording) -> bool:
    return recording.force is None or bool(np.ptp(recording.force) == 0)


def _round_up(rate: float) -> str:
    step = 10.0 ** np.floor(np.log10(rate))
    return f"{np.ceil(rate / step) * step:g}"


def _error(recording: Recording, sentence: str, *, mute: bool = False) -> Problem:
    return Problem("error", f"{recording.name}: {sentence}", mute)


def _note(recording: Recording, sentence: str) -> Problem:
    return Problem("note", f"{recording.name}: {sentence}")


# Numbers that no sensor gives: beyond all measuring, or alone so far above all others that no converter shows both.

#: In whatever unit: squares and fourth powers of it are still numbers.
_LARGEST = 1e30
#: A converter of 24 bits tells so many levels apart; spikes of so few samples are no motion.
_LEVELS, _LONE = 2.0**24, 3


def impossible(signal: np.ndarray) -> tuple[int, str] | None:
    """Index of a value that cannot have been measured, and why in words; None where there is none.

    Args:
        signal: (n,), finite.
    """
    size = np.abs(signal)
    at = int(np.argmax(size))
    if size[at] > _LARGEST:
        return at, f"which no sensor gives (more than {_LARGEST:g})"
    if size.size > 10 * _LONE:
        others = float(np.partition(size, -1 - _LONE)[-1 - _LONE])
        if 0.0 < others * _LEVELS < size[at]:
            return at, f"{size[at] / others:.1g} times all but {_LONE} others, which no converter shows at once"
    return None


# Whether force and response have signs that belong together: a passive thing takes up work, it does not give any.

IN_BAND = 1e-3  # of the strongest line: the force's own band reaches down to -30 dB
#: Energy can only be dissipated or stored, so the mean cosine cannot stay negative. The margin is for what was
#: stored before the record began, for noise, and for a late sensor.
REVERSED = -0.2


def power_cosine(force: np.ndarray, response: np.ndarray, fs: float, quantity: str) -> float:
    """Mean cosine of the phase between force and velocity, both (n,), weighted by |F| |V| over the force's own band.

    Its sign is that of the work that the force does on the thing: the integral of F v dt, by Parseval's theorem, with
    a Hann window so that the ends of the record do not count. A velocity comes from the response by powers of i omega.
    """
    window = np.hanning(len(force))
    f, x = (np.fft.rfft((signal - signal.mean()) * window)[1:] for signal in (force, response))
    omega = 2 * np.pi * np.fft.rfftfreq(len(force), 1 / fs)[1:]
    v = x * (1j * omega) ** (1 - QUANTITIES.index(quantity))
    band = np.abs(f) ** 2 > IN_BAND * np.max(np.abs(f) ** 2)
    work = np.conj(f[band]) * v[band]
    return float(np.sum(work.real) / max(np.sum(np.abs(work)), np.finfo(float).tiny))


# Whether a response is of a size that a vibrating thing can have, or its unit is wrong by orders of magnitude.

FASTEST = 20.0  # m/s: a resonating solid is strained by v/c (Hunt 1960); 20 m/s over 5000 m/s breaks most of them
FAST = 5.0  # m/s: beyond what shakers reach
HARDEST = 1000 * STANDARD_GRAVITY  # m/s2, for what moves by more than LARGE: shakers end near 100 g
LARGE = 0.01  # m
FAINT = 1e-9, 1e-6  # m and m/s2, both: a nanometre is seen by interferometers, 0.1 ug by seismometers
FAINTEST = 1e-12  # m
MOST_TURNED = math.pi  # rad: beyond half a turn it rotates and does not vibrate
MOST_STRAINED = 0.05  # elastic strain of metals ends near 0.005, of most plastics near 0.05
LEAST_STRAINED = 1e-10

ROTATIONS = ("rad", "rad/s", "rad/s2")
_SMALLER = {"m": ("mm", "um"), "m/s": ("mm/s", "um/s"), "m/s2": ("mm/s2",), "strain": ("microstrain",)}


@dataclass(frozen=True)
class Implausible:
    """Why a response cannot be (`impossible`) or hardly is of this size, and the unit that would make sense of it."""

    impossible: bool
    reason: str
    probable: str | None


def implausible(quantity: str, unit: str, amplitude: float, frequency: float) -> Implausible | None:
    """Judge an amplitude (SI, as `unit` says) at a frequency in Hz; None if it can be.

    Volts and other raw signals are not judged.
    """
    omega = 2 * math.pi * max(frequency, 1e-9)
    order = {"displacement": 0, "velocity": 1, "acceleration": 2}[quantity]
    moved, speed, acceleration = (amplitude * omega ** (k - order) for k in range(3))
    size = f"{amplitude:.3g} {unit} at {frequency:.3g} Hz"
    if unit in ROTATIONS and moved > MOST_TURNED:
        return Implausible(True, f"{size} is {moved / (2 * math.pi):.3g} turns", unit.replace("rad", "deg"))
    if unit == "strain" and amplitude > MOST_STRAINED:
        return Implausible(True, f"{size} would break the part", "microstrain")
    if unit == "strain" and amplitude < LEAST_STRAINED:
        return Implausible(True, f"{size} is less than any gauge resolves", None)
    if unit not in _SMALLER or unit == "strain":
        return None
    if moved < FAINTEST or (moved < FAINT[0] and acceleration < FAINT[1]):
        size += f" is a motion of {moved:.3g} m and {acceleration / STANDARD_GRAVITY:.3g} g"
        return Implausible(True, f"{size}, less than any sensor resolves", None)
    impossible = speed > FASTEST or (acceleration > HARDEST and moved > LARGE)
    if impossible or (speed > FAST and moved > LARGE):
        factors = [(name, parse_unit(name, "").factor) for name in _SMALLER[unit]]
        probable = next((name for name, factor in factors if speed * factor <= FAST), factors[-1][0])
        size += f" is a peak of {acceleration / STANDARD_GRAVITY:.3g} g and {speed:.3g} m/s"
        return Implausible(impossible, size, probable)
    return None
