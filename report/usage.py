"""How to use the model: lines to copy, with the names of the files that were made."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..model.display import pretty_unit
from .blocks import Block, Code, Section

if TYPE_CHECKING:
    from ..model import Oscillator


def usage_section(model: Oscillator, files: Sequence[str]) -> Section:
    """FMU, CasADi functions and commands; what was not made is shown with the command that makes it."""
    yaml = _first(files, ".yaml") or "model.yaml"
    fmu, casadi = _first(files, ".fmu"), _first(files, ".casadi")
    unit = pretty_unit(model.response.displacement_unit)
    force = pretty_unit(model.force_unit) if model.mass is not None else f"{unit}/s²"
    blocks: list[Block] = []
    if fmu is None or casadi is None:
        name = yaml.removesuffix(".yaml")
        made = [file for file, there in ((f"{name}.fmu", fmu), (f"{name}.casadi", casadi)) if there is None]
        lines = "\n".join(f"dashpot export {_shell(yaml)} {_shell(file)}" for file in made)
        of = "" if _first(files, ".yaml") else f", of the model saved as {yaml}"
        blocks.append(Code(f"Make the files that other programs load{of}:", lines))
        fmu, casadi = fmu or f"{name}.fmu", casadi or f"{name}.casadi"
    blocks.append(
        Code(
            f"The FMU (FMI 2.0, co-simulation) in a system simulator: input F [{force}], first output x "
            f"[{pretty_unit(model.response.unit)}], the {model.response.quantity}. In Python, with FMPy:",
            "from fmpy import simulate_fmu\n"
            f"result = simulate_fmu({json.dumps(fmu)}, stop_time=2.0, start_values={{'x0': "
            f"{_start(model)}}}, output=['x'])  # a free decay",
        )
    )
    blocks.append(
        Code(
            f"The equations in a controller, with nothing but CasADi: state [displacement {unit}, velocity {unit}/s], "
            f"input force [{force}], parameters left out take the identified values:",
            "import casadi as ca\n"
            f"f = ca.Function.load({json.dumps(casadi)})\n"
            f"xdot = f(x=[{_start(model)}, 0], u=0)['xdot']",
        )
    )
    blocks.append(
        Code(
            "The proof on recordings of your own, and the response to the force of one:",
            f"dashpot verify {_shell(fmu)} recording.csv\n"
            f"dashpot simulate {_shell(yaml)} recording.csv -o response.csv",
        )
    )
    return Section("How to use the model", tuple(blocks))


def _first(files: Sequence[str], suffix: str) -> str | None:
    """The shortest name with that suffix: rig.casadi rather than rig.smooth.step.casadi."""
    return min((name for name in files if name.endswith(suffix)), key=len, default=None)


def _shell(name: str) -> str:
    import shlex

    return shlex.quote(name)


def _start(model: Oscillator) -> str:
    return f"{model.amplitude.max / 2:.2g}" if model.amplitude is not None else "1e-3"
