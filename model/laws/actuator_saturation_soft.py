"""An actuator that gives way gradually."""

from ..law import Expression, Law, LawParameter


def _drive(motion, p, force) -> Expression:
    import casadi as ca

    return p["limit"] * ca.tanh(force / p["limit"])


LAW = Law(
    name="actuator-saturation/soft",
    path="excitation",
    parameters=(LawParameter("limit", "Q", "largest force", lower=1e-12, probes=(0.7, 1.5)),),
    drive=_drive,
    equation="F → {limit} tanh(F / {limit})",
    sentence="The actuator gives way gradually towards a largest force: a magnet circuit or a coil leaving its field.",
    phrase="an actuator that gives way gradually towards its largest force",
    source="Gelb and Vander Velde 1968, section 2.3",
    curves="None in free decay; at high levels the response is smaller than the recorded force makes it.",
)
