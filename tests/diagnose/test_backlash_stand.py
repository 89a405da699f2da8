"""The paper's own omission: Eq. 17 on the stand whose actuator has play, by the commands, from CSV files alone."""

from __future__ import annotations

import json

import numpy as np
import pytest
from dashpot.commands.cli import main
from dashpot.examples import recordings
from dashpot.examples.truth import ACTUATOR

TRAIN = ("bursts", "sweep_low", "sweep_high")


@pytest.mark.long
@pytest.mark.parametrize("kinds", [TRAIN, TRAIN[:1]], ids=["bursts and sweeps", "bursts alone"])
def test_the_backlash_that_the_paper_leaves_out_is_named_and_mended(tmp_path, capsys, kinds):
    """Bursts alone say nothing of it in a regression on the measured motion: its probes are predicted.

    The likelihood of bursts alone has many valleys beside the deepest, which differ in the last digits of a
    processor: what the model still lacks is then held to 2 % of what it lacked, where the sweeps give the floor.
    """
    files = {kind: str(path) for kind, path in recordings("paper-stand-backlash").items()}
    train = [files[kind] for kind in kinds]
    rig, folder = str(tmp_path / "rig.yaml"), tmp_path / "diagnosis"
    main(["identify", *train, "-o", rig])
    capsys.readouterr()
    main(["diagnose", rig, *train, "--holdout", files["multisine"], "-o", str(folder)])
    said = " ".join(capsys.readouterr().out.split())
    document = json.loads((folder / "diagnosis.json").read_text("utf-8"))
    assert document["verdict"] == "missing-physics"
    assert [effect["effect"] for effect in document["effects"]] == ["actuator-backlash"]
    assert document["effects"][0]["indistinguishable_from"] == []
    assert "play between actuator and mass (actuator-backlash)" in said
    # the held-out multisine, run as an FMU
    (held,) = document["fit"]["holdout"]
    assert held["nrmse_before"] > 10 * held["noise_floor"]
    lacking = {
        when: np.sqrt(max(held[when] ** 2 - held["noise_floor"] ** 2, 0.0)) for when in ("nrmse_before", "nrmse_after")
    }
    assert lacking["nrmse_after"] < 0.02 * lacking["nrmse_before"]
    if kinds == TRAIN:
        assert held["nrmse_after"] < 1.05 * held["noise_floor"]
    assert (folder / "model.fmu").stat().st_size > 0
    found = document["effects"][0]["parameters"]
    for name, true in (("gap", ACTUATOR["half_gap"]), ("mass", ACTUATOR["moving_mass"])):
        assert found[name]["value"] == pytest.approx(true, rel=0.02), name
