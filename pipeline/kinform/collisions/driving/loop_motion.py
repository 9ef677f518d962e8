"""The one motion of a block of joints that loops or stated ratios tie together, followed from the pose of the meshes.

It is continued by arc length in joint coordinates: a step along the null vector of the loop closure, and from there
the loops are closed again (`mechanism.closing`), so that rockers turn back at their dead points (Allgower and Georg,
Numerical Continuation Methods, 1990). Between the steps
it is a polynomial through them. What goes on evenly, as a nut on its screw, is followed in long steps.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.mechanism.closing import ACCEPTED, Closing, close
from kinform.mechanism.joint_graph import JointGraph
from kinform.mechanism.linkage import Linkage, linkage
from kinform.mechanism.rank import Rank
from kinform.model.arrays import Array, Flags
from kinform.model.kinematics import Freedom

STEP = 0.04
"""Arc length of a step: rad, and share of the block's size. Chosen, not measured."""
PATH_STEPS = 900
"""Steps to each side at most: 36 rad, six turns of a linkage with one turning joint, or two of one with ten."""
STEP_KEPT = 0.3
"""Share of a step that has to be left of it where the loops are closed again. Chosen, not measured."""
SINGULAR = 2e-3
"""A singular value of the closure that counts, but is below this, is that of a branching: twenty times what may be none
(`RANK_SHARE`), and a twentieth of a step."""
LONG_STEP = 0.4
"""rad: the longest step where a motion goes on evenly: screws and slides along one line, on which there is nothing to
be passed over. Chosen, not measured."""
EVEN_TRIED = 30
"""Steps after which it is believed that a motion goes on evenly. Chosen, not measured."""
EVEN_STEPS = 6000
"""Steps of an even motion in all. Chosen, not measured."""
NODES_THROUGH = 6
"""Nodes that the motion between two of them is taken through. Chosen, not measured."""
SMOOTH = SOLVED
"""rad and share of the size that loops may be open between nodes."""


RETURNED = "returned"
"""How a motion ends that is back where it began."""
TOO_LONG = "the motion is too long to be followed to its end"


@dataclass(frozen=True, eq=False)
class Driven:
    """One block of joints that has one motion, with the assembly's bodies hanging on it."""

    linkage: Linkage
    held: Flags
    """(n,) coordinates that rest, one of each idle freedom."""

    def closed(self, q: Array) -> Closing:
        """Where the loops close near the coordinates q (n,)."""
        return close(self.linkage.system, q[None], self.held)

    def opened(self, q: Array) -> float:
        """How far the loops are open at coordinates q (n,)."""
        return float(np.abs(self.linkage.system.equations(q[None]).residual).max(initial=0.0))

    def tangent(self, jacobian: Array) -> tuple[Array, bool] | None:
        """Unit null vector (n,) of the Jacobian (m, n), and whether it is the only one; None where there is none."""
        free = np.flatnonzero(~self.held)
        _, values, rows = np.linalg.svd(jacobian[:, free], full_matrices=True)
        rank = int(Rank().of(values)) if len(values) else 0
        if rank == len(free):
            return None
        out = np.zeros(len(self.held))
        out[free] = rows[-1]
        return out, rank == len(free) - 1 and bool(rank == 0 or values[rank - 1] > SINGULAR)


Tie = tuple[int, int, float]
"""Two joints of one freedom, by their numbers, and what the first moves by when the second moves by one."""


def driven_block(
    graph: JointGraph, block: Sequence[int], idle: Sequence[Freedom], size: float, ties: Sequence[Tie] = ()
) -> Driven:
    """The joints of one block, of which `idle` freedoms rest; `size` of the assembly (m). With `ties` these may be
    several blocks: joints between them rest."""
    number = {k: n for n, k in enumerate(block)}
    resting = _between(graph, block) if ties else []
    of_block = linkage(graph, [*block, *resting], size, ties=[(number[a], number[b], ratio) for a, b, ratio in ties])
    still = {graph.joints[k].name for k in resting}
    held = np.array([coordinate.joint in still for coordinate in of_block.coordinates], dtype=np.bool_)
    for freedom in idle:
        rates = np.zeros(len(held))
        for name, place, rate in freedom.drives:
            columns = of_block.columns(name)
            if columns and of_block.turns[columns[place]] and not held[columns[place]]:
                rates[columns[place]] = abs(rate)
        if rates.any():
            # rates that are the same but for rounding go by their order
            # Rates of an idle freedom from this share of the greatest are the same but for rounding, and go by their
            # order.
            held[np.flatnonzero(rates > 0.99 * rates.max())[0]] = True
    return Driven(of_block, held)


