"""A large mesh is put into a model only as far as it lies beside what asks: what is found is what all of it gives."""

from __future__ import annotations

import numpy as np
import pytest
from support.analytic_solids import MM
from support.meshes import of_manifold
from support.solids import block, centred_rod

from kinform.foundation.meshes import mesh_index as indices
from kinform.foundation.meshes.boxes import facet_boxes
from kinform.foundation.meshes.mesh_index import MeshIndex


def plate():
    """30 × 30 × 20 mm with a bore, of 5,000 facets on all sides."""
    solid = block(30 * MM, 30 * MM, 20 * MM) - centred_rod(4 * MM, 40 * MM, 24)
    return MeshIndex(of_manifold(solid.refine_to_length(1.5 * MM)))


@pytest.fixture
def large(monkeypatch):
    monkeypatch.setattr(indices, "LARGE_MESH", 0)


def probes(seed, low, high):
    draw = np.random.default_rng(seed)
    points, directions = draw.uniform(low, high, (300, 3)), draw.normal(size=(300, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return points, directions, np.full(300, 1.0 * MM)


def expecting(low, high):
    """The plate, asked to expect a box."""
    out = plate()
    out.expect(np.array([low]), np.array([high]))
    return out


TOP = (np.array([-15.0, -15.0, 9.0]) * MM, np.array([15.0, 15.0, 11.0]) * MM)


def hits_of(index, seed, low, high):
    hits = index.whole().cast(*probes(seed, low, high))
    return hits.probe.tolist(), hits.facet.tolist(), hits.along.tobytes(), hits.facing.tobytes()


@pytest.mark.parametrize("seed", range(4))
def test_probes_beside_the_other_part_hit_what_they_hit_of_all(large, seed):
    partly = expecting(*TOP)
    found = hits_of(partly, seed, *TOP)
    assert len(found[0]) > 100
    assert found == hits_of(plate(), seed, *TOP)
    assert partly._bvh is None


def test_probes_elsewhere_are_answered_by_all(large):
    everywhere = (np.array([-15.0, -15.0, -10.0]) * MM, np.array([15.0, 15.0, 10.0]) * MM)
    found = hits_of(expecting(*TOP), 5, *everywhere)
    assert len(found[0]) > 20
    assert found == hits_of(plate(), 5, *everywhere)


@pytest.mark.parametrize(("height", "crossing"), [(20.5, False), (19.5, True)])
def test_parts_cross_where_all_of_them_do(large, height, crossing):
    one, other = plate(), plate()
    X_SO = np.eye(4)
    X_SO[2, 3] = height * MM
    for index, away in ((one, X_SO[:3, 3]), (other, -X_SO[:3, 3])):
        index.expect(*facet_boxes(index.mesh.vertices + away, index.mesh.faces))
    assert one.whole().crosses(other.whole(), X_SO) is crossing
    assert one._bvh is None
    assert other._bvh is None
    assert plate().whole().crosses(plate().whole(), X_SO) is crossing


def test_no_model_is_made_of_some_for_a_mesh_that_is_not_large():
    small = plate()
    assert not small.is_large
    assert small.whole().bvh is small.model_near(*(corner[None] for corner in TOP))[0]
