"""The pages in a browser, where there is one: nothing on its console, every figure drawn, fit for a phone, small."""

from __future__ import annotations

import contextlib
import html
import json
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import dashpot
import numpy as np
import pytest
from dashpot.commands.cli import main
from dashpot.examples import recordings
from dashpot.report.diagnosis_page import diagnosis_page

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome", "chrome"))), None)
PHONE, SCREEN, SEEN = 390, 1280, 900  # px: widths, and how high the first sight of a page is
#: Reads a page once it is there: how wide it is, and which of its figures have no size.
WRAPPER = """<!doctype html><title>waiting</title>
<iframe id="page" src="{page}" width="{width}" height="3000" style="border: 0"></iframe>
<script>
addEventListener("load", () => {{
  const page = document.getElementById("page").contentDocument;
  const figures = [...page.querySelectorAll(".panel svg, td svg, img, canvas, body > svg")];
  const empty = figures.filter(f => !f.closest("details:not([open])") && f.getBoundingClientRect().height < 5);
  const wide = page.documentElement.scrollWidth;
  const panel = page.querySelector(".panel svg");
  const ticks = () => panel ? [...panel.querySelectorAll(".frame text")].map(text => text.textContent).join(" ") : "";
  const press = key => panel && panel.dispatchEvent(new KeyboardEvent("keydown", {{key: key}}));
  const whole = ticks();
  press("+");
  const enlarged = ticks() !== whole;
  press("0");
  const zoom = enlarged && ticks() === whole;
  const within = {seen};
  const first = [...page.querySelectorAll("h1, main > p, main > pre, main > div tr, section td, section th")]
    .filter(part => part.getClientRects().length && part.getBoundingClientRect().bottom <= within)
    .map(part => part.textContent.replace(/\\s+/g, " ").trim()).join(" | ");
  document.title = JSON.stringify({{wide, figures: figures.length, empty: empty.length, zoom, first, {more}}});
}});
</script>"""
FLEET = """format: dashpot-fleet/1
defaults: {unit: m, force-unit: N, diagnose: never}
rigs:
  - {name: new, rig: stand, when: 1, recordings: bursts.csv.gz}
  - {name: old, rig: stand, when: 2, recordings: sweep_high.csv.gz}
  - {name: older, rig: stand, when: 3, recordings: sweep_low.csv.gz}
  - {name: gone, rig: stand, when: 4, recordings: text.csv}
"""

