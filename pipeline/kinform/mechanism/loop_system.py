"""Forward kinematics and loop closure of one block of joints, in joint coordinates.

A joint of f freedoms is a product of f exponentials exp(S₁q₁)…exp(S_f q_f) of its twists: exact for lower
pairs (Brockett 1984), whose twists span the Lie algebra of the group of their motions, and for universal
joints, whose first axis is fixed in the first body and whose second in the second. All displacements are
of the world relative to the pose of the meshes, where every coordinate is zero and every loop is closed.

Lengths are in units of the block's own size about its centre, so that turns (rad) and slides compare.
Leading axes of arrays are batches of configurations. No forces, no names, no decisions.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.algebra.displacements import carry, exponential_terms, exponentials, identities, inverse
from kinform.foundation.algebra.screws import Frame, bracket, scaled
from kinform.foundation.algebra.vectors import norm
from kinform.foundation.records import altered
from kinform.foundation.rounding import SOLVED, TINY
from kinform.frozen import dataclass
from kinform.mechanism.spanning_tree import spanning_tree
from kinform.model.arrays import Array, Flags

Index = NDArray[np.intp]
Form = tuple[bytes, ...]


@dataclass(frozen=True, eq=False)
class Equations:
    """The closure equations of the loops at a batch of D configurations, to first order."""

    residual: Array
    """(D, m) rotation (rad) and shift (shares of the length) of what each loop comes back with, then what ties miss;
    m = 6 loops + ties. Zero where all loops close."""
    jacobian: Array
    """(D, m, n) its derivative by the coordinates, where the loops are nearly closed."""
    columns: Array
    """(D, n, 6) twist of each coordinate where it is now."""


@dataclass(frozen=True, eq=False)
class LoopSystem:
    """A block of N bodies, its joints and independent loops; n coordinates."""

    screws: Array
    """(n, 6) unit twists at the reference pose; (D, n, 6) of alike systems, those of each configuration."""
    joint: Index
    """(n,) joint of each coordinate, counted within the block."""
    first: Index
    """(joints,) first body of each joint."""
    levels: tuple[tuple[Index, Index], ...]
    """Coordinates that come first, second, … in their joints, with those joints."""
    depths: tuple[tuple[Index, Index, Index, Flags], ...]
    """By distance from the root: bodies, their parents, the joints between, whether these point at the root."""
    chords: tuple[Index, Index, Index]
    """Joints that close the loops, with their first and second bodies."""
    loops: Array
    """(loops, n) how often, and in which sense, a loop runs through a coordinate."""
    ahead: Array
    """(n, n) rates that add up to the twist of what a coordinate acts on."""
    reach: Array
    """(N, n) rates that add up to the twist of each body."""
    ties: Array
    """(k, n) combinations of coordinates that stay zero: ratios that gears keep. They count as rows of the closure."""
    turns: Flags
    """(n,) coordinates that are angles (rad); the others are slides, in shares of the frame's length."""
    rounding: float = 0.0
    """Share of a unit screw that coordinates of the world leave unknown where the block is."""

    @property
    def coordinates(self) -> int:
        """n."""
        return len(self.joint)

    @property
    def form(self) -> Form:
        """The same for systems that differ in nothing but their screws, and in what is not known of them."""
        parts = (self.joint, self.first, *self.chords, *(part for layer in self.depths for part in layer), self.ties)
        return tuple(part.tobytes() for part in parts)

    def rows(self, which: Index) -> LoopSystem:
        """The systems of these configurations, where each has its own."""
        return self if self.screws.ndim == 2 else altered(self, screws=self.screws[which])

    def advance(self, q: Array, change: Array) -> Array:
        """Configurations (D, n) after a change (D, n)."""
        return q + change

    @property
    def start(self) -> Array:
        """(1, n) the reference pose: that of the meshes."""
        return np.zeros((1, self.coordinates))

    def equations(self, q: Array) -> Equations:
        """Residual and Jacobian of the loops at configurations (D, n)."""
        bodies, inside, across = self._displacements(q)
        batch = len(q)
        columns = carry(bodies[:, self.first[self.joint]] @ inside, self.screws)
        members, a, b = self.chords
        gap = bodies[:, a] @ across[:, members] @ inverse(bodies[:, b])
        open_by = np.empty((batch, len(members), 6))
        for row, (i, j) in enumerate(((2, 1), (0, 2), (1, 0))):
            open_by[..., row] = 0.5 * (gap[..., i, j] - gap[..., j, i])
        open_by[..., 3:] = gap[..., :3, 3]
        jacobian = self.loops[:, None, :] * np.swapaxes(columns, -1, -2)[:, None]
        missed = open_by.reshape(batch, 6 * len(members))
        rows = jacobian.reshape(batch, 6 * len(members), self.coordinates)
        if len(self.ties):
            missed = np.concatenate([missed, q @ self.ties.T], axis=1)
            rows = np.concatenate([rows, np.broadcast_to(self.ties, (batch, *self.ties.shape))], axis=1)
        return Equations(missed, rows, columns)

    def bodies(self, q: Array) -> Array:
        """(D, N, 4, 4) displacement of each body from the reference pose, at configurations (D, n), seen from the root,
        in the frame's units about its centre."""
        return self._displacements(q)[0]

    @cached_property
    def _terms(self) -> tuple[Array, ...]:
        """Of the exponentials of screws that all configurations share."""
        return exponential_terms(self.screws)

    def _displacements(self, q: Array) -> tuple[Array, Array, Array]:
        """Displacements of bodies, of coordinates within their joints, and across joints."""
        batch, joints = len(q), len(self.first)
        steps = exponentials(self.screws, q, self._terms if self.screws.ndim == 2 else None)
        inside, across = identities(batch, self.coordinates), identities(batch, joints)
        for level, (coordinates, members) in enumerate(self.levels):
            if level:
                inside[:, coordinates] = across[:, members]
                across[:, members] = across[:, members] @ steps[:, coordinates]
            else:
                across[:, members] = steps[:, coordinates]
        bodies = identities(batch, len(self.reach))
        for nodes, parents, members, backward in self.depths:
            moves = across[:, members]
            if backward.any():
                moves[:, backward] = inverse(moves[:, backward])
            bodies[:, nodes] = bodies[:, parents] @ moves
        return bodies, inside, across

    def curvature(self, columns: Array, rates: Array) -> Array:
        """(D, 6 loops + ties) change of the Jacobian along `rates` (D, n), times `rates`: the acceleration that
        joint rates alone cause in each loop, Σ [twist ahead of i, column i] rateᵢ² and mixed terms.
        `columns` (n, 6) of one configuration."""
        moving = columns * rates[..., None]
        bent = bracket(self.ahead @ moving, moving)
        turned: Array = (self.loops @ bent).reshape(len(rates), 6 * len(self.loops))
        return np.concatenate([turned, np.zeros((len(rates), len(self.ties)))], axis=1) if len(self.ties) else turned


