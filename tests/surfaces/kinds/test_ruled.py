"""Least squares over a short narrow arc, whose vertices hardly tell the axis, do not lead away from these vertices."""

from __future__ import annotations

import numpy as np
import pytest
from support.meshes import mesh_of

from kinform.model.tolerances import Tolerances
from kinform.surfaces.kinds.batch import Batch
from kinform.surfaces.kinds.cylinder import Cylinder
from kinform.surfaces.recovery import _Start

BESIDE = [[0.9, 0.0, 0.0], [0.9, 0.3, 0.0], [0.9, 0.0, 0.3]]
"""A facet far off, so that the mesh is large."""

ARCS = {
    "a ribbon about an axis askew": (0.067, 0.22, 4e-5, 5, -0.53),
    "a shorter one": (0.025, 0.065, 9e-5, 6, 0.35),
    "a longer one": (0.066, 1.05, 1e-5, 6, -0.48),
    "a narrow face": (0.0048, 0.051, 6.7e-3, 6, -0.41),
    "a wider one": (0.0045, 0.052, 1.4e-3, 7, 0.15),
}
"""Radius, angle (rad), width, number of generators, and how far these are moved along the axis for each radian."""


def strip(radius, sweep, width, count, advance, seed):
    """An arc of a cylinder about z in strips, its vertices off by some 1e-5 in each coordinate."""
    angle = np.linspace(-0.5 * sweep, 0.5 * sweep, count)
    ring = np.stack([radius * np.cos(angle), radius * np.sin(angle), advance * radius * angle], axis=1)
    vertices = np.stack([ring, ring + [0.0, 0.0, width]], axis=1).reshape(-1, 3)
    vertices += 1e-5 * np.random.default_rng(seed).normal(size=vertices.shape)
    first = 2 * np.arange(count - 1)
    faces = [[k, k + 2, k + 1] for k in first] + [[k + 1, k + 2, k + 3] for k in first]
    last = len(vertices)
    return mesh_of(np.vstack([vertices, BESIDE]), [*faces, [last, last + 1, last + 2]])


@pytest.mark.parametrize("arc", ARCS)
def test_a_fit_does_not_leave_the_vertices_that_its_surface_lies_on(arc):
    radius, sweep, width, count, advance = ARCS[arc]
    cylinder, asked = Cylinder(), 0
    for seed in range(20):
        start = _Start.of(strip(radius, sweep, width, count, advance, seed), Tolerances())
        work, tolerance = start.work, np.array([start.scale.fit])
        polygons = np.flatnonzero(work.middles(np.arange(work.count))[:, 0] * start.span + start.centre[0] < 0.4)
        batch = Batch(work, np.zeros(len(polygons), np.int64), polygons, 1)
        true = np.zeros((1, 8))
        true[0, 2], true[0, 3:6], true[0, 6] = 1.0, -start.centre / start.span, radius / start.span
        _, vertex = cylinder.defining(batch, true, tolerance)
        if len(vertex) < 5:
            continue

        def off(params, vertex=vertex, work=work):
            distance = cylinder.probe(np.repeat(params, len(vertex), axis=0), work.at(vertex)).distance
            return np.sqrt(np.mean(distance**2))

        asked += 1
        for steps in (1, 2, 3, 6):
            fitted = cylinder.refine(batch, true, tolerance, steps)
            assert off(fitted) <= max(2.0 * off(true), tolerance[0]) * 2.0
    assert asked > 5
