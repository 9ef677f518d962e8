"""What is weighed or measured, beside the bounds that are required of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from kinform.consistency.context import Context
from kinform.consistency.requirements import Answer, bounds, met, undecided, violated
from kinform.consistency.rule import Outcome
from kinform.foundation.words import quoted, telling
from kinform.function.amounts import Amount, amount_of

__all__ = ["amount", "compared", "whose"]

WEIGH = "Give every part of it a density, a material or a mass, and a closed mesh."


def amount(context: Context, name: str | None) -> Amount | Answer:
    """Mass, centre and inertia of a part, a group, or everything."""
    report = context.mass
    if isinstance(report, Outcome):
        return undecided(report.reason, "Run `kinform mass`.")
    parts = [p.name for p in context.assembly.parts] if name is None else list(context.assembly.parts_of(name))
    found = amount_of(report, parts)
    return undecided(found, WEIGH) if isinstance(found, str) else found


def whose(name: str | None) -> str:
    """What is weighed, in words."""
    return "the whole" if name is None else quoted([name])


def compared(
    value: float,
    error: float,
    low: float | None,
    high: float | None,
    what: str,
    told: Callable[[float, int], str],
    remedy: str,
    place: Iterable[float] | None = None,
    cause: str = "by its facets",
    cure: str = "Export a finer mesh.",
) -> Answer:
    """A value with a bound of its error beside the interval that is required. `what` it is ends in "is"."""
    shown = telling(told, value, *(bound for bound in (low, high) if bound is not None))
    wanted, text = bounds(low, high, shown), f"{what} {shown(value)}"
    if low is None and high is None:
        return undecided("it states neither minimum nor maximum", "State one of them.")
    if (low is not None and value + error < low) or (high is not None and value - error > high):
        return violated(
            f"{text}, required is {wanted}", found=shown(value), intended=wanted, remedy=remedy, place=place
        )
    if (low is not None and value - error < low) or (high is not None and value + error > high):
        return undecided(
            f"{text}, give or take {shown(error)} {cause}: too near to the bound",
            cure, found=shown(value), intended=wanted,
        )  # fmt: skip
    return met(text, found=shown(value), intended=wanted)
