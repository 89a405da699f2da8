"""The built-in rig, broken by a law: who breaks it, what is refused, and that the law is named."""

from __future__ import annotations

import json
import re
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner
from dashpot.commands.cli import cli
from dashpot.diagnose.result import Diagnosis, Effect
from dashpot.errors import BadInput
from dashpot.examples.broken import HELD_OUT, TRAINING, sizes
from dashpot.examples.truth import TRUTH
from dashpot.face import demo_broken
from dashpot.face.workflow import WRITING
from dashpot.model import oscillator_with
from dashpot.model.library import find


@pytest.mark.parametrize(
    ("law", "words"),
    [("dry-friction", "one of Eq. 17"), ("free/spring", "no physics to break"), ("quadratic-dragg", "quadratic-drag")],
)
def test_what_breaks_nothing_is_refused(law, words, tmp_path):
    with pytest.raises(BadInput, match=words):
        demo_broken.run(tmp_path, law, lambda line: None)
    assert list(tmp_path.iterdir()) == []


def test_recordings_of_somebody_else_stay(tmp_path):
    (tmp_path / "ringdown.csv.gz").write_bytes(b"mine")
    with pytest.raises(BadInput, match="was not made by a demo"):
        demo_broken.run(tmp_path, "quadratic-drag", lambda line: None)
    assert (tmp_path / "ringdown.csv.gz").read_bytes() == b"mine"


def test_a_law_that_the_independent_integrator_lacks_is_simulated_by_the_engine():
    law = find("gas-spring")
    assert not demo_broken._is_independent(law)
    assert demo_broken._is_independent(find("stiffness-drift/settling"))
    made = demo_broken._by_the_engine(law)
    assert [record.name for record in made] == [*TRAINING, *HELD_OUT]
    assert all(np.isfinite(record.shown).all() and np.std(record.shown) > 1e-4 for record in made)


def test_what_is_found_is_as_the_machine_has_it_and_per_unit_mass_as_it_was_hidden():
    law = "one-sided-stop"
    values = {f"{law}.stiffness": 9e4, f"{law}.position": 1.2e-3, f"{law}.damping": 0.0}
    model = oscillator_with({**TRUTH, **values}, [law])
    parameters = {name.partition(".")[2]: p for name, p in model.parameters().items() if name in values}
    effect = Effect(law, law, "stiffness", parameters)
    diagnosis = SimpleNamespace(model=model, of_machine=lambda effect: Diagnosis.of_machine(diagnosis, effect))
    lines = demo_broken._sizes_found(diagnosis, effect)
    assert lines[0].startswith(f"{law}.stiffness  24300 N/m (90000 1/s² per unit mass)")
    assert lines[1] == f"{law}.position  1.2 mm"


def test_the_command_breaks_and_names(tmp_path, monkeypatch):
    """Drag is named alone, with its size, and what is said can be typed again."""
    folder = tmp_path / "broken"
    stages: list[str] = []
    monkeypatch.setattr("dashpot.commands.cli.doing", stages.append)
    ended = CliRunner().invoke(cli, ["demo", "--break", "quadratic-drag", "-o", str(folder)])
    assert ended.exit_code == 0, ended.output
    assert "shares no code with dashpot: drag 5.938" in ended.output
    assert "quadratic-drag was hidden, and is named" in ended.output
    assert re.search(r"coefficient  \S+ ± \S+ N·s²/m² \(\S+ ± \S+ 1/m per unit mass\)", ended.output)
    assert "maximum likelihood, from prediction to simulation" in stages
    search = stages[stages.index("which physics does it lack?") + 1 : stages.index(WRITING)]
    assert len(search) > 5
    content = json.loads((folder / "diagnosis" / "diagnosis.json").read_text("utf-8"))
    (effect,) = content["effects"]
    coefficient = effect["parameters"]["coefficient"]
    assert abs(coefficient["value"] - sizes("quadratic-drag")["drag"]) < 4 * coefficient["std"]
    files = {path.name for path in folder.glob("*.csv.gz")}
    assert files == {f"{name}.csv.gz" for name in (*TRAINING, *HELD_OUT)}
    assert all(name in demo_broken.next_lines(folder) for name in files)
