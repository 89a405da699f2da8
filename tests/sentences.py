"""The sentences that users see, in one file that is read as prose: ``tests/sentences.yaml``.

A test gives a sentence to the fixture ``reads``, which holds it against that file; ``pytest --write-sentences`` writes
there what the tests of that run give. So a change of words is a change of one file, and its difference shows it whole.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

SENTENCES = Path(__file__).with_suffix(".yaml")
#: The longest name of a case, in characters.
LONGEST = 80


class Prose(str):
    """A text that is written as it reads, without quotes."""


class Writer(yaml.SafeDumper):
    """Writes prose as blocks."""


Writer.add_representer(Prose, lambda writer, text: writer.represent_scalar("tag:yaml.org,2002:str", text, style="|"))

Table = dict[str, dict[str, str]]


def known(path: Path = SENTENCES) -> Table:
    """Sentences by test (``<file>::<function>``) and case."""
    return yaml.load(path.read_text(encoding="utf-8"), yaml.CSafeLoader) if path.exists() else {}


def as_text(table: Table) -> str:
    """The file of sentences."""
    ordered = {test: {case: Prose(cases[case]) for case in sorted(cases)} for test, cases in sorted(table.items())}
    return yaml.dump(ordered, Dumper=Writer, allow_unicode=True, sort_keys=False)


class Sentences:
    """Holds sentences against the file, or gathers those of a run and writes them."""

    def __init__(self, write: bool, exists: Callable[[str], bool]) -> None:
        self.write, self.exists = write, exists
        self.table = known()
        self.given: Table = {}

    def reads(self, node: pytest.Item, text: str, case: str) -> None:
        """Assert that the file has this text for a case of the test, or have it written there."""
        test = node.nodeid.partition("[")[0]
        if self.write:
            node.stash.setdefault(GIVEN, []).append((test, case, text))
            return
        expected = self.table.get(test, {}).get(case)
        assert expected is not None, f"{SENTENCES.name} has no {case!r} of {test}; pytest --write-sentences writes it"
        assert text == expected

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
        report: Any = yield
        if call.when == "teardown":  # the report goes to the process that writes
            report.sentences = item.stash.get(GIVEN, [])
        return report

    def pytest_runtest_logreport(self, report: Any) -> None:
        for test, case, text in getattr(report, "sentences", ()):
            before = self.given.setdefault(test, {}).setdefault(case, text)
            assert before == text, f"two texts for {case!r} of {test}"

    def pytest_terminal_summary(self) -> None:
        if self.write and self.given:
            kept = {test: cases for test, cases in self.table.items() if self.exists(test)}
            SENTENCES.write_text(as_text(kept | self.given), encoding="utf-8")


GIVEN = pytest.StashKey[list[tuple[str, str, str]]]()


@pytest.fixture
def reads(request: pytest.FixtureRequest) -> Callable[..., None]:
    """``reads(text)`` or ``reads(text, case)``: the text is that of ``tests/sentences.yaml``, word by word."""
    sentences = request.config.pluginmanager.get_plugin("sentences")
    usual = getattr(getattr(request.node, "callspec", None), "id", "it")[:LONGEST]

    def check(text: str, case: str = usual) -> None:
        sentences.reads(request.node, text, case)

    return check
