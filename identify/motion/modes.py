"""Several modes in one recording: the wanted one alone, in a zero-phase band that does not bend its backbone.

Which modes there are is found in ``mode_lines``. Where the strongest has others beside it that no law stands for, it is
isolated without being asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ...errors import BadInput
from ...model.oscillator import Band, Oscillator
from ...recording.recording import Recording
from ..signals.registry import numerics, shown
from .band import in_band
from .damped_modes import Modes
from .decays import find_free_motion, linear_modes
from .mode import Mode
from .mode_lines import modes_of

_EDGE = numerics(0.72, "of the way to the next mode", why="in logarithms, at which a band is half as high")
_LISTED = shown(3, "modes", why="beside the one that is taken, in a note")


def isolated(recordings: Sequence[Recording], wanted: str | None = None) -> tuple[list[Recording], Band | None, str]:
    """The recordings with one mode alone, by a zero-phase band; as they are where there is nothing to take away.

    Args:
        recordings: of one rig.
        wanted: which mode, as ``mode_of``; where None the strongest, and only where the others are more than
            a law of the library can stand for.

    Returns:
        recordings, the band (None where nothing was taken away), and a note; empty where there is one mode.
    """
    modes = modes_of(recordings, whole=wanted is not None)
    if wanted is None and len(modes) < 2:
        return list(recordings), None, ""
    mode = mode_of(modes, wanted)
    others = [other for other in modes if other is not mode]
    note = f"the mode at {_hz(mode.frequency)} holds {100 * mode.share:.3g} % of the motion"
    if others:
        note += f" beside {_listed(others)}"
    if not others:
        return list(recordings), None, f"{note}; no other was found, and nothing was taken away"
    # within an octave a law stands for one further mode, or the fit takes it beside; what is farther a band takes away
    nearest = min(max(o.frequency / mode.frequency, mode.frequency / o.frequency) for o in others)
    if wanted is None and len(others) == 1 and nearest < 2:
        return list(recordings), None, f"{note}; both are fitted together, --mode {modes.index(mode) + 1} isolates it"
    band = band_around(mode, others)
    if band is None:
        if wanted is not None:
            raise BadInput(
                f"{note}, but its frequency moves from {_hz(mode.low)} to {_hz(mode.high)} with its amplitude: a band "
                "that leaves the others out would bend it; record at a lower level, or where the others move less"
            )
        return list(recordings), None, f"{note}; they lie too near to it to be taken away"
    return [in_band(r, band) for r in recordings], band, f"{note}; it was isolated {_between(band)}"


def mode_alone(
    recordings: Sequence[Recording], wanted: str | None, model: Oscillator | None, say: Callable[[str], None]
) -> tuple[list[Recording], Band | None]:
    """The recordings in the band of a model where one is given and no mode wanted, else as ``isolated``; notes said."""
    if wanted is None and model is not None:
        return in_the_same_band(recordings, model.identified.band), model.identified.band
    alone, band, note = isolated(recordings, wanted)
    if note:
        say(f"note: {note}")
    return alone, band


def mode_beside(
    recordings: Sequence[Recording], wanted: str | None, model: Oscillator | None, say: Callable[[str], None]
) -> tuple[list[Recording], Band | None, float | None]:
    """As ``mode_alone``, and the frequency in Hz of the mode that is fitted beside others; None where it is alone."""
    modes = modes_of(recordings, struck=wanted is not None) if wanted is not None or model is None else []
    if not _are_linear(modes):
        return *mode_alone(recordings, wanted, model, say), None
    mode = mode_of(modes, wanted)
    others = [other for other in modes if other is not mode]
    say(f"note: of the mode at {mode}, with which are fitted {_listed(others)}")
    return list(recordings), None, mode.frequency


def mode_by_itself(
    recordings: Sequence[Recording], wanted: str | None, say: Callable[[str], None]
) -> tuple[list[Recording], Band | None]:
    """As ``mode_alone``; of a linear rig the other modes are taken off as they are fitted, without a band."""
    modes = modes_of(recordings, struck=True)
    if not _are_linear(modes):
        return mode_alone(recordings, wanted, None, say)
    mode = mode_of(modes, wanted)
    say(f"note: the mode at {mode}; {_listed([other for other in modes if other is not mode])} were taken off")
    return [without_other_modes(recording, mode) for recording in recordings], None


def without_other_modes(recording: Recording, kept: Mode) -> Recording:
    """The recording without what all other modes show in its free pieces.

    Frequencies and damping ratios are those of ``linear_modes``; amplitudes are those of least squares in each piece.
    No band is cut, so that modes may lie as near to each other as they are distinguished.
    """
    motion = find_free_motion(recording)
    modes = [kept, *(mode for mode in linear_modes(recording, struck=True) if mode.frequency != kept.frequency)]
    if len(modes) < 2:
        return recording
    omega = np.array([2 * np.pi * mode.frequency / recording.fs for mode in modes])
    zeta = np.array([mode.damping_ratio or 0.0 for mode in modes])
    columns_of = Modes(omega, zeta, np.zeros((2 * omega.size, 2 * omega.size))).columns
    response = np.array(recording.response, float)
    for decay in motion.decays:
        columns = columns_of(decay.stop - decay.start)
        scale = np.linalg.norm(columns, axis=0)
        weights = np.linalg.lstsq(columns / scale, response[decay.start : decay.stop])[0] / scale
        response[decay.start : decay.stop] -= columns[:, 2:-1] @ weights[2:-1]
    return replace(recording, response=response)


def modes_beside(recordings: Sequence[Recording], known: Sequence[float]) -> list[Mode]:
    """Modes that recordings show beside those of known frequencies, in Hz."""
    return [mode for mode in modes_of(recordings) if not any(mode.is_at(frequency) for frequency in known)]


def _are_linear(modes: Sequence[Mode]) -> bool:
    return len(modes) > 1 and all(mode.damping_ratio is not None for mode in modes)


def in_the_same_band(recordings: Sequence[Recording], band: Band | None) -> list[Recording]:
    """Recordings in a band; as they are without one."""
    return list(recordings) if band is None else [in_band(recording, band) for recording in recordings]


def in_band_of(model: Oscillator, band: Band | None) -> Oscillator:
    """The model with the band that its recordings were looked at in."""
    return replace(model, identified=replace(model.identified, band=band))


def mode_of(modes: Sequence[Mode], wanted: str | None) -> Mode:
    """The strongest mode, or that of a number (in order of frequency, from 1) or of a frequency in Hz.

    Raises BadInput where there is none such.
    """
    if wanted is None:
        return max(modes, key=lambda mode: (mode.strongest, mode.share))
    there = ", ".join(f"{i} at {_hz(mode.frequency)}" for i, mode in enumerate(modes, 1)) or "none"
    text = wanted.strip().lower()
    try:
        value = float(text.removesuffix("hz"))
    except ValueError:
        raise BadInput(
            f"--mode {wanted}: give the number of a mode or its frequency in Hz; there are: {there}"
        ) from None
    if text.isdecimal() and 1 <= value <= len(modes):
        return modes[int(value) - 1]
    near = min(modes, key=lambda mode: abs(mode.frequency - value), default=None)
    if near is None or not near.is_at(value):
        raise BadInput(f"--mode {wanted}: there is no such mode in the recordings; there are: {there}")
    return near


def band_around(mode: Mode, others: Sequence[Mode]) -> Band | None:
    """The band that holds a mode and none of the others; None where it is not flat over all that the mode moves."""
    below = max((o.high for o in others if o.frequency < mode.frequency), default=None)
    above = min((o.low for o in others if o.frequency > mode.frequency), default=None)
    f = mode.frequency
    band = Band(
        f, 0.0 if below is None else f * (below / f) ** _EDGE, None if above is None else f * (above / f) ** _EDGE
    )
    low, high = band.flat
    return band if low < mode.low and mode.high < high else None


def _listed(others: Sequence[Mode]) -> str:
    """The strongest of other modes with their shares."""
    loud = sorted(others, key=lambda mode: -mode.share)[:_LISTED]
    words = ", ".join(map(str, sorted(loud, key=lambda mode: mode.frequency)))
    return words + (f" and {len(others) - _LISTED} more" if len(others) > _LISTED else "")


def _hz(frequency: float) -> str:
    return f"{frequency:.4g} Hz"


def _between(band: Band) -> str:
    if band.high is None:
        return f"above {_hz(band.low)}"
    return f"below {_hz(band.high)}" if band.low == 0.0 else f"between {_hz(band.low)} and {_hz(band.high)}"
