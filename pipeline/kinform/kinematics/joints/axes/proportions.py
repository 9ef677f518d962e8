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
from dataclasses import replace
from functools import cached_property

import numpy as np

from kinform.foundation.algebra.displacements import adjoint, displacement
from kinform.foundation.algebra.screws import Frame
from kinform.foundation.algebra.vectors import cross, cross_matrix, norm
from kinform.foundation.graphs.graph import blocks
from kinform.foundation.rounding import ARITHMETIC, SINGLE, SOLVED, TINY
from kinform.frozen import dataclass
from kinform.kinematics.joints.axes.bounds import MoveBounds
from kinform.kinematics.joints.axes.constants import FITTING_ROUNDS, MET
from kinform.kinematics.joints.pair.joint import twists_of
from kinform.mechanism.closing import Closing, Termination, close
from kinform.mechanism.frame import joint_frame
from kinform.mechanism.joint_graph import JointGraph
from kinform.mechanism.loop_system import LoopSystem, loop_system
from kinform.mechanism.rank import Rank
from kinform.model.arrays import Array, Flags
from kinform.model.kinematics import Joint

CLOSED_GAP = ARITHMETIC
"""rad, and shares of the size: loops that stay closed to this need nothing."""
GLANCE = 0.1
"""Share of that gap below which one look ahead is enough. Chosen, not measured."""
IMPROVED = 0.01
"""Share of the gap before that moved axes may leave. Chosen, not measured."""
STRIDE = 0.12
"""rad (of the joint that turns most) from one pose to the next. Chosen, not measured."""
STRIDES = 16
"""Poses on each side of the start. Chosen, not measured."""
MOST_FITTED_FREEDOMS = 3
"""Blocks with more freedoms are left as they are. Chosen, not measured."""
MOST_FITTED_RATES = 48
"""So are blocks with more joint rates. Chosen, not measured."""
SOUND_POSE = 0.01
"""Relative singular value that must be left: nearer to singular poses gaps say more of the pose than of the axes.
Chosen, not measured."""
POSES = Termination(closed=MET, accepted=SINGLE)
"""Poses are closed as far as numbers go: what is left open is what axes have to be moved for."""
WAY_LOST = 1e-3
"""Share of a direction that must be left among the freedoms of the next pose. Chosen, not measured."""


def fit_proportions(graph: JointGraph, bounds: MoveBounds, size: float) -> tuple[Joint, ...]:
    """The joints with axes that let redundant loops close along their motions.

    `size` of the assembly (m). Loops for which moves within the bounds are not enough stay as they are.
    """
    out = list(graph.joints)
    for block in blocks(len(graph.bodies), graph.edges):
        joints = [out[k] for k in block]
        if len(block) < 2 or any(joint.type == "general" or joint.status == "ambiguous" for joint in joints):
            continue
        edges, of_block = [graph.edges[k] for k in block], list(block)
        loops = _Loops(edges, joints, bounds.sigma[of_block], bounds.most[of_block], joint_frame(joints, size))
        for k, joint in zip(block, _fit_axes(loops), strict=True):
            out[k] = joint
    return tuple(out)


@dataclass(frozen=True, eq=False)
class _Loops:
    """The loops of one block, with its joints where they are by now."""

    edges: Sequence[tuple[int, int]]
    joints: Sequence[Joint]
    sigma: Array
    """(joints, 2): uncertainty of directions (rad) and places (m)."""
    most: Array
    """(joints, 2): by how much they may be moved."""
    frame: Frame

    @cached_property
    def system(self) -> LoopSystem:
        return loop_system(self.edges, [joint.twists for joint in self.joints], self.frame)


@dataclass(frozen=True, eq=False)
class _Walk:
    """Poses (K, n) along the motions of a block, and the gap that is left there at most."""

    q: Array
    gap: float


def _fit_axes(loops: _Loops) -> Sequence[Joint]:
    """The joints of a block, moved where that closes its loops.

    Blocks that close by their kind, that are not redundant, or that have too many freedoms stay as they are. Each round
    moves the axes for the gaps along a walk through the poses, and walks again through those of the moved loops.
    """
    joints = loops.joints
    if sum(joint.freedoms for joint in joints) > MOST_FITTED_RATES:
        return joints
    system = loops.system
    values = np.linalg.svd(system.equations(system.start).jacobian[0], compute_uv=False)
    rank = int(np.count_nonzero(values > SINGLE * max(values.max(initial=0.0), TINY)))
    freedoms = system.coordinates - rank
    if rank == (3 if _planar(joints) else 6) * len(system.loops) or not 0 < freedoms <= MOST_FITTED_FREEDOMS:
        return joints
    if _glance(system, rank) < GLANCE * CLOSED_GAP:
        return joints
    before = walk = _walk(system, rank)
    if before.gap < CLOSED_GAP:
        return joints
    twists = np.zeros((len(joints), 6))
    moved = loops
    for _ in range(FITTING_ROUNDS):
        step = _moves(moved, walk.q, rank)
        twists = twists + step
        moved = replace(moved, joints=[_displace(j, twist) for j, twist in zip(moved.joints, step, strict=True)])
        walk = _walk(moved.system, rank)
        if walk.gap < CLOSED_GAP:
            break
    if walk.gap > max(IMPROVED * before.gap, CLOSED_GAP):
        return joints
    for joint, twist, (angle, place) in zip(joints, twists, loops.most, strict=True):
        at = np.zeros(3) if joint.point is None else joint.point
        turn, shift = norm(twist[:3]), norm(twist[3:] + cross(twist[:3], at))
        if turn > angle or shift > place:
            return joints
    return moved.joints


