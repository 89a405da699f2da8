"""A further mode of the structure: a linear oscillator beside the mass, whose motion the sensor shows as well."""

from ..law import Expression, Law, LawParameter


def _record(motion, p, signal) -> Expression:
    y = motion.state("displacement", "X")
    w = motion.state("velocity", "X/s")
    rate = p["participation"] * motion.force - p["viscous"] * w - p["frequency"] ** 2 * y
    motion.rate(y, w)
    motion.rate(w, rate)
    return signal + {"displacement": y, "velocity": w, "acceleration": rate}[motion.recorded]


def _law(name: str) -> Law:
    return Law(
        name=name,
        path="measurement",
        parameters=(
            LawParameter("participation", "X/(s2.Q)", "its answer to the force: one over its modal mass"),
            LawParameter("frequency", "rad/s", "its natural frequency", lower=1e-9, probes="lines"),
            LawParameter("viscous", "1/s", "its damping: twice the damping ratio times its frequency"),
        ),
        record=_record,
        equation="record r → r + y, y'' + {viscous} y' + {frequency}² y = {participation} F",
        sentence="A further mode of the structure: the sensor shows its motion beside that of the mass.",
        phrase="a further mode of the structure",
        source="modal superposition, Ewins 2000, section 2.4",
        curves="The amplitude beats where it is near; the record shows two lines.",
    )


#: One for each mode that may be fitted beside another.
LAWS = (_law("further-mode"), _law("further-mode/second"))
