"""What made a result: the command as it was typed, versions, and the commit of a checkout and of nothing else."""

from __future__ import annotations

import subprocess
from dataclasses import replace
from importlib import metadata

import pytest
from dashpot import __version__
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.files import made_by as module
from dashpot.files.made_by import LONGEST_COMMAND, MadeBy, line_of, made_by, typed
from dashpot.identify.provenance import stamp
from dashpot.model import Oscillator
from dashpot.model.file import dumps, loads
from dashpot.model.oscillator import Provenance
from dashpot.report.blocks import Page


def test_it_names_the_versions_that_are_installed():
    made = made_by()
    assert made.software == f"dashpot {__version__}"
    assert {name: made.versions[name] for name in ("numpy", "scipy", "casadi")} == {
        name: metadata.version(name) for name in ("numpy", "scipy", "casadi")
    }
    assert made.command == ""


def test_the_command_is_as_it_was_typed_and_no_longer():
    with typed(line_of(["identify", "my rig.csv", "--name", "a\nb", "-o", "rig.yaml"])):
        assert made_by().command == "dashpot identify 'my rig.csv' --name 'a\ufffdb' -o rig.yaml"
        with typed(line_of(["x" * 5000])):
            assert len(made_by().command) == LONGEST_COMMAND
    assert made_by().command == ""


def git(folder, *words):
    line = ["git", "-C", folder, "-c", "user.name=n", "-c", "user.email=e@example.org", *words]
    return subprocess.run(line, check=True, capture_output=True, text=True).stdout.strip()


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    """A checkout in whose place the package lies; the cache of the answer is cleared."""
    git(tmp_path, "init", "-q")
    (tmp_path / "a.txt").write_text("a")
    git(tmp_path, "add", "a.txt")
    git(tmp_path, "commit", "-qm", "a")
    monkeypatch.setattr(module, "__file__", str(tmp_path / "files" / "made_by.py"))
    module._commit.cache_clear()
    yield tmp_path
    module._commit.cache_clear()


def test_the_commit_of_the_checkout_is_named(checkout, monkeypatch):
    commit = git(checkout, "rev-parse", "HEAD")
    monkeypatch.setenv("GIT_DIR", str(checkout / "no-such"))  # of a hook that runs us
    assert commit.startswith(made_by().commit)
    assert len(made_by().commit) == 12
    module._commit.cache_clear()
    (checkout / "a.txt").write_text("b")
    assert made_by().commit == f"{commit[:12]}-dirty"


def test_an_environment_within_a_checkout_of_something_else_has_none(checkout, monkeypatch):
    inner = checkout / ".venv" / "site-packages" / "dashpot" / "files"
    inner.mkdir(parents=True)
    monkeypatch.setattr(module, "__file__", str(inner / "made_by.py"))
    assert made_by().commit == ""
    assert MadeBy("dashpot 1").sentence() == "Made by dashpot 1."


def test_a_model_file_keeps_it():
    with typed("dashpot identify rec.csv -o 'rig 1.yaml'"):
        made = replace(Oscillator.from_values(TRUTH), identified=Provenance(method="maximum-likelihood", **stamp()))
    again = loads(dumps(made)).identified
    assert again.command == "dashpot identify rec.csv -o 'rig 1.yaml'"
    assert again.commit == made.identified.commit
    assert dict(again.versions) == dict(made.identified.versions)
    digits = replace(made, identified=Provenance(commit="123456789012", versions={"numpy": "2.4"}))
    assert (loads(dumps(digits)).identified.commit, loads(dumps(digits)).identified.versions) == (
        "123456789012",
        {"numpy": "2.4"},
    )


def test_a_file_with_something_else_there_is_refused():
    text = dumps(replace(Oscillator.from_values(TRUTH), identified=Provenance(**stamp())))
    with pytest.raises(BadInput, match=r"\$\.identified\.versions\.numpy: must be text, not 2"):
        loads(text.replace(f"numpy: {metadata.version('numpy')}", "numpy: 2"))


def test_pages_say_how_they_were_made():
    with typed(line_of(["identify", "a & b.csv"])):
        page = Page("A page", [], footer="All rows: rows.csv.").html
    footer = page.partition("<footer>")[2].partition("</footer>")[0]
    assert footer.startswith(f"All rows: rows.csv. Made by dashpot {__version__}")
    assert f"numpy {metadata.version('numpy')}" in footer
    assert footer.endswith("by: dashpot identify &#39;a &amp; b.csv&#39;.")
