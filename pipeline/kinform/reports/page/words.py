"""Numbers, names and places as the page writes them."""

from __future__ import annotations

from collections.abc import Iterable

from kinform.foundation import words
from kinform.model.assembly import Assumption
from kinform.model.contacts import Patch
from kinform.model.kinematics import Joint

__all__ = ["assumption", "axis", "contact", "gap_words", "joint_sentence", "number", "patch_words", "place"]

number = words.number
place = words.place


def axis(direction: Iterable[float]) -> str:
    """x, -z, or the components."""
    values = [round(float(v), 4) + 0.0 for v in direction]
    for name, place in (("x", 0), ("y", 1), ("z", 2)):
        unit = [0.0, 0.0, 0.0]
        for sign, text in ((1.0, name), (-1.0, "-" + name)):
            unit[place] = sign
            if values == unit:
                return text
    return "(" + ", ".join(f"{v:g}" for v in values) + ")"


def joint_sentence(joint: Joint, units: str) -> str:
    """ "revolute about z through (0, 0, 21) mm"."""
    if joint.type == "general":
        return f"general, {words.counted(joint.freedoms, 'freedom')}"
    text = joint.type
    if joint.axis is not None and joint.type != "fixed":
        text += f" {'along' if joint.type == 'prismatic' else 'normal to' if joint.type == 'planar' else 'about'} "
        text += axis(joint.axis)
        if joint.axis2 is not None:
            text += f" and {axis(joint.axis2)}"
    if joint.pitch is not None:
        text += f", {words.length(joint.pitch, units)} a turn"
    if joint.point is not None and joint.type not in ("fixed", "prismatic", "planar"):
        text += f" through {place(joint.point, units)}"
    return text


def patch_words(patch: Patch, units: str) -> str:
    """ "cylinder ⌀6 mm, clearance 0.05 mm, 88.2 mm²"."""
    text = patch.kind + (" (surface on one side)" if patch.one_sided else "")
    if patch.kind in ("cylinder", "sphere") and max(patch.radii) > 0.0:
        text += f" ⌀{words.length(2.0 * max(patch.radii), units)}"
    return f"{text}, {patch.fit}{gap_words(patch.gap, units)}, {words.area(patch.area, units)}"


def contact(patches: list[Patch], units: str) -> str:
    """The form behind a joint, in short: kinds with diameter and fit, most area first."""
    seen: dict[str, None] = {}
    for patch in sorted(patches, key=lambda p: (-p.area, p.parts, p.surfaces)):
        text = patch.kind
        if patch.kind in ("cylinder", "sphere") and max(patch.radii) > 0.0:
            text += f" ⌀{words.length(2.0 * max(patch.radii), units)}"
        seen.setdefault(f"{text} ({patch.fit})")
    shown = list(seen)
    rest = f" and {len(shown) - 3} more" if len(shown) > 3 else ""
    return ", ".join(shown[:3]) + rest


def assumption(item: Assumption) -> str:
    """What the user states of two parts."""
    return "do not touch" if item.ignore else f"are joined: {item.type}"


def gap_words(gap: float, units: str) -> str:
    """ ", gap 0.05 mm"; nothing below a ten-millionth of a metre."""
    return "" if abs(gap) < 1e-7 else f", gap {words.length(gap, units, 3)}"
