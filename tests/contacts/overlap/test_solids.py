"""Pieces of an overlap: those into which manifold3d takes it apart."""

from __future__ import annotations

import numpy as np
import pytest
from manifold3d import Manifold

from kinform.contacts.overlap.solids import _overlap


def spheres(count):
    """Two spheres that coincide but for their facets, which share hundreds of lenses."""
    return Manifold.sphere(0.4, count), Manifold.sphere(0.4, int(1.3 * count)).rotate((10, 20, 30))


def bars():
    """A comb of bars that crosses one long bar."""
    comb = [Manifold.cube((0.05, 0.4, 0.05)).translate((x, -0.2, 0.0)) for x in (-0.4, -0.1, 0.3)]
    return Manifold.cube((1.0, 0.1, 0.2), True), Manifold.compose(comb)


@pytest.mark.parametrize("pair", [spheres(32), bars(), (Manifold.cube(), Manifold.cube().translate((2, 0, 0)))])
def test_pieces_are_those_of_manifold3d(pair):
    shared = (pair[0] - Manifold.sphere(0.399, 64)) ^ pair[1]
    parts = [part for part in shared.decompose() if not part.is_empty()]
    every = _overlap(shared, 0.0, np.zeros(3), 1.0).pieces
    by_manifold = sorted((part.volume(), part.surface_area()) for part in parts if part.volume() > 0.0)
    found = sorted((piece.volume, piece.area) for piece in every)
    np.testing.assert_allclose(found, by_manifold, rtol=1e-9, atol=1e-15)
    assert sum(len(piece.corners) for piece in every) == sum(part.num_tri() for part in parts if part.volume() > 0.0)
    if by_manifold:
        least = by_manifold[len(by_manifold) // 2][0]
        above = {piece.volume for piece in _overlap(shared, least, np.zeros(3), 1.0).pieces}
        assert above <= {volume for volume, _ in found if volume >= least}
