"""How bodies move relative to one of them: joint coordinates, their ranges, loops that stay closed.

A chain holds the joints on all paths between its bodies and nothing else; poses are displacements from the pose of
the meshes, relative to its root. Joints that are ambiguous, or known by their velocities only, have no poses: a
chain through one is refused with the reason. Ranges are those of the function and those that were found.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from kinform.foundation.algebra.screws import Frame
from kinform.foundation.algebra.subspaces import null_space
from kinform.foundation.algebra.vectors import cross
from kinform.foundation.graphs.graph import blocks
from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.frozen import dataclass
from kinform.function.joint_names import stated_ranges
from kinform.kinematics.joints.bodies.extents import Extents
from kinform.mechanism.constants import FREE
from kinform.mechanism.joint_graph import JointGraph
from kinform.mechanism.linkage import Linkage, linkage
from kinform.mechanism.loop_system import LoopSystem
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.kinematics import Kinematics


@dataclass(frozen=True)
class Coordinate:
    """One coordinate of a chain. Values in rad, or m, of the joint as kinform signs it."""

    joint: str
    turns: bool
    unit: float
    """Coordinate of the system for a value of 1."""
    lower: float
    upper: float
    """±inf where there is no bound, or none is known."""
    known: bool
    """Whether a range is stated or was found."""


@dataclass(frozen=True, eq=False)
class Chain:
    """Bodies, and the coordinates that decide where they are, with their ranges."""

    linkage: Linkage
    coordinates: tuple[Coordinate, ...]

    @property
    def system(self) -> LoopSystem:
        """The loops of the chain."""
        return self.linkage.system

    @property
    def frame(self) -> Frame:
        """That scales it."""
        return self.linkage.frame

    @property
    def bodies(self) -> tuple[str, ...]:
        """In the order of the system's bodies."""
        return tuple(str(self.linkage.bodies[k].name) for k in self.linkage.members)

    @property
    def looped(self) -> bool:
        """Whether there are loops to close, or ratios to keep."""
        return self.linkage.looped

    @property
    def freedoms(self) -> int:
        """Freedoms of first order in the pose of the meshes."""
        return len(null_space(self._rows, FREE))

    @property
    def _rows(self) -> Array:
        """(6 loops + ties, n) Jacobian of the loops in the pose of the meshes."""
        return np.asarray(self.system.equations(self.system.start).jacobian[0])

    @property
    def lower(self) -> Array:
        """(n,) least coordinates."""
        return np.array([min(c.unit * c.lower, c.unit * c.upper) for c in self.coordinates])

    @property
    def upper(self) -> Array:
        """(n,) greatest coordinates."""
        return np.array([max(c.unit * c.lower, c.unit * c.upper) for c in self.coordinates])

    @property
    def unknown(self) -> tuple[str, ...]:
        """Joints of which no range is known."""
        return tuple(dict.fromkeys(c.joint for c in self.coordinates if not c.known))

    def undetermined(self, body: str) -> tuple[str, ...]:
        """Joints without a known range that can move the body, in the pose of the meshes, while all joints with one
        stand still."""
        held = np.eye(len(self.coordinates))[[c.known for c in self.coordinates]]
        tip = self.system.reach[self.index(body)]
        moved = [
            [c.joint for c, rate in zip(self.coordinates, loose, strict=True) if abs(rate) > SINGLE]
            for loose in null_space(np.concatenate([self._rows, held]), FREE)
            if np.abs((tip * loose) @ self.system.screws).max() > SOLVED
        ]
        return tuple(dict.fromkeys(name for names in moved for name in names))

    def screws(self, body: str) -> dict[str, Array] | None:
        """Unit screws (n, 6) (ω; v at the world's origin) from the root to a body, in the order in which they act, and
        the least and the greatest value (rad or m) of each; None where loops close."""
        if self.looped:
            return None
        system, tip = self.system, self.index(body)
        twists, units, order = system.screws, np.where(system.turns, 1.0, self.frame.length), list[int]()
        for nodes, parents, members, backward in reversed(system.depths):
            for node, parent, member, back in zip(nodes, parents, members, backward, strict=True):
                if node == tip:
                    of_joint = np.flatnonzero(system.joint == member).tolist()
                    order[:0] = of_joint[::-1] if back else of_joint
                    tip = int(parent)
        sense = system.reach[self.index(body)][order]
        world = twists[order] * sense[:, None]
        v = world[:, 3:] * np.where(system.turns[order], self.frame.length, 1.0)[:, None]
        v = v - cross(world[:, :3], np.broadcast_to(self.frame.centre, v.shape))
        low, high = np.sort([sense * self.lower[order], sense * self.upper[order]], axis=0) * units[order]
        return {"screws": np.concatenate([world[:, :3], v], axis=1), "lower": low, "upper": high}

    def index(self, body: str) -> int:
        """Number of a body in the system."""
        return self.linkage.index(body)


