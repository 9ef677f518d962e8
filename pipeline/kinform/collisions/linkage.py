"""The ranges of joints that loops tie together, where all that is left is one motion: it is followed both ways.

Bodies that only spin on themselves, as loose pins do, are held; how far they spin by themselves is another question.
The motion is continued by arc length in joint coordinates, a step along the null vector of the loop closure and
Newton's method back onto the loops, so that rockers turn back at their dead points (Allgower and Georg 1990). It ends
where parts meet, where the linkage comes back to its pose, or where a second motion branches off.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kinform.collisions.pairs import Shapes
from kinform.collisions.recorded import Nodes, moving_pairs
from kinform.collisions.scan import first_crossing
from kinform.collisions.single import drive_alone, guide, joint_twist
from kinform.kinematics.graph import forest
from kinform.kinematics.motion import LoopSystem, exponentials, inverse, loop_system
from kinform.kinematics.screws import Frame
from kinform.model.collisions import JointRange, RangeEnd
from kinform.model.kinematics import Freedom, Joint, Kinematics
from kinform.model.names import BodyName, PartName

__all__ = ["drive_loops"]

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Edge = tuple[int, int]

STEP = 0.04
"""Arc length of a step: rad, and share of the block's size."""
STEPS = 900
"""Steps to each side at most."""
RANK = 1e-4
"""Singular values of the closure below this leave motions; one more of them within `SINGULAR` is a branching."""
SINGULAR = 2e-3


LEAVES = "leaves its guide"
LONG, TRIED, EVENLY, SAME = 0.4, 30, 6000, 1e-9
"""rad of a step, steps after which it is believed, steps in all, and change of the closure's Jacobian where a motion goes
on evenly: screws and slides along one line, on which there is nothing to be passed over."""
MET = 1e-5
"""rad and share of the size by which a motion may miss where it began and be back there."""
RETURNED = "returned"
"""How a motion ends that is back where it began."""
NARROW = 1e-2
"""Share of the assembly's size that a block's size is at least: its joints may be on one point."""
NODES, SMOOTH = 6, 1e-9
"""Nodes that the motion between two of them is taken through, and rad and share of the size that loops may be open then."""
CLOSED = 1e-6
"""rad, and share of the size: loops that are left open by less close, as far as their axes fit."""


class _Linkage:
    """One block of joints, with the assembly's bodies hanging on it."""

    def __init__(
        self,
        kinematics: Kinematics,
        edges: Sequence[Edge],
        block: Sequence[int],
        idle: Sequence[Freedom] = (),
        size: float = 1.0,
    ):
        joints = [kinematics.joints[k] for k in block]
        placed = [j.point for j in joints if j.point is not None]
        centre, length = np.zeros(3), size
        if placed:
            low, high = np.min(placed, axis=0), np.max(placed, axis=0)
            centre, length = 0.5 * (low + high), max(0.5 * float(np.linalg.norm(high - low)), NARROW * size)
        self.system: LoopSystem = loop_system(
            [edges[k] for k in block], [j.twists for j in joints], Frame(centre, length)
        )
        self.twists, self.unit, self.turns = [], [], []
        self.owner: list[int] = []
        for k, joint in zip(block, joints, strict=True):
            for twist in joint.twists:
                turning = float(np.linalg.norm(twist[:3]))
                turns = turning > 1e-9
                self.twists.append(twist / (turning if turns else float(np.linalg.norm(twist[3:]))))
                self.unit.append(1.0 if turns else length)
                self.turns.append(turns)
                self.owner.append(k)
        self._screws, self._units = np.array(self.twists).reshape(-1, 6), np.array(self.unit)
        ground = next((n for n, body in enumerate(kinematics.bodies) if body.ground), 0)
        self.tree = forest(len(kinematics.bodies), edges, ground)
        self.edges = edges
        self.held = np.eye(len(self.owner))[self._columns(kinematics, idle)]
        """(k, n) rows of coordinates that are held, each of an idle freedom."""

    def _columns(self, kinematics: Kinematics, idle: Sequence[Freedom]) -> list[int]:
        """For each idle freedom a coordinate in which it is seen, each another: holding these holds the freedoms."""
        taken: list[int] = []
        for freedom in idle:
            rates = np.zeros(len(self.owner))
            for name, coordinate, rate in freedom.drives:
                own = [n for n, k in enumerate(self.owner) if kinematics.joints[k].name == name]
                if own and own[coordinate] not in taken and self.turns[own[coordinate]]:
                    rates[own[coordinate]] = abs(rate)
            if rates.any():
                # rates that are the same but for rounding go by their order
                taken.append(int(np.flatnonzero(rates > 0.99 * rates.max())[0]))
        return taken

    def poses(self, q: Array) -> Array:
        """(D, B, 4, 4) displacement of each body at coordinates q (D, n); joints outside of the block rest."""
        moves = exponentials(self._screws, q * self._units)
        across: dict[int, Array] = {}
        for n, k in enumerate(self.owner):
            across[k] = across[k] @ moves[:, n] if k in across else moves[:, n]
        out = np.broadcast_to(np.eye(4), (len(q), len(self.tree.parent), 4, 4)).copy()
        for node in self.tree.order:
            up, k = self.tree.parent[node], self.tree.edge[node]
            if up >= 0:
                move = across.get(k)
                if move is not None and self.edges[k][1] != node:
                    move = inverse(move)
                out[:, node] = out[:, up] if move is None else out[:, up] @ move
        return out

    def closed(self, q: Array) -> Array | None:
        """The nearest coordinates at which the loops close."""
        left = math.inf
        for _ in range(12):
            found = self.system.close(q[None])
            residual = found.residual[0]
            before, left = left, float(np.abs(residual).max())
            if left < 1e-12 or (left < CLOSED and left > 0.5 * before):
                return q
            rows = np.vstack([found.jacobian[0], self.held])
            wanted = np.concatenate([residual, self.held @ q])
            q = np.asarray(q - np.linalg.lstsq(rows, wanted, rcond=3.0 * RANK)[0], float)
        return q if np.abs(self.system.close(q[None]).residual).max() < CLOSED else None

    def jacobian(self, q: Array) -> Array:
        """(m, n) of the loops at q."""
        return np.asarray(self.system.close(q[None]).jacobian[0])

    def tangent(self, q: Array) -> tuple[Array, bool] | None:
        """Unit null vector at q, and whether it is the only one; None where there is none."""
        jacobian = np.vstack([self.system.close(q[None]).jacobian[0], self.held])
        _, values, rows = np.linalg.svd(jacobian, full_matrices=True)
        values = np.concatenate([values, np.zeros(max(len(rows) - len(values), 0))])[: len(rows)]
        count = int((values < RANK).sum())
        if count == 0:
            return None
        return rows[-1], count == 1 and bool(len(values) < 2 or values[-2] > SINGULAR)


