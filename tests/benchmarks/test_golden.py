"""The golden set: what comparing finds, and that a case is run on the tree that is meant."""

from __future__ import annotations

import copy
import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
sys.path.append(str(BENCHMARKS))

import golden  # noqa: E402  (it lies beside the package, not in it)
from golden_compare import compare_case, differences, number, plain  # noqa: E402

RESULT = {
    "model": {
        "parameters": {"mass": {"value": 0.27, "std": 1e-4}, "dry": {"value": 1e-12, "std": 2e-3}},
        "identified": {"covariance": [[1e-8, 1e-15], [1e-15, 4e-6]], "log_likelihood": 1234.5},
    },
    "verdict": "consistent",
    "notes": ["the force is held", "viscous is known to 75 % only"],
    "initial": np.array([0.5, -0.25]),
    "samples": 400,
}


def result(**changed):
    """The result as it is kept, with other values at paths such as ``model.parameters.mass.value``."""
    made = copy.deepcopy(RESULT)
    for path, value in changed.items():
        *way, last = path.split(".")
        inside = made
        for step in way:
            inside = inside[step]
        inside[last] = value
    return plain(made)


def found(before, after, **options):
    return {difference.path: difference for difference in differences(before, after, **options)}


def test_floats_are_kept_to_the_last_bit():
    numbers = [0.1, -1e-310, 0.0, -0.0, math.inf, -math.inf, 1e300]
    kept = json.loads(json.dumps(plain({"a": numbers})))["a"]
    assert [number(word) for word in kept] == numbers
    assert math.copysign(1.0, number(kept[3])) == -1.0
    assert math.isnan(number(plain(math.nan)))


@pytest.mark.parametrize("word", ["consistent", "", "infinite", "0x1 of it", True, None])
def test_what_is_no_number_is_none(word):
    assert number(plain(word)) is None


def test_the_same_is_equal():
    assert not found(result(), result())
    assert compare_case("one", result(), result(), 0.0).line == "equal"


def test_one_bit_of_a_number_is_found():
    other = result(**{"model.parameters.mass.value": float(np.nextafter(0.27, 1.0))})
    (difference,) = found(result(), other).values()
    assert difference.path == "model.parameters.mass.value"
    assert difference.size == pytest.approx(2.06e-16, rel=0.01)
    assert compare_case("one", result(), other, 1e-10).same
    exact = compare_case("one", result(), other, 0.0)
    assert not exact.same
    assert "2.1e-16 at model.parameters.mass.value" in exact.line


@pytest.mark.parametrize(
    ("path", "value", "where"),
    [
        ("model.parameters.mass.std", 1.1e-4, "model.parameters.mass.std"),
        ("model.identified.log_likelihood", 1234.6, "model.identified.log_likelihood"),
        ("model.identified.covariance", [[1e-8, 1e-10], [1e-15, 4e-6]], "model.identified.covariance[0][1]"),
        ("model.identified.covariance", [[1e-8, 1e-15]], "model.identified.covariance[1][1]"),
        ("initial", [0.5], "initial[1]"),
        ("initial", [0.5, math.nan], "initial[1]"),
        ("samples", 401, "samples"),
        ("samples", None, "samples"),
        ("verdict", "unexplained", "verdict"),
        ("notes", ["the force is held", "viscous is known to 76 % only"], "notes[1]"),
        ("further", 1.0, "further"),
    ],
)
def test_what_has_changed_is_found(path, value, where):
    for before, after in ((result(), result(**{path: value})), (result(**{path: value}), result())):
        assert where in found(before, after)
        compared = compare_case("one", before, after, 1e-10)
        assert not compared.same
        assert compared.line.startswith("DIFFERS")


def test_a_missing_key_is_found():
    without = result()
    del without["model"]["parameters"]["dry"]
    (difference,) = found(result(), without).values()
    assert (difference.path, difference.size) == ("model.parameters.dry", math.inf)
    assert "(absent)" in str(difference)


def test_a_parameter_is_measured_by_its_error_and_a_covariance_by_its_diagonal():
    nothing = result(
        **{
            "model.parameters.dry.value": 3e-12,
            "model.identified.covariance": [[1e-8, 2e-15], [2e-15, 4e-6]],
        }
    )
    sizes = {path: difference.size for path, difference in found(result(), nothing).items()}
    assert sizes["model.parameters.dry.value"] == pytest.approx(2e-12 / 2e-3)
    assert sizes["model.identified.covariance[0][1]"] == pytest.approx(1e-15 / math.sqrt(1e-8 * 4e-6))


def test_sentences_can_be_left_out_and_names_not():
    said = result(notes=["the force stays from sample to sample", "viscous is known to 75 % only"])
    assert found(result(), said)
    assert not found(result(), said, numbers=True)
    assert found(result(), result(verdict="unexplained"), numbers=True)


def test_an_error_and_a_missing_case_never_pass():
    error = {"error": "TypeError: no"}
    assert not compare_case("one", error, error, 1.0).same
    assert not compare_case("one", None, result(), 1.0).same
    assert not compare_case("one", result(), None, 1.0).same


def written(folder, name, cases):
    file = folder / name
    golden.save(file, {"format": golden.FORMAT, "cases": cases})
    return str(file)


def test_two_files_are_compared(tmp_path, capsys):
    before = written(tmp_path, "a.json", {"decay": result(), "refused": {"refused": "record more of it"}})
    after = written(tmp_path, "b.json", {"decay": result(samples=401), "refused": {"refused": "record longer"}})
    assert golden.main(["--compare", before, before]) == 0
    assert "2 cases: 2 equal, 0 within 1e-10, 0 differ" in capsys.readouterr().out
    assert golden.main(["--compare", before, after, "--exact"]) == 1
    said = capsys.readouterr().out
    assert "samples: 400.0 -> 401.0" in said
    assert "refused: record more of it -> record longer" in said
    assert golden.main(["--compare", before, after, "--numbers", "--tolerance", "0.1"]) == 0
    (tmp_path / "c.json").write_text("[]")
    with pytest.raises(SystemExit, match="is no file of this program"):
        golden.main(["--compare", before, str(tmp_path / "c.json")])


def test_only_names_what_there_is():
    names = ["decay one", "decay two", "sweep"]
    assert golden.chosen(names, []) == names
    assert golden.chosen(names, ["decay"]) == names[:2]
    with pytest.raises(SystemExit, match="no case begins with 'x'"):
        golden.chosen(names, ["x"])


def test_a_case_is_recorded_of_this_tree_and_what_is_known_is_not_run_again(tmp_path):
    file = tmp_path / "made.json"
    assert golden.main(["--record", str(file), "--only", "decay of a known mass", "refused: no such law"]) == 0
    made = golden.load(file)
    decay, refused = made["cases"].values()
    assert number(decay["model"]["parameters"]["omega0"]["value"]) == pytest.approx(79.6, rel=1e-3)
    assert refused["refused"].startswith("effect 'quadratic' is not in the library")
    known = {**made, "cases": {"decay of a known mass": {"kept": 1}}}
    with golden.folder_above(golden.ROOT) as above:
        again = golden.run_tree(above, ["decay of a known mass", "refused: no such law"], known, "again")
    assert again["cases"] == {"decay of a known mass": {"kept": 1}, "refused: no such law": refused}
