"""What the tables of requirements share: their name, and what the value of each key is."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, get_args

from pydantic import BaseModel, Field

from kinform.form.tables import Name, Table
from kinform.foundation.meant import in_quotes
from kinform.frozen import dataclass
from kinform.requirements.kind import Fault

QuantityKind = Literal[
    "length", "angle", "point", "direction", "frame", "joint_rate", "joint_values", "joint_effort",
    "place", "joint", "path", "number",
]  # fmt: skip


@dataclass(frozen=True)
class Quantity:
    """What the value of a requirement's key is, so that it can be brought to SI, the world and full names, and shown.

    length, angle: a number or list of numbers. point, direction: three numbers, or a list of such.
    joint_rate: degrees or lengths a second, by the type of the joint that `joint` names.
    joint_values: a list of tables of degrees or lengths by joint. joint_effort: N·m or N by the type of that joint.
    place, joint: a name or list of names. path: a CSV file, whose rows are added to the table as `rows`. frame: lengths
    that stay in the manifest's frame, whose pose is then added as `X_WF`. number: a number in `unit`, as it is.
    """

    kind: QuantityKind
    unit: str = ""


LENGTH = Quantity("length")
ANGLE = Quantity("angle")
POINT = Quantity("point")
DIRECTION = Quantity("direction")
PLACE = Quantity("place")
JOINT = Quantity("joint")
JOINT_VALUES = Quantity("joint_values")
JOINT_EFFORT = Quantity("joint_effort")


class RequirementTable(Table):
    """What every `[[function.require]]` has; `kind` tells the tables apart."""

    name: Name = Field(description="name of the requirement, any text but '/'")


def quantities(table: type[BaseModel]) -> dict[str, Quantity]:
    """The quantities of the keys of a table and of the tables in it, by key."""
    out: dict[str, Quantity] = {}
    for key, field in table.model_fields.items():
        found = next((one for one in field.metadata if isinstance(one, Quantity)), None)
        if found is not None:
            out[key] = found
        for inner in get_args(field.annotation):
            if isinstance(inner, type) and issubclass(inner, BaseModel):
                out |= quantities(inner)
    return out


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
