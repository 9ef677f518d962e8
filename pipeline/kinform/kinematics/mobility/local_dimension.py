"""Which motions a block of closed loops really has at a pose: the local dimension of its configurations.

Three tests, none of which needs another's result:

- steps: go along a combination of the first-order freedoms and solve the loops again by Gauss–Newton. Where
  the pose is regular, a solve that is truncated to the rank at the pose closes the loops, and the rank there is
  the same: then the configurations near the pose are a manifold of as many dimensions as there are freedoms
  (constant rank theorem). Elsewhere the full solve tells what remains of each step: nothing at a shaky
  structure, motion along a branch at a bifurcation. A generic step that is kept spans the tangent cone.
- second order: the curvature of the closure (`second_order`).
- group: where the joints of a block generate a group of motions and each loop has its full rank in it, the
  closure is a submersion into that group and the pose regular (Hervé 1978), without any step.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from kinform.foundation.algebra.screws import bracket
from kinform.foundation.algebra.vectors import norm
from kinform.foundation.lockstep import run_in_lockstep
from kinform.foundation.rounding import ARITHMETIC, SINGLE, SOLVED, TINY
from kinform.frozen import dataclass
from kinform.kinematics.mobility.second_order import complement, independent, second_order, units
from kinform.mechanism.closing import Closing, StepLimit, Task, Termination, close, close_each
from kinform.mechanism.constants import FREE
from kinform.mechanism.least_change import FINEST_VALUE
from kinform.mechanism.loop_system import LoopSystem
from kinform.mechanism.pose import Pose, reference_poses
from kinform.mechanism.rank import Rank
from kinform.model.arrays import Array
from kinform.model.kinematics import CurvatureVerdict

MIXES = 3
"""Mixes of the freedoms, all of which must be kept: one could by chance lie in a branch of its own."""
MANY_MIXES = 6
"""Mixes at a singular pose, beside the freedoms themselves. Chosen, not measured."""
BRANCH_MIXES = 2
"""Mixes at a pose that lies on one branch, as far as is known. Chosen, not measured."""
STEP_SIZES = (0.05, 0.01, 0.002)
"""rad, and shares of the block's size: near a singular pose a long step leaves the neighbourhood. Chosen, not
measured."""
HIGHER_ORDER = 0.3
"""What a half stride leaves of a whole one's residual: more is misfit, which grows with the step, less an obstruction
of higher order. Chosen, not measured."""
STEP_KEPT = 0.9
"""Share of a step that is left when the motion is real. Chosen, not measured."""
STEP_LOST = 0.1
"""Share that is left when it is none. Chosen, not measured."""
STEP_ASTRAY = 2.0
"""Steps that end farther than this many steps away lead elsewhere. Chosen, not measured."""
STEP_ASIDE = 0.2
"""Share of a step that may go aside within a smooth branch. Chosen, not measured."""
CONE_SHARE = 0.05
"""Relative singular value from which on the ends of steps span a direction of the tangent cone. Chosen, not
measured."""
MOST_BRANCHES = 8
"""Branches that are told apart. Chosen, not measured."""
SAME_BRANCH = 0.95
"""Least cosine between the freedoms of two poses of one branch. Chosen, not measured."""
BRANCH_STEP = 0.1
"""Share of the distance from the pose by which a branch is stepped along. Chosen, not measured."""
MOST_STEP_WORK = 2e10
"""Multiplications that the steps at a singular pose may take; a block that needs more stays undecided. Chosen, not
measured."""
FULL_RANK = Rank(share=FINEST_VALUE)
"""At singular poses: whatever is more than rounding counts."""
QUADRATIC = Termination(accepted=0.0, iterations=12, change=SOLVED)
"""Where convergence is quadratic, or there is none: a change by 1e-9 leaves a residual of 1e-18."""
LINEAR = Termination(accepted=0.0, iterations=60, change=1e-11)
"""Where convergence is linear: halving, at a simple singularity, from steps of 0.05 to 1e-11 in 32, and in twice as
many where the singularity is of higher order."""
CUT = 0.5
"""Share of a step that one iteration may change at most: it may not leave for another branch. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class LocalMotions:
    """What is known of the motions of one block at its pose."""

    freedoms: int
    """Of first order."""
    dimension: int | None
    """Of the motions: the largest of the branches through the pose; None where it was not decided."""
    lost: Array
    """(m, n) coordinate rates of freedoms that no branch has."""
    branches: tuple[int, ...] = ()
    """Dimensions of the branches that were found, eight at most; a single one where the pose is regular, and
    where the motions beside the pose make a cone that is no union of smooth branches."""
    step: float = 0.0
    kept: float = 0.0
    """Least share kept of a generic step where the pose is regular, else the greatest of any step."""
    residual: float = 0.0
    """Greatest closure error of the stepped poses that count (rad, and shares of the size)."""
    stepped: int | None = None
    """Freedoms of first order at stepped poses: the most; None where no step was kept."""
    order: CurvatureVerdict = ""
    """Second order: "extends" (all freedoms), "partly" (some directions), "obstructed" (none), "" not tested."""
    reason: str = ""
    """Why `dimension` is not known; else empty."""


