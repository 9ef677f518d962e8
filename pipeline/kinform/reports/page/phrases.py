"""What the page says of joints, contacts and assumptions, in words."""

from __future__ import annotations

from collections.abc import Iterable

from kinform.foundation import words
from kinform.model.assembly import Assumption
from kinform.model.contacts import Patch
from kinform.model.kinematics import Joint


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
    return f" {how} {words.axis(first)}" + ("" if second is None else f" and {words.axis(second)}")


def point_words(type: str, point: Iterable[float] | None, units: str) -> str:
    """ " through (0, 0, 21) mm": the point (m) of a joint of this type; empty where it means nothing."""
    if point is None or type in ("fixed", "prismatic", "planar"):
        return ""
    return f" through {words.place(point, units)}"


def patch_words(patch: Patch, units: str) -> str:
    """ "cylinder ⌀6 mm, clearance 0.05 mm, 88.2 mm²"."""
    side = " (surface on one side)" if patch.one_sided else ""
    # m: smaller gaps are not told. A mesh of 100 mm in single precision has steps of 1e-8 m, and surfaces are fitted to
    # some of them.
    gap = "" if abs(patch.gap) < 1e-7 else f", gap {words.length(patch.gap, units, 3)}"
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
