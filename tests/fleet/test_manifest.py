"""Manifests: what they stand for, and what is said of those that cannot be used."""

from __future__ import annotations

import pytest
from dashpot.errors import BadInput
from dashpot.fleet.manifest import read_manifest


@pytest.fixture
def written(tmp_path):
    """``written(text, "a.csv", ...)``: a manifest beside empty files."""

    def make(text, *files):
        for name in files:
            (tmp_path / name).parent.mkdir(exist_ok=True)
            (tmp_path / name).write_text("x")
        path = tmp_path / "fleet.yaml"
        path.write_text(f"format: dashpot-fleet/1\n{text}")
        return path

    return make


def test_recordings_of_a_rig_make_one_model_with_the_options_of_both(written, tmp_path):
    path = written(
        "defaults: {unit: mm, fix: {dry: 0.0, cubic: 1.0}, with: [quadratic-drag], part: '1:'}\n"
        "rigs:\n"
        "  - {name: a, recordings: [x.csv, sub/y.csv], holdout: z.csv, unit: m, fix: {cubic: 2, friction: 0.1 N},\n"
        "     mass: 300 g, state: 5,\n"
        "     when: 2026-03-31, response: '*acc*', force-unit: kN, mode: 2, max-left: 5%, from: start.yaml}\n",
    )
    (entry,) = read_manifest(path).entries
    assert entry.recordings == (str(tmp_path / "x.csv"), str(tmp_path / "sub/y.csv"))
    assert entry.holdout == (str(tmp_path / "z.csv"),)
    assert entry.reading == {"unit": "m", "force_unit": "kN", "part": "1:", "response": ["*acc*"]}
    assert entry.how["fix"] == {"dry": 0.0, "cubic": 2.0, "friction": "0.1 N", "mass": "300 g"}
    assert (entry.how["with"], entry.how["mode"], entry.how["diagnose"]) == (["quadratic-drag"], "2", "unfit")
    assert (entry.rig, entry.state, entry.when) == ("a", "5", "2026-03-31T00:00:00+00:00")
    assert entry.start == str(tmp_path / "start.yaml")


def test_each_file_of_a_pattern_is_an_entry_in_the_order_of_numbers(written):
    path = written(
        "rigs: [{recordings: 'recs/*.csv*', each: true, name: w}]",
        *("recs/run10.csv", "recs/run9.csv.gz", "recs/other.txt"),
    )
    entries = read_manifest(path).entries
    assert [(entry.name, entry.rig) for entry in entries] == [("w-run9", "w"), ("w-run10", "w")]


@pytest.mark.parametrize(("content", "kept"), [('{"format": "dashpot-fleet-results/1"}', True), ("{}", False)])
def test_a_pattern_finds_no_folders_and_no_results_of_a_fleet(written, tmp_path, content, kept):
    path = written("rigs: [{recordings: '**/*.csv', each: true}]", "a.csv", "out/fleet.csv", "odd.csv/b.csv")
    (tmp_path / "out/fleet.json").write_text(content)
    assert {entry.name for entry in read_manifest(path).entries} == {"a", "b"} | (set() if kept else {"fleet"})


def test_parts_are_repeats_of_one_state(written):
    path = written("defaults: {part: '1:'}\nrigs: [{name: w, recordings: a.csv, parts: ['0:5', '5:10']}]")
    first, second = read_manifest(path).entries
    assert (first.name, first.rig, first.state, first.reading["part"]) == ("w-part1", "w", "w", "0:5")
    assert (second.name, second.state, second.reading["part"]) == ("w-part2", "w", "5:10")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("rigs: [{recordngs: a.csv, name: x}]", "line 2: $.rigs[0].recordngs: unknown key; did you mean recordings?"),
        ("rigs: [{recordngs: a.csv, name: x}]", r"$.rigs[0].recordings: is missing"),
        ("defaults: {forse: a}\nrigs: [{recordings: a.csv}]", "$.defaults.forse: unknown key; did you mean force?"),
        ("rig: [{recordings: a.csv}]", "$.rig: unknown key; did you mean rigs?"),
        ("rigs: [{recordings: '/**/*.csv', name: x}]", "'/**/*.csv' would search every folder of the disk; begin"),
        ("rigs: [{recordings: 'no/*.csv', name: x}]", "no file matches 'no/*.csv'"),
        ("rigs: [{recordings: [a.csv, b.csv]}]", "needs a name"),
        ("rigs: [{recordings: a.csv}, {name: A, recordings: b.csv}]", "two entries are called"),
        ("rigs: [{recordings: a.csv, with: [quadratic-drg]}]", "quadratic-drag"),
        ("rigs: [{recordings: a.csv, max-left: 5}]", "must be text"),
        ("rigs: [{recordings: a.csv, max-left: '5'}]", "neither a share of the motion"),
        ("rigs: [{recordings: a.csv, when: soon}]", "cannot read 'soon'"),
        ("rigs: [{recordings: a.csv, when: 1}, {recordings: b.csv, when: 2026-01-01}]", "one or the other"),
        ("rigs: [{recordings: a.csv, diagnose: maybe}]", "'unfit', 'never' or 'always'"),
        ("rigs: [{recordings: a.csv, part: '1:', parts: ['1:2']}]", "keep one of them"),
        ("rigs: [{recordings: a.csv, part: '2:1'}]", "part '2:1' is not understood"),
        ("rigs: []", "empty list"),
        ("rigs: [{recordings: a.csv, fix: {dry: none}}]", "$.rigs[0]: dry is 'none'; give a number, or a text"),
        ("rigs: [{recordings: a.csv, each: yes}]", "must be true or false"),
    ],
)
def test_what_is_wrong_is_said_with_its_place(written, text, says):
    with pytest.raises(BadInput) as problem:
        read_manifest(written(text))
    assert says in str(problem.value)


def test_another_file_is_no_manifest(tmp_path):
    path = tmp_path / "rig.yaml"
    path.write_text("format: dashpot-model/1\n")
    with pytest.raises(BadInput, match="write 'format: dashpot-fleet/1'"):
        read_manifest(path)
    with pytest.raises(BadInput, match="cannot be read"):
        read_manifest(tmp_path / "absent.yaml")
