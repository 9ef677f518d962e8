"""What triangles cover, against Clipper's union of them, whatever else is asked with it."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from manifold3d import CrossSection, FillRule

from kinform.contacts.mating.regions import regions


def grid(rng, side, torn):
    """Triangles (n, 3, 2) of a bent grid, with some of its squares torn out; some triangles run right about."""
    x, y = np.meshgrid(*[np.arange(side + 1.0)] * 2, indexing="ij")
    points = np.stack([x, y], axis=2).reshape(-1, 2) + rng.uniform(-0.3, 0.3, ((side + 1) ** 2, 2))
    a = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    a = a[rng.random(len(a)) >= torn]
    faces = np.concatenate([np.stack([a, a + side + 1, a + side + 2], 1), np.stack([a, a + side + 2, a + 1], 1)])
    turned = rng.random(len(faces)) < 0.3
    faces[turned] = faces[turned, ::-1]
    return points[rng.permutation(faces)]


def sets(seed):
    """Whole grids, grids with holes, of which some meet in corners, and triangles that lie on each other or are
    needles."""
    rng = np.random.default_rng(seed)
    out = []
    for torn in (0.0, 0.1, 0.4, 0.9):
        out += [grid(rng, side, torn) for side in (1, 3, 9)]
    loose = rng.uniform(-3.0, 3.0, (40, 3, 2))
    loose[:5, 2] = loose[:5, 1]
    out += [loose, loose[:1], loose[:3], np.concatenate([out[1], out[1][:4]]), np.zeros((0, 3, 2))]
    return out, rng.choice([1e-4, 0.3, 1.0, 40.0], len(out)).tolist()


def union(flat, unit):
    """Of triangles (n, 3, 2), all of them given to Clipper."""
    corners = flat / unit
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    turned = np.where((area < 0.0)[:, None, None], corners[:, ::-1], corners)
    return CrossSection(list(np.ascontiguousarray(turned[area != 0.0])), FillRule.Positive)


@settings(max_examples=12, deadline=None)
@given(st.integers(0, 10**6))
def test_a_region_is_the_union_of_its_triangles(seed):
    for flat, unit, region in zip(*sets(seed), regions(*sets(seed)), strict=True):
        expected = union(flat, unit)
        size = max(1.0, expected.area())
        assert abs(region.area() - expected.area()) <= 1e-6 * size
        assert (region - expected).area() <= 1e-6 * size
        assert (expected - region).area() <= 1e-6 * size


@settings(max_examples=12, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 100))
def test_a_region_does_not_hang_on_the_others_nor_on_their_order(seed, together):
    flats, units = sets(seed)
    alone = [regions([flat], [unit])[0] for flat, unit in zip(flats, units, strict=True)]
    order = np.random.default_rng(seed).permutation(4 * len(flats)) % len(flats)
    for start in range(0, len(order), together):
        some = order[start : start + together]
        for k, region in zip(some, regions([flats[k] for k in some], [units[k] for k in some]), strict=True):
            found, expected = region.to_polygons(), alone[k].to_polygons()
            assert [p.tobytes() for p in found] == [p.tobytes() for p in expected]
