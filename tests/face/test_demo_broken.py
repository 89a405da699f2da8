"""The built-in rig, broken by a law: who breaks it, what is refused, and that the law is named."""

from __future__ import annotations

import json

import numpy as np
import pytest
from click.testing import CliRunner
from dashpot.commands.cli import cli
from dashpot.errors import BadInput
from dashpot.examples.broken import HELD_OUT, TRAINING, sizes
from dashpot.face import demo_broken
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


def test_the_command_breaks_and_names(tmp_path):
    """Drag is named alone, with its size, and what is said can be typed again."""
    folder = tmp_path / "broken"
    ended = CliRunner().invoke(cli, ["demo", "--break", "quadratic-drag", "-o", str(folder)])
    assert ended.exit_code == 0, ended.output
    assert "shares no code with dashpot: drag 5.938" in ended.output
    assert "quadratic-drag was hidden, and is named" in ended.output
    content = json.loads((folder / "diagnosis" / "diagnosis.json").read_text("utf-8"))
    (effect,) = content["effects"]
    coefficient = effect["parameters"]["coefficient"]
    assert abs(coefficient["value"] - sizes("quadratic-drag")["drag"]) < 4 * coefficient["std"]
    files = {path.name for path in folder.glob("*.csv.gz")}
    assert files == {f"{name}.csv.gz" for name in (*TRAINING, *HELD_OUT)}
    assert all(name in demo_broken.next_lines(folder) for name in files)
