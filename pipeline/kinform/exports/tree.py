"""The device as a tree of links, for formats that know nothing else, and the joints that close its loops.

Every link frame has the axes of the world at the pose of the meshes, and its origin on the joint that
carries it, so that an axis reads the same everywhere, and zero is the pose of the meshes. A joint that is
run through from its second body has its motions reversed: the axes change sign, the values do not.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from kinform.behaviour import Ground, JointComponent, RigidBody, System
from kinform.behaviour.primitives import Ball, Primitive
from kinform.foundation.graphs.graph import UnionFind, neighbours
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.simulation.mechanism.topology import arrange


@dataclass(frozen=True, eq=False)
class Motion:
    """One motion of a joint, seen from the parent."""

    name: str
    """The joint's, with that of the coordinate where it has several."""
    primitive: Primitive
    coordinate: int
    """Index among the joint's coordinates."""


def coordinate_names(joint: JointComponent) -> tuple[str, ...]:
    """A name for each coordinate: the joint's, with that of the coordinate where it has several."""
    if joint.kind.rates == 1 or joint.kind.name == "spherical":
        return (joint.subject,) * len(joint.kind.coordinates)
    return tuple(f"{joint.subject}.{coordinate}" for coordinate, _ in joint.kind.coordinates)


@dataclass(frozen=True, eq=False)
class Link:
    """A body, and how its parent carries it. `parent` −1: the root, or a body that is free."""

    body: Ground | RigidBody
    parent: int
    joint: JointComponent | None
    forward: bool
    """The parent is the joint's first body."""
    origin: Array
    """(3,) m, of the link frame in the world at the pose of the meshes."""

    @property
    def motions(self) -> tuple[Motion, ...]:
        """The motions of the joint from the parent to this link."""
        if self.joint is None:
            return ()
        kind = self.joint.kind
        steps = list(zip(kind.chain(self.joint.geometry), kind.uses, strict=True))
        names = coordinate_names(self.joint)
        return tuple(
            Motion(
                names[use],
                primitive if self.forward or isinstance(primitive, Ball) else primitive.reversed(),
                use,
            )
            for primitive, use in (steps if self.forward else reversed(steps))
        )


@dataclass(frozen=True)
class Closing:
    """A joint that closes a loop between two links; `rigid`: both are one body already."""

    joint: JointComponent
    a: int
    b: int
    rigid: bool


@dataclass(frozen=True)
class Tree:
    """Links, parents first, the ground at 0; and the loops."""

    links: tuple[Link, ...]
    closing: tuple[Closing, ...]

    def children(self, link: int) -> tuple[int, ...]:
        """The links that a link carries."""
        return tuple(k for k, other in enumerate(self.links) if other.parent == link)


def grow(system: System, closable: Collection[str] = (), stated: Mapping[str, tuple[bool, int]] | None = None) -> Tree:
    """The tree of a system: that of our simulation; with `closable` kinds of joints, one whose loops are closed
    by joints of these kinds on which nothing acts, where there is a choice; and of these by those that the designer
    states as closing, then by joints that nobody states, then by the last stated.

    `stated`, by name of joint: whether it is stated as closing, and its place among those stated.
    """
    bodies, joints = system.bodies, system.joints
    index = {body.name: k for k, body in enumerate(bodies)}
    pairs = [(index[system.body_at(j.name, "a").name], index[system.body_at(j.name, "b").name]) for j in joints]
    welded = UnionFind(len(bodies))
    kept: list[int] = []
    merged = UnionFind(len(bodies))
    order = _as_simulated(len(bodies), pairs, [j.kind.rates == 0 for j in joints], index[system.ground.name])
    if closable:
        spare = [joint.kind.name in closable and not system.actors(joint.name) for joint in joints]
        said = stated or {}
        place_of = [said.get(joint.subject, (False, len(said))) for joint in joints]
        order.sort(key=lambda k: (joints[k].kind.rates > 0, spare[k], *place_of[k]))
    for k in order:
        a, b = pairs[k]
        if joints[k].kind.rates == 0:
            welded.union(a, b)
        if merged.find(a) != merged.find(b):
            merged.union(a, b)
            kept.append(k)
    near = neighbours(len(bodies), [pairs[k] for k in kept])
    links: list[Link] = []
    place: dict[int, int] = {}
    for root in (index[system.ground.name], *range(len(bodies))):
        if root in place:
            continue
        place[root] = len(links)
        links.append(Link(bodies[root], -1, None, True, _origin(bodies[root], None, np.zeros(3))))
        queue = [root]
        for body in queue:
            for other, edge in near[body]:
                if other in place:
                    continue
                joint, parent = joints[kept[edge]], place[body]
                place[other] = len(links)
                origin = _origin(bodies[other], joint, links[parent].origin)
                links.append(Link(bodies[other], parent, joint, pairs[kept[edge]][0] == body, origin))
                queue.append(other)
    closing = tuple(
        Closing(joints[k], place[pairs[k][0]], place[pairs[k][1]], welded.find(pairs[k][0]) == welded.find(pairs[k][1]))
        for k in range(len(joints))
        if k not in set(kept)
    )
    return Tree(tuple(links), closing)


def _as_simulated(bodies: int, pairs: list[tuple[int, int]], rigid: list[bool], ground: int) -> list[int]:
    """Joints in an order that gives the tree of our simulation: rigid ones, those that carry, the rest."""
    carried = [step.joint for step in arrange(bodies, pairs, rigid, ground).carried]
    first = [k for k, stiff in enumerate(rigid) if stiff] + carried
    return first + [k for k in range(len(pairs)) if k not in set(first)]


def _origin(body: Ground | RigidBody, joint: JointComponent | None, parent: Array) -> Array:
    """On the joint; without one at the centre of mass; the ground's is the world's."""
    if isinstance(body, Ground):
        return np.zeros(3)
    point = None if joint is None else joint.geometry.point
    if point is None:
        point = body.centre_of_mass if joint is None else parent
    return np.asarray(point) if np.all(np.isfinite(point)) else parent
