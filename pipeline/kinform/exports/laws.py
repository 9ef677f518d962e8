"""Tables as polynomials of time, piece by piece."""

from __future__ import annotations

import numpy as np

from kinform.behaviour.signals import Spline, Table

__all__ = ["pieces"]


def pieces(signal: Table | Spline) -> list[tuple[float, float, list[float]]]:
    """(end, start, coefficients from the constant up, in time − start) of each stretch; held before and after."""
    knots = signal.knots
    out = [(knots[0], knots[0], [signal.value(knots[0])])]
    for k, (left, right) in enumerate(zip(knots[:-1], knots[1:], strict=True)):
        if isinstance(signal, Table):
            out.append((right, left, [signal.levels[k], signal.rate(left)]))
        else:
            out.append((right, left, signal.coefficients(k)))
    out.append((np.inf, knots[-1], [signal.value(knots[-1])]))
    return out
