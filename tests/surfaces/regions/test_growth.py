"""What is not tried at all would have come to nothing: first looks, and pieces that may be rounds of strips."""

from __future__ import annotations

import numpy as np
import pytest
from support.meshes import mesh_of, of_manifold
from support.solids import block, centred_rod

from kinform.model.tolerances import Tolerances
from kinform.surfaces.kinds.batch import Batch
from kinform.surfaces.kinds.cylinder import Cylinder
from kinform.surfaces.recovery import _Start, recover
from kinform.surfaces.regions import growth
from kinform.surfaces.regions.candidates import Candidates
from kinform.surfaces.regions.chords import ROUND_CHORDS, Rounds
from kinform.surfaces.regions.constants import WIDEST
from kinform.surfaces.regions.growth import MAJORITY, _may_be_most


@pytest.fixture(scope="module")
def start():
    plate = block(0.06, 0.04, 0.01) - centred_rod(0.008, 0.02, 32).translate((0.01, 0, 0))
    return _Start.of(of_manifold(plate), Tolerances())


def test_first_look_refuses_only_what_does_not_conform_for_the_greatest_part(start):
    work, draw = start.work, np.random.default_rng(3)
    bore = np.flatnonzero(np.abs(work.normal[:, 2]) < 0.5)
    bore = bore[np.argsort(-work.area[bore])][4:]
    flats = np.setdiff1d(np.arange(work.count), bore)
    fitted = Cylinder().propose(Batch(work, np.zeros(len(bore), np.int64), np.sort(bore), 1))[0]
    regions = [
        np.sort(np.r_[draw.choice(bore, draw.integers(1, 12), replace=False), draw.choice(flats, k, replace=False)])
        for k in draw.integers(0, 6, 200)
    ]
    region = np.repeat(np.arange(len(regions)), [len(polygons) for polygons in regions])
    batch = Batch(work, region, np.concatenate(regions), len(regions))
    candidates = Candidates(Cylinder(), fitted.repeat(200, axis=0), np.full(200, -1), np.full(200, start.scale.fit))
    may = _may_be_most(candidates, batch)
    fits = candidates.conforms(batch, candidates.reach(batch))
    many = np.bincount(batch.region[fits], minlength=200)
    most = (many / batch.size >= MAJORITY) & (many >= Cylinder.least)
    assert not (most & ~may).any()
    assert most.sum() > 20
    assert (~may).sum() > 5


@pytest.mark.parametrize("segments", [5, 9, 24, 40])
def test_pieces_too_few_of_whose_polygons_conform_come_to_nothing_later(monkeypatch, segments):
    solid = block(0.06, 0.04, 0.01) - centred_rod(0.008, 0.02, segments).translate((0.01, 0, 0))
    solid += centred_rod(0.006, 0.03, 6).translate((-0.02, 0, 0)) ^ block(0.06, 0.04, 0.024)
    mesh = of_manifold(solid.refine_to_length(0.02))
    early = recover(mesh, Tolerances())
    monkeypatch.setattr(growth, "_most", lambda kind, conforming, size: conforming / size >= MAJORITY)
    late = recover(mesh, Tolerances())
    assert (early.labels == late.labels).all()
    for one, other in zip(early.surfaces, late.surfaces, strict=True):
        assert (one.kind, one.side) == (other.kind, other.side)
        np.testing.assert_allclose(
            [*one.axis, *one.point, one.radius], [*other.axis, *other.point, other.radius], atol=1e-12
        )


def bar(turn):
    """A bar whose upper side is a round, with ridges at these angles (n + 1,), and its n strips."""
    count, edge = len(turn), 0.005 * np.c_[np.sin(turn), np.cos(turn)]
    outline = np.concatenate([edge, [[0.0, -0.006]]])
    low, high = (np.c_[outline, np.full(count + 1, z)] for z in (0.0, 0.02))
    faces = []
    for k in range(count + 1):
        after = (k + 1) % (count + 1)
        faces += [(k, count + 1 + k, after), (after, count + 1 + k, count + 1 + after)]
    for k in range(count - 1):
        faces += [(count, k, k + 1), (2 * count + 1, count + 2 + k, count + 1 + k)]
    work = _Start.of(mesh_of(np.concatenate([low, high]), faces), Tolerances()).work
    middle = (turn[1:] + turn[:-1]) / 2
    facing = work.normal @ np.c_[np.sin(middle), np.cos(middle), np.zeros(count - 1)].T
    return work, np.flatnonzero((facing > 1.0 - 1e-9).any(axis=1))


def tried(turn):
    """Whether the strips may be a round."""
    work, strips = bar(np.asarray(turn))
    assert len(strips) == len(turn) - 1
    piece = Batch(work, np.zeros(len(strips), np.int64), strips, 1)
    return Rounds.of(Cylinder(), piece, np.ones(1, np.int64)).batch.count == 1


@pytest.mark.parametrize("strips", [8, 20, 60])
@pytest.mark.parametrize("angle", [170.0, 180.0, 200.0, 300.0])
def test_rounds_are_tried(strips, angle):
    half = np.radians(angle) / 2
    assert tried(np.linspace(-half, half, strips + 1))


def test_a_round_between_the_widest_strips_is_tried():
    half = ROUND_CHORDS / 2 + 1e-9  # not to hang on roundings
    inner = half - WIDEST
    assert tried([-half, *np.linspace(-inner, inner, 7), half])


@pytest.mark.parametrize("angle", [30.0, 60.0, 90.0])
def test_arcs_that_are_no_rounds_are_not(angle):
    half = np.radians(angle) / 2
    assert not tried(np.linspace(-half, half, 13))
