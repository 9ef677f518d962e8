"""How far the collision geometry of a link covers its visual geometry, and reaches beyond it.

Simulators that take meshes for collisions take their convex hulls, or the meshes themselves, whose hulls are the same;
so all is measured on hulls: the visual's vertices against the hull of each piece of collision geometry, and the corners
of these hulls against the hull of the whole visual.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.meshes.hulls import hull_of, outside_of_all
from kinform.model.arrays import Array, Ints
from kinform.model.descriptions import Coverage


def coverage_of(visual: Sequence[tuple[Array, Ints]], collision: Sequence[Array]) -> Coverage | None:
    """The coverage of pieces with vertices (n, 3) m and faces (m, 3) by pieces with vertices (k, 3) m, all in one
    frame; None where one of the two has no extent. Of large meshes a share of the facets is looked at."""
    hulls = [hull for points in collision if (hull := hull_of(points)) is not None]
    whole = hull_of(np.concatenate([points for points, _ in visual])) if visual else None
    if whole is None or not hulls:
        return None
    size = float(np.linalg.norm(np.ptp(whole.corners, axis=0)))
    corners = np.concatenate([hull.corners for hull in hulls])
    beyond = float(whole.outside(corners).max())
    outmost = float(outside_of_all(hulls, whole.corners).max())
    area = bare = 0.0
    for points, faces in visual:
        # Facets of a visual mesh that are held against the collision geometry, about: of larger ones every second,
        # third, … 2000 tell a share of the area to 1 %.
        a, b, c = (points[faces[:: 1 + len(faces) // 2000, k]] for k in range(3))
        if not len(a):
            continue
        out = outside_of_all(hulls, (a + b + c) / 3.0)
        areas = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
        outmost = max(outmost, float(out.max()))
        area += float(areas.sum())
        # Share of a link's size by which its visual may reach out of the collision geometry and counts as covered:
        # facets of primitives and of simplified meshes miss a surface by about 0.1 % to 1 %. Chosen, not measured.
        bare += float(areas @ (out > 0.01 * size))
    across = float(np.linalg.norm(np.ptp(corners, axis=0)))
    return Coverage(max(outmost, 0.0), bare / area if area > 0.0 else 0.0, max(beyond, 0.0), size, across)
