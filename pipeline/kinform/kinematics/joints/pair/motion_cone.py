"""The cone of motions of a pair: what contact allows that pushes and does not pull.

The second body may move by every scaled twist V with R V ≥ 0: no sample goes into the other body. Motions of the cone
that keep all contact are the freedoms *at rest*, its lineality. What the cone spans is *closed*: contact that opposes
holds the rest in both senses. The true motion of a mechanism lies between the two.

Rows are known no better than the directions and places of their surfaces. So a row may be missed by its slack: by as
much as the tolerances of its patch give at the speed that the motion asked about has there. Of what is held by opposing
rows the slack leaves a little, its clearance; of what is free a unit twist leaves about all. Between the two lies
`REACH`.

The point of the cone nearest to a twist d tells whether d reaches into it: the cone is convex, so that it is one point,
moves with the data and does not jump (Moreau 1962). It is the solution of a least distance problem, which is one of
least squares without negative numbers (Lawson and Hanson 1974, chapter 23).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from kinform.foundation.algebra.vectors import cross, norm
from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.frozen import dataclass
from kinform.kinematics.joints.pair.evidence import COAXIAL, GAP_BANDS, LOOSE_ANGLE, Evidence
from kinform.model.arrays import Array, Flags, Ints

REACH = 0.25
"""Length of the point of the cone that is nearest to a unit twist, from which on the twist is free. In 1,100 pairs of
fixtures and robots what opposing contact holds came to 0.24 at most, all but 30 of them below 0.1, and what is free to
0.26 at least, all but 40 above 0.5."""
OPENS = 0.02
"""Mean speed of a patch along its normals, of a unit twist, from which on the twist opens it: it is 0.05 or more, or
rounding, in the same pairs."""
LEAST_SLACK = 0.1
"""Share of the slack of a unit twist that each row has for every motion. Chosen, not measured."""
LINEAR_RANGE = 0.2
"""Displacement, over the length, up to which the directions of motions are good enough: of a turn that is 11°."""
APART = GAP_BANDS[1][0]
"""Share of the contact tolerance from which on faces stand off each other and do not touch."""
TRIES = 4
"""Scales of the rows with which a least distance is asked for. Rows that tie may end the method early; one in 10,000
did, and none of those whose rows have unit length. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class MotionCone:
    """What the contact of a pair allows, in the frame of its evidence."""

    rest: Array
    """(6, r) orthonormal: the motions that keep all contact."""
    closed: Array
    """(6, c) orthonormal, of which the first r are `rest`: what opposing contact does not hold."""
    inside: Array
    """(6,) unit: a motion of the cone that opens all contact that any of its motions opens; zero where none does."""
    opened: Flags
    """(items,) which patches that motion opens."""
    holding: Flags
    """(items,) which patches hold anything."""

    @cached_property
    def extra(self) -> int:
        """How many motions are free in one sense only."""
        return int(self.closed.shape[1] - self.rest.shape[1])

    @property
    def beyond(self) -> Array:
        """(6, extra) orthonormal: what is closed beside what is at rest."""
        return self.closed[:, self.rest.shape[1] :]

    def exactly(self, freed: Array) -> MotionCone:
        """The cone with its span within what its closed contact alone leaves beside what is at rest, (6, n)
        orthonormal: it is known to slack only, and surfaces know their own motions. As it is where that is less."""
        if not self.extra or freed.shape[1] < self.extra:
            return self
        vectors, values, _ = np.linalg.svd(freed.T @ self.beyond, full_matrices=False)
        if values.min() < WITHIN:
            return self
        return replace(self, closed=np.hstack([self.rest, freed @ vectors]))

    @property
    def plainly_open(self) -> bool:
        """Whether one motion opens all contact that holds, as of a block that is lifted off its table."""
        return bool(self.extra) and bool(self.opened[self.holding].all())

    @property
    def withdraws(self) -> bool:
        """Whether bodies without freedoms come apart along one line, and in no other way."""
        slides = self.extra == 1 and norm(self.beyond[:3, 0]) < SLIDES
        return not self.rest.shape[1] and slides


WITHIN = 0.9
"""Cosine between a motion of the cone and what surfaces leave, from which on it is one of these: 26°, as little slack
turns a motion that few rows see. Chosen, not measured."""
SLIDES = 0.05
"""Turn of a unit twist up to which it is a slide: of what is known to slack only. Chosen, not measured."""


def motion_cone(evidence: Evidence, rest: Array, bounds: Sequence[Ints]) -> MotionCone:
    """The cone of a pair whose freedoms at rest are known.

    `rest` (6, r) orthonormal, scaled in the evidence's frame; `bounds`: of each item the samples that bound its patch.
    """
    counts = [len(samples) for samples in bounds]
    owner = np.repeat(np.arange(len(bounds)), counts)
    chosen = evidence.start[owner] + np.concatenate(bounds)
    across = np.linalg.svd(rest, full_matrices=True)[0][:, rest.shape[1] :] if rest.shape[1] else np.eye(6)
    seen = _rows(evidence, chosen, owner)
    beside = across
    across = across @ _firm(seen, across)
    found, space = _reached(seen, across)
    closed = np.hstack([rest, across @ space])
    if all(item.patch.unknown for item in evidence.items):  # what it holds is not known
        closed = np.hstack([rest, beside])
    inside = across @ found.sum(axis=0) if len(found) else np.zeros(6)
    size = norm(inside)
    inside = inside / size if size > SOLVED else np.zeros(6)
    holding = np.zeros(len(bounds), dtype=bool)
    holding[owner[np.linalg.norm(seen.rows @ across, axis=1) > seen.least]] = True
    return MotionCone(rest, closed, inside, _mean_speeds(evidence, inside) > OPENS, holding)


