"""Shells of a welded mesh.

Where more than two facets meet in an edge, bodies touch: facets are paired about the edge so that each pair
encloses material (radial sorting of half-edges, as in Hoffmann, Geometric and Solid Modeling, 1989, ch. 2),
so that two boxes that stand on each other stay two shells.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross, dot
from kinform.foundation.graphs.components import components
from kinform.foundation.meshes.edges import EdgeTable, unsorted_edge_table
from kinform.model.arrays import Array, Flags, Ints

SAME_ANGLE = 1e-7
"""rad: facets about an edge within this are coincident."""


def shells_of(vertices: Array, faces: Ints, edges: EdgeTable | None = None) -> Ints:
    """(F,) number of the shell of each facet; shells are numbered by their first facet."""
    if not len(faces):
        return np.zeros(0, dtype=np.int64)
    edges = edges or unsorted_edge_table(faces, len(vertices))
    links = edges.pairs
    if edges.overused:
        links = np.concatenate([links, _radial_links(vertices, faces, edges).T], axis=1)
    first, second = links // 3
    return components(first, second, len(faces))


def shell_volumes(vertices: Array, faces: Ints, shell: Ints) -> Array:
    """(S,) m³, signed, that each shell of a closed mesh bounds: cavities are negative."""
    corners = vertices[faces] - vertices.mean(axis=0)
    return np.bincount(shell, dot(corners[:, 0], cross(corners[:, 1], corners[:, 2]))) / 6.0


def _radial_links(vertices: Array, faces: Ints, edges: EdgeTable) -> Ints:
    """Pairs of half-edges that belong together at edges of more than two facets."""
    busy = edges.counts > 2
    paired = busy & (edges.balance == 0)
    return np.concatenate([
        _neighbours_in_edge(edges, busy & ~paired), _across_material(vertices, faces, edges, paired),
    ])  # fmt: skip


def _members(edges: EdgeTable, which: Flags) -> tuple[Ints, Ints]:
    """Half-edges of the chosen edges, and for each the number of its edge among the chosen."""
    counts = edges.counts[which]
    owner = np.repeat(np.arange(len(counts)), counts)
    within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    return edges.half_edges[np.repeat(edges.starts[which], counts) + within], owner


def _neighbours_in_edge(edges: EdgeTable, which: Flags) -> Ints:
    """All facets of an edge hang together: where directions disagree nothing finer can be said."""
    half, owner = _members(edges, which)
    same = owner[1:] == owner[:-1]
    return np.stack([half[:-1][same], half[1:][same]], axis=1)


def _across_material(vertices: Array, faces: Ints, edges: EdgeTable, which: Flags) -> Ints:
    """Each forward facet with the next backward one, turning from its back side through its material."""
    half, owner = _members(edges, which)
    if not len(half):
        return np.zeros((0, 2), dtype=np.int64)
    angle = _angles(vertices, faces, half, owner, edges.forward)
    backward = ~edges.forward[half]
    order = np.lexsort((angle, owner))
    angle, owner_sorted = angle[order], owner[order]
    step = np.concatenate([[False], (owner_sorted[1:] != owner_sorted[:-1]) | (np.diff(angle) > SAME_ANGLE)])
    # at one angle the backward facet comes first: it closes what came before, not what begins here
    order = order[np.lexsort((~backward[order], np.cumsum(step)))]
    return _next_backward(half[order], owner[order], backward[order])


def _next_backward(half: Ints, owner: Ints, backward: Flags) -> Ints:
    """Pairs each forward half-edge with the next backward one of its edge, cyclically."""
    position = np.arange(len(half))
    begin = np.searchsorted(owner, owner)
    first_backward = np.full(int(owner[-1]) + 1, len(half))
    np.minimum.at(first_backward, owner[backward], position[backward])
    ahead = np.where(backward, position, len(half))
    ahead = np.minimum.accumulate(ahead[::-1])[::-1]
    end = np.searchsorted(owner, owner, side="right")
    target = np.where(ahead < end, ahead, first_backward[owner])
    keep = ~backward & (begin <= position)
    return np.stack([half[keep], half[target[keep]]], axis=1)


def _angles(vertices: Array, faces: Ints, half: Ints, owner: Ints, forward: Flags) -> Array:
    """Angle of each facet about its edge, from the first facet of the edge, towards a forward facet's back."""
    f, k = half // 3, half % 3
    a, b, apex = faces[f, k], faces[f, (k + 1) % 3], faces[f, (k + 2) % 3]
    low, high = np.where(forward[half], a, b), np.where(forward[half], b, a)
    along = vertices[high] - vertices[low]
    along /= _lengths(along)
    out = vertices[apex] - vertices[low]
    out -= dot(out, along)[:, None] * along
    first = np.searchsorted(owner, owner)
    u = out[first] / _lengths(out[first])
    v = cross(along, u)
    # a forward facet's outward normal is along × out, so its material lies at decreasing angles
    angle: Array = np.mod(-np.arctan2(dot(out, v), dot(out, u)), 2 * np.pi)
    angle[angle > 2 * np.pi - SAME_ANGLE] = 0.0
    return angle


def _lengths(vectors: Array) -> Array:
    """(n, 1) to divide by: a facet without area has no direction from its edge, and stays without."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(lengths > 0.0, lengths, 1.0)
