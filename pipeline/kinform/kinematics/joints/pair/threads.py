"""Facets that lean all round an axis like those of a thread, where no two threads were found to mate."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinform.foundation.algebra.vectors import cross, perpendicular, sine
from kinform.kinematics.joints.pair.constants import ALONG_AXIS
from kinform.kinematics.joints.pair.evidence import COAXIAL, Evidence, Item
from kinform.kinematics.joints.pair.suspects import AtRest, Suspect
from kinform.model.arrays import Array

THREAD_AXES = 4
"""Axes about which threads are suspected. Chosen, not measured."""
THREAD_SECTORS = 8
"""Parts of a turn of which all but one must have contact where a thread is suspected. Chosen, not measured."""
FILLED_SECTOR = 0.02
"""Share of the weight from which on such a part has contact. Chosen, not measured."""
THREAD_SLOPE = 0.01
"""Mean square of the normals along the axis below which nothing leans. Chosen, not measured."""
THREAD_LEAN = 5e-3
"""Advance a radian, in radii, of what leans like a thread. Chosen, not measured."""
THREAD_FIT = 0.75
"""Share of the squared speeds that a screw may leave where facets lean like a thread. Chosen, not measured."""


def leaning_facets(pair: AtRest) -> Iterator[Suspect]:
    """All contact where its facets lean like those of a thread."""
    form, items = pair.form, pair.evidence.items
    if form.type == "screw" or pair.count > 2:
        return
    coaxial = sorted((i for i in items if i.patch.kind in COAXIAL), key=lambda i: (-i.area, i.index))
    lines = [(item.patch.axis, item.patch.point) for item in coaxial[:THREAD_AXES]]
    if form.axis is not None and form.point is not None:
        lines.append((form.axis, form.point))
    for axis, point in lines:
        advance = _advance(pair.evidence, axis, point)
        if advance:
            words = (
                f"facets lean like those of a thread of about {2e3 * np.pi * advance:.3g} mm a turn, "
                "but no two threads of one pitch were found"
            )
            yield Suspect(tuple(range(len(items))), "doubt", words)


def _advance(evidence: Evidence, axis: Array, point: Array) -> float:
    """m a radian of the screw about a line that leaves what touches besides surfaces of revolution about it much
    more nearly free than the turn does; 0 where there is none.

    The advance is the one that makes the weighted squares of the speeds along the normals least. It counts where
    contact goes all round the axis, leans against it, and is preserved better by the screw than by the turn.
    """
    leaning = [i for i in evidence.items if i.patch.kind not in COAXIAL or i.patch.one_sided or not _about(i, axis)]
    if all(i.patch.kind == "plane" and _about(i, axis) for i in leaning):
        return 0.0
    points, normals = np.concatenate([i.points for i in leaning]), np.concatenate([i.normals for i in leaning])
    weights = np.concatenate([i.weights for i in leaning])
    arm = points - point
    radial = arm - (arm @ axis)[:, None] * axis
    radius = float(weights @ np.linalg.norm(radial, axis=1) / weights.sum())
    turning, sliding = np.einsum("ij,ij->i", normals, cross(axis, arm)), normals @ axis
    u, v = perpendicular(axis)
    sector = np.floor(np.arctan2(radial @ v, radial @ u) / (2.0 * np.pi) * THREAD_SECTORS).astype(int) % THREAD_SECTORS
    share = np.bincount(sector, weights=weights, minlength=THREAD_SECTORS) / weights.sum()
    filled = np.count_nonzero(share > FILLED_SECTOR) >= THREAD_SECTORS - 1
    if not filled or weights @ sliding**2 < THREAD_SLOPE * weights.sum():
        return 0.0
    advance = -float(weights @ (turning * sliding) / (weights @ sliding**2))
    rest = float(weights @ (turning + advance * sliding) ** 2)
    lean = abs(advance) > THREAD_LEAN * radius and rest < THREAD_FIT * float(weights @ turning**2)
    return advance if lean else 0.0


def _about(item: Item, axis: Array) -> bool:
    return sine(item.patch.axis, axis) < ALONG_AXIS
