"""Redundant constraints: which joints, or contacts of one joint, hold something that is held already, and why.

A constraint is redundant where the joints can be under load without any load from outside (a self-stress: the left
null space of the closure equations). A loop on its own has the wrenches that none of its joints gives way to; what
several loops have only together is told apart by minimal sets of joints that bear it (Calladine 1978 for self-stress;
the sets are circuits of the matroid of constraints).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.screws import Frame, scaled, span
from kinform.foundation.algebra.vectors import cross, cross_matrix
from kinform.foundation.graphs.cycles import Cycle
from kinform.foundation.rounding import TINY
from kinform.kinematics.mobility.joint_redundancy import redundancy
from kinform.kinematics.screws.wording import (
    EXACT_WRENCH,
    Locked,
    axis_word,
    locked_text,
    locked_wrenches,
    rows_too_many,
)
from kinform.mechanism.block_rates import FEW_RATES, Block, loop_matrix
from kinform.mechanism.constants import FREE
from kinform.mechanism.first_order import Closure
from kinform.mechanism.frame import axes_frame
from kinform.model.arrays import Array
from kinform.model.kinematics import Joint, Redundancy

MOST_SORTED_LOOPS = 60
"""Up to so many loops in a block, what they hold together is told apart. Chosen, not measured."""
MOST_NAMED = 12
"""So many bodies or joints are named in a text. Chosen, not measured."""


def redundancies_of_loops(joints: Sequence[Joint], closure: Closure, size: float) -> tuple[Redundancy, ...]:
    """What is held more than once in the loops of the joints, block by block of their `closure`; `size` of the assembly
    (m). Loops that hold too much alone are told first; what is left is looked for in sets of joints."""
    free = np.bincount([b for b in closure.block_of if b >= 0], minlength=len(closure.blocks))
    out: list[Redundancy] = []
    for block, mobility in zip(closure.blocks, free, strict=True):
        members = [joints[k] for k in block.edges]
        rates = sum(joint.freedoms for joint in members)
        count = 6 * len(block.cycles) - rates + int(mobility)
        if count <= 0:
            continue
        alone = [item for item in (_of_loop(members, cycle, block, size) for cycle in block.cycles) if item is not None]
        rest = count - sum(item.rows for item in alone)
        if rest < 0:
            out.append(_of_block(members, count))
            continue
        out += alone
        if rest and len(block.cycles) <= MOST_SORTED_LOOPS and rates <= FEW_RATES:
            out += _together(members, block, count, rest)
        elif rest:
            out.append(_of_block(members, rest))
    return tuple(out)


def _of_loop(joints: Sequence[Joint], cycle: Cycle, block: Block, size: float) -> Redundancy | None:
    """What the joints of one loop of a block do not give way to."""
    members = [joints[k] for k, _ in cycle]
    spaces = [joint.twists for joint in members]
    frame = axes_frame(spaces, size) if len(block.cycles) > 1 else block.frame
    columns = np.hstack([scaled(s.T, frame) for s in spaces])
    columns = columns / np.maximum(np.linalg.norm(columns, axis=0), TINY)
    if columns.shape[1] > 6:
        columns = np.asarray(np.linalg.qr(columns.T, mode="r")).T
    left, values, _ = np.linalg.svd(columns, full_matrices=True)
    rank = int(np.count_nonzero(values > max(FREE, frame.rounding) * values[0])) if len(values) else 0
    if rank == 6:
        return None
    space = locked_wrenches(left[:, rank:].T)
    bodies = [joints[k].bodies[0 if sign > 0 else 1] for k, sign in cycle]
    names = "-".join(bodies)
    if len(bodies) > MOST_NAMED:
        names = "-".join(bodies[: MOST_NAMED - 1]) + f"-… ({len(bodies)} bodies)"
    why = _reason(space, frame)
    text = f"loop {names}{why}: {rows_too_many(6 - rank)}: {locked_text([word for word, _ in space])}"
    return redundancy("loop", text, 6 - rank, members, space, frame)


def _reason(space: Sequence[Locked], frame: Frame) -> str:
    """Why the loop holds too much, from the wrenches that it can lock in."""
    words = [word for word, _ in space]
    wrenches = np.array([wrench for _, wrench in space])
    forces = wrenches[[not w.startswith("moment") for w in words]]
    moments = wrenches[[w.startswith("moment") for w in words]][:, :3]
    if len(space) == 6:
        return " gives way to nothing"
    if len(moments) == 3:
        return " cannot turn" if not len(forces) else " only slides"
    if len(forces) == 1 and len(moments) == 2 and np.abs(moments @ forces[0, 3:]).max() < EXACT_WRENCH:
        return f" is planar, normal to {axis_word(forces[0, 3:])}"
    if len(forces) == 3 and not len(moments) and _concurrent(forces):
        return " is spherical: its axes meet in one point"
    if len(forces) == 3 and len(moments) == 2:
        return f" turns about one axis along {axis_word(cross(moments[0], moments[1]))}"
    if len(forces) == 2 and len(moments) == 2:
        return f" turns about and slides along {axis_word(cross(moments[0], moments[1]))}"
    return ""


def _concurrent(forces: Array) -> bool:
    """Do the three forces (3, 6) have one point in common?"""
    matrix = np.vstack([-cross_matrix(f) for f in forces[:, 3:]])
    right = forces[:, :3].ravel()
    point = np.linalg.lstsq(matrix, right, rcond=None)[0]
    return bool(np.abs(matrix @ point - right).max() < 10.0 * EXACT_WRENCH)


def _together(joints: Sequence[Joint], block: Block, count: int, rest: int) -> list[Redundancy]:
    """Self-stresses, `count` in all, that no loop of the basis has alone (`rest`), in minimal sets of joints.

    A combination z of the self-stresses gives each loop a wrench, and each joint the sum of those of its loops, which
    is what it bears. Those of single loops are taken first. Then, as long as some are left, joint after joint is asked
    to bear nothing, wherever a combination is left that is new: what still bears is a minimal set.
    """
    spaces = [joint.twists for joint in joints]
    norms = np.concatenate([np.linalg.norm(scaled(s.T, block.frame), axis=0) for s in spaces])
    matrix = loop_matrix(spaces, block.cycles, block.frame, norms)
    left = np.linalg.svd(matrix, full_matrices=True)[0]
    stress = left[:, len(left) - count :].T.reshape(count, len(block.cycles), 6)
    bears = [np.zeros((count, 6)) for _ in joints]
    for row, cycle in enumerate(block.cycles):
        for k, sign in cycle:
            bears[k] += sign * stress[:, row]
    taken = np.zeros((count, 0))
    for row in range(len(block.cycles)):
        others = np.delete(stress, row, axis=1).reshape(count, -1)
        taken = span(np.hstack([taken, _vanishing(np.eye(count), others)]), EXACT_WRENCH)
    if taken.shape[1] != count - rest:
        return [_of_block(joints, rest)]
    out = []
    while taken.shape[1] < count:
        chosen = np.eye(count)
        for k in reversed(range(len(joints))):
            fewer = _vanishing(chosen, bears[k])
            if fewer.shape[1] and np.abs(fewer - taken @ (taken.T @ fewer)).max() > EXACT_WRENCH:
                chosen = fewer
        members = [k for k in range(len(joints)) if np.abs(chosen.T @ bears[k]).max() > EXACT_WRENCH]
        new = _beyond(chosen, taken)
        taken = span(np.hstack([taken, chosen]), EXACT_WRENCH)
        out.append(_circuit([joints[k] for k in members], bears[members[0]].T @ new, new.shape[1], block.frame))
    return out


def _vanishing(space: Array, bears: Array) -> Array:
    """(r, k) what of the column space (r, n) bears nothing: columns z with zᵀ bears = 0."""
    if not space.shape[1]:
        return space
    left, values, _ = np.linalg.svd(space.T @ bears, full_matrices=True)
    rank = int(np.count_nonzero(values > EXACT_WRENCH))
    rest: Array = space @ left[:, rank:]
    return rest


def _beyond(space: Array, taken: Array) -> Array:
    """Orthonormal basis of what the columns span beyond those that are taken."""
    rest = space - taken @ (taken.T @ space)
    left, values, _ = np.linalg.svd(rest, full_matrices=False)
    basis: Array = left[:, values > EXACT_WRENCH]
    return basis


def _circuit(joints: Sequence[Joint], first: Array, rows: int, frame: Frame) -> Redundancy:
    """`first` (6, rows): what the first of the joints bears."""
    values = np.linalg.svd(first, compute_uv=False)
    full = len(values) == rows and bool(values.min() > EXACT_WRENCH)
    space = locked_wrenches(first.T) if full else []
    which = f": {locked_text([word for word, _ in space])}, as {joints[0].name} bears it" if full else ""
    text = f"joints {_names(joints)} hold each other: {rows_too_many(rows)}{which}"
    return redundancy("loops", text, rows, joints, space, frame)


def _of_block(joints: Sequence[Joint], rows: int) -> Redundancy:
    text = f"joints {_names(joints)} hold each other in many loops: {rows_too_many(rows)}, not told apart"
    return redundancy("block", text, rows, joints, [], Frame(np.zeros(3), 1.0))


def _names(joints: Sequence[Joint]) -> str:
    names = [str(joint.name) for joint in joints]
    if len(names) <= MOST_NAMED:
        return ", ".join(names)
    return ", ".join(names[: MOST_NAMED - 1]) + f", … ({len(names)} joints)"