Result = TypeVar("Result")

Steps = Generator[Task, Closing, Result]
"""A way to a result, with steps on it that others may go at the same time."""


def local_motions(system: LoopSystem) -> LocalMotions:
    """Motions of the block at its reference pose."""
    return local_motions_of_each([system])[0]


def local_motions_of_each(systems: Sequence[LoopSystem]) -> list[LocalMotions]:
    """Motions of each of several blocks at its reference pose: as if it were alone, to the last bit."""
    return run_in_lockstep([_local_motions(pose) for pose in reference_poses(systems)], close_each)


def _local_motions(pose: Pose) -> Steps[LocalMotions]:
    """Motions of a block at its reference pose."""
    count, none = pose.freedoms, np.zeros((0, pose.system.coordinates))
    if count == 0:
        return LocalMotions(0, 0, none, stepped=0)
    # A seed makes the random mixes of freedoms that are stepped along the same in every run.
    rng = np.random.default_rng(20000)
    mixes = units(rng.normal(size=(1 if _submersion(pose) else MIXES, count)))
    if count == 1:
        mixes = np.unique(mixes, axis=0)  # forth and back are all that there is
    mixes = mixes @ pose.free
    bends = np.linalg.norm(pose.obstruction(mixes), axis=1)
    for step in STEP_SIZES:
        closed = yield from _regular(pose, mixes, step, STEP_SIZES[0])
        # Curvature that is none.
        if closed is not None and bends.max() > 1e-4:
            why = "steps close, but the second-order test finds an obstruction"
            return LocalMotions(count, None, none, (count,), step, *closed, count, "obstructed", why)
        if closed is not None:
            return LocalMotions(count, count, none, (count,), step, *closed, count, "extends")
    return _singular(pose, rng)


def _submersion(pose: Pose) -> bool:
    """Does each independent loop have the full rank of the algebra that the joints generate?"""
    system = pose.system
    generators = independent(system.screws)
    algebra = generators
    while len(algebra) < 6:
        products = bracket(algebra[:, None], generators[None]).reshape(-1, 6)
        larger = independent(np.concatenate([algebra, products]))
        if len(larger) == len(algebra):
            break
        algebra = larger
    return pose.rank == len(algebra) * len(system.loops) + len(system.ties)