def _between(graph: JointGraph, block: Sequence[int]) -> list[int]:
    """The other joints on the ways from the bodies of some joints to ground."""
    out, tree = set(), graph.tree
    for body in (body for k in block for body in graph.edges[k]):
        while tree.parent[body] >= 0:
            out.add(tree.edge[body])
            body = tree.parent[body]
    return sorted(out.difference(block))


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


def follow(driven: Driven, sign: float) -> Path:
    """The motion to one side, as far as it goes."""
    q = driven.linkage.system.start[0]
    even: Array | None = driven.linkage.system.equations(q[None]).jacobian[0]
    assert even is not None
    tangent = driven.tangent(even)
    assert tangent is not None
    along, step = sign * tangent[0], STEP
    path, s = [q], [0.0]
    turns = driven.linkage.turns
    loops = len(driven.linkage.system.loops) > 0  # without, ratios keep what turns about several axes, too

    def ended(why: str) -> Path:
        return Path(np.array(path), np.array(s), why, len(path) > 2 and even is not None)

    while len(path) <= PATH_STEPS:
        if loops and even is not None and len(path) > EVEN_TRIED:
            rest = np.arange(1.0, EVEN_STEPS)[:, None] * step * along
            if driven.opened(q + rest[-1]) < ACCEPTED:
                path.extend(q + rest)
                s.extend(s[-1] + np.arange(1.0, EVEN_STEPS) * step / STEP)
                break
        closing = driven.closed(q + step * along)
        following, jacobian = closing.q[0], closing.jacobian[0]
        if not closing.closed[0] or float(np.linalg.norm(following - q)) < STEP_KEPT * step:
            return ended("the loops cannot be closed further")
        tangent = driven.tangent(jacobian)
        if tangent is None or not tangent[1]:
            return ended("a singular pose, from which motions branch")
        if even is not None and np.abs(jacobian - even).max(initial=0.0) > SOLVED:
            even = None
        q = following
        path.append(q)
        s.append(s[-1] + step / STEP)
        step = STEP if even is None or not loops else min(2.0 * step, LONG_STEP)
        along = tangent[0] if float(tangent[0] @ along) >= 0.0 else -tangent[0]
        # Steps after which the motion may be back where it began.
        if len(path) > 8 and float(np.linalg.norm(_around(q, turns))) < step and _meets_start(driven, q, along):
            return ended(RETURNED)
    return ended(TOO_LONG)


def _around(q: Array, turns: Flags) -> Array:
    """Coordinates less whole turns."""
    return np.where(turns, (q + math.pi) % (2.0 * math.pi) - math.pi, q)


def _meets_start(driven: Driven, q: Array, along: Array) -> bool:
    """Whether the motion goes through the start near q, rather than past it, as a nut does that is a turn further."""
    turns = driven.linkage.turns
    for _ in range(4):
        closing = driven.closed(q - float(_around(q, turns) @ along) * along)
        tangent = driven.tangent(closing.jacobian[0])
        if not closing.closed[0] or tangent is None:
            return False
        q, along = closing.q[0], tangent[0]
    # rad and share of the size by which a motion may miss where it began and be back there.
    return float(np.linalg.norm(_around(q, turns))) < 1e-5


class Between:
    """Coordinates between the nodes of a path (T, n) at parameters s (T,), at which the loops close."""

    def __init__(self, driven: Driven, q: Array, s: Array):
        self._driven, self._q, self._s = driven, q, s
        self._smooth: dict[int, bool] = {}

    def __call__(self, x: float) -> Array:
        n = min(max(int(np.searchsorted(self._s, x, side="right")) - 1, 0), len(self._s) - 1)
        if x == self._s[n] or n == len(self._s) - 1:
            return np.asarray(self._q[n])
        if n not in self._smooth:
            # what closes the loops in the middle of a step does so all along it
            middle = self._through(n, 0.5 * float(self._s[n] + self._s[n + 1]))
            self._smooth[n] = self._driven.opened(middle) < SMOOTH
        guess = self._through(n, x)
        if self._smooth[n]:
            return guess
        closed = self._driven.closed(guess).one()
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
