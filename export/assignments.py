"""An expression as assignments, for any language: one walk over the instructions that CasADi evaluates.

What the fit, the FMU and the CasADi functions compute is in the instruction list of an SX function (CasADi's
``instruction_id``). The walk gives it as nodes; ``assignments`` writes them out with the operators of a ``Language``,
those that are used twice under a name of their own. So each export has every operation in the order that CasADi has it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from ..errors import BadInput

#: Operations whose result is true or false.
LOGICAL = frozenset(("LT", "LE", "EQ", "NE", "NOT", "AND", "OR"))
#: Those that take truth values: at which places.
_TAKES_TRUTH = {"NOT": (0,), "AND": (0, 1), "OR": (0, 1), "IF_ELSE": (0,)}
#: Operations that every language has as operators between numbers.
_BY_OPERATOR = frozenset(("ADD", "SUB", "NEG", "MUL", "DIV", "SQ", "TWICE", "INV", "POW", "CONSTPOW"))
#: How tightly a text holds together: of a name or call, a power, a product, a sum, a comparison.
ATOM, POWER, PRODUCT, SUM, COMPARISON = 4, 3, 2, 1, 0
#: Longest text, in characters, that stands within another.
_LONGEST = 100


@dataclass(frozen=True)
class Node:
    """One operation on earlier nodes, or an input, or a constant.

    Attributes:
        op: name of the operation without ``OP_``; ``INPUT``, ``CONST``, and ``IF_ELSE`` of three.
        args: places of the nodes that it takes; of an input its number and the element.
        value: of a constant.
    """

    op: str
    args: tuple[int, ...] = ()
    value: float = 0.0


@dataclass(frozen=True)
class Walk:
    """Nodes in an order in which they can be computed, and for each output the nodes of its elements."""

    nodes: tuple[Node, ...]
    outputs: tuple[tuple[int, ...], ...]


@dataclass(frozen=True)
class Language:
    """How operations are written.

    Attributes:
        name: for messages.
        operators: by operation: the text with ``{0}``, ``{1}`` for what it takes, and how tightly it holds together.
            What a text of a call or a power takes may hold together less than it; what an operator takes may not.
        constant: text of a number; of one that is taken by a call ``argument``.
        truth: text of "``{0}`` is not zero"; ``number``: of 1 where ``{0}`` is true, else 0.
        assignment: text of "``{0}`` is ``{1}``".
    """

    name: str
    operators: Mapping[str, tuple[str, int]]
    truth: str
    number: str
    assignment: str
    argument: str = "{0}"
    infinity: str = "inf"

    def constant(self, value: float) -> str:
        """A number to the last bit."""
        if value in (float("inf"), float("-inf")):
            return self.infinity if value > 0 else f"-{self.infinity}"
        return repr(float(value))


@cache
def _operations() -> dict[int, str]:
    """CasADi's names of operations by their numbers."""
    import casadi as ca

    return {number: name[3:] for name, number in vars(ca).items() if name.startswith("OP_")}


def walk(function: Any) -> Walk:
    """The nodes of an SX function whose outputs are dense; equal ones once."""
    names, nodes, places = _operations(), [], {}
    register: dict[int, int] = {}
    outputs = [[-1] * function.numel_out(i) for i in range(function.n_out())]

    def kept(node: Node) -> int:
        if node not in places:
            places[node] = len(nodes)
            nodes.append(node)
        return places[node]

    def node_of(op: str, args: tuple[int, ...]) -> Node:
        """The operation; ``if_else`` for what CasADi writes as a sum of two that are zero where the other is not."""
        first, second = (nodes[i] for i in (args[0], args[-1]))
        if (
            op == "ADD"
            and first.op == second.op == "IF_ELSE_ZERO"
            and nodes[second.args[0]] == Node("NOT", (first.args[0],))
        ):
            return Node("IF_ELSE", (first.args[0], first.args[1], second.args[1]))
        return Node(op, args)

    for k in range(function.n_instructions()):
        op = names[function.instruction_id(k)]
        given, target = function.instruction_input(k), function.instruction_output(k)
        if op == "OUTPUT":
            outputs[target[0]][target[1]] = register[given[0]]
        elif op == "INPUT":
            register[target[0]] = kept(Node(op, tuple(given)))
        elif op == "CONST":
            register[target[0]] = kept(Node(op, (), function.instruction_constant(k)))
        else:
            register[target[0]] = kept(node_of(op, tuple(register[i] for i in given)))
    return Walk(tuple(nodes), tuple(map(tuple, outputs)))


