"""What is told of a turn or a slide at once: where facets can meet, how far parts are certainly apart, and what is no
collision wherever the motion goes."""

from __future__ import annotations

import math
from types import SimpleNamespace

import fcl
import numpy as np
import pytest
from support.diagonal import diagonal
from support.slots import lever_between_pegs
from support.solids import assembly, box, part, random_pose, rod

from kinform import collisions, contacts, kinematics, surfaces
from kinform.collisions.driving.meeting_spans import meeting_spans
from kinform.collisions.driving.swept_profiles import Profile, meeting
from kinform.collisions.driving.swept_spheres import first_touch
from kinform.collisions.pair.advancement import Search
from kinform.collisions.pair.mate_surfaces import Kept
from kinform.foundation.algebra.displacements import displacement
from kinform.foundation.meshes.fcl_adapter import fcl_distance, fcl_model, fcl_pose

MARGIN = 1e-9


def no_mates(i, j, low, high):
    return np.zeros(len(i), dtype=bool)


def twist_of(kind, X):
    axis = X[:3, 2]
    return np.append(axis, np.cross(X[:3, 3], axis)) if kind == "turn" else np.append(np.zeros(3), axis)


def shards(rng, count, size, off):
    """Triangles strewn about, as vertices and faces."""
    places = rng.uniform(-1, 1, (count, 1, 3)) + off
    return (places + rng.normal(scale=size, size=(count, 3, 3))).reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def distances(first, second, twist, places):
    models = [fcl.CollisionObject(fcl_model(*mesh)) for mesh in (first, second)]
    out = []
    for s in places:
        models[1].setTransform(fcl_pose(displacement(s * twist)))
        out.append(fcl_distance(*models))
    return np.array(out)


@diagonal(kind=["turn", "slide"], seed=range(4))
def test_parts_meet_nowhere_but_where_it_is_said(kind, seed):
    rng = np.random.default_rng(seed)
    twist = twist_of(kind, random_pose(rng))
    size = 0.02 if seed % 2 else 0.4
    meshes = [shards(rng, 12, size, off) for off in (0.0, [0.9, 0.2, 0.1])]
    profiles = [Profile(*mesh, twist) for mesh in meshes]
    every = np.arange(12)
    spans = meeting_spans([(p.corners(every), every) for p in profiles], kind == "turn", MARGIN, no_mates)
    told = {sign: spans.towards(sign) for sign in (-1, 1)}
    places = np.linspace(0.0, 3.1, 700)
    met = 0
    for sign in (-1, 1):
        live = np.array([told[sign](s)[0] for s in places])
        touching = distances(*meshes, sign * twist, places) <= 0.0
        met += touching.sum()
        assert live[touching].all()
        assert size > 0.1 or not live.all()
        for s, meets in zip(places[::25], live[::25], strict=True):
            until = told[sign](s)[1]
            within = (places >= s) & (places < until)
            assert (live[within] == meets).all()
    if size > 0.1:
        assert met


@diagonal(kind=["turn", "slide"], seed=range(4))
def test_what_meets_in_a_piece_of_the_way_is_among_the_facets_that_can(kind, seed):
    """By boxes of facets, of many of them by those that lie together too, and by the spans in which they can meet."""
    rng = np.random.default_rng(seed)
    twist = twist_of(kind, random_pose(rng))
    count, size = (12, 0.35) if seed % 2 else (150, 0.06)
    meshes = [shards(rng, count, size, off) for off in (0.0, [0.9, 0.2, 0.1])]
    every = np.arange(count)
    first, second = (Profile(*mesh, twist) for mesh in meshes)
    found = meeting(first, second, every, every, MARGIN)
    spans = meeting_spans([(p.corners(every), every) for p in (first, second)], kind == "turn", MARGIN, no_mates)
    left_out, met = np.zeros(2), 0
    for begin in np.linspace(-3.1, 2.8, 12):
        told = found.within(begin, begin + 0.3), spans.facets(begin, begin + 0.3)
        left_out += [2 * count - sum(map(len, facets)) for facets in told]
        for s in np.linspace(begin, begin + 0.3, 8):
            D = displacement(s * twist)
            models = [fcl.CollisionObject(fcl_model(*mesh)) for mesh in meshes]
            models[1].setTransform(fcl_pose(D))
            result = fcl.CollisionResult()
            fcl.collide(*models, fcl.CollisionRequest(num_max_contacts=1000), result)
            met += len(result.contacts)
            for facets in told:
                assert {c.b1 for c in result.contacts} <= set(facets[0].tolist())
                assert {c.b2 for c in result.contacts} <= set(facets[1].tolist())
    assert met
    assert left_out.all()


