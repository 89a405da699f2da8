"""Reads a Modelica model and runs it: the part of the grammar (Modelica 3.4, appendix A) that an export may use.

A text that the grammar does not take, a variable with no equation or two, an algebraic loop: each is an AssertionError.
``Run`` has the semantics of appendix B: relations keep their values between events, an event is located where one would
change, and equations are gone through again until no discrete variable changes.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

TOKEN = re.compile(
    r"(?P<space>\s+|//[^\n]*)|(?P<number>\d+(\.\d*)?([eE][+-]?\d+)?)|(?P<name>[A-Za-z_]\w*)"
    r"|(?P<text>\"([^\"\\]|\\.)*\")|(?P<mark><>|<=|>=|==|[-+*/^=<>(){},;])"
)
WORDS = frozenset(
    [
        "model",
        "end",
        "parameter",
        "input",
        "output",
        "protected",
        "initial",
        "equation",
        "when",
        "then",
        "if",
        "elseif",
        "else",
        "and",
        "or",
        "not",
        "annotation",
        "true",
        "false",
        "der",
        "pre",
        "change",
        "reinit",
    ]
)
FUNCTIONS: dict[str, Callable[..., float]] = {
    "abs": abs, "sign": lambda a: float((a > 0) - (a < 0)), "min": min, "max": max, "sqrt": math.sqrt,
    "exp": math.exp, "sin": math.sin, "cos": math.cos, "tanh": math.tanh, "log": math.log,
}  # fmt: skip
Expression = Callable[["Run"], Any]


@dataclass
class Component:
    kind: str
    type: str
    changed: dict[str, Expression]
    binding: Expression | None


@dataclass
class Model:
    name: str
    components: dict[str, Component] = field(default_factory=dict)
    initial: dict[str, Expression] = field(default_factory=dict)
    equations: dict[str, Expression] = field(default_factory=dict)
    rates: dict[str, Expression] = field(default_factory=dict)
    when: list[Expression] = field(default_factory=list)
    events: dict[str, Expression] = field(default_factory=dict)
    reinits: dict[str, Expression] = field(default_factory=dict)


class Reader:
    """One model out of a text."""

    def __init__(self, text: str) -> None:
        at, self.tokens = 0, []
        while at < len(text):
            found = TOKEN.match(text, at)
            assert found, f"no token of Modelica: {text[at : at + 30]!r}"
            at = found.end()
            if found.lastgroup != "space":
                self.tokens.append((found.lastgroup, found[0]))
        self.tokens.append(("end of text", ""))
        self.at = self.relations = 0

    def peek(self) -> str:
        return self.tokens[self.at][1]

    def take(self, *wanted: str) -> str:
        kind, text = self.tokens[self.at]
        assert not wanted or text in wanted or kind in wanted, f"{text!r} where {wanted} should be"
        self.at += 1
        return text

    def given(self, *texts: str) -> bool:
        if self.peek() in texts:
            self.at += 1
            return True
        return False

    def name(self) -> str:
        text = self.take("name")
        assert text not in WORDS, f"{text!r} is a word of Modelica"
        return text

    def model(self) -> Model:
        self.take("model")
        model = Model(self.name())
        self.take("text")
        while self.peek() not in ("initial", "equation"):
            if not self.given("protected"):
                self.component(model)
        if self.given("initial"):
            self.take("equation")
            while self.peek() != "equation":
                self.equation(model.initial, {})
        self.take("equation")
        while self.peek() != "annotation":
            if self.given("when"):
                self.take("{")
                model.when.append(self.expression())
                while self.given(","):
                    model.when.append(self.expression())
                self.take("}"), self.take("then")
                while not self.given("end"):
                    if self.given("reinit"):
                        self.take("(")
                        state = self.name()
                        self.take(",")
                        assert state not in model.reinits
                        model.reinits[state] = self.expression()
                        self.take(")"), self.take(";")
                    else:
                        self.equation(model.events, {})
                self.take("when"), self.take(";")
            else:
                self.equation(model.equations, model.rates)
        self.take("annotation")
        self.arguments()
        self.take(";"), self.take("end")
        assert self.take() == model.name
        self.take(";"), self.take("end of text")
        return model

    def component(self, model: Model) -> None:
        kind = self.take() if self.peek() in ("parameter", "input", "output") else ""
        type_, name = self.take("Real", "Integer", "Boolean"), self.name()
        changed = self.arguments() if self.peek() == "(" else {}
        assert set(changed) <= {"unit", "min", "max", "start", "fixed", "nominal"}
        binding = self.expression() if self.given("=") else None
        if self.tokens[self.at][0] == "text":
            self.take()
        self.take(";")
        assert name not in model.components, f"{name} is there twice"
        model.components[name] = Component(kind, type_, changed, binding)

    def arguments(self) -> dict[str, Any]:
        self.take("(")
        found: dict[str, Any] = {}
        while not self.given(")"):
            name = self.take("name")
            if self.peek() == "(":
                found[name] = self.arguments()
            else:
                self.take("=")
                text = self.tokens[self.at][0] == "text"
                found[name] = self.take().strip('"') if text else self.expression()
            self.given(",")
        return found

    def equation(self, plain: dict[str, Expression], rates: dict[str, Expression]) -> None:
        target = plain
        if self.given("der"):
            target = rates
            self.take("(")
            name = self.name()
            self.take(")")
        else:
            name = self.name()
        self.take("=")
        assert name not in target, f"{name} has two equations"
        target[name] = self.expression()
        self.take(";")

    def expression(self) -> Expression:
        if self.given("if"):
            cases = [(self.expression(), (self.take("then"), self.expression())[1])]
            while self.given("elseif"):
                cases.append((self.expression(), (self.take("then"), self.expression())[1]))
            self.take("else")
            last = self.expression()
            return lambda run: chosen(run, cases, last)
        return self.chain(("or",), lambda: self.chain(("and",), self.negation))

    def negation(self) -> Expression:
        if self.given("not"):
            inner = self.relation()
            return lambda run: not truth(inner(run))
        return self.relation()

    def relation(self) -> Expression:
        left = self.sum()
        if self.peek() not in ("<", "<=", ">", ">=", "==", "<>"):
            return left
        mark, right, number = self.take(), self.sum(), self.relations
        self.relations += 1
        return lambda run: run.relation(number, mark, left(run), right(run))

    def sum(self) -> Expression:
        if self.given("-"):
            inner = self.product()
            return self.chain(("+", "-"), self.product, lambda run: -inner(run))
        return self.chain(("+", "-"), self.product)

    def product(self) -> Expression:
        return self.chain(("*", "/"), self.power)

    def power(self) -> Expression:
        base = self.primary()
        if not self.given("^"):
            return base
        exponent = self.primary()
        return lambda run: base(run) ** exponent(run)

    def chain(self, marks: tuple[str, ...], part: Callable[[], Expression], first: Any = None) -> Expression:
        left = first or part()
        while self.peek() in marks:
            left = joined(self.take(), left, part())
        return left

    def primary(self) -> Expression:
        kind, text = self.tokens[self.at]
        self.at += 1
        if kind == "number":
            return lambda run, value=float(text): value
        if text in ("true", "false"):
            return lambda run, value=text == "true": value
        if text == "(":
            inner = self.expression()
            self.take(")")
            return inner
        assert kind == "name", f"{text!r} where a value should be"
        if text == "time":
            return lambda run: run.time
        if self.peek() != "(":
            assert text not in WORDS
            return lambda run: run.value(text)
        self.take("(")
        if text in ("pre", "change"):
            name = self.name()
            self.take(")")
            return (lambda run: run.pre[name]) if text == "pre" else (lambda run: run.value(name) != run.pre[name])
        given = [self.expression()]
        while self.given(","):
            given.append(self.expression())
        self.take(")")
        function = FUNCTIONS[text]
        return lambda run: function(*(argument(run) for argument in given))


def truth(value: Any) -> bool:
    assert isinstance(value, bool), f"{value!r} is not Boolean"
    return value


def chosen(run: Run, cases: list[tuple[Expression, Expression]], last: Expression) -> Any:
    for condition, value in cases:
        if truth(condition(run)):
            return value(run)
    return last(run)


def joined(mark: str, left: Expression, right: Expression) -> Expression:
    return {
        "+": lambda run: left(run) + right(run),
        "-": lambda run: left(run) - right(run),
        "*": lambda run: left(run) * right(run),
        "/": lambda run: left(run) / right(run),
        "and": lambda run: truth(left(run)) and truth(right(run)),
        "or": lambda run: truth(left(run)) or truth(right(run)),
    }[mark]


class Run:
    """A model under way: its states, its discrete variables, and what its relations are."""

    def __init__(
        self, model: Model, force: Callable[[float], float], start: dict[str, float], **changed: float
    ) -> None:
        self.model, self.force, self.time = model, force, 0.0
        self.frozen: dict[int, bool] | None = None
        self.seen: dict[int, bool] = {}
        self.busy: set[str] = set()
        self.memo: dict[str, Any] = {}
        self.parameters = {n: c.binding(self) for n, c in model.components.items() if c.kind == "parameter"}
        self.parameters |= changed
        self.states = {name: start.get(name, 0.0) for name in model.rates}
        self.discrete = dict.fromkeys(model.events)
        self.pre: dict[str, Any] = {}
        solved = {*model.rates, *model.equations, *model.events, *self.parameters}
        unsolved = {n for n, c in model.components.items() if c.kind != "input"} ^ solved
        assert not unsolved, f"no equation for, or no declaration of, {sorted(unsolved)}"
        assert not set(model.equations) & {*model.rates, *model.events}
        for name, rate in model.initial.items():
            if name in self.states:
                self.states[name] = start.get(name, rate(self))
        for name in sorted(set(model.initial) - set(self.states), key=list(model.initial).index):
            self.discrete[name] = model.initial[name](self)
            self.memo = {}
        assert None not in self.discrete.values()
        self.pre = dict(self.discrete)
        self.conditions = [False] * len(model.when)
        self.pre = self.discretes()
        self.settle()

    def value(self, name: str) -> Any:
        for known in (self.parameters, self.states, self.discrete):
            if name in known:
                return known[name]
        if name == "F":
            return self.force(self.time)
        if name not in self.memo:
            assert name not in self.busy, f"an algebraic loop through {name}"
            self.busy.add(name)
            try:
                self.memo[name] = self.model.equations[name](self)
            finally:
                self.busy.discard(name)
        return self.memo[name]

    def relation(self, number: int, mark: str, left: float, right: float) -> bool:
        if self.frozen is not None and number in self.frozen:
            return self.frozen[number]
        made = {"<": left < right, "<=": left <= right, ">": left > right, ">=": left >= right, "<>": left != right}
        self.seen[number] = bool({**made, "==": left == right}[mark])
        return self.seen[number]

    def all(self) -> dict[int, bool]:
        """Everything computed anew; what the relations are."""
        self.memo, self.seen = {}, {}
        for name in self.model.equations:
            self.value(name)
        for condition in self.model.when:
            condition(self)
        return dict(self.seen)

    def rates(self, states: dict[str, float], time: float) -> dict[str, float]:
        self.states, self.time, self.memo = states, time, {}
        return {name: rate(self) for name, rate in self.model.rates.items()}

    def advanced(self, states: dict[str, float], time: float, h: float) -> dict[str, float]:
        """One step of Runge and Kutta of order four."""

        def beside(rates: dict[str, float], part: float) -> dict[str, float]:
            return {name: value + part * rates[name] for name, value in states.items()}

        k1 = self.rates(states, time)
        k2 = self.rates(beside(k1, h / 2), time + h / 2)
        k3 = self.rates(beside(k2, h / 2), time + h / 2)
        k4 = self.rates(beside(k3, h), time + h)
        return {n: z + h / 6 * (k1[n] + 2 * k2[n] + 2 * k3[n] + k4[n]) for n, z in states.items()}

    def settle(self) -> None:
        """Event iteration: until no discrete variable changes."""
        self.frozen = None
        for _ in range(20):
            self.all()
            now = [truth(condition(self)) for condition in self.model.when]
            if any(new and not old for new, old in zip(now, self.conditions, strict=True)):
                for name, made in self.model.events.items():  # in their order, each with those before it
                    self.discrete = {**self.discrete, name: made(self)}
                    self.memo = {}
                self.states = {**self.states, **{name: made(self) for name, made in self.model.reinits.items()}}
            self.conditions = now
            after = self.discretes()
            if after == self.pre:
                break
            self.pre = after
        else:
            raise AssertionError("the event iteration does not end")
        self.frozen = self.all()

    def discretes(self) -> dict[str, Any]:
        """Every variable that changes at events alone."""
        self.memo = {}
        computed = (name for name in self.model.equations if self.model.components[name].type != "Real")
        return {**self.discrete, **{name: self.value(name) for name in computed}}

    def until(self, end: float, step: float) -> dict[str, float]:
        """States at ``end``, in steps of at most ``step``, every event located."""
        while self.time < end - 1e-12:
            states, time = dict(self.states), self.time
            h = min(step, end - time)
            ahead = self.advanced(states, time, h)
            if not self.changes(ahead, time + h):
                self.states, self.time = ahead, time + h
                continue
            low, high = 0.0, h
            while high - low > 1e-13 + 1e-15 * time:
                middle = 0.5 * (low + high)
                beyond = self.changes(self.advanced(states, time, middle), time + middle)
                low, high = (low, middle) if beyond else (middle, high)
            self.states, self.time = self.advanced(states, time, high), time + high
            self.memo = {}
            self.settle()
        self.memo = {}
        return dict(self.states)

    def changes(self, states: dict[str, float], time: float) -> bool:
        """Whether a relation is another there."""
        kept, self.frozen = self.frozen, None
        self.states, self.time = states, time
        live = self.all()
        self.frozen = kept
        return any(live[number] != was for number, was in (kept or {}).items() if number in live)
