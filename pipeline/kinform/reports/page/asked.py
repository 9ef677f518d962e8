"""What a requirement asks for, in words: its kind and the values of the manifest with their units."""

from __future__ import annotations

from typing import Any

from kinform.foundation import words
from kinform.model.assembly import Assembly
from kinform.model.function import Requirement
from kinform.reports.page.words import axis, place

__all__ = ["asked"]

ANGLES = ("half_angle", "angle_tolerance")
LENGTHS = ("tolerance", "distance")
DIRECTIONS = ("axis", "direction")
UNITS = {
    ("mass", "minimum"): "kg", ("mass", "maximum"): "kg", ("balance", "limit"): "kg·m",
    ("inertia", "minimum"): "kg·m²", ("inertia", "maximum"): "kg·m²",
    ("reaction", "force"): "N", ("reaction", "torque"): "N·m",
}  # fmt: skip
HIDDEN = ("rows", "X_WF")
"""Values that kinform adds for itself."""


def asked(assembly: Assembly, requirement: Requirement) -> str:
    """ "clear: between housing and outer_gimbal, distance 0 mm, over ranges"."""
    told = [
        f"{key.replace('_', ' ')} {_told(assembly, requirement, key, value)}"
        for key, value in requirement.values.items()
        if value is not None and value != [] and key not in HIDDEN
    ]
    return f"{requirement.kind.replace('_', ' ')}: {', '.join(told)}"


def _told(assembly: Assembly, requirement: Requirement, key: str, value: Any) -> str:
    units = assembly.units
    if isinstance(value, dict):
        kind = f"{value['type']} " if "type" in value else ""
        rest = [f"{k.replace('_', ' ')} {_told(assembly, requirement, k, v)}" for k, v in value.items()
                if k != "type" and k not in HIDDEN and v is not None]  # fmt: skip
        return kind + ", ".join(rest)
    if isinstance(value, list):
        if value and isinstance(value[0], str):
            return " and ".join(value)
        if value and isinstance(value[0], list | dict):
            return f"({words.counted(len(value), 'value')})"
        return axis(value) if key in DIRECTIONS else place(value, units)
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
