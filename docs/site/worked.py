"""Pages that are worked out when the site is built: their blocks run in an empty folder, and show what was printed.

A page of docs/gallery/ has blocks of Python, which make or copy recordings, and blocks of commands. They run in the
order of the page. Behind a block of commands a comment says what of the output matters:

    <!-- says: PART | ^PART -->    each is in the output, or is how a line begins, or the build fails; these are shown
    <!-- picture: FILE | WORDS --> a picture that a command has drawn, with what it shows

All that was printed stands folded beneath. What a page gave is kept in .worked/ by the page and all sources of the
package, so that a second build takes it from there.

`<!-- needs: FILE -->` on top names a recording of other people, which is looked for in DASHPOT_DATA or ../shared/data.
Where it is not there, the page stays as it is written, and says so; nothing of it goes into the repository.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, field
from html import escape
from importlib.metadata import version
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KEPT = ROOT / ".worked"
#: Another number where pages are to be run otherwise, so that what is kept counts no more.
_FORM = "1"
_NEEDS = re.compile(r"<!-- needs: (\S+) -->\n")
#: Folders of the repository on which no result depends.
_ASIDE = ("tests", "docs", "benchmarks", "build", "demo", "proof", "recorded", "site")
_BLOCK = re.compile(r"```(python|console)\n(.*?)```\n|<!-- (says|picture): (.*?) -->\n", re.DOTALL)
#: On a page of which the diagnoses name what is not there, so that no law's page lists it.
_WRONG = "<!-- wrong names -->"
#: Seconds that one block may take.
_LONGEST = 600.0


class Differs(Exception):
    """A page that says something else than the commands do, in one sentence."""


@dataclass(frozen=True)
class Worked:
    """What a page gave.

    Attributes:
        printed: output of each block of commands, in the order of the page.
        pictures: SVG by the name that the page gives it.
        named: laws that a diagnosis of the page named, with the recordings.
    """

    printed: list[str] = field(default_factory=list)
    pictures: dict[str, str] = field(default_factory=dict)
    named: dict[str, list[str]] = field(default_factory=dict)


def worked(pages: Iterable[Path]) -> dict[str, Worked]:
    """Each page by its stem, run or taken from an earlier build, two at a time; without those that lack a recording.

    Raises:
        Differs: a command ended otherwise than a page says, or did not print what it says; of every page that does.
    """
    pages = [page for page in pages if needed(page.read_text("utf-8")) is not None]
    with ThreadPoolExecutor(2) as pool:
        made = list(pool.map(_kept, pages))
    wrong = [str(each) for each in made if isinstance(each, Differs)]
    if wrong:
        raise Differs("\n".join(wrong))
    return {page.stem: each for page, each in zip(pages, made, strict=True)}


def _kept(page: Path) -> Worked | Differs:
    text = page.read_text("utf-8")
    given = b"".join(file.read_bytes() for file in needed(text) or ())
    key = hashlib.sha256((text + _sources() + _FORM).encode() + given).hexdigest()[:16]
    place = KEPT / f"{page.stem}-{key}.json"
    if place.exists():
        return Worked(**json.loads(place.read_text("utf-8")))
    try:
        made = run(text, page.name)
    except Differs as problem:
        return problem
    KEPT.mkdir(exist_ok=True)
    for old in KEPT.glob(f"{page.stem}-*.json"):
        if len(old.stem) == len(place.stem):
            old.unlink(missing_ok=True)
    beside = place.with_suffix(".new")
    beside.write_text(json.dumps(asdict(made)), "utf-8")
    beside.replace(place)
    return made


def needed(text: str) -> list[Path] | None:
    """The recordings of other people that a page needs; None where one is not at hand."""
    folder = Path(os.environ.get("DASHPOT_DATA") or ROOT.parent / "shared" / "data")
    files = [folder / name for name in _NEEDS.findall(text)]
    return files if all(file.is_file() for file in files) else None


def _sources() -> str:
    """What the results depend on beside the page: the package's sources, its recordings, the libraries' versions."""
    total = hashlib.sha256()
    for path in sorted(ROOT.rglob("*")):
        inside = path.relative_to(ROOT).parts
        if inside[0] in _ASIDE or inside[0].startswith(".") or "__pycache__" in inside or not path.is_file():
            continue
        if path.suffix in (".py", ".c", ".h", ".j2", ".js", ".gz"):
            total.update(str(inside).encode() + path.read_bytes())
    return total.hexdigest() + " ".join(version(name) for name in ("numpy", "scipy", "casadi", "matplotlib"))


def run(text: str, name: str) -> Worked:
    """What the blocks of a page give, in an empty folder of their own.

    Raises:
        Differs: see ``worked``.
    """
    made = Worked()
    with tempfile.TemporaryDirectory(prefix="dashpot-page-") as place:
        folder = Path(place)
        for file in needed(text) or ():
            shutil.copy(file, folder / file.name)
        for match in _BLOCK.finditer(text):
            kind, block, remark, words = match.groups()
            if kind == "python":
                _ran([sys.executable, "-P", "-c", block], folder, 0, f"{name}: a block of Python")
            elif kind == "console":
                made.printed.append("".join(_typed(line, folder, name) for line in lines(block)))
            elif remark == "says":
                _check(words, made.printed[-1], name)
            else:
                file = words.partition("|")[0].strip()
                if not (folder / file).is_file():
                    raise Differs(f"{name}: no command has drawn {file}; there are {_drawn(folder)}")
                made.pictures[_picture(name, file)] = (folder / file).read_text("utf-8")
        for found in [] if _WRONG in text else sorted(folder.rglob("diagnosis.json")):
            content = json.loads(found.read_text("utf-8"))
            rows = [row["file"] for part in ("train", "holdout") for row in content["fit"][part]]
            for effect in content["effects"]:  # of a stretch, "FILE, 0 to 2 s", the file
                made.named[effect["law"]] = list(dict.fromkeys(row.partition(",")[0] for row in rows))
    return made


def lines(block: str) -> list[str]:
    """The commands of a block, each in one line."""
    return [line for line in block.replace("\\\n", " ").splitlines() if line.strip()]


def _typed(line: str, folder: Path, name: str) -> str:
    """What a command printed, beneath the line itself; it ends with 0, or as ``# exit code N`` says."""
    words = shlex.split(line, comments=True)
    wanted = re.search(r"# exit code (\d+)", line)
    command = [sys.executable, "-P", "-m", *words]
    out = _ran(command, folder, int(wanted[1]) if wanted else 0, f"{name}: {shlex.join(words)}")
    return f"$ {shlex.join(words)}\n{out}\n"


