"""Where what was built once is kept."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def cache_folder() -> Path:
    """Where built libraries are kept: ``$DASHPOT_CACHE``, else the user's cache folder."""
    if given := os.environ.get("DASHPOT_CACHE"):
        return Path(given)
    base = os.environ.get("LOCALAPPDATA" if sys.platform == "win32" else "XDG_CACHE_HOME")
    try:
        return Path(base) / "dashpot" if base else Path.home() / ".cache" / "dashpot"
    except RuntimeError:  # a user without a home, as in a container
        return Path("/nonexistent/dashpot")
