"""Shells of one closed mesh that cannot be the faces of one solid: inside out, or filling what others fill too.

About any point of space the facets of a solid wind once or not at all. Facets are probed a little below and above:
below one of a solid is material, once; above one of a cavity is none. Shells that touch flush are no fault.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.foundation.meshes.boxes import FacetBoxes, facet_boxes
from kinform.foundation.meshes.ray_parity import RAYS, Ray
from kinform.foundation.meshes.shells import shell_volumes, shells_of
from kinform.foundation.meshes.subdivision import inner_weights
from kinform.foundation.rounding import TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.assembly import Mesh

SHELL_DEPTH = 1e-3
"""How far from a facet it is probed, in the longest side of the shell's facets: fits are shallower, walls thicker."""
CROSSING_SHARE = 0.02
"""Share of the area of a shell that may lie in other shells without a fault: screws modelled in bores that are too
narrow do."""


@dataclass(frozen=True)
class ShellFaults:
    """How many shells are inside out, how many others cross or lie in material; and how far (m³) the signed volume of
    the mesh may be off for these: those inside others count twice, and may have been meant as cavities."""

    inverted: int = 0
    overlapping: int = 0
    doubtful: float = 0.0


def shell_faults(mesh: Mesh) -> ShellFaults:
    """What is wrong with the shells of a closed mesh, wound one way; nothing where it has only one."""
    health = mesh.health
    if health.shells < 2 or not (health.watertight and health.consistent_winding):
        return ShellFaults()
    shell = shells_of(mesh.vertices, mesh.faces)
    volumes = shell_volumes(mesh.vertices, mesh.faces, shell)
    chosen = _chosen(shell)
    chosen = chosen[(_beside_others(mesh, shell) | (volumes < 0.0))[shell[chosen]]]
    share = _wrong(mesh, shell[chosen], chosen, volumes)
    inverted = (share > 0.5) & (volumes < 0.0)
    overlapping, whole = (share > CROSSING_SHARE) & ~inverted, share > 1.0 - CROSSING_SHARE
    inside, crossing = (np.abs(volumes[overlapping & flags]) for flags in (whole, ~whole))
    if len(crossing) > 1:  # what the largest shares with the others is no more than they are
        crossing = np.sort(crossing)[:-1]
    return ShellFaults(int(inverted.sum()), int(overlapping.sum()), float(2.0 * inside.sum() + crossing.sum()))


def _chosen(shell: Ints) -> Ints:
    """Facets of each shell that are probed: evenly many, as the file has them."""
    order = np.argsort(shell, kind="stable")
    counts = np.bincount(shell)
    rank = np.arange(len(shell)) - np.repeat(np.cumsum(counts) - counts, counts)
    # Facets of a shell that are probed, each in the middles of nine triangles that it is divided into: they find
    # overlaps of a few hundredths of a shell.
    step = np.repeat(-(-counts // 32), counts)
    return np.asarray(order[rank % step == 0])


def _beside_others(mesh: Mesh, shell: Ints) -> Flags:
    """(S,) whether the box of a shell meets that of another."""
    low, high = facet_boxes(mesh.vertices, mesh.faces)
    lows, highs = np.full((shell.max() + 1, 3), np.inf), np.full((shell.max() + 1, 3), -np.inf)
    np.minimum.at(lows, shell, low)
    np.maximum.at(highs, shell, high)
    boxes = FacetBoxes(lows, highs)
    return np.array([len(boxes.meeting(*box)) > 1 for box in zip(lows, highs, strict=True)])


def _wrong(mesh: Mesh, shell: Ints, chosen: Ints, volumes: Array) -> Array:
    """(S,) share of the area of each shell, of which the facets `chosen` were probed, that lies in material, or bounds
    a cavity in none."""
    corners = mesh.vertices[mesh.faces[chosen]]
    spans = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(spans, axis=1)
    normals = spans / np.where(areas > 0.0, areas, 1.0)[:, None]
    sizes = np.full(len(volumes), 0.0)
    np.maximum.at(sizes, shell, np.linalg.norm(corners.max(axis=1) - corners.min(axis=1), axis=1))
    cavity = volumes[shell] < 0.0
    depth = np.where(cavity, SHELL_DEPTH, -SHELL_DEPTH) * sizes[shell]
    # the middles of nine triangles of each facet
    points = inner_weights(3) @ corners + (depth[:, None] * normals)[:, None]
    winding = _windings(mesh, points.reshape(-1, 3)).reshape(points.shape[:2])
    bad = np.where(cavity[:, None], winding < -0.5, winding > 1.5).mean(axis=1)
    whole = np.maximum(np.bincount(shell, areas, len(volumes)), TINY)
    return np.asarray(np.bincount(shell, areas * bad, len(volumes)) / whole)


def _windings(mesh: Mesh, points: Array) -> Array:
    """(n,) how often the mesh winds about points (n, 3): the median of three rays' crossings."""
    if not len(points):
        return np.zeros(0)
    first, second = (Ray(mesh, ray).crossings(points) for ray in RAYS[:2])
    doubtful = first != second
    if doubtful.any():
        third = Ray(mesh, RAYS[2]).crossings(points[doubtful])
        first[doubtful] = np.median([first[doubtful], second[doubtful], third], axis=0)
    return first
