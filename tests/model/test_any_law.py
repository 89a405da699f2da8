"""Files of laws after accidents: each is taken whole, or refused with its name and nothing is taken."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest
from dashpot.model import law_trial, oscillator_with
from dashpot.model import user_laws as user
from dashpot.model.file import dumps, loads
from dashpot.model.library import KNOWN
from dashpot.model.show import describe
from dashpot.model.user_laws import load_law_file
from hypothesis import strategies as st

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = re.findall(r"```python\n(.*?)```", (ROOT / "docs/laws.md").read_text(encoding="utf-8"), re.DOTALL)[0]
#: What laws are written with, in places where it belongs and where it does not.
PIECES = (
    "motion.x", "motion.v", "motion.t", "motion.sign(motion.v)", "motion.beyond(motion.x)",
    "motion.state('q', 'X')", "motion.rate(motion.x, motion.v)", "motion.recorded", "motion", "p", "p['strength']",
    "p['reach']", "p['odd']", "ca", "ca.exp(motion.x)", "ca.sqrt(motion.v)", "ca.SX.sym('q')", "ca.MX.sym('q')",
    "ca.SX(2, 2)", "ca.DM([1, 2])", "ca.fabs", "0", "-1", "1e400", "1j", "None", "True", "'text'", "[]", "()", "{}",
    "lambda *a: 0", "len", "object()", "float('nan')", "name", "force", "stored", "drive", "record", "proper",
    "path", "parameters", "Law", "LawParameter", "undefined", "+", "-", "*", "/", "**", "==", ">",
    " if motion.x > 0 else ", " and ", " or ", "(", ")", "[", "]", ",", "=", ":", "\n", "    ", "X", "Q", "X/s2",
    "1/X", "{strength}", "{}", "%", "\x00", "é", '"', "'", "\\", "raise SystemExit", "raise KeyboardInterrupt",
)  # fmt: skip


pytestmark = pytest.mark.usefixtures("library")


@st.composite
def damaged(draw):
    """The example of docs/laws.md with some words replaced, lost or repeated."""
    dice = random.Random(draw(st.integers(0, 2**32)))
    words = re.split(r"(\W)", EXAMPLE)
    inside = [i for i, word in enumerate(words) if i > words.index("def") and word.strip()]
    for _ in range(dice.choice([1, 1, 1, 2, 4])):
        at, kind = dice.choice(inside), dice.randrange(6)
        if kind < 4:
            words[at] = dice.choice(PIECES)
        elif kind == 4:
            words[at] = ""
        else:
            words[at] += words[at]
    return "".join(words)


def test_any_law_is_taken_or_refused(every, unless_refused, tmp_path):
    path, before, taken = tmp_path / "law.py", dict(KNOWN), 0

    def holds(text):
        nonlocal taken
        path.write_text(text, encoding="utf-8", errors="replace")
        user._loaded.clear()
        KNOWN.clear()
        KNOWN.update(before)
        laws = unless_refused(load_law_file, path)
        if laws is None:
            assert before == KNOWN
            return
        taken += 1
        values = {"mass": 0.3, "omega0": 60.0, "cubic": 0.0, "preload": 0.0, "viscous": 3.0, "dry": 0.0}
        values |= {
            f"{law.name}.{p.name}": min(max(p.natural(law_trial._SCALES), p.lower), p.upper)
            for law in laws
            for p in law.parameters
        }
        model = oscillator_with(values, effects=tuple(law.name for law in laws))
        assert describe(model).strip()
        assert loads(dumps(model)).values() == model.values()

    every(damaged(), holds)
    assert taken