pytestmark = [pytest.mark.long, pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")]


#: Enlarges the recording, takes what is shown for the part, moves a cursor by a key, chooses a mode, reads a piece.
CHOICE = """...(() => {
  const click = element => element.dispatchEvent(new MouseEvent("click", {bubbles: true}));
  const type = (element, key) => element.dispatchEvent(new KeyboardEvent("keydown", {key: key, bubbles: true}));
  const texts = () => [...page.querySelectorAll(".chosen code")].map(code => code.textContent);
  const all = texts();
  press("+");
  const named = words => [...page.querySelectorAll(".chosen button")].find(button => button.textContent === words);
  click(named("What is shown"));
  const shown = texts();
  const [start, end] = page.querySelectorAll("[role=slider]");
  type(start, "ArrowRight");
  const moved = texts();
  click(page.querySelectorAll(".choice")[1]);
  const pressed = [...page.querySelectorAll(".choice")].map(choice => choice.getAttribute("aria-pressed"));
  press("Enter");
  const said = page.querySelector(".saying").textContent;
  click(page.querySelector(".saying button"));
  const at = end.getAttribute("aria-valuenow");
  return {all: all, shown: shown, moved: moved, pressed: pressed, said: said, chosen: texts(), end: at};
})()"""


def looked_at(page: Path, width: int = PHONE, more: str = "") -> dict[str, Any]:
    """What a browser makes of a page, on a phone if not said; a word on its console fails the test."""
    wrapper = page.with_name(f"wrapped-{page.name}")
    wrapper.write_text(WRAPPER.format(page=page.name, width=width, seen=SEEN, more=more), encoding="utf-8")
    flags = ["--headless", "--no-sandbox", "--disable-gpu", "--allow-file-access-from-files", "--enable-logging=stderr"]
    flags += [f"--user-data-dir={page.parent / 'browser'}", "--virtual-time-budget=5000", "--dump-dom"]
    ran = subprocess.run(
        [str(BROWSER), *flags, wrapper.as_uri()], capture_output=True, text=True, timeout=120, check=False
    )
    said = [line for line in ran.stderr.splitlines() if "CONSOLE" in line]
    assert said == []
    title = re.search(r"<title>(.*?)</title>", ran.stdout, re.S)
    assert title is not None, ran.stderr[-400:]
    return json.loads(html.unescape(title.group(1)))


def two_modes(path: Path) -> None:
    """A rest of two seconds, and a linear rig of two modes that rings."""
    t = np.arange(6000) / 500.0
    since = np.maximum(t - 2.0, 0.0)
    x = 4.0 * np.exp(-0.9 * since) * np.sin(2 * np.pi * 9.3 * since)
    x += 1.5 * np.exp(-1.2 * since) * np.sin(2 * np.pi * 31.7 * since)
    x += 1e-3 * np.random.default_rng(0).normal(size=t.size)
    np.savetxt(path, np.column_stack([t + 5.0, x]), delimiter=",", header="time_s,x_mm", comments="")


def damper(path: Path) -> None:
    """A damper with a spring under a motion that was imposed."""
    t = np.arange(4000) / 1000.0
    x = 5e-3 * np.sin(2 * np.pi * (1 + 0.5 * t) * t) * np.minimum(t, 1.0)
    force = 800.0 * np.gradient(x, t) + 3e3 * x + 0.2 * np.random.default_rng(0).normal(size=t.size)
    columns = np.column_stack([t, force, 1e3 * x])
    np.savetxt(path, columns, delimiter=",", header="time_s,force_N,stroke_mm", comments="")


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a page of each command that makes one."""
    folder = tmp_path_factory.mktemp("pages")
    for path in recordings("paper-stand").values():
        shutil.copy(path, folder)
    (folder / "fleet.yaml").write_text(FLEET, encoding="utf-8")
    (folder / "text.csv").write_text("no recording", encoding="utf-8")
    two_modes(folder / "two.csv")
    damper(folder / "damper.csv")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for command in (
            "identify bursts.csv.gz -o rig.yaml --report identify.html",
            "hilbert bursts.csv.gz -o curves",
            "export rig.yaml rig.fmu",
            "verify rig.fmu sweep_high.csv.gz --report verify.html",
            "diagnose rig.yaml bursts.csv.gz --holdout multisine.csv.gz -o diagnosis",
            "batch fleet.yaml -o results",
            "watch results --report life.html",
            "look two.csv --page look.html",
            "identify damper.csv --prescribed stroke_mm -o damper.yaml --report element.html",
        ):
            with contextlib.suppress(SystemExit):  # one row of the fleet is bad
                main(command.split())
    return folder


@pytest.mark.parametrize(
    ("page", "figures"),
    [
        ("identify.html", 5),
        ("curves/report.html", 5),
        ("verify.html", 3),
        ("diagnosis/report.html", 3),
        ("results/index.html", 9),
        ("life.html", 1),
        ("look.html", 2),
        ("element.html", 3),
    ],
)
def test_a_page_reads_on_a_phone(pages, page, figures):
    seen = looked_at(pages / page)
    assert seen["wide"] <= PHONE
    assert seen["figures"] >= figures
    assert seen["empty"] == 0
    assert seen["zoom"] == ('class="panel' in (pages / page).read_text(encoding="utf-8"))
    assert (pages / page).stat().st_size < 1_500_000


@pytest.mark.parametrize("width", [PHONE, SCREEN])
def test_the_first_sight_of_a_page_has_verdict_figures_and_next_step(pages, width):
    first = looked_at(pages / "identify.html", width)["first"]
    assert "Identification of rig" in first
    assert "times the noise" in first
    assert "natural frequency" in first
    assert "moving mass" in first
    assert "dashpot verify" in first
    first = looked_at(pages / "diagnosis" / "report.html", width)["first"]
    assert "✓ Consistent." in first
    assert "% of the motion" in first
    assert "What to do next:" in first


@pytest.mark.parametrize("width", [PHONE, SCREEN])
def test_so_has_that_of_a_diagnosis_that_names_a_law(pages, hand_made, width):
    found = hand_made.verdicts["missing-physics"]()
    effect = replace(found.effects[0], share=0.97)
    page = pages / "missing.html"
    page.write_text(diagnosis_page(replace(found, effects=(effect,)), files=("model.yaml",)).html, encoding="utf-8")
    first = looked_at(page, width)["first"]
    places = [
        first.index(words)
        for words in (
            "◆ Missing physics.",
            "quadratic-drag",
            "N·s²/m²",
            "97 % of what is left without it",
            "What to do next:",
            "The next experiment:",
        )
    ]
    assert places == sorted(places)


def test_a_part_and_a_mode_are_chosen_as_they_are_typed(pages):
    seen = looked_at(pages / "look.html", more=CHOICE)
    start = "dashpot identify two.csv"
    assert seen["all"] == ["", "", f"{start} -o rig.yaml --report rig.html"]
    # a plus shows three fifths of what was shown, about its middle
    assert seen["shown"][0] == "--part 2.4:9.6"
    assert seen["moved"][0] == "--part 2.44:9.6"
    assert seen["pressed"] == ["false", "true"]
    assert seen["said"].startswith("Left, 0 to 2.002 s: at rest, or faded into the noise: ")
    assert seen["chosen"][:2] == ["--part 0:2.002", "--mode 31.7Hz"]
    assert seen["chosen"][2] == f"{start} --part 0:2.002 --mode 31.7Hz -o rig.yaml --report rig.html"
    assert seen["end"] == "2.002"


def test_a_notebook_shows_the_same_page_and_asks_no_one(pages):
    cell = pages / "cell.html"
    shown = dashpot.look(pages / "two.csv")._repr_html_()
    cell.write_text(f"<!doctype html><p>before</p>{shown}", encoding="utf-8")
    ask = """...(() => {
      const frame = page.querySelector("iframe").contentDocument;
      const choice = frame.querySelectorAll(".choice")[0];
      choice.dispatchEvent(new KeyboardEvent("keydown", {key: "Enter", bubbles: true}));
      return {chosen: [...frame.querySelectorAll(".chosen code")].map(code => code.textContent)};
    })()"""
    chosen = looked_at(cell, more=ask)["chosen"]
    assert chosen[:2] == ["", 'mode="9.301Hz"']
    assert chosen[2].endswith('two.csv\', mode="9.301Hz")')


def test_what_is_wrong_with_a_page_is_seen(tmp_path):
    page = tmp_path / "wrong.html"
    body = '<!doctype html><div style="width: 500px">wide</div><svg width="10" height="0"></svg>'
    page.write_text(body, encoding="utf-8")
    assert looked_at(page) == {"wide": 500 + 8, "figures": 1, "empty": 1, "zoom": False, "first": ""}
    page.write_text(body + "<script>missing()</script>", encoding="utf-8")
    with pytest.raises(AssertionError, match="missing is not defined"):
        looked_at(page)
