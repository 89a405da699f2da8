"""What the site has beyond the files of docs/: pages made from the code, files from elsewhere, and equations as MathML.

- Documents and sources that a page names outside docs/ come along, and links to them lead there.
- Each law of the library has a page and a picture; `library.md` gets their table, `commands.md` the commands' help.
- The pages of docs/gallery/ are worked out (`worked.py`): what their commands print and draw stands behind them.
- Equations become MathML, which browsers draw by themselves.
"""

from __future__ import annotations

import atexit
import os
import posixpath
import re
import shutil
import sys
import tempfile
from html import unescape
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.plugins import event_priority
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

sys.path.append(str(Path(__file__).parent))

# it stands beside this file, which mkdocs loads by its path
from worked import Differs, Worked, shown, worked

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

ROOT = Path(__file__).resolve().parents[2]
#: Documents outside docs/ and the pages that they become.
ELSEWHERE = {
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "SECURITY.md": "security.md",
    "examples/README.md": "examples.md",
}
_LINK = re.compile(r"(\]\()([^)#\s:]+)((?:#[^)\s]*)?\))")
_CODE = re.compile(r"(```.*?```|`[^`\n]*`)", re.DOTALL)
_LAWS, _COMMANDS = "<!-- the laws -->", "<!-- the commands -->"
GALLERY = "gallery/"
#: What the pages of the gallery gave, by their stem.
_gallery: dict[str, Worked] = {}


@event_priority(100)  # before mkdocstrings, which is told where the package lies
def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Leave out entries without a page, put pages without an entry last, and say where the package lies."""
    config.plugins["mkdocstrings"].config.handlers["python"]["paths"] = [_package()]
    folder = Path(config.docs_dir)
    there = {p.relative_to(folder).as_posix() for p in folder.rglob("*.md")} | set(ELSEWHERE.values())
    named: set[str] = set()

    def kept(items: list[Any]) -> list[Any]:
        result: list[Any] = []
        for item in items:
            ((title, value),) = item.items() if isinstance(item, dict) else ((None, item),)
            if isinstance(value, list):
                if inside := kept(value):
                    result.append({title: inside})
            elif value in there:
                named.add(value)
                result.append(item)
        return result

    from dashpot.report.law_page import laws, page_name

    nav = kept(list(config.nav or []))
    for section in nav:
        if isinstance(section, dict) and "Laws" in section:
            section["Laws"].append({"Each law": [{law.name: f"library/{page_name(law)}.md"} for law in laws()]})
    more: list[Any] = sorted(there - named)
    config.nav = [*nav, {"More": more}] if more else nav
    return config


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add the pages of laws, and what pages name outside docs/."""
    from dashpot.report.law_figure import law_figure
    from dashpot.report.law_page import law_page, laws, page_name
    from dashpot.report.matplotlib_figure import drawn

    for origin, uri in ELSEWHERE.items():
        files.append(File.generated(config, uri, content=(ROOT / origin).read_text("utf-8")))
    _work_out(files, config)
    for law in laws():
        name = page_name(law)
        picture = drawn(law_figure(law, name), "svg")
        page = law_page(law, f"{name}.svg", _named(law.name))
        files.append(File.generated(config, f"library/{name}.md", content=page))
        files.append(File.generated(config, f"library/{name}.svg", content=picture))
    named = {
        target
        for file in files.documentation_pages()
        for _, link, _ in _LINK.findall(_without_code(file.content_string))
        if not (target := _in_repository(file.src_uri, link)).startswith("docs/")
    }
    for target in sorted(named - {*ELSEWHERE, "README.md"}):
        if (ROOT / target).is_file():
            files.append(File.generated(config, f"source/{target}", abs_src_path=str(ROOT / target)))
    return files


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Links as the site needs them, and what is made from the code."""
    uri = page.file.src_uri
    if uri.startswith(GALLERY):
        if (made := _gallery.get(Path(uri).stem)) is not None:
            return _linked(uri, shown(markdown, Path(uri).name, made))
        markdown += "\nThe recording was not at hand when this site was made, so that nothing is printed here.\n"
    markdown = _linked(uri, markdown)
    if _LAWS in markdown:
        from dashpot.report.law_page import library_table

        markdown = markdown.replace(_LAWS, library_table())
    return markdown.replace(_COMMANDS, _commands()) if _COMMANDS in markdown else markdown


def _linked(uri: str, markdown: str) -> str:
    """The page's links as the site needs them; a picture of the gallery lies beside its page."""
    pieces = _CODE.split(markdown)
    pieces[::2] = [_LINK.sub(lambda m: m[1] + _on_site(uri, m[2]) + m[3], text) for text in pieces[::2]]
    return "".join(pieces)


