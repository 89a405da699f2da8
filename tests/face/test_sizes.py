"""What an installation takes on the disk, by the lists of files of its packages."""

from __future__ import annotations

import pytest
from dashpot.face.sizes import in_words, sizes_of


@pytest.fixture
def packages(tmp_path, monkeypatch):
    """Packages as pip leaves them, which ask for one another in a ring, and for one that is not there."""
    for name, asks, size in (
        ("ring", ["round-one>=1", "absent ; sys_platform == 'win32'", "large[more] ; extra == 'big'"], 3_000_000),
        ("Round_One", ["ring", 'large ; extra == "big"'], 250_000),
        ("large", ["added ; extra == 'more'"], 40_000_000),
    ):
        told = tmp_path / f"{name}-1.0.dist-info"
        told.mkdir()
        lines = [f"Requires-Dist: {text}" for text in asks]
        (told / "METADATA").write_text(
            "\n".join(["Metadata-Version: 2.1", f"Name: {name}", "Version: 1.0", *lines, ""])
        )
        (tmp_path / name).mkdir()  # importlib_metadata, where something has imported it, counts only what is there
        (tmp_path / name / "__init__.py").touch()
        (told / "RECORD").write_text(f"{name}/__init__.py,sha256=x,{size}\n{name}/__pycache__/__init__.pyc,,\n")
    monkeypatch.syspath_prepend(str(tmp_path))


def test_all_that_a_package_asks_for_is_counted_once(packages):
    assert sizes_of("ring") == {"ring": 3.0, "round-one": 0.25}
    assert sizes_of("ring", "big") == {"ring": 3.0, "round-one": 0.25, "large": 40.0}


def test_what_is_not_installed_has_no_size():
    assert sizes_of("no-such-package-here") == {}
    assert in_words({}) == "0 MB"


def test_the_largest_are_named():
    sizes = {"small": 0.2, "casadi": 280.6, "numpy": 57.0, "scipy": 114.0, "a": 3.0, "b": 2.0}
    assert in_words(sizes) == "457 MB (casadi 281, scipy 114, numpy 57, a 3)"
