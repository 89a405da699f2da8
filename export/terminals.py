"""What a tool draws and wires of an FMU: its icon and, in FMI 3.0 (section 2.4.9), the terminal at its mass.

One wire of a tool that knows terminals then brings the force and takes the motion; a member that the other end has not
is left open.
"""

from __future__ import annotations

from .description import Description
from .icon import FLANGE, LINES, MARK, SIDE, png, svg
from .render import render

FOLDER = "terminalsAndIcons"
#: Members of the terminal: as the other end has them, the variable, and how it flows.
_MEMBERS = (
    ("f", "F", "inflow"),
    ("f_rate", "F_rate", "signal"),
    ("s", "displacement", "signal"),
    ("v", "velocity", "signal"),
    ("a", "acceleration", "signal"),
)
#: Half the side of the terminal's mark, in units of the icon.
_MARK = 10.0


def terminals_and_icons(description: Description, version: int) -> dict[str, bytes]:
    """The files by their names in the archive of an FMU."""
    if version == 2:
        return {"model.png": png()}
    there = {variable.name for variable in description.variables}
    x, y = FLANGE
    text = render(
        "terminals.xml.j2",
        members=[member for member in _MEMBERS if member[1] in there],
        side=SIDE,
        corners=(x - _MARK, y - _MARK, x + _MARK, y + _MARK),
    )
    return {
        f"{FOLDER}/terminalsAndIcons.xml": text.encode(),
        f"{FOLDER}/icon.png": png(LINES),
        f"{FOLDER}/icon.svg": svg(LINES),
        f"{FOLDER}/flange.png": png(MARK, 32),
        f"{FOLDER}/flange.svg": svg(MARK),
    }
