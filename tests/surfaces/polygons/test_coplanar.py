"""Moments of polygons are taken over to the bit where polygons stay what they were."""

from __future__ import annotations

import numpy as np
import pytest

from kinform.surfaces.polygons.coplanar import moments, moments_again
from kinform.surfaces.polygons.facets import Facets

SIDE = 40


def crumpled() -> Facets:
    """A sheet of 2 · 40² facets in random heights."""
    x, y = np.meshgrid(np.arange(SIDE + 1.0), np.arange(SIDE + 1.0), indexing="ij")
    heights = np.random.default_rng(3).normal(size=x.size)
    grid = np.arange(x.size).reshape(x.shape)
    a, b, c, d = (g.ravel() for g in (grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]))
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return Facets.of(np.stack([x.ravel(), y.ravel(), heights], 1) / SIDE, faces)


def renumbered(label: np.ndarray) -> np.ndarray:
    """Numbers without gaps."""
    return np.unique(label, return_inverse=True)[1].astype(np.int64)


@pytest.mark.parametrize("change", ["none", "joined", "parted", "swapped", "all"])
def test_moments_again_are_those_found_anew(change: str) -> None:
    """Whatever becomes of the polygons: joined, parted, or of as many facets as before, but of others."""
    mesh, rng = crumpled(), np.random.default_rng(7)
    before = renumbered(rng.integers(0, 300, len(mesh.faces)))
    after = before.copy()
    if change == "joined":
        after[after < 20] = 5
    elif change == "parted":
        some = np.flatnonzero(after < 20)
        after[some[::2]] += 1000
    elif change == "swapped":
        first, second = np.flatnonzero(after == 8)[0], np.flatnonzero(after == 9)[0]
        after[first], after[second] = 9, 8
    elif change == "all":
        after = rng.integers(0, 90, len(after))
    after = renumbered(after)
    wanted = moments(mesh, after)
    found = moments_again(mesh, after, before, moments(mesh, before))
    for one, other in zip(wanted, found, strict=True):
        assert one.tobytes() == other.tobytes()