@pytest.mark.parametrize("middle", np.linspace(0.0, 6.0, 7))
def test_what_lies_on_the_far_side_does_not_count_in_a_gap_of_a_ring(middle):
    """A facet in a gap of 1 rad in a ring, turned by less than half of it, and by more."""

    def facets(angles):
        corners = np.array([[1.0, 0, 0], [1.01, 0, 0], [1.0, 0.01, 0.01]])
        c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
        x, y = corners[:, 0], corners[:, 1]
        turned = np.stack([c * x - s * y, s * x + c * y, np.broadcast_to(corners[:, 2], (len(angles), 3))], axis=2)
        return turned.reshape(-1, 3), np.arange(3 * len(angles)).reshape(-1, 3)

    twist = np.array([0, 0, 1.0, 0, 0, 0])
    around = middle + np.linspace(0.5, math.tau - 0.5, 200)
    first, second = Profile(*facets(np.array([middle])), twist), Profile(*facets(around), twist)
    found = meeting(first, second, np.arange(1), np.arange(200), MARGIN)
    assert [len(side) for side in found.within(-0.45, 0.45)] == [0, 0]
    assert 1 <= len(found.within(0.45, 0.6)[1]) < 40


def test_a_fine_ring_is_met_no_further_than_its_teeth_reach():
    """Two small facets at 90° meet at a quarter of a turn, and for about as long as they are wide."""
    first = np.array([[[1.0, 0, 0], [1.0, 0.01, 0], [1.0, 0.01, 0.01]]])
    second = np.array([[[0, -1.0, 0], [0.01, -1.0, 0], [0.01, -1.0, 0.01]]])
    spans = meeting_spans([(first, np.zeros(1, int)), (second, np.zeros(1, int))], True, MARGIN, no_mates)
    assert len(spans.low) == 1
    assert spans.low[0] <= np.pi / 2 <= spans.high[0]
    assert spans.high[0] - spans.low[0] < 0.021 + 2 * math.tau / 8192


@diagonal(kind=["turn", "slide"], seed=range(2))
def test_spheres_touch_first_where_it_is_said(kind, seed):
    rng = np.random.default_rng(seed)
    spheres = [np.vstack([rng.uniform(-1, 1, (3, 120)), rng.uniform(0, 0.3, (1, 120))]) for _ in range(2)]
    start = 0.0 if seed % 2 else 0.7
    places = np.linspace(start, start + math.tau if kind == "turn" else 4.0, 4000)
    for sign in (-1, 1):
        first = first_touch(*spheres, kind == "turn", sign, start)
        twist = np.zeros(6)
        twist[2 if kind == "turn" else 5] = sign
        moved = np.stack([displacement(s * twist) for s in places])
        at = np.einsum("sij,jn->sin", moved[:, :3, :3], spheres[1][:3]) + moved[:, :3, 3:]
        gap = np.linalg.norm(at - spheres[0][:3], axis=1) - spheres[0][3] - spheres[1][3]
        met = gap <= 0.0
        sure = np.where(met.any(axis=0), places[met.argmax(axis=0)], np.inf)
        assert (first <= sure + 1e-9).all()
        # what the steps do not resolve is a graze
        step = places[1] - places[0]
        early = first < sure - step
        least = np.array([gap[np.searchsorted(places, f) - 1 :, n].min() for n, f in enumerate(first) if early[n]])
        assert (least < 3 * step).all()
        assert np.isfinite(first).any()
        assert np.isinf(first).any()


