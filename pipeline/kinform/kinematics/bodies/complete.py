"""`[function] complete = true`: every joint that is meant to move is stated; what no contact holds is taken as stated.

Robot descriptions end their meshes at a flange or leave a gap: pins and bearings are in no mesh. With a function that
says that it is complete
- a stated fixed joint makes its two sides one body;
- contact between bodies that stated joints move relative to each other, and that no stated joint joins, constrains
  nothing: crossing legs, link 0 on link 2 (it is reported: KF406, KF407);
- a stated joint that contact does not hold, or that has no contact, is taken as stated; what contact forbids, and what
  it leaves ambiguous, stays as contact has it.

It covers the parts of its own file. Parts that no stated joint reaches are decided by contact as ever.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.foundation.graphs.graph import UnionFind
from kinform.kinematics.bodies.merging import Merger
from kinform.kinematics.bodies.stated_joints import Pair, joint_form, pair_between
from kinform.kinematics.constants import ADMITTED
from kinform.kinematics.pair.joint import stated_joint, twists_of
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Joint
from kinform.model.names import BodyName, PartName


def complete_joints(assembly: Assembly) -> tuple[IntendedJoint, ...]:
    """The intended joints of manifests that say that they are complete."""
    covered = set(assembly.function.complete)
    return tuple(j for j in assembly.function.joints if j.name[: j.name.rfind("/") + 1] in covered)


def without_effect(assembly: Assembly, merger: Merger) -> Callable[[PartName, PartName], bool]:
    """Tells of two parts whether contact between them constrains nothing, as bodies are now."""
    pairs: set[frozenset[int]] = set()
    numbers: dict[int, int] = {}
    for joint in complete_joints(assembly):
        if joint.type != "fixed":
            ends = [merger.root(assembly.parts_of(name)[0]) for name in joint.between]
            pairs.add(frozenset(ends))
            for end in ends:
                numbers.setdefault(end, len(numbers))
    chained = UnionFind(len(numbers))
    for pair in pairs:
        chained.union(*(numbers[end] for end in (min(pair), max(pair))))

    def nothing(first: PartName, second: PartName) -> bool:
        a, b = merger.root(first), merger.root(second)
        if a not in numbers or b not in numbers or frozenset((a, b)) in pairs:
            return False
        return chained.find(numbers[a]) == chained.find(numbers[b])

    return nothing


def as_stated(
    assembly: Assembly, of_part: Mapping[PartName, BodyName], decided: Mapping[Pair, Joint], size: float
) -> dict[Pair, Joint]:
    """The joints that are taken as stated. `decided` are those of contact, `size` (m) is that of the assembly."""
    meshed = {of_part[part.name] for part in assembly.parts if part.mesh is not None}
    out: dict[Pair, Joint] = {}
    for intended in complete_joints(assembly):
        pair = pair_between(assembly, of_part, intended.between)
        if pair is None or intended.type == "fixed" or not meshed.issuperset(pair):
            continue
        found = decided.get(pair)
        if found is not None and (found.type == intended.type or not leaves_free(found, intended, size)):
            continue
        held = f"{found.type} by contact, which leaves more free" if found is not None else "no contact"
        joint = stated_joint(pair, joint_form(assembly, of_part, intended, pair), "function",
                             f"intended joint {intended.name} of a complete function: {held}")  # fmt: skip
        motion = "" if found is None else found.motion or f"{found.freedoms} freedoms"
        out[pair] = replace(joint, status="stated", motion=motion)
    return out


def leaves_free(found: Joint, intended: IntendedJoint, size: float) -> bool:
    """Whether a joint that is certain lets everything move that the intended one does, and more; `size` in m."""
    if found.status not in ("determined", "inferred") or intended.type not in ONE_BASIS:
        return False
    if (intended.axis is None and intended.type != "spherical") or (
        intended.point is None and intended.type not in ("prismatic", "planar")
    ):
        return False
    place = found.point if found.point is not None else np.zeros(3)
    point = place if intended.point is None else intended.point
    wanted = _scaled(twists_of(intended.type, intended.axis, point, intended.pitch, intended.axis2), point, size)
    free = _scaled(found.twists, point, size)
    if len(free) <= len(wanted):
        return False
    basis, _ = np.linalg.qr(free.T)
    rest = wanted - (wanted @ basis) @ basis.T
    return bool((np.linalg.norm(rest, axis=1) <= ADMITTED * np.linalg.norm(wanted, axis=1)).all())


ONE_BASIS = ("revolute", "prismatic", "cylindrical", "spherical", "planar", "screw", "universal")
"""Types whose freedoms axis and point give."""


def _scaled(twists: Array, point: Array, size: float) -> Array:
    """Twists (n, 6) at the origin, as (ω; v over the size) at a point (3,)."""
    turns = twists[:, :3]
    return np.hstack([turns, (twists[:, 3:] + cross(turns, np.broadcast_to(point, turns.shape))) / size])