@dataclass(frozen=True, eq=False)
class _Path:
    q: Array
    """(T, n)."""
    s: Array
    """(T,) arc length in steps."""
    why: str
    """How it ended: returned, or why no further."""
    even: bool = False
    """Whether it goes on the same for ever, as a nut on its screw does."""


def _follow(linkage: _Linkage, sign: float) -> _Path:
    q = np.zeros(linkage.system.coordinates)
    found = linkage.tangent(q)
    assert found is not None
    along, step = sign * found[0], STEP
    even: Array | None = linkage.jacobian(q)
    path, s = [q], [0.0]
    turns = np.array(linkage.turns)

    def ended(why: str) -> _Path:
        return _Path(np.array(path), np.array(s), why, len(path) > 2 and even is not None)

    while len(path) <= STEPS:
        if even is not None and len(path) > TRIED:
            rest = np.arange(1.0, EVENLY)[:, None] * step * along
            if np.abs(linkage.system.close(q + rest[-1:]).residual).max() < CLOSED:
                path.extend(q + rest)
                s.extend(s[-1] + np.arange(1.0, EVENLY) * step / STEP)
                break
        following = linkage.closed(q + step * along)
        if following is None or float(np.linalg.norm(following - q)) < 0.3 * step:
            return ended("the loops cannot be closed further")
        found = linkage.tangent(following)
        if found is None or not found[1]:
            return ended("a singular pose, from which motions branch")
        if even is not None and np.abs(linkage.jacobian(following) - even).max(initial=0.0) > SAME:
            even = None
        q = following
        path.append(q)
        s.append(s[-1] + step / STEP)
        step = STEP if even is None else min(2.0 * step, LONG)
        along = found[0] if float(found[0] @ along) >= 0.0 else -found[0]
        if len(path) > 8 and float(np.linalg.norm(_around(q, turns))) < step and _meets_start(linkage, q, turns):
            return ended(RETURNED)
    return ended("the motion is too long to be followed to its end")


def _around(q: Array, turns: Flags) -> Array:
    """Coordinates less whole turns."""
    return np.where(turns, (q + math.pi) % (2.0 * math.pi) - math.pi, q)


def _meets_start(linkage: _Linkage, q: Array, turns: Flags) -> bool:
    """Whether the motion goes through the start near q, rather than past it, as a nut does that is a turn further."""
    for _ in range(4):
        found = linkage.tangent(q)
        moved = None if found is None else linkage.closed(q - float(_around(q, turns) @ found[0]) * found[0])
        if moved is None:
            return False
        q = moved
    return float(np.linalg.norm(_around(q, turns))) < MET


