"""Broken model files: every problem at once, each with its line, path and advice, and never another exception."""

from __future__ import annotations

import random

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
    ("old", "new", "said"),
    [
        ("name: rig\n", "", "line 1: $.name: is missing; write name: my-rig"),
        ("name: rig", 'name: "a\\nb"', "line 2: $.name: holds a line break or a control character; take it out"),
        ("name: rig", f"name: {'x' * 300}", "line 2: $.name: is longer than 255 characters; shorten it"),
        ("name: rig", "name: ''", "line 2: $.name: is empty; write something there"),
        ("name: rig", "name: 12", "line 2: $.name: must be text, not 12; put it in quotes"),
        ("value: 0.27", "value: -0.27", "line 3: $.mass.value: must be greater than 0, not -0.27"),
        ("value: 79.61", "value: 0", "line 4: $.omega0.value: must be greater than 0, not 0"),
        ("std: 0.002, unit: rad", "std: -1, unit: rad", "line 4: $.omega0.std: must not be below 0, but is -1"),
        (
            "rad/s",
            "Hz",
            "line 4: $.omega0.unit: must be rad/s for a displacement in m, not 'Hz'; multiply the value by 2 pi",
        ),
        ("4.6e5", "true", "line 5: $.cubic.value: must be a plain number such as 4.6e5, not true"),
        ("4.6e5", "four", "line 5: $.cubic.value: must be a plain number such as 4.6e5, not 'four'"),
        ("4.6e5", ".nan", "line 5: $.cubic.value: must be a finite number"),
        ("4.6e5", "-.inf", "line 5: $.cubic.value: must be a finite number"),
        ("4.6e5", "1e999", "line 5: $.cubic.value: must be a finite number"),
        ("4.6e5", "9" * 6000, "line 5: $.cubic.value: must be a finite number"),
        (
            "1/(m2.s2)",
            "1/s2",
            "line 5: $.cubic.unit: must be 1/(m2.s2) for a displacement in m, not '1/s2'; convert the value",
        ),
        (
            "0.0008, unit: m/s2",
            "0.0008, unit: m/s^2",
            "line 6: $.preload.unit: must be m/s2 for a displacement in m, not 'm/s^2'; convert the value",
        ),
        ("value: 0.0741, std", "value: 0.0741, sdt", "line 6: $.preload.sdt: unknown key; did you mean std?"),
        ("viscous:", "viscuos:", "line 7: $.viscuos: unknown key; did you mean viscous?"),
        (
            "viscous: {value: 5.0, std: 0.002, unit: 1/s}",
            "viscous: 5.0",
            "line 7: $.viscous: must be a mapping, not 5.0; write viscous: {value: 0.0, std: null, unit: 1/s}",
        ),
        (
            "dry: {value: 0.015, std: 0.0005, unit: m/s2}\n",
            "",
            "line 1: $.dry: is missing; write dry: {value: 0.0, std: null, unit: m/s2}",
        ),
        (
            "dry: {value: 0.015, ",
            "dry: {value: 0.015, value: 3, ",
            "line 8: $.dry.value: stands here for the second time (first on line 8); keep one",
        ),
        (
            "quadratic-drag",
            "quadratic-drga",
            "line 10: $.terms[0].effect: effect 'quadratic-drga' is not in the library of laws; "
            "did you mean quadratic-drag",
        ),
        (
            "coefficient:",
            "coeficient:",
            "line 10: $.terms[0].parameters.coeficient: quadratic-drag has no such parameter; "
            "did you mean coefficient?",
        ),
        (
            "unit: 1/m}",
            "unit: m}",
            "line 10: $.terms[0].parameters.coefficient.unit: must be 1/m for a displacement in m, not 'm'; "
            "convert the value",
        ),
        (
            "response:",
            "  - {effect: quadratic-drag, parameters: {coefficient: {value: 1, unit: 1/m}}}\nresponse:",
            "line 11: $.terms[1].effect: quadratic-drag is there already; add its parameters to that one",
        ),
        (
            "quantity: displacement",
            "quantity: position",
            "line 11: $.response.quantity: must be 'displacement', 'velocity' or 'acceleration', not 'position'",
        ),
        (
            "displacement, unit: m}",
            "displacement, unit: m^2}",
            "line 11: $.response.unit: cannot read 'm^2'; write it like m, rad, V, m/s2 or counts",
        ),
        (
            "max: 9.0e-3",
            "max: 9.0e-5",
            "line 13: $.valid.amplitude: min 0.0002 is above max 9e-05; exchange them",
        ),
        (
            "unit: Hz",
            "unit: rad/s",
            "line 14: $.valid.frequency.unit: must be Hz for a displacement in m, not 'rad/s'; convert the value",
        ),
        (
            "sha256: null",
            "sha256: abc",
            "line 16: $.identified.recordings[0].sha256: must be 64 hexadecimal digits in lower case, or null",
        ),
        (
            "[preload, dry]",
            "[preload, drt]",
            "line 17: $.identified.parameters[1]: the model has no parameter 'drt'; did you mean dry?",
        ),
        (
            "[preload, dry]",
            "[dry, dry]",
            "line 17: $.identified.parameters[1]: dry is there already; name each row of the covariance once",
        ),
        (
            "[preload, dry]",
            "[preload]",
            "line 18: $.identified.covariance: must be 1 by 1 for preload, not 2 rows of 2 numbers; "
            "name its rows in identified.parameters",
        ),
        (
            "[1.0e-7, 2.5e-7]]",
            "[1.5e-7, 2.5e-7]]",
            "line 18: $.identified.covariance: is not symmetric: preload with dry differs from the other way round",
        ),
        (
            "[[6.4e-7",
            "[[-6.4e-7",
            "line 18: $.identified.covariance: the variance of preload is negative; a variance is a square",
        ),
        (
            "[[6.4e-7, 1.0e-7], [1.0e-7, 2.5e-7]]",
            "[[1.0, 3.0], [3.0, 1.0]]",
            "line 18: $.identified.covariance: a covariance is larger than the two variances allow (correlation above "
            "1); check the numbers",
        ),
        (
            "[preload, dry]\n  covariance: [[6.4e-7, 1.0e-7], [1.0e-7, 2.5e-7]]",
            "[cubic, preload, dry]\n  covariance: [[1, 0.9, 0.9], [0.9, 1, -0.9], [0.9, -0.9, 1]]",
            "line 18: $.identified.covariance: is not positive semidefinite, so no set of measurements has it; "
            "check the numbers",
        ),
        (
            "[[6.4e-7, 1.0e-7]",
            "[[6.4, 1.0e-7]",
            "line 18: $.identified.covariance[0]: preload has the standard error 2.53 here and std: 0.0008 where it "
            "stands; give both the same, or leave the covariance out",
        ),
    ],
)
def test_one_problem_is_one_sentence_with_its_line_and_path(old, new, said):
    assert GOOD.count(old) >= 1
    lines = problems(GOOD.replace(old, new, 1))
    assert any(line.startswith(f"m.yaml: {said}") for line in lines), lines
    others = [line for line in lines if not line.startswith(f"m.yaml: {said}")]
    related = ("is missing", "unknown key", "the model has no parameter", "covariance: must be")  # of a wrong name
    assert all(any(word in line for word in related) for line in others), others


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
    ("text", "said"),
    [
        ("", "holds no model"),
        ("# only a comment", "holds no model"),
        ("just text", "holds no model"),
        ("- 1\n- 2", "holds no model"),
        ("name: x", "has no 'format'"),
        ("format: dashpot-model/2", "says format 'dashpot-model/2'; this version of dashpot reads"),
        ("format: [1]", "says format a list"),
        ("format: null", "says format null"),
        ("a: [1, 2", "line 1: cannot be read as YAML"),
        ("a: b: c", "line 1: cannot be read as YAML: mapping values are not allowed here"),
        ("\tformat: x", "cannot be read as YAML"),
        ("a: 'x", "cannot be read as YAML"),
        ("--- 1\n--- 2", "line 2: cannot be read as YAML"),
        ("[" * 100_000, "nested more than 16 levels deep"),
        ("{a: " * 1000, "nested more than 16 levels deep"),
        ("- " * 5000, "nested more than 16 levels deep"),
        (LAUGHS, "line 2: cannot be read as YAML: aliases"),
        ("a: &a [*a]", "aliases"),
        ("a: !!python/object/apply:os.system ['echo']", "tags"),
        ("!!python/object/apply:os.system ['echo']", "tags"),
        ("a: !!python/name:os.system", "tags"),
        ("a: !!binary x", "tags"),
        ("!!set {a}", "tags"),
        ("? [a, b]\n: 1", "has no 'format'"),
        ("format: dashpot-model/1\n? {a: 1}\n: 1", "a key must be a word"),
        ("format: dashpot-model/1\n<<: {name: x}", "$['<<']: unknown key"),
        ('a: "\\UFFFFFFFF"', "cannot be read as YAML"),
        ('format: "\\ud800"', "says format '\\ud800'"),
        ("%YAML " + "9" * 5000 + ".1\n---\na", "cannot be read as YAML"),
        ("a\x00b", "has a character that text cannot contain"),
        ("x" * 1_000_001, "longer than 1000000 characters"),
    ],
)
def test_what_is_no_model_file_gets_one_sentence(text, said):
    with pytest.raises(BadInput) as caught:
        loads(text, "m.yaml")
    message = str(caught.value)
    assert message.startswith("m.yaml: ")
    assert said in message
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
