"""The options that commands share: how a recording is read, which laws there are, which parameters keep a value."""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import BadInput

if TYPE_CHECKING:
    from ..model.fit_state import MostLeft

FILE = click.Path(path_type=Path)


class Above(click.FloatRange):
    """A number above zero, which nan is not, up to the largest."""

    def __init__(self, most: float | None = None) -> None:
        super().__init__(min=0, min_open=True, max=most)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """See ``click.FloatRange``."""
        number = super().convert(value, param, ctx)
        if math.isnan(number):
            self.fail(f"{value} is not in the range {self._describe_range()}.", param, ctx)
        return number


_RECORDING_OPTIONS: tuple[Callable[..., Any], ...] = (
    click.option("--time", metavar="COLUMN", help="Column of the time, by name, pattern ('*clock*') or number."),
    click.option("--force", metavar="COLUMN", help="Column of the force; none: leave it out."),
    click.option(
        "--base", metavar="COLUMN", help="Column of the motion of the base, where that drives the rig; or none."
    ),
    click.option(
        "--relative/--absolute",
        default=None,
        help="Whether the response is relative to the base. Default: by the signals.",
    ),
    click.option(
        "--through",
        type=click.Choice(["spring", "damper"]),
        help="What the base moves one end of, where all else stands between the thing and the ground.",
    ),
    click.option(
        "--prescribed",
        metavar="COLUMN",
        help="Column of a motion that was imposed, as in a test machine: the force law itself is then identified.",
    ),
    click.option(
        "--channel",
        "channels",
        metavar="NAME[=VALUE]",
        multiple=True,
        callback=lambda _context, _option, texts: channels_stated(texts),
        help="What the rig may depend on: a column (temperature_degC), a number of all recordings (current=0.5A), of "
        "each in their order (current=0A,0.5A) or by file (current=slow.csv:0A); several times.",
    ),
    click.option(
        "--response",
        metavar="COLUMN",
        multiple=True,
        help="Column of the response, by name, pattern or number; several times for several sensors.",
    ),
    click.option(
        "--quantity",
        type=click.Choice(["displacement", "velocity", "acceleration"]),
        help="What the response column measures, where its unit does not say.",
    ),
    click.option("--unit", metavar="UNIT", help="Unit of the response, for example mm."),
    click.option("--force-unit", metavar="UNIT", help="Unit of the force, for example kN."),
    click.option(
        "--calibration",
        metavar="COLUMN=FACTOR",
        multiple=True,
        callback=lambda _context, _option, texts: calibrations(texts),
        help="What the numbers of a column stand for, such as force='22.4 N/V', '*acc*=10.2 mV/g' or time='1 ms': "
        "force, response, time, or a column by name or pattern; several times.",
    ),
    click.option("--fs", type=float, metavar="HZ", help="Sampling frequency, where no column holds the time."),
    click.option("--part", metavar="FROM:TO", help="Seconds of each recording to use, from its first sample."),
    click.option(
        "--amplitude",
        metavar="[FROM..]TO",
        help="Amplitudes of the motion to use, such as 5mm (up to that), 1mm..5mm or 1mm.. (from that on).",
    ),
    click.option(
        "--max-size",
        type=Above(1e6),
        default=500.0,
        show_default=True,
        metavar="MB",
        help="Largest recording that is read, unpacked.",
    ),
    click.option(
        "--hold",
        type=click.Choice(["zero", "linear", "smooth"]),
        help="How the force runs between samples: held from one to the next (as behind a converter), in straight "
        "lines, or smooth. Default: the model's; for a new one, what the recordings show.",
    ),
)


