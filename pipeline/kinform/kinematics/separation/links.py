"""Contact between two bodies as the whole assembly sees it: its cone, or, where nothing opens, what it leaves free."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field
from functools import cached_property

import numpy as np

from kinform.foundation.algebra.screws import Frame, scaled
from kinform.foundation.algebra.vectors import cross
from kinform.frozen import dataclass
from kinform.kinematics.constants import SAME_DIRECTION
from kinform.kinematics.screws.canonical_basis import directions
from kinform.kinematics.separation.constants import CONE_HELD
from kinform.kinematics.separation.contact_rows import Cone
from kinform.model.arrays import Array
from kinform.model.kinematics import Release
from kinform.model.names import JointName


@dataclass(frozen=True, eq=False)
class Link:
    """Two bodies in contact. `cone` is None where nothing opens."""

    name: JointName
    ends: tuple[int, int]
    cone: Cone | None
    twists: Array
    """(f, 6) its freedoms where nothing opens, (0, 6) elsewhere."""
    slides: tuple[Release, ...] | None = None
    """In which the second leaves the first; None where not known yet."""
    straight: Array = field(default_factory=lambda: np.zeros((3, 0)))
    """(3, k) perpendicular unit directions of translations that keep all its contact."""

    @cached_property
    def across(self) -> Array:
        """(3, 3) projector onto what these translations do not span."""
        return np.eye(3) - self.straight @ self.straight.T

    def held_in(self, frame: Frame) -> Array:
        """Unit rows (n, 6) of what it holds as long as it does not open, against twists scaled in `frame`."""
        if self.cone is not None:
            both = np.concatenate([self.cone.fixed, self.cone.rows])
            return rows_in_frame(both, self.cone.frame, frame)
        free = scaled(self.twists.T, frame)
        held, _ = np.linalg.qr(free, mode="complete") if free.shape[1] else (np.eye(6), None)
        rows: Array = held[:, free.shape[1] :].T
        return rows


def translations_of_cone(cone: Cone) -> Array:
    """(3, k) perpendicular unit directions of translations that keep all contact of a pair."""
    normals = np.concatenate([cone.fixed, cone.rows])[:, 3:]
    if not len(normals):
        return np.eye(3)
    _, values, right = np.linalg.svd(normals, full_matrices=True)
    still = np.ones(3, dtype=np.bool_)
    # no row moves faster than that for certain: so many rows together no faster than their root
    still[: len(values)] = values <= CONE_HELD * np.sqrt(len(normals))
    return directions(right[still].T)


def translations_of_twists(twists: Array, frame: Frame) -> Array:
    """(3, k) the same of freedoms (f, 6), seen in a frame about the bodies."""
    if not len(twists):
        return np.zeros((3, 0))
    basis, _ = np.linalg.qr(scaled(twists.T, frame))
    _, values, right = np.linalg.svd(basis[:3], full_matrices=True)
    still = np.ones(len(right), dtype=np.bool_)
    still[: len(values)] = values <= SAME_DIRECTION
    return directions(basis[3:] @ right[still].T)


def common_frame(frames: Sequence[Frame]) -> Frame:
    """One frame for contacts that have their own."""
    centres = np.array([frame.centre for frame in frames])
    whole = Frame.of(centres)
    length = whole.length if len(frames) > 1 and np.ptp(centres, axis=0).any() else 0.0
    return Frame(whole.centre, max(length, *(frame.length for frame in frames)))


def rows_in_frame(rows: Array, source: Frame, frame: Frame) -> Array:
    """Rows (n, 6) against twists scaled in `source` as rows against twists scaled in `frame`."""
    normals = rows[:, 3:]
    moments = rows[:, :3] * source.length + cross(source.centre - frame.centre, normals)
    return np.concatenate([moments / frame.length, normals], axis=1)
