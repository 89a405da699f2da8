"""Laws of a user's own: the example of docs/laws.md, and everything that can be wrong with such a file."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from dashpot.commands.cli import main
from dashpot.errors import BadInput
from dashpot.model import Oscillator, law_trial, oscillator_with
from dashpot.model import user_laws as user
from dashpot.model.describing import equivalent_stiffness
from dashpot.model.effect_words import effect_in_words
from dashpot.model.file import save
from dashpot.model.library import KNOWN
from dashpot.model.user_laws import load_law_file

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = re.findall(r"```python\n(.*?)```", (ROOT / "docs/laws.md").read_text(encoding="utf-8"), re.DOTALL)[0]


pytestmark = pytest.mark.usefixtures("library")


@pytest.fixture
def write(tmp_path):
    def to(text, name="magnet.py"):
        (tmp_path / name).write_text(text, encoding="utf-8")
        return tmp_path / name

    return to


PLAIN = {"mass": 0.3, "omega0": 60.0, "cubic": 0.0, "preload": 0.0, "viscous": 3.0, "dry": 0.0}


def magnet():
    return oscillator_with({**PLAIN, "magnet.strength": 20.0, "magnet.reach": 5e-3}, effects=("magnet",))


def test_the_example_becomes_part_of_the_library(write):
    (law,) = load_law_file(write(EXAMPLE))
    assert KNOWN["magnet"] is law
    small = equivalent_stiffness(magnet(), np.array([1e-5]), 60.0)
    assert small == pytest.approx([60.0**2 + 20.0 / 5e-3], rel=1e-4)
    assert load_law_file(write(EXAMPLE)) == (law,)  # again: the same


def test_every_command_takes_it(write, tmp_path, capsys):
    path = str(write(EXAMPLE))
    load_law_file(path)
    save(magnet(), tmp_path / "rig.yaml")
    KNOWN.pop("magnet")
    user._loaded.clear()
    rig = str(tmp_path / "rig.yaml")
    main(["show", rig, "--law", path])
    assert "strength x / reach exp(-(x / reach)²)" in capsys.readouterr().out
    main(["export", rig, str(tmp_path / "rig.fmu"), str(tmp_path / "rig.casadi"), "--law", path])
    time = np.arange(400) * 2e-3
    rows = "\n".join(f"{t:.6g},{np.sin(60 * t):.9g},{1e-3 * t * np.cos(60 * t):.9g}" for t in time)
    (tmp_path / "force.csv").write_text(f"time_s,force_N,displacement_m\n{rows}\n")
    main(["simulate", rig, str(tmp_path / "force.csv"), "-o", str(tmp_path / "out.csv"), "--law", path])
    assert (tmp_path / "out.csv").is_file()


def test_without_its_file_the_model_is_refused(write, tmp_path, capsys):
    load_law_file(write(EXAMPLE))
    save(magnet(), tmp_path / "rig.yaml")
    KNOWN.pop("magnet")
    with pytest.raises(SystemExit) as ended:
        main(["show", str(tmp_path / "rig.yaml")])
    assert ended.value.code == 2
    assert "'magnet' is not in the library of laws" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('name="magnet"', 'name="viscoelastic"'),
        ('name="magnet"', 'name="My Magnet"'),
        ('path="restoring"', 'path="spring"'),
        ("force=pull,", ""),
        ("force=pull,", "force=pull, drive=pull,"),
        ('source="a dipole\'s field near its axis, fitted by a bell"', 'source=""'),
        ('"force per unit mass at the reach, times e"', '" "'),
        ('"X/s2"', '"N/kg"'),
        ('"X/s2"', '"X//s"'),
        ("lower=1e-9, probes=(0.1, 0.3, 1.0)", "lower=1.0, upper=0.0, probes=(0.1,)"),
        ("lower=1e-9, probes=(0.1, 0.3, 1.0)", "lower=1e-9"),
        ("{strength} x / {reach}", "{power} x / {reach}"),
        ("{strength} x / {reach}", "x / {reach}"),
        ('p["strength"]', 'p["strenth"]'),
        ("return p", "q = motion.state('q', 'X'); return q * p"),
        ("return p", "return ca.vertcat(1, 2) * p"),
        ("force=pull,", "record=pull,"),
        ('return p["strength"] * p["reach"]', 'return ca.vertcat(1, 2) * p["reach"]'),
        ('p["reach"] / 2', "p['reach'] * motion.sign(motion.x - p['reach'])"),
        ('p["reach"] / 2', "motion.inner('q')"),
        ("return p", "return ca.SX.sym('mu') * p"),
        ("return p", "return ca.sign(motion.v) * p"),
        ("return p", "return ca.fabs(motion.x) * p"),
        ("return p", "return abs(motion.v) * p"),
        ("return p", "return ca.fmax(motion.x, 0) * p"),
        ("return p", "return ca.if_else(motion.x > 0, 1, 2) * p"),
        ("return p", "return 1 / motion.v * p"),
        ("return p", "return ca.sqrt(motion.x) * p"),
        ("return p", "return ca.log(motion.v) * p"),
        ("return p", "return 'text' or p"),
        ("return p", "return None and p"),
        ("return p", "return 1e400 * p"),
        ('return p["strength"] * p["reach"] / 2', "return ca.SX.sym('mu')"),
        ("lower=1e-9,", "lower=0.0,"),
        ('"reach", "X"', '"reach", "X2"'),
        ('"X/s2"', '"X/s"'),
        ('motion.x / p["reach"] * ca', "motion.x / 5e-3 * ca"),
        ('p["reach"] / 2', "p['reach'] ** 2 / 2"),
        ("return p", "q = motion.state('q', 'X'); motion.rate(q, motion.x - q); return q / p['reach'] * p"),
        ('name="magnet"', "name=3"),
        ('name="magnet"', "name=['magnet']"),
        ('path="restoring"', "path=None"),
        ("force=pull,", "force=3,"),
        ("    parameters=(", "    parameters='strength' or ("),
        ("    parameters=(", "    parameters=('strength',) or ("),
        ("lower=1e-9,", "lower='0',"),
        ("probes=(0.1, 0.3, 1.0)", "probes=0.1"),
        ("probes=(0.1, 0.3, 1.0)", "probes=(0.1,), size=3"),
        ("probes=(0.1, 0.3, 1.0)", "probes=(0.1,), in_radians='one'"),
        ("probes=(0.1, 0.3, 1.0)", "probes=(0.1,), size=len"),
        ('"X/s2"', "7"),
        ("import casadi as ca\n", "import casadi as ca\n  x\n"),
        ("LAW = Law(", "1 / 0\nLAW = Law("),
        ("LAW = Law(", "raise SystemExit(3)\nLAW = Law("),
        ("LAW = Law(", "LAW = dict("),
    ],
)
def test_what_is_wrong_is_said_with_its_place(old, new, reads, write):
    assert old in EXAMPLE
    before = dict(KNOWN)
    path = write(EXAMPLE.replace(old, new, 1))
    with pytest.raises(BadInput) as caught:
        load_law_file(path)
    said = str(caught.value)
    assert said.startswith(f"{path}")
    # an exception's own words are Python's or CasADi's
    reads(re.sub(r"(Error\b:?).*(;|\))", r"\1 ...\2", said.replace(f"{path}", path.name, 1), flags=re.DOTALL))
    assert before == KNOWN


def test_a_file_that_is_none_is_said(tmp_path, write):
    with pytest.raises(BadInput, match="cannot be read"):
        load_law_file(tmp_path / "missing.py")
    (tmp_path / "bytes.py").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(BadInput, match="is not UTF-8 text"):
        load_law_file(tmp_path / "bytes.py")
    path = write(EXAMPLE)
    load_law_file(path)
    path.write_text(EXAMPLE + "\n# changed\n")
    with pytest.raises(BadInput, match="start Python again"):
        load_law_file(path)


def test_a_bad_file_ends_the_command_with_code_two(write, tmp_path, capsys):
    save(Oscillator.from_values(PLAIN), tmp_path / "rig.yaml")
    with pytest.raises(SystemExit) as ended:
        main(["show", str(tmp_path / "rig.yaml"), "--law", str(write("LAW = 1 +", "bad.py"))])
    assert ended.value.code == 2
    assert "bad.py, line 1: not Python" in capsys.readouterr().err


def test_a_law_of_ones_own_is_said_by_its_phrase_and_without_one_by_its_sentence(write):
    load_law_file(write(EXAMPLE))
    assert effect_in_words("magnet") == "a magnet that pulls the mass back to its seat (magnet)"
    KNOWN.pop("magnet")
    user._loaded.clear()
    lines = [line for line in EXAMPLE.splitlines() if not line.strip().startswith("phrase=")]
    (law,) = load_law_file(write("\n".join(lines), "plain.py"))
    assert law.phrase == ""
    assert effect_in_words("magnet").startswith("a magnet that pulls the mass back to its seat, the less")


@pytest.mark.parametrize("phrase", ["a magnet, strong", "a magnet.", "two\nlines", " a magnet", "(magnet)", "a: b", 3])
def test_a_phrase_that_would_not_read_in_a_list_is_refused(phrase):
    (problem,) = law_trial.problems(replace(KNOWN["stribeck"], phrase=phrase))
    assert "phrase" in problem
    assert "leave it out" in problem


def test_the_library_keeps_to_the_trial():
    """But for kinks that no motion of the rig goes through at speed: those laws are ours, and tested one by one."""
    import casadi as ca
    from dashpot.model.law import Motion
    from dashpot.model.law_trial import fault, wrong_types

    for law in KNOWN.values():
        motion = Motion(x=ca.SX.sym("x"), v=ca.SX.sym("v"), t=ca.SX.sym("t"))
        own = {p.name: ca.SX.sym(p.name) for p in law.parameters}
        signal = ca.SX.sym("signal")
        made = law.force or law.drive or law.record
        expression = ca.SX(made(motion, own) if law.force else made(motion, own, signal))
        said = fault(law, motion, own, signal, expression, law_trial._SCALES)
        assert not said or "of the motion, which is located by nothing" in said, (law.name, said)
        assert not list(wrong_types(law))
