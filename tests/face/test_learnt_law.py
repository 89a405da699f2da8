"""A learnt curve as a law file: refused before any work, written where there is a form, loaded again."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest
from dashpot.errors import BadInput
from dashpot.face.learnt_law import law_name, write_law
from dashpot.model import Parameter
from dashpot.model.formula.closed_form import ClosedForm
from dashpot.model.user_laws import load_law_file

CONSTANTS = {"c0": Parameter(6340.0, 2.0, "1/s2"), "c1": Parameter(1.2, 0.1, "m/s2"), "a1": Parameter(3e-3, 1e-4, "m")}
FORM = ClosedForm("free/spring", ("tanh",), CONSTANTS, True, 0.0, 9e-3)


def found(*forms: ClosedForm, effects: tuple[str, ...] = ("free/spring",)) -> SimpleNamespace:
    identified = SimpleNamespace(recordings=({"file": "sweep.csv"},))
    return SimpleNamespace(
        forms=forms,
        effects=[SimpleNamespace(effect=name) for name in effects],
        model=SimpleNamespace(identified=identified),
    )


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("My Spring.py", "is no name for a law file; give small letters, digits and hyphens before .py"),
        ("my-spring.txt", "is no name for a law file"),
        ("stribeck.py", "there is a law 'stribeck' already; give the file another name, as my-stribeck.py"),
        ("free.py", ""),
    ],
)
def test_a_name_that_no_law_can_have_is_refused(tmp_path: Path, name, words):
    if not words:
        assert law_name(tmp_path / name) == "free"
        return
    with pytest.raises(BadInput, match=words):
        law_name(tmp_path / name)


def test_another_s_file_is_left_alone(tmp_path: Path):
    file = tmp_path / "my-spring.py"
    file.write_text("print('mine')\n", encoding="utf-8")
    with pytest.raises(BadInput, match="my-spring"):
        write_law(file, found(FORM))
    assert file.read_text(encoding="utf-8") == "print('mine')\n"


@pytest.mark.usefixtures("library")
def test_the_shortest_form_becomes_a_law_that_loads(tmp_path: Path):
    file = tmp_path / "learnt-spring-tried.py"
    said = write_law(file, found(FORM))
    assert said.startswith(f"written: {file}, the law learnt-spring-tried: c0 x + c1 tanh(x/a1)")
    assert write_law(file, found(FORM)).startswith("written")  # its own file is written anew
    (law,) = load_law_file(file)
    assert [(p.name, p.unit, p.strength) for p in law.parameters] == [("c1", "X/s2", True), ("a1", "X", False)]
    assert law.parameters[1].probes == pytest.approx((1 / 6, 1 / 3, 2 / 3), rel=1e-2)
    assert "sweep.csv" in file.read_text(encoding="utf-8").splitlines()[0]


@pytest.mark.parametrize(
    ("effects", "why"), [(("free/spring",), "no closed form of two pieces"), (("stribeck",), "nothing was learnt")]
)
def test_where_there_is_none_nothing_is_written_and_why_is_said(tmp_path: Path, effects, why):
    file = tmp_path / "my-spring.py"
    assert why in write_law(file, found(effects=effects))
    assert not file.exists()
