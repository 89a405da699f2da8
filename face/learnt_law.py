"""The closed form of a learnt curve as a law file of the user's own."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import BadInput
from ..files.writing import check_ours, write

if TYPE_CHECKING:
    from ..diagnose.result import Diagnosis

#: How each law file of ours begins.
_OURS = '"""A law that dashpot learnt: '


def law_name(path: Path) -> str:
    """The name of the law that a file is to hold, which is the file's own.

    Raises BadInput where that is none for a law, is taken, or the file is there and is not one of ours.
    """
    from ..model.laws import BASE, FURTHER
    from ..model.library import KNOWN

    name = path.stem
    if path.suffix != ".py" or not re.fullmatch(r"[a-z][a-z0-9-]*", name):
        raise BadInput(
            f"{path}: is no name for a law file; give small letters, digits and hyphens before .py, as my-spring.py"
        )
    if name in KNOWN or name in FURTHER or name in {law.name for law in BASE}:
        raise BadInput(f"{path}: there is a law {name!r} already; give the file another name, as my-{name}.py")
    check_ours(path, _OURS.encode(), "a law that was learnt")
    return name


def write_law(path: Path, found: Diagnosis) -> str:
    """Write the shortest closed form of a diagnosis as a law file; returns what to say.

    Nothing is written where there is none. Raises BadInput as ``law_name`` does.
    """
    from ..model.formula.closed_form import law_file

    name = law_name(path)
    if not found.forms:
        if any(effect.effect.startswith("free/") for effect in found.effects):
            return f"{path} is not written: no closed form of two pieces lies within the band of what was learnt"
        return f"{path} is not written: nothing was learnt; each law that was taken has a name"
    form = found.forms[0]
    files = [str(row["file"]) for row in found.model.identified.recordings]
    write(path, law_file(form, name, files))
    return f"written: {path}, the law {name}: {form.text}; use it with --law {path} --with {name}"