@dataclass(frozen=True, eq=False)
class _Rows:
    """Rows of samples that bound their patches, and how well they are known."""

    rows: Array
    """(n, 6)."""
    arms: Array
    """(n, 3) of the samples, over the length."""
    angle: Array
    """(n,) rad."""
    position: Array
    """(n,) over the length."""
    apart: Array
    """(n,) slack by gaps, of a unit twist."""

    @cached_property
    def least(self) -> Array:
        """(n,) slack that there is for every motion: a share of that of a unit twist, whatever it does at the sample,
        as the motion of the cone nearest to one asked about is another one."""
        return np.asarray(LEAST_SLACK * (self.angle * (1.0 + np.linalg.norm(self.arms, axis=1)) + self.position))

    def slack(self, motions: Array) -> Array:
        """(m, n) by how much rows may be missed by about these motions (m, 6)."""
        return np.asarray(self.noise(motions) + self.apart)

    def noise(self, motions: Array) -> Array:
        """(m, n) the part of it that surfaces give, not gaps: a wider gap holds no more."""
        turns, slides = motions[:, None, :3], motions[:, None, 3:]
        x, y, z = np.moveaxis(slides + cross(turns, self.arms), -1, 0)
        turning = np.sqrt(np.einsum("mi,mi->m", motions[:, :3], motions[:, :3]))
        speed = np.sqrt(x * x + y * y + z * z)
        return np.asarray(self.angle * speed + self.position * turning[:, None] + self.least)


def _rows(evidence: Evidence, chosen: Ints, owner: Ints) -> _Rows:
    """The chosen rows of the evidence, of items `owner` (n,). Faces that stand off each other let go as much of a
    motion over `LINEAR_RANGE` as their gap; the clearance of rounds is part of their `position`."""
    gaps = np.array(
        [
            0.0
            if item.patch.kind in (*COAXIAL, "sphere") or item.patch.gap < APART * evidence.contact
            else item.patch.gap
            for item in evidence.items
        ]
    )
    return _Rows(
        evidence.rows[chosen],
        evidence.arms[chosen],
        np.minimum(evidence.angle, LOOSE_ANGLE)[owner],
        evidence.position[owner] / evidence.frame.length,
        gaps[owner] / (LINEAR_RANGE * evidence.frame.length),
    )


def _firm(seen: _Rows, across: Array) -> Array:
    """(k, m) orthonormal: motions across (6, k) that some row sees well enough for its sense to count. Of others what
    is at rest stands."""
    if not across.shape[1]:
        return np.zeros((0, 0))
    rows = seen.rows @ across
    _, vectors = np.linalg.eigh(rows.T @ rows)
    firm = (np.abs(rows @ vectors).T * REACH > 2.0 * seen.noise((across @ vectors).T)).any(axis=1)
    return np.asarray(vectors[:, firm])


def _reached(seen: _Rows, across: Array) -> tuple[Array, Array]:
    """Unit motions (m, size) of the cone, in the motions across (6, size), and the space (size, k) that they span,
    orthonormal: all that is in it."""
    rows, size = seen.rows @ across, across.shape[1]
    found: list[Array] = []
    space, left = np.zeros((size, 0)), np.linalg.eigh(rows.T @ rows)[1] if size else np.zeros((0, 0))
    while left.shape[1]:
        new = []
        for way, slack in zip(left.T, seen.slack((across @ left).T), strict=True):
            for point in (nearest_within(rows, slack, sense * way) for sense in (1.0, -1.0)):
                if norm(left.T @ point) > REACH:
                    new.append(point / norm(point))
        if not new:
            break
        found += new
        vectors, values, _ = np.linalg.svd(np.array(found).T)
        rank = int(np.count_nonzero(values > REACH))
        if rank == space.shape[1]:
            break
        space, left = vectors[:, :rank], vectors[:, rank:]
    return np.array(found).reshape(len(found), size), space


def nearest_within(rows: Array, slack: Array, point: Array) -> Array:
    """(k,) the point of {V : rows V ≥ −slack} that is nearest to `point` (k,); `rows` (n, k), slack (n,) positive."""
    from scipy.optimize import nnls

    missed = -slack - rows @ point
    if not (missed > 0.0).any():
        return point
    system = np.empty((len(point) + 1, len(rows)))
    system[:-1], system[-1] = rows.T, missed
    system /= np.sqrt(np.einsum("ij,ij->j", system, system))
    target = np.zeros(len(system))
    target[-1] = 1.0
    least, best = np.inf, np.zeros_like(point)
    for attempt in range(TRIES):
        scaled = system * (1.0 + np.modf((np.arange(len(rows)) + 1.0) * 0.618 * attempt)[0]) if attempt else system
        weights, _ = nnls(scaled, target)
        rest = scaled @ weights - target
        if abs(rest[-1]) < SOLVED:
            continue
        nearest = point - rest[:-1] / rest[-1]
        beyond = float((-slack - rows @ nearest).max())
        if beyond < least:
            least, best = beyond, nearest
        if beyond < SINGLE:
            break
    return best


def _mean_speeds(evidence: Evidence, motion: Array) -> Array:
    """(items,) mean speed of each patch along its normals."""
    speeds, first = evidence.share * (evidence.rows @ motion), evidence.start[:-1]
    return np.asarray(np.add.reduceat(speeds, first) / np.add.reduceat(evidence.share, first))
