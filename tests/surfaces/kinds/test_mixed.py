"""Cylinders and cones in one batch: each has what it has among its own kind alone, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest
from support.diagonal import first
from support.meshes import of_manifold
from support.solids import block, centred_rod

from kinform.model.tolerances import Tolerances
from kinform.surfaces.kinds.batch import Batch
from kinform.surfaces.kinds.mixed import Mixed
from kinform.surfaces.polygons.noise import Scales
from kinform.surfaces.polygons.patchwork import Patchwork
from kinform.surfaces.recovery import _Start
from kinform.surfaces.regions.growth import pursue
from kinform.surfaces.regions.partition import CONE, CYLINDER, STRAIGHT, _around
from kinform.surfaces.regions.territory import Territory

KINDS = (CYLINDER, CONE)


@pytest.fixture(scope="module")
def territory():
    """Of rods, tapers and bores, two meshes with different tolerances."""
    from manifold3d import Manifold

    taper = Manifold.cylinder(0.02, 0.01, 0.004, 40) + centred_rod(0.004, 0.06, 24)
    plate = block(0.06, 0.04, 0.01) - centred_rod(0.008, 0.02, 32) - Manifold.cylinder(0.006, 0.002, 0.012, 28)
    starts = [_Start.of(of_manifold(solid), Tolerances()) for solid in (taper, plate + taper.translate((0.01, 0, 0)))]
    return Territory.of(Patchwork.joined([s.work for s in starts]), Scales.of([s.scale for s in starts]))


def regions_of(territory, kind, draw):
    """About edges, and of polygons drawn at random, of which many are on no surface of the kind."""
    work, edges = territory.patchwork, territory.smooth
    some = np.sort(draw.choice(edges, min(len(edges), 60), replace=False))
    side = np.where(work.sign[some] < 0, -1, 1)
    keys = [_around(territory, some, side, STRAIGHT[kind.name]).keys]
    keys += [
        (len(some) + k) * work.count + np.sort(draw.choice(work.count, kind.least, replace=False)) for k in range(40)
    ]
    batch = Batch.of_keys(work, np.concatenate(keys), len(some) + 40)
    order = draw.permutation(batch.count)
    batch = Batch.of_keys(work, np.sort(order[batch.region] * np.int64(work.count) + batch.polygon), batch.count)
    side = np.concatenate([side, draw.choice([-1, 1], 40)])[np.argsort(order)]
    batch, number = batch.where(batch.size >= kind.least).compact()
    return batch, side[number]


def of_growth(growth):
    """Everything in it, as bytes, of the regions that there are."""
    size = growth.batch.size
    kept = np.flatnonzero(size)
    surfaces = growth.surfaces
    return [
        surfaces.kind.name,
        *(values[kept].tobytes() for values in (surfaces.params, surfaces.side, surfaces.tolerance, size)),
        growth.batch.polygon.tobytes(),
    ]


def together(territory, batches, sides):
    keys = [batches[0].keys, batches[1].keys + batches[0].count * np.int64(territory.patchwork.count)]
    count = sum(batch.count for batch in batches)
    batch = Batch.of_keys(territory.patchwork, np.concatenate(keys), count)
    return pursue(territory, Mixed(*KINDS, batches[0].count), batch, np.concatenate(sides)).each()


@pytest.mark.parametrize("seed", first(2, range(4)))
def test_company_of_another_kind_changes_no_bit(territory, seed):
    draw = np.random.default_rng(seed)
    batches, sides = zip(*(regions_of(territory, kind, draw) for kind in KINDS), strict=True)
    alone = [pursue(territory, kind, batch, side) for kind, batch, side in zip(KINDS, batches, sides, strict=True)]
    assert all(growth.batch.size.any() for growth in alone)
    assert not CYLINDER.propose(batches[0])[1].all()
    assert [of_growth(g) for g in together(territory, batches, sides)] == [of_growth(g) for g in alone]


@pytest.mark.parametrize("missing", [0, 1])
def test_a_kind_without_regions_is_left_out(territory, missing):
    draw = np.random.default_rng(5)
    batches, sides = map(list, zip(*(regions_of(territory, kind, draw) for kind in KINDS), strict=True))
    nothing = np.zeros(0, np.int64)
    batches[missing], sides[missing] = Batch(territory.patchwork, nothing, nothing, 0), nothing
    there = 1 - missing
    alone = pursue(territory, KINDS[there], batches[there], sides[there])
    assert [of_growth(growth) for growth in together(territory, batches, sides)] == [of_growth(alone)]
