"""The one motion of a block of joints that loops tie together, followed from the pose of the meshes.

It is continued by arc length in joint coordinates, a step along the null vector of the loop closure and Newton's
method back onto the loops, so that rockers turn back at their dead points (Allgower and Georg 1990). Between the steps
it is a polynomial through them. What goes on evenly, as a nut on its screw, is followed in long steps.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property

import numpy as np

from kinform.foundation.algebra.displacements import exponentials, inverse
from kinform.foundation.algebra.screws import Frame
from kinform.foundation.graphs.graph import forest
from kinform.frozen import dataclass
from kinform.mechanism.loop_system import LoopSystem, loop_system
from kinform.model.arrays import Array, Flags
from kinform.model.kinematics import Freedom, Kinematics

STEP = 0.04
"""Arc length of a step: rad, and share of the block's size."""
PATH_STEPS = 900
"""Steps to each side at most."""
STEP_KEPT = 0.3
"""Share of a step that has to be left of it where the loops are closed again."""
STEPS_AWAY = 8
"""Steps after which the motion may be back where it began."""
CLOSING_STEPS = 12
"""Newton steps that close the loops."""
LOOP_RANK = 1e-4
"""Singular values of the closure below this leave motions."""
SINGULAR = 2e-3
"""One more of them within this is a branching."""
LONG_STEP = 0.4
"""rad: the longest step where a motion goes on evenly: screws and slides along one line, on which there is nothing to
be passed over."""
EVEN_TRIED = 30
"""Steps after which it is believed that a motion goes on evenly."""
EVEN_STEPS = 6000
"""Steps of an even motion in all."""
JACOBIAN_SAME = 1e-9
"""Change of the closure's Jacobian within which a motion goes on evenly."""
RETURN_MISS = 1e-5
"""rad and share of the size by which a motion may miss where it began and be back there."""
NARROW = 1e-2
"""Share of the assembly's size that a block's size is at least: its joints may be on one point."""
NODES_THROUGH = 6
"""Nodes that the motion between two of them is taken through."""
SMOOTH = 1e-9
"""rad and share of the size that loops may be open between nodes."""
CLOSED = 1e-6
"""rad, and share of the size: loops that are left open by less close, as far as their axes fit."""
CLOSED_EXACTLY = 1e-12
"""rad, and share of the size: loops that are left open by less need no more steps."""
RATE_SAME = 0.99
"""Rates of an idle freedom from this share of the greatest are the same but for rounding, and go by their order."""


Edge = tuple[int, int]

RETURNED = "returned"
"""How a motion ends that is back where it began."""


class Linkage:
    """One block of joints, with the assembly's bodies hanging on it."""

    def __init__(
        self,
        kinematics: Kinematics,
        edges: Sequence[Edge],
        block: Sequence[int],
        idle: Sequence[Freedom] = (),
        size: float = 1.0,
    ):
        """`edges` are the bodies of all joints, `block` the joints of this one; `idle` freedoms are held; `size` (m) is
        that of the assembly, a share of which a block counts at least."""
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
        self._asked: tuple[Array, Array, Array] | None = None

    def _columns(self, kinematics: Kinematics, idle: Sequence[Freedom]) -> list[int]:
        """For each idle freedom a coordinate in which it is seen, each another: holding these holds the freedoms."""
        held: list[int] = []
        for freedom in idle:
            rates = np.zeros(len(self.owner))
            for name, coordinate, rate in freedom.drives:
                columns = [n for n, k in enumerate(self.owner) if kinematics.joints[k].name == name]
                if columns and columns[coordinate] not in held and self.turns[columns[coordinate]]:
                    rates[columns[coordinate]] = abs(rate)
            if rates.any():
                # rates that are the same but for rounding go by their order
                held.append(int(np.flatnonzero(rates > RATE_SAME * rates.max())[0]))
        return held

    def poses(self, q: Array) -> Array:
        """(D, B, 4, 4) displacement of each body at coordinates q (D, n); joints outside of the block rest."""
        moves = exponentials(self._screws, q * self._units)
        across: dict[int, Array] = {}
        for n, k in enumerate(self.owner):
            across[k] = across[k] @ moves[:, n] if k in across else moves[:, n]
        motions, moved = self._motions
        out = np.broadcast_to(np.eye(4), (len(q), 1 + len(moved), 4, 4)).copy()
        for n, (up, k, back) in enumerate(moved, 1):
            out[:, n] = out[:, up] @ (inverse(across[k]) if back else across[k])
        return np.asarray(out[:, motions])

    @cached_property
    def _motions(self) -> tuple[list[int], list[tuple[int, int, bool]]]:
        """The motion of each body, as most hang on others without a joint of the block; and of each motion after the
        first, which is rest, the one that it moves on, the joint between, and whether that is passed from its second
        body to its first."""
        motion, moved = [0] * len(self.tree.parent), []
        for node in self.tree.order:
            up, k = self.tree.parent[node], self.tree.edge[node]
            if up < 0:
                continue
            motion[node] = motion[up]
            if k in self.owner:
                moved.append((motion[up], k, self.edges[k][1] != node))
                motion[node] = len(moved)
        return motion, moved

    def closed(self, q: Array) -> Array | None:
        """The nearest coordinates at which the loops close."""
        left = math.inf
        for _ in range(CLOSING_STEPS):
            residual, jacobian = self._loops(q)
            before, left = left, float(np.abs(residual).max())
            if left < CLOSED_EXACTLY or (left < CLOSED and left > 0.5 * before):
                return q
            rows = np.vstack([jacobian, self.held])
            wanted = np.concatenate([residual, self.held @ q])
            q = np.asarray(q - np.linalg.lstsq(rows, wanted, rcond=3.0 * LOOP_RANK)[0], float)
        return q if np.abs(self._loops(q)[0]).max() < CLOSED else None

    def _loops(self, q: Array) -> tuple[Array, Array]:
        """Residual (m,) and Jacobian (m, n) of the loops at q (n,), which is asked several times before the next."""
        if self._asked is None or not np.array_equal(self._asked[0], q):
            loops = self.system.close(q[None])
            self._asked = q, loops.residual[0], loops.jacobian[0]
        return self._asked[1:]

    def jacobian(self, q: Array) -> Array:
        """(m, n) of the loops at q."""
        return self._loops(q)[1]

    def tangent(self, q: Array) -> tuple[Array, bool] | None:
        """Unit null vector at q, and whether it is the only one; None where there is none."""
        jacobian = np.vstack([self._loops(q)[1], self.held])
        _, values, rows = np.linalg.svd(jacobian, full_matrices=True)
        values = np.concatenate([values, np.zeros(max(len(rows) - len(values), 0))])[: len(rows)]
        count = int((values < LOOP_RANK).sum())
        if count == 0:
            return None
        return rows[-1], count == 1 and bool(len(values) < 2 or values[-2] > SINGULAR)