def assignments(
    function: Any, inputs: Sequence[Sequence[str]], language: Language, *, numbers: int | None = None, prefix: str = "a"
) -> tuple[list[str], list[list[str]]]:
    """The function written out.

    Args:
        function: a casadi SX function with dense outputs.
        inputs: for each input the names of its elements.
        language: the operators.
        numbers: the input whose elements may be plain numbers where the others are arrays.
        prefix: of the names of what is used more than once.

    Returns:
        Assignments in order, and for each output the text of each element.

    Raises:
        BadInput: the language has no word for an operation.
    """
    walked = walk(function)
    nodes = walked.nodes
    needed: Counter[int] = Counter(place for output in walked.outputs for place in output)
    for place in reversed(range(len(nodes))):
        if needed[place] and nodes[place].op != "INPUT":
            needed.update(nodes[place].args)
    lines: list[str] = []
    texts: dict[int, tuple[str, int]] = {}
    plain = _plain(nodes, numbers)

    def taken(place: int, truth: bool, least: int, call: bool) -> str:
        """Text of what an operation takes: a truth value or a number, in parentheses where it holds too little."""
        text, level = texts[place]
        if (nodes[place].op in LOGICAL) != truth:
            text, level = (language.truth if truth else language.number).format(_enclosed(text, level, ATOM)), ATOM
        if call and place in plain:
            return language.argument.format(_enclosed(text, level, PRODUCT))
        return _enclosed(text, level, least)

    for place, node in enumerate(nodes):
        if not needed[place]:
            continue
        if node.op == "INPUT":
            texts[place] = inputs[node.args[0]][node.args[1]], ATOM
            continue
        if node.op == "CONST":
            texts[place] = language.constant(node.value), SUM if node.value < 0 else ATOM
            continue
        if node.op not in language.operators:
            raise BadInput(
                f"a law uses the operation {node.op.lower()}, which the export to {language.name} does not know; "
                "write the law without it, or export the model as .c, .casadi or .fmu"
            )
        pattern, level = language.operators[node.op]
        truths = _TAKES_TRUTH.get(node.op, ())
        if node.op == "IF_ELSE_ZERO":
            truths = (0,)
        least = [_least(node.op, level, i) for i in range(len(node.args))]
        call = level == ATOM or (level == COMPARISON and plain.issuperset(node.args))
        parts = [taken(arg, i in truths, least[i], call) for i, arg in enumerate(node.args)]
        text = pattern.format(*parts)
        if needed[place] > 1 or len(text) > _LONGEST:
            name = f"{prefix}{len(lines) + 1}"
            lines.append(language.assignment.format(name, text))
            texts[place] = name, ATOM
        else:
            texts[place] = text, level
    return lines, [[taken(place, False, COMPARISON, False) for place in output] for output in walked.outputs]


def _plain(nodes: Sequence[Node], numbers: int | None) -> set[int]:
    """Places of what depends on constants and plain numbers alone, by operators and not by calls."""
    places: set[int] = set()
    for place, node in enumerate(nodes):
        if node.op == "INPUT":
            known = node.args[0] == numbers
        else:
            known = node.op == "CONST" or (node.op in _BY_OPERATOR and places.issuperset(node.args))
        if known:
            places.add(place)
    return places


def _least(op: str, level: int, place: int) -> int:
    """How tightly what stands at a place of an operator must hold together; within a call anything may."""
    if level == ATOM:
        return COMPARISON
    if level == POWER:
        return ATOM
    # from left to right; of those with one place it is the right one
    return level + (1 if place or op in ("NEG", "INV", "TWICE") else 0)


def _enclosed(text: str, level: int, least: int) -> str:
    return text if level >= least else f"({text})"