def _ran(command: list[str], folder: Path, wanted: int, what: str) -> str:
    environment = {
        **os.environ,
        **{"OPENBLAS_NUM_THREADS": "1", "DASHPOT_SECONDS": "inf", "COLUMNS": "110", "NO_COLOR": "1"},
    }
    ended = subprocess.run(
        command,
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=_LONGEST,
        check=False,
    )
    out = ended.stdout.rstrip()
    if ended.returncode != wanted:
        raise Differs(f"{what} ended with {ended.returncode} where {wanted} is said:\n{out}")
    return out


def _check(words: str, printed: str, name: str) -> None:
    missing = [part for part in _parts(words) if not any(_holds(line, part) for line in printed.splitlines())]
    if missing:
        raise Differs(f"{name}: {' and '.join(map(repr, missing))} not printed:\n{printed}")


def _parts(words: str) -> list[str]:
    return [part.strip() for part in words.split("|")]


def _holds(line: str, part: str) -> bool:
    return f"{line.strip()} ".startswith(f"{part[1:]} ") if part.startswith("^") else part in line


def _picked(printed: str, words: str) -> list[str]:
    """The lines that hold a part, a note that is printed twice only once."""
    lines = [line for line in printed.splitlines() if any(_holds(line, part) for part in _parts(words))]
    bare = [re.sub(r"^ *(note: |- )", "", line).rstrip(".") for line in lines]
    return [line for place, line in enumerate(lines) if bare[place] not in bare[:place]]


def _drawn(folder: Path) -> str:
    return ", ".join(path.relative_to(folder).as_posix() for path in sorted(folder.rglob("*.svg"))) or "none"


def _picture(name: str, file: str) -> str:
    return f"{name.removesuffix('.md')}-{Path(file).parent.name}-{Path(file).name}"


def shown(text: str, name: str, made: Worked) -> str:
    """The page with what was printed behind its commands, and its pictures."""
    printed = iter(made.printed)
    last = ""

    def put(match: re.Match[str]) -> str:
        nonlocal last
        kind, _, remark, words = match.groups()
        if kind == "python":
            return match[0]
        if kind == "console":
            last = next(printed)
            says = re.match(r"\s*<!-- says: (.*?) -->", text[match.end() :], re.DOTALL)
            return match[0] + ("" if says else _whole(last))
        if remark == "says":
            return "\n```text\n" + "\n".join(_picked(last, words)) + "\n```\n\n" + _folded(last)
        file, _, alt = words.partition("|")
        return f"\n![{alt.strip()}]({_picture(name, file.strip())})\n"

    return _BLOCK.sub(put, text)


def _whole(printed: str) -> str:
    return f"\n```text\n{printed.rstrip()}\n```\n"


def _folded(printed: str) -> str:
    return f"<details><summary>All that was printed</summary><pre>{escape(printed.rstrip())}</pre></details>\n"
