"""Bodies that overlap where nothing mates: what touches there is drawn into the other, and may hold what the found
contact leaves.

A cone in a bottom of too few facets is no contact, but an overlap: the shaft would seem to slide. A joint of one
freedom is not doubted, because it would be none: a horn that is drawn into its motor turns. Nor is a ball, whose neck
may be drawn into the rim of its socket.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from kinform.foundation.words import quoted
from kinform.kinematics.joints.bodies.stated_joints import Pair
from kinform.model.contacts import Interference
from kinform.model.kinematics import Joint
from kinform.model.names import BodyName, PartName


def deepest_overlaps(
    interferences: Iterable[Interference], of_part: Mapping[PartName, BodyName]
) -> dict[Pair, Interference]:
    """The deepest overlap that no mating surfaces explain, of each pair of bodies, in the order of their names."""
    out: dict[Pair, Interference] = {}
    for overlap in interferences:
        a, b = sorted(of_part[part] for part in overlap.parts)
        if a != b and not overlap.mated and ((a, b) not in out or overlap.depth > out[a, b].depth):
            out[a, b] = overlap
    return out


def with_overlap(joint: Joint, overlap: Interference) -> Joint:
    """The joint, which is not certain where it leaves more than one freedom, a slide among them."""
    if joint.status != "determined" or joint.freedoms < 2 or joint.type == "spherical":
        return joint
    reason = (
        f"{joint.freedoms} of 6 freedoms are left, but {quoted(overlap.parts)} overlap by {1e3 * overlap.depth:.2g} mm "
        "where nothing mates: contact that is drawn there may hold some of them"
    )
    return replace(joint, status="ambiguous", reason=reason)
