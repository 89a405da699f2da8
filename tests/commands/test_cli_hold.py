"""``--hold``: said once, kept in the model file, honoured by every command behind it."""

from __future__ import annotations

import json

import numpy as np
import pytest
from dashpot.commands.cli import main
from dashpot.examples.force import chirp
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.model.file import load

FS, N = 400.0, 6000
NOISE = 2e-6


@pytest.fixture
def held(tmp_path):
    """A sweep of the paper's stand whose force is held from sample to sample."""
    force = chirp(1.0, 8.0, 10.0 * FS / N, np.arange(N) / FS, 1 / FS)[:, 0]
    x = integrate_pieces(TRUTH, force[:-1, None], 1 / FS)[0] + NOISE * np.random.default_rng(3).standard_normal(N)
    path = tmp_path / "held.csv"
    table = np.column_stack([np.arange(N) / FS, force, x])
    np.savetxt(path, table, "%.9g", ",", header="time_s,force_N,displacement_m", comments="")
    return path


def remainder(path):
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    return np.sqrt(np.mean((table[:, 3] - table[:, 2]) ** 2))


def test_a_hold_goes_from_the_option_into_the_model_and_on(tmp_path, held, capsys):
    model, out = tmp_path / "rig.yaml", tmp_path / "out.csv"
    main(["identify", str(held), "-o", str(model), "--hold", "zero"])
    assert load(model).hold == "zero"
    assert "fitted so" not in capsys.readouterr().err  # it was said, not found
    main(["show", str(model), "--json"])
    assert json.loads(capsys.readouterr().out)["excitation"] == {"unit": "N", "hold": "zero"}
    main(["simulate", str(model), str(held), "-o", str(out)])
    assert remainder(out) < 1.1 * NOISE
    main(["simulate", str(model), str(held), "-o", str(out), "--hold", "smooth"])
    assert remainder(out) > 10 * NOISE


def test_a_hold_nobody_knows_is_refused(tmp_path, held, capsys):
    with pytest.raises(SystemExit) as stopped:
        main(["identify", str(held), "-o", str(tmp_path / "rig.yaml"), "--hold", "cubic"])
    assert stopped.value.code == 2
    assert "zero" in capsys.readouterr().err
