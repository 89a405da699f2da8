"""A formula with its numbers and units, as words, as JSON and as a law file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..oscillator import Oscillator
from ..parameter import Parameter
from ..units import compose, factors, render
from .atoms import ATOMS
from .curve import KINDS, Kind, LearntCurve, curve_of, learnt_terms
from .search import Formula, formulas

#: So many forms of a curve are shown.
_SHOWN = 3


@dataclass(frozen=True)
class ClosedForm:
    """A closed form that a learnt curve may be.

    Attributes:
        effect: the learnt term whose curve it is.
        pieces: names of ``ATOMS``, in order.
        constants: ``c0`` before the straight line (of a damping or a mass: the constant), ``c1`` and so on before
            the pieces, ``a1`` and so on within them.
        within: whether the curve does not contradict it.
        information: by how many natural units its description is longer than that of the shortest form.
        reach: largest value of the variable that was recorded.
    """

    effect: str
    pieces: tuple[str, ...]
    constants: dict[str, Parameter]
    within: bool
    information: float
    reach: float

    @property
    def kind(self) -> Kind:
        """What its curve is."""
        return KINDS[self.effect]

    @property
    def text(self) -> str:
        """The form with letters for its constants."""
        variable, times = self.kind.variable, self.kind.times
        made = ["c0" if times else f"c0 {variable}"]
        for k, name in enumerate(self.pieces, start=1):
            made.append(f"c{k} {ATOMS[name].text.format(q=variable, a=f'a{k}')}")
        whole = " + ".join(made)
        return f"({whole}) {times}" if times else whole

    def at(self, q: np.ndarray) -> np.ndarray:
        """Values (n,) at q, in the unit of the variable."""
        values = {name: parameter.value for name, parameter in self.constants.items()}
        made = values["c0"] * (np.ones(q.shape) if self.kind.times else q)
        for k, name in enumerate(self.pieces, start=1):
            made = made + values[f"c{k}"] * ATOMS[name].values(q, values.get(f"a{k}", 0.0))
        return made

    def as_json(self) -> dict[str, Any]:
        """As ``diagnosis.json`` has it."""
        numbers = {n: {"value": p.value, "std": p.std, "unit": p.unit} for n, p in self.constants.items()}
        return {
            "effect": self.effect,
            "form": self.text,
            "constants": numbers,
            "within_band": self.within,
            "longer_by": self.information,
        }


def closed_forms(model: Oscillator) -> tuple[ClosedForm, ...]:
    """Of each learnt curve of a model the forms within its band, the shortest first; of each at most three."""
    made: list[ClosedForm] = []
    if model.identified.covariance is None:  # nothing to judge a form by
        return ()
    for term in learnt_terms(model):
        curve = curve_of(model, term)
        found = [one for one in formulas(curve) if one.within][:_SHOWN]
        made += [_closed(model, curve, one, found[0]) for one in found]
    return tuple(made)


def _closed(model: Oscillator, curve: LearntCurve, found: Formula, shortest: Formula) -> ClosedForm:
    kind, response = curve.kind, model.response

    def parameter(value: float, error: float, power: int, *, inside: bool = False) -> Parameter:
        template = kind.over if inside else _over(kind.unit, kind.over, power)
        unit = compose(template, response.displacement_unit, model.force_unit, response.unit)
        return Parameter(float(value), float(error), unit)

    constants = {"c0": parameter(found.factors[0], found.errors[0], 0 if kind.times else 1)}
    for k, name in enumerate(found.pieces, start=1):
        constants[f"c{k}"] = parameter(found.factors[k], found.errors[k], ATOMS[name].power or 0)
    for k, (name, inside) in enumerate(zip(found.pieces, found.inside, strict=True), start=1):
        if ATOMS[name].within:
            constants[f"a{k}"] = parameter(inside, found.inside_errors[k - 1], 0, inside=True)
    reach = float(max(abs(curve.at[0]), abs(curve.at[-1])))
    return ClosedForm(
        curve.effect,
        found.pieces,
        constants,
        found.within,
        found.length - shortest.length,
        reach,
    )


def _over(whole: str, variable: str, power: int) -> str:
    """The template of a factor before a power of the variable."""
    total = dict(factors(whole))
    for symbol, exponent in factors(variable).items():
        total[symbol] = total.get(symbol, 0) - power * exponent
    return render({symbol: exponent for symbol, exponent in total.items() if exponent})


#: Of each kind of curve: the path of its law, the variable in code, and how people write that.
_LAWS = {
    "free/spring": ("restoring", "motion.x", "x"),
    "free/damping": ("dissipation", "motion.v", "x'"),
    "free/surface": ("dissipation", "motion.x", "x"),
    "free/inertia": ("inertia", "motion.x", "x"),
    "free/drive": ("excitation", "signal", "F"),
    "free/sensor": ("measurement", "signal", "r"),
}


def law_file(form: ClosedForm, name: str, origin: Sequence[str] = ()) -> str:
    """A Python file that defines a law of this form, for ``--law``; straight line or constant are Eq. 17's.

    Args:
        form: the closed form.
        name: of the law.
        origin: recordings that it was learnt from, for the file's first words.
    """
    kind, (path, _, letter) = form.kind, _LAWS[form.effect]
    parameters, shown = [], []
    for k, piece in enumerate(form.pieces, start=1):
        atom = ATOMS[piece]
        own = _over(kind.unit, kind.over, atom.power or 0)
        parameters.append(f'LawParameter("c{k}", "{own}", "size of the piece {piece}", strength=True)')
        shown.append(f"{{c{k}}} " + atom.text.format(q=letter, a=f"{{a{k}}}"))
        if atom.within:
            ratio = abs(form.constants[f"a{k}"].value) / form.reach
            probes = ", ".join(f"{part * ratio:.3g}" for part in (0.5, 1.0, 2.0))
            bound = ", lower=1e-12" if "beyond" in atom.code else ""  # on the other side of it there is another law
            parameters.append(f'LawParameter("a{k}", "{kind.over}", "size within {piece}"{bound}, probes=({probes}))')
    code, given = _code(form)
    text = " + ".join(shown)
    equation = {
        "v": f"({text}) x'",
        "x''": f"m x'' + (dm/dx) x'² / 2 with m = {text}",
    }.get(kind.times, f"{letter} → {letter} + {text}" if letter in "Fr" else text)
    lines = [
        f'"""A law that dashpot learnt: {form.text}, from {", ".join(origin) or "recordings"}."""',
        "",
        "from dashpot.model import Law, LawParameter",
        "",
        *code,
        "",
        "LAW = Law(",
        f'    name="{name}",',
        f'    path="{path}",',
        "    parameters=(",
        *(f"        {parameter}," for parameter in parameters),
        "    ),",
        *(f"    {function}={function}," for function in given),
        f'    equation="{equation}",',
        f'    sentence="The closed form that was found for {form.effect}: {form.text}.",',
        '    phrase="a law of a form that was learnt",',
        '    source="the shortest closed form within the band of a learnt curve",',
        ")",
        "",
    ]
    return "\n".join(lines)


def _code(form: ClosedForm) -> tuple[list[str], list[str]]:
    """Lines of a law's functions, and their names."""
    kind, (_, variable, _) = form.kind, _LAWS[form.effect]
    value, energy, slope = (_sum(form, part) for part in ("code", "stored", "slope"))
    if kind.times == "x''":
        made = {
            "force": f"({value}) * motion.a + ({slope}) * motion.v**2 / 2",
            "stored": f"({value}) * motion.v**2 / 2",
        }
    elif kind.times:
        made = {"force": f"({value}) * motion.v"}
    elif variable == "signal":
        made = {"drive" if kind.variable == "F" else "record": f"q + {value}"}
    else:
        made = {"force": value} | ({"stored": energy} if kind.variable == "x" else {})
    lines: list[str] = []
    for name, returned in made.items():
        arguments = "motion, p, signal" if variable == "signal" else "motion, p"
        lines += ["", f"def {name}({arguments}):", "    import casadi as ca  # noqa: F401", "", f"    q = {variable}"]
        lines += [f'    a{k} = p["a{k}"]' for k, piece in enumerate(form.pieces, start=1) if ATOMS[piece].within]
        lines += [f"    return {returned}", ""]
    return lines, list(made)


def _sum(form: ClosedForm, part: str) -> str:
    """The sum of the pieces' code, or of what they have stored, or of their slopes."""
    pieces = [getattr(ATOMS[piece], part).format(q="q", a=f"a{k}") for k, piece in enumerate(form.pieces, start=1)]
    return " + ".join(f'p["c{k}"] * ({code})' for k, code in enumerate(pieces, start=1))
