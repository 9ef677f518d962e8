"""What the page says of joints, contacts, assumptions and requirements, in words."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from kinform.foundation import words
from kinform.model.assembly import Assembly, Assumption
from kinform.model.contacts import Patch
from kinform.model.function import Requirement
from kinform.model.kinematics import Joint

LEAST_GAP = 1e-7
"""m: smaller gaps are not told; meshes are seldom finer."""


ANGLES = ("half_angle", "angle_tolerance")
LENGTHS = ("tolerance", "distance")
DIRECTIONS = ("axis", "direction")
CURVES = ("speeds", "efforts")
"""Values of requirements by what they measure."""
UNITS = {
    ("mass", "minimum"): "kg", ("mass", "maximum"): "kg", ("balance", "limit"): "kg·m",
    ("inertia", "minimum"): "kg·m²", ("inertia", "maximum"): "kg·m²",
    ("reaction", "force"): "N", ("reaction", "torque"): "N·m",
}  # fmt: skip
"""By kind of requirement and value."""
HIDDEN = ("rows", "X_WF")
"""Values that kinform adds for itself."""


def axis(direction: Iterable[float]) -> str:
    """x, -z, or the components."""
    values = [round(float(v), 4) + 0.0 for v in direction]
    for k, name in enumerate("xyz"):
        if abs(values[k]) == 1.0 and values.count(0.0) == 2:
            return name if values[k] > 0.0 else f"-{name}"
    return "(" + ", ".join(f"{v:g}" for v in values) + ")"


def joint_sentence(joint: Joint, units: str) -> str:
    """ "revolute about z through (0, 0, 21) mm"."""
    if joint.type == "general":
        return f"general, {words.counted(joint.freedoms, 'freedom')}"
    text: str = joint.type
    if joint.type != "fixed":
        text += axis_words(joint.type, joint.axis, joint.axis2)
    if joint.pitch is not None:
        text += f", {words.length(joint.pitch, units)} a turn"
    return text + point_words(joint.type, joint.point, units)


def axis_words(type: str, first: Iterable[float] | None, second: Iterable[float] | None) -> str:
    """ " about z and x": the axes of a joint of this type; empty without them."""
    if first is None:
        return ""
    how = {"prismatic": "along", "planar": "normal to"}.get(type, "about")
    return f" {how} {axis(first)}" + ("" if second is None else f" and {axis(second)}")


def point_words(type: str, point: Iterable[float] | None, units: str) -> str:
    """ " through (0, 0, 21) mm": the point (m) of a joint of this type; empty where it means nothing."""
    if point is None or type in ("fixed", "prismatic", "planar"):
        return ""
    return f" through {words.place(point, units)}"


def patch_words(patch: Patch, units: str) -> str:
    """ "cylinder ⌀6 mm, clearance 0.05 mm, 88.2 mm²"."""
    side = " (surface on one side)" if patch.one_sided else ""
    gap = "" if abs(patch.gap) < LEAST_GAP else f", gap {words.length(patch.gap, units, 3)}"
    return f"{patch.kind}{side}{_diameter(patch, units)}, {patch.fit}{gap}, {words.area(patch.area, units)}"


def contact(patches: list[Patch], units: str) -> str:
    """The form behind a joint, in short: kinds with diameter and fit, most area first."""
    ordered = sorted(patches, key=lambda p: (-p.area, p.parts, p.surfaces))
    shown = list(dict.fromkeys(f"{patch.kind}{_diameter(patch, units)} ({patch.fit})" for patch in ordered))
    rest = f" and {len(shown) - 3} more" if len(shown) > 3 else ""
    return ", ".join(shown[:3]) + rest


def assumption(item: Assumption) -> str:
    """What the user states of two parts."""
    return "do not touch" if item.ignore else f"are joined: {item.type}"


def _diameter(patch: Patch, units: str) -> str:
    round = patch.kind in ("cylinder", "sphere") and max(patch.radii) > 0.0
    return f" ⌀{words.length(2.0 * max(patch.radii), units)}" if round else ""


def requirement_words(assembly: Assembly, requirement: Requirement) -> str:
    """ "clear: between housing and outer_gimbal, distance 0 mm, over ranges"."""
    values = [
        f"{key.replace('_', ' ')} {_value_words(assembly, requirement, key, value)}"
        for key, value in requirement.values.items()
        if value is not None and value != [] and key not in HIDDEN
    ]
    return f"{requirement.kind.replace('_', ' ')}: {', '.join(values)}"


def _value_words(assembly: Assembly, requirement: Requirement, key: str, value: Any) -> str:
    """A value of a requirement with its unit, by what its key measures."""
    units = assembly.units
    if isinstance(value, dict):
        kind = f"{value['type']} " if "type" in value else ""
        rest = [f"{k.replace('_', ' ')} {_value_words(assembly, requirement, k, v)}" for k, v in value.items()
                if k != "type" and k not in HIDDEN and v is not None]  # fmt: skip
        return kind + ", ".join(rest)
    if isinstance(value, list):
        if key in CURVES:
            return f"({words.counted(len(value), 'value')})"
        if value and isinstance(value[0], str):
            return " and ".join(value)
        if value and isinstance(value[0], list | dict):
            return f"({words.counted(len(value), 'value')})"
        return axis(value) if key in DIRECTIONS else words.place(value, units)
    if not isinstance(value, int | float):
        return str(value)
    if key in ANGLES:
        return words.angle(value, 4)
    if key in LENGTHS or requirement.kind == "fit":
        return words.length(value, units)
    if key == "limit" and "joint" in requirement.values and requirement.kind != "balance":
        slides = any(j.name == requirement.values["joint"] and j.type == "prismatic" for j in assembly.function.joints)
        if requirement.kind == "speed":
            return f"{words.length(value, units) if slides else words.angle(value, 4)}/s"
        return f"{words.number(value)} {'N' if slides else 'N·m'}"
    unit = UNITS.get((requirement.kind, key), "")
    return f"{words.number(value)} {unit}".rstrip()
