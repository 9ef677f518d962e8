"""Which joints carry the bodies, and which close loops. Graph questions only, no physics.

Bodies joined by rigid joints are one node; the nodes make a mechanism (`mechanism.spanning_tree`).
"""

from __future__ import annotations

from collections.abc import Sequence

from kinform.foundation.graphs.graph import UnionFind
from kinform.frozen import dataclass
from kinform.mechanism.spanning_tree import spanning_tree


@dataclass(frozen=True)
class Carried:
    """A node taken up by a joint: `forward` when the joint's first body is nearer to the ground."""

    node: int
    parent: int
    joint: int
    forward: bool


@dataclass(frozen=True)
class Topology:
    """Nodes are 0 … n−1, 0 the ground; −1 for bodies that no chain of joints connects with it."""

    node_of: tuple[int, ...]
    """Node of each body."""
    carried: tuple[Carried, ...]
    """One a node but the ground, parents first."""
    closing: tuple[int, ...]
    """Joints that close loops, in order."""
    adrift: tuple[int, ...]
    """Bodies that nothing connects with the ground, in order."""


def arrange(bodies: int, joints: Sequence[tuple[int, int]], rigid: Sequence[bool], ground: int) -> Topology:
    """The tree and the loops of joints, pairs of bodies 0 … n−1, some of them rigid."""
    merged = UnionFind(bodies)
    for (a, b), stiff in zip(joints, rigid, strict=True):
        if stiff:
            merged.union(a, b)
    moving = [k for k, stiff in enumerate(rigid) if not stiff]
    edges = [(merged.find(joints[k][0]), merged.find(joints[k][1])) for k in moving]
    root = merged.find(ground)
    tree = spanning_tree(bodies, edges, root)
    node = {root: 0}
    carried: list[Carried] = []
    for step in tree.carried:
        if tree.root[step.body] == root:
            node[step.body] = len(node)
            carried.append(Carried(node[step.body], node[step.parent], moving[step.joint], step.forward))
    node_of = tuple(node.get(merged.find(body), -1) for body in range(bodies))
    closing = tuple(moving[k] for k in tree.closing if node_of[joints[moving[k]][0]] >= 0)
    adrift = tuple(body for body in range(bodies) if node_of[body] < 0)
    return Topology(node_of, tuple(carried), closing, adrift)
