"""YAML as a model file needs it: plain data only, numbers that are numbers, and a line for every value.

PyYAML's own SafeLoader reads ``1e-3`` and ``2.0e9`` as text and ``no`` as false, lets a repeated key win silently and
expands aliases without limit. The loader here follows YAML 1.2's core schema in these points and refuses tags,
aliases and deep nesting: a model file is data.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar

import yaml

from ..errors import BadInput

MAX_CHARACTERS = 1_000_000
MAX_DEPTH = 16
MAX_SHOWN = 50  # problems in one message

Path = tuple[str | int, ...]

_NULL, _BOOL, _INT, _FLOAT = (f"tag:yaml.org,2002:{kind}" for kind in ("null", "bool", "int", "float"))
_PLAIN_STEP = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*")


@dataclass(frozen=True)
class Problem:
    """What is wrong at one place of a document, and what to do about it."""

    path: Path
    line: int | None
    text: str


@dataclass
class Document:
    """A document as read: its data, where every value stands, and the problems noticed so far.

    Attributes:
        where: file name, for messages.
        data: dicts with text keys, lists, text, numbers, bools and None.
        lines: line of every value by its path, from 1.
        problems: found so far, in any order.
    """

    where: str
    data: Any = None
    lines: dict[Path, int] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)

    def report(self, path: Path, text: str) -> None:
        """Add a problem; its line is that of the value or of the nearest value around it."""
        self.problems.append(Problem(path, next(self._lines_around(path), None), text))

    def _lines_around(self, path: Path) -> Iterator[int]:
        return (self.lines[path[:i]] for i in range(len(path), -1, -1) if path[:i] in self.lines)

    def error(self) -> BadInput:
        """All problems as one error, in the order of the lines."""
        ordered = sorted(dict.fromkeys(self.problems), key=lambda problem: problem.line or 0)
        said = [f"{self.where}: {_line(p.line)}{path_text(p.path)}: {p.text}" for p in ordered[:MAX_SHOWN]]
        if len(ordered) > MAX_SHOWN:
            said.append(f"{self.where}: and {len(ordered) - MAX_SHOWN} more problems")
        return BadInput("\n".join(said))


def path_text(path: Path) -> str:
    """``$.terms[1].parameters.gap`` for ``("terms", 1, "parameters", "gap")``."""
    text = "$"
    for step in path:
        if isinstance(step, int):
            text += f"[{step}]"
        else:
            text += f".{step}" if _PLAIN_STEP.fullmatch(step) else f"[{step[:40]!r}]"
    return text


def _line(line: int | None) -> str:
    return "" if line is None else f"line {line}: "


def shown(value: Any) -> str:
    """A value as it may stand in a message."""
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list):
        return "a list"
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def suggestion(name: str, known: Iterable[str]) -> str:
    """``did you mean ...?`` where something is close, else what is known."""
    known = list(known)
    close = difflib.get_close_matches(name[:60], known, n=3, cutoff=0.6)
    return f"did you mean {' or '.join(close)}?" if close else f"known here: {', '.join(known) or 'nothing'}"


class _Loader(yaml.SafeLoader):
    """SafeLoader with YAML 1.2 numbers, without tags, aliases, and nesting beyond ``MAX_DEPTH``."""

    yaml_implicit_resolvers: ClassVar[dict[str, list[Any]]] = {}  # pyright: ignore[reportIncompatibleVariableOverride]
    depth = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        event = self.peek_event()
        if isinstance(event, yaml.AliasEvent):
            raise _refusal("aliases (*name) are not allowed here; write the value out", event)
        if getattr(event, "tag", None) is not None:
            raise _refusal("tags (!name) are not allowed here; such a file is plain data", event)
        if self.depth >= MAX_DEPTH:
            raise _refusal(f"nested more than {MAX_DEPTH} levels deep; no file of dashpot is", event)
        self.depth += 1
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node


_Loader.add_implicit_resolver(_NULL, re.compile(r"(?:~|null|Null|NULL|)\Z"), ["~", "n", "N", ""])
_Loader.add_implicit_resolver(_BOOL, re.compile(r"(?:true|True|TRUE|false|False|FALSE)\Z"), list("tTfF"))
_Loader.add_implicit_resolver(_INT, re.compile(r"[-+]?[0-9]+\Z"), list("-+0123456789"))
_Loader.add_implicit_resolver(
    _FLOAT,
    re.compile(
        r"(?:[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))\Z"
    ),
    list("-+.0123456789"),
)


def _refusal(text: str, event: Any) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=text, problem_mark=event.start_mark)


def is_text(value: str) -> bool:
    """Whether ``value``, written without quotes, is read as text here and by YAML 1.1 readers."""
    loaders = (_Loader(""), yaml.SafeLoader(""))
    return all(loader.resolve(yaml.ScalarNode, value, (True, False)).endswith(":str") for loader in loaders)


def read_yaml(text: str, where: str) -> Document:
    """Read one YAML document into plain data.

    Args:
        text: the document.
        where: file name, for messages.

    Returns:
        The document; repeated keys and keys that are not text are among its ``problems``.

    Raises:
        BadInput: the text is too long or not YAML, or it has a tag, an alias or too deep nesting.
    """
    if len(text) > MAX_CHARACTERS:
        raise BadInput(f"{where}: longer than {MAX_CHARACTERS} characters; no file of dashpot is")
    try:
        loader = _Loader(text)
        try:
            node = loader.get_single_node()
        finally:
            loader.dispose()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = _line(mark.line + 1 if mark else None)
        said = " ".join(part for part in (error.context, error.problem) if part)
        raise BadInput(f"{where}: {line}cannot be read as YAML: {said[:200]}") from None
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        raise BadInput(f"{where}: line {line}: has a character that text cannot contain; save it as UTF-8") from None
    except (
        yaml.YAMLError,
        ValueError,
        OverflowError,
    ):  # PyYAML lets "\\UFFFFFFFF" and %YAML 999...9 through as ValueError
        raise BadInput(f"{where}: cannot be read as YAML; check its escapes and directives") from None
    document = Document(where)
    document.data = None if node is None else _plain(node, (), document)
    return document


def _plain(node: Any, path: Path, document: Document) -> Any:
    document.lines.setdefault(path, node.start_mark.line + 1)
    if isinstance(node, yaml.SequenceNode):
        return [_plain(item, (*path, i), document) for i, item in enumerate(node.value)]
    if isinstance(node, yaml.MappingNode):
        return _mapping(node, path, document)
    if node.tag == _NULL:
        return None
    if node.tag == _BOOL:
        return node.value.lower() == "true"
    if node.tag == _INT and len(node.value) <= 18:  # longer ones are floats all the same, and int() has its limits
        return int(node.value)
    if node.tag in (_INT, _FLOAT):
        return float(re.sub(r"\.(inf|nan)$", r"\1", node.value.lower()))
    return node.value


def _mapping(node: Any, path: Path, document: Document) -> dict[str, Any]:
    mapping: dict[str, Any] = {}
    for key_node, value_node in node.value:
        line = key_node.start_mark.line + 1
        if not isinstance(key_node, yaml.ScalarNode):
            document.problems.append(Problem(path, line, "a key must be a word; this one is a list or a mapping"))
            continue
        key = key_node.value
        here = (*path, key)
        if key in mapping:
            first = document.lines[here]
            text = f"stands here for the second time (first on line {first}); keep one"
            document.problems.append(Problem(here, line, text))
            continue
        document.lines[here] = line
        mapping[key] = _plain(value_node, here, document)
    return mapping
