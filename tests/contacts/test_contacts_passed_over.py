"""What is passed over at first sight changes no contact: all of it asked, the answers are the same to the bit."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from manifold3d import Manifold
from support.diagonal import first
from support.solids import box, extrusion, random_pose, recovered, rod

from kinform import contacts
from kinform.contacts import pair as one_pair
from kinform.contacts.higher import outlines, profiles
from kinform.contacts.mating import freeform, one_sided


def scattered(solid, rng, by):
    """The solid with vertices that scatter (mm)."""
    return solid.refine_to_length(1.5).warp_batch(lambda v: v + by * rng.normal(size=v.shape))


def ellipse(a, b, segments, phase):
    t = 2 * np.pi * (np.arange(segments) + phase) / segments
    return np.stack([a * np.cos(t), b * np.sin(t)], axis=1)


def pairs(rng):
    """Solids that touch along faces, facets and lines, and beside these come near each other elsewhere."""
    shaft = rod(2.2, -6, 6, 24) + rod(4.0, 4, 6, 24)
    block = box(-5, 5, -5, 5, -3.95, 3.95) - rod(2.25, -5, 5, 32)
    yield {"block": block, "shaft": scattered(shaft, rng, 0.02)}
    yield {"block": scattered(block, rng, 0.02), "shaft": scattered(shaft, rng, 0.02)}
    yield {"block": scattered(block, rng, 0.02), "shaft": scattered(rod(2.2, -6, 6, 24), rng, 0.02).rotate((0, 4, 20))}
    tilted = box(-3, 3, -3, 3, 0, 2).rotate((0.7, 0.4, 0.0)).translate((0.0, 0.0, 3.99))
    yield {"block": block, "tilted": tilted}
    yield {"ball": scattered(rod(3.0, 0, 3, 20), rng, 0.01).translate((0, 0, 3.95)), "block": block}
    cam = extrusion(ellipse(6.0, 4.0, 60, 0.2), -2, 2)
    yield {"cam": cam, "other": extrusion(ellipse(5.0, 3.0, 48, 0.4), -1, 3).translate((11.0, 0, 0))}
    table = box(-5, 5, -5, 5, -2, 0)
    yield {"table": table, "tower": box(-5, 5, -5, 5, 0, 2) + box(-1, 1, -1, 1, 2, 4)}
    for away in rng.uniform(0.0, 0.5, 4):
        # the boxes of what stands askew meet, and of what is in a bore
        yield {"table": table, "above": box(-2, 2, -2, 2, 0, 2).rotate((4.0, 3.0, 0.0)).translate((0, 0, 0.3 + away))}
        yield {"block": block, "rod": rod(2.25 - 2.5 * away, -6, 6, 20)}
        yield {"block": block, "ball": Manifold.sphere(2.2 - 2.0 * away, 24).translate((0.1, 0.0, 1.0))}
    yield {"cam": cam, "table": box(-20, 20, -9, -3.99, -3, 3) + rod(1.0, -3, 3, 16).translate((-9, -3.2, 0))}


def of_all(touching):
    """All that patches and overlaps hold."""
    return [
        [np.asarray(getattr(one, field.name)).tolist() for field in dataclasses.fields(one)]
        for one in (*touching.patches, *touching.interferences)
    ]


def everything(monkeypatch):
    """Has all of it asked, and returns how much each of the tests would have passed over."""
    spared = {"rest": 0, "face": 0, "curve": 0, "far": 0, "straight": 0}
    rest, face, curve = one_sided._may_rest, freeform._may_face, outlines.may_curve
    far, bulge = one_pair.far_apart, profiles.bulge_of

    def all_rest(view, rows, facets, normals):
        spared["rest"] += np.count_nonzero(~rest(view, rows, facets, normals))
        return np.ones(len(rows), bool)

    def all_face(pair, rows, columns, flags):
        every = [(int(i), int(j), None) for i, j in np.argwhere(flags)]
        facing = {(i, j): facets for i, j, facets in face(pair, rows, columns, flags)}
        for i, j, _ in every:
            probed = pair.near[0].facets[rows[i]], pair.near[1].facets[columns[j]]
            kept = facing.get((i, j), ((), ()))
            spared["face"] += sum(map(len, probed)) - sum(map(len, kept or probed))
        return every

    def all_curve(part, pieces, smooth_edge):
        may = curve(part, pieces, smooth_edge)
        spared["curve"] += np.count_nonzero(~may)
        return np.ones_like(may)

    def all_near(pairs):
        spared["far"] += sum(far(pairs))
        return [False] * len(pairs)

    def all_bent(part, smooth):
        spared["straight"] += not bulge(part, smooth)
        return 1.0

    monkeypatch.setattr(one_pair, "far_apart", all_near)
    monkeypatch.setattr(profiles, "bulge_of", all_bent)
    monkeypatch.setattr(one_sided, "_may_rest", all_rest)
    monkeypatch.setattr(freeform, "_may_face", all_face)
    monkeypatch.setattr(profiles, "may_curve", all_curve)
    return spared


@pytest.mark.parametrize("seed", first(1, range(2)))
def test_what_is_passed_over_changes_nothing(seed, monkeypatch):
    rng = np.random.default_rng(seed)
    asked = [recovered(random_pose(rng), **solids) for solids in pairs(rng)]
    found = [of_all(contacts.find(*made)) for made in asked]
    assert sum(bool(patches) for patches in found) >= 4
    spared = everything(monkeypatch)
    assert [of_all(contacts.find(*made)) for made in asked] == found
    assert all(spared.values())


def points(rng, kind):
    """Points (n, 2) some of which lie within 1 of each other: alone, in pairs, in chains, in columns."""
    base = rng.uniform(-50, 50, (40, 2))
    if kind == "columns":
        base[:, 0] = np.round(base[:, 0], -1)
    steps = {"pairs": 1, "chains": 6, "columns": 3}.get(kind, 0)
    out = [base]
    for _ in range(steps):
        out.append(out[-1] + rng.uniform(-0.8, 0.8, base.shape))
    return np.concatenate(out)


@pytest.mark.parametrize("kind", ["alone", "pairs", "chains", "columns"])
def test_points_are_made_one_by_their_distances(kind):
    rng = np.random.default_rng(3)
    for _ in range(20):
        every = points(rng, kind)
        order = np.lexsort((every[:, 1], every[:, 0]))
        every = every[order]
        near = np.linalg.norm(every[:, None] - every[None], axis=2) <= 1.0
        leader = near.argmax(axis=1)
        while (leader[leader] != leader).any():
            leader = leader[leader]
        assert (outlines._leaders(every, 1.0) == leader).all()
