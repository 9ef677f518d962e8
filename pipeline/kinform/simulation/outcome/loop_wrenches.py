"""What joints carry round closed loops: the wrenches of the joints left over, loops apart that share no joint.

The wrenches λ of these joints are unknown. Every joint transmits along its freedoms what acts on its shaft: linear
conditions on λ; where redundancy leaves a choice it is that of the pseudoinverse, over all joints about their points.
Loops without a joint in common are systems of their own, and those of one size are solved in one stack: n loops side
by side cost n times what one costs, not n³. How many conditions are independent is decided for all of them together.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from kinform.foundation.algebra.vectors import cross_matrix
from kinform.foundation.graphs.graph import UnionFind
from kinform.model.arrays import Array, Flags, Ints
from kinform.simulation.constants import UNDETERMINED_SHARE


@dataclass(frozen=True, eq=False)
class Shares:
    """What λ does to the joints."""

    by_loops: Array
    """(J, C) of the wrench on the second body of each joint, from the wrenches of the C joints left over."""
    closing: Ints
    """(C,) these joints."""
    owner: Ints
    """(n,) joint of each rate."""
    gears: Array
    """(g, n) conditions on the rates."""
    length: float
    """m: what torques are divided by."""
    scale: Array
    """(n,)."""


@dataclass(frozen=True, eq=False)
class _Stack:
    """G systems of one size: their rates, loops and joints."""

    rates: Ints
    """(G, m)."""
    loops: Ints
    """(G, c)."""
    joints: Ints
    """(G, j)."""


@dataclass(frozen=True, eq=False)
class _Conditions:
    """The conditions of a stack, decomposed, and what λ adds to its joints."""

    stack: _Stack
    left: Array
    """(T, G, m, k)."""
    values: Array
    """(T, G, 6c) descending, with noughts where there are fewer conditions."""
    right: Array
    """(T, G, 6c, 6c)."""
    rest: Array
    """(T, G, m)."""
    lever: Array
    """(T, G, c, 6, 6) λ about the centre, from λ about the points of its joints with torques over the length."""


def add_loops(
    carried: Array, shares: Shares, screws: Array, points: Array, effort: Array, rank: int
) -> tuple[Array, Flags, Array]:  # fmt: skip
    """(T, J, 6) wrenches on the second bodies about the joints' points, (J, 6) what is not determined, and (z, J, 6)
    wrenches that could be added at the first time, torques of about the length and forces of about 1 at most.

    `carried` (T, J, 6) is what the tree alone carries, about the centre; `screws` (T, n, 6) of the rates, as the
    second bodies have them, and `effort` (T, n), both as they are; `rank` is that of the loops and the gears.
    """
    unit = np.array([shares.length] * 3 + [1.0] * 3)
    whole = about(carried, points) / unit
    loose = np.zeros(whole.shape[1:], dtype=np.bool_)
    S = screws / shares.scale[:, None]
    rest = effort / shares.scale - np.einsum("tnk,tnk->tn", S, carried[:, shares.owner])
    solved = [_conditions(shares, stack, S, points, rest, unit) for stack in _stacks(shares)]
    counted = rank - len(shares.gears)
    every = np.concatenate([one.values.reshape(len(carried), -1) for one in solved], axis=1)
    least = np.full(len(every), np.inf) if counted <= 0 else -np.sort(-every, axis=1)[:, counted - 1]
    stresses = [np.zeros((0, *loose.shape))]
    for one in solved:
        added, free, open_ = _added(shares, one, whole, points, unit, one.values >= least[:, None, None])
        whole[:, one.stack.joints] = added
        loose[one.stack.joints] = free
        for joints, columns in zip(one.stack.joints, open_, strict=True):
            stress = np.zeros((columns.shape[1], *loose.shape))
            stress[:, joints] = columns.T.reshape(-1, len(joints), 6)
            stresses.append(stress[np.abs(stress).max(axis=(1, 2)) > 0.0])
    return whole * unit, loose, np.concatenate(stresses) * unit


def about(wrenches: Array, points: Array) -> Array:
    """Wrenches (T, J, 6) about the centre taken to points (T, J, 3)."""
    out = wrenches.copy()
    out[..., :3] -= np.cross(points, wrenches[..., 3:])
    return out


def _stacks(shares: Shares) -> Iterator[_Stack]:
    """The systems: loops that share a joint are one, and gears make one of all."""
    joints, loops = shares.by_loops.shape
    if len(shares.gears):
        yield _Stack(*(np.arange(many)[None] for many in (len(shares.owner), loops, joints)))
        return
    sets, of_joint = UnionFind(loops), np.full(joints, -1)
    first: dict[int, int] = {}
    rows, columns = np.nonzero(shares.by_loops)
    for joint, loop in zip(rows.tolist(), columns.tolist(), strict=True):
        sets.union(first.setdefault(joint, loop), loop)
    # systems are numbered as their first loops are
    roots, of_loop = np.unique([sets.find(loop) for loop in range(loops)], return_inverse=True)
    count = len(roots)
    of_joint[rows] = of_loop[columns]
    of_rate = of_joint[shares.owner]
    lists = [[np.flatnonzero(of == k) for of in (of_rate, of_loop, of_joint)] for k in range(count)]
    sizes = [tuple(len(numbers) for numbers in system) for system in lists]
    for size in sorted(set(sizes)):
        alike = [system for system, other in zip(lists, sizes, strict=True) if other == size]
        yield _Stack(*(np.stack(numbers) for numbers in zip(*alike, strict=True)))


def _conditions(shares: Shares, stack: _Stack, S: Array, points: Array, rest: Array, unit: Array) -> _Conditions:
    """Along every freedom, what acts on the shaft; gears pass efforts on among theirs."""
    count, (systems, loops) = len(S), stack.loops.shape
    lever = np.zeros((count, systems, loops, 6, 6))
    lever[:] = np.diag(unit)
    lever[..., :3, 3:] = cross_matrix(points[:, shares.closing[stack.loops]])
    share = shares.by_loops[shares.owner[stack.rates][:, :, None], stack.loops[:, None, :]]
    turned = np.einsum("tgnk,tgckl->tgncl", S[:, stack.rates], lever)
    passed = (share[..., None] * turned).reshape(count, systems, -1, 6 * loops)
    mine = rest[:, stack.rates]
    if len(shares.gears):
        _, _, right = np.linalg.svd(shares.gears / shares.scale)
        keep = right[len(shares.gears) :]
        passed, mine = keep @ passed, mine @ keep.T
    left, found, right = np.linalg.svd(passed)
    values = np.zeros((*found.shape[:2], 6 * loops))
    values[..., : found.shape[2]] = found
    return _Conditions(stack, left[..., : found.shape[2]], values, right, mine, lever)


def _added(
    shares: Shares, one: _Conditions, whole: Array, points: Array, unit: Array, counts: Flags
) -> tuple[Array, Flags, Array]:  # fmt: skip
    """The wrenches (T, G, j, 6) of the joints of a stack, torques over the length, which are not determined, and
    (G, 6j, z) what could be added at the first time.

    `counts` (T, G, 6c): which singular values do; the directions of the others are free.
    """
    stack, (count, systems, loops) = one.stack, one.lever.shape[:3]
    many = one.left.shape[-1]
    known = np.einsum("tgmr,tgm->tgr", one.left, one.rest)
    known = np.where(counts[..., :many], known / np.maximum(one.values[..., :many], 1e-300), 0.0)
    special = np.einsum("tgrl,tgr->tgl", one.right[..., :many, :], known)
    share = shares.by_loops[stack.joints[:, :, None], stack.loops[:, None, :]]
    adds = np.einsum("gjc,tgckl->tgjkcl", share, one.lever).reshape(count, systems, -1, 6, 6 * loops)
    adds[..., :3, :] -= cross_matrix(points[:, stack.joints]) @ adds[..., 3:, :]
    adds = (adds / unit[:, None]).reshape(count, systems, -1, 6 * loops)
    out: Array = whole[:, stack.joints].reshape(count, systems, -1) + np.einsum("tgml,tgl->tgm", adds, special)
    loose = np.zeros((*stack.joints.shape, 6), dtype=np.bool_)
    open_ = np.zeros((systems, stack.joints.shape[1] * 6, 0))
    first = int(counts.sum(axis=2).min())
    free = ~counts[..., first:]
    if free.any():
        freedom = adds @ (one.right[..., first:, :] * free[..., None]).swapaxes(-1, -2)
        inner = freedom.swapaxes(-1, -2) @ freedom + counts[..., first:, None] * np.eye(free.shape[-1])
        answer = np.linalg.solve(inner, np.einsum("tgmz,tgm->tgz", freedom, out)[..., None])
        out = out - (freedom @ answer)[..., 0]
        loose = (np.abs(freedom).max(axis=(0, 3)) > UNDETERMINED_SHARE).reshape(loose.shape)
        open_ = freedom[0]
    return out.reshape(count, systems, -1, 6), loose, open_
