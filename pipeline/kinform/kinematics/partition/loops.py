"""Whether joints that close loops could still move: names that joints hang together already are one body only then.

A function names its joints because they are meant to move. Round a loop of bodies the twists of the joints, each with
its rate, sum to zero (Davies 1981): a joint whose rate is zero in all solutions is locked, in the pose that is drawn.
At a dead centre others move to first order only, so that a loop also counts that has more rates than the algebra that
its twists generate has dimensions (Hervé 1978): a planar loop of four joints, as of a crank, has 4 for 3.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.screws import Frame, bracket, scaled, span
from kinform.foundation.algebra.subspaces import null_space
from kinform.foundation.graphs.cycles import Cycle, short_cycles
from kinform.foundation.graphs.graph import blocks
from kinform.frozen import dataclass
from kinform.mechanism.block_rates import loop_matrix
from kinform.mechanism.frame import axes_frame
from kinform.model.arrays import Array

CLOSED_SHARE = 1e-3
"""Share of the largest up to which singular values, and rates, of stated joints round a loop count as zero: axes are
written with three digits or more."""


@dataclass(frozen=True, eq=False)
class Loops:
    """Joints by their twists (rates, 6), or None where these are not known, and by the labels of their sides."""

    twists: Sequence[Array | None]
    sides: Sequence[tuple[int, int]]
    size: float
    """m, of the assembly."""
    connected: bool
    """Whether names alone connect all joints: who names bodies alike may mean others by other names."""

    def move(self, now: Sequence[int]) -> bool:
        """Whether every joint can move when label k is the body now[k]."""
        edges = [(now[first], now[second]) for first, second in self.sides]
        if any(first == second for first, second in edges):
            return False
        return all(self._moves(edges, block) for block in blocks(len(now), edges) if len(block) > 1)

    def _moves(self, edges: Sequence[tuple[int, int]], block: Sequence[int]) -> bool:
        spaces = [space for k in block if (space := self.twists[k]) is not None and len(space)]
        if len(spaces) < len(block):
            return False
        local = {node: k for k, node in enumerate(sorted({node for k in block for node in edges[k]}))}
        cycles = short_cycles(len(local), [(local[edges[k][0]], local[edges[k][1]]) for k in block])
        frame = axes_frame(spaces, self.size)
        norms = np.concatenate([np.linalg.norm(scaled(space.T, frame), axis=0) for space in spaces])
        rates = np.abs(null_space(loop_matrix(spaces, cycles, frame, norms), CLOSED_SHARE)).max(0, initial=0.0)
        start = np.cumsum([0, *map(len, spaces)])
        locked = [k for k in range(len(block)) if rates[start[k] : start[k + 1]].max() < CLOSED_SHARE]
        loose = {k for cycle in cycles if _more_rates(cycle, spaces, frame) for k, _ in cycle} if locked else set()
        return set(locked) <= loose


def _more_rates(cycle: Cycle, spaces: Sequence[Array], frame: Frame) -> bool:
    """Whether a loop has more rates than its twists and their brackets span."""
    twists = np.hstack([scaled(spaces[k].T, frame) for k, _ in cycle]) / frame.length
    basis = span(twists / np.linalg.norm(twists, axis=0), CLOSED_SHARE)
    while True:
        more = [bracket(one, other) for one in basis.T for other in basis.T]
        wider = span(np.column_stack([basis, *more]), CLOSED_SHARE)
        if wider.shape[1] == basis.shape[1]:
            return int(twists.shape[1]) > int(basis.shape[1])
        basis = wider
