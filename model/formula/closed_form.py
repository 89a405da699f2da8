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
from .curve import LearntCurve, curve_of, learnt_terms
from .search import Formula, formulas

#: So many forms of a curve are shown.
_SHOWN = 3


@dataclass(frozen=True)
class ClosedForm:
    """A closed form that a learnt curve may be.

    Attributes:
        effect: the learnt term whose curve it is.
        variable: ``x`` or ``v``.
        times: ``v`` where the force is the curve times the velocity.
        pieces: names of ``ATOMS``, in order.
        constants: ``c0`` before the straight line (of a damping over the place: the constant), ``c1`` and so on before
            the pieces, ``a1`` and so on within them.
        within: whether the curve does not contradict it.
        information: by how many natural units its description is longer than that of the shortest form.
        reach: largest value of the variable that was recorded.
    """

    effect: str
    variable: str
    times: str
    pieces: tuple[str, ...]
    constants: dict[str, Parameter]
    within: bool
    information: float
    reach: float

    @property
    def text(self) -> str:
        """The form with letters for its constants."""
        first = "c0" if self.times else f"c0 {self.variable}"
        made = [first]
        for k, name in enumerate(self.pieces, start=1):
            made.append(f"c{k} {ATOMS[name].text.format(q=self.variable, a=f'a{k}')}")
        whole = " + ".join(made)
        return f"({whole}) {self.times}" if self.times else whole

    def at(self, q: np.ndarray) -> np.ndarray:
        """Values (n,) at q, in the unit of the variable."""
        values = {name: parameter.value for name, parameter in self.constants.items()}
        made = values["c0"] * (np.ones(q.shape) if self.times else q)
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
    whole, variable = _units(curve.variable, curve.times)

    def parameter(value: float, error: float, power: int, *, inside: bool = False) -> Parameter:
        template = variable if inside else _over(whole, variable, power)
        return Parameter(float(value), float(error), compose(template, model.response.displacement_unit))

    constants = {"c0": parameter(found.factors[0], found.errors[0], 0 if curve.times else 1)}
    for k, name in enumerate(found.pieces, start=1):
        constants[f"c{k}"] = parameter(found.factors[k], found.errors[k], ATOMS[name].power or 0)
    for k, (name, inside) in enumerate(zip(found.pieces, found.inside, strict=True), start=1):
        if ATOMS[name].within:
            constants[f"a{k}"] = parameter(inside, found.inside_errors[k - 1], 0, inside=True)
    reach = float(max(abs(curve.at[0]), abs(curve.at[-1])))
    return ClosedForm(
        curve.effect,
        curve.variable,
        curve.times,
        found.pieces,
        constants,
        found.within,
        found.length - shortest.length,
        reach,
    )


def _units(variable: str, times: str) -> tuple[str, str]:
    """Templates of the units of the curve and of its variable."""
    return "1/s" if times else "X/s2", "X" if variable == "x" else "X/s"


def _over(whole: str, variable: str, power: int) -> str:
    """The template of a factor before a power of the variable."""
    total = dict(factors(whole))
    for symbol, exponent in factors(variable).items():
        total[symbol] = total.get(symbol, 0) - power * exponent
    return render({symbol: exponent for symbol, exponent in total.items() if exponent})


def law_file(form: ClosedForm, name: str, origin: Sequence[str] = ()) -> str:
    """A Python file that defines a law of this form, for ``--law``; the straight line is Eq. 17's.

    Args:
        form: the closed form.
        name: of the law.
        origin: recordings that it was learnt from, for the file's first words.
    """
    variable = "motion.x" if form.variable == "x" else "motion.v"
    whole, unit = _units(form.variable, form.times)
    parameters, force, stored, shown = [], [], [], []
    for k, piece in enumerate(form.pieces, start=1):
        atom = ATOMS[piece]
        own = _over(whole, unit, atom.power or 0)
        parameters.append(f'LawParameter("c{k}", "{own}", "size of the piece {piece}", strength=True)')
        force.append(f'p["c{k}"] * ({atom.code.format(q="q", a=f"a{k}")})')
        stored.append(f'p["c{k}"] * ({atom.stored.format(q="q", a=f"a{k}")})')
        shown.append(f"{{c{k}}} " + atom.text.format(q="x" if form.variable == "x" else "x'", a=f"{{a{k}}}"))
        if atom.within:
            ratio = abs(form.constants[f"a{k}"].value) / form.reach
            probes = ", ".join(f"{part * ratio:.3g}" for part in (0.5, 1.0, 2.0))
            bound = ", lower=1e-12" if "beyond" in atom.code else ""  # on the other side of it there is another law
            parameters.append(f'LawParameter("a{k}", "{unit}", "size within {piece}"{bound}, probes=({probes}))')
    sizes = [f'    a{k} = p["a{k}"]' for k, piece in enumerate(form.pieces, start=1) if ATOMS[piece].within]
    body = " + ".join(force)
    text = " + ".join(shown)
    energy = form.variable == "x" and not form.times
    lines = [
        f'"""A law that dashpot learnt: {form.text}, from {", ".join(origin) or "recordings"}."""',
        "",
        "from dashpot.model import Law, LawParameter",
        "",
        "",
        "def force(motion, p):",
        "    import casadi as ca  # noqa: F401",
        "",
        f"    q = {variable}",
        *sizes,
        f"    return ({body}) * motion.v" if form.times else f"    return {body}",
        "",
    ]
    if energy:
        lines += ["", "def stored(motion, p):", "    import casadi as ca  # noqa: F401", "", f"    q = {variable}"]
        lines += [*sizes, f"    return {' + '.join(stored)}", ""]
    lines += [
        "",
        "LAW = Law(",
        f'    name="{name}",',
        f'    path="{"restoring" if energy else "dissipation"}",',
        "    parameters=(",
        *(f"        {parameter}," for parameter in parameters),
        "    ),",
        "    force=force,",
        *(["    stored=stored,"] if energy else []),
        f'    equation="{f"({text}) x" + chr(39) if form.times else text}",',
        f'    sentence="The closed form that was found for {form.effect}: {form.text}.",',
        '    phrase="a force of a form that was learnt",',
        '    source="the shortest closed form within the band of a learnt curve",',
        ")",
        "",
    ]
    return "\n".join(lines)
