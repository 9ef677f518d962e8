"""Freedoms of the whole assembly, named: which joint drives each, what follows, and what only spins.

The basis is that of the closure: block by block of the graph, each freedom driven by one joint at rate 1 while the
other drivers rest. Idle turns take the place of one freedom each, so that the others are the effective ones.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinform.foundation.algebra.vectors import canonical, cross
from kinform.foundation.graphs.graph import Forest, forest
from kinform.kinematics.mobility.closure import Closure
from kinform.kinematics.mobility.loops import ROUNDING, Solution
from kinform.model.arrays import Array
from kinform.model.kinematics import Body, Freedom, Joint, Kinematics
from kinform.model.names import BodyName

__all__ = ["Motions", "named_freedoms"]


SAME = 1e-2
"""An idle turn is one of the assembly's freedoms when it is within this share of one."""


def named_freedoms(
    bodies: Sequence[Body],
    joints: Sequence[Joint],
    closure: Closure,
    idle: Mapping[BodyName, Array],
    places: Sequence[Array],
) -> tuple[Freedom, ...]:
    """A readable basis of the freedoms of the assembly.

    `closure` of these joints; `idle`: idle turns (k, 6) of bodies (ω; v at the world's origin); `places` (3,) m where
    each body is, for bodies that nothing holds.
    """
    index = {body.name: n for n, body in enumerate(bodies)}
    edges = [(index[j.bodies[0]], index[j.bodies[1]]) for j in joints]
    depth = _depths(closure.tree)
    owner = np.concatenate([np.zeros(0, np.int64), *(np.full(j.freedoms, k) for k, j in enumerate(joints))]).astype(int)
    looped = [b >= 0 and bool(closure.blocks[b].cycles) for b in closure.block_of]
    spinning = _exchanged(bodies, joints, edges, closure, idle)
    out = []
    for n, solution in enumerate(closure.solutions):
        if solution.driver >= closure.offset[-1]:
            number = solution.driver - closure.offset[-1]
            root = closure.loose[number // 6]
            axis = np.eye(3)[number % 3]
            kind = "turn" if number % 6 < 3 else "slide"
            out.append(Freedom(None, bodies[root].name, kind, axis, places[root], 0.0, False, False, ()))
            continue
        body, replaced = spinning.get(n, (None, solution))
        k = int(owner[replaced.driver])
        joint, coordinate = joints[k], replaced.driver - closure.offset[k]
        kind, axis, point, pitch = _read(joint.twists[coordinate], joint.point)
        far = max(edges[k], key=lambda node: depth[node])
        drives = tuple(
            (joints[int(owner[c])].name, int(c) - closure.offset[int(owner[c])], float(rate))
            for c, rate in zip(replaced.columns, replaced.rates, strict=True)
        )
        if body is not None:
            turn = idle[body[0]][body[1]]
            kind, axis, point, pitch = _read(turn, joint.point)
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


def _depths(tree: Forest) -> list[int]:
    depth = [0] * len(tree.parent)
    for node in tree.order:
        if tree.parent[node] >= 0:
            depth[node] = depth[tree.parent[node]] + 1
    return depth


def _read(twist: Array, near: Array | None) -> tuple[str, Array, Array, float]:
    """Kind, axis, point (m, beside `near`) and pitch (m a turn) of one twist."""
    omega, velocity = twist[:3], twist[3:]
    square = float(omega @ omega)
    beside = np.zeros(3) if near is None else near
    if square < 1e-20 * max(float(velocity @ velocity), 1.0):
        return "slide", canonical(velocity), beside, 0.0
    axis = omega / np.sqrt(square)
    foot = cross(omega, velocity) / square
    point = foot + axis * float(axis @ (beside - foot))
    pitch = 2.0 * np.pi * float(omega @ velocity) / square
    scale = max(1.0, float(np.linalg.norm(velocity)) / np.sqrt(square))
    if abs(pitch) < 1e-6 * scale:
        return "turn", canonical(axis), point, 0.0
    return "screw", canonical(axis), point, pitch


def _exchanged(
    bodies: Sequence[Body],
    joints: Sequence[Joint],
    edges: Sequence[tuple[int, int]],
    closure: Closure,
    idle: Mapping[BodyName, Array],
) -> dict[int, tuple[tuple[BodyName, int], Solution]]:
    """Solutions that an idle turn replaces: their number, the body with the turn's number, and its rates.

    What is left stays a basis (Steinitz); of the joints beside an idle body the one nearest to ground is replaced.
    """
    index = {body.name: n for n, body in enumerate(bodies)}
    around: dict[int, list[int]] = {}
    for k, edge in enumerate(edges):
        for node in edge:
            around.setdefault(node, []).append(k)
    depth = _depths(closure.tree)
    near = {
        closure.offset[k] + c: min(depth[n] for n in edges[k]) for k, j in enumerate(joints) for c in range(j.freedoms)
    }
    driven = {solution.driver: n for n, solution in enumerate(closure.solutions)}
    reduced: dict[int, dict[int, float]] = {}
    out: dict[int, tuple[tuple[BodyName, int], Solution]] = {}
    for name in sorted(idle):
        node = index[name]
        for number, turn in enumerate(idle[name]):
            wanted = _rates(turn, node, around.get(node, []), joints, edges, closure.offset)
            parts = {driven[c]: rate for c, rate in wanted.items() if c in driven}
            spun = _sum(closure.solutions, parts)
            if _apart(spun, wanted) > SAME:
                continue
            rest = dict(parts)
            while taken := sorted(set(rest) & set(reduced)):
                pivot = taken[0]
                factor = rest[pivot] / reduced[pivot][pivot]
                for n, value in reduced[pivot].items():
                    rest[n] = rest.get(n, 0.0) - factor * value
                del rest[pivot]
            drivers = {n: closure.solutions[n].driver for n, value in rest.items() if abs(value) > 0.1}
            if not drivers:
                continue
            chosen = min(drivers, key=lambda n: (near[drivers[n]], n))
            reduced[chosen] = rest
            columns = np.array(sorted(spun), dtype=np.int64)
            rates = np.array([spun[c] for c in sorted(spun)])
            out[chosen] = ((name, number), Solution(drivers[chosen], columns, rates))
    return out


def _rates(
    turn: Array,
    node: int,
    around: Sequence[int],
    joints: Sequence[Joint],
    edges: Sequence[tuple[int, int]],
    offset: Sequence[int],
) -> dict[int, float]:
    """Joint rates when only this body moves."""
    out: dict[int, float] = {}
    unit = turn / float(np.linalg.norm(turn[:3]))
    for k in around:
        sign = 1.0 if edges[k][1] == node else -1.0
        rates = np.linalg.lstsq(joints[k].twists.T, sign * unit, rcond=None)[0]
        for n, rate in enumerate(rates):
            if abs(rate) > 1e-9:
                out[offset[k] + n] = float(rate)
    return out


def _sum(solutions: Sequence[Solution], parts: Mapping[int, float]) -> dict[int, float]:
    out: dict[int, float] = {}
    for n, factor in parts.items():
        for c, rate in zip(solutions[n].columns.tolist(), solutions[n].rates.tolist(), strict=True):
            out[c] = out.get(c, 0.0) + factor * rate
    largest = max((abs(rate) for rate in out.values()), default=0.0)
    return {c: rate for c, rate in out.items() if abs(rate) > ROUNDING * largest}


def _apart(one: Mapping[int, float], other: Mapping[int, float]) -> float:
    return max((abs(one.get(c, 0.0) - other.get(c, 0.0)) for c in {*one, *other}), default=0.0)


@dataclass(frozen=True, eq=False)
class Motions:
    """Twists of bodies for each named freedom, computed as they are asked for: memory stays linear."""

    kinematics: Kinematics
    tree: Forest
    index: dict[str, int]
    """Of each body."""
    number: dict[str, int]
    """Of each joint."""

    @staticmethod
    def of(kinematics: Kinematics) -> Motions:
        """For the freedoms that the kinematics name."""
        index = {str(body.name): n for n, body in enumerate(kinematics.bodies)}
        edges = [(index[j.bodies[0]], index[j.bodies[1]]) for j in kinematics.joints]
        ground = next((n for n, body in enumerate(kinematics.bodies) if body.ground), 0)
        number = {str(j.name): k for k, j in enumerate(kinematics.joints)}
        return Motions(kinematics, forest(len(index), edges, ground), index, number)

    def twists(self, freedom: Freedom) -> dict[BodyName, Array]:
        """Twists (ω; v at the world's origin) of the bodies that move, ground at rest."""
        moving: dict[int, Array] = {}
        own = self._own(freedom)
        for node in self.tree.order:
            up = self.tree.parent[node]
            twist = moving.get(up)
            edge = self.tree.edge[node]
            if up < 0:
                if freedom.driver is None and node == self.index[freedom.body]:
                    moving[node] = _unit(freedom)
                continue
            relative = own.get(edge)
            if relative is not None:
                joint = self.kinematics.joints[edge]
                forward = 1.0 if self.index[joint.bodies[1]] == node else -1.0
                twist = forward * relative if twist is None else twist + forward * relative
                if float(np.abs(twist).max()) <= 1e-9 * float(np.abs(relative).max()):
                    twist = None
            if twist is not None:
                moving[node] = twist
        return {self.kinematics.bodies[node].name: twist for node, twist in sorted(moving.items())}

    def relative(self, first: str, second: str) -> Array:
        """(k, 6) twists of the second body relative to the first, of the freedoms that have one."""
        path: dict[int, float] = {}
        roots: dict[str, float] = {}
        for name, sign in ((first, -1.0), (second, 1.0)):
            node = self.index[name]
            while self.tree.parent[node] >= 0:
                edge = self.tree.edge[node]
                forward = 1.0 if self.index[self.kinematics.joints[edge].bodies[1]] == node else -1.0
                path[edge] = path.get(edge, 0.0) + sign * forward
                node = self.tree.parent[node]
            roots[self.kinematics.bodies[node].name] = roots.get(self.kinematics.bodies[node].name, 0.0) + sign
        numbers = {self.kinematics.joints[edge].name: sign for edge, sign in path.items() if sign}
        twists_of = {j.name: j.twists for j in self.kinematics.joints if j.name in numbers}
        out = []
        for freedom in self.kinematics.mobility.named:
            if freedom.driver is None:
                if roots.get(freedom.body, 0.0):
                    out.append(roots[freedom.body] * _unit(freedom))
                continue
            twist = np.zeros(6)
            for joint, coordinate, rate in freedom.drives:
                if joint in numbers:
                    twist += numbers[joint] * rate * twists_of[joint][coordinate]
            if np.abs(twist).max() > 1e-12:
                out.append(twist)
        return np.array(out).reshape(-1, 6)

    def _own(self, freedom: Freedom) -> dict[int, Array]:
        """Relative twist of each joint that moves, by its index."""
        found: dict[int, Array] = {}
        for name, coordinate, rate in freedom.drives:
            k = self.number[name]
            found[k] = found.get(k, np.zeros(6)) + rate * self.kinematics.joints[k].twists[coordinate]
        return found


def _unit(freedom: Freedom) -> Array:
    """The twist of a body that nothing holds."""
    if freedom.kind == "slide":
        return np.concatenate([np.zeros(3), freedom.axis])
    return np.concatenate([freedom.axis, cross(freedom.point, freedom.axis)])
