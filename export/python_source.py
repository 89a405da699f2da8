"""An oscillator as one file of plain Python, over whatever arrays it is called with: ``OUT.py``.

The file imports nothing but the standard library; NumPy, JAX, PyTorch and others give their own functions, by the array
API standard (2022.12). It evaluates what ``OUT.casadi`` does, operation by operation.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

from ..files.writing import write
from .assignments import assignments
from .facts import Facts
from .languages import PYTHON
from .program import Program, filled, functions, program


def export_python(facts: Facts, path: Path) -> Path:
    """Write the file; the same model gives the same bytes. Raises BadInput, see ``program``."""
    write(path, python_source(program(facts), path.stem))
    return path


def python_source(of: Program, module: str) -> str:
    """Text of the file, which is imported as ``module``."""
    bodies, used = {}, {}
    for name, function in functions(of).items():
        lines, ((*texts,), *_) = assignments(function, of.inputs, PYTHON, numbers=2)
        bodies[name] = lines, texts
        used[name] = set(re.findall(r"[A-Za-z_]\w*", " ".join([*lines, *texts])))
    return filled(
        "rig.py.j2",
        of=of,
        module=module if module.isidentifier() else "rig",
        bodies=bodies,
        timed=of.timed,
        repr=repr,
        quoted=json.dumps,
        used=used,
    )
