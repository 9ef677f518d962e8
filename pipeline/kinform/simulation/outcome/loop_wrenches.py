"""What joints carry round closed loops: the wrenches of the joints left over, loops apart that share no joint.

The wrenches λ of these joints are unknown. Every joint transmits along its freedoms what acts on its shaft: linear
conditions on λ; where redundancy leaves a choice it is that of the pseudoinverse, over all joints about their points.
Loops without a joint in common are systems of their own, and those of one size are solved in one stack: n loops side
by side cost n times what one costs, not n³. How many conditions are independent is decided for all of them together.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from kinform.foundation.algebra.vectors import cross_matrix
from kinform.foundation.rounding import ARITHMETIC, SINGLE, TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.simulation.mechanism.loop_systems import alike, systems_of_loops
from kinform.simulation.outcome.loop_freedoms import least_wrenches


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
class _Directions:
    """K wrenches of the joints left over of a stack, each of one of them."""

    loops: Ints
    """(K,) ascending."""
    wrenches: Array
    """(T, G, K, 6) about the centre, of torques over the length of about 1."""


@dataclass(frozen=True, eq=False)
class _Conditions:
    """The conditions of a stack on what they see of λ."""

    stack: _Stack
    seen: _Directions
    """K directions that take part in conditions."""
    unseen: _Directions
    """U directions that take part in none: what they are nothing but the least of all wrenches says."""
    rows: Array
    """(T, G, m, K)."""
    rest: Array
    """(T, G, m)."""


@dataclass(frozen=True, eq=False)
class _Answer:
    """What the conditions of a stack say of the K directions that they see."""

    known: Array
    """(T, G, K)."""
    free: Array
    """(T, G, z, K) directions that they leave free; noughts at times at which they are not."""
    held: Array
    """(T, G, z) one where that direction is noughts."""


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
    systems = [_conditions(shares, stack, S, points, rest, unit) for stack in _stacks(shares)]
    stresses = [np.zeros((0, *loose.shape))]
    for one, answer in zip(systems, _answers(systems, rank - len(shares.gears)), strict=True):
        added, free, open_ = _added(shares, one, answer, whole, points, unit)
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
    of_joint, of_loop = systems_of_loops(shares.by_loops)
    yield from (_Stack(*numbers) for numbers in alike(of_joint[shares.owner], of_loop, of_joint))


def _conditions(shares: Shares, stack: _Stack, S: Array, points: Array, rest: Array, unit: Array) -> _Conditions:
    """Along every freedom, what acts on the shaft; gears pass efforts on among theirs."""
    count, (systems, loops) = len(S), stack.loops.shape
    lever = np.zeros((count, systems, loops, 6, 6))
    lever[:] = np.diag(unit)
    lever[..., :3, 3:] = cross_matrix(points[:, shares.closing[stack.loops]])
    share = shares.by_loops[shares.owner[stack.rates][:, None, :], stack.loops[:, :, None]]
    passed = share[..., None] * (S[:, stack.rates][:, :, None] @ lever)
    values, basis = _seen_from(passed, share)
    taken = (
        np.arange(6) < np.count_nonzero(values > ARITHMETIC * values.max(initial=0.0), axis=3).max(axis=(0, 1))[:, None]
    )
    wrenches = lever @ basis
    seen, unseen = (
        _Directions(which[0], wrenches[:, :, which[0], :, which[1]].transpose(1, 2, 0, 3))
        for which in (np.nonzero(taken), np.nonzero(~taken))
    )
    where = np.nonzero(taken)
    rows = (passed @ basis)[:, :, where[0], :, where[1]].transpose(1, 2, 3, 0)
    mine = rest[:, stack.rates]
    if len(shares.gears):
        _, _, right = np.linalg.svd(shares.gears / shares.scale)
        keep = right[len(shares.gears) :]
        rows, mine = keep @ rows, mine @ keep.T
    return _Conditions(stack, seen, unseen, rows, mine)


def _seen_from(passed: Array, share: Array) -> tuple[Array, Array]:
    """(T, G, c, 6) descending, how much the conditions (T, G, c, n, 6) of each loop see of six directions of its λ, and
    these directions, columns (T, G, c, 6, 6): what no condition of its own loop sees, no other does.

    `share` (G, c, n): nought where the rate is none of the loop's.
    """
    count = min(max(int(np.count_nonzero(share, axis=2).max(initial=0)), 6), share.shape[2])
    own = np.argsort(share == 0.0, axis=2, kind="stable")[:, :, :count]
    rows = np.take_along_axis(passed, own[None, ..., None], axis=3)
    _, found, right = np.linalg.svd(rows, full_matrices=count < 6)
    values = np.zeros((*found.shape[:3], 6))
    values[..., : found.shape[3]] = found
    return values, right.swapaxes(-1, -2)


def _answers(systems: Sequence[_Conditions], counted: int) -> list[_Answer]:
    """What the conditions of each stack say, where so many of all of them are independent.

    Where that is all directions that they see, these are the least squares; else the singular values tell which count.
    """
    if sum(one.rows.shape[1] * one.rows.shape[3] for one in systems) <= counted:
        return [_determined(one) for one in systems]
    parts = []
    for one in systems:
        left, found, right = np.linalg.svd(one.rows)
        values = np.zeros((*found.shape[:2], one.rows.shape[3]))
        values[..., : found.shape[2]] = found
        parts.append((left[..., : found.shape[2]], values, right))
    every = np.concatenate([values.reshape(len(values), -1) for _, values, _ in parts], axis=1)
    least = np.full(len(every), np.inf) if counted <= 0 else -np.sort(-every, axis=1)[:, counted - 1]
    out = []
    for one, (left, values, right) in zip(systems, parts, strict=True):
        counts, many = values >= least[:, None, None], left.shape[-1]
        known = np.einsum("tgmr,tgm->tgr", left, one.rest)
        known = np.where(counts[..., :many], known / np.maximum(values[..., :many], TINY), 0.0)
        first = int(counts.sum(axis=2).min())
        held = counts[..., first:]
        free = right[..., first:, :] * ~held[..., None]
        out.append(_Answer(np.einsum("tgrk,tgr->tgk", right[..., :many, :], known), free, held.astype(np.float64)))
    return out


def _determined(one: _Conditions) -> _Answer:
    count, systems, _, many = one.rows.shape
    Q, R = np.linalg.qr(one.rows)
    known = np.linalg.solve(R, np.einsum("tgmk,tgm->tgk", Q, one.rest)[..., None])[..., 0]
    return _Answer(known, np.zeros((count, systems, 0, many)), np.zeros((count, systems, 0)))


def _added(
    shares: Shares, one: _Conditions, answer: _Answer, whole: Array, points: Array, unit: Array
) -> tuple[Array, Flags, Array]:  # fmt: skip
    """The wrenches (T, G, j, 6) of the joints of a stack, torques over the length, which are not determined, and
    (G, 6j, z) what could be added at the first time."""
    joints = one.stack.joints
    systems, many = joints.shape
    share = shares.by_loops[joints[:, :, None], one.stack.loops[:, None, :]]
    turn = cross_matrix(points[:, joints])
    lever = turn * (unit[3:] / unit[:3, None])

    def on_joints(directions: _Directions) -> Array:
        """(T, G, j, 6, K) wrenches on the joints about their points, over the units, from directions of λ."""
        out = share[:, :, None, directions.loops] * (directions.wrenches / unit).swapaxes(-1, -2)[:, :, None]
        out[..., :3, :] -= lever @ out[..., 3:, :]
        return out

    of_loop = (one.seen.loops == np.arange(share.shape[2])[:, None]).astype(np.float64)
    known = share @ (of_loop @ (answer.known[..., None] * one.seen.wrenches))
    known[..., :3] -= (turn @ known[..., 3:, None])[..., 0]
    borne = whole[:, joints] + known / unit
    if len(one.unseen.loops) and not answer.free.shape[2]:
        least_of = least_wrenches(borne, share, one.unseen.loops, one.unseen.wrenches / unit, lever)
        if least_of is not None:
            return least_of[0], least_of[1] > SINGLE, least_of[2]
    out: Array = borne.reshape(len(whole), systems, -1)
    freedom = on_joints(one.unseen).reshape(*out.shape, -1)
    held = np.zeros((*freedom.shape[:2], freedom.shape[3]))
    if answer.free.shape[2]:
        more = on_joints(one.seen).reshape(*out.shape, -1) @ answer.free.swapaxes(-1, -2)
        freedom, held = np.concatenate([freedom, more], axis=3), np.concatenate([held, answer.held], axis=2)
    loose = np.zeros((*joints.shape, 6), dtype=np.bool_)
    if freedom.shape[3]:
        inner = freedom.swapaxes(-1, -2) @ freedom + held[..., None] * np.eye(held.shape[2])
        least = np.linalg.solve(inner, np.einsum("tgmz,tgm->tgz", freedom, out)[..., None])
        out = out - (freedom @ least)[..., 0]
        most = np.maximum(freedom.max(axis=(0, 3)), -freedom.min(axis=(0, 3)))
        loose = (most > SINGLE).reshape(loose.shape)
    return out.reshape(len(whole), systems, many, 6), loose, freedom[0]
