"""Broken model files: every problem at once, each with its line, path and advice, and never another exception."""

from __future__ import annotations

import random
import re

import pytest
from dashpot.errors import BadInput
from dashpot.model.file import load, loads

GOOD = """\
format: dashpot-model/1
name: rig
mass: {value: 0.27, std: 0.0003, unit: kg}
omega0: {value: 79.61, std: 0.002, unit: rad/s}
cubic: {value: 4.6e5, std: 5.0e3, unit: 1/(m2.s2)}
preload: {value: 0.0741, std: 0.0008, unit: m/s2}
viscous: {value: 5.0, std: 0.002, unit: 1/s}
dry: {value: 0.015, std: 0.0005, unit: m/s2}
terms:
  - {effect: quadratic-drag, parameters: {coefficient: {value: 0.1, unit: 1/m}}}
response: {quantity: displacement, unit: m}
valid:
  amplitude: {min: 2.0e-4, max: 9.0e-3, unit: m}
  frequency: {min: 5, max: 20, unit: Hz}
identified:
  recordings: [{file: a.csv, sha256: null, kind: sweep}]
  parameters: [preload, dry]
  covariance: [[6.4e-7, 1.0e-7], [1.0e-7, 2.5e-7]]
"""


def problems(text: str) -> list[str]:
    with pytest.raises(BadInput) as caught:
        loads(text, "m.yaml")
    return str(caught.value).splitlines()


def refusal(text: str) -> str:
    """What the refusal says; empty where the text is read."""
    try:
        loads(text, "m.yaml")
    except BadInput as error:
        return str(error)
    return ""


def test_the_good_file_is_good():
    assert loads(GOOD).name == "rig"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("name: rig\n", ""),
        ("name: rig", 'name: "a\\nb"'),
        ("name: rig", f"name: {'x' * 300}"),
        ("name: rig", "name: ''"),
        ("name: rig", "name: 12"),
        ("value: 0.27", "value: -0.27"),
        ("value: 79.61", "value: 0"),
        ("std: 0.002, unit: rad", "std: -1, unit: rad"),
        ("rad/s", "Hz"),
        ("4.6e5", "true"),
        ("4.6e5", "four"),
        ("4.6e5", ".nan"),
        ("4.6e5", "-.inf"),
        ("4.6e5", "1e999"),
        ("4.6e5", "9" * 6000),
        ("1/(m2.s2)", "1/s2"),
        ("0.0008, unit: m/s2", "0.0008, unit: m/s^2"),
        ("value: 0.0741, std", "value: 0.0741, sdt"),
        ("viscous:", "viscuos:"),
        ("viscous: {value: 5.0, std: 0.002, unit: 1/s}", "viscous: 5.0"),
        ("dry: {value: 0.015, std: 0.0005, unit: m/s2}\n", ""),
        ("dry: {value: 0.015, ", "dry: {value: 0.015, value: 3, "),
        ("quadratic-drag", "quadratic-drga"),
        ("coefficient:", "coeficient:"),
        ("unit: 1/m}", "unit: m}"),
        ("response:", "  - {effect: quadratic-drag, parameters: {coefficient: {value: 1, unit: 1/m}}}\nresponse:"),
        ("quantity: displacement", "quantity: position"),
        ("displacement, unit: m}", "displacement, unit: m^2}"),
        ("max: 9.0e-3", "max: 9.0e-5"),
        ("unit: Hz", "unit: rad/s"),
        ("sha256: null", "sha256: abc"),
        ("[preload, dry]", "[preload, drt]"),
        ("[preload, dry]", "[dry, dry]"),
        ("[preload, dry]", "[preload]"),
        ("[1.0e-7, 2.5e-7]]", "[1.5e-7, 2.5e-7]]"),
        ("[[6.4e-7", "[[-6.4e-7"),
        ("[[6.4e-7, 1.0e-7], [1.0e-7, 2.5e-7]]", "[[1.0, 3.0], [3.0, 1.0]]"),
        (
            "[preload, dry]\n  covariance: [[6.4e-7, 1.0e-7], [1.0e-7, 2.5e-7]]",
            "[cubic, preload, dry]\n  covariance: [[1, 0.9, 0.9], [0.9, 1, -0.9], [0.9, -0.9, 1]]",
        ),
        ("[[6.4e-7, 1.0e-7]", "[[6.4, 1.0e-7]"),
    ],
)
def test_one_problem_is_one_sentence_with_its_line_and_path(old, new, reads):
    assert GOOD.count(old) >= 1
    lines = problems(GOOD.replace(old, new, 1))
    reads("\n".join(lines))
    assert all(re.match(r"m\.yaml: line \d+: \$\.[\w.[\]]+: \w", line) for line in lines), lines


