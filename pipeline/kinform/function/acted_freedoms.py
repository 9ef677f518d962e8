"""Which freedom of a joint is meant by what acts on it: a drive, an initial value, a limit.

A joint of one freedom leaves no choice. Of several the one is meant that is named (`freedom = "slide"`), or that the
intended joint's type names; else the one that the rest of the assembly leaves. A ram between two pins slides, because
they hold its spin; one between two balls slides too, because its spin turns one body that slides on itself, and moves
nothing else. Where the rest leaves several, or none, nobody but the designer can tell.

The freedoms of the assembly (`Mobility.named`) say how each joint moves in each of them, at the pose of the meshes.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.foundation.rounding import SINGLE
from kinform.foundation.words import counted
from kinform.frozen import dataclass
from kinform.function.joint_names import Resolution, resolve_joint
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.kinematics import Joint, Kinematics

FREEDOMS: Mapping[str, tuple[str, ...]] = {
    "revolute": ("turn",),
    "prismatic": ("slide",),
    "screw": ("turn",),
    "cylindrical": ("turn", "slide"),
    "universal": ("turn", "turn2"),
    "planar": ("turn", "u", "v"),
    "spherical": ("x", "y", "z"),
}
"""What the freedoms of each type of joint are called, in the order of its rates."""

_BY_TYPE = {"revolute": "turn", "prismatic": "slide"}
"""What an intended joint of one freedom means of a joint that has more."""


@dataclass(frozen=True, eq=False)
class ActedFreedom:
    """One freedom of a derived joint."""

    joint: Joint | None
    """None: there is no such joint; `reason` says why."""
    freedom: int | None
    """Which of its rates; None: not known, `reason` says why."""
    sign: int
    """Designer's value = sign · kinform's."""
    reason: str = ""
    because: str = ""
    """Why it is this one, where nothing that is stated says so."""


def acted_freedom(assembly: Assembly, kinematics: Kinematics, name: str, freedom: str = "") -> ActedFreedom:
    """The freedom that is meant by the name of a joint and, where it is stated, of its freedom."""
    found = resolve_joint(assembly, kinematics, name)
    joint = found.joint
    if joint is None:
        return ActedFreedom(None, None, 1, found.reason)
    names = FREEDOMS.get(joint.type, ())
    if not names:
        return ActedFreedom(joint, None, 1, f'the joint "{joint.name}" is {joint.type}: it has no freedom to name')
    if freedom:
        return _named(found, joint, names, freedom)
    if len(names) == 1:
        return ActedFreedom(joint, 0, found.sign)
    by_type = "" if found.intended is None else _BY_TYPE.get(found.intended.type, "")
    if joint.type == "cylindrical" and by_type:
        return ActedFreedom(joint, names.index(by_type), found.sign)
    left, why = _left(kinematics, joint)
    if len(left) == 1:
        chosen = _named(found, joint, names, names[left[0]])
        return ActedFreedom(joint, chosen.freedom, chosen.sign, chosen.reason, why)
    has = f'the joint "{joint.name}" is {joint.type}: it has {counted(len(names), "freedom")}, not one'
    if found.intended is not None and len(FREEDOMS.get(found.intended.type, ())) == 1:
        return ActedFreedom(joint, None, 1, has)
    rest = "at the pose of the meshes the rest of the assembly lets it move in none of them alone"
    if len(left) > 1:
        rest = f"the rest of the assembly leaves it {' and '.join(names[k] for k in left)}"
    return ActedFreedom(joint, None, 1, f"{has}, and {rest}: say which one with freedom = {_or(names)}")


def _or(names: tuple[str, ...]) -> str:
    return " or ".join(f'"{name}"' for name in names)


def _named(found: Resolution, joint: Joint, names: tuple[str, ...], freedom: str) -> ActedFreedom:
    """The freedom of that name, with the designer's sign."""
    if freedom not in names:
        why = f'the joint "{joint.name}" is {joint.type}: it has no freedom "{freedom}", but {_or(names)}'
        return ActedFreedom(joint, None, 1, why)
    index, swapped = names.index(freedom), found.bodies[0] != joint.bodies[0]
    if joint.type == "universal":
        return _of_universal(found, joint, index, swapped)
    if swapped and freedom in ("u", "v", "x", "y", "z"):
        why = (
            f'the freedom "{freedom}" of the {joint.type} joint "{joint.name}" is one of the body '
            f"{joint.bodies[0]}: name that side first in `between`"
        )
        return ActedFreedom(joint, None, 1, why)
    return ActedFreedom(joint, index, 1 if freedom in ("u", "v", "x", "y", "z") else found.sign)


def _of_universal(found: Resolution, joint: Joint, index: int, swapped: bool) -> ActedFreedom:
    """Its first turn is about the axis in the first body: seen from the other side it is the second."""
    intended = found.intended
    place = 1 - index if swapped else index
    sign = -1 if swapped else 1
    meant = None if intended is None else (intended.axis, intended.axis2)[index]
    axis = (joint.axis, joint.axis2)[place]
    if meant is not None and axis is not None and float(np.dot(meant, axis)) < 0.0:
        sign = -sign
    return ActedFreedom(joint, place, sign)


def _left(kinematics: Kinematics, joint: Joint) -> tuple[list[int], str]:
    """The freedoms of a cylindrical joint that the rest of the assembly leaves, but for idle ones, and why no other."""
    if joint.type != "cylindrical" or joint.axis is None:
        return list(range(joint.freedoms)), ""
    joints, length = {other.name: other for other in kinematics.joints}, kinematics.matrix.length
    moves, idle = [], False
    for freedom in kinematics.mobility.named:
        rates, whole = np.zeros(2), 0.0
        for name, twist, rate in freedom.drives:
            moved = rate * _turn_and_slide(joints[name], joints[name].twists[twist]) / (1.0, length)
            whole = max(whole, float(np.abs(moved).max()))
            if name == joint.name:
                rates += moved
        turn, slide = (bool(abs(value) > SINGLE * whole) for value in rates)
        idle = idle or (freedom.idle and turn)
        if not freedom.idle:
            moves.append((turn, slide))
    left = [k for k in (0, 1) if any(move[k] for move in moves)]
    if left == [0, 1] and all(turn == slide for turn, slide in moves):
        return left, ""
    held = "is idle" if idle else "is held by the rest of the assembly"
    return left, (f"its spin {held}" if left == [1] else f"its slide {held}")


def _turn_and_slide(joint: Joint, twist: Array) -> Array:
    """(2,) how fast (rad, m a second) a twist (6,) of a joint turns and slides: about its axis where it has one."""
    point = np.zeros(3) if joint.point is None else joint.point
    there = twist[3:] + cross(twist[:3], point)
    if joint.axis is None:
        return np.array([np.linalg.norm(twist[:3]), np.linalg.norm(there)])
    return np.array([twist[:3] @ joint.axis, there @ joint.axis])
