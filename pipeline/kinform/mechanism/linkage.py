"""A linkage: bodies that joints carry, the coordinates of these joints, and where all bodies are at their values.

The joints are those of one block of loops, of a chain between two bodies, or all: bodies that no joint of the linkage
moves, rest, or move with the body that they hang on by other joints. Coordinates are those of the loop system: angles
in rad, slides in shares of the frame's length; values of joints are in rad and m, as kinform signs them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.screws import Frame
from kinform.foundation.algebra.vectors import norm
from kinform.foundation.graphs.graph import forest
from kinform.frozen import dataclass
from kinform.mechanism.frame import joint_frame
from kinform.mechanism.joint_graph import JointGraph
from kinform.mechanism.loop_system import LoopSystem, loop_system
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.kinematics import Body, Joint
from kinform.model.names import JointName


@dataclass(frozen=True)
class Coordinate:
    """One coordinate of a linkage."""

    joint: JointName
    place: int
    """Of its twist among those of the joint."""
    turns: bool
    """Whether it is an angle."""
    unit: float
    """Coordinate for a value of 1 rad or 1 m of the joint, with the sign of the joint's axis: what results show."""
    rate: float
    """Coordinate for the joint's own twist taken once; a twist is a unit vector only of most joints."""


@dataclass(frozen=True, eq=False)
class Linkage:
    """Bodies, and the coordinates that decide where they are."""

    bodies: tuple[Body, ...]
    """Of the assembly, in the order of `poses`."""
    joints: tuple[Joint, ...]
    system: LoopSystem
    frame: Frame
    coordinates: tuple[Coordinate, ...]
    members: tuple[int, ...]
    """Of the system's bodies, in its order, their places among `bodies`."""
    carrier: Ints
    """(B,) body of the system with which each body moves."""

    @property
    def looped(self) -> bool:
        """Whether there are loops to close, or ratios to keep."""
        return len(self.system.chords[0]) + len(self.system.ties) > 0

    @property
    def turns(self) -> Flags:
        """(n,) coordinates that are angles."""
        return self.system.turns

    @property
    def units(self) -> Array:
        """(n,) coordinates for values of 1 (rad or m)."""
        return np.array([c.unit for c in self.coordinates])

    @property
    def rates(self) -> Array:
        """(n,) coordinates for 1 of each twist of the joints."""
        return np.array([c.rate for c in self.coordinates])

    def index(self, body: str) -> int:
        """Place of a body in the system."""
        return next(n for n, k in enumerate(self.members) if self.bodies[k].name == body)

    def columns(self, joint: str) -> list[int]:
        """Coordinates of a joint."""
        return [n for n, coordinate in enumerate(self.coordinates) if coordinate.joint == joint]

    def poses(self, q: Array) -> Array:
        """(D, B, 4, 4) displacement (m, world) of every body from the pose of the meshes, at coordinates (D, n)."""
        return np.asarray(self.world(self.system.bodies(q))[:, self.carrier])

    def world(self, poses: Array) -> Array:
        """Displacements (…, 4, 4) of the system as displacements in the world (m)."""
        out = poses.copy()
        turned = (poses[..., :3, :3] @ self.frame.centre[:, None])[..., 0]
        out[..., :3, 3] = poses[..., :3, 3] * self.frame.length + self.frame.centre - turned
        return np.asarray(out)

    def local(self, points: Array) -> Array:
        """World points (…, 3) m in the system's units."""
        return np.asarray((points - self.frame.centre) / self.frame.length)


def linkage(
    graph: JointGraph, joints: Sequence[int], size: float, root: int | None = None,
    ties: Sequence[tuple[int, int, float]] = (),
) -> Linkage:  # fmt: skip
    """The linkage that some joints of a graph make, seen from body `root` (ground); `size` of the assembly (m).

    `ties` (a, b, ratio): of joints with one freedom, by their places in `joints`, the first moves by ratio when the
    second moves by one.
    """
    root = graph.ground if root is None else root
    members, edges = [graph.joints[k] for k in joints], [graph.edges[k] for k in joints]
    carried, first = _carried(graph, joints, root)
    frame = joint_frame(members, size)
    system = loop_system(edges, [joint.twists for joint in members], frame, ties, first)
    inside = sorted({n for edge in edges for n in edge} | {first})
    place = {body: n for n, body in enumerate(inside)}
    carrier = np.array([place[body] for body in carried], dtype=np.int64)
    coordinates = _coordinates(members, system, frame)
    return Linkage(graph.bodies, tuple(members), system, frame, coordinates, tuple(inside), carrier)


def _carried(graph: JointGraph, joints: Sequence[int], root: int) -> tuple[list[int], int]:
    """For each body the one of the linkage that carries it, and the first of these, which rests with the root."""
    inside = {body for k in joints for body in graph.edges[k]}
    tree = graph.tree if root == graph.ground else forest(len(graph.bodies), graph.edges, root)
    carried = list(range(len(graph.bodies)))
    for body in tree.order:
        if body not in inside and tree.parent[body] >= 0:
            carried[body] = carried[tree.parent[body]]
    first = next((body for body in tree.order if body in inside and tree.root[body] == tree.root[root]), root)
    return [body if body in inside else first for body in carried], first


def _coordinates(joints: Sequence[Joint], system: LoopSystem, frame: Frame) -> tuple[Coordinate, ...]:
    out: list[Coordinate] = []
    for joint in joints:
        for place, twist in enumerate(joint.twists):
            turns = bool(system.turns[len(out)])
            vector, length = (twist[:3], 1.0) if turns else (twist[3:], frame.length)
            sense = -1.0 if joint.axis is not None and float(vector @ joint.axis) < 0.0 else 1.0
            out.append(Coordinate(joint.name, place, turns, sense / length, norm(vector) / length))
    return tuple(out)
