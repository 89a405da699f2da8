"""HDF5 files, and MAT files of version 7.3, which are such: each group with vectors in it is a record."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from ...errors import BadInput
from ..channels import tables_of_tree
from ..content import too_large
from ..table import Table

#: Attributes that hold a unit, and those of a rate, as measuring programs write them.
_UNIT = ("units", "unit", "unit_str", "unit_string")
_RATE = ("fs", "sampling_rate", "sample_rate", "sampling_frequency", "dt")


def read_tables(where: str, content: bytes, most: float) -> list[Table]:
    """The records of a file: data sets are channels, with the unit that their attribute `units` or `unit` states.

    Links to other files and data kept outside of this one are not followed. Raises BadInput where the data sets take
    more than ``most`` MB unpacked, and ModuleNotFoundError without h5py.
    """
    import h5py

    tree: dict[str, Any] = {}
    units: dict[str, str] = {}
    total = 0

    def visit(path: str, node: Any) -> None:
        nonlocal total
        if path.startswith("#refs#") or "/#refs#" in path:  # where MATLAB keeps what its cells point to
            return
        *groups, name = path.split("/")
        branch = tree
        for group in groups:
            branch = branch.setdefault(group, {})
        if isinstance(node, h5py.Group):
            branch[name] = {key: node.attrs[key] for key in _RATE if key in node.attrs}
            return
        matlab = _text(node.attrs.get("MATLAB_class", ""))
        if node.dtype.kind not in "iufcbV" or matlab in ("char", "cell", "logical") or node.external or node.is_virtual:
            return
        total += node.size * max(node.dtype.itemsize, 8)
        if total > most * 1e6:
            raise too_large(where, most)
        branch[name] = node[()]
        units[path] = next((_text(node.attrs[key]) for key in _UNIT if key in node.attrs), "")
        for key in _RATE:
            if key in node.attrs and np.any(branch.setdefault(key, node.attrs[key]) != node.attrs[key]):
                raise BadInput(
                    f"{where}: '{path}' states another {key} than what lies beside it; export the records one by one"
                )

    with h5py.File(io.BytesIO(content), "r") as file:
        tree.update({key: file.attrs[key] for key in _RATE if key in file.attrs})
        file.visititems(visit)  # visits each object once and follows no link out of the file
    return tables_of_tree(where, tree, units)


def _text(value: Any) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
