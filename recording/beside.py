"""A ``dashpot.yaml`` beside recordings, ``dashpot-data/1``: how the files of its folder are read, said once.

It is data, read as a model file is: no tag or alias of it is obeyed, and every problem is reported at once with its
line and path (``beside_form``). What a command or a call says itself counts instead of what stands there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, TypeVar

from ..errors import BadInput, TellsNothing
from ..files.reading import content_of
from .beside_form import NAME, checked, options_of
from .channel import stated_channels
from .frequency import frequency_of
from .part import parse_part
from .recording import Recording

_MOST_BYTES = 4_000_000
#: By an option that is given, those of the file that are not meant beside it, since both cannot be.
_RIVALS = {"force": ("base",), "base": ("force",), "response": ("prescribed",), "prescribed": ("response", "base")}
#: By an option that states a unit, the column whose calibration states one too.
_CALIBRATED = {"unit": "response", "force_unit": "force"}
Made = TypeVar("Made")


@dataclass(frozen=True)
class Told:
    """What a file beside says of one recording: its path, the name of the rig, the options taken from it."""

    path: Path | None = None
    rig: str = ""
    taken: Mapping[str, Any] = field(default_factory=dict)

    def of(self, make: Callable[[], Recording]) -> Recording:
        """A recording with the note that the file was read; what is wrong with it says so too."""
        return self._noted(self._made(make))

    def each(self, make: Callable[[], list[Recording]]) -> list[Recording]:
        """Recordings with that note."""
        return [self._noted(recording) for recording in self._made(make)]

    def _made(self, make: Callable[[], Made]) -> Made:
        try:
            return make()
        except BadInput as problem:
            if not self.taken:
                raise
            kind = TellsNothing if isinstance(problem, TellsNothing) else BadInput
            raise kind(f"{problem} (read as {self._place()} says: {self._words()})") from None

    def _noted(self, recording: Recording) -> Recording:
        if self.path is None:
            return recording
        words = self._words() or (f"the rig is {self.rig}" if self.rig else "nothing that the options do not say")
        note = f"{recording.name}: read as {self._place()} says: {words}"
        return replace(recording, rig=self.rig, notes=(note, *recording.notes))

    def _place(self) -> str:
        """Its folder and name: what is kept of a recording need not say where on a machine it lay."""
        return "" if self.path is None else str(Path(self.path.parent.name) / self.path.name)

    def _words(self) -> str:
        return ", ".join(f"{name.replace('_', ' ')} {_text(value)}" for name, value in self.taken.items())


def with_beside(file: Path, record: str, given: Mapping[str, Any]) -> tuple[dict[str, Any], Told]:
    """The options for reading a file: those given and, where they say nothing, those of the file beside it.

    Args:
        file: of the recording.
        record: name of the record that is meant in it, "" for all.
        given: options of ``recording_of``, and `amplitude`; None and what is empty say nothing.

    Returns:
        Options of ``recording_of``, with `amplitude`, and what is to be said of where they come from.

    Raises:
        BadInput: the file beside is not as it must be.
    """
    place = file.parent / NAME
    text = _text_at(place)
    if text is None:
        return dict(given), Told()
    form = checked(text, str(place))
    said = options_of(form)
    for pattern, more in form.get("files", {}).items():
        if any(fnmatchcase(name.lower(), pattern.lower()) for name in (file.name, f"{file.name}#{record}")):
            said |= options_of(more)
    for pattern, part in form.get("parts", {}).items():
        if fnmatchcase(file.name.lower(), pattern.lower()):
            said["part"] = part
    options = {name: value for name, value in given.items() if _says(value)}
    unmeant = {rival for name, rivals in _RIVALS.items() if _names(options.get(name)) for rival in rivals}
    taken = {name: value for name, value in said.items() if name not in options and name not in unmeant}
    if calibration := taken.pop("calibration", None):
        stated = {_CALIBRATED[option] for option in _CALIBRATED if option in options}
        taken |= {"calibration": kept} if (kept := {k: v for k, v in calibration.items() if k not in stated}) else {}
    for option in _CALIBRATED:
        if _CALIBRATED[option] in (options.get("calibration") or {}):
            taken.pop(option, None)
    return {**given, **_as_options(taken)}, Told(place, form.get("name", ""), taken)


def prescribed_beside(file: Path, given: Any) -> Any:
    """The column of a prescribed motion: the one given or, where none is, that which a file beside names."""
    return given if _says(given) else with_beside(file, "", {})[0].get("prescribed")


def _says(value: Any) -> bool:
    return value is not None and not (isinstance(value, str | tuple | list | Mapping) and len(value) == 0)


def _names(value: Any) -> bool:
    """Whether an option names a column, and does not leave one out."""
    return _says(value) and str(value).strip().lower() != "none"


def _as_options(taken: Mapping[str, Any]) -> dict[str, Any]:
    """Texts of the file as what ``recording_of`` takes."""
    made = dict(taken)
    if "fs" in made:
        made["fs"] = frequency_of(made["fs"])
    if "part" in made:
        made["part"] = parse_part(made["part"])
    if "channels" in made:
        made["channels"] = tuple(channel.of(0, "") for channel in stated_channels(made["channels"]))
    return made


def _text(value: Any) -> str:
    return "; ".join(f"{k} {v}" for k, v in value.items()) if isinstance(value, Mapping) else str(value)


def _text_at(place: Path) -> str | None:
    """The text of a file; None where there is no such file. Raises BadInput where it cannot be read."""
    try:
        return content_of(place, _MOST_BYTES).decode("utf-8-sig")
    except (FileNotFoundError, NotADirectoryError):
        return None
    except UnicodeDecodeError:
        raise BadInput(f"{place}: is not UTF-8 text; save it as UTF-8, or name it otherwise") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise BadInput(f"{place}: cannot be read ({reason}); check it, or name it otherwise") from None
