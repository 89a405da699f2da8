"""A sensor that does not read zero at the spring's zero."""

from ..law import Law, LawParameter

LAW = Law(
    name="sensor-offset",
    path="measurement",
    parameters=(LawParameter("offset", "Y", "reading where the true signal is zero", strength=True),),
    record=lambda motion, p, signal: signal + p["offset"],
    equation="record r → r + {offset}",
    sentence="The sensor does not read zero where the spring does: an offset in the record, not in the rig.",
    phrase="a sensor whose zero is not the spring's",
    source="static calibration curve, Doebelin 2003, section 3.3",
    curves="None, once the offset is taken off.",
)
