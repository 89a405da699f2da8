"""Laws of a user's own: a Python file that defines one or more ``Law`` objects, taken into the library.

The file is a program and is run. What it defines is checked as strictly as the laws that come with the package, so that
a slip is said here with its line and not met in the middle of a fit.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

from ..errors import BadInput
from ..files.arguments import path_of
from ..files.reading import content_of
from .law import Law
from .law_trial import line_of, said
from .laws import BASE
from .library import KNOWN, take

#: No file of laws is longer.
_MOST_BYTES = 4_000_000
#: The laws that were loaded, by the file they came from, with the text it had.
_loaded: dict[str, tuple[str, tuple[Law, ...]]] = {}


def load_law_file(path: str | os.PathLike[str]) -> tuple[Law, ...]:
    """Run a file that defines laws, and take them into the library.

    A file that was loaded before is not run again.

    Args:
        path: of a Python file; every ``Law`` among its module's names counts.

    Returns:
        The laws, in the order of definition.

    Raises:
        BadInput: the file cannot be read or run, defines no law, or one whose name is taken, that lacks something, or
            whose expression cannot be made; nothing is then taken into the library.
    """
    path = path_of(path, "a Python file with laws")
    where = str(path)
    try:
        text = content_of(path, _MOST_BYTES).decode("utf-8-sig")
        key = os.fspath(Path(path).resolve())
    except UnicodeDecodeError:
        raise BadInput(f"{where}: is not UTF-8 text, so no Python file; give one that defines a Law") from None
    except (OSError, ValueError) as error:  # ValueError: a name with a null byte
        reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
        raise BadInput(f"{where}: cannot be read ({reason}); check the path") from None
    if key in _loaded:
        before, laws = _loaded[key]
        if before != text:
            raise BadInput(f"{where}: was loaded before with another text; start Python again to use the new one")
        return laws
    laws = tuple(_defined(_run(text, where)))
    if not laws:
        raise BadInput(f"{where}: defines no Law; write LAW = Law(name=..., ...) as docs/laws.md shows")
    take(laws, where)
    _loaded[key] = (text, laws)
    return laws


def _run(text: str, where: str) -> ModuleType:
    module = ModuleType(f"dashpot_law_{re.sub(r'[^A-Za-z0-9_]', '_', Path(where).stem)}")
    module.__file__ = where
    try:
        code = compile(text, where, "exec")
    except (SyntaxError, ValueError) as error:  # ValueError: null bytes
        line = getattr(error, "lineno", None)
        words = getattr(error, "msg", None) or str(error)
        raise BadInput(f"{where}{f', line {line}' if line else ''}: not Python ({words}); correct it") from None
    try:
        exec(code, module.__dict__)  # the user's own program, named on the command line
    except (Exception, SystemExit) as error:
        raise BadInput(f"{where}{line_of(error, where)}: {said(error)}; correct the file") from error
    return module


def _defined(module: ModuleType) -> Iterator[Law]:
    """Every law among the module's names, once, but those of the library."""
    seen = {id(law) for law in (*BASE, *KNOWN.values())}
    for value in list(vars(module).values()):
        if isinstance(value, Law) and id(value) not in seen:
            seen.add(id(value))
            yield value