def _regular(pose: Pose, mixes: Array, stride: float, step: float) -> Steps[tuple[float, float] | None]:
    """(least share kept of a stride, greatest residual) if walks of length `step` along mixes (D, n) close with
    the rank of the pose and find that rank again; else None. However short the strides, the walk goes on to the
    full step: obstructions of third and higher order cannot be told from rounding nearby."""
    q, kept, closed = pose.q, 1.0, max(FREE, pose.system.rounding)
    for _ in range(round(step / stride)):
        ahead = q + stride * mixes
        closing = yield _beside(pose, ahead, stride)
        q, residual, jacobian = closing.q, closing.residual, closing.jacobian
        kept = min(kept, 1.0 - float(np.abs(((ahead - q) * mixes).sum(axis=1)).max()) / stride)
        if residual.max() > closed * step or kept < STEP_KEPT:
            return None
    worst = float(residual.max())
    # where the numbers of the place leave more unknown, what is missed may be that
    misfit = worst > max(ARITHMETIC, pose.system.rounding * step)
    if misfit:
        # it grows with the step where axes are off, an obstruction of third or higher order with its powers
        half = yield _beside(pose, pose.q + 0.5 * stride * mixes, stride)
        if float(half.residual.max()) < HIGHER_ORDER * worst * stride / step:
            return None
    values = np.linalg.svd(jacobian, compute_uv=False)
    beyond = values[:, pose.rank :].max(initial=0.0) / max(values.max(), TINY)
    # where the loops close to rounding over the whole step, nothing of the axes' misfit is in the rank
    zero = SINGLE if misfit else SOLVED
    return (kept, worst) if beyond < max(zero, pose.system.rounding) else None


def _beside(pose: Pose, start: Array, stride: float) -> Task:
    """Close the loops near `start` (D, n), strides beside a pose that is taken to be regular."""
    return Task(pose.system, start, pose.regular, StepLimit(CUT * stride), QUADRATIC)


def _closed(pose: Pose, start: Array, step: float) -> Closing:
    """Close the loops near `start` (D, n), steps beside a pose that may be singular."""
    return close(pose.system, start, rank=FULL_RANK, limit=StepLimit(CUT * step), until=LINEAR)


@dataclass(frozen=True, eq=False)
class _Spread:
    """Where steps in all first-order directions end."""

    ends: Array
    """(e, n) closed configurations that stay away from the pose."""
    cone: Array
    """(c, n) orthonormal: what the motions from the pose to the ends span, of the first-order freedoms."""
    kept: float
    residual: float
    undecided: int
    """Steps after which the loops did not close."""


def _spread(pose: Pose, directions: Array, step: float) -> _Spread:
    """Steps both ways along directions (D, n), solved in full."""
    start = pose.q + step * np.concatenate([directions, -directions])
    found = _closed(pose, start, step)
    q, residual = found.q, found.residual
    moved = (q - pose.q) @ pose.free.T / step
    kept = np.linalg.norm(moved, axis=1)
    closed = residual < max(FREE, pose.system.rounding) * step
    stays = closed & (kept > STEP_LOST) & (np.linalg.norm(q - start, axis=1) < STEP_ASTRAY * step)
    _, values, right = np.linalg.svd(moved[stays], full_matrices=False)
    cone = right[: int(np.count_nonzero(values > CONE_SHARE * values.max(initial=0.0)))] @ pose.free
    return _Spread(
        q[stays],
        cone,
        float(kept[closed].max(initial=0.0)),
        float(residual[stays].max(initial=0.0)),
        int(np.count_nonzero(~closed)),
    )


def _smooth(pose: Pose, cone: Array, step: float, rng: np.random.Generator) -> bool:
    """Is every step within the cone kept, so that the cone is the tangent space of one smooth branch?"""
    if not len(cone):
        return True
    mixes = units(rng.normal(size=(MIXES, len(cone)))) @ cone
    found = _closed(pose, pose.q + step * mixes, step)
    q, residual = found.q, found.residual
    kept = ((q - pose.q) * mixes).sum(axis=1) / step
    aside = np.linalg.norm((q - pose.q) @ pose.free.T / step - kept[:, None] * (mixes @ pose.free.T), axis=1)
    return bool(
        residual.max() < max(FREE, pose.system.rounding) * step and kept.min() > STEP_KEPT and aside.max() < STEP_ASIDE
    )


