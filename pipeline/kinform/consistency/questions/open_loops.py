"""Loops that a tree of stated joints leaves open and contact closes: the linkage still moves with that joint.

A tree of links, as URDF has them, cannot close a loop. Contact between two links that is a joint by itself, and that no
stated joint makes, is the open end of a loop where the loop moves when it is closed there. Contact that would lock the
loop is none: parts that only pass each other.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from kinform.frozen import dataclass
from kinform.kinematics.joints.pair.joint import stated_joint
from kinform.kinematics.joints.pair.lower_pairs import JointForm
from kinform.kinematics.mobility.finite_motion import finite_mobility
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.arrays import Array
from kinform.model.contacts import Contacts
from kinform.model.kinematics import IgnoredContact, Joint, Kinematics

SURFACE = {"revolute": "cylinder", "cylindrical": "cylinder", "spherical": "sphere"}
"""Kind of the surface whose point lies on the axis of such a joint, or is its centre."""
PARALLEL = math.cos(math.radians(1.0))
"""Least cosine of the axes of a joint and of the surface that carries it: fits know them better. Chosen, not
measured."""
MOST_LOOPS = 12
"""Contacts that are tried: more than robots have, and each takes some 10 ms. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class OpenLoop:
    """A loop with the joint that would close it."""

    aside: IgnoredContact
    joint: Joint
    along: tuple[str, ...]
    """Names of the joints in force that the loop goes through, in their order."""
    stated: int
    """Freedoms of these."""
    closed: int
    """Freedoms that are left with the joint, as motions over a distance."""


def open_loops(kinematics: Kinematics, contacts: Contacts) -> Iterator[OpenLoop]:
    """The open loops of a function that states all joints, sorted by their bodies."""
    certain = [a for a in kinematics.asides if a.status == "determined" and a.type in (*SURFACE, "prismatic")]
    for aside in certain[:MOST_LOOPS]:
        point = _point(aside, kinematics, contacts)
        if point is None and aside.type != "prismatic":
            continue
        form = JointForm(aside.type, aside.axis, point)
        loop = _closed(kinematics, aside, stated_joint(aside.bodies, form, "contact", aside.words))
        if loop is not None:
            yield loop


def _point(aside: IgnoredContact, kinematics: Kinematics, contacts: Contacts) -> Array | None:
    """Of the largest surface that carries the joint; None where none does."""
    of_body = {part: body.name for body in kinematics.bodies for part in body.parts}
    found = [
        patch
        for patch in contacts.patches
        if patch.kind == SURFACE.get(aside.type)
        and {of_body[part] for part in patch.parts} == set(aside.bodies)
        and (aside.type == "spherical" or aside.axis is None or abs(float(patch.axis @ aside.axis)) >= PARALLEL)
    ]
    return max(found, key=lambda patch: patch.area).point if found else None


def _closed(kinematics: Kinematics, aside: IgnoredContact, joint: Joint) -> OpenLoop | None:
    """The loop that the joint closes; None where it closes none, or none that is known to move."""
    whole = JointGraph(kinematics.bodies, (*kinematics.joints, joint))
    last = len(kinematics.joints)
    (block,) = (block for block in whole.blocks if last in block)
    along = [whole.joints[k] for k in block if k != last]
    if not along:
        return None
    names = {name for k in block for name in whole.joints[k].bodies}
    graph = JointGraph(tuple(b for b in kinematics.bodies if b.name in names), (*along, joint))
    open_ = JointGraph(graph.bodies, tuple(along))
    size = kinematics.matrix.length
    closure = graph.close(size)
    finite = finite_mobility(graph.edges, graph.joints, len(graph.bodies), closure.mobility, size)
    if not finite.count or finite.on_edge or not _moves(graph, size):
        return None
    stated = open_.close(size).mobility
    return OpenLoop(aside, joint, tuple(str(j.name) for j in along), stated, finite.count)


def _moves(graph: JointGraph, size: float) -> bool:
    """Whether the last joint, and each other of the loop, moves in some freedom."""
    closure = graph.close(size)
    rates = np.abs(closure.sparse_rates.toarray()).max(axis=0, initial=0.0)
    return all(rates[closure.offset[k] : closure.offset[k + 1]].any() for k in range(len(graph.joints)))
