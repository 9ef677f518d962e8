"""Which joints carry the bodies, and which close loops. Graph questions only, no physics.

Bodies joined by rigid joints are one node; a breadth-first tree from the ground takes each remaining
node up by one joint; the joints left over close loops.
"""

from __future__ import annotations

from collections.abc import Sequence

from kinform.foundation.graphs.graph import UnionFind, forest
from kinform.frozen import dataclass


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
    tree = forest(bodies, edges, root)
    node = {root: 0}
    carried: list[Carried] = []
    for member in tree.order:
        if tree.root[member] != root or member == root:
            continue
        node[member] = len(node)
        k = moving[tree.edge[member]]
        parent = tree.parent[member]
        carried.append(Carried(node[member], node[parent], k, merged.find(joints[k][0]) == parent))
    used = {step.joint for step in carried}
    node_of = tuple(node.get(merged.find(body), -1) for body in range(bodies))
    closing = tuple(k for k in moving if k not in used and node_of[joints[k][0]] >= 0)
    adrift = tuple(body for body in range(bodies) if node_of[body] < 0)
    return Topology(node_of, tuple(carried), closing, adrift)
