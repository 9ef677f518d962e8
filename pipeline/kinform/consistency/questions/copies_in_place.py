"""Parts that are copies of each other in one place: their mass counts as often as they are there."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Part

APART = 0.01
"""Share of the least extent of a part by which the corners of its copy may lie beside its own: 99 % of both is then in
one place. Chosen, not measured."""


def copies_in_place(assembly: Assembly) -> Iterator[tuple[Part, Part]]:
    """Parts whose vertices are those of an earlier part, with that part: inside groups as outside of them.

    Parts whose mass is stated, alone or with their group, and geometry of descriptions without a density, are left out:
    no mass follows from them.
    """
    stated = {name for group in assembly.groups if group.override is not None for name in group.parts}
    described = {name for d in assembly.descriptions for link in d.links for name in link.parts}
    firsts: list[Part] = []
    boxes = np.empty((len(assembly.parts), 6))
    for part in assembly.parts:
        mesh = part.mesh
        if mesh is None or not len(mesh.faces) or part.override is not None or part.name in stated:
            continue
        if part.density is None and part.name in described:
            continue
        box = np.concatenate(mesh.placed_box(part.X_WP))
        within = APART * float((box[3:] - box[:3]).min())
        near = np.flatnonzero((np.abs(boxes[: len(firsts)] - box) <= within).all(axis=1))
        first = next((firsts[k] for k in near if _same(firsts[k], part, within)), None)
        if first is not None:
            yield first, part
        else:
            boxes[len(firsts)] = box
            firsts.append(part)


def _same(first: Part, second: Part, within: float) -> bool:
    """Whether each vertex of either is within that distance (m) of one of the other."""
    if first.mesh is second.mesh and np.array_equal(first.X_WP, second.X_WP):
        return True
    from scipy.spatial import KDTree

    a, b = _placed(first), _placed(second)
    return all(
        bool((KDTree(those).query(these, distance_upper_bound=within)[0] <= within).all())
        for those, these in ((a, b), (b, a))
    )


def _placed(part: Part) -> Array:
    """Vertices (n, 3) m in the world."""
    assert part.mesh is not None
    placed: Array = part.mesh.vertices @ part.X_WP[:3, :3].T + part.X_WP[:3, 3]
    return placed
