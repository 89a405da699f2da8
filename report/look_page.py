"""A recording to look at with a mouse: pieces taken and left with their reasons, a part and a mode to be chosen."""

from __future__ import annotations

import math
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..export.render import plain_text
from ..identify.motion.mode import Mode
from ..model.display import full_stop, number, scale_of
from .blocks import Block, Chosen, Figure, Items, Page, Section, Table, Text
from .chart import Chart
from .residual import spectral_density
from .style import FREE, MODEL
from .time_history import SHADES, TAKEN, Left, Taken, recording_figure
from .used import joined

if TYPE_CHECKING:
    from ..recording.recording import Recording

#: What each kind of motion is, and what a fit makes of it.
KINDS = {
    "decay": "a decay: the rig is let go, and swings until it rests; no force drives it",
    "bursts": "bursts: a force drives it and is silent in between, where the rig swings free",
    "struck": "blows of a hammer, with what rings after each",
    "sine": "a sine: a force of one frequency drives it throughout",
    "sweep": "a sweep: a force whose frequency moves drives it throughout",
    "broadband": "random or many-tone motion: a force of many frequencies drives it throughout",
    "prescribed": "a motion that was imposed, as in a test machine: what is identified is the force law by itself",
}
#: Rows of the table of pieces.
_ROWS = 60
#: Letters of a value that stands in what is to be pasted; longer ones are left to the reader.
_LONGEST = 120


@dataclass(frozen=True)
class Shown:
    """One recording to show.

    Attributes:
        file: how it is named where it is read again; None for what has no name.
        record: its name on the page.
        facts: what ``dashpot look --json`` says of it.
        recording: None where it was refused.
        part: seconds that were read of it; None for all.
        how: the other options that it was read with, by the names of ``dashpot.recording.Reading``.
    """

    file: str | None
    record: str
    facts: Mapping[str, Any]
    recording: Recording | None
    part: tuple[float, float] | None = None
    how: Mapping[str, Any] = field(default_factory=dict)

    @property
    def begins(self) -> float:
        """When what was read begins, s from the first sample of the file: what a part counts from."""
        return max(self.part[0], 0.0) if self.part else 0.0


def look_page(shown: Sequence[Shown], *, python: bool = False) -> Page:
    """The page of recordings: the first is unfolded, the others below it.

    Args:
        shown: what was read, and what was refused.
        python: whether what is chosen is written for a call of Python, not for a command.
    """
    lead: list[Block] = []
    sections: list[Section] = []
    for i, one in enumerate(shown, 1):
        blocks = _refused(one) if one.recording is None else _blocks(one, one.recording, str(i), python)
        if len(shown) == 1:
            lead = blocks
            continue
        sections.append(Section(plain_text(one.record), tuple(blocks), folded=i > 1 and one.recording is not None))
    names = list(dict.fromkeys(one.record for one in shown))
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    footer = "Nothing was fitted."
    return Page(f"Look at {names[0] if names else 'nothing'}{more}", sections, lead=lead, footer=footer, numbered=False)


def _chosen(one: Shown, at: str, modes: str, *, element: bool, python: bool) -> Chosen:
    """What is chosen, as the options of a command or the arguments of a call."""
    begin, end = one.part or (0.0, math.inf)
    whole = "" if one.part is None else f"{begin:g}:{'' if math.isinf(end) else f'{end:g}'}"
    how = {"modes": modes, "whole": whole}
    if python:
        texts = {name: "..." if name == "channels" else repr(value) for name, value in one.how.items()}
        ways = "".join(f", {name}={text if len(text) <= _LONGEST else '...'}" for name, text in texts.items())
        call = f"dashpot.identify{'_element' if element else ''}({repr(one.file) if one.file else '...'}{ways}{{}})"
        return Chosen(*_keys(at), 'part="{}"', 'mode="{}"', call, join=",", **how)
    ways = "".join(f" {way}" for name, value in one.how.items() for way in _typed(name, value))
    command = f"dashpot identify {shlex.quote(one.file or 'REC')}{ways}{{}} -o rig.yaml --report rig.html"
    return Chosen(*_keys(at), "--part {}", "--mode {}", command, **how)


def _typed(name: str, value: Any) -> list[str]:
    """A way to read as it is typed; of channels that there are some."""
    option = f"--{name.replace('_', '-')}"
    if name == "channels":
        return ["--channel ..."]
    if isinstance(value, bool):
        return [option if value else "--absolute"]
    values = [f"{key}={of}" for key, of in value.items()] if isinstance(value, Mapping) else [str(value)]
    return [f"{option} {shlex.quote(one)}" for one in values]


def _keys(at: str) -> tuple[str, str]:
    return f"recording-{at}", f"spectrum-{at}"


def _refused(one: Shown) -> list[Block]:
    return [Text(full_stop(line), "bad", "✕ Refused.") for line in str(one.facts["refused"]).split("\n")]


def _blocks(one: Shown, recording: Recording, at: str, python: bool) -> list[Block]:
    facts = one.facts
    time, spectrum = _keys(at)
    modes = facts["modes"]
    imposed = bool(recording.prescribed)
    charts = [Figure(time_chart(recording, facts, time, one.begins), _caption(facts))]
    above = spectrum_chart(recording, modes, spectrum)
    hint = "" if imposed else _modes_hint(modes)
    blocks: list[Block] = [Text(full_stop(KINDS[kind_shown(facts)]), "note", "Taken for"), *charts]
    blocks.append(_chosen(one, at, hint, element=imposed, python=python))
    if above is not None:
        caption = "Spectrum of the motion that was imposed." if imposed else _spectrum_caption(modes)
        blocks.append(Figure(above, caption))
    blocks.append(_facts_table(facts, recording))
    blocks += [] if imposed else [_pieces_table(facts, one.begins)]
    if facts["notes"]:
        blocks.append(Items(tuple(full_stop(note) for note in facts["notes"])))
    return blocks


