"""The site of docs/: its entries, its links, and that it is whole without the network."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
MKDOCS = "make docs, or pip install 'dashpot[docs]'"
#: Entries that may have no page: others write them.
LATER = {"python.md", "fleets.md"}


@pytest.fixture(scope="module")
def hooks():
    pytest.importorskip("mkdocs", reason=MKDOCS)
    spec = importlib.util.spec_from_file_location("site_hooks", ROOT / "docs/site/hooks.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_entry_has_a_page():
    """A page without an entry comes last (hooks.py), so that nothing is lost; an entry without a page is a slip."""
    text = (ROOT / "mkdocs.yml").read_text("utf-8")
    entries = set(re.findall(r"^ +- (?:[A-Z][\w ]*: )?(\S+\.md)$", text, re.MULTILINE))
    pages = {path.relative_to(ROOT / "docs").as_posix() for path in ROOT.glob("docs/**/*.md")}
    assert len(entries) > 25
    assert entries - pages - set(made_elsewhere()) <= LATER


def made_elsewhere() -> list[str]:
    return re.findall(r'^    "\S+\.md": "(\S+\.md)",$', (ROOT / "docs/site/hooks.py").read_text("utf-8"), re.MULTILINE)


def test_a_page_without_an_entry_comes_last_and_an_entry_without_a_page_is_left_out(hooks, tmp_path):
    from types import SimpleNamespace

    for name in ("index.md", "fleets.md"):
        (tmp_path / name).write_text("# A page")
    handlers = {"python": {}}
    config = SimpleNamespace(
        docs_dir=str(tmp_path),
        nav=[{"Home": "index.md"}, {"How to": ["python.md"]}, {"Here": [{"There": "index.md"}]}],
        plugins={"mkdocstrings": SimpleNamespace(config=SimpleNamespace(handlers=handlers))},
    )
    nav = hooks.on_config(config).nav
    assert nav[:2] == [{"Home": "index.md"}, {"Here": [{"There": "index.md"}]}]
    assert nav[-1] == {"More": sorted(["fleets.md", *made_elsewhere()])}
    assert (Path(handlers["python"]["paths"][0]) / "dashpot" / "model" / "law.py").is_file()


@pytest.mark.parametrize(
    ("page", "link", "on_site"),
    [
        ("paper.md", "../examples/README.md", "examples.md"),
        ("howto/system.md", "../fmu.md", "../fmu.md"),
        ("howto/system.md", "../../examples/system/coupled.py", "../source/examples/system/coupled.py"),
        ("changelog.md", "docs/noise.md", "noise.md"),
        ("changelog.md", "SECURITY.md", "security.md"),
        ("examples.md", "../docs/fmu.md", "fmu.md"),
        ("house.md", "../README.md", "index.md"),
    ],
)
def test_links_lead_where_they_lead_in_the_repository(hooks, page, link, on_site):
    assert hooks._on_site(page, link) == on_site


@pytest.mark.parametrize("page", sorted(path for path in (ROOT / "docs").rglob("*.md")), ids=lambda path: path.stem)
def test_source_files_that_a_page_names_exist(page):
    here = [path.name for path in ROOT.iterdir() if (path / "__init__.py").exists()]
    folders = "|".join([*here, "benchmarks"])
    named = set(re.findall(rf"`((?:{folders})/[\w/]+\.py)`", page.read_text("utf-8")))
    assert [name for name in sorted(named) if not (ROOT / name).exists()] == []


def test_equations_become_mathml(hooks):
    html = (
        '<p><span class="arithmatex">\\(a &lt; b_0\\)</span></p>\n<div class="arithmatex">\\[\n\\frac{F}{m}\n\\]</div>'
    )
    made = hooks.on_page_content(html, page=None, config=None, files=None)
    assert made.count("<math") == 2
    assert 'display="block"' in made
    assert "<mfrac>" in made
    assert "\\" not in made


@pytest.mark.long
def test_the_site_builds_without_a_warning_and_fetches_nothing(tmp_path):
    pytest.importorskip("material", reason=MKDOCS)
    line = [sys.executable, "-P", "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path / "site")]
    nowhere = {f"{name}_proxy": "http://127.0.0.1:9" for name in ("http", "https", "HTTP", "HTTPS")}
    environment = {**os.environ, **nowhere, "NO_MKDOCS_2_WARNING": "1"}
    built = subprocess.run(line, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stderr
    assert "WARNING" not in built.stderr
    site = tmp_path / "site"
    pages = list(site.rglob("*.html"))
    assert len(pages) > 50
    assert (site / "library" / "hysteresis.svg").is_file()
    for page in pages:
        text = page.read_text("utf-8")
        fetched = re.findall(r'<(?:script|img|iframe|source)[^>]* src="?(https?:[^" >]+)', text)
        fetched += re.findall(r'<link[^>]* href="?(https?:[^" >]+)', text)
        assert fetched == [], page
        assert "\\(" not in re.sub(r"<(code|pre|script).*?</\1>", "", text, flags=re.DOTALL), page
    assert "__index" in (site / "search" / "search_index.js").read_text("utf-8")[:40]
    assert sum(path.stat().st_size for path in site.rglob("*") if path.is_file()) < 16e6
