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
  document.title = JSON.stringify({{wide, figures: figures.length, empty: empty.length, zoom, first}});
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


def looked_at(page: Path, width: int = PHONE) -> dict[str, Any]:
    """What a browser makes of a page, on a phone if not said; a word on its console fails the test."""
    wrapper = page.with_name(f"wrapped-{page.name}")
    wrapper.write_text(WRAPPER.format(page=page.name, width=width, seen=SEEN), encoding="utf-8")
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


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a page of each command that makes one."""
    folder = tmp_path_factory.mktemp("pages")
    for path in recordings("paper-stand").values():
        shutil.copy(path, folder)
    (folder / "fleet.yaml").write_text(FLEET, encoding="utf-8")
    (folder / "text.csv").write_text("no recording", encoding="utf-8")
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
        ("results/index.html", 3),
        ("life.html", 1),
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


def test_what_is_wrong_with_a_page_is_seen(tmp_path):
    page = tmp_path / "wrong.html"
    body = '<!doctype html><div style="width: 500px">wide</div><svg width="10" height="0"></svg>'
    page.write_text(body, encoding="utf-8")
    assert looked_at(page) == {"wide": 500 + 8, "figures": 1, "empty": 1, "zoom": False, "first": ""}
    page.write_text(body + "<script>missing()</script>", encoding="utf-8")
    with pytest.raises(AssertionError, match="missing is not defined"):
        looked_at(page)
