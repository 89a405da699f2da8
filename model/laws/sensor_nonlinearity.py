"""A sensor whose sensitivity depends on what it measures."""

from ..law import Law, LawParameter

LAW = Law(
    name="sensor-nonlinearity",
    path="measurement",
    parameters=(
        LawParameter("quadratic", "1/Y", "change of sensitivity in proportion to the signal", strength=True),
        LawParameter("cubic", "1/Y2", "change of sensitivity with the squared signal", strength=True),
    ),
    record=lambda motion, p, signal: signal * (1 + p["quadratic"] * signal + p["cubic"] * signal**2),
    equation="record r → r (1 + {quadratic} r + {cubic} r²)",
    sentence="The sensor's sensitivity depends on the displacement: an optical or inductive sensor near the end of "
    "its range.",
    phrase="a sensor whose sensitivity depends on what it measures",
    source="static calibration curve, Doebelin 2003, section 3.3",
    curves="Amplitudes are shown wrong while frequencies are right, so that the backbone is distorted along its "
    "amplitude axis; even harmonics without the restoring force that would make them.",
)
