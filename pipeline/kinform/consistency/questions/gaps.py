"""How far parts are apart as they are drawn."""

from __future__ import annotations

import math
from collections.abc import Collection
from itertools import product

import fcl
import numpy as np

from kinform.foundation.meshes.fcl_adapter import fcl_distance, fcl_model, fcl_pose
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Mesh, Part
from kinform.model.findings import Witness, between

PAIRS_MOST = 100_000
"""Pairs of parts between two sides that are looked at: more are two halves of an assembly of 600 parts."""


def gap_between(assembly: Assembly, first: Collection[str], second: Collection[str]) -> Witness | None:
    """The least distance of the meshes of two sides; None where a side has none, or both are too many."""
    one, other = ([part for part in map(assembly.part, sorted(names)) if part.mesh is not None] for names in
                  (first, second))  # fmt: skip
    if not one or not other or len(one) * len(other) > PAIRS_MOST:
        return None
    boxes = {part.name: _box(part) for part in (*one, *other)}
    pairs = sorted(
        (_box_gap(boxes[a.name], boxes[b.name]), a.name, b.name) for a, b in product(one, other) if a is not b
    )
    models: dict[str, fcl.CollisionObject] = {}
    least = math.inf
    for bound, *names in pairs:
        if bound >= least:
            break
        a, b = (models.setdefault(name, _model(assembly.part(name))) for name in names)
        least = min(least, fcl_distance(a, b))
    return between([part.name for part in one], [part.name for part in other], least)


def _box(part: Part) -> Array:
    assert part.mesh is not None
    return np.array(part.mesh.placed_box(part.X_WP))


def _box_gap(one: Array, other: Array) -> float:
    return float(np.linalg.norm(np.maximum(0.0, np.maximum(other[0] - one[1], one[0] - other[1]))))


def _model(part: Part) -> fcl.CollisionObject:
    mesh = part.mesh
    assert isinstance(mesh, Mesh)
    return fcl.CollisionObject(fcl_model(mesh.vertices, mesh.faces), fcl_pose(part.X_WP))
