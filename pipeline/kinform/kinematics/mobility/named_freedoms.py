"""Freedoms of the whole assembly, named: which joint drives each, what follows, and what only spins.

The basis is that of the closure: block by block of the graph, each freedom driven by one joint at rate 1 while the
other drivers rest. Idle turns take the place of one freedom each, so that the others are the effective ones.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np

from kinform.foundation.algebra.vectors import canonical, cross, foot, norm
from kinform.foundation.graphs.graph import Forest, forest
from kinform.foundation.rounding import ARITHMETIC, SOLVED
from kinform.frozen import dataclass
from kinform.mechanism.block_rates import Solution
from kinform.mechanism.first_order import Closure
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.arrays import Array
from kinform.model.kinematics import Freedom, Kinematics, MotionKind
from kinform.model.names import BodyName, JointName


def named_freedoms(
    graph: JointGraph, closure: Closure, idle: Mapping[BodyName, Array], places: Sequence[Array], size: float
) -> tuple[Freedom, ...]:
    """A readable basis of the freedoms of the assembly.

    `closure` of the graph's joints; `idle`: idle turns (k, 6) of bodies (ω; v at the world's origin); `places` (3,) m
    where each body is, for bodies that nothing holds; `size` (m) of the assembly.
    """
    bodies, joints = graph.bodies, graph.joints
    depth = closure.tree.depths()
    owner = np.concatenate([np.zeros(0, np.int64), *(np.full(j.freedoms, k) for k, j in enumerate(joints))]).astype(int)
    looped = [b >= 0 and bool(closure.blocks[b].cycles) for b in closure.block_of]
    spinning = _exchange(graph, closure, idle)
    out = []
    for n, solution in enumerate(closure.solutions):
        if solution.driver >= closure.offset[-1]:
            number = solution.driver - closure.offset[-1]
            root = closure.loose[number // 6]
            axis = np.eye(3)[number % 3]
            kind: MotionKind = "turn" if number % 6 < 3 else "slide"
            out.append(Freedom(None, bodies[root].name, kind, axis, places[root], 0.0, False, False, ()))
            continue
        body, replaced = spinning.get(n, (None, solution))
        k = int(owner[replaced.driver])
        joint, coordinate = joints[k], replaced.driver - closure.offset[k]
        far = max(graph.edges[k], key=lambda node: depth[node])
        kind, axis, point, pitch = _read(joint.twists[coordinate], joint.point, places[far], size)
        drives = tuple(
            (joints[int(owner[c])].name, int(c) - closure.offset[int(owner[c])], float(rate))
            for c, rate in zip(replaced.columns, replaced.rates, strict=True)
        )
        if body is not None:
            turn = idle[body[0]][body[1]]
            kind, axis, point, pitch = _read(turn, joint.point, places[far], size)
        out.append(
            Freedom(
                driver=joint.name,
                body=bodies[far].name if body is None else body[0],
                kind=kind,
                axis=axis,
                point=point,
                pitch=pitch,
                idle=body is not None,
                looped=looped[n],
                drives=drives,
            )
        )
    return tuple(out)


def _read(twist: Array, near: Array | None, place: Array, size: float) -> tuple[MotionKind, Array, Array, float]:
    """Kind, axis, point (m, beside `near`) and pitch (m a turn) of one twist (ω; v at the world's origin) of a body at
    `place` (m) in an assembly of this size (m)."""
    omega, velocity = twist[:3], twist[3:]
    square = float(omega @ omega)
    beside = np.zeros(3) if near is None else near
    there = velocity + cross(omega, place if near is None else near)
    if square * size**2 < SOLVED**2 * float(there @ there):
        return "slide", canonical(there), beside, 0.0
    axis = omega / np.sqrt(square)
    point = foot(cross(omega, velocity) / square, axis, beside)
    pitch = 2.0 * np.pi * float(omega @ velocity) / square
    lost = ARITHMETIC * norm(velocity) / np.sqrt(square)
    # m a turn that is none, as a share of the size of the assembly; a choice: a fine thread has 1e-2 of its screw.
    if abs(pitch) < 1e-6 * size + lost:
        return "turn", canonical(axis), point, 0.0
    return "screw", canonical(axis), point, pitch


def _exchange(
    graph: JointGraph, closure: Closure, idle: Mapping[BodyName, Array]
) -> dict[int, tuple[tuple[BodyName, int], Solution]]:
    """Solutions that an idle turn replaces: their number, the body with the turn's number, and its rates.

    What is left stays a basis (Steinitz); of the joints beside an idle body the one nearest to ground is replaced.
    """
    edges = graph.edges
    around: dict[int, list[int]] = {}
    for k, edge in enumerate(edges):
        for node in edge:
            around.setdefault(node, []).append(k)
    depth = closure.tree.depths()
    near = {
        closure.offset[k] + c: min(depth[n] for n in edges[k])
        for k, j in enumerate(graph.joints)
        for c in range(j.freedoms)
    }
    driven = {solution.driver: n for n, solution in enumerate(closure.solutions)}
    reduced: dict[int, dict[int, float]] = {}
    out: dict[int, tuple[tuple[BodyName, int], Solution]] = {}
    for name in sorted(idle):
        node = graph.node[name]
        for number, turn in enumerate(idle[name]):
            wanted = _rates(turn, node, around.get(node, []), graph, closure.offset)
            parts = {driven[c]: rate for c, rate in wanted.items() if c in driven}
            spun = _sum(closure.solutions, parts)
            # An idle turn is one of the assembly's freedoms when it is within this share of one.
            if _difference(spun, wanted) > 1e-2:
                continue
            rest = dict(parts)
            while taken := sorted(set(rest) & set(reduced)):
                pivot = taken[0]
                factor = rest[pivot] / reduced[pivot][pivot]
                for n, value in reduced[pivot].items():
                    rest[n] = rest.get(n, 0.0) - factor * value
                del rest[pivot]
            # Rate in an idle turn from which on a driver may give way to it.
            drivers = {n: closure.solutions[n].driver for n, value in rest.items() if abs(value) > 0.1}
            if not drivers:
                continue
            chosen = min(drivers, key=lambda n: (near[drivers[n]], n))
            reduced[chosen] = rest
            columns = np.array(sorted(spun), dtype=np.int64)
            rates = np.array([spun[c] for c in sorted(spun)])
            out[chosen] = ((name, number), Solution(drivers[chosen], columns, rates))
    return out


def _rates(turn: Array, node: int, around: Sequence[int], graph: JointGraph, offset: Sequence[int]) -> dict[int, float]:
    """Joint rates when only this body moves, by the joints around it."""
    out: dict[int, float] = {}
    unit = turn / norm(turn[:3])
    for k in around:
        sign = 1.0 if graph.edges[k][1] == node else -1.0
        rates = np.linalg.lstsq(graph.joints[k].twists.T, sign * unit, rcond=None)[0]
        for n, rate in enumerate(rates):
            if abs(rate) > SOLVED:
                out[offset[k] + n] = float(rate)
    return out


def _sum(solutions: Sequence[Solution], parts: Mapping[int, float]) -> dict[int, float]:
    out: dict[int, float] = {}
    for n, factor in parts.items():
        for c, rate in zip(solutions[n].columns.tolist(), solutions[n].rates.tolist(), strict=True):
            out[c] = out.get(c, 0.0) + factor * rate
    largest = max((abs(rate) for rate in out.values()), default=0.0)
    return {c: rate for c, rate in out.items() if abs(rate) > SOLVED * largest}


def _difference(one: Mapping[int, float], other: Mapping[int, float]) -> float:
    return max((abs(one.get(c, 0.0) - other.get(c, 0.0)) for c in {*one, *other}), default=0.0)


@dataclass(frozen=True, eq=False)
class Motions:
    """Twists of bodies for each named freedom, computed as they are asked for: memory stays linear."""

    kinematics: Kinematics
    graph: JointGraph
    tree: Forest

    @staticmethod
    def of(kinematics: Kinematics) -> Motions:
        """For the freedoms that the kinematics name."""
        graph = JointGraph(kinematics.bodies, kinematics.joints)
        return Motions(kinematics, graph, forest(len(graph.bodies), graph.edges, graph.ground))

    @cached_property
    def _number(self) -> dict[JointName, int]:
        """Of each joint."""
        return {joint.name: k for k, joint in enumerate(self.graph.joints)}

    def twists(self, freedom: Freedom) -> dict[BodyName, Array]:
        """Twists (ω; v at the world's origin) of the bodies that move, ground at rest."""
        moving: dict[int, Array] = {}
        rates = self._relative_twists(freedom)
        for node in self._carried(freedom, rates):
            up, edge = self.tree.parent[node], self.tree.edge[node]
            if up < 0:
                if freedom.driver is None and node == self.graph.node[freedom.body]:
                    moving[node] = _unit(freedom)
                continue
            twist, relative = moving.get(up), rates.get(edge)
            if relative is not None:
                forward = self._forward(edge, node)
                twist = forward * relative if twist is None else twist + forward * relative
                if float(np.abs(twist).max()) <= SOLVED * float(np.abs(relative).max()):
                    twist = None
            if twist is not None:
                moving[node] = twist
        return {self.graph.bodies[node].name: twist for node, twist in sorted(moving.items())}

    @cached_property
    def _below(self) -> tuple[dict[int, int], list[list[int]], list[int]]:
        """The node that each edge of the tree carries, the nodes above each, and the place of each in their order."""
        carried = {edge: node for node, edge in enumerate(self.tree.edge) if self.tree.parent[node] >= 0}
        above: list[list[int]] = [[] for _ in self.tree.parent]
        for node, up in enumerate(self.tree.parent):
            if up >= 0:
                above[up].append(node)
        place = [0] * len(above)
        for k, node in enumerate(self.tree.order):
            place[node] = k
        return carried, above, place

    def _carried(self, freedom: Freedom, rates: Mapping[int, Array]) -> list[int]:
        """Nodes that a freedom may move, in the order of the tree: those that its joints carry."""
        carried, above, place = self._below
        waiting = [carried[edge] for edge in rates if edge in carried]
        if freedom.driver is None:
            waiting.append(self.graph.node[freedom.body])
        found: set[int] = set()
        while waiting:
            node = waiting.pop()
            if node not in found:
                found.add(node)
                waiting += above[node]
        return sorted(found, key=place.__getitem__)

    def relative(self, first: str, second: str) -> Array:
        """(k, 6) twists of the second body relative to the first, of the freedoms that have one."""
        path: dict[int, float] = {}
        roots: dict[str, float] = {}
        for name, sign in ((first, -1.0), (second, 1.0)):
            node = self.graph.node[name]
            while self.tree.parent[node] >= 0:
                edge = self.tree.edge[node]
                path[edge] = path.get(edge, 0.0) + sign * self._forward(edge, node)
                node = self.tree.parent[node]
            root = self.graph.bodies[node].name
            roots[root] = roots.get(root, 0.0) + sign
        signs = {edge: sign for edge, sign in path.items() if sign}
        out = []
        for freedom in self.kinematics.mobility.named:
            if freedom.driver is None:
                if roots.get(freedom.body, 0.0):
                    out.append(roots[freedom.body] * _unit(freedom))
                continue
            twist = np.zeros(6)
            for joint, coordinate, rate in freedom.drives:
                edge = self._number[joint]
                if edge in signs:
                    twist += signs[edge] * rate * self.graph.joints[edge].twists[coordinate]
            if np.abs(twist).max() > ARITHMETIC:
                out.append(twist)
        return np.array(out).reshape(-1, 6)

    def _forward(self, edge: int, node: int) -> float:
        """1 where a joint counts the motion of this body, the farther from ground; −1 where that of the other."""
        return 1.0 if self.graph.edges[edge][1] == node else -1.0

    def _relative_twists(self, freedom: Freedom) -> dict[int, Array]:
        """Relative twist of each joint that moves, by its number."""
        out: dict[int, Array] = {}
        for name, coordinate, rate in freedom.drives:
            k = self._number[name]
            out[k] = out.get(k, np.zeros(6)) + rate * self.graph.joints[k].twists[coordinate]
        return out


def _unit(freedom: Freedom) -> Array:
    """The twist of a body that nothing holds."""
    if freedom.kind == "slide":
        return np.concatenate([np.zeros(3), freedom.axis])
    return np.concatenate([freedom.axis, cross(freedom.point, freedom.axis)])
