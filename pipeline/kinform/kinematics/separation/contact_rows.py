"""Rows of contact between pairs of bodies, and the cone of motions that they leave.

Rows come from the assembly's J, which is consistent with the snapped freedoms; those of patches that block
count too. Joints that somebody stated, or that an axis suggested by rims made, are not decided by contact.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from kinform.foundation.algebra.screws import Frame
from kinform.foundation.algebra.vectors import cross
from kinform.frozen import dataclass
from kinform.kinematics.joints.pair.extremes import extreme_samples
from kinform.kinematics.separation.cone import grams, held_for_certain, split_directions, unit_rows_of
from kinform.kinematics.separation.constants import CONE_FREE
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch
from kinform.model.kinematics import Body, ConstraintMatrix, Joint
from kinform.model.names import BodyName, PartName

Members = Sequence[tuple[int, bool]]
"""Patches by index, each turned when its part a belongs to the second body."""


@dataclass(frozen=True, eq=False)
class Cone:
    """What contact allows the second body relative to the first, twists scaled in `frame`."""

    fixed: Array
    """(k, 6) orthonormal: directions that single patches hold both ways, as a shaft in its bore does."""
    rows: Array
    """(n, 6) unit: what the other patches allow one way; perpendicular to `fixed`."""
    frame: Frame

    @cached_property
    def opposed(self) -> Array:
        """(6, c) orthonormal: directions that the rows oppose."""
        return self.rows.T if len(self.rows) == 1 else split_directions(self.rows)[0]

    @property
    def preserved(self) -> Array:
        """(6, f) orthonormal: contact-preserving motion."""
        moved = np.hstack([self.opposed, self.fixed.T])
        return np.linalg.svd(moved, full_matrices=True)[0][:, moved.shape[1] :] if moved.shape[1] else np.eye(6)


class ContactRows:
    """Rows of patches: of the assembled J where they are in it, else of the patch itself."""

    def __init__(self, matrix: ConstraintMatrix, bodies: Sequence[Body], patches: Sequence[Patch]):
        self._matrix, self._patches = matrix, patches
        self._body = {part: k for k, body in enumerate(bodies) for part in body.parts}
        self._parts = {body.name: frozenset(body.parts) for body in bodies}
        self._cones: dict[tuple[tuple[int, bool], ...], Cone | None] = {}
        self._held: frozenset[int] | None = None
        order = np.argsort(matrix.patch, kind="stable")
        owner = matrix.patch[order]
        self._bounds = np.searchsorted(owner, np.arange(len(patches) + 1)).tolist()
        start = np.cumsum([0, *(len(patch.points) for patch in patches)])[:-1]
        every = np.concatenate([np.zeros((0, 3)), *(patch.points for patch in patches)])
        ahead = np.array([self._body[patch.parts[0]] < self._body[patch.parts[1]] for patch in patches], np.bool_)
        blocks = matrix.data.reshape(-1, 12)[order]
        rows = np.where(ahead[owner, None], blocks[:, 6:], blocks[:, :6])
        self._points = every[start[owner] + matrix.sample[order]] if len(owner) else every[:0]
        self._normals, self._moments = rows[:, 3:], rows[:, :3] * matrix.length

    @property
    def frame(self) -> Frame:
        """About everything that touches."""
        return Frame(self._matrix.centre, self._matrix.length)

    def parts_of(self, body: BodyName) -> frozenset[PartName]:
        """The parts of a body."""
        return self._parts[body]

    def members(self, joint: Joint) -> Members:
        """The patches that carry the joint or block it."""
        first = self.parts_of(joint.bodies[0])
        indices = joint.touching
        return [(k, self._patches[k].parts[0] not in first) for k in indices]

    def cone(self, members: Members) -> Cone | None:
        """The cone of patches given as (index, turned): turned when part a belongs to the second body."""
        return self.cones([members])[0]

    def cones(self, pairs: Sequence[Members]) -> list[Cone | None]:
        """The cones of several pairs, which take little longer than one."""
        keys = [tuple(members) for members in pairs]
        new = [key for key in dict.fromkeys(keys) if key not in self._cones]
        pieces = {key: [self.samples(k, turned=turned) for k, turned in key] for key in new}
        sampled = [key for key in new if any(len(points) for points, _, _ in pieces[key])]
        self._cones |= dict.fromkeys(new)
        if sampled:
            self._cones |= dict(zip(sampled, self._solve(sampled, [pieces[key] for key in sampled]), strict=True))
        return [self._cones[key] for key in keys]

    def _solve(self, keys: Sequence[Members], pieces: Sequence[Sequence[tuple[Array, Array, Array]]]) -> list[Cone]:
        """The cones of pairs with samples; `pieces`: of each pair, patch by patch, what `samples` gives.

        Rows of patches that hold both ways span what is fixed; those of the others count across that only.
        """
        patches = [samples for of_pair in pieces for samples in of_pair]
        points, normals, moments = (np.concatenate([samples[k] for samples in patches]) for k in range(3))
        counts = np.array([sum(len(samples[0]) for samples in of_pair) for of_pair in pieces])
        owner = np.repeat(np.arange(len(keys)), counts)
        frames = _frames(points, counts)
        rows = self._rows(normals, moments, frames, owner)
        alone = [self._two_way(k) for key in keys for k, _ in key]
        both_ways = np.repeat(np.array(alone, np.bool_), [len(samples[0]) for samples in patches])
        rows, group = unit_rows_of(rows, 2 * owner + ~both_ways)
        of_both, of_one = group % 2 == 0, group % 2 == 1
        fixed = _opposed_directions(rows[of_both], group[of_both] // 2, len(keys))
        across = np.array([np.eye(6) - basis.T @ basis for basis in fixed])
        rows, owner = rows[of_one], group[of_one] // 2
        rows, owner = unit_rows_of(np.einsum("ni,nij->nj", rows, across[owner]), owner)
        parts = np.split(rows, np.cumsum(np.bincount(owner, minlength=len(keys)))[:-1])
        return [Cone(*fields) for fields in zip(fixed, parts, frames, strict=True)]

    def _rows(self, normals: Array, moments: Array, frames: Sequence[Frame], owner: Ints) -> Array:
        """Rows (n, 6) of normals and moments (n, 3), each against twists scaled in the frame of its owner."""
        offset = np.array([self._matrix.centre - frame.centre for frame in frames])
        length = np.array([frame.length for frame in frames])
        moved = moments + cross(offset[owner], normals)
        return np.concatenate([moved / length[owner, None], normals], axis=1)

    def rows(self, k: int, frame: Frame, *, turned: bool) -> Array:
        """Rows (n, 6) of the extreme samples of one patch, against twists scaled in `frame`."""
        _, normals, moments = self.samples(k, turned=turned)
        return self._rows(normals, moments, [frame], np.zeros(len(normals), dtype=np.int64))

    def _two_way(self, k: int) -> bool:
        """Does this patch alone hold whatever it does not let slide?"""
        if self._held is None:
            # a plane has one normal, and holds nothing both ways
            curved = [k for k, p in enumerate(self._patches) if p.kind != "plane" and len(p.points) > 1]
            self._held = frozenset(np.array(curved, dtype=int)[self._hold(curved)].tolist()) if curved else frozenset()
        return k in self._held

    def _hold(self, curved: Sequence[int]) -> Flags:
        """Of each of these patches, whether it is proven to hold what it touches."""
        counts = np.array([len(self._patches[k].points) for k in curved])
        frames = _frames(np.concatenate([self._patches[k].points for k in curved]), counts)
        pieces = [self.samples(k, turned=False) for k in curved]
        owner = np.repeat(np.arange(len(curved)), [len(points) for points, _, _ in pieces])
        normals, moments = (np.concatenate([samples[k] for samples in pieces]) for k in (1, 2))
        rows, owner = unit_rows_of(self._rows(normals, moments, frames, owner), owner)
        return held_for_certain(np.split(rows, np.cumsum(np.bincount(owner, minlength=len(curved)))[:-1]))

    def samples(self, k: int, *, turned: bool) -> tuple[Array, Array, Array]:
        """Points, normals and moments (m) about the centre of J, of the extreme samples of one patch."""
        sign = -1.0 if turned else 1.0
        rows = slice(self._bounds[k], self._bounds[k + 1])
        if rows.start < rows.stop:
            return self._points[rows], sign * self._normals[rows], sign * self._moments[rows]
        patch = self._patches[k]
        (samples,) = extreme_samples([patch])
        points, normals = patch.points[samples], sign * patch.normals[samples]
        return points, normals, cross(points - self._matrix.centre, normals)


def pair_cones(rows: ContactRows, joints: Sequence[Joint]) -> list[Cone | None]:
    """The rows of each joint's patches and blockers; None for joints that contact does not decide."""
    decided = [k for k, joint in enumerate(joints) if not is_stated(joint)]
    cones = dict(zip(decided, rows.cones([rows.members(joints[k]) for k in decided]), strict=True))
    return [cones.get(k) for k in range(len(joints))]


