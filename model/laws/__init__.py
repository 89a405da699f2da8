"""The laws that come with the package, one a file. ``model/library.py`` finds them, and those of users, by name."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from ..law import Law
from . import (
    actuator_backlash,
    actuator_dead_zone,
    actuator_lag,
    actuator_quadratic,
    actuator_saturation,
    actuator_saturation_soft,
    asymmetric_friction,
    asymmetric_friction_dry,
    attached_resonator,
    clearance,
    constant_force,
    cubic_damping,
    cubic_stiffness,
    digressive_damping,
    displacement_dependent_damping,
    dry_friction,
    exponential_spring,
    free_curves,
    free_damping,
    free_spring,
    further_mode,
    gas_spring,
    hysteresis,
    linear_stiffness,
    lugre,
    nonlinear_maxwell,
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
LIBRARY: Mapping[str, Law] = MappingProxyType(
    {
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
            actuator_quadratic,
            sensor_lag,
            sensor_nonlinearity,
            sensor_offset,
            time_delay,
            stiffness_drift,
            stiffness_drift_settling,
            tonal_disturbance,
        )
    }
    | {law.name: law for law in free_curves.LAWS}
)

#: Further modes, which are fitted beside the one that the model is of; no diagnosis asks for them.
MODES: Mapping[str, Law] = MappingProxyType({law.name: law for law in further_mode.LAWS})

#: Laws of dampers, seals, gas and junctions, asked for where a motion was prescribed and the force recorded: along a
#: motion that the laws themselves make they are hardly told from hysteresis and drag. ``--with`` takes them anywhere.
PRESCRIBED: Mapping[str, Law] = MappingProxyType(
    {file.LAW.name: file.LAW for file in (digressive_damping, gas_spring, exponential_spring, lugre, nonlinear_maxwell)}
)

#: Learnt before there were ``free_curves``: model files may have them.
EARLIER: Mapping[str, Law] = MappingProxyType({file.LAW.name: file.LAW for file in (free_spring, free_damping)})

#: What a name may mean beside the library that a diagnosis asks for.
FURTHER: Mapping[str, Law] = MappingProxyType({**MODES, **PRESCRIBED, **EARLIER})
