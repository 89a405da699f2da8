"""The machine in its own units: masses in kg, springs in N/m, friction in N, from the quantities per unit mass.

What is identified is per unit mass (Eq. 17, inside the bracket); what a drawing or a data sheet states is not. These
follow from the parameters and are none themselves, so that nothing is said twice.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from . import units
from .as_recorded import as_recorded
from .fit_state import FOLLOWS, MostLeft, beyond
from .machine_units import products, words_of_product
from .parameter import Parameter

if TYPE_CHECKING:
    from .equations import Equations
    from .law import Expression
    from .oscillator import Oscillator

#: Name, unit template (``X`` displacement, ``Q`` force) and words.
QUANTITIES = (
    ("total_mass", "Q.s2/X", "moving mass with its payload"),
    ("stiffness", "Q/X", "stiffness of the linear spring: mass omega0²"),
    ("cubic_stiffness", "Q/X3", "stiffness of the cubic spring: mass cubic"),
    ("preload_force", "Q", "force that leaves the seat of a preloaded spring: mass preload"),
    ("damping", "Q.s/X", "viscous damping: mass viscous"),
    ("friction", "Q", "dry friction: mass dry"),
    ("natural_frequency", "Hz", "undamped natural frequency of the linear part with the payload"),
)


def physical(eq: Equations) -> Expression:
    """The quantities (n,) as an expression of ``eq.p``; none, (0,), where the equations take no payload."""
    import casadi as ca

    from .equations import PAYLOAD

    if not eq.payload:
        return ca.SX(0, 1)
    p = {name: eq.p[i] for i, name in enumerate(eq.parameter_names)}
    mass, total = p["mass"], p["mass"] + p[PAYLOAD]
    frequency = p["omega0"] * ca.sqrt(mass / total) / (2 * math.pi)
    return ca.vertcat(total, *[mass * quantity for quantity in _per_mass(p)], frequency)


def _per_mass(p: Mapping[str, Any]) -> list[Any]:
    """What of QUANTITIES is the mass times something, over the mass."""
    return [p["omega0"] ** 2, p["cubic"], p["preload"], p["viscous"], p["dry"]]


#: What a rig does amid the recorded amplitudes, where it is known best: the parameters of a spring that bends and of
#: two kinds of damping are known apart far worse than what they come to there.
AMID = ("frequency_amid", "damping_ratio_amid")
#: What a drawing states and the FMU has no need of.
DAMPING_RATIO = "damping_ratio"
_RATIO_WORDS = "viscous damping over critical: viscous / (2 omega0)"


def machine(oscillator: Oscillator) -> dict[str, Parameter]:
    """Mass, springs, damping, friction and laws as the machine has them, frequency and damping ratio, with errors.

    The standard errors are those of the parameters carried over to first order, with their covariance where the model
    has one. Without a mass (free decays alone) only natural frequency and damping ratio can be stated. What is zero and
    was not identified (a cubic spring that is not there) is left out.
    """
    values = oscillator.values()
    stds = {name: p.std for name, p in oscillator.parameters().items()}
    given = {"mass": 1.0} | values

    def of(p: Mapping[str, Any]) -> dict[str, Any]:
        names = [name for name, _, _ in QUANTITIES]
        found = [p["mass"], *[p["mass"] * quantity for quantity in _per_mass(p)], p["omega0"] / (2 * math.pi)]
        return dict(zip(names, found, strict=True)) | {DAMPING_RATIO: p["viscous"] / (2 * p["omega0"])}

    slopes = {  # by a complex step, which is exact
        name: {key: q.imag / _STEP for key, q in of(given | {name: complex(given[name], _STEP)}).items()}
        for name in given
    }
    unit, force = oscillator.response.displacement_unit, oscillator.force_unit
    templates = {name: template for name, template, _ in QUANTITIES} | {DAMPING_RATIO: "1"}
    made = {}
    for name, value in of(given).items():
        if oscillator.mass is None and name not in ("natural_frequency", DAMPING_RATIO):
            continue
        needs = [key for key in values if slopes[key][name]]
        known = [stds[key] for key in needs if stds[key] is not None]
        if value == 0 and not known:
            continue
        error = _carried({key: slopes[key][name] for key in needs}, oscillator) if known else None
        found = templates[name] if templates[name] in ("Hz", "1") else units.compose(templates[name], unit, force)
        made[name] = Parameter(value, error, found)
    named = products(oscillator)
    return made | {named[key].name: p for key, p in law_strengths(oscillator).items()} | _amid(oscillator)


def law_strengths(oscillator: Oscillator) -> dict[str, Parameter]:
    """The strengths of further laws as the machine has them, by parameter: drag in N·s²/m², a stop in N/m, with errors.

    None without a mass, nor of laws that are no force on it.
    """
    return {name: p for name, p in in_machine_units(oscillator).items() if "." in name}


def in_machine_units(oscillator: Oscillator) -> dict[str, Parameter]:
    """Each parameter that is per unit mass times the mass, by the parameter's name; see ``products``.

    The standard errors hold that of the mass, with their covariance where the model has one.
    """
    made, parameters = {}, oscillator.parameters()
    for name, product in products(oscillator).items():
        p, mass = parameters[name], parameters["mass"]
        known = p.std is not None or (p.value and mass.std is not None)
        error = _carried({"mass": p.value, name: mass.value}, oscillator) if known else None
        made[name] = Parameter(mass.value * p.value, error, product.unit)
    return made


def _amid(oscillator: Oscillator) -> dict[str, Parameter]:
    """Natural frequency and damping ratio at the middle of the recorded amplitudes; none where nobody knows these.

    The mean natural frequency there and the equivalent viscous damping over it, as FREEVIB and FORCEVIB measure them,
    with the errors of the parameters carried over to first order.
    """
    from ..errors import BadInput
    from .describing import natural_motion

    amplitude = amid(oscillator)
    if amplitude is None:
        return {}

    def of(model: Oscillator) -> list[float]:
        omega, h = (float(one[0]) for one in natural_motion(model, [amplitude]))
        return [omega / (2 * math.pi), h / omega]

    parameters = oscillator.parameters()
    slopes: list[dict[str, float]] = [{}, {}]
    try:
        values = of(oscillator)
        for name, p in parameters.items():
            if not p.std or name == "mass":
                continue
            step = _FEELER * p.std
            there, back = (
                of(oscillator.with_parameters({name: replace(p, value=p.value + way * step)})) for way in (1, -1)
            )
            for slope, one, other in zip(slopes, there, back, strict=True):
                slope[name] = (one - other) / (2 * step)
    except BadInput:  # a law that no motion of that size is told of
        return {}
    if not all(math.isfinite(number) for number in (*values, *slopes[0].values(), *slopes[1].values())):
        return {}
    errors = [_carried(slope, oscillator) if slope else None for slope in slopes]
    return {n: Parameter(v, e, u) for n, v, e, u in zip(AMID, values, errors, ("Hz", "1"), strict=True)}


def amid(oscillator: Oscillator) -> float | None:
    """The middle of the recorded amplitudes; None where nobody knows them, or the model does not follow the motion."""
    known = oscillator.amplitude
    if beyond(oscillator, MostLeft(part=FOLLOWS)):
        return None
    return 0.5 * (known.min + known.max) if known is not None and 0 < known.max < math.inf else None


_STEP = 1e-30
#: Standard errors of a parameter to either side, over which what follows from it is all but straight.
_FEELER = 1e-2


def machine_words(oscillator: Oscillator) -> dict[str, str]:
    """What each quantity of ``machine`` is."""
    value, unit = as_recorded(oscillator, amid(oscillator) or 0.0, oscillator.response.displacement_unit)
    at = f"at {value:.3g} {unit}, amid the recorded amplitudes"
    words = dict(zip(AMID, (f"natural frequency {at}", f"damping over critical {at}"), strict=True))
    words |= {name: text for name, _, text in QUANTITIES} | {DAMPING_RATIO: _RATIO_WORDS}
    known = oscillator.descriptions()
    words |= {product.name: words_of_product(known[key]) for key, product in products(oscillator).items() if "." in key}
    return words | {"total_mass": "moving mass", "natural_frequency": "undamped natural frequency of the linear part"}


def _carried(slopes: Mapping[str, float], oscillator: Oscillator) -> float:
    """Standard error of what has those slopes over the parameters."""
    provenance, parameters = oscillator.identified, oscillator.parameters()
    rows, names = provenance.covariance, provenance.parameters or tuple(parameters)
    if rows is not None and all(name in names for name in slopes if parameters[name].std):
        within = [(slopes.get(name, 0.0), i) for i, name in enumerate(names)]
        variance = sum(a * b * rows[i][j] for a, i in within for b, j in within)
    else:
        variance = sum((slope * (parameters[name].std or 0.0)) ** 2 for name, slope in slopes.items())
    return math.sqrt(max(variance, 0.0))
