"""MAT files: versions 4 to 7 by scipy, version 7.3, which is HDF5, by h5py."""

from __future__ import annotations

import io
import zlib

from ...errors import BadInput
from ..channels import tables_of_tree
from ..content import too_large
from ..table import Table
from . import FORMATS, missing

_COMPRESSED = 15  # the type of an element that is packed, "MAT-File Level 5 File Format", MathWorks, table 1-1
_HEADER = 128


def read_tables(where: str, content: bytes, most: float) -> list[Table]:
    """The records of a file: variables are channels, a struct is a record of its own.

    Raises:
        BadInput: it unpacks to more than ``most`` MB, or is of version 7.3 and h5py is not there.
    """
    if content[:10] == b"MATLAB 7.3" or content[:8] == b"\x89HDF\r\n\x1a\n" or content[512:520] == b"\x89HDF\r\n\x1a\n":
        from .hdf5 import read_tables as read_hdf5

        try:
            return read_hdf5(where, content, most)
        except ModuleNotFoundError as error:
            raise missing(where, FORMATS[".h5"]._replace(name="MAT 7.3"), error) from None
    from scipy.io import loadmat

    if content[:6] == b"MATLAB":
        _limited(where, content, most)
    loaded = loadmat(io.BytesIO(content), simplify_cells=True)
    if sparse := [name for name, value in loaded.items() if hasattr(value, "tocsc")]:
        raise BadInput(f"{where}: '{sparse[0][:80]}' is a sparse matrix, which no record is; save it with full()")
    return tables_of_tree(where, {name: value for name, value in loaded.items() if not name.startswith("__")})


def _limited(where: str, content: bytes, most: float) -> None:
    """Count what the packed elements unpack to; raises BadInput beyond ``most`` MB."""
    order = "big" if content[126:128] == b"MI" else "little"
    at, left = _HEADER, int(most * 1e6)
    while at + 8 <= len(content):
        kind = int.from_bytes(content[at : at + 4], order)
        size = int.from_bytes(content[at + 4 : at + 8], order)
        if kind == _COMPRESSED:
            packed = memoryview(content)[at + 8 : at + 8 + size]
            unpacker = zlib.decompressobj()
            while packed and not unpacker.eof:
                left -= len(unpacker.decompress(packed, 1 << 20))
                packed = memoryview(unpacker.unconsumed_tail)
                if left < 0:
                    raise too_large(where, most)
        at += 8 + size
