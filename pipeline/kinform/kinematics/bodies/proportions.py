"""Loops that move by their proportions only: their axes are moved until the loops close all along the motion.

A Bennett or a Bricard linkage has more constraints than its motion leaves room for; it moves because lengths and
twists of its links satisfy equations. Coordinates of a mesh file satisfy them to their rounding, and what is missing
grows on the way: a gap of 1e-8 at the start is one of 1e-6 near a pose where the links fold. Known here: poses along
the motion, the gaps that no joint can close there, and how they change when axes move; the least moves, each weighed
by its uncertainty, that close all of them (Gauss and Newton; what a moved frame does to a closure is the difference
of its twist carried by the bodies on either side, Park and Okamura, Kinematic calibration and the product of
exponentials formula, 1994).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from kinform.foundation.algebra.displacements import displacement
from kinform.foundation.algebra.screws import Frame
from kinform.foundation.algebra.vectors import cross
from kinform.foundation.graphs.graph import blocks
from kinform.kinematics.mobility.loop_system import LoopSystem, loop_system
from kinform.kinematics.pair.joint import twists_of
from kinform.model.arrays import Array
from kinform.model.kinematics import Body, Joint, Misfit

__all__ = ["proportioned"]


SIGMAS = 3.0
"""Axes may move by this many times their uncertainty, as where they are snapped."""
ROUNDING = 1e-8
"""rad, and share of the size: uncertainty of what the single precision of mesh files holds."""
GAP = 1e-12
"""rad, and shares of the size: loops that stay closed to this need nothing."""
STRIDE, STRIDES = 0.12, 16
"""rad (of the joint that turns most) from one pose to the next, and poses on each side of the start."""
FREEDOMS, RATES = 3, 48
"""Blocks with more are left as they are."""
SOUND = 0.01
"""Relative singular value that must be left: nearer to singular poses gaps say more of the pose than of the axes."""
RANK = 1e-6
"""Relative singular value below which rows depend on the others."""
PARALLEL = 1e-14
"""Sine below which axes are exactly parallel: snapping makes them so."""
ROUNDS = 8
"""Of Gauss and Newton: they converge in three."""


def proportioned(
    bodies: Sequence[Body], joints: Sequence[Joint], doubts: Array, size: float, misfit: Misfit
) -> tuple[tuple[Joint, ...], Misfit]:
    """The joints with axes that let redundant loops close along their motions, and the misfit with what was moved.

    `doubts` (joints, 2): uncertainty of directions (rad) and places (m). Loops for which moves within these are not
    enough stay as they are.
    """
    index = {body.name: k for k, body in enumerate(bodies)}
    edges = [(index[j.bodies[0]], index[j.bodies[1]]) for j in joints]
    out = list(joints)
    for block in blocks(len(bodies), edges):
        if len(block) < 2 or any(joints[k].type == "general" or joints[k].status == "ambiguous" for k in block):
            continue
        own = [joints[k] for k in block]
        sigma = np.maximum(doubts[list(block)], [ROUNDING, ROUNDING * size])
        moved = _fitted([edges[k] for k in block], own, sigma, size)
        for k, joint in zip(block, moved, strict=True):
            misfit = _noted(misfit, out[k], joint)
            out[k] = joint
    return tuple(out), misfit


@dataclass(frozen=True, eq=False)
class _Walk:
    """Poses (K, n) along the motions of a block, and the gap that is left there at most."""

    q: Array
    gap: float


def _fitted(edges: Sequence[tuple[int, int]], joints: Sequence[Joint], sigma: Array, size: float) -> Sequence[Joint]:
    """The joints of a block, moved where that closes its loops."""
    if sum(joint.freedoms for joint in joints) > RATES or _planar(joints):
        return joints
    frame = _frame(joints, size)
    system = loop_system(edges, [joint.twists for joint in joints], frame)
    values = np.linalg.svd(system.close(np.zeros((1, system.coordinates))).jacobian[0], compute_uv=False)
    rank = int(np.count_nonzero(values > RANK * max(values.max(initial=0.0), 1e-300)))
    freedoms = system.coordinates - rank
    if rank == 6 * len(system.loops) or not 0 < freedoms <= FREEDOMS:
        return joints
    if _glance(system, rank) < 0.1 * GAP:
        return joints
    before = _walk(system, rank)
    if before.gap < GAP:
        return joints
    members = [int(np.flatnonzero(system.joint == k)[0]) if joints[k].freedoms else -1 for k in range(len(joints))]
    twists = np.zeros((len(joints), 6))
    now, current, walk = list(joints), system, before
    for _ in range(ROUNDS):
        step = _moves(current, walk.q, rank, now, members, sigma, frame, edges)
        twists = twists + step
        now = [_displaced(joint, twist) for joint, twist in zip(now, step, strict=True)]
        current = loop_system(edges, [joint.twists for joint in now], frame)
        walk = _walk(current, rank)
        if walk.gap < GAP:
            break
    if walk.gap > max(0.01 * before.gap, GAP):
        return joints
    for joint, twist, (angle, place) in zip(joints, twists, sigma, strict=True):
        at = np.zeros(3) if joint.point is None else joint.point
        turn, shift = np.linalg.norm(twist[:3]), np.linalg.norm(twist[3:] + cross(twist[:3], at))
        if turn > SIGMAS * angle or shift > SIGMAS * place:
            return joints
    return now


def _planar(joints: Sequence[Joint]) -> bool:
    """Whether all turns are about exactly parallel axes and all slides along or across them: such loops close
    exactly by their kind, and are by far the most."""
    turns = [j.axis for j in joints if j.type in ("revolute", "cylindrical", "planar") and j.axis is not None]
    slides = [j.axis for j in joints if j.type == "prismatic" and j.axis is not None]
    if len(turns) + len(slides) < len(joints) or not turns:
        return False
    crossed = np.linalg.norm(cross(np.array(turns), turns[0]), axis=1).max()
    tilted = [min(abs(float(s @ turns[0])), float(np.linalg.norm(cross(s, turns[0])))) for s in slides]
    return bool(max([float(crossed), *tilted]) < PARALLEL)


def _frame(joints: Sequence[Joint], size: float) -> Frame:
    points = np.array([joint.point for joint in joints if joint.point is not None]).reshape(-1, 3)
    frame = Frame.of(points) if len(points) else Frame(np.zeros(3), size)
    return Frame(frame.centre, max(frame.length, 0.05 * size))


def _glance(system: LoopSystem, rank: int) -> float:
    """The gap one stride on, along all freedoms together: it tells loops that close exactly, as most do."""
    start = np.zeros(system.coordinates)
    _, _, right = np.linalg.svd(system.close(start[None]).jacobian[0])
    ahead = right[rank:].sum(axis=0)
    q, sound = _closed(system, rank, start + STRIDE * ahead / np.abs(ahead).max())[:2]
    return float(np.abs(system.close(q[None]).residual).max()) if sound else np.inf


def _closed(system: LoopSystem, rank: int, q: Array) -> tuple[Array, bool, Array]:
    """The pose near q (n,) that closes the loops as well as its rank allows, whether it is far from singular ones, and
    its freedoms (k, n)."""
    change, values, right = np.ones(1), np.ones(1), np.eye(len(q))
    for _ in range(8):
        closed = system.close(q[None])
        left, values, right = np.linalg.svd(closed.jacobian[0])
        change = -(left[:, :rank].T @ closed.residual[0] / values[:rank]) @ right[:rank]
        q = q + change
        if np.abs(change).max() < 1e-13:
            break
    return q, bool(values[rank - 1] >= SOUND * values[0] and np.abs(change).max() <= 1e-9), right[rank:]


def _walk(system: LoopSystem, rank: int) -> _Walk:
    """Along each freedom and all of them together, to both sides, until a pose is nearly singular."""
    start = np.zeros(system.coordinates)
    _, _, right = np.linalg.svd(system.close(start[None]).jacobian[0])
    free = right[rank:]
    ways = [*free, free.sum(axis=0)] if len(free) > 1 else [*free]
    poses, gap = [], 0.0
    for way in (sign * way for way in ways for sign in (1.0, -1.0)):
        q, ahead = start, way
        for _ in range(STRIDES):
            q, sound, null = _closed(system, rank, q + STRIDE * ahead / np.abs(ahead).max())
            if not sound:
                break
            ahead = null.T @ (null @ ahead)
            if np.abs(ahead).max() < 1e-3:
                break
            poses.append(q)
            gap = max(gap, float(np.abs(system.close(q[None]).residual).max()))
    return _Walk(np.array(poses).reshape(-1, system.coordinates), gap)


def _moves(
    system: LoopSystem,
    q: Array,
    rank: int,
    joints: Sequence[Joint],
    members: Sequence[int],
    sigma: Array,
    frame: Frame,
    edges: Sequence[tuple[int, int]],
) -> Array:
    """(joints, 6) twists (ω; v at the world's origin) of the joints' frames that close the gaps at poses q, the
    least by their uncertainties."""
    number = {body: i for i, body in enumerate(sorted({n for edge in edges for n in edge}))}
    closed, bodies = system.close(q), system.bodies(q)
    count, loops = len(q), len(system.loops)
    carried = _adjoint(bodies)
    effect = np.zeros((count, loops, 6, len(joints), 6))
    weigh = np.zeros((len(joints), 6, 6))
    for k, joint in enumerate(joints):
        if members[k] < 0:
            continue
        first, second = (number[body] for body in edges[k])
        sense = system.loops[:, members[k]]
        at = np.zeros(3) if joint.point is None else (joint.point - frame.centre) / frame.length
        weigh[k, :3, :3] = sigma[k, 0] * np.eye(3)
        weigh[k, 3:, 3:] = sigma[k, 1] / frame.length * np.eye(3)
        weigh[k, 3:, :3] = sigma[k, 0] * _skew(at)
        difference = (carried[:, first] - carried[:, second]) @ weigh[k]
        effect[:, :, :, k] = sense[None, :, None, None] * difference[:, None]
    rows, gaps = [], []
    left, _, _ = np.linalg.svd(closed.jacobian)
    for k in range(count):
        beyond = left[k][:, rank:].T
        rows.append(beyond @ effect[k].reshape(6 * loops, -1))
        gaps.append(beyond @ closed.residual[k])
    matrix, missing = np.concatenate(rows), np.concatenate(gaps)
    answer = np.linalg.lstsq(matrix, -missing, rcond=1e-9)[0].reshape(-1, 6)
    local: Array = np.einsum("jkl,jl->jk", weigh, answer)
    out = local.copy()
    # from the block's units about its centre to metres about the world's origin
    out[:, 3:] = frame.length * local[:, 3:] + cross(np.broadcast_to(frame.centre, (len(local), 3)), local[:, :3])
    return out


def _skew(p: Array) -> Array:
    return np.array([[0.0, -p[2], p[1]], [p[2], 0.0, -p[0]], [-p[1], p[0], 0.0]])


def _adjoint(poses: Array) -> Array:
    """(…, 6, 6) what poses (…, 4, 4) do to twists."""
    R, p = poses[..., :3, :3], poses[..., :3, 3]
    out = np.zeros((*poses.shape[:-2], 6, 6))
    out[..., :3, :3] = out[..., 3:, 3:] = R
    spin = np.zeros_like(R)
    spin[..., 0, 1], spin[..., 0, 2], spin[..., 1, 2] = -p[..., 2], p[..., 1], -p[..., 0]
    spin -= np.swapaxes(spin, -1, -2)
    out[..., 3:, :3] = spin @ R
    return out


def _displaced(joint: Joint, twist: Array) -> Joint:
    """The joint with its frame displaced."""
    if not twist.any():
        return joint
    X = displacement(twist)
    axis, axis2 = (None if a is None else X[:3, :3] @ a for a in (joint.axis, joint.axis2))
    point = None if joint.point is None else X[:3, :3] @ joint.point + X[:3, 3]
    twists = twists_of(joint.type, axis, point, joint.pitch, axis2)
    return replace(joint, axis=axis, point=point, axis2=axis2, twists=twists)


def _noted(misfit: Misfit, old: Joint, new: Joint) -> Misfit:
    """The misfit with how far one joint was moved."""
    if old is new:
        return misfit
    if old.axis is not None and new.axis is not None:
        angle = float(np.linalg.norm(cross(old.axis, new.axis)))
        if angle > misfit.angle:
            misfit = replace(misfit, angle=angle, angle_at=old.name)
    if old.point is not None and new.point is not None:
        distance = float(np.linalg.norm(new.point - old.point))
        if distance > misfit.distance:
            misfit = replace(misfit, distance=distance, distance_at=old.name)
    return misfit
