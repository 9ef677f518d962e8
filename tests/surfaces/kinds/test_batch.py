"""Batches of candidate regions: what a selection takes over is what it would find by itself."""

from __future__ import annotations

import numpy as np
import pytest
from support.meshes import of_manifold
from support.solids import block, centred_rod

from kinform.model.tolerances import Tolerances
from kinform.surfaces.kinds.axial import cylindrical
from kinform.surfaces.kinds.batch import Batch
from kinform.surfaces.recovery import _Start


@pytest.fixture(scope="module")
def patchwork():
    plate = block(0.06, 0.04, 0.01) - centred_rod(0.008, 0.02, 32).translate((0.01, 0, 0))
    return _Start.of(of_manifold(plate), Tolerances()).work


def batch_and_surfaces(work, draw, count=9):
    keys = np.flatnonzero(draw.random(count * work.count) < 0.4)
    params = draw.normal(size=(count, 8))
    params[:, :3] /= np.linalg.norm(params[:, :3], axis=1, keepdims=True)
    return Batch.of_keys(work, keys, count), params


@pytest.mark.parametrize("seed", range(5))
def test_points_of_a_selection_are_seen_as_those_of_a_batch_of_its_own(patchwork, seed):
    draw = np.random.default_rng(seed)
    batch, params = batch_and_surfaces(patchwork, draw)
    batch.seen(params, cylindrical)
    once = batch.select(draw.random(len(batch.region)) < 0.7)
    for kept in (once, once.select(draw.random(len(once.region)) < 0.5), batch.where(draw.random(batch.count) < 0.5)):
        group, at = kept.seen(params, cylindrical)
        fresh = Batch(patchwork, kept.region, kept.polygon, kept.count)
        expected, own = fresh.seen(params, cylindrical)
        assert group.tobytes() == expected.tobytes()
        assert [values.tobytes() for values in at] == [values.tobytes() for values in own]
        assert [values.tobytes() for values in kept.corners] == [values.tobytes() for values in fresh.corners]


def test_a_selection_is_seen_about_other_surfaces_when_it_is_asked_for_those(patchwork):
    draw = np.random.default_rng(8)
    batch, params = batch_and_surfaces(patchwork, draw)
    batch.seen(params, cylindrical)
    kept, other = batch.select(draw.random(len(batch.region)) < 0.7), params + 0.1
    fresh = Batch(patchwork, kept.region, kept.polygon, kept.count)
    assert kept.seen(other, cylindrical)[1].t.tobytes() == fresh.seen(other, cylindrical)[1].t.tobytes()


@pytest.mark.parametrize("seed", range(5))
def test_a_run_of_regions_has_the_edges_and_vertices_of_a_batch_of_its_own(patchwork, seed):
    draw = np.random.default_rng(seed)
    batch, _ = batch_and_surfaces(patchwork, draw)
    batch.find_shared()
    low, high = np.sort(draw.integers(0, batch.count + 1, 2)).tolist()
    run = batch.run(slice(low, high))
    mine = (batch.region >= low) & (batch.region < high)
    fresh = Batch(patchwork, batch.region[mine] - low, batch.polygon[mine], high - low)
    for found, own in ((run.edges, fresh.edges), (run.inner_vertices(), fresh.inner_vertices())):
        assert [values.tobytes() for values in found] == [values.tobytes() for values in own]