@pytest.mark.parametrize("size", [1e-7, 1.0, 1e5, 1e9])
def test_spheres_on_the_axis_touch_or_not_without_a_warning(size):
    """Of parts of kilometres numpy warned of an overflow, on stderr."""
    near, far = size * np.array([[0.0], [0.0], [0.0], [1.0]]), size * np.array([[0.0], [0.0], [3.0], [1.0]])
    with np.errstate(all="raise"):
        assert first_touch(near, far, True, 1, 0.1)[0] == np.inf
        assert first_touch(near, near, True, 1, 0.1)[0] == pytest.approx(0.1)


@pytest.mark.parametrize("turning", [True, False])
@pytest.mark.parametrize("kind", ["plane", "cylinder"])
def test_points_are_no_further_from_a_mate_than_their_box_says(turning, kind):
    rng = np.random.default_rng(5)
    told = 0
    for _ in range(40):
        X = random_pose(rng)
        axis = X[:3, :3].T @ [0, 0, 1.0] if turning or kind == "cylinder" else X[:3, :3].T @ [1.0, 0, 0]
        axis = axis + rng.normal(scale=0.02, size=3)
        axis /= np.linalg.norm(axis)
        surface = SimpleNamespace(kind=kind, axis=axis, point=rng.normal(scale=0.1, size=3), radius=0.5)
        low = rng.uniform(0.2, 0.5, (1, 2))
        high = low + rng.uniform(0, 0.3, (1, 2))
        bound = Kept(low, high, turning, X, (-1.0, 1.0)).furthest(surface, np.array([0]))
        if bound is None:
            continue
        told += 1
        a, b = rng.uniform(low[0], high[0], (2000, 2)).T
        angle, height = rng.uniform(0, math.tau, 2000), rng.uniform(-1, 1, 2000)
        points = np.stack([a * np.cos(angle), a * np.sin(angle), b] if turning else [a, b, height], axis=1)
        local = (points - X[:3, 3]) @ X[:3, :3] - surface.point
        along = local @ axis
        away = np.abs(along)
        if kind == "cylinder":
            away = np.abs(np.linalg.norm(local - along[:, None] * axis, axis=1) - 0.5)
        assert away.max() <= bound[0] + 1e-12
    assert told == (0 if kind == "cylinder" and not turning else 40)


def searched(monkeypatch, solids):
    """Pairs that are followed, with the poses that were tried of each, and the ranges."""
    tried = {}

    def counted(search, test, course, *args):
        asked = set()
        whole = course.displacement
        object.__setattr__(course, "displacement", lambda s: asked.add(s) or whole(s))
        tried.setdefault(test.part_names, []).append(asked)
        begin(search, test, course, *args)

    begin = Search.__init__
    monkeypatch.setattr(Search, "__init__", counted)
    made = assembly(*(part(name, solid, np.eye(4), 1e-3) for name, solid in solids.items()), ground=None)
    known = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, known)
    return tried, collisions.ranges(made, known, touching, kinematics.derive(made, known, touching))


def test_a_shaft_between_its_collars_is_not_followed_round(monkeypatch):
    block = box(-20, 20, -20, 20, 0, 20) - rod(10, -1, 21, 48)
    shaft = rod(10, -3, 23, 48) + rod(14, -6, 0, 48) + rod(14, 20, 26, 48)
    tried, ranges = searched(monkeypatch, {"block": block, "shaft": shaft})
    assert [item.status for item in ranges] == ["unbounded"]
    assert tried == {}


def test_a_lever_is_followed_only_where_it_comes_to_its_pegs(monkeypatch):
    tried, ranges = searched(monkeypatch, lever_between_pegs())
    assert [item.status for item in ranges] == ["found"]
    assert sorted(len(times) for times in tried.values()) == [2]
    assert max(len(asked) for times in tried.values() for asked in times) < 80
