"""Is one motion there, forward or backward: in a pair, and in the whole assembly with contacts that push only?

In the assembly the motion between two bodies is prescribed and everything else is free: the linear program
min 1ᵀs, JV + s ≥ 0, s ≥ 0 is at zero when it can be done. Where not, it could be done without the contacts
that have s > 0; those of them that can be put back are, one by one. The others block it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from kinform.foundation.algebra.screws import Frame, scaled
from kinform.foundation.algebra.vectors import norm
from kinform.foundation.graphs.graph import blocks
from kinform.foundation.rounding import TINY
from kinform.frozen import dataclass
from kinform.kinematics.separation.contact_rows import ContactRows, is_stated
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.arrays import Array, Ints
from kinform.model.contacts import Patch
from kinform.model.kinematics import Joint, Kinematics

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

MOTION_THERE = 1e-3
"""A unit twist is there when less than this of it lies outside the freedoms (scaled by the size). Chosen, not
measured."""
MOST_PROGRAM_ROWS = 20_000
"""Rows of contact beyond which the linear program would take minutes. Chosen, not measured."""
MOST_CONTACTS_TRIED = 40
"""Violated contacts up to which each is tried again, so that none is named without need. Chosen, not measured."""
MOST_ROWS_TRIED = 2_000
"""Rows of contact up to which that is done. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Attempt:
    """One sense of a motion in the whole assembly: `possible` is None where it was too large to decide."""

    possible: bool | None
    patches: tuple[int, ...] = ()
    """Indices into Contacts.patches: without these it could be done."""
    joints: tuple[str, ...] = ()
    """Joints that somebody stated, and that would have to give."""


def pair_ways(kinematics: Kinematics, patches: Sequence[Patch], joint: Joint, twist: Array) -> tuple[bool, bool] | None:
    """Whether contact lets the second body of the joint move by the twist (ω; v at the origin), and by its reverse.

    None where contact does not decide the joint.
    """
    if is_stated(joint):
        return None
    rows = ContactRows(kinematics.matrix, kinematics.bodies, patches)
    cone = rows.cone(rows.members(joint))
    if cone is None:
        return None
    unit = scaled(twist[:, None], cone.frame)[:, 0]
    unit = unit / norm(unit)
    if len(cone.fixed) and norm(cone.fixed @ unit) > MOTION_THERE:
        return False, False
    speed = cone.rows @ unit
    return bool((speed >= -MOTION_THERE).all()), bool((speed <= MOTION_THERE).all())


def attempt(
    kinematics: Kinematics, patches: Sequence[Patch], first: str, second: str, twist: Array, frame: Frame
) -> Attempt:
    """Can the second body move relative to the first by the twist (ω; v at the origin), the assembly taking part?

    `frame`: of the motion, in which the twist has about unit size; slower violations than `MOTION_THERE` are none.
    Unknown are the twists of the other bodies on paths between the two; each contact of these gives rows that must not
    be negative.
    """
    graph = JointGraph(kinematics.bodies, kinematics.joints)
    a, b = graph.node[first], graph.node[second]
    between = _between(graph, a, b)
    others = sorted({n for k in between for n in graph.edges[k]} - {a, b})
    goal = scaled(twist[:, None], frame)[:, 0]
    source = ContactRows(kinematics.matrix, kinematics.bodies, patches)
    program = _Program(others, {a: np.zeros(6), b: goal / norm(goal)})
    for k in between:
        for rows, label in _rows(source, graph.joints[k], frame):
            program.add(rows, label, graph.edges[k])
    if not program.count:
        return Attempt(True)
    slack = program.violations() if program.count <= MOST_PROGRAM_ROWS else None
    if slack is None:
        return Attempt(None)
    worst: dict[int | str, float] = {}
    for row in np.flatnonzero(slack > MOTION_THERE):
        label = program.labels[row]
        worst[label] = max(worst.get(label, 0.0), float(slack[row]))
    broken = sorted(worst, key=lambda label: (worst[label], str(label)))
    blocking = _fewest(broken, program)
    return Attempt(
        not blocking,
        tuple(sorted(label for label in blocking if isinstance(label, int))),
        tuple(sorted(label for label in blocking if isinstance(label, str))),
    )


