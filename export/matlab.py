"""An oscillator as one MATLAB function, the right-hand side for ode45 and its like: ``OUT.m``; GNU Octave takes it."""

from __future__ import annotations

from pathlib import Path

from ..files.writing import write
from .assignments import assignments
from .facts import Facts
from .languages import MATLAB
from .program import Program, filled, functions, named_after_file, program


def export_matlab(facts: Facts, path: Path) -> Path:
    """Write the file; the same model gives the same bytes.

    Raises BadInput where the file's name is none that a function can have, and see ``program``.
    """
    name = named_after_file(path, "MATLAB")
    write(path, matlab_function(program(facts), name))
    return path


def matlab_function(of: Program, name: str) -> str:
    """Text of the file, whose function is called ``name``."""
    bodies = {}
    for part, function in functions(of).items():
        lines, ((*texts,), *_) = assignments(function, of.inputs, MATLAB)
        bodies[part] = lines, texts
    return filled("rig.m.j2", of=of, name=name, bodies=bodies, timed=of.timed, repr=repr)
