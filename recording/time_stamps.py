"""The unit of time stamps where a file does not say it: seconds, ticks since 1970, or the numbers of the samples."""

from __future__ import annotations

import numpy as np

from ..errors import BadInput

#: Seconds of the years 2001 to 2096 since 1970: ticks of which fraction of a second fall there says what they are.
EARLIEST, LATEST = 1e9, 4e9
_TICKS = {"milliseconds": 1e-3, "microseconds": 1e-6, "nanoseconds": 1e-9}
#: Days of the years 2000 to 2100 as spreadsheets count them, from the end of 1899, where one stamp follows another
#: within a tenth of a second: taken for seconds the same are a rate above a megahertz.
_DAYS, _DAY, _CLOSE = (36526, 73051), 86400.0, 1e-6
#: No recorder that dates its samples in seconds is of a later year: ticks are taken for seconds there.
_NO_SECONDS = 1e11


def in_seconds(
    where: str, label: str, stamps: np.ndarray, *, stated: bool, fs: float | None
) -> tuple[np.ndarray | None, tuple[str, ...]]:
    """Time stamps, (n,), in seconds, and what was noticed; None in their place where they only count the samples.

    Args:
        where: name of the file.
        label: the column's.
        stamps: as the file has them, in seconds where it says their unit.
        stated: whether it does.
        fs: sampling rate that the user gave, Hz.

    Raises:
        BadInput: where they cannot be seconds, or it cannot be known.
    """
    if stamps.size < 2 or not np.all(np.isfinite(stamps)):
        return stamps, ()  # which is said elsewhere
    first = float(stamps[0])
    if _DAYS[0] <= first <= _DAYS[1] and 0 < np.median(np.diff(stamps)) <= _CLOSE:
        return (stamps - stamps[0]) * _DAY, (
            f"{where}: the time column {label} holds days as spreadsheets count them; counted from the first sample",
        )
    if stated:
        if abs(first) > _NO_SECONDS:
            raise BadInput(
                f"{where}: the time column {label} begins at {first:.6g} s, thousands of years from now; check the unit"
            )
        return stamps, ()
    for name, tick in _TICKS.items():
        if EARLIEST <= first * tick <= LATEST:
            return (stamps - stamps[0]) * tick, (
                f"{where}: the time column {label} holds {name} since 1970; counted from the first sample",
            )
    if abs(first) > _NO_SECONDS:
        raise BadInput(
            f"{where}: the time column {label} begins at {first:.6g}, which is no time in seconds; write its unit into "
            "its name (time_ms), or leave it out with --time none and give --fs"
        )
    steps = np.diff(stamps)
    usual = float(np.median(steps))
    if np.all(stamps == np.round(stamps)) and usual >= 1:
        if np.all(steps == 1) and fs is not None and abs(fs - 1.0) > 1e-3:
            return None, (f"{where}: the time column {label} counts the samples; their time is that of --fs",)
        raise BadInput(
            f"{where}: the time column {label} holds the whole numbers {first:.12g}, {stamps[1]:.12g}, ... without a "
            f"unit; say it: --calibration time='1 ms' if {1e3 / usual:.4g} samples came in a second, time='1 us' if "
            f"{1e6 / usual:.4g}, time='1 s' if {1 / usual:.4g}; or give the sampling rate with --fs and --time none "
            "where it counts the samples"
        )
    return stamps, ()
