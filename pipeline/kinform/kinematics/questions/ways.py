"""Is one motion there, forward or backward: in a pair, and in the whole assembly with contacts that push only?

In the assembly the motion between two bodies is prescribed and everything else is free: the linear program
min 1ᵀs, JV + s ≥ 0, s ≥ 0 is at zero when it can be done. Where not, it could be done without the contacts
that have s > 0; those of them that can be put back are, one by one. The others block it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.algebra.screws import Frame, scaled
from kinform.foundation.graphs.graph import blocks
from kinform.kinematics.separation.contact_rows import ContactRows, stated
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.model.kinematics import Joint, Kinematics

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

__all__ = ["Attempt", "attempt", "pair_ways"]


MOST_ROWS = 20_000
"""Rows of contact beyond which the program would take minutes."""


MOST_TRIED = 40
"""Violated contacts up to which each is tried again, so that none is named without need."""


@dataclass(frozen=True, eq=False)
class Attempt:
    """One sense of a motion in the whole assembly: `possible` is None where it was too large to decide."""

    possible: bool | None
    patches: tuple[int, ...] = ()
    """Indices into Contacts.patches: without these it could be done."""
    joints: tuple[str, ...] = ()
    """Joints that somebody stated, and that would have to give."""


def pair_ways(
    kinematics: Kinematics, patches: Sequence[Patch], joint: Joint, twist: Array, tolerance: float
) -> tuple[bool, bool] | None:
    """Whether contact lets the second body of the joint move by the twist (ω; v at the origin), and by its reverse.

    None where contact does not decide the joint.
    """
    if stated(joint):
        return None
    rows = ContactRows(kinematics.matrix, kinematics.bodies, patches)
    first = rows.parts_of(joint.bodies[0])
    own = sorted({*joint.patches, *(blocker.patch for blocker in joint.blockers)})
    cone = rows.cone([(k, patches[k].parts[0] not in first) for k in own])
    if cone is None:
        return None
    unit = scaled(twist[:, None], cone.frame)[:, 0]
    unit = unit / np.linalg.norm(unit)
    if len(cone.fixed) and float(np.linalg.norm(cone.fixed @ unit)) > tolerance:
        return False, False
    speed = cone.rows @ unit
    return bool((speed >= -tolerance).all()), bool((speed <= tolerance).all())


def attempt(
    kinematics: Kinematics,
    patches: Sequence[Patch],
    first: str,
    second: str,
    twist: Array,
    frame: Frame,
    tolerance: float,
) -> Attempt:
    """Can the second body move relative to the first by the twist (ω; v at the origin), the assembly taking part?

    `frame`: of the motion, in which the twist has about unit size; slower violations than `tolerance` are none.
    """
    from scipy.sparse import coo_matrix

    index = {str(body.name): k for k, body in enumerate(kinematics.bodies)}
    joints = _between(kinematics, index[first], index[second], index)
    nodes = sorted({index[name] for joint in joints for name in joint.bodies} - {index[first], index[second]})
    column = {n: 6 * k for k, n in enumerate(nodes)}
    goal = scaled(twist[:, None], frame)[:, 0]
    goal = goal / np.linalg.norm(goal)
    known = {index[first]: np.zeros(6), index[second]: goal}
    source = ContactRows(kinematics.matrix, kinematics.bodies, patches)
    data, rows, columns, right, owner = [], [], [], [], []
    count = 0
    for joint in joints:
        ends = [index[name] for name in joint.bodies]
        for own, label in _rows(source, joint, patches, frame):
            at = np.arange(count, count + len(own))
            bound = np.zeros(len(own))
            for sign, node in zip((-1.0, 1.0), ends, strict=True):
                if node in known:
                    bound += sign * own @ known[node]
                else:
                    data.append((sign * own).ravel())
                    rows.append(np.repeat(at, 6))
                    columns.append(np.tile(column[node] + np.arange(6), len(own)))
            right.append(bound)
            owner += [label] * len(own)
            count += len(own)
    if count == 0:
        return Attempt(True)
    if count > MOST_ROWS:
        return Attempt(None)
    shape = (count, 6 * len(nodes))
    empty = np.zeros(0)
    matrix = coo_matrix(
        (np.concatenate([empty, *data]), (np.concatenate([empty, *rows]).astype(int), np.concatenate([empty, *columns]).astype(int))),
        shape,
    )  # fmt: skip
    program = _Program(matrix.tocsr(), np.concatenate(right))
    everything = np.ones(count, dtype=bool)
    slack = program.violations(everything)
    if slack is None:
        return Attempt(None)
    labels = np.array([str(label) for label in owner], dtype=object)
    broken = sorted(
        {labels[k]: owner[k] for k in np.flatnonzero(slack > tolerance)}.items(),
        key=lambda item: (float(slack[labels == item[0]].max()), item[0]),
    )
    needed = _fewest([key for key, _ in broken], labels, program, tolerance)
    found = [label for key, label in broken if key in needed]
    return Attempt(
        not found,
        tuple(sorted(label for label in found if isinstance(label, int))),
        tuple(sorted(label for label in found if isinstance(label, str))),
    )


class _Program:
    """min 1ᵀs with AV + s ≥ −b and s ≥ 0."""

    def __init__(self, matrix: csr_matrix, right: Array):
        self._matrix, self._right = matrix, right

    def violations(self, chosen: NDArray[np.bool_]) -> Array | None:
        """(rows,) s at the optimum with the chosen rows only, 0 for the others; None where HiGHS gives up."""
        from scipy.optimize import linprog
        from scipy.sparse import hstack, identity

        count, width = int(chosen.sum()), self._matrix.shape[1]
        found = linprog(
            np.concatenate([np.zeros(width), np.ones(count)]),
            A_ub=hstack([-self._matrix[chosen], -identity(count)]).tocsr(),
            b_ub=self._right[chosen],
            bounds=[(None, None)] * width + [(0.0, None)] * count,
            method="highs",
        )
        if found.status != 0:
            return None
        out = np.zeros(len(chosen))
        out[chosen] = found.x[width:]
        return out


def _fewest(broken: Sequence[str], labels: NDArray[np.object_], program: _Program, tolerance: float) -> set[str]:
    """Of the contacts without which the motion is there, a set none of which can be put back."""
    out = set(broken)
    if len(broken) > MOST_TRIED or len(labels) > MOST_ROWS // 10:
        return out
    for label in broken:
        if len(out) == 1:
            break
        slack = program.violations(~np.isin(labels, sorted(out - {label})))
        if slack is not None and slack.max(initial=0.0) <= tolerance:
            out.discard(label)
    return out


def _between(kinematics: Kinematics, first: int, second: int, index: dict[str, int]) -> list[Joint]:
    """The joints on paths between two bodies: those in one block with an edge that would join them."""
    edges = [(index[j.bodies[0]], index[j.bodies[1]]) for j in kinematics.joints]
    block = next(b for b in blocks(len(kinematics.bodies), [*edges, (first, second)]) if len(edges) in b)
    return [kinematics.joints[k] for k in block if k < len(edges)]


def _rows(source: ContactRows, joint: Joint, patches: Sequence[Patch], frame: Frame) -> list[tuple[Array, int | str]]:
    """Rows (n, 6) ≥ 0 of the motion of the second body relative to the first, patch by patch; of a stated joint
    those that hold both ways."""
    if stated(joint):
        free = scaled(joint.twists.T, frame)
        basis = np.linalg.qr(free, mode="complete")[0][:, free.shape[1] :].T if free.shape[1] else np.eye(6)
        return [(np.vstack([basis, -basis]), str(joint.name))]
    first = source.parts_of(joint.bodies[0])
    out: list[tuple[Array, int | str]] = []
    for k in sorted({*joint.patches, *(blocker.patch for blocker in joint.blockers)}):
        rows = source.rows(k, frame, turned=patches[k].parts[0] not in first)
        out.append((rows / np.maximum(np.linalg.norm(rows, axis=1), 1e-300)[:, None], k))
    return out