class _Program:
    """min 1ᵀs with AV + s ≥ −b and s ≥ 0, rows added contact by contact."""

    def __init__(self, nodes: Sequence[int], prescribed: Mapping[int, Array]):
        """V: the twists of the bodies `nodes`; b: what the `prescribed` twists of others add."""
        self.count = 0
        """Rows so far."""
        self.labels: list[int | str] = []
        """Of each row: the patch, or the name of the stated joint, that it belongs to."""
        self._width, self._column, self._prescribed = (
            6 * len(nodes),
            {n: 6 * k for k, n in enumerate(nodes)},
            prescribed,
        )
        self._right: list[Array] = []
        self._entries: list[tuple[Array, Ints, Ints]] = []

    def add(self, rows: Array, label: int | str, ends: Sequence[int]) -> None:
        """Rows (n, 6) of the twist of the second of two bodies less that of the first."""
        numbers = np.arange(self.count, self.count + len(rows))
        bound = np.zeros(len(rows))
        for sign, node in zip((-1.0, 1.0), ends, strict=True):
            if node in self._prescribed:
                bound += sign * rows @ self._prescribed[node]
            else:
                columns = np.tile(self._column[node] + np.arange(6), len(rows))
                self._entries.append(((sign * rows).ravel(), np.repeat(numbers, 6), columns))
        self._right.append(bound)
        self.labels += [label] * len(rows)
        self.count += len(rows)

    @cached_property
    def _matrix(self) -> csr_matrix:
        """A, once all rows are there."""
        from scipy.sparse import coo_matrix

        none = (np.zeros(0), np.zeros(0, np.int64), np.zeros(0, np.int64))
        data, rows, columns = (np.concatenate(parts) for parts in zip(none, *self._entries, strict=True))
        return coo_matrix((data, (rows, columns)), (self.count, self._width)).tocsr()

    def violations(self, without: Collection[int | str] = ()) -> Array | None:
        """(rows,) s at the optimum without the rows of these labels, which have 0; None where HiGHS gives up."""
        from scipy.optimize import linprog
        from scipy.sparse import hstack, identity

        chosen = np.array([label not in without for label in self.labels])
        count = int(chosen.sum())
        solved = linprog(
            np.concatenate([np.zeros(self._width), np.ones(count)]),
            A_ub=hstack([-self._matrix[chosen], -identity(count)]).tocsr(),
            b_ub=np.concatenate(self._right)[chosen],
            bounds=[(None, None)] * self._width + [(0.0, None)] * count,
            method="highs",
        )
        if solved.status != 0:
            return None
        out = np.zeros(self.count)
        out[chosen] = solved.x[self._width :]
        return out


def _fewest(broken: Sequence[int | str], program: _Program) -> set[int | str]:
    """Of the contacts without which the motion is there, a set none of which can be put back."""
    out = set(broken)
    if len(broken) > MOST_CONTACTS_TRIED or program.count > MOST_ROWS_TRIED:
        return out
    for label in broken:
        if len(out) == 1:
            break
        slack = program.violations(out - {label})
        if slack is not None and slack.max(initial=0.0) <= MOTION_THERE:
            out.discard(label)
    return out


def _between(graph: JointGraph, first: int, second: int) -> list[int]:
    """The joints on paths between two bodies: those in one block with an edge that would join them."""
    count = len(graph.edges)
    block = next(b for b in blocks(len(graph.bodies), [*graph.edges, (first, second)]) if count in b)
    return [k for k in block if k < count]


def _rows(source: ContactRows, joint: Joint, frame: Frame) -> list[tuple[Array, int | str]]:
    """Rows (n, 6) ≥ 0 of the motion of the second body relative to the first, patch by patch; of a stated joint
    those that hold both ways."""
    if is_stated(joint):
        free = scaled(joint.twists.T, frame)
        basis = np.linalg.qr(free, mode="complete")[0][:, free.shape[1] :].T if free.shape[1] else np.eye(6)
        return [(np.vstack([basis, -basis]), str(joint.name))]
    out: list[tuple[Array, int | str]] = []
    for k, turned in source.members(joint):
        rows = source.rows(k, frame, turned=turned)
        out.append((rows / np.maximum(np.linalg.norm(rows, axis=1), TINY)[:, None], k))
    return out
