"""WAV files: channels by number, in counts of the converter, at the rate that the header states."""

from __future__ import annotations

import io

import numpy as np

from ...errors import BadInput
from ..channels import Channel, table_of
from ..table import Table


def read_tables(where: str, content: bytes, most: float) -> list[Table]:
    """The one record of a WAV file: counts as they are stored, or fractions of full scale in a file of floats.

    Raises:
        BadInput: it is no WAV file, or cut short.
    """
    from scipy.io import wavfile

    if content[:4] not in (b"RIFF", b"RIFX", b"RF64") or content[8:12] != b"WAVE":
        raise BadInput(f"{where} is no WAV file; name it by what it is, or export it as CSV")
    size = int.from_bytes(content[4:8], "big" if content[:4] == b"RIFX" else "little")
    if content[:4] != b"RF64" and size + 8 > len(content) + 1:  # one byte of padding is often forgotten
        raise BadInput(f"{where} is cut short, {len(content)} of {size + 8} bytes are there; copy it again")
    fs, data = wavfile.read(io.BytesIO(content))
    if data.dtype == np.uint8:
        data = data.astype(float) - 128.0  # eight bits are stored from 0 to 255
        full = 128
    elif data.dtype.kind == "f":
        full = 1
    else:
        stored = 8 * _stored_bytes(content)  # of three bytes scipy makes four, the lowest 0
        data = data >> 8 * data.dtype.itemsize - stored
        full = 2 ** (stored - 1)
    data = data[:, None] if data.ndim == 1 else data
    note = f"{where}: holds counts of a converter, full scale {full}; --calibration says what a count is"
    return [table_of(where, [Channel("", column, "counts") for column in data.T], float(fs), notes=[note])]


def _stored_bytes(content: bytes) -> int:
    """Bytes of one sample of one channel, by the chunk ``fmt`` ("Multimedia Programming Interface", IBM, Microsoft)."""
    order = "big" if content[:4] == b"RIFX" else "little"
    at = 12
    while content[at : at + 4] != b"fmt ":
        size = int.from_bytes(content[at + 4 : at + 8], order)
        at += 8 + size + size % 2
    channels, block = (int.from_bytes(content[at + 8 + k : at + 10 + k], order) for k in (2, 12))
    return block // channels
