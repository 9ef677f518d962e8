"""The least and the most freedoms that one-sided contact leaves: what of it holds is not known from one pose.

At the low end all contact is kept, as it is at rest. At the high end contact that no stated joint names, and that the
assembly lets separate, is left out: the hook on its lid, the balls of a cradle, a pawl; and joints that are drawn at an
end stop, or whose contact does not decide, have all that it lets go in one sense or the other (`Joint.closed`).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.screws import Frame, scaled, span
from kinform.kinematics.joints.pair.lower_pairs import name_space
from kinform.kinematics.mobility.finite_motion import finite_mobility
from kinform.mechanism.first_order import close
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.kinematics import Coupling, FiniteCertificate, Joint, body_of_part
from kinform.model.names import JointName

Spaces = tuple[Sequence[Array], Sequence[Array]]
"""Motions (k, 6) of each joint at the low and at the high end; all six of one that is left out."""


def mobility_ends(
    graph: JointGraph, ends: Spaces, effective: int, instantaneous: int, size: float, doubts: Array | None
) -> tuple[int, int]:
    """The low and the high end of the effective mobility, which lies between them.

    `ends`: those of the joints; `effective` and `instantaneous` are the counts of the joints as they are; `size` (m)
    and `doubts` are those of the closure.
    """
    counts = []
    for spaces in ends:
        same = all(a is b for a, b in zip(spaces, graph.spaces, strict=True))
        count = instantaneous if same else graph.close(size, doubts, spaces).mobility
        counts.append(effective + count - instantaneous)
    return max(0, min(counts[0], effective)), max(counts[1], effective)


def joint_ends(assembly: Assembly, graph: JointGraph, opened: Collection[JointName]) -> Spaces:
    """The motions (k, 6) of each joint at the low and at the high end; `opened`: joints whose contact the assembly lets
    separate."""
    of_part = body_of_part(graph.bodies)
    named = set()
    for stated in assembly.function.joints:
        sides = {of_part[part] for name in stated.between for part in assembly.parts_of(name)[:1] if part in of_part}
        named.add(tuple(sorted(sides)))
    loose = {joint.name for joint in graph.joints if joint.name in opened and joint.bodies not in named}
    low = [_low(joint) for joint in graph.joints]
    return low, [np.eye(6) if joint.name in loose else _high(joint) for joint in graph.joints]


def certified_at_ends(
    graph: JointGraph,
    ends: Spaces,
    certificates: Iterable[FiniteCertificate],
    size: float,
    ties: Sequence[Coupling] = (),
) -> tuple[FiniteCertificate, ...]:
    """The certificates, with `at_ends` of those that are shaky or singular; `size` (m) and `ties` are those of
    `finite_mobility`."""
    number = {joint.name: k for k, joint in enumerate(graph.joints)}
    out = []
    for one in certificates:
        block = [number[name] for name in one.joints]
        open_to = [
            spaces
            for spaces in ends
            if (one.infinitesimal or one.singular) and any(spaces[k] is not graph.spaces[k] for k in block)
        ]
        out.append(replace(one, at_ends=all(_is_alike(one, graph, block, s, size, ties) for s in open_to)))
    return tuple(out)


def _is_alike(
    one: FiniteCertificate,
    graph: JointGraph,
    block: Sequence[int],
    spaces: Sequence[Array],
    size: float,
    ties: Sequence[Coupling],
) -> bool:
    """Whether a block whose joints have these motions is shaky or singular as its certificate says."""
    kept = [k for k in block if len(spaces[k]) < 6]
    joints = [_moving_by(graph.joints[k], spaces[k], size) for k in kept]
    nodes = sorted({node for k in block for node in graph.edges[k]})
    edges = [(nodes.index(a), nodes.index(b)) for a, b in (graph.edges[k] for k in kept)]
    count = close(len(nodes), edges, [joint.twists for joint in joints], 0, size, None).mobility
    found = finite_mobility(edges, joints, len(nodes), count, size, [t for t in ties if t.through in one.joints])
    return (
        found.count is not None
        and bool(found.infinitesimal) == bool(one.infinitesimal)
        and found.singular == one.singular
    )


def _moving_by(joint: Joint, space: Array, size: float) -> Joint:
    """The joint with other motions (k, 6)."""
    if space is joint.twists:
        return joint
    frame = Frame(np.zeros(3) if joint.point is None else joint.point, size)
    form = name_space(span(scaled(space.T, frame)) if len(space) else np.zeros((6, 0)), frame)
    return replace(joint, type=form.type, twists=space, freedoms=len(space))


def _decided(joint: Joint) -> bool:
    """Whether contact decides the joint."""
    return len(joint.closed) > 0 and joint.status != "stated"


def _low(joint: Joint) -> Array:
    one_sided = _decided(joint) and joint.status != "blocked" and len(joint.at_rest) < len(joint.twists)
    return joint.at_rest if one_sided else joint.twists


def _high(joint: Joint) -> Array:
    open_to = _decided(joint) and (joint.at_stop or joint.status == "ambiguous")
    return joint.closed if open_to and len(joint.closed) > len(joint.twists) else joint.twists
