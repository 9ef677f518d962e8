"""The least and the most freedoms that one-sided contact leaves: what of it holds is not known from one pose.

At the low end all contact is kept, as it is at rest. At the high end contact that no stated joint names, and that the
assembly lets separate, is left out: the hook on its lid, the balls of a cradle, a pawl; and joints that are drawn at an
end stop, or whose contact does not decide, have all that it lets go in one sense or the other (`Joint.closed`).
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from kinform.mechanism.joint_graph import JointGraph
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.kinematics import Joint, body_of_part
from kinform.model.names import JointName


def mobility_ends(
    assembly: Assembly,
    graph: JointGraph,
    opened: Collection[JointName],
    effective: int,
    instantaneous: int,
    size: float,
    doubts: Array | None,
) -> tuple[int, int]:
    """The low and the high end of the effective mobility, which lies between them.

    `opened`: joints whose contact the assembly lets separate; `effective` and `instantaneous` are the counts of the
    joints as they are; `size` (m) and `doubts` are those of the closure.
    """
    of_part = body_of_part(graph.bodies)
    named = set()
    for stated in assembly.function.joints:
        sides = {of_part[part] for name in stated.between for part in assembly.parts_of(name)[:1] if part in of_part}
        named.add(tuple(sorted(sides)))
    loose = {joint.name for joint in graph.joints if joint.name in opened and joint.bodies not in named}
    low = [_low(joint) for joint in graph.joints]
    high = [np.eye(6) if joint.name in loose else _high(joint) for joint in graph.joints]
    counts = []
    for spaces in (low, high):
        same = all(a is b for a, b in zip(spaces, graph.spaces, strict=True))
        count = instantaneous if same else graph.close(size, doubts, spaces).mobility
        counts.append(effective + count - instantaneous)
    return max(0, min(counts[0], effective)), max(counts[1], effective)


def _decided(joint: Joint) -> bool:
    """Whether contact decides the joint."""
    return len(joint.closed) > 0 and joint.status != "stated"


def _low(joint: Joint) -> Array:
    one_sided = _decided(joint) and joint.status != "blocked" and len(joint.at_rest) < len(joint.twists)
    return joint.at_rest if one_sided else joint.twists


def _high(joint: Joint) -> Array:
    open_to = _decided(joint) and (joint.at_stop or joint.status == "ambiguous")
    return joint.closed if open_to and len(joint.closed) > len(joint.twists) else joint.twists
