"""The graph of an assembly's mechanism: bodies are its nodes, joints its edges, both in the order given."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from kinform.foundation.graphs.graph import Forest, blocks, forest
from kinform.frozen import dataclass
from kinform.mechanism.first_order import Closure, close
from kinform.model.arrays import Array
from kinform.model.kinematics import Body, Joint


@dataclass(frozen=True, eq=False)
class JointGraph:
    """Bodies and the joints between them."""

    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]

    @cached_property
    def node(self) -> dict[str, int]:
        """Number of each body, by its name."""
        return {body.name: k for k, body in enumerate(self.bodies)}

    @cached_property
    def edges(self) -> list[tuple[int, int]]:
        """Numbers of the two bodies of each joint."""
        return [(self.node[first], self.node[second]) for first, second in (joint.bodies for joint in self.joints)]

    @property
    def spaces(self) -> list[Array]:
        """(f, 6) twists (ω; v at the world's origin) of each joint."""
        return [joint.twists for joint in self.joints]

    @property
    def ground(self) -> int:
        """Number of the body that is ground; of the first where none is."""
        return next((k for k, body in enumerate(self.bodies) if body.ground), 0)

    @cached_property
    def tree(self) -> Forest:
        """Breadth-first spanning trees of the bodies; the first grows from ground."""
        return forest(len(self.bodies), self.edges, self.ground)

    @cached_property
    def blocks(self) -> list[list[int]]:
        """Joints of each biconnected block: those of one close no loop."""
        return blocks(len(self.bodies), self.edges)

    @property
    def loops(self) -> list[list[int]]:
        """Joints of each block that has loops."""
        return [block for block in self.blocks if len(block) > 1]

    def close(self, size: float, doubts: Array | None = None, spaces: Sequence[Array] | None = None) -> Closure:
        """Closure of all loops (`first_order.close`), with other `spaces` of the joints where they are given."""
        return close(len(self.bodies), self.edges, spaces or self.spaces, self.ground, size, doubts)
