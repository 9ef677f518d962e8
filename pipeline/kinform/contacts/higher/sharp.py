"""Convex edges of a part beside another, and whether places are on a surface of a part."""

from __future__ import annotations

import numpy as np

from kinform.contacts.search.pair_view import PairView, PartView, near_facets
from kinform.foundation.algebra.vectors import dot
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints


@dataclass(frozen=True, eq=False)
class ConvexEdges:
    """Edges at which facets of a part, near the other one, meet convexly."""

    ends: Ints
    """(e, 2) vertices."""
    facets: Ints
    """(e, 2) beside them."""
    cosine: Array
    """(e,) of the angle between the normals of these."""

    def where(self, rows: Flags) -> ConvexEdges:
        """Some of them."""
        return ConvexEdges(self.ends[rows], self.facets[rows], self.cosine[rows])


def convex_edges(pair: PairView) -> tuple[ConvexEdges, ConvexEdges] | None:
    """Those of a and of b in their common box; None where there is no such box."""
    both = convex_edges_of_first(pair), convex_edges_of_first(pair.swapped)
    return None if both[0] is None or both[1] is None else (both[0], both[1])


def convex_edges_of_first(pair: PairView) -> ConvexEdges | None:
    """Those of a."""
    box = pair.common_box()
    return None if box is None else _convex(pair.a, near_facets(pair.a, *box)[0])


def _convex(part: PartView, facets: Ints) -> ConvexEdges:
    """Those between the facets (ascending)."""
    chosen = np.zeros(len(part.faces), dtype=bool)
    chosen[facets] = True
    edges = part.index.edges_among(chosen)
    edges = edges.where(edges.opposed.nonzero()[0])
    beside = edges.facets
    one, two = (part.normals(side) for side in beside.T)
    convex = (edges.convexity(part.vertices, one, two) > 0.0).nonzero()[0]
    cosine = dot(one, two).take(convex)
    return ConvexEdges(edges.ends.take(convex, axis=0), beside.take(convex, axis=0), cosine)


def on_surface(part: PartView, points: Array, normals: Array, surface: int, spare: float) -> Flags:
    """(n,) whether points (n, 3) that lie within `spare` (m) of a surface, with these normals, are on its facets."""
    reach = np.full(len(points), spare + part.surfaces.surfaces[surface].chord)
    hits = part.region.cast(part.to_part(points), part.turn_to_part(normals), reach)
    out = np.zeros(len(points), dtype=bool)
    out[hits.probe[part.surfaces.labels[hits.facet] == surface]] = True
    return out
