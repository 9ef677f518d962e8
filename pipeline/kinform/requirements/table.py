"""What the tables of requirements share: their name, and what the value of each key is."""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import Field

from kinform.form.tables import Name, Table
from kinform.foundation.name_hints import in_quotes
from kinform.requirements.kind import Fault


class RequirementTable(Table):
    """What every `[[function.require]]` has; `kind` tells the tables apart."""

    name: Name = Field(description="name of the requirement, any text but '/'")


def bound_faults(minimum: float | None, maximum: float | None) -> Iterator[Fault]:
    """What is wrong with two bounds."""
    if minimum is None and maximum is None:
        yield "it states neither minimum nor maximum", "add one of them", None
    elif minimum is not None and maximum is not None and minimum > maximum:
        yield f"its minimum, {minimum:g}, is above its maximum, {maximum:g}", "exchange them", "minimum"


def side_faults(between: list[str]) -> Iterator[Fault]:
    """What is wrong with two sides."""
    if len(set(between)) < 2:
        yield f"both sides are {in_quotes(between[0])}", "name two different ones", "between"
