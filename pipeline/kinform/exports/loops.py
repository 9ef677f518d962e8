"""Which equations of the loops are independent, and which coordinates they leave.

Redundant loops have dependent equations, which solvers of equations reject. A joint that closes a loop
ends in a frame that must coincide with its second body: six rows, in axes of that frame that follow the
joint's axis, so that what is redundant at the start (all that leaves the plane of a planar linkage) stays
redundant. Rows are taken greedily, the best supported first, until there are as many as the rank that the
simulation uses. The coordinates that are left free are chosen so that they stay good along our run.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.behaviour import JointComponent, MotionDrive
from kinform.exports.model import ExportModel
from kinform.exports.tree import Closing, Tree
from kinform.foundation.algebra.vectors import perpendicular
from kinform.model.arrays import Array
from kinform.simulation.mechanism.closure import rank_of

__all__ = ["Closure", "Loops", "held_rates", "loops", "singular"]


MOVED = 1e-9
"""rad or m: what counts as motion."""
SAMPLES = 24
"""Poses of our run at which the free coordinates must be good."""
CLOSE = 0.7
"""Choices within this factor of the best count as equal, and the first is taken: the same on all machines."""


@dataclass(frozen=True, eq=False)
class Closure:
    """The frame at the end of a closing joint must coincide with the second body in the rows that are held."""

    joint: JointComponent
    a: int
    """Link of the tree that the joint starts from."""
    b: int
    """Link that it ends at."""
    point: Array
    """(3,) m, world at the pose of the meshes."""
    axes: Array
    """(3, 3) columns: the axes of the rows, at the pose of the meshes."""
    place: tuple[bool, bool, bool]
    """Which displacements along the axes are held."""
    turn: tuple[bool, bool, bool]
    """Which turns about the axes are held."""


@dataclass(frozen=True, eq=False)
class Loops:
    """Closures in order, gears that are held, and the rates that are free."""

    closures: tuple[Closure, ...]
    gears: tuple[bool, ...]
    free: frozenset[int]
    """Indices of rates that drives and loops leave free."""
    led: frozenset[int]
    """Indices of rates that drives prescribe."""


def loops(model: ExportModel, tree: Tree) -> Loops:
    """The independent equations of the loops of `tree`, which must be that of our simulation."""
    mechanism = model.mechanism
    reached = [k for k, link in enumerate(tree.links) if _reached(tree, k)]
    closings = [c for c in tree.closing if not c.rigid and c.a in reached]
    led = frozenset(
        slot.v.start
        for slot, joint in zip(mechanism.slots, model.system.joints, strict=True)
        if any(isinstance(actor, MotionDrive) for actor in model.system.actors(joint.name))
    )
    rest = np.array([k for k in range(mechanism.rates) if k not in led], dtype=np.int64)
    frames = [_axes(closing) for closing in closings]
    scale = mechanism.scale[rest]
    rows = _rows(model, closings, frames, model.q)[:, rest] * scale
    rank = rank_of(
        mechanism.closure(mechanism.screws(mechanism.poses(model.q)))[:, rest], scale, model.assembly.tolerances.free
    )
    # Gears come last among the rows and first among the choices: they are stated, loops are not.
    gears = len(mechanism.gear_v)
    order = [*range(len(rows) - gears, len(rows)), *range(len(rows) - gears)]
    held = {order[k] for k in _independent(rows[order], rank)}
    closures = []
    for n, (closing, axes) in enumerate(zip(closings, frames, strict=True)):
        place, turn = (tuple(6 * n + side + k in held for k in range(3)) for side in (3, 0))
        point = closing.joint.geometry.point
        closures.append(
            Closure(
                closing.joint, closing.a, closing.b, mechanism.centre if point is None else point, axes,
                (place[0], place[1], place[2]), (turn[0], turn[1], turn[2]),
            )
        )  # fmt: skip
    free = _free(model, closings, frames, rest, sorted(held))
    gear_rows = range(len(rows) - gears, len(rows))
    return Loops(tuple(closures), tuple(k in held for k in gear_rows), frozenset(rest[free].tolist()), led)


def held_rates(model: ExportModel, found: Loops, lost: list[str], remarks: list[str]) -> frozenset[int]:
    """Rates that the equations hold, because our run is one without forces; what that run did otherwise is added."""
    run = model.simulation
    if model.with_forces or run is None or not found.free:
        return frozenset()
    remarks.append("our run is one without forces: joints that nothing prescribes are held where they start")
    columns = dict(zip(run.joint_names, run.joint_offset, strict=False))
    for slot in model.mechanism.slots:
        held = [k for k in range(slot.v.stop - slot.v.start) if slot.v.start + k in found.free]
        if held and slot.has_ball:
            lost.append(f"{slot.name}: in our run it rests, here its spherical joint swings")
        elif any(np.ptp(run.joint_position[:, int(columns[slot.name]) + k]) > MOVED for k in held):
            lost.append(
                f"{slot.name}: nothing prescribes it; in our run it moves no more than it must, here it is held"
            )
    return found.free


def singular(model: ExportModel) -> tuple[str, ...]:
    """A sentence where the start is a singular pose: what is redundant there is not so along our run."""
    run = model.simulation
    if model.refused:
        return (f"a motion to compare with: ours was refused, as {model.refused}",)
    if run is None or not len(run.rank) or run.rank.max() <= run.rank[0]:
        return ()
    return (
        f"the loops away from the start: {run.rank[0]} of their equations are independent there, {run.rank.max()} later "
        "in our run, and only the former are held; it starts in a singular pose",
    )


def _reached(tree: Tree, link: int) -> bool:
    while tree.links[link].parent >= 0:
        link = tree.links[link].parent
    return link == 0


def _axes(closing: Closing) -> Array:
    axis = closing.joint.geometry.axis
    if axis is None:
        return np.eye(3)
    u, v = perpendicular(np.asarray(axis))
    return np.column_stack([u, v, axis])


def _rows(model: ExportModel, closings: list[Closing], frames: list[Array], q: Array) -> Array:
    """(6C + G, n) turns about and displacements (over length) along the axes, at the points, by the rates."""
    mechanism = model.mechanism
    X = mechanism.poses(q)
    rows = mechanism.closure(mechanism.screws(X))
    out = rows.copy()
    for n, (closing, axes) in enumerate(zip(closings, frames, strict=True)):
        end = X[mechanism.closures[n, 0]]
        point = closing.joint.geometry.point
        arm = end[:3, :3] @ (np.zeros(3) if point is None else point - mechanism.centre) + end[:3, 3]
        E = (end[:3, :3] @ axes).T
        turning, moving = rows[6 * n : 6 * n + 3], rows[6 * n + 3 : 6 * n + 6]
        out[6 * n : 6 * n + 3] = E @ turning
        out[6 * n + 3 : 6 * n + 6] = E @ (moving + np.cross(turning.T, arm / mechanism.length).T)
    return out


def _independent(rows: Array, rank: int) -> list[int]:
    """Indices of `rank` independent rows."""
    rest, chosen = rows.copy(), []
    for _ in range(rank):
        size = np.linalg.norm(rest, axis=1)
        k = int(np.flatnonzero(size >= CLOSE * size.max())[0])
        chosen.append(k)
        unit = rest[k] / size[k]
        rest = rest - np.outer(rest @ unit, unit)
        rest[chosen] = 0.0
    return chosen


def _free(
    model: ExportModel, closings: list[Closing], frames: list[Array], rest: NDArray[np.int64], held: list[int]
) -> list[int]:
    """Indices into `rest` of coordinates that determine the others all along our run."""
    mechanism = model.mechanism
    scale = mechanism.scale[rest]
    spaces = []
    for q in _poses(model) if held else [model.q]:
        rows = _rows(model, closings, frames, q)[held][:, rest] * scale
        spaces.append(np.linalg.svd(rows, full_matrices=True)[2][len(held) :].T if len(rows) else np.eye(len(rest)))
    chosen: list[int] = []
    while spaces[0].shape[1]:
        score = np.min([np.linalg.norm(space, axis=1) for space in spaces], axis=0)
        k = int(np.flatnonzero(score >= CLOSE * score.max())[0])
        chosen.append(k)
        spaces = [_without(space, k) for space in spaces]
    return sorted(chosen)


def _without(space: Array, k: int) -> Array:
    """An orthonormal basis of the vectors of `space` whose component k is zero."""
    right = np.linalg.svd(space[k : k + 1], full_matrices=True)[2]
    return np.asarray(space @ right[1:].T)


def _poses(model: ExportModel) -> list[Array]:
    """Coordinates along our run, the start first."""
    run, mechanism = model.simulation, model.mechanism
    if run is None or run.joint_names != tuple(slot.name for slot in mechanism.slots):
        return [model.q]
    picked = np.unique(np.linspace(0, len(run.time) - 1, SAMPLES).round().astype(np.int64))
    return [model.q, *run.joint_position[picked]]
