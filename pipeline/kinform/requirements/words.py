"""A stored requirement in words, as the page lists it: each value with its unit, by the quantity of its key."""

from __future__ import annotations

from typing import Any

from kinform.foundation import words
from kinform.model.assembly import Assembly
from kinform.model.function import Requirement
from kinform.requirements import KINDS, kind_of
from kinform.requirements.quantity import Quantity, quantities

ADDED = ("rows", "X_WF")
"""Values that kinform adds for itself."""


def requirement_words(assembly: Assembly, requirement: Requirement) -> str:
    """ "clear: between housing and outer_gimbal, distance 0 mm, over ranges"."""
    known = quantities(kind_of(requirement.kind).table) if requirement.kind in KINDS else {}
    joint = requirement.values.get("joint")
    slides = any(j.name == joint and j.type == "prismatic" for j in assembly.function.joints)
    values = [
        f"{key.replace('_', ' ')} {_value_words(assembly.units, known.get(key), value, slides, known)}"
        for key, value in requirement.values.items()
        if value is not None and value != [] and key not in ADDED
    ]
    return f"{requirement.kind.replace('_', ' ')}: {', '.join(values)}"


def _value_words(units: str, quantity: Quantity | None, value: Any, slides: bool, known: dict[str, Quantity]) -> str:
    """A value with its unit; `slides`: whether the joint of the requirement does."""
    if isinstance(value, dict):
        kind = f"{value['type']} " if "type" in value else ""
        rest = [
            f"{key.replace('_', ' ')} {_value_words(units, known.get(key), inner, slides, known)}"
            for key, inner in value.items()
            if key != "type" and key not in ADDED and inner is not None
        ]
        return kind + ", ".join(rest)
    what = "" if quantity is None else quantity.kind
    if isinstance(value, list):
        if value and isinstance(value[0], str):
            return " and ".join(value)
        if what in ("point", "direction", "frame") and value and not isinstance(value[0], list):
            return words.axis(value) if what == "direction" else words.place(value, units)
        return f"({words.counted(len(value), 'value')})"
    if not isinstance(value, int | float):
        return str(value)
    if what == "angle":
        return words.angle(value, 4)
    if what == "length":
        return words.length(value, units)
    if what == "joint_rate":
        return f"{words.length(value, units) if slides else words.angle(value, 4)}/s"
    unit = "" if quantity is None else quantity.unit
    if what == "joint_effort":
        unit = "N" if slides else "N·m"
    return f"{words.number(value)} {unit}".rstrip()
