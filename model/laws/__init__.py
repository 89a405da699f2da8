"""The library of laws: one law a file, found by its name."""

from __future__ import annotations

import difflib

from ...errors import BadInput
from ..law import Law
from . import (
    actuator_backlash,
    actuator_dead_zone,
    actuator_lag,
    actuator_saturation,
    actuator_saturation_soft,
    asymmetric_friction,
    asymmetric_friction_dry,
    attached_resonator,
    clearance,
    constant_force,
    cubic_damping,
    cubic_stiffness,
    displacement_dependent_damping,
    dry_friction,
    free_damping,
    free_spring,
    hysteresis,
    linear_stiffness,
    one_sided_stop,
    preload,
    quadratic_drag,
    quadratic_stiffness,
    quintic_stiffness,
    sensor_lag,
    sensor_nonlinearity,
    sensor_offset,
    softening_stiffness,
    softening_stiffness_sine,
    stiffness_drift,
    stiffness_drift_settling,
    stribeck,
    time_delay,
    tonal_disturbance,
    two_sided_stop,
    viscoelastic,
    viscous_damping,
)

#: The Eq. 17 family, in the order of the model file.
BASE: tuple[Law, ...] = (
    linear_stiffness.LAW,
    cubic_stiffness.LAW,
    preload.LAW,
    viscous_damping.LAW,
    dry_friction.LAW,
)

#: Further physics that `terms` of the model file may name, the plainer before what resembles it.
LIBRARY: dict[str, Law] = {
    file.LAW.name: file.LAW
    for file in (
        quadratic_stiffness,
        quintic_stiffness,
        softening_stiffness,
        softening_stiffness_sine,
        clearance,
        one_sided_stop,
        two_sided_stop,
        constant_force,
        quadratic_drag,
        cubic_damping,
        displacement_dependent_damping,
        stribeck,
        asymmetric_friction,
        asymmetric_friction_dry,
        hysteresis,
        viscoelastic,
        attached_resonator,
        actuator_lag,
        actuator_saturation,
        actuator_saturation_soft,
        actuator_dead_zone,
        actuator_backlash,
        sensor_lag,
        sensor_nonlinearity,
        sensor_offset,
        time_delay,
        stiffness_drift,
        stiffness_drift_settling,
        tonal_disturbance,
        free_spring,
        free_damping,
    )
}


def find(effect: str) -> Law:
    """The law of that name, of the library or of an installed package; raises BadInput with the closest known names."""
    if effect in LIBRARY:
        return LIBRARY[effect]
    from ..installed_laws import take_installed_laws

    problems = take_installed_laws()
    if effect in LIBRARY:
        return LIBRARY[effect]
    close = difflib.get_close_matches(effect, LIBRARY, n=3, cutoff=0.4)
    known = f"did you mean {', '.join(close)}?" if close else f"known: {', '.join(sorted(LIBRARY)) or 'none yet'}"
    raise BadInput("\n".join([f"effect {effect!r} is not in the library of laws; {known}", *problems]))
