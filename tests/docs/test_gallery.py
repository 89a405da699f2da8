"""The pages that are worked out when the site is built, what runs them, and the pictures of README and home page."""

from __future__ import annotations

import importlib.util
import re
import shlex
import sys
from pathlib import Path

import numpy as np
import pytest
from dashpot.commands.cli import cli
from dashpot.model.laws import LIBRARY
from dashpot.report.law_page import law_page

ROOT = Path(__file__).resolve().parents[2]
GALLERY = sorted(ROOT.glob("docs/gallery/*.md"))


def loaded(name: str):
    spec = importlib.util.spec_from_file_location(f"site_{name}", ROOT / f"docs/site/{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # where its dataclasses look for their names
    spec.loader.exec_module(module)
    return module


worked = loaded("worked")
RAMP = """# Is it there?

```python
import numpy as np

t = np.arange(1000) / 500.0
x = 5e-3 * np.exp(-2.5 * t) * np.cos(79.6 * t)
np.savetxt("decay.csv", np.column_stack([t, x]), delimiter=",", header="time_s,x_m", comments="")
```

```console
dashpot look decay.csv
dashpot look absent.csv # exit code 2
```
<!-- says: ^motion | does not exist -->

The end.
"""


def test_each_page_has_a_question_a_wrong_turn_and_marks_behind_its_commands():
    assert len(GALLERY) >= 8
    for page in GALLERY:
        text = page.read_text("utf-8")
        assert re.match(r"# .+(\?|believe it)\n", text), page
        assert "## The wrong turn" in text or "When not" in text, page
        blocks = re.findall(r"```console\n.*?```\n(.*)", text, re.DOTALL)
        assert blocks, page
        for after in re.split(r"```console\n.*?```\n", text, flags=re.DOTALL)[1:]:
            assert after.startswith("<!-- says: "), page


@pytest.mark.parametrize("page", GALLERY, ids=lambda page: page.stem)
def test_its_commands_and_options_exist(page):
    for block in re.findall(r"```console\n(.*?)```", page.read_text("utf-8"), re.DOTALL):
        for line in worked.lines(block):
            words = shlex.split(line, comments=True)
            assert words[0] == "dashpot", line
            known = {name for option in cli.commands[words[1]].params for name in option.opts}
            assert {word for word in words if word.startswith("-")} <= known, line


def test_a_page_is_run_in_an_empty_folder_and_shows_what_was_printed():
    made = worked.run(RAMP, "ramp.md")
    assert len(made.printed) == 1
    assert made.printed[0].startswith("$ dashpot look decay.csv\n")
    shown = worked.shown(RAMP, "ramp.md", made)
    assert "says:" not in shown
    short, folded = re.search(r"```text\n(.*?)```.*?<pre>(.*?)</pre>", shown, re.DOTALL).groups()
    assert short.split()[:2] == ["motion", "decay"]
    assert "absent.csv does not exist" in short
    assert "sampling" in folded
    assert "sampling" not in short
    assert shown.endswith("The end.\n")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("^motion", "^multisine", "'\\^multisine' not printed"),
        (" # exit code 2", "", "ended with 2 where 0 is said"),
        ("<!-- says: ^motion | does not exist -->", "<!-- picture: a.svg | it -->", "no command has drawn a.svg"),
    ],
)
def test_a_page_that_says_something_else_is_refused(old, new, words):
    with pytest.raises(worked.Differs, match=words):
        worked.run(RAMP.replace(old, new), "ramp.md")


def test_a_line_begins_with_a_whole_word():
    assert worked._holds("  dry  0.1", "^dry")
    assert not worked._holds("  drying 0.1", "^dry")
    assert worked._holds("a drying rack", "drying")
    assert worked._picked("note: much is left\n  - much is left.\nelse", "is left") == ["note: much is left"]


def test_what_a_page_gave_is_taken_from_an_earlier_build(tmp_path, monkeypatch):
    calls = []
    monkeypatch.setattr(worked, "KEPT", tmp_path / "kept")
    monkeypatch.setattr(worked, "_sources", lambda: "the same")
    monkeypatch.setattr(worked, "run", lambda text, name: calls.append(name) or worked.Worked([text], {}, {"a": ["b"]}))
    page = tmp_path / "ramp.md"
    for text in ("one\n", "one\n", "two\n"):
        page.write_text(text, "utf-8")
        assert worked.worked([page])["ramp"] == worked.Worked([text], {}, {"a": ["b"]})
    assert calls == ["ramp.md", "ramp.md"]
    assert len(list((tmp_path / "kept").iterdir())) == 1  # what no page is any more is gone


def test_the_page_of_a_law_lists_where_it_was_named():
    law = LIBRARY["quadratic-drag"]
    text = law_page(law, "it.svg", {"[Is it drag?](../gallery/it.md)": ["a.csv", "b.csv"]})
    assert "## Where it was named" in text
    assert "- [Is it drag?](../gallery/it.md): `a.csv`, `b.csv`" in text
    assert "Where it was named" not in law_page(law, "it.svg")


home = loaded("home_pictures")


def test_readme_and_home_page_have_three_small_pictures():
    for page, folder in (("README.md", "docs/"), ("docs/index.md", "")):
        text = (ROOT / page).read_text("utf-8")
        named = re.findall(r"!\[[^\]]+\]\((\S+\.svg)\)", text)
        assert named == [f"{folder}{name}" for name in home.PICTURES], page
    for name in home.PICTURES:
        assert 5e3 < (ROOT / "docs" / name).stat().st_size < 60e3, name


def numbers_of(svg: str) -> np.ndarray:
    """All coordinates of the drawing."""
    paths = re.findall(r' d="([^"]+)"', svg)
    return np.array([float(number) for path in paths for number in re.findall(r"-?\d+\.?\d*", path)])


@pytest.mark.long
def test_the_pictures_are_what_the_script_makes(tmp_path):
    """To a twentieth of a point in most places: the last digits of a fit depend on the processor."""
    home.main([str(tmp_path)])
    for name in home.PICTURES:
        kept, made = (numbers_of((folder / name).read_text("utf-8")) for folder in (ROOT / "docs", tmp_path))
        assert kept.shape == made.shape, name
        assert np.quantile(np.abs(kept - made), 0.99) < 0.05, name
