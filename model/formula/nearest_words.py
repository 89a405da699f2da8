"""The nearest law of a learnt curve in words, as ``softening-stiffness up to 3 mm, then harder``, and as JSON."""

from __future__ import annotations

from typing import Any

from ..as_recorded import as_recorded
from ..display import number, scale_of
from ..oscillator import Oscillator
from ..units import compose
from .curve import curve_of, learnt_terms
from .nearest_law import NearestLaw, nearest_law

#: What more and less of a force than the law's is, by the learnt term.
WAYS = {
    "free/spring": {"more": "harder", "less": "softer"},
    "free/damping": {"more": "stronger", "less": "weaker"},
    "free/surface": {"more": "stronger", "less": "weaker"},
}


def nearest_laws(model: Oscillator) -> tuple[NearestLaw, ...]:
    """Of each learnt curve of a model the nearest law, where there is one and the model has a covariance."""
    if model.identified.covariance is None:
        return ()
    unit = model.response.displacement_unit
    found = (nearest_law(curve_of(model, term), unit) for term in learnt_terms(model) if term.law.effect in WAYS)
    return tuple(one for one in found if one is not None)


def in_words(nearest: NearestLaw, model: Oscillator) -> str:
    """``as softening-stiffness up to 3 mm, then harder``, in the unit of length that was recorded."""
    ways, law = WAYS[nearest.effect], f"as {nearest.law or 'Eq. 17'}"
    below, above = (ways.get(way, "") for way in (nearest.below, nearest.above))
    if nearest.whole:
        return f"{law} over all that was recorded"
    low, high = (_said(value, nearest, model) for value in (nearest.low, nearest.high))
    if not below:
        return f"{law} up to {high} on the positive side, then {above}"
    if not above:
        return f"{law} up to {low} on the negative side, then {below}"
    if nearest.high == -nearest.low:
        way = above if above == below else f"{above} on the positive side and {below} on the negative one"
        return f"{law} up to {high} on both sides, then {way}"
    return f"{law} from {low} to {high}; {below} below, {above} above"


def as_json(nearest: NearestLaw, model: Oscillator) -> dict[str, Any]:
    """As ``diagnosis.json`` has it, in SI but for the sentence; ``law`` is null where Eq. 17 by itself is as near."""
    ways = WAYS[nearest.effect]
    return {
        "effect": nearest.effect,
        "law": nearest.law or None,
        "from": nearest.low,
        "to": nearest.high,
        "recorded_to": nearest.reach,
        "unit": _unit(nearest, model),
        "below": ways.get(nearest.below),
        "above": ways.get(nearest.above),
        "parameters": {n: {"value": p.value, "std": p.std, "unit": p.unit} for n, p in nearest.parameters.items()},
        "sentence": in_words(nearest, model),
    }


def _unit(nearest: NearestLaw, model: Oscillator) -> str:
    return compose("X/s" if nearest.variable == "v" else "X", model.response.displacement_unit)


def _said(value: float, nearest: NearestLaw, model: Oscillator) -> str:
    own = _unit(nearest, model)
    shown, unit = as_recorded(model, value, own)
    if unit == own:  # no other is known: with a prefix that reads well
        scale = scale_of(own, value)
        shown, unit = value * scale.factor, scale.unit
    return f"{number(shown, 2)} {unit}"