def test_every_problem_is_reported_at_once_in_the_order_of_the_lines():
    text = GOOD
    for old, new in (("kg", "g"), ("4.6e5", "x"), ("drag,", "darg,"), ("dry:", "dri:"), ("file:", "fiel:")):
        text = text.replace(old, new, 1)
    lines = problems(text)
    assert [line.split(": ")[2] for line in lines] == [
        "$.dry",
        "$.mass.unit",
        "$.cubic.value",
        "$.dri",
        "$.terms[0].effect",
        "$.identified.recordings[0].file",
        "$.identified.recordings[0].fiel",
    ]


def test_the_units_follow_the_response():
    text = GOOD.replace("quantity: displacement, unit: m", "quantity: velocity, unit: V")
    lines = {line.split(": ")[2]: line for line in problems(text)}
    assert "must be N.s/V for a velocity in V, not 'kg'" in lines["$.mass.unit"]
    assert "must be V/s for a velocity in V" in lines["$.dry.unit"]
    assert "must be V.s or V for a velocity in V" in lines["$.valid.amplitude.unit"]
    assert "$.omega0.unit" not in lines


def test_many_problems_are_cut_short():
    lines = problems(GOOD + "".join(f"key{i}: 1\n" for i in range(200)))
    assert len(lines) == 51
    assert lines[-1] == "m.yaml: and 150 more problems"


LAUGHS = "a: &a [x, x]\n" + "".join(
    f"{chr(98 + i)}: &{chr(98 + i)} [*{chr(97 + i)}, *{chr(97 + i)}]\n" for i in range(20)
)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "# only a comment",
        "just text",
        "- 1\n- 2",
        "name: x",
        "format: dashpot-model/2",
        "format: [1]",
        "format: null",
        "a: [1, 2",
        "a: b: c",
        "\tformat: x",
        "a: 'x",
        "--- 1\n--- 2",
        "[" * 100_000,
        "{a: " * 1000,
        "- " * 5000,
        LAUGHS,
        "a: &a [*a]",
        "a: !!python/object/apply:os.system ['echo']",
        "!!python/object/apply:os.system ['echo']",
        "a: !!python/name:os.system",
        "a: !!binary x",
        "!!set {a}",
        "? [a, b]\n: 1",
        "format: dashpot-model/1\n? {a: 1}\n: 1",
        "format: dashpot-model/1\n<<: {name: x}",
        'a: "\\UFFFFFFFF"',
        'format: "\\ud800"',
        "%YAML " + "9" * 5000 + ".1\n---\na",
        "a\x00b",
        "x" * 1_000_001,
    ],
)
def test_what_is_no_model_file_gets_one_sentence(text, reads):
    message = "\n".join(problems(text))
    reads(re.sub(r"(as YAML): (?!tags|aliases|nested).*", r"\1: ...", message))  # what follows are the library's words
    assert message.startswith("m.yaml: ")
    assert len(message) < 1500


@pytest.mark.parametrize(
    "content", [b"\xff\xfe\x00\x01", b"\x89PNG\r\n\x1a\n" + bytes(range(256)), "ü".encode("latin-1")]
)
def test_binary_files_are_said_to_be_no_model_file(content, tmp_path):
    path = tmp_path / "model.yaml"
    path.write_bytes(content)
    with pytest.raises(BadInput, match="is not UTF-8 text, so not a model file"):
        load(path)


def test_a_byte_order_mark_and_windows_line_ends_do_no_harm(tmp_path):
    path = tmp_path / "model.yaml"
    path.write_bytes(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode())
    assert load(path) == loads(GOOD)


@pytest.mark.parametrize("seed", range(60))
def test_a_damaged_file_is_read_or_refused_but_never_fails_otherwise(seed):
    dice = random.Random(seed)
    pieces = [
        "{",
        "}",
        "[",
        "]",
        ":",
        ",",
        "\n",
        " ",
        "null",
        "true",
        "-1",
        "1e400",
        "&a",
        "*a",
        "!!x",
        "'",
        '"',
        "é",
        "- ",
    ]
    text = GOOD
    for _ in range(dice.randint(1, 6)):
        at = dice.randrange(len(text))
        text = text[:at] + dice.choice(pieces) + text[at + dice.choice([0, 0, 1, 5, 30]) :]
    assert all(line.startswith("m.yaml: ") for line in refusal(text).splitlines())


@pytest.mark.parametrize("junk", ["3", "[]", "{}", "x", "null", "[[[]]]", "{a: {b: {c: 1}}}", "[null, 1, x, {}]"])
@pytest.mark.parametrize(
    "key", ["name", "mass", "omega0", "dry", "terms", "response", "excitation", "valid", "identified"]
)
def test_anything_in_the_place_of_anything_is_read_or_refused(key, junk):
    lines = [
        line for line in GOOD.splitlines() if not line.startswith((" ", f"{key}:", "terms", "valid", "identified"))
    ]
    said = refusal("\n".join([*lines, f"{key}: {junk}"]))
    fits = {"mass": "null", "terms": "[]", "valid": "{}", "identified": "{}", "excitation": "{}", "name": "x"}
    assert (said == "") == (fits.get(key) == junk)
    assert said == "" or f"$.{key}" in said
