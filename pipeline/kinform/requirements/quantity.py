"""What the value of a requirement's key is: which numbers are to be converted, and how they are shown."""

from __future__ import annotations

from typing import Any, Literal, get_args

from kinform.frozen import dataclass

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


def quantities(table: Any) -> dict[str, Quantity]:
    """The quantities of the keys of a table (pydantic) and of the tables in it, by key."""
    out: dict[str, Quantity] = {}
    for key, field in table.model_fields.items():
        found = next((one for one in field.metadata if isinstance(one, Quantity)), None)
        if found is not None:
            out[key] = found
        for inner in get_args(field.annotation):
            if hasattr(inner, "model_fields"):
                out |= quantities(inner)
    return out
