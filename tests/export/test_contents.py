"""The model file inside an FMU makes the same model again."""

from __future__ import annotations

import zipfile
from dataclasses import replace

import pytest
from dashpot.export.contents import further_contents, model_file
from dashpot.export.description import describe_fmu
from dashpot.export.facts import Facts
from dashpot.model import Parameter, Provenance, Range
from dashpot.model.file import dumps, load, loads


def test_it_loads_again_identical_and_lies_in_the_archive(fmus, models, tmp_path):
    facts = Facts(models["drag"]())
    for backend in ("native", "python"):
        with zipfile.ZipFile(fmus("drag", backend)) as archive:
            text = archive.read("resources/model.yaml").decode()
            assert set(further_contents(facts, describe_fmu(facts))) < set(archive.namelist())
        assert text == dumps(models["drag"]())
        (tmp_path / "model.yaml").write_text(text, encoding="utf-8")
        again = load(tmp_path / "model.yaml")
        assert again == models["drag"]()


@pytest.mark.parametrize(
    "name", ["", "x" * 500, '"; system("x"); //', "a\nb\tc\x00\x1b\ud800\ufffe", "Prüfstand №5", "int"]
)
def test_a_name_of_any_kind_leaves_a_file_that_loads(models, name):
    odd = Parameter(0.1 + 0.2, 2.5e-3, "m/s2")
    model = replace(
        models["base"]().with_parameters({"dry": odd}),
        name=name,
        amplitude=Range(2e-4, 9e-3, "m"),
        identified=Provenance(
            recordings=({"file": "sweep.csv", "sha256": "0" * 64, "kind": "sweep"},),
            method="maximum-likelihood",
            software="dashpot 0.1.0",
            parameters=("dry",),
            covariance=((6.25e-6,),),
            log_likelihood=-1.0 / 3.0,
        ),
    )
    text = model_file(model)["resources/model.yaml"].decode()
    again = loads(text)
    assert replace(again, name=name) == model
    assert dumps(again) == text