def with_recordings(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options that say how a recording is to be read."""
    return functools.reduce(lambda wrapped, option: option(wrapped), reversed(_RECORDING_OPTIONS), command)


def with_time_limit(command: Callable[..., Any]) -> Callable[..., Any]:
    """The option that says how long an FMU may take."""
    return click.option(
        "--time-limit",
        type=Above(1e6),
        default=30.0,
        show_default=True,
        metavar="S",
        help="Longest time without a step that the FMU finished.",
    )(command)


def with_figures(command: Callable[..., Any]) -> Callable[..., Any]:
    """The option that draws the pictures of a page as files."""
    return click.option(
        "--figures",
        metavar="pdf|png|svg",
        callback=lambda _context, _option, text: _kinds(text),
        help="Draw each picture of the page as a file too, into a folder of figures; several kinds: pdf,svg.",
    )(command)


def _kinds(text: str | None) -> tuple[str, ...]:
    from ..errors import BadInput
    from ..face.figures import kinds_of

    try:
        return kinds_of(text) if text is not None else ()
    except BadInput as problem:
        raise click.BadParameter(str(problem)) from None


def with_mode(command: Callable[..., Any]) -> Callable[..., Any]:
    """The option that says which of several modes is meant."""
    return click.option(
        "--mode",
        metavar="N|HZ",
        help="Which of several modes, by its number in order of frequency or by its frequency in Hz; a zero-phase band "
        "isolates it. Default: the model's band; for a new one the strongest, where others would be in its way.",
    )(command)


def _load_laws(context: click.Context, parameter: click.Parameter, files: tuple[Path, ...]) -> None:
    from ..model.user_laws import load_law_file

    for file in files:
        load_law_file(file)


def law_names(context: click.Context, parameter: click.Parameter, begun: str) -> list[str]:
    """The laws of the library, and of installed packages, whose names begin so: for the completion of a shell."""
    from ..model.library import KNOWN, take_installed_laws

    take_installed_laws()
    return [name for name in KNOWN if name.startswith(begun)]


#: A number with a unit behind it, which is looked at where the recordings' units are known.
_WITH_UNIT = re.compile(r"\s*[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?\s*(?:[A-Za-zµμ°]|1/).*")


def fixed_values(context: click.Context, parameter: click.Parameter, values: tuple[str, ...]) -> dict[str, float | str]:
    """``NAME=VALUE`` as a dictionary: a number, or a text that begins with one and goes on with a unit."""
    fixed: dict[str, float | str] = {}
    given: set[str] = set()
    for text in values:
        name, sign, number = text.partition("=")
        try:
            fixed[name.strip()] = float(number)
        except ValueError:
            if _WITH_UNIT.fullmatch(number):
                fixed[name.strip()] = number.strip()
            else:
                sign = ""
        if not sign or not name.strip():
            raise click.BadParameter(f"'{text[:80]}' is not NAME=VALUE with a number, such as viscous=0.5")
        if name.strip() in given:
            raise click.BadParameter(f"'{name.strip()[:80]}' is fixed twice; give it one value")
        given.add(name.strip())
    return fixed


def added_to_files(context: click.Context, parameter: click.Parameter, values: tuple[str, ...]) -> dict[str, str]:
    """``FILE=0.5kg`` as a dictionary of texts."""
    added: dict[str, str] = {}
    for text in values:
        file, sign, size = text.rpartition("=")
        if not sign or not file.strip() or not _WITH_UNIT.fullmatch(size):
            raise click.BadParameter(f"'{text[:80]}' is not FILE=SIZE with a unit, such as loaded.csv=0.5kg")
        if file.strip() in added:
            raise click.BadParameter(f"what was added to '{file.strip()[:80]}' is given twice; give its sum")
        added[file.strip()] = size.strip()
    return added


def most_left(context: click.Context, parameter: click.Parameter, text: str | None) -> MostLeft | None:
    """``5%`` of the motion or ``3x`` the noise as the most that a model may leave."""
    from ..errors import BadInput
    from ..model.fit_state import parse_most_left

    try:
        return None if text is None else parse_most_left(text)
    except BadInput as problem:
        raise click.BadParameter(str(problem)) from None


def channels_stated(texts: tuple[str, ...]) -> tuple[Any, ...] | None:
    """``NAME=VALUE`` or a column, understood as far as no recording is needed for it; None for none."""
    from ..recording.channel import stated_channels

    return stated_channels(texts) if texts else None


def calibrations(texts: tuple[str, ...]) -> dict[str, str]:
    """``COLUMN=FACTOR`` as a dictionary of texts, which are understood beside the column they are for."""
    from ..recording.calibration import parse_calibration

    made = {}
    for text in texts:
        name, sign, factor = text.partition("=")
        if not sign or not name.strip():
            raise click.BadParameter(f"'{text}' is not COLUMN=FACTOR, such as force='22.4 N/V'")
        parse_calibration(factor, f"--calibration {name.strip()}")
        made[name.strip()] = factor.strip()
    return made


def with_known_values(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options that give parameters that are known and not to be found."""
    fix = click.option(
        "--fix",
        metavar="NAME=VALUE",
        multiple=True,
        callback=fixed_values,
        help="Parameter that keeps a value, in SI or with a unit (friction=0.15N); several times.",
    )
    mass = click.option(
        "--mass",
        metavar="KG",
        callback=lambda _context, _option, value: None if value is None else _in_kg(value),
        help="Moving mass, in kg or such as 270g, where only decays were recorded or it is known.",
    )
    return fix(mass(command))


def _in_kg(given: str) -> float:
    from ..model.quantity import in_unit

    with suppress(ValueError):
        return float(given)  # inf and nan too, which are refused as a parameter's values are
    try:
        return in_unit(given, "kg", "the mass")
    except BadInput as problem:
        raise click.BadParameter(str(problem)) from None


def with_laws(command: Callable[..., Any]) -> Callable[..., Any]:
    """The option that adds laws to the library before the command reads a model."""
    return click.option(
        "--law",
        metavar="FILE.py",
        type=FILE,
        multiple=True,
        expose_value=False,
        is_eager=True,
        callback=_load_laws,
        help="Python file with laws of your own; it is run. May be given several times.",
    )(command)