def _work_out(files: Files, config: MkDocsConfig) -> None:
    """Run the pages of the gallery, and add their pictures."""
    pages = sorted(Path(config.docs_dir, GALLERY).glob("*.md"))
    try:
        _gallery.update(worked(pages))
    except Differs as problem:
        raise PluginError(str(problem)) from problem
    for made in _gallery.values():
        for name, picture in made.pictures.items():
            files.append(File.generated(config, f"{GALLERY}{name}", content=picture))


def _named(law: str) -> dict[str, list[str]]:
    """Pages of the gallery, as seen from a law's page, that name the law: title and link to the recordings."""
    return {
        f"[{_title(stem)}](../{GALLERY}{stem}.md)": made.named[law]
        for stem, made in _gallery.items()
        if law in made.named
    }


def _title(stem: str) -> str:
    text = (ROOT / "docs" / GALLERY / f"{stem}.md").read_text("utf-8")
    return text.partition("\n")[0].removeprefix("# ")


def on_page_content(html: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Equations as MathML, and in tables a bar in code without the sign that keeps it from parting cells."""
    html = html.replace("\\|", "|")
    html = re.sub(r'(<span class="arithmatex">)\\\((.*?)\\\)(</span>)', lambda m: _math(m, "inline"), html, flags=re.S)
    return re.sub(r'(<div class="arithmatex">)\\\[(.*?)\\\](</div>)', lambda m: _math(m, "block"), html, flags=re.S)


def _package() -> str:
    """A folder with the package under its own name, for a reader of sources that knows packages by their folder."""
    folder = tempfile.mkdtemp(prefix="dashpot-site-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    inside = Path(folder, "dashpot")
    inside.mkdir()
    for path in ROOT.iterdir():
        if path.suffix == ".py" or (path / "__init__.py").is_file():
            (inside / path.name).symlink_to(path)
    return folder


def _math(match: re.Match[str], display: str) -> str:
    from latex2mathml.converter import convert

    return match[1] + convert(unescape(match[2]).strip(), display=display) + match[3]


def _without_code(markdown: str) -> str:
    return _CODE.sub("", markdown)


def _in_repository(uri: str, link: str) -> str:
    """Where a link of a page leads, as a path of the repository."""
    origin = next((origin for origin, made in ELSEWHERE.items() if made == uri), f"docs/{uri}")
    return posixpath.normpath(posixpath.join(posixpath.dirname(origin), link))


def _on_site(uri: str, link: str) -> str:
    """The same link, as the page has to name it on the site."""
    if uri.startswith("library/"):
        return link
    target = _in_repository(uri, link)
    place = {**ELSEWHERE, "README.md": "index.md"}.get(target) or (
        target.removeprefix("docs/") if target.startswith("docs/") else f"source/{target}"
    )
    return posixpath.relpath(place, posixpath.dirname(uri) or ".")


def _commands() -> str:
    """The help of every command, as it prints it."""
    import click
    from dashpot.commands.cli import cli

    parts = []
    for name, command in sorted(cli.commands.items()):
        context = click.Context(command, info_name=f"dashpot {name}", max_content_width=100)
        parts.append(f"## dashpot {name}\n\n```text\n{command.get_help(context)}\n```\n")
    return "\n".join(parts)
