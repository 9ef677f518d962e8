"""What is held more than once, and which freedoms there are by name, on assemblies with known answers."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.analytic_solids import surface
from support.assemblies import assembly, between, contacts, part
from support.linkages import CLOSED, bennett
from support.patches import cylinder, patch, plane, ring

from kinform.design import Design
from kinform.kinematics import Motions, derive
from kinform.kinematics.queries.motion_query import query
from kinform.model.surfaces import MeshSurfaces

X, Y, Z = np.eye(3)


def turned(axis, angle):
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def posed(patches, rotation=None, shift=(0, 0, 0), scale=1.0):
    """The patches turned, scaled and shifted."""
    r = np.eye(3) if rotation is None else rotation
    return [
        replace(
            p, points=scale * p.points @ r.T + shift, normals=p.normals @ r.T, axis=p.axis @ r.T,
            point=scale * r @ p.point + shift, weights=scale**2 * p.weights, area=scale**2 * p.area,
            gaps=scale * p.gaps, radii=tuple(scale * x for x in p.radii),
        )
        for p in patches
    ]  # fmt: skip


def hinge(a, b, point, axis=Z, size=1.0):
    """A journal with a thrust ring."""
    point = np.asarray(point, float)
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    made = (
        cylinder(radius=0.005 * size, length=0.02 * size, axis=axis, point=point),
        ring(centre=point + 0.01 * size * axis, normal=axis, inner=0.005 * size, outer=0.008 * size),
    )
    return [between(p, a, b) for p in made]


def closed_chain(points, axes, names):
    joined = zip(names, [*names[1:], names[0]], points, axes, strict=True)
    return [p for a, b, point, axis in joined for p in hinge(a, b, 0.1 * np.asarray(point, float), axis)]


def derived(patches, ground, round_about_z=(), **settings):
    """Kinematics of these contacts; parts named in `round_about_z` are rods about the z axis, others have no shape."""
    names = sorted({name for p in patches for name in p.parts})
    parts = [part(name, volume=2e-6 if name in round_about_z else 1e-6) for name in names]
    rod = surface("cylinder", [0], np.array([1e-4]), axis=Z, radius=0.005)
    shapes = {"2e-06": MeshSurfaces("2e-06", (rod,), np.zeros(4, np.int64), 0.0)}
    return derive(assembly(*parts, ground=ground, **settings), shapes, contacts(*patches))


def of_kind(kinematics, *kinds):
    return [r for r in kinematics.mobility.redundancies if r.kind in kinds]


def keeps_the_count(kinematics):
    mobility = kinematics.mobility
    frees = sum(6 - joint.freedoms for joint in kinematics.joints)
    assert mobility.gruebler == 6 * (len(kinematics.bodies) - 1) - frees
    assert sum(r.rows for r in of_kind(kinematics, "loop", "loops", "block")) == mobility.redundant
    assert len(mobility.named) == mobility.instantaneous
    assert sum(f.idle for f in mobility.named) == mobility.idle
    return True


@cache
def four_bar_contacts():
    return closed_chain(*CLOSED["four-bar"][:2], ["base", "crank", "coupler", "rocker"])


def test_a_planar_four_bar_has_three_rows_too_many_and_says_which():
    found = derived(four_bar_contacts(), "base")
    (loop,) = found.mobility.redundancies
    assert (found.mobility.redundant, loop.rows, loop.kind) == (3, 3, "loop")
    assert loop.directions == ("force along z", "moment about x", "moment about y")
    assert set(loop.joints) == {joint.name for joint in found.joints}
    assert set(loop.patches) == {k for joint in found.joints for k in joint.patches}
    assert keeps_the_count(found)


def test_what_a_loop_can_lock_in_moves_no_joint():
    found = derived(posed(four_bar_contacts(), turned([1, 2, 3], 0.7), (0.3, -0.2, 0.5)), "base")
    (loop,) = found.mobility.redundancies
    for joint in found.joints:
        power = loop.wrenches @ joint.twists.T
        assert np.abs(power).max() < 1e-9


@pytest.mark.parametrize("scale", [0.3, 1.0, 20.0])
def test_redundancy_depends_neither_on_pose_nor_on_scale(scale):
    plain = derived(four_bar_contacts(), "base")
    moved = derived(posed(four_bar_contacts(), turned([1, -2, 0.5], 1.1), (0.4, 3.0, -1.0), scale), "base")
    (a,), (b,) = plain.mobility.redundancies, moved.mobility.redundancies
    assert (a.rows, a.joints, a.kind) == (b.rows, b.joints, b.kind)
    assert [(f.driver, f.body, f.kind) for f in plain.mobility.named] == [
        (f.driver, f.body, f.kind) for f in moved.mobility.named
    ]
    rates = [np.array([rate for _, _, rate in k.mobility.named[0].drives]) for k in (plain, moved)]
    assert np.allclose(*rates, atol=1e-9)


def test_the_order_of_contacts_changes_nothing():
    found = [derived(patches, "base") for patches in (four_bar_contacts(), four_bar_contacts()[::-1])]
    held = [[(r.kind, r.joints, r.directions) for r in k.mobility.redundancies] for k in found]
    assert held[0] == held[1]
    (one,), (two,) = (k.mobility.named for k in found)
    assert [drive[:2] for drive in one.drives] == [drive[:2] for drive in two.drives]
    assert np.allclose([drive[2] for drive in one.drives], [drive[2] for drive in two.drives])


def test_any_ground_gives_the_same_redundancy():
    for ground in ("base", "crank", "coupler", "rocker"):
        found = derived(four_bar_contacts(), ground)
        assert [r.rows for r in found.mobility.redundancies] == [3]
        assert keeps_the_count(found)


def test_a_four_bar_is_driven_at_its_frame_by_one_joint():
    found = derived(four_bar_contacts(), "base")
    (freedom,) = found.mobility.named
    assert "base" in freedom.driver and freedom.looped and not freedom.idle
    assert len(freedom.drives) == 4
    assert {j: r for j, _, r in freedom.drives}[freedom.driver] == 1.0
    assert set(Motions.of(found).twists(freedom)) == {"crank", "coupler", "rocker"}


def test_a_parallelogram_with_a_third_crank_holds_its_plane_twice_and_one_force_more():
    names = ["base", "bar", "crank1", "crank2", "crank3"]
    patches = []
    for k, name in enumerate(names[2:]):
        foot = np.array([0.1 * k, 0.0, 0.0])
        patches += hinge("base", name, foot) + hinge(name, "bar", foot + [0.03, 0.08, 0.0])
    found = derived(patches, "base")
    assert found.mobility.instantaneous == 1
    assert found.mobility.redundant == 7
    assert [r.rows for r in of_kind(found, "loop")] == [3, 3]
    (extra,) = of_kind(found, "loops")
    assert extra.rows == 1 and len(extra.joints) == 6
    # the three cranks can hold each other only along themselves
    force = extra.wrenches[0, 3:]
    assert np.linalg.norm(np.cross(force / np.linalg.norm(force), [0.03, 0.08, 0] / np.hypot(0.03, 0.08))) < 1e-6
    assert keeps_the_count(found)


def test_bennett_has_three_rows_too_many_that_no_plane_explains():
    points, axes = bennett()
    found = derived(closed_chain(points, axes, ["a", "b", "c", "d"]), "a")
    (loop,) = of_kind(found, "loop")
    assert (found.mobility.instantaneous, loop.rows) == (1, 3)


def test_a_spherical_four_bar_says_that_its_axes_meet():
    axes = [np.array(a, float) / np.linalg.norm(a) for a in ([1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1.3])]
    points = [0.9 * axis for axis in axes]
    found = derived(closed_chain(points, axes, ["a", "b", "c", "d"]), "a")
    (loop,) = of_kind(found, "loop")
    assert loop.rows == 3 and len(loop.directions) == 3
    assert all(word.startswith("force") for word in loop.directions)


@pytest.mark.parametrize(("count", "excess"), [(1, 0), (2, 5), (4, 15)])
def test_each_further_hinge_of_a_door_holds_five_rows_too_many(count, excess):
    patches = [p for k in range(count) for p in hinge("door", "frame", (0, 0, 0.5 * k))]
    for pose in (patches, posed(patches, turned([1, 2, 3], 0.7), (1.0, 0.0, 2.0), 3.0)):
        found = derived(pose, "frame")
        assert [joint.type for joint in found.joints] == ["revolute"]
        assert sum(r.rows for r in of_kind(found, "pair")) == excess
        assert found.mobility.redundant == 0 and keeps_the_count(found)
        for one in of_kind(found, "pair"):
            assert len(one.directions) == excess


def test_two_journals_of_one_shaft_hold_four_rows_twice():
    patches = [between(cylinder(point=(0, 0, z)), "shaft", "wall") for z in (0.0, 0.2)]
    found = derived(patches, "wall")
    (pair,) = found.mobility.redundancies
    assert found.joints[0].type == "cylindrical" and pair.rows == 4
    assert sorted(set(pair.directions)) == ["force along x", "force along y", "moment about x", "moment about y"]


def point_foot(x, y):
    return between(patch(np.array([[x, y, 0.0]]), -Z, "point", axis=Z, point=(x, y, 0.0), area=1e-6), "table", "floor")


@pytest.mark.parametrize(("feet", "excess"), [(3, 0), (4, 1)])
def test_a_table_on_points_stands_on_three_of_its_legs(feet, excess):
    places = [(0, 0), (0.8, 0), (0.8, 0.5), (0, 0.5)][:feet]
    found = derived([point_foot(*place) for place in places], "floor")
    assert found.joints[0].freedoms == 3
    assert sum(r.rows for r in of_kind(found, "pair")) == excess


def test_a_table_on_four_flat_feet_holds_nine_rows_too_many():
    feet = [
        between(plane(centre=(x, y, 0), normal=-Z, size=(0.02, 0.02)), "table", "floor")
        for x in (0, 0.8)
        for y in (0, 0.5)
    ]
    (pair,) = derived(feet, "floor").mobility.redundancies
    assert pair.rows == 9 and len(pair.patches) == 4


def test_a_pin_that_only_spins_is_idle_and_the_arm_keeps_its_turn():
    patches = (
        hinge("base", "pin", (0, 0, 0)) + hinge("arm", "pin", (0, 0, 0.05)) + hinge("arm", "tool", (0.2, 0, 0.1), Y)
    )
    found = derived(patches, "base", round_about_z=["pin"])
    idle = [f for f in found.mobility.named if f.idle]
    assert found.mobility.idle == len(idle) and [f.body for f in idle if f.body == "pin"] == ["pin"]
    spin = next(f for f in idle if f.body == "pin")
    assert list(Motions.of(found).twists(spin)) == ["pin"]
    others = [set(Motions.of(found).twists(f)) for f in found.mobility.named if not f.idle]
    assert {"arm", "tool"} in others and keeps_the_count(found)


def test_named_freedoms_span_the_dense_basis():
    patches = (
        four_bar_contacts()
        + hinge("coupler", "tool", (0.1, 0.3, 0.1), [1, 1, 0])
        + hinge("tool", "tip", (0.2, 0.3, 0.2), X)
    )
    found = derived(patches, "base")
    motions, names = Motions.of(found), [body.name for body in found.bodies]
    rows = np.zeros((len(found.mobility.named), len(names), 6))
    for row, freedom in zip(rows, found.mobility.named, strict=True):
        for name, twist in motions.twists(freedom).items():
            row[names.index(name)] = twist
    dense = found.mobility.freedoms
    both = np.vstack([rows.reshape(len(rows), -1), dense.reshape(len(dense), -1)])
    assert np.linalg.matrix_rank(both, tol=1e-8) == np.linalg.matrix_rank(rows.reshape(len(rows), -1)) == len(dense)


def test_a_body_that_nothing_holds_has_six_freedoms_of_its_own():
    made = assembly(part("base"), part("loose"), part("lid"), ground="base")
    found = derive(made, {}, contacts(*hinge("base", "lid", (0, 0, 0))))
    free = [f for f in found.mobility.named if f.driver is None]
    assert [f.body for f in free] == ["loose"] * 6
    twists = np.array([Motions.of(found).twists(f)["loose"] for f in free])
    assert np.linalg.matrix_rank(twists) == 6 and keeps_the_count(found)


def test_a_query_without_the_dense_basis_answers_the_same():
    made = assembly(*(part(n) for n in ("base", "crank", "coupler", "rocker")), ground="base")
    touching = contacts(*four_bar_contacts())
    found = derive(made, {}, touching)
    bare = replace(found, mobility=replace(found.mobility, freedoms=np.zeros((0, 4, 6))))
    for a, b in (("base", "crank"), ("base", "coupler"), ("crank", "rocker")):
        for motion in ({"turn": (Z, np.zeros(3))}, {"slide": X}, {"turn": (X, np.zeros(3))}):
            answers = [
                query(Design(assembly=made, surfaces={}, contacts=touching, kinematics=k), a, b, **motion)
                for k in (found, bare)
            ]
            assert answers[0].free_in_assembly == answers[1].free_in_assembly
