"""Texts with placeholders, to be filled in: XML, HTML, a header, the Python slave."""

from __future__ import annotations

from importlib import resources


def template(name: str) -> str:
    """Text of one of the templates, by file name."""
    return resources.files(__name__).joinpath(name).read_text(encoding="utf-8")
