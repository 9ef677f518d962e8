"""Couplings that the function states, where no geometry shows them: constraints between joint rates.

Known here: what is left of the freedoms when values keep their ratios. Ratios are linear in joint values, so outside of
loops what holds at first order holds over a distance; inside loops that is not known.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.vectors import norm
from kinform.foundation.rounding import SOLVED
from kinform.mechanism.block_rates import Solution
from kinform.mechanism.first_order import Closure
from kinform.model.arrays import Array
from kinform.model.function import Function, IntendedJoint
from kinform.model.kinematics import Joint, Mobility
from kinform.model.names import BodyName


def coupling_rows(
    function: Function, joints: Sequence[Joint], body_of: Mapping[str, BodyName], offset: Sequence[int]
) -> Array:
    """(c, rates) rows that are zero where the stated ratios hold.

    `body_of`: the body that contains a part or group that a joint is between; `offset`: first rate of each joint, and
    their number. Couplings of joints that have not one freedom say nothing here.
    """
    intended = {joint.name: joint for joint in function.joints}
    number = {frozenset(joint.bodies): k for k, joint in enumerate(joints)}
    rows = []
    for coupling in function.couplings:
        row = np.zeros(offset[-1])
        ends = {}
        for name, factor in coupling.terms.items():
            wanted = intended.get(name)
            if wanted is None:
                continue
            first, second = (body_of[side] for side in wanted.between)
            k = number.get(frozenset((first, second)))
            sense = None if k is None else _sense(joints[k], wanted, first)
            if k is not None and sense is not None:
                ends[k] = sense * factor
        if len(ends) < len(coupling.terms):
            continue
        for k, factor in ends.items():
            row[offset[k]] = factor
        rows.append(row / np.abs(row).max())
    return np.array(rows).reshape(-1, offset[-1])


def _sense(joint: Joint, intended: IntendedJoint, first: BodyName) -> float | None:
    """The sign of the joint's rate in the designer's sense, with the designer's `first` body; None where it has not one
    freedom, or no direction is stated."""
    if joint.freedoms != 1 or intended.axis is None:
        return None
    twist = joint.twists[0]
    turns = norm(twist[:3]) > SOLVED * norm(twist[3:])
    along = float((twist[:3] if turns else twist[3:]) @ intended.axis)
    return (1.0 if along > 0.0 else -1.0) * (1.0 if first == joint.bodies[0] else -1.0)


def restrict_closure(closure: Closure, rows: Array) -> Closure:
    """The closure with the freedoms that the rows leave: each still driven by one rate of 1, the others follow.

    The rows, written in the freedoms, are brought to echelon form: each independent one makes the last freedom that it
    has follow those before it.
    """
    every = closure.rates
    reduced = rows @ every[:, : rows.shape[1]].T
    pivots: list[int] = []
    for row in reduced:
        for pivot, before in zip(pivots, reduced, strict=False):
            row -= before * row[pivot]
        size = np.abs(row).max(initial=0.0)
        if size <= SOLVED:
            row[:] = 0.0
            pivots.append(-1)
            continue
        last = int(np.flatnonzero(np.abs(row) > SOLVED * size)[-1])
        row /= row[last]
        for before in reduced[: len(pivots)]:
            before -= row * before[last]
        pivots.append(last)
    follow = {pivot: row for pivot, row in zip(pivots, reduced, strict=True) if pivot >= 0}
    solutions, block_of = [], []
    for k, solution in enumerate(closure.solutions):
        if k in follow:
            continue
        rates = every[k] - sum((row[k] * every[pivot] for pivot, row in follow.items()), np.zeros(every.shape[1]))
        columns = np.flatnonzero(np.abs(rates) > SOLVED * np.abs(rates).max())
        solutions.append(Solution(solution.driver, columns, rates[columns]))
        block_of.append(closure.block_of[k])
    return replace(closure, solutions=tuple(solutions), block_of=tuple(block_of))


def coupled_mobility(mobility: Mobility, closure: Closure, coupled: Closure, rows: Array) -> Mobility:
    """The counts of `mobility` (of `closure`) with the stated couplings, of which `coupled` is what they leave."""
    lost = closure.mobility - coupled.mobility
    in_loops = {int(c) for block in closure.blocks if block.cycles for c in _columns(closure, block.edges)}
    touched = {int(c) for c in np.flatnonzero(np.abs(rows).max(axis=0, initial=0.0) > 0.0)}
    finite = None if mobility.finite is None or touched & in_loops else mobility.finite - lost
    reason = mobility.finite_reason
    if mobility.finite is not None and finite is None:
        reason = "; ".join(filter(None, [reason, "stated couplings act on joints in loops: not tried over a distance"]))
    return replace(
        mobility,
        instantaneous=coupled.mobility,
        finite=finite,
        effective=(coupled.mobility if finite is None else finite) - mobility.idle,
        redundant=mobility.redundant - lost + len(rows),
        blocked=mobility.blocked - lost,
        finite_reason=reason,
    )


def _columns(closure: Closure, edges: Sequence[int]) -> list[int]:
    return [c for k in edges for c in range(closure.offset[k], closure.offset[k + 1])]
