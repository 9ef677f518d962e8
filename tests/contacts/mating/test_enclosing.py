"""What encloses a part is found with the probes that can hit something alone, as with all of them."""

from __future__ import annotations

from itertools import cycle

import numpy as np
from manifold3d import Manifold
from support.solids import box, derived, random_pose, recovered, rod

from kinform import contacts
from kinform.contacts.constants import FACING_LEAST
from kinform.contacts.mating import enclosing


def crumpled(solid: Manifold, rng, by: float) -> Manifold:
    """The solid with vertices that scatter (mm)."""
    return solid.refine_to_length(1.5).warp_batch(lambda v: v + by * rng.normal(size=v.shape))


def test_probes_that_are_left_out_hit_nothing(monkeypatch):
    seen = []
    asked = enclosing._can_hit

    def watched(view, points, normals, reach, unread, of_row, column):
        able, region = asked(view, points, normals, reach, unread, of_row, column)
        hits = view.b.region.cast(view.b.to_part(points), view.b.turn_to_part(normals), np.full(len(points), reach))
        at = column[view.b.surfaces.labels[hits.facet]]
        count = (at >= 0) & unread[of_row[hits.probe], at] & (hits.facing < -FACING_LEAST)
        assert np.isin(hits.probe[count], able).all()
        assert region.facets is None or np.isin(hits.facet[count], region.facets).all()
        seen.append(count.sum())
        return able, region

    monkeypatch.setattr(enclosing, "_can_hit", watched)
    block = box(-5, 5, -5, 5, -3.95, 3.95) - rod(2.3, -5, 5, 32)
    for seed in range(2):
        rng = np.random.default_rng(seed)
        shaft = crumpled(rod(2.2, -6, 6, 24) + rod(4.0, 4, 6, 24) + rod(4.0, -6, -4, 24), rng, 0.04)
        derived(random_pose(rng), block=block, shaft=shaft)
    assert any(seen)


def test_faces_that_look_the_same_way_are_left_out(monkeypatch):
    """The end of a pin, flush with the plate that it is in, where the boxes of faces tell nothing."""
    left = []
    asked = enclosing._can_hit

    def watched(view, points, *rest):
        able, region = asked(view, points, *rest)
        left.append(len(points) - len(able))
        return able, region

    monkeypatch.setattr(enclosing, "may_face", lambda pair, unread: bool(unread.any()))
    monkeypatch.setattr(enclosing, "_can_hit", watched)
    pin = rod(3.0, 0, 5, 24) + rod(4.5, 5, 7, 24)
    derived(random_pose(np.random.default_rng(5)), plate=box(-9, 9, -9, 9, 0, 5) - rod(3.05, -1, 6, 24), pin=pin)
    assert any(left)


def test_surfaces_that_never_face_each_other_have_no_facets_that_do(monkeypatch):
    """Pins with a neck in one bore, shafts with collars in stepped ones, balls in seats, shafts whose vertices scatter:
    what is passed over has nothing near."""
    rng = np.random.default_rng(5)
    said = []
    asked = enclosing.may_face

    def watched(pair, unread):
        may = asked(pair, unread)
        near = enclosing._near(pair, unread) if unread.any() else None
        assert may or near is None
        said.append((may, near is None))
        return may

    monkeypatch.setattr(enclosing, "may_face", watched)
    for play, pose in zip((0.02, 0.48, 0.52), cycle((np.eye(4), random_pose(rng))), strict=False):
        shaft = rod(3.0, -6, 9, 24) + rod(4.0, 4, 6, 24)
        block = box(-8, 8, -8, 8, -5, 8) - rod(3.05, -7, 5, 28) - rod(4.0 + play, 4 - play, 9, 24)
        contacts.find(*recovered(pose, block=block, shaft=shaft))
        pin = rod(3.0, 0, 2.5, 24) + rod(3.05 - play, 2.5, 5, 24)
        contacts.find(*recovered(pose, plate=box(-9, 9, -9, 9, 0, 5) - rod(3.05, -1, 6, 24), pin=pin))
        ball = Manifold.sphere(3.0, 32).translate((0.4, 0.2, 3.0 + 0.3 * play))
        contacts.find(*recovered(pose, block=box(-8, 8, -8, 8, -5, 4) - rod(3.5 + play, 0, 9, 40), ball=ball))
        worn = crumpled(rod(2.99, -6, 9, 24) + rod(3.9, 4, 6, 24), rng, 0.04)
        contacts.find(*recovered(pose, block=block, shaft=worn))
    assert {may for may, _ in said} == {True, False}
