"""One job in a process of its own: an importer that crashes takes nothing with it, and leaves nothing behind.

    python -P play.py JOB.json OUT.npy

The job names a module of this folder, one of its functions, and its arguments; the force is a file beside it. Ends with
77 and a reason on standard output where what the module needs is not on this machine.
"""

from __future__ import annotations

import importlib
import json
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np

#: What automake's tests end with when they are skipped.
NOT_HERE = 77


def main() -> int:
    """Do the job of the command line."""
    sys.path.insert(0, str(Path(__file__).parent))
    from machines import NotHereError

    job = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    adapter = importlib.import_module(job["module"])
    missing = [name for name in adapter.NEEDS if find_spec(name) is None]
    if missing:
        print(f"{' and '.join(missing)} not installed")
        return NOT_HERE
    arguments = {**job["arguments"], "fmu": Path(job["arguments"]["fmu"]), "force": np.load(job["force"])}
    try:
        np.save(sys.argv[2], getattr(adapter, job["function"])(**arguments))
    except NotHereError as problem:
        print(problem)
        return NOT_HERE
    return 0


if __name__ == "__main__":
    sys.exit(main())
