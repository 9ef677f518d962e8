"""A measured value beside the bounds that a requirement sets it, with the error of the measurement."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from kinform.foundation.words import quoted, telling
from kinform.frozen import dataclass
from kinform.model.findings import Equation, Witness, computed
from kinform.requirements.answer import Answer, Margin, met, undecided, violated
from kinform.requirements.evidence import Amount, Evidence

WEIGH = "Give every part of it a density, a material or a mass, and a closed mesh."


Proof = Callable[[float, float, Mapping[str, float]], Witness | None]
"""(how far a value is beyond its bounds, its error, the bounds by name) → the witness."""


def proof_of_amount(equation: Equation, whole: Amount, **more: Any) -> Proof:
    """The witness of an amount, by this equation."""
    return lambda off, error, bounds: computed(
        equation, off, error, parts=whole.parts, **whole.numbers, **more, **bounds
    )


@dataclass(frozen=True, eq=False)
class Compared:
    """What is compared with a requirement, in words."""

    name: str
    """ "the mass of 'arm'"."""
    shown: Callable[[float, int], str]
    """A value of it, in SI, with so many significant digits."""
    remedy: str
    """What to do where it is out of bounds."""
    unit: str
    """In SI."""
    place: Iterable[float] | None = None
    """(3,) m."""
    cause: str = "by its facets"
    """What its error comes from."""
    cure: str = "Export a finer mesh."
    """What makes its error smaller."""
    proof: Proof | None = None
    """What makes a witness of how far the value is beyond its bounds."""


def beside_bounds(compared: Compared, value: float, error: float, low: float | None, high: float | None) -> Answer:
    """A value with a bound of its error beside the interval that is required."""
    if low is None and high is None:
        return undecided("it states neither minimum nor maximum", "State one of them.")
    shown = telling(compared.shown, value, *(bound for bound in (low, high) if bound is not None))
    wanted, text = _interval(low, high, shown), f"{compared.name} is {shown(value)}"
    low, high = -np.inf if low is None else low, np.inf if high is None else high
    margin = Margin(float(min(value - low, high - value)), compared.unit)
    if value + error < low or value - error > high:
        return violated(
            f"{text}, required is {wanted}", found=shown(value), intended=wanted,
            remedy=compared.remedy, place=compared.place, margin=margin,
            witness=None if compared.proof is None else compared.proof(max(low - value, value - high), error, {
                name: bound for name, bound in (("least", low), ("most", high)) if np.isfinite(bound)
            }),
        )  # fmt: skip
    if value - error < low or value + error > high:
        return undecided(
            f"{text}, give or take {shown(error)} {compared.cause}: too near to the bound",
            compared.cure, found=shown(value), intended=wanted,
        )  # fmt: skip
    return met(text, found=shown(value), intended=wanted, margin=margin)


def amount(evidence: Evidence, name: str | None) -> Amount | Answer:
    """Mass, centre and inertia of a part, a group, or everything. Needs masses."""
    assembly = evidence.assembly
    parts = [p.name for p in assembly.parts] if name is None else list(assembly.parts_of(name))
    result = evidence.amount(parts)
    return undecided(result, WEIGH) if isinstance(result, str) else result


def whose(name: str | None) -> str:
    """What is weighed, in words."""
    return "the whole" if name is None else quoted([name])


def shared_parts(evidence: Evidence, between: Sequence[str]) -> list[str]:
    """Parts that are on both of two sides, sorted."""
    first, second = (evidence.assembly.parts_of(name) for name in between)
    return sorted(set(first) & set(second))


def _interval(low: float | None, high: float | None, shown: Callable[[float], str]) -> str:
    """The interval that is required, in words; one end at least is stated."""
    if low is None or high is None:
        return f"at least {shown(low)}" if low is not None else f"at most {shown(high or 0.0)}"
    return f"{shown(low)} to {shown(high)}"
