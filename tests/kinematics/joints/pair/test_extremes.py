"""Samples that bound a patch: corners of hulls and ends of sectors, whatever else is asked at once."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import nnls
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation
from support.patches import Z, cylinder, patch, plane, ring, sphere

from kinform.foundation.algebra.vectors import perpendicular, weighted_mean
from kinform.kinematics.joints.pair.extremes import extreme_samples, hull


@pytest.mark.parametrize("seed", range(20))
def test_corners_are_those_that_qhull_finds(seed):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(int(rng.integers(4, 200)), 3))
    u, v = perpendicular(Z)
    found = ConvexHull(np.stack([points @ u, points @ v], axis=1)).vertices
    assert hull(points, Z).tolist() == sorted(found.tolist())


@pytest.mark.parametrize("sides", [3, 5, 24, 40])
@pytest.mark.parametrize("size", [1e-4, 1.0, 1e3])
def test_corners_of_a_polygon_are_its_own_and_what_stands_out_from_its_sides(sides, size):
    turn = 2.0 * np.pi * np.arange(sides) / sides + 0.3
    corners = np.stack([np.cos(turn), np.sin(turn), np.zeros(sides)], axis=1)
    middles = 0.5 * (corners + np.roll(corners, -1, axis=0))
    rng = np.random.default_rng(sides)
    for out, counts in ((-1e-3, False), (0.0, False), (1e-8, False), (1e-4, True)):
        points = np.concatenate([corners, middles * (1.0 + out), 0.5 * corners])
        wanted = np.zeros(len(points), dtype=bool)
        wanted[: 2 * sides if counts else sides] = True
        order = rng.permutation(len(points))
        moved = size * (points[order] + [3.0, -2.0, 5.0])
        assert hull(moved, Z).tolist() == np.flatnonzero(wanted[order]).tolist()


def test_a_large_ring_at_one_height_keeps_the_ends_of_its_sectors():
    """No matter how large it is: its samples are all of one level."""
    small, large = (
        replace(cylinder(), points=scale * cylinder().points * [1.0, 1.0, 0.0] + [0.0, 0.0, scale])
        for scale in (1.0, 1e6)
    )
    with np.errstate(all="raise"):
        assert [samples.tolist() for samples in extreme_samples([small])] == [
            samples.tolist() for samples in extreme_samples([large])
        ]


def test_samples_of_a_patch_do_not_depend_on_those_asked_with_it():
    patches = [plane(), ring(), cylinder(), cylinder(arc=(0.0, 2.0)), plane(size=(0.02, 1e-4)), ring(inner=0.001)]
    patches += [replace(patch, points=patch.points + 0.1 * k) for k, patch in enumerate(patches)]
    line = np.linspace(0.0, 1.0, len(ring().points))
    patches += [replace(ring(), points=line[:, None] * [0.3, 0.1, 0.0]), replace(ring(), points=0.0 * ring().points)]
    alone = [samples.tobytes() for patch in patches for samples in extreme_samples([patch])]
    for seed in range(10):
        rng = np.random.default_rng(seed)
        chosen = rng.permutation(len(patches))[: int(rng.integers(1, len(patches) + 1))].tolist()
        together = extreme_samples([patches[k] for k in chosen])
        assert [samples.tobytes() for samples in together] == [alone[k] for k in chosen]


def test_rows_of_a_cylinder_are_combinations_of_those_that_are_kept():
    patch = cylinder(arc=(0.0, 2.5))
    rows = np.hstack([np.cross(patch.points, patch.normals) / 0.01, patch.normals])
    (kept,) = extreme_samples([patch])
    assert len(kept) < len(rows)
    assert max(nnls(rows[kept].T, row)[1] for row in rows) < 1e-9


def test_the_samples_that_bound_a_plane_are_the_corners_of_its_hull():
    rng = np.random.default_rng(0)
    corners = np.array([[0, 0, 0], [4, 0, 0], [5, 2, 0], [1, 3, 0]], float)
    points = np.vstack([rng.dirichlet(np.ones(4), 200) @ corners, corners, 0.5 * (corners[:2] + corners[1:3])])
    (chosen,) = extreme_samples([patch(points, Z, "plane")])
    assert sorted(chosen) == [200, 201, 202, 203]


@pytest.mark.parametrize("found", [cylinder(arc=(0.0, 2.5)), cylinder(), sphere(cap=-0.3), sphere()])
def test_what_the_chosen_samples_allow_all_samples_allow(found):
    (chosen,) = extreme_samples([found])
    rows = np.hstack([np.cross(found.points / 0.01, found.normals), found.normals])
    missing = max(nnls(rows[chosen].T, row)[1] for row in rows)
    assert missing < (1e-6 if found.kind == "cylinder" else 0.02)


@pytest.mark.parametrize("count", [1, 2, 7, 96, 1000])
def test_weighted_mean_has_the_bits_of_numpy(count):
    rng = np.random.default_rng(count)
    points, weights = rng.normal(size=(count, 3)), rng.random(count) + 0.1
    assert weighted_mean(points, weights).tobytes() == np.average(points, axis=0, weights=weights).tobytes()


@pytest.mark.parametrize("shape", ["cloud", "grid", "ring", "sliver"])
@pytest.mark.parametrize("count", [3, 30, 900])
def test_the_corners_of_a_hull_are_those_of_qhull(shape: str, count: int) -> None:
    rng = np.random.default_rng(count)
    turn = 2 * np.pi * np.round(64 * rng.random(count)) / 64
    flat = {
        "cloud": rng.random((count, 2)),
        "grid": np.stack(np.divmod(np.arange(count), max(count // 20, 2)), axis=1).astype(float),
        "ring": np.stack([np.cos(turn), np.sin(turn)], axis=1) * rng.choice([0.5, 1.0], count)[:, None],
        "sliver": np.stack([rng.random(count), 1e-4 * rng.random(count)], axis=1),
    }[shape]
    points = np.column_stack([flat, np.full(count, 0.3)])
    chosen = flat[hull(points, np.array([0.0, 0.0, 1.0]))]
    corners = flat[ConvexHull(flat, qhull_options="QJ Pp" if shape == "sliver" else "").vertices]
    size = np.ptp(flat, axis=0).max()
    # every corner of either is within rounding of the outline of the other: equal areas, and none outside
    assert ConvexHull(chosen).volume == pytest.approx(ConvexHull(corners).volume, rel=1e-5)
    equations = ConvexHull(chosen).equations
    assert (flat @ equations[:, :2].T + equations[:, 2]).max() < 1e-5 * size


@pytest.mark.parametrize("make", [plane, ring, cylinder, sphere, lambda: cylinder(arc=(0.0, 2.0))])
def test_samples_turn_with_the_patch(make):
    one = make()
    wanted = extreme_samples([one])[0].tolist()
    for seed in range(20):
        turn = Rotation.random(random_state=seed).as_matrix()
        moved = {name: getattr(one, name) @ turn.T for name in ("points", "normals", "axis", "point")}
        assert extreme_samples([replace(one, **moved)])[0].tolist() == wanted
