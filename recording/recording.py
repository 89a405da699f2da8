"""One measured record: a response, the force that caused it if it was measured, and how it was sampled."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..errors import BadInput
from ..files.arguments import number_of, text_of
from ..files.computed_once import computed_once
from .channel import Channel
from .missing import Runs, cut_runs
from .plain_numbers import vector_of
from .sensor_range import seen_whole
from .units import parse_unit

QUANTITIES = ("displacement", "velocity", "acceleration")
#: What a base that moves drives, see ``Recording.base``.
WHOLE, PART = "whole", "part"
#: What stands between a base that moves and the mass, where all else stands on the ground.
THROUGH = SPRING, DAMPER = "spring", "damper"
#: How a force may run between its samples: held from one to the next, in straight lines, or as a band-limited signal.
HOLDS = ("zero", "linear", "smooth")


@dataclass(frozen=True, eq=False, repr=False)
class Recording:
    """A uniformly sampled record of a vibrating thing, in SI units.

    `response` and `force` are float64 of shape (n,) and read-only; `force` is None for a free decay. `unit` and
    `force_unit` are SI, or as recorded where no SI factor exists (V, strain). `fs` is in Hz, `start` in s.
    `sha256` is of the file as read; `notes` are the sentences that reading or checking had to say. `free` is set where
    the record is known to be a piece of one free decay, which need not be sought in it again. `hold` is how the force
    runs between its samples, one of HOLDS, None where nobody said. `struck` holds start, stop and whether it was
    clipped of each blow of a hammer where these are known, after a band has drawn them out. `blank` holds start and
    stop of what the response does not show, which was filled from its neighbours and is not fitted; `unknown` those of
    what the force does not tell, behind which the motion begins anew. `differs` holds names of properties and how
    much more of each the thing had while this was recorded than on the mean of all recordings. `force_noise`
    is the standard deviation of noise on a force that no longer shows it, its levels having been averaged or its base's
    motion differentiated; else 0. `base` is not
    empty where the force is minus the acceleration of a moving base and the response relative to it: "whole" where it
    drives one mass, "part" where what is recorded takes part in that by another factor, as a mode of a beam does. It is
    "spring" or "damper" where the base moves one end of such, the response is over the ground, and the force is the
    base's displacement or velocity. `prescribed` is set where the response was imposed and the force is what that took.
    `recorded_unit` and `recorded_force_unit` are those of the file, where these are others, for what a person reads.
    `rig` is the name that a file beside the recording gives the thing, "" for none.
    `channels` are further signals on which the thing may depend (temperature, current), each a number or (n,).

    Raises BadInput when shapes, `fs`, `start`, `quantity` or `hold` do not make a record.
    """

    name: str
    fs: float
    response: np.ndarray
    force: np.ndarray | None = None
    quantity: str = "displacement"
    unit: str = "m"
    force_unit: str = "N"
    start: float = 0.0
    sha256: str | None = None
    notes: tuple[str, ...] = ()
    free: bool = False
    hold: str | None = None
    struck: tuple[tuple[int, int, bool], ...] = ()
    blank: Runs = ()
    unknown: Runs = ()
    differs: tuple[tuple[str, float], ...] = ()
    force_noise: float = 0.0
    base: str = ""
    prescribed: bool = False
    channels: tuple[Channel, ...] = ()
    recorded_unit: str = ""
    recorded_force_unit: str = ""
    rig: str = ""

    def __post_init__(self) -> None:
        text_of(self.name, "the name of a recording")
        for field, what in (("fs", "the sampling rate"), ("start", "the first time stamp")):
            object.__setattr__(self, field, number_of(getattr(self, field), f"{self.name}: {what}, {field},"))
        for field in ("quantity", "unit", "force_unit"):
            text_of(getattr(self, field), f"{self.name}: {field}")
        if self.hold is not None:
            text_of(self.hold, f"{self.name}: hold")
        if not (math.isfinite(self.fs) and self.fs > 0):
            raise BadInput(f"{self.name}: the sampling rate is {self.fs} Hz; it must be a positive number")
        if not math.isfinite(self.start):
            raise BadInput(f"{self.name}: the first time stamp is {self.start} s; it must be a number")
        if self.quantity not in QUANTITIES:
            raise BadInput(f"{self.name}: quantity '{self.quantity}' is not known; use one of {', '.join(QUANTITIES)}")
        if self.hold is not None and self.hold not in HOLDS:
            raise BadInput(f"{self.name}: hold '{self.hold}' is not known; use one of {', '.join(HOLDS)}")
        response = _frozen(self.response, f"{self.name}: the response")
        if len(response) < 2:
            raise BadInput(f"{self.name}: the response has {len(response)} samples; a record needs at least 2")
        object.__setattr__(self, "response", response)
        if self.force is not None:
            force = _frozen(self.force, f"{self.name}: the force")
            if len(force) != len(response):
                raise BadInput(
                    f"{self.name}: the force has {len(force)} samples and the response {len(response)}; "
                    "both must cover the same samples"
                )
            object.__setattr__(self, "force", force)
        for channel in self.channels:
            if channel.over(len(response)).shape != response.shape:
                raise BadInput(
                    f"{self.name}: the channel {channel.name} has {len(channel.over(1))} samples and the response "
                    f"{len(response)}; both must cover the same samples"
                )
        object.__setattr__(self, "notes", tuple(self.notes))

    def __repr__(self) -> str:
        force = "no force" if self.force is None else f"force in {self.force_unit}"
        return (
            f"<Recording {self.name!r}: {self.quantity} in {self.unit}, {self.n} samples at {self.fs:.6g} Hz, {force}>"
        )

    def plot(self) -> Any:
        """Response and force over time; a matplotlib Figure."""
        from .picture import Track, plotted

        shown = [Track(self.quantity.capitalize(), self.response, self.unit, self.blank, "not shown")]
        if self.force is not None:
            what = "Base's motion" if self.base else "Force"
            shown.append(Track(what, self.force, self.force_unit, self.unknown, "not known"))
        return plotted(self.name, self.time, shown)

    @property
    def n(self) -> int:
        """Number of samples."""
        return len(self.response)

    @property
    def rides(self) -> bool:
        """Whether the rig stands on a base that moves, and its response is relative to that."""
        return self.base in (WHOLE, PART)

    @property
    def dt(self) -> float:
        """Sampling interval in s."""
        return 1.0 / self.fs

    @property
    def time(self) -> np.ndarray:
        """Time stamps (n,) in s, the first one at `start`."""
        return self.start + np.arange(self.n) / self.fs

    @property
    def duration(self) -> float:
        """Length in s: n samples last n intervals."""
        return self.n / self.fs

    @computed_once
    def known(self) -> dict[str, tuple[Any, frozenset[str]]]:
        """What was measured of it, by name, and the fields that it rests on: see ``fact``."""
        return {}

    def slice(self, i: int | None, j: int | None) -> Recording:
        """Return the samples i to j as Python slices them; raises BadInput when fewer than 2 remain."""
        first, last, _ = slice(i, j).indices(self.n)
        force = None if self.force is None else self.force[first:last]
        struck = tuple(
            (max(a - first, 0), min(b, last) - first, c) for a, b, c in self.struck if b > first and a < last
        )
        start = self.start + first / self.fs
        left = {name: cut_runs(getattr(self, name), first, last) for name in ("blank", "unknown")}
        channels = tuple(channel.slice(first, last) for channel in self.channels)
        cut = {"response": self.response[first:last], "force": force, "channels": channels}
        return replace(self, **cut, start=start, struck=struck, **left)

    def to_sep5(self) -> list[dict[str, Any]]:
        """Return the response, then the force if any, as SEP 5 time-series dictionaries (sdypy)."""
        common = {"fs": self.fs, "time": self.time}
        series = [
            {**common, "data": self.response, "name": self.name, "quantity": self.quantity, "unit_str": self.unit}
        ]
        if self.force is not None:
            force = {"data": self.force, "name": f"{self.name}:force", "quantity": "force", "unit_str": self.force_unit}
            series.append({**common, **force})
        return series


def from_sep5(response: Mapping[str, Any], force: Mapping[str, Any] | None = None) -> Recording:
    """Make a Recording of one or two SEP 5 dictionaries: `data`, `fs` or `time`, and if given `name`, `unit_str`.

    Values are converted to SI. Raises BadInput for a missing key, an unknown unit or an uneven `time`.
    """
    # sampling.py imports nothing of recording.py; it is imported here to keep the class free of file reading
    from .sampling import uniform_sampling

    name = str(response.get("name", "recording"))
    if "data" not in response:
        raise BadInput(f"{name}: the SEP 5 dictionary has no 'data'")
    columns = [vector_of(series["data"], f"{name}: 'data'") for series in (response, force) if series is not None]
    if any(column.shape != columns[0].shape or column.ndim != 1 for column in columns):
        raise BadInput(f"{name}: the SEP 5 'data' of response and force must be vectors of the same length")
    time, fs = response.get("time"), response.get("fs")
    stamps = None if time is None else vector_of(time, f"{name}: 'time'")
    rate = None if fs is None else float(vector_of([fs], f"{name}: 'fs'")[0])
    sampling = uniform_sampling(name, stamps, rate, np.column_stack(columns))
    whole = seen_whole(name, sampling.columns, sampling.fs)
    unit = parse_unit(str(response.get("unit_str", "m")), where=name)
    force_unit = parse_unit(str(force.get("unit_str", "N")) if force else "N", where=name)
    for which, measured, allowed in (("response", unit, (*QUANTITIES, "any")), ("force", force_unit, ("force", "any"))):
        if measured.quantity not in allowed:
            raise BadInput(f"{name}: the {which} has the unit '{measured.text}', which measures {measured.quantity}")
    quantity = str(response.get("quantity", "")).lower()
    if quantity not in QUANTITIES:
        quantity = unit.quantity if unit.quantity in QUANTITIES else "displacement"
    return Recording(
        name=name,
        fs=sampling.fs,
        response=whole.columns[:, 0] * unit.factor,
        force=None if force is None else whole.columns[:, 1] * force_unit.factor,
        quantity=quantity,
        unit=unit.si,
        force_unit=force_unit.si,
        recorded_unit=unit.text,
        recorded_force_unit=force_unit.text,
        start=sampling.start,
        notes=(*sampling.notes, *whole.notes),
        blank=whole.blank,
        unknown=whole.unknown,
    )


def _frozen(values: np.ndarray, what: str) -> np.ndarray:
    copy = vector_of(values, what)
    if np.ma.is_masked(values):
        raise BadInput(f"{what} has masked samples, which are missing; hand it over as an array by name to bridge them")
    if copy.ndim != 1:
        raise BadInput(f"{what} has shape {copy.shape}; it must be one column of samples")
    copy.setflags(write=False)
    return copy