def drive_loops(
    shapes: Shapes, kinematics: Kinematics, edges: Sequence[Edge], block: Sequence[int]
) -> dict[int, JointRange] | str:
    """The ranges of the joints of one block; or why they are not known."""
    doubtful = [
        k for k in block if kinematics.joints[k].type == "general" or kinematics.joints[k].status == "ambiguous"
    ]
    if doubtful:
        return f"its loops run through {kinematics.joints[doubtful[0]].name}, whose motion is not known"
    idle = _idle(kinematics, block)
    linkage = _Linkage(kinematics, edges, block, idle, shapes.size)
    first = linkage.tangent(np.zeros(linkage.system.coordinates))
    if first is None:
        return "the loops do not move"
    if not first[1]:
        return "its loops have more than one freedom, or a singular pose"
    ends = [_travelled(shapes, kinematics, linkage, _follow(linkage, -1.0))]
    # a motion that comes back to where it began, and meets nothing, is the same the other way round
    free = ends[0].why == RETURNED and not ends[0].left_out
    ends.append(ends[0] if free else _travelled(shapes, kinematics, linkage, _follow(linkage, 1.0)))
    out = {}
    for k in block:
        joint = kinematics.joints[k]
        columns = [n for n, owner in enumerate(linkage.owner) if owner == k]
        spinning = [freedom.body for freedom in idle if freedom.body in joint.bodies]
        if len(columns) == 1:
            out[k] = (
                _spun(shapes, kinematics, joint, spinning[0]) if spinning else _range(joint, linkage, columns[0], ends)
            )
    return out


def _idle(kinematics: Kinematics, block: Sequence[int]) -> list[Freedom]:
    """The idle freedoms that move joints of a block."""
    names = {kinematics.joints[k].name for k in block}
    return [f for f in kinematics.mobility.named if f.idle and any(joint in names for joint, _, _ in f.drives)]


def _spun(shapes: Shapes, kinematics: Kinematics, joint: Joint, body: BodyName) -> JointRange:
    """The range of a joint of a body that spins on itself while all else is at rest."""
    if joint.type != "revolute" or joint.axis is None or joint.point is None:
        end = RangeEnd("unknown", reason=f"'{body}' spins on itself")
        return JointRange(joint.name, end, end)
    own = sorted(shapes.body_parts[body])
    rest = sorted(part for name, parts in shapes.body_parts.items() if name != body for part in parts)
    found = drive_alone(shapes, joint, *((rest, own) if joint.bodies[1] == body else (own, rest)))
    if found.status == "unbounded":
        return found
    end = RangeEnd("unknown", reason=f"'{body}' spins on itself, and not freely where it is")
    return JointRange(joint.name, end, end, found.left_out)


