"""One edge, or one facet, of a mesh that shows what is wrong with all of it."""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross, dot
from kinform.foundation.meshes.ray_parity import RAYS, Ray
from kinform.foundation.meshes.shells import shells_of
from kinform.model.assembly import Mesh
from kinform.model.findings import Witness, computed

ABOVE = 1e-4
"""How far above a facet it is probed, in the square root of its area."""
FACETS_TRIED = 20
"""Largest facets that are probed."""


def misused_edge(mesh: Mesh, part: str, *, directed: bool = False) -> Witness | None:
    """The first edge that other than two facets share, or, `directed`, that two run along in one sense; if there is
    any."""
    runs = np.concatenate([mesh.faces[:, [k, (k + 1) % 3]] for k in range(3)])
    edges, counts = np.unique(runs if directed else np.sort(runs, axis=1), axis=0, return_counts=True)
    wrong = np.flatnonzero(counts > 1 if directed else counts != 2)
    if not len(wrong):
        return None
    count = int(counts[wrong[0]])
    ends = mesh.vertices[edges[wrong[0]]]
    off = count - 1 if directed else abs(count - 2)
    return computed("edge uses", off, 0.0, parts=[part], edge=ends, directed=float(directed))


def inverted_facet(mesh: Mesh, part: str) -> Witness | None:
    """A large facet that faces into what its shell encloses; None where none is found."""
    corners = mesh.vertices[mesh.faces] - mesh.vertices.mean(axis=0)
    shell = shells_of(mesh.vertices, mesh.faces)
    volumes = np.bincount(shell, dot(corners[:, 0], cross(corners[:, 1], corners[:, 2])))
    spans = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    double = np.linalg.norm(spans, axis=1)
    facets = np.argsort(np.where(volumes[shell] < 0.0, -double, 0.0), kind="stable")[:FACETS_TRIED]
    facets = facets[double[facets] > 0.0]
    above = ABOVE * spans[facets] / np.sqrt(double[facets])[:, None]
    points = mesh.vertices[mesh.faces[facets]].mean(axis=1) + above
    odd = sum((Ray(mesh, ray).crossings(points) % 2.0 for ray in RAYS), np.zeros(len(points))) >= 2.0
    facing = facets[odd]
    return computed("facet faces inwards", 1.0, 0.0, parts=[part], facet=facing[0]) if len(facing) else None
