"""The icon of an FMU: a mass on a spring and a damper, as SVG and PNG from the same lines.

FMI 2.0.5 (section 2.2) has ``model.png``; FMI 3.0.2 (section 2.4.9) has ``terminalsAndIcons/icon.png`` and, of the same
picture, ``icon.svg``.
"""

from __future__ import annotations

import struct
import zlib
from functools import cache
from itertools import pairwise

import numpy as np

Line = tuple[tuple[float, float], ...]

#: The picture is this square, y upwards; where the force acts on the mass.
SIDE = 100.0
FLANGE = (75.0, 0.0)
_WIDTH = 6.0
_PIXELS = 128
_ZIGZAG = tuple((-62.0 + 12.0 * k, 30.0 + (0.0 if k in (0, 6) else 14.0 * (-1) ** k)) for k in range(7))
#: Each a line from point to point: the ground, the spring, the damper, the mass.
LINES: tuple[Line, ...] = (
    ((-90.0, -60.0), (-90.0, 60.0)),
    ((-90.0, 30.0), *_ZIGZAG, (15.0, 30.0)),
    ((-90.0, -30.0), (-45.0, -30.0)),
    ((-10.0, -48.0), (-45.0, -48.0), (-45.0, -12.0), (-10.0, -12.0)),
    ((-25.0, -42.0), (-25.0, -18.0)),
    ((-25.0, -30.0), (15.0, -30.0)),
    ((15.0, -60.0), (75.0, -60.0), (75.0, 60.0), (15.0, 60.0), (15.0, -60.0)),
)
#: The mark of a terminal: a square.
MARK: tuple[Line, ...] = (((-80.0, -80.0), (80.0, -80.0), (80.0, 80.0), (-80.0, 80.0), (-80.0, -80.0)),)


def svg(lines: tuple[Line, ...] = LINES) -> bytes:
    """The lines as SVG."""
    paths = "".join(f'<path d="M{" L".join(f"{x:g} {-y:g}" for x, y in line)}"/>\n' for line in lines)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{-SIDE:g} {-SIDE:g} {2 * SIDE:g} {2 * SIDE:g}">\n'
        f'<g fill="none" stroke="black" stroke-width="{_WIDTH:g}" stroke-linejoin="round" stroke-linecap="round">\n'
        f"{paths}</g>\n</svg>\n"
    ).encode()


@cache
def png(lines: tuple[Line, ...] = LINES, pixels: int = _PIXELS) -> bytes:
    """The lines as PNG (ISO/IEC 15948), shades of grey on nothing."""
    scale = 2.0 * SIDE / pixels
    centre = (np.arange(pixels) + 0.5) * scale - SIDE
    x, y = np.meshgrid(centre, -centre)
    far = np.full((pixels, pixels), np.inf)
    for line in lines:
        for (x0, y0), (x1, y1) in pairwise(line):
            dx, dy = x1 - x0, y1 - y0
            along = np.clip(((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy), 0.0, 1.0)
            far = np.minimum(far, np.hypot(x - x0 - along * dx, y - y0 - along * dy))
    covered = np.round(255.0 * np.clip((_WIDTH / 2.0 - far) / scale + 0.5, 0.0, 1.0)).astype(np.uint8)
    shades = np.stack([np.zeros_like(covered), covered], axis=2)  # black, and how much of it
    rows = np.concatenate([np.zeros((pixels, 1), np.uint8), shades.reshape(pixels, -1)], axis=1)  # unfiltered

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    head = struct.pack(">IIBBBBB", pixels, pixels, 8, 4, 0, 0, 0)  # 8 bits of grey and of alpha
    parts = (chunk(b"IHDR", head), chunk(b"IDAT", zlib.compress(rows.tobytes(), 9)), chunk(b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)
