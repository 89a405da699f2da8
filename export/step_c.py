"""The discrete step of the smooth model and its Jacobian as C: for a controller on a machine of its own."""

from __future__ import annotations

from ..model.law import Expression
from ..simulate.generated_c import generated_c
from .plain_c import Program, own, render_c

#: Suffixes of the two files.
SOURCE, HEADER = "smooth.step.c", "smooth.step.h"


def step_c(step: Expression, prefix: str, title: str, dt: float, header: str) -> tuple[str, str]:
    """C source and header of ``step`` and of its Jacobian by state and force.

    Args:
        step: casadi.Function x_next = step(x, u, p) or (x, u, p, t).
        prefix: what the names in C begin with.
        title: the model, for a comment.
        dt: sample time, s.
        header: file name of the header.

    Raises:
        BadInput: where the temporary folder does not take the generated text.
    """
    import casadi as ca

    names = step.name_in()
    jacobian = step.factory("dp_step_jacobian", names, ["jac:x_next:x", "jac:x_next:u"])
    symbols = [ca.MX.sym(name, step.size1_in(name)) for name in names]
    plain = ca.Function("dp_step", symbols, step.call(symbols))
    dense = ca.Function("dp_step_jacobian", symbols, [ca.densify(m) for m in jacobian.call(symbols)])
    if step.class_name() == "SXFunction":
        plain, dense = plain.expand(), dense.expand()
    generator = ca.CodeGenerator("law.c", {"casadi_int": "int", "with_header": False})
    generator.add(plain)
    generator.add(dense)
    values = {
        "id": prefix,
        "title": title,
        "dt": repr(dt),
        "header": header,
        "n": step.size1_in("x"),
        "np": step.size1_in("p"),
        "timed": "t" in names,
        "sizes": [(f.sz_arg(), f.sz_res(), f.sz_iw() + 1, f.sz_w() + 1) for f in (plain, dense)],
        "body": Program(own(generated_c(generator))),
    }
    return render_c("step.c.j2", values), render_c("step.h.j2", values)
