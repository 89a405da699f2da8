"""Words in a row."""

from __future__ import annotations

import pytest
from dashpot.files.spoken import spoken


@pytest.mark.parametrize(
    ("names", "text"),
    [
        ((), ""),
        (("a",), "a"),
        (("a", "b"), "a and b"),
        (("a", "b", "c"), "a, b and c"),
        (("a", "b", "c", "d"), "a, b, c and d"),
    ],
)
def test_a_list_is_spoken(names, text):
    assert spoken(names) == text
    assert spoken(names, "or") == text.replace(" and ", " or ")
