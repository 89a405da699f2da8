"""Derivatives of expressions with kinks: which side of each holds is an argument of its own.

A law may have the size of a state in it (``fabs``), or the larger of two values. Where such a kink is at a surface, the
engine stops there, and rounding alone would decide which of the two slopes its first and last stage see. So the side is
taken from the inside of the piece of motion, and all of its stages have the slopes of that side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..model.law import Expression


@dataclass(frozen=True)
class Sided:
    """A vector of expressions and its Jacobian on given sides of its kinks.

    Attributes:
        sides: one symbol for each kink.
        values: what each of them is at a point: a sign, or whether a comparison holds.
        jacobian: by the variables asked for, an expression of ``sides`` too.
    """

    sides: Expression
    values: Expression
    jacobian: Expression


def sided(vector: Expression, arguments: Sequence[Expression], moving: Expression, by: Expression) -> Sided:
    """The Jacobian of a vector by some of its variables, each kink on a side that is given.

    Args:
        vector: column.
        arguments: all symbols in it, column vectors.
        moving: those that change along the motion; kinks in others are none.
        by: what to differentiate by.
    """
    import casadi as ca

    function = ca.Function("plain", list(arguments), [vector])
    work: list[Expression] = [None] * function.sz_w()
    result = ca.SX.zeros(vector.numel())
    sizes: list[Expression] = []  # a symbol for each result of a kink that has slopes
    made: list[Expression] = []  # ... and what it is
    slopes: list[Expression] = []  # ... and its derivatives
    sides, values = [], []

    def slope(expression: Expression) -> Expression:
        known = ca.vertcat(ca.SX(0, 1), *sizes)
        total = ca.jacobian(expression, by)
        return total + ca.mtimes(ca.jacobian(expression, known), ca.vertcat(*slopes)) if slopes else total

    def side(value: Expression) -> Expression:
        sides.append(ca.SX.sym(f"side{len(sides)}"))
        values.append(value)
        return sides[-1]

    def size(value: Expression, derivative: Expression) -> Expression:
        slopes.append(derivative)
        sizes.append(ca.SX.sym(f"size{len(sizes)}"))
        made.append(value)
        return sizes[-1]

    for place in range(function.n_instructions()):
        operation = function.instruction_id(place)
        taken, put = function.instruction_input(place), function.instruction_output(place)
        if operation == ca.OP_CONST:
            work[put[0]] = ca.SX(function.instruction_constant(place))
        elif operation == ca.OP_INPUT:
            work[put[0]] = arguments[taken[0]][taken[1]]
        elif operation == ca.OP_OUTPUT:
            result[function.sparsity_out(0).row(put[1])] = work[taken[0]]
        else:
            parts = [work[i] for i in taken]
            value = ca.SX.unary(operation, *parts) if len(parts) == 1 else ca.SX.binary(operation, *parts)
            if not ca.depends_on(ca.vertcat(*parts), ca.vertcat(moving, *sizes)):
                pass
            elif operation in (ca.OP_SIGN, ca.OP_LT, ca.OP_LE, ca.OP_EQ, ca.OP_NE):
                value = side(value)
            elif operation == ca.OP_FABS:
                value = size(value, side(ca.sign(parts[0])) * slope(parts[0]))
            elif operation in (ca.OP_FMAX, ca.OP_FMIN):
                first = side(parts[0] >= parts[1] if operation == ca.OP_FMAX else parts[0] <= parts[1])
                value = size(value, first * slope(parts[0]) + (1 - first) * slope(parts[1]))
            work[put[0]] = value
    stacked = ca.vertcat(ca.SX(0, 1), *values)
    jacobian = slope(result)
    for symbol, value in zip(reversed(sizes), reversed(made), strict=True):
        stacked, jacobian = ca.substitute([stacked, jacobian], [symbol], [value])
    for k in reversed(range(len(sides))):  # a comparison may be of what an earlier one has chosen
        if ca.depends_on(stacked, sides[k]):
            (stacked,) = ca.substitute([stacked], [sides[k]], [stacked[k]])
    return Sided(ca.vertcat(ca.SX(0, 1), *sides), stacked, ca.sparsify(jacobian))
