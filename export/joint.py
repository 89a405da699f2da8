"""A model as a joint of a multibody program, or a degree of freedom of a platform: numbers in SI, and what is left out.

Such programs know a few fixed terms. Every other term of the model that is not zero is named, with its size, so that
nothing is lost in silence.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..errors import BadInput
from ..model.display import number, pretty_unit
from ..model.effect_words import effect_in_words
from ..model.fit_state import state_of_fit
from ..model.units import same

if TYPE_CHECKING:
    from ..model import Oscillator

#: Units that such a program counts in: of the displacement, of the force, and what a joint of that kind does.
_KINDS = (("m", "N"), ("rad", "N.m"))


@dataclass(frozen=True)
class Joint:
    """A model's terms as forces in N or N·m, inertia in kg or kg·m², by the displacement in m or rad.

    ``inertia a + damping v + quadratic v|v| + cubic_damping v³ + friction sgn v + stiffness x + square x² + cubic x³ +
    preload sgn x = load + F``

    Attributes:
        name: the model's.
        rotates: whether it is a rotation.
        quadratic: drag, ``quadratic-drag``.
        square: ``quadratic-stiffness``.
        load: ``constant-force``.
        effects: names of the laws that none of these is.
        amplitude: largest that was identified; None where the model does not say.
        state: what the fit left, in words; empty where nothing.
    """

    name: str
    rotates: bool
    inertia: float
    stiffness: float
    cubic: float
    preload: float
    damping: float
    friction: float
    quadratic: float = 0.0
    cubic_damping: float = 0.0
    square: float = 0.0
    load: float = 0.0
    effects: tuple[str, ...] = ()
    amplitude: float | None = None
    state: str = ""

    @property
    def length_unit(self) -> str:
        """Unit of the displacement, as it is printed."""
        return "rad" if self.rotates else "m"

    @property
    def force_unit(self) -> str:
        """Unit of the force or moment, as it is printed."""
        return "N·m" if self.rotates else "N"


#: Laws that are a term of a joint: the parameter that counts, and the term.
_TERMS = {
    "quadratic-drag": ("coefficient", "quadratic"),
    "cubic-damping": ("coefficient", "cubic_damping"),
    "quadratic-stiffness": ("coefficient", "square"),
    "constant-force": ("load", "load"),
}
#: Each term in words, and its unit: F force, X displacement.
_WORDS = {
    "inertia": ("the inertia", "F s²/X"),
    "stiffness": ("the linear spring", "F/X"),
    "square": ("the spring's asymmetry", "F/X²"),
    "cubic": ("the cubic spring", "F/X³"),
    "preload": ("the preload", "F"),
    "damping": ("viscous damping", "F s/X"),
    "quadratic": ("quadratic drag", "F s²/X²"),
    "cubic_damping": ("cubic damping", "F s³/X³"),
    "friction": ("dry friction", "F"),
    "load": ("the constant force", "F"),
}
#: Of the terms of a spring, the power of the displacement.
_POWERS = {"preload": 0, "load": 0, "square": 2, "cubic": 3}


def joint_of(oscillator: Oscillator) -> Joint:
    """The model's terms for such a program.

    Raises:
        BadInput: where the mass is not known, or displacement and force are not in m and N, or rad and N·m.
    """
    unit, force = oscillator.response.displacement_unit, oscillator.force_unit
    if oscillator.mass is None:
        raise BadInput(
            f"{oscillator.name}: its mass is not known, so that its forces are not either; identify it with a force, "
            "or say the mass with dashpot identify --mass KG"
        )
    rotates = next((x == "rad" for x, f in _KINDS if same(unit, x) and same(force, f)), None)
    if rotates is None:
        raise BadInput(
            f"{oscillator.name}: its displacement is in {unit} and its force in {force}, and a joint takes m and N, or "
            "rad and N.m; identify it again with --unit, --force-unit or --calibration, which say what the numbers mean"
        )
    mass, values = oscillator.mass.value, oscillator.values()
    terms = {
        name: mass * values[f"{effect}.{parameter}"]
        for effect, (parameter, name) in _TERMS.items()
        if f"{effect}.{parameter}" in values
    }
    return Joint(
        name=oscillator.name,
        rotates=rotates,
        inertia=mass,
        stiffness=mass * values["omega0"] ** 2,
        cubic=mass * values["cubic"],
        preload=mass * values["preload"],
        damping=mass * values["viscous"],
        friction=mass * values["dry"],
        **terms,
        effects=tuple(term.effect for term in oscillator.terms if term.effect not in _TERMS),
        amplitude=None if oscillator.amplitude is None else oscillator.amplitude.max,
        state=state_of_fit(oscillator) or "",
    )


def left_out(joint: Joint, has: Collection[str], program: str) -> tuple[str, ...]:
    """Each term of the model that is not zero and not among those that the program ``has``, a sentence each."""
    sentences = []
    for name, (words, template) in _WORDS.items():
        value = getattr(joint, name)
        if value and name not in has:
            unit = template.replace("F", joint.force_unit).replace("X", joint.length_unit)
            sentences.append(f"{program} has no place for {words} of {number(value)} {unit}{_share(joint, name)}")
    sentences += [f"{program} has no place for {effect_in_words(effect)}" for effect in joint.effects]
    if joint.state:
        sentences.append(f"the model itself is not all: {joint.state}")
    return tuple(sentences)


def _share(joint: Joint, name: str) -> str:
    """Of a term of the spring, how much it is at the largest amplitude beside the linear spring."""
    if name not in _POWERS or not joint.amplitude or not joint.stiffness:
        return ""
    part = abs(getattr(joint, name)) * joint.amplitude ** _POWERS[name] / (joint.stiffness * joint.amplitude)
    where = f"{number(joint.amplitude)} {pretty_unit(joint.length_unit)}"
    return f", {number(100 * part, 2)} % of the linear spring's force at the largest amplitude identified, {where}"