def is_stated(joint: Joint) -> bool:
    """Is the joint what somebody stated, or what rims suggested, rather than what contact leaves?"""
    return not joint.patches or bool({"rim", "bolt circle", "assumption"}.intersection(joint.evidence))


def _frames(points: Array, counts: Ints) -> list[Frame]:
    """The frames of groups of points (n, 3), one group after the other and none of them empty."""
    start = np.cumsum(counts) - counts
    low, high = np.minimum.reduceat(points, start), np.maximum.reduceat(points, start)
    half = (0.5 * np.linalg.norm(high - low, axis=1)).tolist()
    return [Frame(centre, size or 1.0) for centre, size in zip(0.5 * (low + high), half, strict=True)]


def _opposed_directions(rows: Array, group: Ints, count: int) -> list[Array]:
    """(k, 6) orthonormal directions that the unit rows (n, 6) of each group, ascending, oppose."""
    out = [np.zeros((0, 6))] * count
    counts = np.bincount(group, minlength=count)
    groups = np.flatnonzero(counts)
    if len(groups):
        values, vectors = np.linalg.eigh(grams(rows, np.ones(len(rows)), counts[groups]))
        moved = values > CONE_FREE**2 * counts[groups, None]
        for k, chosen, directions in zip(groups.tolist(), moved, vectors, strict=True):
            out[k] = directions[:, chosen].T
    return out
