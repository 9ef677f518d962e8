"""Which joint stands wrong where loops nearly move: the least correction of one joint after which they do.

Loops whose closure equations have one singular value far below all others have a motion that they nearly make, and that
something off by as little forbids: a hinge a hundredth of a millimetre beside its place, an axis a tenth of a degree
askew. So have loops that give to first order and then lock: a crank that is a little too long. For each joint that may
be it, unknowns are its correction and the poses of the block at a few steps along that motion, both ways; equations are
that all loops close there (Gauss and Newton). Where they can be met, the joint so corrected is asked for its motions
like any other (`mobility.local_dimension`): what only turns a lock into a shaky pose is no correction.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.vectors import norm, perpendicular
from kinform.foundation.graphs.graph import blocks
from kinform.foundation.rounding import ARITHMETIC, SOLVED, TINY
from kinform.frozen import dataclass
from kinform.kinematics.joints.axes.snapping import LINES
from kinform.kinematics.joints.pair.joint import twists_of
from kinform.kinematics.mobility.finite_motion import MOVING_JOINT
from kinform.kinematics.mobility.local_dimension import local_motions
from kinform.mechanism.closing import FirstOrder, StepLimit, Termination, close
from kinform.mechanism.constants import FREE
from kinform.mechanism.frame import joint_frame
from kinform.mechanism.joint_graph import JointGraph
from kinform.mechanism.loop_system import Index, LoopSystem, loop_system
from kinform.mechanism.pose import Pose
from kinform.mechanism.rank import Rank
from kinform.model.arrays import Array
from kinform.model.kinematics import Joint, Kinematics
from kinform.model.names import JointName

NEARLY = 0.02
"""Singular value of the closure over the greatest, below which a motion is nearly made: that of a hinge 2 % of the size
beside its place."""
NEARLY_APART = 10.0
"""The next singular value has to be greater by 1/(NEARLY · this), which is five times: else it is no single motion. A
choice."""
MOST_CORRECTED = 0.02
"""Greatest correction: rad, or shares of the size of the loops. What is off by more is another design."""
AS_SMALL = 1.5
"""Corrections up to so many times the least are told with it: any of them may be what is wrong."""
MOST_NEAR_RATES = 40
"""Joint rates of a block that is asked: each joint takes some hundred poses of it."""
NEAR_STEPS = (-0.6, -0.3, 0.3, 0.6)
"""Steps along the motion, of its rates together (rad, or shares of the size), at which loops have to close."""
NEAR_DIFFERENCE = 1e-5
"""Half the difference of a correction by which its effect is found."""
NEAR_RANK = Rank(share=SOLVED)
"""Motions and corrections are of different sizes: whatever is more than rounding counts."""
EXACTLY = Termination(accepted=ARITHMETIC, iterations=12)
"""Corrections are as small as what axes usually miss each other by: loops have to close but for
rounding. Four or five steps are usual."""
NEAR_LIMIT = StepLimit(4.0)
"""Poses at all steps change together, by twice as much as one does."""


@dataclass(frozen=True, eq=False)
class Correction:
    """What one joint would have to be moved by for the loops to move: a shift or a tilt."""

    joint: JointName
    shift: Array
    """(3,) m, of its point; zero for a tilt."""
    tilt: float
    """rad, of its axis; 0 for a shift."""
    effect: float
    """Shift, or tilt times the size of the loops (m): what corrections are compared by."""


@dataclass(frozen=True, eq=False)
class NearMotion:
    """A motion that loops nearly make."""

    moves: tuple[JointName, ...]
    """Joints that would move."""
    corrections: tuple[Correction, ...]
    """The least first; any one of them would do."""


def near_motions(kinematics: Kinematics) -> tuple[NearMotion, ...]:
    """Motions that a small correction of one joint would free, block by block of loops; without those of blocks that
    have ambiguous or general joints, or are large."""
    graph = JointGraph(kinematics.bodies, kinematics.joints)
    found = []
    for block in blocks(len(graph.bodies), graph.edges):
        joints = [graph.joints[k] for k in block]
        doubtful = any(joint.type == "general" or joint.status == "ambiguous" for joint in joints)
        if len(block) > 1 and not doubtful and sum(joint.freedoms for joint in joints) <= MOST_NEAR_RATES:
            near = _of_block([graph.edges[k] for k in block], joints, kinematics)
            if near is not None:
                found.append(near)
    return tuple(found)


@dataclass(frozen=True, eq=False)
class _Block:
    """A block of loops and the motion (n,) that it nearly makes, in coordinates of its loop system."""

    edges: Sequence[tuple[int, int]]
    joints: Sequence[Joint]
    size: float
    """m: of the assembly."""
    way: Array

    def system(self, joints: Sequence[Joint]) -> LoopSystem:
        """The loops with these joints, in the frame of the block as it is."""
        return loop_system(self.edges, [joint.twists for joint in joints], joint_frame(self.joints, self.size))

    def freedoms(self, joints: Sequence[Joint]) -> int:
        """Of motions over a distance; 0 where that is not known."""
        return local_motions(self.system(joints)).dimension or 0


def _of_block(edges: Sequence[tuple[int, int]], joints: Sequence[Joint], kinematics: Kinematics) -> NearMotion | None:
    """The motion that a block of loops nearly makes, where a joint can be corrected so that it does."""
    size = _size(kinematics)
    frame = joint_frame(joints, size)
    system = loop_system(edges, [joint.twists for joint in joints], frame)
    motions, way = local_motions(system), _nearly_free(system)
    if way is None and len(motions.lost):
        # The loops give a little, and lock.
        way = motions.lost[0]
    elif way is None and motions.dimension is None and motions.freedoms == 1:
        # Perhaps they do: by so little that no step shows it.
        way = Pose.at(system, system.start[0]).free[0]
    if way is None:
        return None
    block, now = _Block(edges, joints, size, way), motions.dimension or 0
    found = []
    for k, joint in enumerate(joints):
        each = (_correction(block, k, _ways(joint, tilts), now, tilts) for tilts in (False, True))
        found += [one for one in each if one is not None]
    if not found:
        return None
    # Equal ones, as the two ends of a crank, by their names: rounding is no order.
    found.sort(key=lambda one: (float(f"{one.effect:.3g}"), one.joint, one.tilt))
    least = [one for one in found if one.effect <= AS_SMALL * found[0].effect]
    rates = np.abs(block.way)
    moving = np.unique(system.joint[rates > MOVING_JOINT * rates.max()])
    return NearMotion(tuple(joints[k].name for k in moving), tuple(least))


def _nearly_free(system: LoopSystem) -> Array | None:
    """(n,) the motion that one singular value far below all others forbids; None where there is none."""
    _, values, right = np.linalg.svd(system.equations(system.start).jacobian[0])
    rank = int(np.count_nonzero(values > FREE * values.max(initial=TINY)))
    if rank < 2 or values[rank - 1] > NEARLY * min(values[0], NEARLY_APART * values[rank - 2]):
        return None
    return np.asarray(right[rank - 1])


def _size(kinematics: Kinematics) -> float:
    """m: extent of the joints."""
    points = np.array([joint.point for joint in kinematics.joints if joint.point is not None])
    return max(norm(np.ptp(points, axis=0)), 1e-9) if len(points) else 1.0


def _ways(joint: Joint, tilts: bool) -> list[Array]:
    """(3,) unit directions in which a joint may be shifted, or its axis tilted."""
    if joint.type == "spherical":
        return [] if tilts else list(np.eye(3))
    if joint.axis is None or joint.type not in (*LINES, "prismatic", "planar", "universal"):
        return []
    return list(perpendicular(joint.axis)) if tilts or joint.type in LINES else []


def _moved(joint: Joint, ways: Sequence[Array], amounts: Array, tilts: bool) -> Joint:
    """The joint, shifted (m) or tilted (rad) by so much in these ways."""
    change = sum((amount * way for amount, way in zip(amounts, ways, strict=True)), np.zeros(3))
    axis, point = joint.axis, joint.point
    if tilts:
        assert axis is not None
        axis = (axis + change) / norm(axis + change)
    elif point is not None:
        point = point + change
    return replace(joint, axis=axis, point=point, twists=twists_of(joint.type, axis, point, joint.pitch, joint.axis2))


def _correction(block: _Block, k: int, ways: Sequence[Array], now: int, tilts: bool) -> Correction | None:
    """The least correction of joint k of the block in these ways after which it has more freedoms than `now`."""
    if not ways:
        return None
    joint, length = block.joints[k], joint_frame(block.joints, block.size).length
    unit = 1.0 if tilts else length

    def corrected(amounts: Array) -> list[Joint]:
        joints = list(block.joints)
        joints[k] = _moved(joint, ways, unit * amounts, tilts)
        return joints

    amounts = _solved(lambda amounts: block.system(corrected(amounts)), block.way, len(ways))
    if amounts is None or not 0.0 < norm(amounts) <= MOST_CORRECTED:
        return None
    if block.freedoms(corrected(amounts)) <= now:
        return None
    change = sum((amount * way for amount, way in zip(amounts, ways, strict=True)), np.zeros(3))
    effect = length * norm(amounts)
    return Correction(joint.name, np.zeros(3) if tilts else length * change, norm(amounts) if tilts else 0.0, effect)


@dataclass(frozen=True, eq=False)
class _Bordered:
    """Poses at steps along a way together with the correction of a joint, as one system of equations.

    Its one configuration are the S poses, n coordinates each, and then the amounts: all loops close at all poses, each
    of which is as far along the way as its step says.
    """

    system_with: Callable[[Array], LoopSystem]
    way: Array

    def equations(self, q: Array) -> FirstOrder:
        """At configurations (1, S n + amounts)."""
        steps, n = np.array(NEAR_STEPS), len(self.way)
        poses, amounts = q[0, : len(steps) * n].reshape(len(steps), n), q[0, len(steps) * n :]
        closed = self.system_with(amounts).equations(poses)
        beside = [self._beside(poses, amounts, h) for h in NEAR_DIFFERENCE * np.eye(len(amounts))]
        rows = closed.residual.shape[1] + 1
        missed, matrix = np.zeros((len(steps), rows)), np.zeros((len(steps), rows, q.shape[1]))
        missed[:, :-1], missed[:, -1] = closed.residual, poses @ self.way - steps
        for s in range(len(steps)):
            matrix[s, :-1, s * n : (s + 1) * n], matrix[s, -1, s * n : (s + 1) * n] = closed.jacobian[s], self.way
        matrix[:, :-1, len(steps) * n :] = np.stack(beside, axis=2)
        return FirstOrder(missed.reshape(1, -1), matrix.reshape(1, -1, q.shape[1]))

    def _beside(self, poses: Array, amounts: Array, h: Array) -> Array:
        """(S, m) derivative of the residuals by one of the amounts."""
        up, down = (self.system_with(amounts + sign * h).equations(poses).residual for sign in (1.0, -1.0))
        return np.asarray((up - down) / (2.0 * NEAR_DIFFERENCE))

    def advance(self, q: Array, change: Array) -> Array:
        """See `mechanism.closing.System`."""
        return q + change

    def rows(self, which: Index) -> _Bordered:
        """See `mechanism.closing.System`."""
        return self


def _solved(system_with: Callable[[Array], LoopSystem], way: Array, count: int) -> Array | None:
    """(count,) amounts at which all loops close at steps along the way; None where they do not."""
    start = np.concatenate([np.outer(NEAR_STEPS, way).ravel(), np.zeros(count)])
    q = close(_Bordered(system_with, way), start[None], rank=NEAR_RANK, limit=NEAR_LIMIT, until=EXACTLY).one()
    return None if q is None else q[len(start) - count :]