def _singular(pose: Pose, rng: np.random.Generator) -> LocalMotions:
    """Motions at a pose that is not regular: steps of two sizes have to agree with each other, and with the second
    order. What they found is told with the reason where they do not."""
    order, along = second_order(pose, rng)
    directions = np.concatenate([along, pose.free, units(rng.normal(size=(MANY_MIXES, pose.freedoms))) @ pose.free])
    none = np.zeros((0, pose.system.coordinates))
    rows, columns = 6 * len(pose.system.loops), pose.system.coordinates
    if 2.0 * len(directions) * LINEAR.iterations * rows * columns * min(rows, columns) > MOST_STEP_WORK:
        why = "the pose is singular, and the block too large for the steps that would tell its branches"
        return LocalMotions(pose.freedoms, None, none, order=order, reason=why)
    wide, narrow = STEP_SIZES[:2]
    first, second = (_explore(pose, directions, step, rng) for step in (wide, narrow))
    reason = ""
    if second.dimension is None:
        reason = second.reason
    elif first.dimension != second.dimension or len(first.lost) != len(second.lost):
        reason = f"steps of {wide:g} and {narrow:g} disagree"
    elif second.dimension >= pose.freedoms:
        reason = "the pose is singular, but no step shows what is lost"
    elif order == "obstructed" and second.dimension:
        reason = "steps find a motion that the second-order test forbids"
    elif second.dimension == 0 and order != "obstructed" and second.reason:
        reason = second.reason
    motions = replace(second, order=order, reason=reason)
    return replace(motions, dimension=None, lost=none) if reason else motions


def _explore(pose: Pose, directions: Array, step: float, rng: np.random.Generator) -> LocalMotions:
    """Branches through the pose that steps of one size find.

    Where every step within the tangent cone is kept, the cone is the one branch. Else each end of a step whose freedoms
    are new is a branch, of the dimension of the motions there; where the motions beside the pose are no union of smooth
    branches, only the largest dimension counts.
    """
    spread = _spread(pose, directions, step)
    lost = complement(pose.free, spread.cone)
    doubt = "the loops did not close after a step" if spread.undecided else ""
    if _smooth(pose, spread.cone, step, rng):
        count = len(spread.cone)
        # at stepped poses loops are closed to rounding, and freedoms are free to that of files
        stepped = [Pose.at(pose.system, q, SINGLE).freedoms for q in spread.ends[:1]]
        measured = step, spread.kept, spread.residual, max(stepped, default=None)
        return LocalMotions(pose.freedoms, count, lost, (count,) if count else (), *measured, reason=doubt)
    poses: list[Pose] = []
    dimensions: list[int | None] = []
    for end in spread.ends:
        there = Pose.at(pose.system, end, SINGLE)
        fresh = len(poses) < MOST_BRANCHES or all(there.freedoms != other.freedoms for other in poses)
        if fresh and not any(_same(there, other) for other in poses):
            poses.append(there)
            dimensions.append(_dimension(there, BRANCH_STEP * norm(end - pose.q), rng))
    decided = [] if None in dimensions else [d for d in dimensions if d is not None]
    if not decided:
        doubt = "a branch is singular itself"
    elif not all(_smooth(pose, independent(b.free @ pose.free.T @ pose.free), step, rng) for b in poses):
        decided = [max(decided)]
    measured = step, spread.kept, spread.residual, max((b.freedoms for b in poses), default=None)
    branches = tuple(sorted(decided, reverse=True))
    return LocalMotions(pose.freedoms, max(decided, default=None), lost, branches, *measured, reason=doubt)


def _dimension(pose: Pose, step: float, rng: np.random.Generator) -> int | None:
    """Dimension of the motions at a pose that lies on a single branch; None if it does not."""
    count = pose.freedoms
    if count == 0:
        return 0
    mixes = units(rng.normal(size=(BRANCH_MIXES, count))) @ pose.free
    if run_in_lockstep([_regular(pose, mixes, step, step)], close_each)[0] is not None:
        return count
    more = units(rng.normal(size=(count + 3, count))) @ pose.free
    cone = _spread(pose, more, step).cone
    return len(cone) if _smooth(pose, cone, step, rng) else None


def _same(a: Pose, b: Pose) -> bool:
    """Do two stepped poses have nearly the same freedoms, so that they lie on one branch?"""
    if a.freedoms != b.freedoms:
        return False
    if a.freedoms == 0:
        return True
    cosines = np.linalg.svd(a.free @ b.free.T, compute_uv=False)
    return bool(cosines.min() > SAME_BRANCH)
