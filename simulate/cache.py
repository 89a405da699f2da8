"""Where what was built once is kept."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def cache_folder() -> Path:
    """Where built libraries are kept: ``$DASHPOT_CACHE``, else the user's cache folder.

    A relative path in ``XDG_CACHE_HOME`` is none (XDG base directory specification 0.8), nor is one in ``HOME``, which
    an empty one is: then the user's entry in the system's list says where the home is.
    """
    if given := os.environ.get("DASHPOT_CACHE"):
        return Path(given)
    base = os.environ.get("LOCALAPPDATA" if sys.platform == "win32" else "XDG_CACHE_HOME")
    try:
        return Path(base) / "dashpot" if base and Path(base).is_absolute() else _home() / ".cache" / "dashpot"
    except (RuntimeError, KeyError):  # a user without a home, as in a container
        return Path("/nonexistent/dashpot")


def _home() -> Path:
    if sys.platform == "win32" or Path(os.environ.get("HOME", "/")).is_absolute():
        return Path.home()
    import pwd

    return Path(pwd.getpwuid(os.getuid()).pw_dir)
