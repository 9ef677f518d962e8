"""The mobility of a sub-assembly by itself: of its parts among themselves."""

from __future__ import annotations

from collections.abc import Sequence

from kinform.kinematics.mobility.finite_motion import finite_mobility
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.kinematics import Kinematics


def mobility_within(kinematics: Kinematics, part_names: Sequence[str]) -> int | None:
    """Freedoms of some parts among themselves, finite where that is known: the bodies they belong to and
    the joints between those, relative to the first of these bodies (or ground, if it is among them); None where two
    ways to count them disagree."""
    wanted = set(part_names)
    bodies = tuple(b for b in kinematics.bodies if wanted.intersection(b.parts))
    if not bodies:
        return 0
    names = {body.name for body in bodies}
    graph = JointGraph(bodies, tuple(j for j in kinematics.joints if names.issuperset(j.bodies)))
    size = kinematics.matrix.length
    count = graph.close(size).mobility
    finite = finite_mobility(graph.edges, graph.joints, len(bodies), count, size)
    if finite.on_edge:
        return None
    return count if finite.count is None else finite.count


def idle_within(kinematics: Kinematics, part_names: Sequence[str]) -> int:
    """Idle freedoms of bodies all of whose joints are between some parts: `mobility_within` counts them."""
    wanted = set(part_names)
    names = {body.name for body in kinematics.bodies if wanted.intersection(body.parts)}
    outside = {name for joint in kinematics.joints if not names.issuperset(joint.bodies) for name in joint.bodies}
    return sum(freedom.idle and freedom.body in names - outside for freedom in kinematics.mobility.named)
