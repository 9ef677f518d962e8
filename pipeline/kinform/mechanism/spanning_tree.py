"""The tree of joints that carry the bodies of a mechanism, and the joints left over, which close loops. Graph only.

Breadth first from a root. A joint is passed forwards where its first body is nearer to the root, and else backwards.
"""

from __future__ import annotations

from collections.abc import Sequence

from kinform.foundation.graphs.graph import forest
from kinform.frozen import dataclass


@dataclass(frozen=True)
class Carried:
    """A body that a joint carries."""

    body: int
    parent: int
    joint: int
    forward: bool
    """Whether the joint's first body is its parent."""
    depth: int
    """Joints between it and its root."""


@dataclass(frozen=True)
class SpanningTree:
    """Of bodies 0 … n−1 that joints, pairs of bodies, connect."""

    carried: tuple[Carried, ...]
    """Every body but the roots, parents first."""
    closing: tuple[int, ...]
    """Joints that close loops, in order."""
    root: tuple[int, ...]
    """Of each body: that of the first tree is the root that was asked for."""


def spanning_tree(bodies: int, joints: Sequence[tuple[int, int]], root: int) -> SpanningTree:
    """The trees of joints between bodies 0 … n−1; the first grows from `root`."""
    found = forest(bodies, joints, root)
    depth = found.depths()
    carried = tuple(
        Carried(body, found.parent[body], found.edge[body], joints[found.edge[body]][1] == body, depth[body])
        for body in found.order
        if found.parent[body] >= 0
    )
    used = {one.joint for one in carried}
    return SpanningTree(carried, tuple(k for k in range(len(joints)) if k not in used), found.root)