@dataclass(frozen=True, eq=False)
class Path:
    """A motion, step by step."""

    q: Array
    """(T, n)."""
    s: Array
    """(T,) arc length in steps."""
    why: str
    """How it ended: returned, or why no further."""
    even: bool = False
    """Whether it goes on the same for ever, as a nut on its screw does."""


def follow(linkage: Linkage, sign: float) -> Path:
    """The motion to one side, as far as it goes."""
    q = np.zeros(linkage.system.coordinates)
    tangent = linkage.tangent(q)
    assert tangent is not None
    along, step = sign * tangent[0], STEP
    even: Array | None = linkage.jacobian(q)
    path, s = [q], [0.0]
    turns = np.array(linkage.turns)

    def ended(why: str) -> Path:
        return Path(np.array(path), np.array(s), why, len(path) > 2 and even is not None)

    while len(path) <= PATH_STEPS:
        if even is not None and len(path) > EVEN_TRIED:
            rest = np.arange(1.0, EVEN_STEPS)[:, None] * step * along
            if np.abs(linkage.system.close(q + rest[-1:]).residual).max() < CLOSED:
                path.extend(q + rest)
                s.extend(s[-1] + np.arange(1.0, EVEN_STEPS) * step / STEP)
                break
        following = linkage.closed(q + step * along)
        if following is None or float(np.linalg.norm(following - q)) < STEP_KEPT * step:
            return ended("the loops cannot be closed further")
        tangent = linkage.tangent(following)
        if tangent is None or not tangent[1]:
            return ended("a singular pose, from which motions branch")
        if even is not None and np.abs(linkage.jacobian(following) - even).max(initial=0.0) > JACOBIAN_SAME:
            even = None
        q = following
        path.append(q)
        s.append(s[-1] + step / STEP)
        step = STEP if even is None else min(2.0 * step, LONG_STEP)
        along = tangent[0] if float(tangent[0] @ along) >= 0.0 else -tangent[0]
        if (
            len(path) > STEPS_AWAY
            and float(np.linalg.norm(_around(q, turns))) < step
            and _meets_start(linkage, q, turns)
        ):
            return ended(RETURNED)
    return ended("the motion is too long to be followed to its end")


def _around(q: Array, turns: Flags) -> Array:
    """Coordinates less whole turns."""
    return np.where(turns, (q + math.pi) % (2.0 * math.pi) - math.pi, q)


def _meets_start(linkage: Linkage, q: Array, turns: Flags) -> bool:
    """Whether the motion goes through the start near q, rather than past it, as a nut does that is a turn further."""
    for _ in range(4):
        tangent = linkage.tangent(q)
        back = None if tangent is None else linkage.closed(q - float(_around(q, turns) @ tangent[0]) * tangent[0])
        if back is None:
            return False
        q = back
    return float(np.linalg.norm(_around(q, turns))) < RETURN_MISS


class Between:
    """Coordinates between the nodes of a path (T, n) at parameters s (T,), at which the loops close."""

    def __init__(self, linkage: Linkage, q: Array, s: Array):
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
        closed = self._linkage.closed(guess)
        return guess if closed is None else closed

    def _through(self, n: int, x: float) -> Array:
        """The polynomial through the nodes about step n (Lagrange), at x."""
        first = min(max(n - NODES_THROUGH // 2 + 1, 0), max(len(self._s) - NODES_THROUGH, 0))
        s, q = self._s[first : first + NODES_THROUGH], self._q[first : first + NODES_THROUGH]
        apart = s[:, None] - s
        np.fill_diagonal(apart, 1.0)
        away = np.broadcast_to(x - s, apart.shape).copy()
        np.fill_diagonal(away, 1.0)
        return np.asarray((away / apart).prod(axis=1) @ q)