def kind_shown(facts: Mapping[str, Any]) -> str:
    """The kind of motion a recording is taken for, a key of ``KINDS``: a hammer's blows have one of their own."""
    struck = any(piece["kind"] == "struck" for piece in facts["pieces"])
    return "struck" if struck else str(facts["motion"])


def time_chart(recording: Recording, facts: Mapping[str, Any], key: str, begins: float = 0.0) -> Chart:
    """Force and response over the time from the first sample, pieces shaded by what becomes of them, with cursors.

    The first sample that was read is ``begins`` s behind that of the file.
    """
    taken, left = pieces(facts)
    chart = recording_figure(recording, taken, key, left, begins)
    for panel in chart.panels:
        panel.x.set(label="Time from the first sample [s]", low=begins, high=begins + recording.duration)
    return replace(chart, cursors=True)


def pieces(facts: Mapping[str, Any]) -> tuple[list[Taken], list[Left]]:
    """What a fit takes and leaves, each in order; pieces of a kind that follow one another are one."""

    def samples(piece: Mapping[str, Any]) -> tuple[int, int]:
        return round(piece["start"] * facts["fs"]), round(piece["stop"] * facts["fs"])

    taken = joined([(piece["kind"], *samples(piece)) for piece in facts["pieces"]])
    return taken, [(*samples(piece), piece["why"]) for piece in facts["left"]]


def spectrum_chart(recording: Recording, modes: Sequence[Mapping[str, float]], key: str) -> Chart | None:
    """Amplitude density of the response over the frequency, each mode a rule to be chosen; None of no motion."""
    from ..errors import BadInput
    from ..identify.signals.hilbert import dominant_frequency

    response = np.asarray(recording.response, float)
    try:
        # of a rig that is held and released the strongest line is that of the releases; its speed shows what rings
        alone = [] if modes else [dominant_frequency(signal, recording.fs) for signal in (response, np.diff(response))]
    except BadInput:
        return None
    lines = alone or [mode["frequency_hz"] for mode in modes]
    natural, highest = min(lines), max(lines)
    f, density = spectral_density(response - np.mean(response), recording.fs, natural, highest)
    if not np.any(density > 0):
        return None
    scale = scale_of(recording.unit, density)
    chart = Chart(key, f"{plain_text(recording.name)}: spectral density of the response")
    (panel,) = chart.row(1, height=240)
    panel.line(f, np.where(density > 0, density * scale.factor, np.nan), FREE, width=1.1)
    for i, mode in enumerate(modes, 1):
        choice = f"{mode['frequency_hz']:.4g}Hz"  # with its unit, for a number alone may be that of a mode
        said = f"Mode {i}: {Mode.of_json(mode)}"
        panel.rule(mode["frequency_hz"], MODEL, upright=True, width=1.0, choice=choice, said=said)
    panel.x.set(label="Frequency [Hz]", tight=True)
    panel.y.set(label=f"Spectral density [{scale.unit}/√Hz]", log=True)
    return chart


def _caption(facts: Mapping[str, Any]) -> str:
    kinds = [kind for kind in SHADES if any(piece["kind"] == kind for piece in facts["pieces"])]
    shaded = [f"{SHADES[kind][0]} what is {kind}" for kind in kinds] + (["grey what is left"] if facts["left"] else [])
    said = f"Shaded: what a fit takes and leaves, {', '.join(shaded)}. " if shaded else ""
    return f"{said}The two cursors choose a part: drag them, or move them with the arrow keys."


def _spectrum_caption(modes: Sequence[Mapping[str, float]]) -> str:
    if not modes:
        return "Spectrum of the response. It shows no modes of free motion that could be told apart."
    return "Spectrum of the response; the numbers mark the modes that its free motion shows. Click on one to choose it."


def _modes_hint(modes: Sequence[Mapping[str, float]]) -> str:
    if not modes:
        return ""
    if len(modes) == 1:
        return "One mode was found, which needs no option."
    return f"{len(modes)} modes: click on one in the spectrum; without the option the strongest is taken."


def _facts_table(facts: Mapping[str, Any], recording: Recording) -> Table:
    columns = ", ".join(f"{role} = {name}" for role, name in facts["columns"].items() if name is not None)
    rows = [
        ("read as", f"{columns}; {facts['quantity']}" if columns else str(facts["quantity"])),
        ("sampling", f"{facts['fs']:.6g} Hz, {facts['samples']} samples, {facts['duration']:.6g} s"),
    ]
    for signal in facts["signals"]:
        rows.append((signal["role"], signal["range"].replace("-", "−")))
    if recording.start:
        rows.append(("time stamps", f"from {number(recording.start, 6)} s on; a part counts from the first sample"))
    return Table(("", "What is read"), tuple(rows))


def _pieces_table(facts: Mapping[str, Any], begins: float) -> Block:
    taken, left = pieces(facts)
    both = [(start, stop, kind, TAKEN[kind]) for kind, start, stop in taken]
    both += [(start, stop, "left", why) for start, stop, why in left]
    if not taken:
        return Text("A fit would take nothing of it: nothing in it moves beyond its noise.", "warn", "▲ Nothing.")
    rows = []
    for start, stop, kind, why in sorted(both)[:_ROWS]:
        first, last = (number(begins + i / facts["fs"], 4) for i in (start, stop))
        rows.append((f"{first} to {last} s", kind, why))
    more = f"And {len(both) - _ROWS} more." if len(both) > _ROWS else ""
    return Table(("From the first sample", "Piece", "Why"), tuple(rows), caption=more, cards=True)