class _Between:
    """Coordinates between the nodes of a path (T, n) at parameters s (T,), at which the loops close."""

    def __init__(self, linkage: _Linkage, q: Array, s: Array):
        self._linkage, self._q, self._s = linkage, q, s
        self._smooth: dict[int, bool] = {}

    def __call__(self, x: float) -> Array:
        n = min(max(int(np.searchsorted(self._s, x, side="right")) - 1, 0), len(self._s) - 1)
        if x == self._s[n] or n == len(self._s) - 1:
            return np.asarray(self._q[n])
        if n not in self._smooth:
            # what closes the loops in the middle of a step does so all along it
            middle = self._through(n, 0.5 * float(self._s[n] + self._s[n + 1]))
            self._smooth[n] = bool(np.abs(self._linkage.system.close(middle[None]).residual).max() < SMOOTH)
        guess = self._through(n, x)
        if self._smooth[n]:
            return guess
        found = self._linkage.closed(guess)
        return guess if found is None else found

    def _through(self, n: int, x: float) -> Array:
        """The polynomial through the nodes about step n (Lagrange), at x."""
        first = min(max(n - NODES // 2 + 1, 0), max(len(self._s) - NODES, 0))
        s, q = self._s[first : first + NODES], self._q[first : first + NODES]
        apart = s[:, None] - s
        np.fill_diagonal(apart, 1.0)
        away = np.broadcast_to(x - s, apart.shape).copy()
        np.fill_diagonal(away, 1.0)
        return np.asarray((away / apart).prod(axis=1) @ q)


@dataclass(frozen=True, eq=False)
class _Travelled:
    q: Array
    """(T, n) of what is free."""
    s: Array
    """(T,)."""
    why: str
    parts: tuple[PartName, ...]
    place: Array | None
    left_out: tuple[tuple[PartName, PartName], ...]


def _travelled(shapes: Shapes, kinematics: Kinematics, linkage: _Linkage, path: _Path) -> _Travelled:
    """The path until parts meet."""
    names = [str(body.name) for body in kinematics.bodies]
    path = _guided(shapes, kinematics, linkage, path) if path.even else path
    s = path.s
    at = _Between(linkage, path.q, s)
    # pairs halve the same steps: most poses are asked for by several
    between = lru_cache(maxsize=None)(lambda x: linkage.poses(at(x)[None])[0])
    nodes = Nodes(s, linkage.poses(path.q), between)
    end, why, place = float(s[-1]), path.why, None
    parts: tuple[PartName, ...] = ()
    left_out = set()
    for item in sorted(moving_pairs(shapes, names, kinematics.joints, nodes), key=lambda item: -item.free):
        test = item.test
        if item.free >= end:
            continue
        found = first_crossing(test, item.course, end, 1e-3, start=item.free)
        if found.overlaps or (item.rolls and found.at is not None):
            left_out.add(test.part_names)
        if found.exhausted is not None:
            end, why, parts, place = found.exhausted, f"{' and '.join(test.names)} stay too close", (), None
        elif found.at is not None and found.place is not None and not item.rolls:
            end, why, parts = found.at, "", test.part_names
            place = (nodes.between(found.at)[item.first] @ np.append(found.place, 1.0))[:3]
    kept = s < end
    q, s = np.concatenate([path.q[kept], at(end)[None]]), np.append(s[kept], end)
    return _Travelled(q, s, why, parts, place, tuple(sorted(left_out)))


def _guided(shapes: Shapes, kinematics: Kinematics, linkage: _Linkage, path: _Path) -> _Path:
    """The path until the first of its slides and screws has left its guide."""
    end, why = float(path.s[-1]), path.why
    for n, k in enumerate(linkage.owner):
        joint = kinematics.joints[k]
        if joint.type not in ("prismatic", "screw") or joint.axis is None:
            continue
        values = path.q[:, n] * linkage.unit[n] * _sense(joint, linkage.twists[n])
        low, high = guide(shapes, joint, joint_twist(joint))
        limit = high if values[-1] > 0.0 else low
        if abs(values[-1]) > abs(limit):
            at = float(np.interp(abs(limit), np.abs(values), path.s))
            if at < end:
                end, why = at, f"'{joint.name}' {LEAVES}"
    kept = path.s < end
    last = np.array([np.interp(end, path.s, column) for column in path.q.T])
    return _Path(np.vstack([path.q[kept], last]), np.append(path.s[kept], end), why, True)


def _range(joint: Joint, linkage: _Linkage, column: int, ends: Sequence[_Travelled]) -> JointRange:
    """The values that one joint takes along what is free to both sides."""
    unit = linkage.unit[column] * _sense(joint, linkage.twists[column])
    values = [end.q[:, column] * unit for end in ends]
    low, high = (
        min(_least(sign * v, end.s) for v, end in zip(values, ends, strict=True)) * sign for sign in (1.0, -1.0)
    )
    left_out = tuple(sorted({pair for end in ends for pair in end.left_out}))
    returned = any(end.why == RETURNED for end in ends)
    if returned and linkage.turns[column] and high - low > 2.0 * math.pi - 0.2:
        free = RangeEnd("unknown", reason=_overlap(left_out)) if left_out else RangeEnd("unbounded")
        return JointRange(joint.name, free, free, left_out)
    sides = []
    for value in (low, high):
        n = min(range(2), key=lambda k: abs(float(values[k][-1]) - value))
        at_end = abs(float(values[n][-1]) - value) < 1e-9
        end = ends[n]
        if at_end and end.parts:
            sides.append(RangeEnd("found", float(value), end.parts, end.place))
        elif at_end and end.why.endswith(LEAVES):
            sides.append(RangeEnd("unbounded", reason=end.why, leaves=float(value)))
        elif at_end and end.why != RETURNED:
            sides.append(RangeEnd("unknown", reason=end.why))
        elif left_out:
            sides.append(RangeEnd("unknown", reason=_overlap(left_out)))
        else:
            sides.append(RangeEnd("found", float(value), reason="the linkage turns back"))
    return JointRange(joint.name, sides[0], sides[1], left_out)


def _least(values: Array, s: Array) -> float:
    """The least of values at parameters, between them where it is not at an end: of the parabola through three."""
    n = int(np.argmin(values))
    if n == 0 or n >= len(values) - 2:
        return float(values[n])
    bend, slope, least = (float(c) for c in np.polyfit(s[n - 1 : n + 2] - s[n], values[n - 1 : n + 2], 2))
    return least - slope * slope / (4.0 * bend) if bend > 0.0 else least


def _overlap(pairs: Sequence[tuple[str, str]]) -> str:
    return f"overlap from the start: {', '.join(' and '.join(pair) for pair in pairs[:3])}"


def _sense(joint: Joint, twist: Array) -> float:
    """1 where the twist goes with the joint's axis, −1 where against it."""
    if joint.axis is None:
        return 1.0
    own = twist[3:] if joint.type == "prismatic" else twist[:3]
    return 1.0 if float(own @ joint.axis) >= 0.0 else -1.0
