"""NPZ archives of numpy: each array a channel, a number named fs the rate. Pickled objects are never loaded."""

from __future__ import annotations

import math
from pathlib import PurePosixPath
from typing import IO, Any

import numpy as np

from ...errors import BadInput
from ..channels import tables_of_tree
from ..content import too_large
from ..table import Table
from .archive import opened


def read_tables(where: str, content: bytes, most: float) -> list[Table]:
    """The records of an archive; a slash in an array's name makes groups, ``run1/force_N``.

    Raises:
        BadInput: it holds pickled objects, or more than ``most`` MB.
    """
    tree: dict[str, Any] = {}
    with opened(where, content, most) as archive:
        for entry in archive.infolist():
            if not entry.filename.endswith(".npy"):
                continue
            *groups, name = PurePosixPath(entry.filename.removesuffix(".npy")).parts
            with archive.open(entry) as file:
                value = _array(where, name, file, most)
            branch = tree
            for group in groups:
                branch = branch.setdefault(group, {})
            branch[name] = value
    return tables_of_tree(where, tree)


def _array(where: str, name: str, file: IO[bytes], most: float) -> np.ndarray:
    version = np.lib.format.read_magic(file)
    header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, fortran, dtype = header(file)
    if dtype.hasobject:
        raise BadInput(
            f"{where}: '{name}' holds pickled Python objects, which are programs and never loaded; save plain arrays"
        )
    if math.prod(shape) * dtype.itemsize > most * 1e6:
        raise too_large(where, most)
    data = file.read()
    return np.frombuffer(data, dtype, math.prod(shape)).reshape(shape, order="F" if fortran else "C")
