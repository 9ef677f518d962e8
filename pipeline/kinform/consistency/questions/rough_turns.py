"""Bodies that turn about their own axis, and whose meshes are too rough to tell whether anybody could see it.

A pin of 9 facets whose vertices scatter, or a scanned one, has no surfaces that are known to be round
(`mobility.revolution`), and may be a solid of revolution all the same: where its facets, as they are seen in the
half-plane through the axis (radius, height), are the same all round, but for their roughness.
"""

from __future__ import annotations

import math

import numpy as np

from kinform.foundation.algebra.vectors import cross, lengths, perpendicular
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.kinematics import Freedom, Kinematics
from kinform.model.names import BodyName

ROUGH = 2e-3
"""Share of the size of a body by which facets may differ round the axis: meshes with a scatter of 1e-3 do. Chosen, not
measured."""
SPACING = 0.01
"""Share of the size of a body by which points on its facets are apart at most."""
MOST_POINTS = 400_000
"""Points beyond which a body is not looked at."""
SECTORS = 24
"""Parts of a turn that are compared with each other."""
COARSE = math.tau / 7
"""rad: facets of a coarse cylinder span so much at most (`mobility.revolution.COARSE`)."""


def rough_turns(assembly: Assembly, kinematics: Kinematics, least: int = 1) -> tuple[BodyName, ...]:
    """Names of the bodies that no stated joint names, of which one freedom is a turn of the body alone that counts, and
    may turn it onto itself. Meshes are looked at where there are as many such turns as `least`."""
    sides = {name for joint in assembly.function.joints for name in joint.between}
    stated = {kinematics.body_of(assembly.parts_of(name)[0]).name for name in sides}
    turns = [
        freedom
        for freedom in kinematics.mobility.named
        if freedom.kind == "turn" and not freedom.idle and freedom.body not in stated and _alone(kinematics, freedom)
    ]
    if len(turns) < least:
        return ()
    return tuple(freedom.body for freedom in turns if _may_be_round(assembly, kinematics, freedom))


def _alone(kinematics: Kinematics, freedom: Freedom) -> bool:
    """Whether a freedom moves one body alone."""
    joints = kinematics.named_joints
    return bool(freedom.drives) and all(freedom.body in joints[name].bodies for name, _, _ in freedom.drives)


def _may_be_round(assembly: Assembly, kinematics: Kinematics, freedom: Freedom) -> bool:
    """Whether a body is the same all round the axis of a freedom, but for roughness."""
    from scipy.spatial import cKDTree

    axes = np.array([*perpendicular(freedom.axis), freedom.axis])
    corners = [np.zeros((0, 3, 3))]
    for name in kinematics.named_bodies[freedom.body].parts:
        part = assembly.part(name)
        if part.mesh is None:
            return False
        corners.append(
            ((part.mesh.vertices @ part.X_WP[:3, :3].T + part.X_WP[:3, 3] - freedom.point) @ axes.T)[part.mesh.faces]
        )
    facets = np.concatenate(corners)
    if not len(facets):
        return False
    places = facets.reshape(-1, 3)
    size = float(np.linalg.norm(np.ptp(places, axis=0)))
    points = _spread(facets, SPACING * size)
    if points is None:
        return False
    allowed = ROUGH * size + 0.5 * SPACING * size + _sagitta(facets)
    seen = np.stack([np.hypot(points[:, 0], points[:, 1]), points[:, 2]], axis=1)
    sector = ((np.arctan2(points[:, 1], points[:, 0]) / math.tau + 0.5) * SECTORS).astype(int) % SECTORS
    # points of one cell of the half-plane are one
    cells = np.unique(np.column_stack([sector, np.round(seen / (0.5 * ROUGH * size)).astype(int)]), axis=0)
    sector, seen = cells[:, 0], cells[:, 1:] * 0.5 * ROUGH * size
    # on the axis there are no sectors
    away = seen[seen[:, 0] > 2.0 * SPACING * size + allowed]
    for k in range(SECTORS):
        own = seen[sector == k]
        if not len(own) or cKDTree(own).query(away, distance_upper_bound=allowed)[0].max(initial=0.0) > allowed:
            return False
    return True


def _spread(facets: Array, spacing: float) -> Array | None:
    """(n, 3) points on facets (m, 3, 3), no farther than so much from the next; None where they are very many."""
    longest = np.max([lengths(facets[:, k] - facets[:, k - 1]) for k in range(3)], axis=0)
    steps = np.maximum(np.ceil(longest / spacing), 1.0).astype(int)
    if int(((steps + 1) * (steps + 2) // 2).sum()) > MOST_POINTS:
        return None
    out = []
    for count in np.unique(steps).tolist():
        i, j = (part.ravel() for part in np.meshgrid(np.arange(count + 1), np.arange(count + 1)))
        inside = i + j <= count
        shares = np.stack([i, j, count - i - j], axis=1)[inside] / count
        out.append((shares @ facets[steps == count]).reshape(-1, 3))
    return np.concatenate(out)


def _sagitta(facets: Array) -> float:
    """m: by how much facets that face away from z stand off circles about it, by the middle one of their area."""
    normals = cross(facets[:, 1] - facets[:, 0], facets[:, 2] - facets[:, 0])
    areas = lengths(normals)
    sides = np.abs(normals[:, 2]) < 0.5 * areas
    if not sides.any():
        return 0.0
    facets, areas = facets[sides], areas[sides]
    angles = np.arctan2(facets[..., 1], facets[..., 0])
    spans = np.max([np.abs((angles[:, k] - angles[:, k - 1] + math.pi) % math.tau - math.pi) for k in range(3)], axis=0)
    off = np.hypot(facets[..., 0], facets[..., 1]).max(axis=1) * (1.0 - np.cos(0.5 * np.minimum(spans, COARSE)))
    order = np.argsort(off, kind="stable")
    share = np.cumsum(areas[order])
    return float(off[order][np.searchsorted(share, 0.5 * share[-1])])
