"""An oscillator as an SSP 1.0 archive: its FMU in a system, and the uncertainty of its parameters as variants of that.

``SystemStructure.ssd``       the system with the identified parameters
``draw_01.ssd`` ...           the same with parameters drawn from the covariance of the estimates
``resources/NAME.fmu``        the FMU (FMI 2.0, as SSP 1.0 has it)
``resources/parameters/``     every set of parameters again, as ``nominal.ssv``, ``draw_01.ssv`` ...
``documentation/index.html``  what is what, and all values in one table

Every set binds at the system, so that names are ``rig.mass``; the .ssd hold theirs inline, for tools differ in whether
they follow a binding to a file (Modelica Association Project SSP, System Structure and Parameterization 1.0, 2019).
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import __version__
from ..errors import BadInput
from ..model.display import pretty_unit
from ..model.fit_state import state_of_fit
from .archive import archived, write_archive
from .description import Description, Variable
from .draws import draws as drawn
from .facts import Facts
from .fmu import fmu_entries
from .render import render

if TYPE_CHECKING:
    from ..model import Oscillator

#: Draws where nobody says how many, and at most.
DRAWS, MOST_DRAWS = 20, 1000
#: Name of the FMU in the system.
COMPONENT = "rig"
_TOOL = f"dashpot {__version__}"
_XML = '<?xml version="1.0" encoding="UTF-8"?>\n'


def export_ssp(
    oscillator: Oscillator, path: str | Path, *, draws: int | None = None, seed: int = 0, **fmu: Any
) -> Path:
    """Write an SSP archive; the same model gives the same bytes.

    Args:
        oscillator: the model.
        path: where to write it.
        draws: sets of parameters drawn from the covariance; None: ``DRAWS`` of them, or none where the model holds no
            covariance (``note`` says so).
        seed: of the draws.
        fmu: how the FMU is made, as for ``export_fmu``; its version is 2, as SSP 1.0 has it.

    Returns:
        The path written.

    Raises:
        BadInput: draws are asked for and the model holds no covariance, or hardly one lies within the parameters'
            bounds; ``draws`` is not between 0 and ``MOST_DRAWS`` or ``seed`` is negative; and as ``export_fmu``.
        ToolchainMissing: where the native FMU finds no C compiler.
    """
    if draws is not None and not 0 <= draws <= MOST_DRAWS:
        raise BadInput(f"{draws} draws: give a number between 0 and {MOST_DRAWS}")
    if seed < 0:
        raise BadInput(f"the seed of the draws is {seed}; give 0 or a positive whole number")
    count = _default(oscillator) if draws is None else draws
    width = len(str(count))
    sets = {"nominal": oscillator.values()}
    made = drawn(oscillator, count, seed) if count else []
    sets |= {f"draw_{i:0{max(width, 2)}d}": values for i, values in enumerate(made, start=1)}
    description, contents = fmu_entries(Facts(oscillator), **fmu)
    return write_archive(Path(path), _entries(description, sets, seed, note(oscillator, draws), archived(contents)))


def note(oscillator: Oscillator, draws: int | None = None) -> str | None:
    """What to tell a user of the draws: how far to trust them, or why there are none where nobody said how many."""
    if (_default(oscillator) if draws is None else draws) > 0:
        state = state_of_fit(oscillator)
        return f"{oscillator.name}: {state}, and a result by more than the draws spread" if state else None
    if draws is not None:
        return None
    return (
        f"{oscillator.name}: the model holds no covariance, so the archive holds the given parameters only and no "
        "draws; identify it with dashpot identify to have them"
    )


def _default(oscillator: Oscillator) -> int:
    return 0 if oscillator.identified.covariance is None else DRAWS


def _entries(
    description: Description, sets: Mapping[str, Mapping[str, float]], seed: int, remark: str | None, fmu: bytes
) -> dict[str, bytes]:
    """Contents of the archive by their names in it."""
    source = f"resources/{description.identifier}.fmu"
    units = {v.name: v.unit for v in description.variables if v.role == "parameter"}
    entries = {source: fmu}
    for name, values in sets.items():
        words = "the identified parameters" if name == "nominal" else f"drawn from their covariance, seed {seed}"
        words += f". Take note: {description.state}." if description.state else ""
        text = _parameter_set(description, name, words, values, units)
        entries[f"resources/parameters/{name}.ssv"] = (_XML + text).encode()
        system = render(
            "SystemStructure.ssd.j2",
            title=description.name if name == "nominal" else f"{description.name}, {name}",
            description=words,
            tool=_TOOL,
            system=description.identifier,
            equation=description.words,
            component=COMPONENT,
            source=source,
            signals=_signals(description),
            units=_known(description, {v.unit for v in _signals(description)}),
            parameter_set=text.strip(),
            stop_time=description.experiment.stop,
        )
        entries["SystemStructure.ssd" if name == "nominal" else f"{name}.ssd"] = system.encode()
    entries["documentation/index.html"] = render(
        "ssp_documentation.html.j2",
        title=description.name,
        source=source,
        component=COMPONENT,
        seed=seed,
        note=remark,
        columns=[(name, pretty_unit(units[name])) for name in next(iter(sets.values()))],
        rows=[(name, list(values.values())) for name, values in sets.items()],
    ).encode()
    return entries


def _parameter_set(
    description: Description, name: str, words: str, values: Mapping[str, float], units: Mapping[str, str]
) -> str:
    return render(
        "ParameterSet.ssv.j2",
        title=name,
        description=words,
        tool=_TOOL,
        parameters=[(f"{COMPONENT}.{n}", repr(float(value)), units[n]) for n, value in values.items()],
        units=_known(description, set(units.values())),
    )


def _signals(description: Description) -> list[Variable]:
    """What the system shows: the force in, all outputs out."""
    return [v for v in description.variables if v.role in ("input", "output")]


def _known(description: Description, used: set[str]) -> dict[str, Any]:
    """Base exponents of the units in use; of those that SI does not know (counts, say) SSP can say nothing."""
    units = description.units()
    return {unit: exponents for unit, exponents in units.items() if exponents is not None and unit in used}
