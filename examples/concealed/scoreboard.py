"""The score as one self-contained HTML page."""

from __future__ import annotations

from pathlib import Path
from typing import Any


def judged(rig: dict[str, Any]) -> tuple[bool, str]:
    """Say in a few words how one rig's answer counts, and whether that is good."""
    if rig["answer"]["problem"]:
        return False, "failed"
    if rig["kind"] == "none":
        return not rig["false_alarm"], "false alarm" if rig["false_alarm"] else "no false alarm"
    if rig["kind"] == "open":
        return rig["unexplained"], "left unexplained" if rig["unexplained"] else "explained away"
    if rig["kind"] == "two":
        return rig["found"] == 2, ("none found", "one found", "both found")[rig["found"]]
    if rig["strict"]:
        return True, "alone" if rig["alone"] else "first of its group"
    if rig["group"]:
        return True, "in the group"
    return False, "twin" if rig["twin"] else "missed"


def page(board: dict[str, Any], sha256: str = "") -> str:
    """Render a score, as `score.score` gives it, as HTML."""
    from jinja2 import Environment, StrictUndefined

    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters["percent"] = lambda value: "–" if value is None else f"{100 * value:.0f} %"
    environment.filters["part"] = lambda value: "–" if value is None or value != value else f"{100 * value:.2f} %"
    environment.filters["ratio"] = lambda value: "–" if value is None else f"{value:.2f}"
    environment.filters["judged"] = judged
    text = Path(__file__).with_name("scoreboard.html.j2").read_text(encoding="utf-8")
    return environment.from_string(text).render(board=board, sha256=sha256)