def loop_system(
    edges: Sequence[tuple[int, int]],
    spaces: Sequence[Array],
    frame: Frame,
    ties: Sequence[tuple[int, int, float]] = (),
    root: int | None = None,
) -> LoopSystem:
    """The loops of joints between bodies.

    `edges` (bodies of any numbers) and `spaces[k]`, the (f, 6) twists of joint k (ω; v at the world's origin) of its
    second body relative to its first, in the order of the product of exponentials. `frame`: centre and length (m) that
    scale it. `ties` (a, b, ratio): joints of one freedom, of which the first moves by ratio (SI) when the second moves
    by one, along their twists. Bodies are numbered in their order, and the tree grows from `root`, or the first.
    """
    present = {n for edge in edges for n in edge} | ({root} if root is not None else set())
    number = {body: i for i, body in enumerate(sorted(present))}
    inner = [(number[a], number[b]) for a, b in edges]
    sizes = [len(space) for space in spaces]
    start = np.cumsum([0, *sizes])
    total = int(start[-1])
    screws, turns = _unit_screws(np.concatenate([np.zeros((0, 6)), *spaces]), frame)
    held = np.zeros((len(ties), total))
    for line, (a, b, ratio) in zip(held, ties, strict=True):
        # a coordinate of one is so much of the joint's own value
        for k, factor in ((a, 1.0), (b, -ratio)):
            twist, turning = spaces[k][0], turns[start[k]]
            length = 1.0 if turning else frame.length
            line[start[k]] = factor * length / norm(twist[:3] if turning else twist[3:])
        line /= np.abs(line).max()
    tree = spanning_tree(len(number), inner, 0 if root is None else number[root])
    reach = np.zeros((len(number), total))
    layers: dict[int, list[tuple[int, int, int, bool]]] = {}
    for step in tree.carried:
        of_joint = slice(start[step.joint], start[step.joint + 1])
        reach[step.body] = reach[step.parent]
        reach[step.body, of_joint] = 1.0 if step.forward else -1.0
        layers.setdefault(step.depth, []).append((step.body, step.parent, step.joint, not step.forward))
    chords = tree.closing
    loops = np.array([reach[inner[k][0]] - reach[inner[k][1]] for k in chords]).reshape(len(chords), total)
    for row, k in enumerate(chords):
        loops[row, start[k] : start[k + 1]] += 1.0
    joint = np.repeat(np.arange(len(inner)), sizes)
    place = np.arange(total) - start[joint]
    first = np.array([a for a, _ in inner], dtype=np.intp)
    earlier = (joint[:, None] == joint[None]) & (place[None] < place[:, None])
    return LoopSystem(
        screws=screws,
        joint=joint,
        first=first,
        levels=tuple((np.flatnonzero(place == n), joint[place == n]) for n in range(max(sizes, default=0))),
        depths=tuple(_layer(layers[d]) for d in sorted(layers)),
        chords=_columns([(k, *inner[k]) for k in chords]),
        loops=loops,
        ahead=reach[first[joint]] + earlier,
        reach=reach,
        ties=held,
        turns=turns,
        rounding=frame.rounding,
    )


def stacked(systems: Sequence[LoopSystem], counts: Sequence[int]) -> LoopSystem:
    """Systems of one form as one, to be closed at the configurations of the first, so many as `counts` says, then at
    those of the second, and so forth: each as by itself, to the last bit, where there are no ties."""
    return altered(systems[0], screws=np.repeat(np.array([system.screws for system in systems]), counts, axis=0))


def _unit_screws(twists: Array, frame: Frame) -> tuple[Array, Flags]:
    """Unit screws (n, 6) of twists (n, 6; ω; v at the world's origin) in the frame's units, and which of them turn."""
    local = scaled(twists.T, frame).T / frame.length
    turning = np.linalg.norm(local[:, :3], axis=1)
    sliding = np.linalg.norm(local[:, 3:], axis=1)
    turns = turning > SOLVED * sliding
    local = local / np.maximum(np.where(turns, turning, sliding), TINY)[:, None]
    local[~turns, :3] = 0.0
    return local, turns


def _layer(rows: Sequence[tuple[int, int, int, bool]]) -> tuple[Index, Index, Index, Flags]:
    nodes, parents, members, backward = np.array(rows, dtype=np.intp).T
    return nodes, parents, members, backward.astype(np.bool_)


def _columns(rows: Sequence[tuple[int, int, int]]) -> tuple[Index, Index, Index]:
    first, second, third = np.array(rows, dtype=np.intp).reshape(-1, 3).T
    return first, second, third
