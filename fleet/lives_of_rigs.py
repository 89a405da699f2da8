"""The lives of rigs, model after model: from model files in order, or from the folder of a fleet's results."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import takewhile
from pathlib import Path
from typing import Any

from ..change import Life, Point, watch
from ..errors import BadInput
from ..files.reading import content_of
from ..files.yaml_loader import suggestion
from ..model.identified import Identified, load_identified
from .kept_files import changed_file
from .manifest import instant
from .sealed_json import unsealed
from .store import FLEET, FORMAT, Store

_MOST_BYTES = 100_000_000


def lives_of(
    places: Sequence[Path], rig: str | None, say: Callable[[str], None], repeats: Sequence[Path] = ()
) -> list[Life]:
    """The lives that model files, or the folders of fleets, tell.

    Args:
        places: model files in order, which are of one rig; or folders that ``dashpot batch`` wrote.
        rig: of a fleet, this one alone; None: each. Where no rig has two models, all are taken for one.
        say: called with one line for each that cannot be watched.
        repeats: as ``repeats_of`` takes them, to learn repeatability from.

    Raises:
        BadInput: there is no such file, folder or rig, or the models cannot be compared.
    """
    folders, taught = [place for place in places if place.is_dir()], repeats_of(repeats)
    if not folders:
        if rig is not None:
            raise BadInput("--rig chooses from a fleet's results; name the folder that dashpot batch wrote")
        return [watch(_distinct(places), _common(places), taught)]
    if len(folders) < len(places):
        raise BadInput("name model files in order, or folders that dashpot batch wrote, but not both")
    rigs: dict[str, list[Point]] = {}
    for folder in folders:
        for entry in _entries(folder, say):
            if entry["model"] is None:
                say(f"note: {entry['name']} has no model ({entry['result']}) and is left out")
                continue
            model = load_identified(entry["model"])
            point = Point(entry["name"], model, entry.get("state"), entry.get("when"))
            rigs.setdefault(entry["rig"], []).append(point)
    if not rigs:
        raise BadInput(f"{folders[0]}: holds no model yet; run dashpot batch to its end")
    if rig is not None:
        if rig not in rigs:
            raise BadInput(f"{folders[0]}: has no rig {rig!r}; {suggestion(rig, rigs)}")
        return [watch(rigs[rig], rig, taught)]
    if all(len(points) < 2 for points in rigs.values()):
        return [watch([point for points in rigs.values() for point in points], "fleet", taught)]
    for name, points in rigs.items():
        if len(points) < 2:
            say(f"note: {name} has one model and no life to watch")
    return [watch(points, name, taught) for name, points in rigs.items() if len(points) > 1]


def repeats_of(places: Sequence[Path]) -> list[list[Identified]]:
    """Groups of models, each of one rig in one state: the model files together, and the states of fleets' results.

    Raises:
        BadInput: nothing in them repeats.
    """
    groups: dict[tuple[str, str, str], list[Identified]] = {}
    for place in places:
        if not place.is_dir():
            groups.setdefault(("", "", ""), []).append(load_identified(place))
            continue
        for entry in _entries(place):
            if entry["model"] is not None and entry.get("state") is not None:
                key = (str(place), entry["rig"], entry["state"])
                groups.setdefault(key, []).append(load_identified(entry["model"]))
    found = [group for group in groups.values() if len(group) > 1]
    if places and not found:
        raise BadInput(
            "--repeats: nothing repeats there; name two or more models of one rig in one state, or the results of a "
            "fleet in which several entries have the same rig and state"
        )
    return found


def _distinct(places: Sequence[Path]) -> list[Point]:
    """A point for each model file, named by the file where models bear the same name."""
    models = [load_identified(place) for place in places]
    alike = len({model.name for model in models}) < len(models)
    return [Point(place.stem if alike else model.name, model) for place, model in zip(places, models, strict=True)]


def _common(places: Sequence[Path]) -> str:
    """What the names of files have in common, as the rig's name."""
    alike = takewhile(lambda letters: len(set(letters)) == 1, zip(*(place.stem for place in places), strict=False))
    return "".join(letters[0] for letters in alike).strip(" -_.") or "rig"


def _entries(folder: Path, say: Callable[[str], None] = lambda _: None) -> list[dict[str, Any]]:
    """The rows of a fleet's results, ``model`` as a Path; what else lies there and was changed is said.

    Raises:
        BadInput: there are none, or what is read here is not as it was written.
    """
    try:
        value = unsealed(content_of(folder / FLEET, _MOST_BYTES))
    except (OSError, ValueError) as problem:
        why = getattr(problem, "strerror", None) or problem
        raise BadInput(
            f"{folder}: holds no {FLEET} that can be used ({why}); name the folder that dashpot batch wrote and run "
            "dashpot batch again, into another where it does not take this one for its own, or name model files"
        ) from None
    if value.get("format") != FORMAT or not isinstance(value.get("files"), dict) or not _are_rows(value.get("entries")):
        raise BadInput(
            f"{folder}: its {FLEET} is no table of a fleet; name the folder that dashpot batch wrote, or model files"
        )
    for name, known in value["files"].items():
        if why := changed_file(folder, {name: known}):
            say(f"note: {folder}: {why} since dashpot batch wrote it; it is not used here")
    store = Store(folder)
    for entry in value["entries"]:
        entry["model"] = _model_of(store, entry) if entry["key"] else None
    return value["entries"]


def _model_of(store: Store, entry: Mapping[str, Any]) -> Path | None:
    """The file of an entry's model, which is as it was written; None where it has none."""
    outcome = store.outcome(entry["name"], entry["key"])
    if outcome is None and (why := store.changed(entry["name"], entry["key"])):
        raise BadInput(
            f"{store.folder}: {entry['name']}: what was kept is not as it was written ({why}); run dashpot batch again"
        )
    if outcome is None and entry["model"] is not None:
        raise BadInput(f"{store.folder}: {entry['name']}: its model is gone; run dashpot batch again")
    model = None if outcome is None else outcome.model
    return None if model is None else store.place(entry["name"], entry["key"]) / model


def _are_rows(value: Any) -> bool:
    """Whether it is a list of rows as ``table.as_json`` makes them, as far as they are used here."""
    return isinstance(value, list) and all(
        isinstance(row, dict)
        and all(isinstance(row.get(name), str) for name in ("name", "rig", "result", "key"))
        and all(row.get(name) is None or isinstance(row[name], str) for name in ("state", "model"))
        and "model" in row
        and _is_when(row.get("when"))
        for row in value
    )


def _is_when(value: Any) -> bool:
    """A number, a time, or nothing."""
    if isinstance(value, str):
        try:
            instant(value)
        except ValueError:
            return False
        return True
    return value is None or type(value) in (int, float)
