"""The form of a ``dashpot.yaml``: its keys, what each may hold, and the options that it stands for."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from ..errors import BadInput
from ..files.yaml_loader import Document, read_yaml, shown, suggestion
from .by_amplitude import amplitudes_of
from .calibration import parse_calibration
from .channel import stated_channels
from .frequency import frequency_of
from .part import parse_part
from .recording import HOLDS, QUANTITIES, THROUGH
from .units import parse_unit

NAME, FORMAT = "dashpot.yaml", "dashpot-data/1"
_EXAMPLE = "columns: {response: laser}"
_COLUMNS = ("time", "force", "response", "base", "prescribed")
#: The option that states the unit of a column; of the time it is a calibration.
_UNITS = {"response": "unit", "prescribed": "unit", "force": "force_unit", "base": "force_unit"}
_WORDS = {"quantity": QUANTITIES, "hold": HOLDS, "through": THROUGH}
#: What may stand at the top and under `files`, and at the top alone.
_SETTINGS = ("columns", "units", "calibration", "part", "amplitude", "fs", *_WORDS, "relative", "channels")
_TOP = ("format", "name", *_SETTINGS, "parts", "files")

Place = tuple[str | int, ...]


def checked(text: str, where: str) -> dict[str, Any]:
    """The settings of a file, each of its type.

    Args:
        text: of the file.
        where: its path, for messages.

    Raises:
        BadInput: with every problem, ``file: line N: $.path: what is wrong and what to do``.
    """
    document = read_yaml(text, where)
    form = document.data
    if not isinstance(form, dict) or form.get("format") != FORMAT:
        stated = isinstance(form, dict) and "format" in form
        said = f"says format {shown(form['format'])}" if stated else "has no format"
        raise BadInput(
            f"{where}: {said}; a file of that name says how the recordings beside it are read, and begins with "
            f"'format: {FORMAT}': write that, or name it otherwise"
        )
    _closed(document, form, (), _TOP)
    if "name" in form and not (isinstance(form["name"], str) and form["name"].strip() and form["name"].isprintable()):
        document.report(("name",), f"must be the name of the rig, not {shown(form['name'])}; put it in quotes")
    _settings(document, form, ())
    for pattern, part in _mapping(document, form, ("parts",), "{decay.csv: '2:30'}"):
        _sound(document, ("parts", pattern), part, lambda value: parse_part(_is_text(value)))
    for pattern, more in _mapping(document, form, ("files",), f"{{'old*.csv': {{{_EXAMPLE}}}}}"):
        if not isinstance(more, dict):
            document.report(("files", pattern), f"must be a mapping, not {shown(more)}; write {{{_EXAMPLE}}}")
            continue
        _closed(document, more, ("files", pattern), _SETTINGS)
        _settings(document, more, ("files", pattern))
    if document.problems:
        raise document.error()
    return form


def options_of(settings: Mapping[str, Any]) -> dict[str, Any]:
    """What settings that were checked say, as options by their names."""
    units = settings.get("units", {})
    made: dict[str, Any] = dict(settings.get("columns", {}))
    made |= {_UNITS[column]: unit for column, unit in units.items() if column in _UNITS}
    calibration = {key: str(value) for key, value in settings.get("calibration", {}).items()}
    calibration |= {"time": f"1 {units['time']}"} if "time" in units else {}
    made |= {"calibration": calibration} if calibration else {}
    rest = ("part", "amplitude", "fs", *_WORDS, "relative", "channels")
    return made | {key: settings[key] for key in rest if key in settings}


def _settings(document: Document, settings: Mapping[str, Any], at: Place) -> None:
    """Report what is wrong with the settings of a mapping, that of all files or of some."""
    for column, given in _mapping(document, settings, (*at, "columns"), "{force: '*shaker*', response: 3}", _COLUMNS):
        if not isinstance(given, str | int) or isinstance(given, bool) or given == "":
            text = f"must be a column's name, pattern or number from 1, not {shown(given)}"
            document.report((*at, "columns", column), text)
    for column, unit in _mapping(document, settings, (*at, "units"), "{response: mm}", ("time", *_UNITS)):
        _sound(document, (*at, "units", column), unit, lambda value: parse_unit(_is_text(value), ""))
    for column, factor in _mapping(document, settings, (*at, "calibration"), "{force: 22.4 N/V}"):
        _sound(document, (*at, "calibration", column), factor, lambda value: parse_calibration(_is_factor(value), ""))
    for name, channel in _mapping(document, settings, (*at, "channels"), "{current: 0.5 A, oil: T2}"):
        _sound(document, (*at, "channels", name), {name: channel}, _channel)
    for key, check in _CHECKS.items():
        if key in settings:
            _sound(document, (*at, key), settings[key], check)
    for key, words in _WORDS.items():
        if key in settings and settings[key] not in words:
            document.report((*at, key), f"must be {' or '.join(words)}, not {shown(settings[key])}")
    if "relative" in settings and not isinstance(settings["relative"], bool):
        document.report((*at, "relative"), f"must be true or false, not {shown(settings['relative'])}")


def _is_text(value: Any) -> str:
    if not isinstance(value, str) or not value.strip():
        raise BadInput(f"must be text, not {shown(value)}; put it in quotes")
    return value


def _is_factor(value: Any) -> str:
    return str(value) if isinstance(value, int | float) and not isinstance(value, bool) else _is_text(value)


def _channel(stated: Mapping[str, Any]) -> None:
    for value in stated.values():
        if isinstance(value, list | dict | bool) or value is None:
            raise BadInput(f"must be a number with its unit or a column, not {shown(value)}; say others under files")
    stated_channels(stated)


def _positive(value: Any) -> None:
    if isinstance(value, bool) or not frequency_of(value) > 0:
        raise BadInput(f"must be a frequency such as 1000 or 1 kHz, not {shown(value)}")


_CHECKS: dict[str, Callable[[Any], Any]] = {
    "part": lambda value: parse_part(_is_text(value)),
    "amplitude": lambda value: amplitudes_of(_is_text(value)),
    "fs": _positive,
}


def _sound(document: Document, at: Place, value: Any, check: Callable[[Any], Any]) -> None:
    """Report what a check raises of a value."""
    try:
        check(value)
    except BadInput as problem:
        document.report(at, str(problem).partition("\n")[0].removeprefix(": "))


def _mapping(
    document: Document, settings: Mapping[str, Any], at: Place, example: str, keys: Iterable[str] = ()
) -> list[tuple[str, Any]]:
    """The entries of a mapping that may be there; what is no mapping, or no key of it, is reported and left out."""
    given = settings.get(str(at[-1]), {})
    if not isinstance(given, dict):
        document.report(at, f"must be a mapping, not {shown(given)}; write {example}")
        return []
    _closed(document, given, at, list(keys) or given)
    return [(key, value) for key, value in given.items() if not keys or key in keys]


def _closed(document: Document, given: Mapping[str, Any], at: Place, keys: Iterable[str]) -> None:
    for key in given:
        if key not in keys:
            document.report((*at, key), f"unknown key; {suggestion(key, keys)}")