def _planar(joints: Sequence[Joint]) -> bool:
    """Whether all turns are about exactly parallel axes and all slides along or across them: three conditions a loop
    are met by their kind, and the other three decide in the plane."""
    turns = [j.axis for j in joints if j.type in ("revolute", "cylindrical", "planar") and j.axis is not None]
    slides = [j.axis for j in joints if j.type == "prismatic" and j.axis is not None]
    if len(turns) + len(slides) < len(joints) or not turns:
        return False
    crossed = np.linalg.norm(cross(np.array(turns), turns[0]), axis=1).max()
    tilted = [min(abs(float(s @ turns[0])), norm(cross(s, turns[0]))) for s in slides]
    return bool(max([float(crossed), *tilted]) < ARITHMETIC)


def _along(system: LoopSystem, start: Array, ways: Array, rank: int) -> tuple[Closing, Flags, list[Array]]:
    """Poses one stride from `start` (K, n) along `ways` (K, n), closed as well as their rank allows; which of them (K,)
    closed and are far from singular ones; and their freedoms (k, n)."""
    ahead = start + STRIDE * ways / np.abs(ways).max(axis=1, keepdims=True)
    closing = close(system, ahead, rank=Rank(number=rank), until=POSES)
    _, values, right = np.linalg.svd(closing.jacobian)
    sound = (values[:, rank - 1] >= SOUND_POSE * values[:, 0]) & closing.closed
    return closing, np.asarray(sound), list(right[:, rank:])


def _glance(system: LoopSystem, rank: int) -> float:
    """The gap one stride on, along all freedoms together: it tells loops that close exactly, as most do."""
    _, _, right = np.linalg.svd(system.equations(system.start).jacobian[0])
    closing, sound, _ = _along(system, system.start, right[rank:].sum(axis=0)[None], rank)
    return float(closing.residual[0]) if sound[0] else np.inf


def _walk(system: LoopSystem, rank: int) -> _Walk:
    """Along each freedom and all of them together, to both sides, until a pose is nearly singular."""
    _, _, right = np.linalg.svd(system.equations(system.start).jacobian[0])
    free = right[rank:]
    ways = np.concatenate([free, free.sum(axis=0)[None]] if len(free) > 1 else [free])
    ways = np.concatenate([ways, -ways])
    q = np.repeat(system.start, len(ways), axis=0)
    poses, gap = [], 0.0
    for _ in range(STRIDES):
        closing, sound, nulls = _along(system, q, ways, rank)
        ways = np.array([null.T @ (null @ way) for null, way in zip(nulls, ways, strict=True)])
        going = sound & (np.abs(ways).max(axis=1) >= WAY_LOST)
        if not going.any():
            break
        q, ways = closing.q[going], ways[going]
        poses.append(q)
        gap = max(gap, float(closing.residual[going].max()))
    return _Walk(np.concatenate([np.zeros((0, system.coordinates)), *poses]), gap)


def _moves(loops: _Loops, q: Array, rank: int) -> Array:
    """(joints, 6) twists (ω; v at the world's origin) of the joints' frames that close the gaps at poses q, the
    least by their uncertainties.

    What a frame's twist does to a loop is the difference of what the bodies on its two sides make of it, in the sense
    in which the loop runs through the joint. Of that only what no joint rate can close counts: rows beyond the rank.
    """
    system, frame, sigma = loops.system, loops.frame, loops.sigma
    number = {body: i for i, body in enumerate(sorted({n for edge in loops.edges for n in edge}))}
    closed, carried = system.equations(q), adjoint(system.bodies(q))
    count, cycles, size = len(q), len(system.loops), len(loops.joints)
    effect = np.zeros((count, cycles, 6, size, 6))
    weigh = np.zeros((size, 6, 6))
    for k, joint in enumerate(loops.joints):
        if not joint.freedoms:
            continue
        first, second = (number[body] for body in loops.edges[k])
        sense = system.loops[:, np.flatnonzero(system.joint == k)[0]]
        at = np.zeros(3) if joint.point is None else (joint.point - frame.centre) / frame.length
        weigh[k, :3, :3] = sigma[k, 0] * np.eye(3)
        weigh[k, 3:, 3:] = sigma[k, 1] / frame.length * np.eye(3)
        weigh[k, 3:, :3] = sigma[k, 0] * cross_matrix(at)
        difference = (carried[:, first] - carried[:, second]) @ weigh[k]
        effect[:, :, :, k] = sense[None, :, None, None] * difference[:, None]
    rows, gaps = [], []
    left, _, _ = np.linalg.svd(closed.jacobian)
    for k in range(count):
        beyond = left[k][:, rank:].T
        rows.append(beyond @ effect[k].reshape(6 * cycles, -1))
        gaps.append(beyond @ closed.residual[k])
    matrix, missing = np.concatenate(rows), np.concatenate(gaps)
    answer = np.linalg.lstsq(matrix, -missing, rcond=SOLVED)[0].reshape(-1, 6)
    local: Array = np.einsum("jkl,jl->jk", weigh, answer)
    out = local.copy()
    # from the block's units about its centre to metres about the world's origin
    out[:, 3:] = frame.length * local[:, 3:] + cross(np.broadcast_to(frame.centre, (len(local), 3)), local[:, :3])
    return out


def _displace(joint: Joint, twist: Array) -> Joint:
    """The joint with its frame displaced."""
    if not twist.any():
        return joint
    X = displacement(twist)
    axis, axis2 = (None if a is None else X[:3, :3] @ a for a in (joint.axis, joint.axis2))
    point = None if joint.point is None else X[:3, :3] @ joint.point + X[:3, 3]
    twists = twists_of(joint.type, axis, point, joint.pitch, axis2)
    return replace(joint, axis=axis, point=point, axis2=axis2, twists=twists)
