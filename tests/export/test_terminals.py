"""Icon and terminal of an FMU: valid by the standard's schema, of variables that are there, one picture twice."""

from __future__ import annotations

import io
import struct
import xml.etree.ElementTree as ElementTree
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest
from dashpot.export.description import describe_fmu
from dashpot.export.facts import Facts
from dashpot.export.icon import LINES, SIDE, png, svg
from dashpot.export.terminals import FOLDER, terminals_and_icons


def entries(path: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_fmi_3_has_a_terminal_that_the_schema_takes(fmu_of):
    import fmpy
    from lxml import etree

    inside = entries(fmu_of(3))
    text = inside[f"{FOLDER}/terminalsAndIcons.xml"]
    schema = etree.XMLSchema(file=str(Path(fmpy.__file__).parent / "schema/fmi3/fmi3TerminalsAndIcons.xsd"))
    schema.assertValid(etree.parse(io.BytesIO(text)))
    terminal = ElementTree.fromstring(text).find("Terminals/Terminal")
    assert terminal is not None
    members = {m.get("memberName"): m.get("variableName") for m in terminal.findall("TerminalMemberVariable")}
    assert members == {"f": "F", "f_rate": "F_rate", "s": "displacement", "v": "velocity", "a": "acceleration"}
    known = {v.get("name") for v in ElementTree.fromstring(inside["modelDescription.xml"]).iter("Float64")}
    assert set(members.values()) <= known
    drawn = terminal.find("TerminalGraphicalRepresentation")
    assert drawn is not None
    assert f"{FOLDER}/{drawn.get('iconBaseName')}.png" in inside


def test_each_version_has_its_icon_where_the_standard_looks(fmu_of, fmus, models):
    assert entries(fmu_of(3))[f"{FOLDER}/icon.png"] == png()
    assert entries(fmu_of(3))[f"{FOLDER}/icon.svg"] == svg()
    assert entries(fmu_of(2))["model.png"] == entries(fmus("base", "python"))["model.png"] == png()
    description = describe_fmu(Facts(models["base"]()), version=3)
    assert terminals_and_icons(description, 3) == terminals_and_icons(description, 3)


@pytest.mark.parametrize("pixels", [64, 128])
def test_the_png_is_the_picture(pixels):
    """Taken apart by the standard's own rules: sizes, checksums, black where a line is and nothing where none is."""
    data, chunks, at = png(LINES, pixels), {}, 8
    assert data.startswith(b"\x89PNG\r\n\x1a\n")
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind, content = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length : at + 12 + length])[0] == zlib.crc32(kind + content)
        chunks[kind], at = content, at + 12 + length
    assert list(chunks) == [b"IHDR", b"IDAT", b"IEND"]
    assert struct.unpack(">II", chunks[b"IHDR"][:8]) == (pixels, pixels)
    rows = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(pixels, 1 + 2 * pixels)
    assert not rows[:, 0].any()  # no filter
    alpha = rows[:, 1:].reshape(pixels, pixels, 2)[:, :, 1]

    def shade(x: float, y: float) -> int:
        return int(alpha[int((SIDE - y) / 2 / SIDE * pixels), int((x + SIDE) / 2 / SIDE * pixels)])

    assert shade(45, 0) == 0  # within the mass
    assert shade(75, 20) > 100  # its side
    assert shade(-90, 0) > 100  # the ground
    assert shade(-50, 80) == 0


def test_the_svg_draws_every_line():
    root = ElementTree.fromstring(svg())
    assert len(root.findall(".//{http://www.w3.org/2000/svg}path")) == len(LINES)
