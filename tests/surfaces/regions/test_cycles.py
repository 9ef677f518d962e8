"""What regions have after the next round of growth is said where it is known, and is what it was a period before."""

from __future__ import annotations

import numpy as np
import pytest
from support.meshes import of_manifold
from support.solids import block, centred_rod

from kinform.model.tolerances import Tolerances
from kinform.surfaces.kinds.batch import Batch
from kinform.surfaces.recovery import _Start
from kinform.surfaces.regions.cycles import STEADY, Cycles

REGIONS = 6


@pytest.fixture(scope="module")
def patchwork():
    plate = block(0.06, 0.04, 0.01) - centred_rod(0.008, 0.02, 32).translate((0.01, 0, 0))
    return _Start.of(of_manifold(plate), Tolerances()).work


def rounds(work, draw, periods):
    """(number, what the region has in each phase, its fits) of some of the regions."""
    numbers = np.sort(draw.choice(REGIONS, len(periods), replace=False))
    return [
        (number, [np.flatnonzero(draw.random(work.count) < 0.3 + 0.1 * k) for k in range(period)], draw.normal(size=8))
        for number, period in zip(numbers, periods, strict=True)
    ]


def after(work, regions, stage):
    """(batch, numbers, parameters) of the regions after a round."""
    numbers = np.array([number for number, _, _ in regions])
    had = [phases[stage % len(phases)] for _, phases, _ in regions]
    region = np.repeat(np.arange(len(regions)), [len(polygons) for polygons in had])
    params = np.array([fit + stage % len(phases) for _, phases, fit in regions])
    return Batch(work, region, np.concatenate(had), len(regions)), numbers, params


def filled(work, regions, stages):
    cycles = Cycles(REGIONS)
    for stage in range(stages):
        cycles.add(*after(work, regions, stage))
    return cycles


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("periods", [(2,), (3,), (2, 2), (2, 3), (3, 2, 2)])
def test_what_returns_is_known_after_two_periods(patchwork, periods, seed):
    regions = rounds(patchwork, np.random.default_rng(seed), periods)
    for stage in range(1, 11):
        batch, numbers, params = after(patchwork, regions, stage)
        ahead = filled(patchwork, regions, stage).ahead(numbers, params)
        assert (ahead is not None) == (stage >= 2 * max(periods))
        if ahead is not None:
            assert ahead.count == batch.count
            assert (ahead.region == batch.region).all()
            assert (ahead.polygon == batch.polygon).all()


def test_nothing_is_known_where_a_fit_moves_or_a_region_still_grows(patchwork):
    regions = rounds(patchwork, np.random.default_rng(1), (2, 2))
    _, numbers, params = after(patchwork, regions, 8)
    assert filled(patchwork, regions, 8).ahead(numbers, params) is not None
    moved = params.copy()
    moved[1, 4] += 2 * STEADY
    assert filled(patchwork, regions, 8).ahead(numbers, moved) is None
    cycles = filled(patchwork, regions, 7)
    grown, _, fits = after(patchwork, regions, 7)
    keep = np.ones(len(grown.region), bool)
    keep[-1] = False
    cycles.add(grown.select(keep), numbers, fits)
    assert cycles.ahead(numbers, params) is None
