"""JSON that is plain data of a known form, and as it was written to the byte."""

from __future__ import annotations

import json

import pytest
from dashpot.fleet.outcome import Outcome, from_json
from dashpot.fleet.sealed_json import MOST_DEPTH, plain, sealed, unsealed

TOLD = {"format": "x", "numbers": [0.1, -3, 1e300, None, True], "name": 'ω₀ \\ " \n'}


def test_what_was_sealed_comes_back():
    assert unsealed(sealed(TOLD).encode()) == TOLD


def test_a_change_of_any_byte_is_found():
    content = sealed(TOLD).encode()
    for i in range(len(content)):
        for bit in range(8):
            changed = bytearray(content)
            changed[i] ^= 1 << bit
            with pytest.raises(ValueError, match=r"."):
                unsealed(bytes(changed))
    for changed in (content[:-1], content + b"\n", content[:40], b"", b" " + content):
        with pytest.raises(ValueError, match=r"."):
            unsealed(changed)


@pytest.mark.parametrize(
    "text",
    [
        "NaN", "[Infinity]", "-Infinity", "1e999", "1" * 40, "1" * 5000, '{"a": 1, "a": 2}', '"\\ud800"',
        '{"\\udc00": 1}', "[" * 100_000, "[" * 100_000 + "]" * 100_000, '{"a":' * 50_000 + "1" + "}" * 50_000,
        "[" * (MOST_DEPTH + 1) + "]" * (MOST_DEPTH + 1), "", "{", "\ufeff{}", "'a'", "[1,]", "nul",
    ],
    ids=lambda text: text[:12],
)  # fmt: skip
def test_what_is_no_plain_data_is_refused(text):
    with pytest.raises(ValueError, match=r"."):
        plain(text.encode())


def test_bytes_that_are_no_text_are_refused():
    with pytest.raises(ValueError, match=r"."):
        plain(b"\xff\xfe{}")


def test_depth_up_to_the_limit_is_read():
    assert plain(("[" * MOST_DEPTH + "]" * MOST_DEPTH).encode()) is not None


SOUND = Outcome("0" * 32, "a", "good", "said", model="model.yaml", files={"model.yaml": "00"}).as_json()


def test_a_sound_outcome_is_read():
    assert from_json(json.loads(json.dumps(SOUND))) is not None


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *[(name, value) for name in SOUND for value in ([[]], {"a": {}}, 1.5, True) if name != "wanted"],
        ("wanted", 1), ("attempts", True), ("attempts", -1), ("attempts", 1.0), ("key", None), ("stage", "else"),
        ("seconds", {"identify": float("nan")}), ("seconds", {"identify": "1"}), ("seconds", None),
        ("parameters", {"mass": 1.0}), ("parameters", {"mass": {"value": 1.0}}),
        ("parameters", {"mass": {"value": float("inf"), "std": None, "unit": "kg"}}),
        ("parameters", {"mass": {"value": "1", "std": None, "unit": "kg"}}),
        ("recordings", [1]), ("recordings", [{"nrmse": "0"}]), ("recordings", [{"over_noise": float("nan")}]),
        ("curve", {"unit": "m", "amplitude": [1.0], "damping_ratio": [0.1, 0.1]}),
        ("curve", {"unit": "m", "amplitude": [0.0], "damping_ratio": [0.1]}),
        ("curve", {"unit": "m", "amplitude": [], "damping_ratio": []}), ("curve", {"unit": "m", "amplitude": [1.0]}),
        ("picture", ["x"]), ("effects", [1]), ("model", "../model.yaml"), ("page", "report.html"),
        ("extra", 1), ("state", "excellent"), ("format", "dashpot-entry/2"),
    ],
)  # fmt: skip
def test_an_outcome_of_another_form_is_none(name, value):
    assert from_json({**SOUND, name: value}) is None


@pytest.mark.parametrize("told", [None, [], "x", 1, {}, {**{k: v for k, v in SOUND.items() if k != "key"}}])
def test_what_is_no_outcome_is_none(told):
    assert from_json(told) is None
