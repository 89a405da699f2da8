"""How a strength of an element depends on a channel: temperature, pressure, current, gap, load or speed.

A force is proportional to its strengths, so that one of them times a function of a channel is the same force times that
function, whatever the motion. Each form is one at a reference value of the channel, c0, where the strength is stated:
``linear`` is strength + slope (c - c0), ``power`` strength (c/c0)^exponent, ``origin`` strength c/c0, and ``inverse``
strength / (1 + rate (c - c0)).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from . import units
from .parameter import Parameter


@dataclass(frozen=True)
class Form:
    """One way in which a strength may depend on a channel.

    Attributes:
        name: of the way.
        parameter: name of its own number; empty where it has none.
        words: what that is, with the names of channel and strength left open.
        text: the strength as text, from texts of the strength, its own number, the channel and its reference value.
        proportional: whether it divides by the channel's reference value, so that its zero must mean something.
        positive: whether the channel must keep its sign.
        value: the strength, from that at the reference value, its own number, the channel, and the reference value.
    """

    name: str
    parameter: str
    words: str
    text: str
    proportional: bool
    positive: bool
    value: Callable[[Any, Any, Any, float], Any]


#: Unit of a temperature, whose zero is a convention.
CELSIUS = "degC"
#: In the order in which they are asked for.
FORMS: Mapping[str, Form] = {
    form.name: form
    for form in (
        Form(
            *("linear", "slope", "change of {of} with {channel}", "({s} + {a} ({c} - {c0}))"),
            *(False, False),
            lambda s, a, c, c0: s + a * (c - c0),
        ),
        Form(
            *("origin", "", "", "{s} {c}/{c0}"),
            *(True, False),
            lambda s, a, c, c0: s * (c / c0),
        ),
        Form(
            *("power", "exponent", "exponent of {channel} in {of}", "{s} ({c}/{c0})^{a}"),
            *(True, True),
            lambda s, a, c, c0: s * (c / c0) ** a,
        ),
        Form(
            *("inverse", "rate", "part by which {of} falls with {channel}", "{s}/(1 + {a} ({c} - {c0}))"),
            *(False, False),
            lambda s, a, c, c0: s / (1.0 + a * (c - c0)),
        ),
    )
}


@dataclass(frozen=True)
class Dependence:
    """One strength that depends on a channel.

    Attributes:
        channel: its name.
        of: name of the parameter that depends on it, by ``Element.parameters()``.
        how: a key of ``FORMS``.
        reference: value of the channel for which the strength is stated.
        unit: of the channel.
        low, high: what the recordings covered.
        parameter: its own number; None where the form has none.
    """

    channel: str
    of: str
    how: str
    reference: float
    unit: str
    low: float
    high: float
    parameter: Parameter | None = None

    @property
    def form(self) -> Form:
        """What its ``how`` means."""
        return FORMS[self.how]

    @property
    def name(self) -> str:
        """Of its own number among the element's parameters; empty where it has none."""
        return own_name(self.of, self.channel, self.how)

    def beyond(self, least: float, most: float) -> str | None:
        """A sentence where a channel leaves what the recordings covered, else None."""
        slack = 1e-9 * max(abs(self.low), abs(self.high))
        if self.low - slack <= least and most <= self.high + slack:
            return None
        span = f"{least:.4g}" if least == most else f"{least:.4g} to {most:.4g}"
        return (
            f"{self.channel} is {span} {self.unit}, and the recordings covered {self.low:.4g} to {self.high:.4g} "
            f"{self.unit}: beyond that {self.of} is a guess"
        )


def own_name(of: str, channel: str, how: str) -> str:
    """Name of a dependence's own number among an element's parameters: the parameter, the channel, what it is."""
    own = FORMS[how].parameter
    return f"{of}.{channel}_{own}" if own else ""


def own_unit(how: str, strength: str, channel: str) -> str:
    """Unit of a form's own number, from those of the strength and of the channel."""
    own = FORMS[how].parameter
    if own == "exponent":
        return "1"
    exponents = dict(units.factors(strength)) if own == "slope" else {}
    for symbol, power in units.factors(channel).items():
        exponents[symbol] = exponents.get(symbol, 0) - power
    return units.render({symbol: power for symbol, power in exponents.items() if power})


def in_order(dependences: Iterable[Dependence], of: str) -> list[Dependence]:
    """The dependences of one strength as they apply: slopes add to it, and factors multiply their sum."""
    return sorted((one for one in dependences if one.of == of), key=lambda one: one.how != "linear")


def strength_at(
    dependences: Iterable[Dependence], of: str, strength: Any, own: Mapping[str, Any], channels: Mapping[str, Any]
) -> Any:
    """A strength where channels have some values: numbers, arrays or expressions.

    Args:
        dependences: of all strengths.
        of: name of this one.
        strength: at the references.
        own: numbers of the forms, by name.
        channels: by name; one that is left out has its reference.
    """
    for one in in_order(dependences, of):
        channel = channels.get(one.channel, one.reference)
        strength = one.form.value(strength, own.get(one.name), channel, one.reference)
    return strength


def channels_of(dependences: Sequence[Dependence]) -> dict[str, Dependence]:
    """The first dependence on each channel, by the channel's name: it knows unit, reference and range."""
    known: dict[str, Dependence] = {}
    for one in dependences:
        known.setdefault(one.channel, one)
    return known


def beyond(dependences: Sequence[Dependence], least: Mapping[str, float], most: Mapping[str, float]) -> list[str]:
    """Sentences on channels, by name, that leave what the recordings covered."""
    said = [one.beyond(least[name], most[name]) for name, one in channels_of(dependences).items() if name in least]
    return [sentence for sentence in said if sentence]


def possible(how: str, unit: str, low: float, high: float, reference: float) -> str | None:
    """Why a form cannot be of a channel between two values, in words; None where it can."""
    form = FORMS[how]
    if form.proportional and (unit == CELSIUS or not reference):
        return "its zero is a convention" if unit == CELSIUS else "its reference value is zero"
    if form.positive and not low * high > 0.0:
        return f"its zero lies within {low:g} to {high:g} {unit}"
    return None