def chain_between(
    assembly: Assembly, kinematics: Kinematics, root: str, tip: str, prefer: Literal["both", "stated"] = "both"
) -> Chain | str:
    """The chain of all paths between two bodies, or why there is none.

    `prefer`: the narrower of stated and found ranges ("both"), or the stated where there is one ("stated").
    """
    graph = JointGraph(kinematics.bodies, kinematics.joints)
    extra = len(graph.edges)
    every = blocks(len(graph.bodies), [*graph.edges, (graph.node[root], graph.node[tip])])
    used = [k for k in next(block for block in every if extra in block) if k != extra]
    if not used:
        return f"no joints connect '{root}' and '{tip}'"
    return _chain(assembly, kinematics, graph, used, root, prefer)


def mechanism_of(assembly: Assembly, kinematics: Kinematics) -> Chain | str:
    """Everything that joints connect with the ground."""
    if not any(body.ground for body in kinematics.bodies):
        return "there is no ground"
    graph = JointGraph(kinematics.bodies, kinematics.joints)
    reached = [root == graph.ground for root in graph.tree.root]
    used = [k for k, (a, _) in enumerate(graph.edges) if reached[a]]
    if not used:
        return "nothing is joined to the ground"
    return _chain(assembly, kinematics, graph, used, str(graph.bodies[graph.ground].name), "both")


def _chain(
    assembly: Assembly, kinematics: Kinematics, graph: JointGraph, used: Sequence[int], root: str, prefer: str
) -> Chain | str:
    """The chain of these joints, or why it has no poses; what gears tie are coordinates with a fixed ratio."""
    teeth = {coupling.through: coupling for coupling in kinematics.couplings if coupling.meshing is not None}
    joints = [graph.joints[k] for k in used]
    for joint in joints:
        if joint.status == "ambiguous":
            return f"joint '{joint.name}' is ambiguous: {joint.reason}"
        if joint.type == "general" and joint.freedoms and joint.name not in teeth:
            return f"joint '{joint.name}' is known by its velocities only"
    geared = [teeth[joint.name] for joint in joints if joint.type == "general" and joint.name in teeth]
    kept = [k for k in used if graph.joints[k].type != "general" or graph.joints[k].name not in teeth]
    index = {graph.joints[k].name: n for n, k in enumerate(kept)}
    if not all(name in index for coupling in geared for name in coupling.joints):
        return f"the teeth of '{geared[0].through}' couple joints beside the chain"
    ties = [(index[c.joints[0]], index[c.joints[1]], c.meshing.ratio) for c in geared if c.meshing is not None]
    made = linkage(graph, kept, Extents(assembly).assembly, graph.node[root], ties)
    ranges = _ranges(assembly, kinematics, prefer)
    freedoms = {joint.name: joint.freedoms for joint in made.joints}
    coordinates = []
    for c in made.coordinates:
        single = freedoms[c.joint] == 1 and c.joint in ranges
        low, high = ranges[c.joint] if single else (-math.inf, math.inf)
        coordinates.append(Coordinate(c.joint, c.turns, c.unit, low, high, single))
    return Chain(made, tuple(coordinates))


def _ranges(assembly: Assembly, kinematics: Kinematics, prefer: str) -> dict[str, tuple[float, float]]:
    """Known ranges of joints, in kinform's sign."""
    out: dict[str, tuple[float, float]] = {}
    for joint in kinematics.joints:
        if joint.range_status in ("found", "unbounded"):
            low = -math.inf if joint.range_lower is None else joint.range_lower
            high = math.inf if joint.range_upper is None else joint.range_upper
            out[joint.name] = (low, high)
    for name, (low, high) in stated_ranges(assembly, kinematics):
        if prefer == "both" and name in out:
            low, high = max(low, out[name][0]), min(high, out[name][1])
        out[name] = (low, high)
    return out
