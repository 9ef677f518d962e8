"""Balls and rollers on each other and in bores: rows as the analytic surfaces have them, however posed or meshed."""

from __future__ import annotations

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold
from scipy.spatial.transform import Rotation
from support.diagonal import diagonal, first
from support.solids import ball, box, derived, random_pose, rod


def block():
    return box(-20, 20, -20, 20, -5, 0)


def tube(segments):
    return rod(10, -20, 20, segments) - rod(5, -21, 21, segments, 2.0)


def grooved(n, tube=5.0, middle=15.0):
    """A ring with a groove inside, up to 50° from its bottom."""
    a = np.radians(np.linspace(-50, 50, 11))
    groove = np.stack([middle + tube * np.cos(a), tube * np.sin(a)], axis=1)
    outline = np.vstack([groove, [[middle + 8, groove[-1, 1]], [middle + 8, groove[0, 1]]]])
    return Manifold.revolve(CrossSection([outline[::-1]]), n)


def torus(n, tube=4.0, middle=15.0):
    a = np.linspace(0, 2 * np.pi, n // 2, endpoint=False)
    return Manifold.revolve(CrossSection([np.stack([middle + tube * np.cos(a), tube * np.sin(a)], axis=1)]), n)


def taper(n, low=5.0, high=9.0, length=30.0):
    """A cone along z whose axis lies as high above its lowest generator as it is wide there."""
    return Manifold.cylinder(length, low, high, n)


def laid(cone, low=5.0, high=9.0, length=30.0):
    """The same with a generator on the plane z = 0, along x."""
    slope = np.degrees(np.arctan2(high - low, length))
    return cone.rotate((0, 90, 0)).translate((0, 0, low)).rotate((0, -slope, 0))


def seat(n, half=45.0):
    """A block with a conical hole, whose apex is the origin and whose axis is z."""
    wide = 20.0 * np.tan(np.radians(half))
    return rod(wide + 5, 1, 19, n) - Manifold.cylinder(20, 0, wide, n)


LEAN = np.degrees(np.arctan2(4, 30))
"""Half-angle of a taper."""


def roller_on_a_taper(n):
    """A roller along the generator of a taper at +x."""
    away = 4 * np.array([np.cos(np.radians(LEAN)), 0, -np.sin(np.radians(LEAN))])
    roller = rod(4, -12, 12, n, 2.0).rotate((0, LEAN, 0)).translate(tuple(np.array([7, 0, 15]) + away))
    return {"a": taper(n), "b": roller}


def roller_in_a_cup(n, lean=12.0):
    """A tapered roller of half-angle 3° in a conical ring of 15°, both with their apex at the origin."""

    def frustum(half, low, high):
        slope = np.tan(np.radians(half))
        return Manifold.cylinder(high - low, slope * low, slope * high, n).translate((0, 0, low))

    return {"a": frustum(3, 60, 80).rotate((0, lean, 0)), "b": rod(40, 55, 85, n) - frustum(15, 50, 90)}


def crossed_tapers(n, turn=70.0):
    """Two tapers that touch at (7, 0, 15), the second turned about the normal there."""
    lean = np.radians(LEAN)
    about = Rotation.from_rotvec(np.radians(turn) * np.array([np.cos(lean), 0, -np.sin(lean)]))
    R = (about * Rotation.from_euler("y", 2 * LEAN, degrees=True)).as_matrix()
    shift = np.array([7, 0, 15]) - R @ [-7, 0, 15]
    return {"a": taper(n), "b": taper(n).rotate((0, 0, 5)).transform(np.column_stack([R, shift]))}


def upright(solid, height):
    """What turns about z, standing on the plane z = 0, which is so far below its middle."""
    return solid.rotate((90, 0, 0)).translate((0, 0, height))


def barrel(n, tube, middle, half=8.0):
    """What is crowned by `tube`, and as thick as `tube` and `middle` together."""
    a = np.linspace(-np.arcsin(half / tube), np.arcsin(half / tube), n // 2)
    crown = np.stack([middle + tube * np.cos(a), tube * np.sin(a)], axis=1)
    return Manifold.revolve(CrossSection([np.vstack([[[0, -half]], crown, [[0, half]]])]), n)


def wide_tube(n):
    return rod(35, -30, 30, n) - rod(25, -31, 31, n, 2.0)


def rolling_cones(n, first, second):
    """Two cones with one apex at the origin that roll on each other; half-angles in degrees."""

    def frustum(half):
        low, high = 10 * np.tan(np.radians(half)), 5 * np.tan(np.radians(half))
        return Manifold.cylinder(5, low, high, n).translate((0, 0, -10))

    return {"a": frustum(first), "b": frustum(second).rotate((0, 0, 3)).rotate((0, first + second, 0))}


def roller_in_a_ring(n, radius=8.0, wide=20.0, gap=0.0):
    """A roller that lies along the wall of a bore, at +x."""
    ring = rod(wide + 6, -12, 12, n) - rod(wide, -13, 13, n, 2.0)
    return {"a": rod(radius, -10, 11, n, 1.0).translate((wide - radius - gap, 0, 0)), "b": ring}


def ball_in_a_bowl(n, radius=8.0, wide=20.0, gap=0.0):
    """A ball that lies in a bowl which is a half ball deep, off its lowest place."""
    bowl = rod(wide + 5, -wide - 5, 0, n) - ball(wide, n, 2.0)
    where = (wide - radius - gap) * np.array([0.48, 0.64, -0.6])
    return {"a": ball(radius, n, 1.0).translate(tuple(where)), "b": bowl}


CASES = {
    "a small ball in a bowl": (5, "point", lambda n: ball_in_a_bowl(n, 2.0)),
    "a ball in a bowl": (5, "point", ball_in_a_bowl),
    "a ball in a bowl not much wider": (5, "point", lambda n: ball_in_a_bowl(n, 18.0)),
    "a small roller in a ring": (4, "line", lambda n: roller_in_a_ring(n, 1.5)),
    "a roller in a ring": (4, "line", roller_in_a_ring),
    "a roller in a ring not much wider": (4, "line", lambda n: roller_in_a_ring(n, 18.5)),
    "cones at right angles": (4, "line", lambda n: rolling_cones(n, 45, 45)),
    "unequal cones at right angles": (4, "line", lambda n: rolling_cones(n, 30, 60)),
    "cones at an obtuse angle": (4, "line", lambda n: rolling_cones(n, 60, 70)),
    "cones at an acute angle": (4, "line", lambda n: rolling_cones(n, 20, 40)),
    "a tyre on a plane": (5, "point", lambda n: {"a": upright(torus(n), 19), "b": block()}),
    "a leaning tyre on a plane": (
        5,
        "point",
        lambda n: {"a": torus(n).rotate((60, 0, 0)).translate((0, 0, 4 + 15 * np.sin(np.pi / 3))), "b": block()},
    ),
    "a tyre on a roller": (
        5,
        "point",
        lambda n: {"a": upright(torus(n), 24), "b": rod(5, -20, 20, n, 1.0).rotate((90, 0, 20))},
    ),
    "a rod in an eye": (5, "point", lambda n: {"a": torus(n), "b": rod(5, -30, 30, n, 1.0).translate((6, 0, 0))}),
    "two links of a chain": (
        5,
        "point",
        lambda n: {"a": torus(n), "b": torus(n).rotate((90, 0, 0)).translate((22, 0, 0))},
    ),
    "tyres side by side": (
        5,
        "point",
        lambda n: {"a": torus(n), "b": torus(n).rotate((0, 0, 3)).translate((38, 0, 0))},
    ),
    "a barrel in a bore": (4, "line", lambda n: {"a": barrel(n, 20, 5), "b": wide_tube(n)}),
    "a ring in a bore": (4, "line", lambda n: {"a": torus(n, 5.0, 20.0), "b": wide_tube(n)}),
    "a barrel in a wider bore": (
        5,
        "point",
        lambda n: {"a": barrel(n, 20, 3).translate((2, 0, 0)), "b": wide_tube(n)},
    ),
    "tapered rollers side by side": (
        4,
        "line",
        lambda n: {"a": taper(n), "b": taper(n).rotate((180, 0, 3)).translate((14, 0, 30))},
    ),
    "tapered rollers with one apex": (
        4,
        "line",
        lambda n: {
            "a": taper(n).translate((0, 0, 37.5)),
            "b": taper(n).rotate((0, 0, 4)).translate((0, 0, 37.5)).rotate((0, 2 * LEAN, 0)),
        },
    ),
    "a roller on a taper": (4, "line", roller_on_a_taper),
    "a tapered roller in its ring": (4, "line", roller_in_a_cup),
    "crossed tapers": (5, "point", crossed_tapers),
    "ball on a plane": (5, "point", lambda n: {"a": ball(5, n).translate((0, 0, 5)), "b": block()}),
    "roller on a plane": (
        4,
        "line",
        lambda n: {"a": rod(5, -15, 15, n, 3.7).rotate((0, 90, 0)).translate((0, 0, 5)), "b": block()},
    ),
    "ball in a bore of its size": (4, "line", lambda n: {"a": ball(5, n), "b": tube(n)}),
    "ball in a larger bore": (5, "point", lambda n: {"a": ball(4, n).translate((1, 0, 0)), "b": tube(n)}),
    "crossed rollers": (
        5,
        "point",
        lambda n: {"a": rod(5, -20, 20, n), "b": rod(3, -20, 20, n, 1.0).rotate((90, 0, 0)).translate((8, 0, 0))},
    ),
    "rollers side by side": (
        4,
        "line",
        lambda n: {"a": rod(5, -20, 20, n), "b": rod(3, -15, 15, n, 1.0).translate((8, 0, 0))},
    ),
    "ball in the groove of a ring": (
        4,
        "line",
        lambda n: {"a": ball(5, n, 1.0).translate((0, 15, 0)), "b": grooved(n)},
    ),
    "ball in a wider groove": (5, "point", lambda n: {"a": ball(3, n).translate((17, 0, 0)), "b": grooved(n)}),
    "ball on a ring": (5, "point", lambda n: {"a": ball(5, n).translate((24, 0, 0)), "b": torus(n)}),
    "pin in a slot with play": (
        4,
        "line",
        lambda n: {"a": rod(3, -15, 15, n), "b": box(-20, 20, -10, 10, -5, 5) - box(-9, 9, -3.1, 3.1, -6, 6)},
    ),
    "tapered roller on a plane": (4, "line", lambda n: {"a": laid(taper(n)), "b": box(-20, 60, -20, 20, -5, 0)}),
    "ball on a cone": (
        5,
        "point",
        lambda n: {
            "a": ball(5, n).translate((7 + 5 * 30 / np.hypot(30, 4), 0, 15 - 5 * 4 / np.hypot(30, 4))),
            "b": taper(n),
        },
    ),
    "ball beside the middle of a cone": (
        5,
        "point",
        lambda n: {"a": ball(4, n).translate((1, 0, 1 + 4 * np.sqrt(2))), "b": seat(n)},
    ),
    "two balls": (5, "point", lambda n: {"a": ball(5, n), "b": ball(4, n, 3.0).translate((9, 0, 0))}),
}


LIKE_OTHERS = {
    "a small ball in a bowl", "a ball in a bowl not much wider", "a small roller in a ring",
    "a roller in a ring not much wider", "unequal cones at right angles", "cones at an acute angle",
    "a leaning tyre on a plane", "tapered rollers side by side", "ball in a wider groove", "tyres side by side",
}  # fmt: skip
"""Tried in the sweep."""
MESHES = [(48, False), (64, True)]


@pytest.mark.parametrize(
    ("name", "mesh"),
    [
        pytest.param(name, MESHES[i], marks=() if i == k % 2 and name not in LIKE_OTHERS else pytest.mark.sweep)
        for k, name in enumerate(sorted(CASES))
        for i in range(2)
    ],
)
def test_a_higher_pair_holds_what_it_touches(name, mesh):
    segments, swap = mesh
    freedoms, kind, make = CASES[name]
    solids = make(segments)
    if swap:
        solids = {"a": solids["b"], "b": solids["a"]}
    kinematics, contacts = derived(random_pose(np.random.default_rng(segments)), **solids)
    assert {patch.kind for patch in contacts.patches} == {kind}
    (joint,) = kinematics.joints
    assert joint.type == "general"
    assert joint.freedoms == freedoms


@diagonal(half=[20.0, 45.0, 55.0], mesh=[(48, False), (64, True)])
def test_a_ball_is_seated_in_a_cone_as_far_as_a_line_tells(half, mesh):
    segments, swap = mesh
    """It turns about its middle, which the cone holds from one side."""
    X = random_pose(np.random.default_rng(segments))
    middle = np.array([0.0, 0.0, 4.0 / np.sin(np.radians(half))])
    solids = {"a": ball(4, segments).translate(tuple(middle)), "b": seat(segments, half)}
    kinematics, contacts = derived(X, **({"a": solids["b"], "b": solids["a"]} if swap else solids))
    assert [patch.kind for patch in contacts.patches] == ["line"]
    (joint,) = kinematics.joints
    assert (joint.type, joint.status) == ("spherical", "ambiguous")
    assert np.allclose(joint.point, X[:3, :3] @ middle * 1e-3 + X[:3, 3], atol=1e-6)


@pytest.mark.parametrize("apart", first(1, [0.5, 2.0]))
def test_what_does_not_touch_is_no_pair(apart):
    for a, b in (
        (ball(5, 48), ball(4, 48).translate((9 + apart, 0, 0))),
        (rod(5, -20, 20, 48), rod(3, -20, 20, 48).rotate((90, 0, 0)).translate((8 + apart, 0, 0))),
        (ball(4.5 - apart / 2, 48), tube(48)),
        (ball(4, 48).translate((0, 0, 4 * np.sqrt(2) + apart)), seat(48)),
        (laid(taper(48)).translate((0, 0, apart)), box(-20, 60, -20, 20, -5, 0)),
        (taper(48), taper(48).rotate((180, 0, 0)).translate((14 + apart, 0, 30))),
        (taper(48), crossed_tapers(48)["b"].translate((apart, 0, 0))),
        (upright(torus(48), 19 + apart), block()),
        (torus(48), rod(5, -30, 30, 48).translate((6 - apart, 0, 0))),
        (torus(48), torus(48).translate((38 + apart, 0, 0))),
        (roller_in_a_cup(48)["a"].translate((-apart, 0, 0)), roller_in_a_cup(48)["b"]),
        tuple(roller_in_a_ring(48, gap=apart).values()),
        tuple(ball_in_a_bowl(48, gap=apart).values()),
    ):
        _, contacts = derived(np.eye(4), a=a, b=b)
        assert not contacts.patches


def test_a_pin_on_a_disc_beside_a_slot_is_held_across_it_and_by_the_disc():
    pin = rod(3, -10, 10, 48) + rod(8, 5.1, 10, 48)
    slotted = box(-20, 20, -10, 10, -5, 5) - box(-9, 9, -3.05, 3.05, -6, 6)
    kinematics, contacts = derived(random_pose(np.random.default_rng(5)), a=pin, b=slotted)
    assert sorted({patch.kind for patch in contacts.patches}) == ["line", "plane"]
    assert kinematics.joints[0].freedoms == 2


def test_a_pin_beside_one_wall_and_a_face_is_not_in_a_slot():
    pin = rod(3, -10, 10, 48) + rod(8, 5.1, 10, 48)
    _, contacts = derived(np.eye(4), a=pin, b=box(-20, 20, -15, -3.0, -5, 5))
    assert {patch.kind for patch in contacts.patches} == {"plane"}


@pytest.mark.parametrize("segments", [24, 57])
def test_the_line_of_two_tapers_is_the_generator_that_they_share(segments):
    X = random_pose(np.random.default_rng(segments))
    (patch,) = derived(X, **roller_in_a_cup(segments))[1].patches
    generator = X[:3, :3] @ [np.sin(np.radians(15)), 0, np.cos(np.radians(15))]
    normal = X[:3, :3] @ [np.cos(np.radians(15)), 0, -np.sin(np.radians(15))]
    along = (patch.points - X[:3, 3]) @ generator
    assert np.abs(patch.points - X[:3, 3] - np.outer(along, generator)).max() < 2e-7
    assert np.allclose(patch.normals, normal, atol=1e-5)
    cosine = np.cos(np.radians(3))
    assert 0.06 / cosine < along.min() < 0.061 / cosine
    assert 0.079 / cosine < along.max() < 0.08 / cosine


@diagonal(size=[(3.0, 0.0), (15.0, 0.0), (8.0, 0.02)], segments=[32, 57])
def test_the_line_of_a_roller_in_a_ring_lies_where_both_are_nearest(size, segments):
    radius, gap = size
    X = random_pose(np.random.default_rng(segments))
    (patch,) = derived(X, **roller_in_a_ring(segments, radius, gap=gap))[1].patches
    local = (patch.points - X[:3, 3]) @ X[:3, :3] * 1e3
    assert np.abs(local[:, :2] - [20 - gap / 2, 0]).max() < 1e-3
    assert -10 < local[:, 2].min() < -9 < 10 < local[:, 2].max() < 11
    assert np.allclose(patch.normals @ X[:3, :3], [1, 0, 0], atol=1e-4)
    assert np.allclose(patch.gaps, 1e-3 * gap, atol=1e-6)
    assert patch.radii[0] == pytest.approx(1e-3 * 20 * radius / (20 - radius), rel=1e-3)


@pytest.mark.parametrize(("radius", "gap"), [(3.0, 0.0), (15.0, 0.0), (8.0, 0.02)])
def test_the_point_of_a_ball_in_a_bowl_lies_where_both_are_nearest(radius, gap):
    X = random_pose(np.random.default_rng(3))
    (patch,) = derived(X, **ball_in_a_bowl(64, radius, gap=gap))[1].patches
    outward = np.array([0.48, 0.64, -0.6])
    assert np.abs((patch.points - X[:3, 3]) @ X[:3, :3] * 1e3 - (20 - gap / 2) * outward).max() < 1e-3
    assert np.allclose(patch.normals @ X[:3, :3], outward, atol=1e-4)
    assert np.allclose(patch.gaps, 1e-3 * gap, atol=1e-6)


def test_what_is_little_smaller_than_its_bore_is_its_shaft():
    kinematics, contacts = derived(np.eye(4), **roller_in_a_ring(64, 19.6))
    assert [patch.kind for patch in contacts.patches] == ["cylinder"]
    assert kinematics.joints[0].type == "cylindrical"


def test_tapered_rollers_that_lie_askew_touch_at_a_point():
    """Beyond the angle up to which they share a generator."""
    for turn in (2.0, -10.0):
        kinematics, contacts = derived(random_pose(np.random.default_rng(8)), **crossed_tapers(64, turn))
        assert [patch.kind for patch in contacts.patches] == ["point"]
        assert kinematics.joints[0].freedoms == 5


def test_a_ring_on_a_shaft_is_held_upright_by_more_than_its_line():
    kinematics, _ = derived(random_pose(np.random.default_rng(2)), a=torus(64), b=rod(11, -20, 20, 64, 1.0))
    assert (kinematics.joints[0].type, kinematics.joints[0].status) == ("cylindrical", "determined")


@pytest.mark.parametrize("rings", first(2, [20, 65, 21, 48]))
def test_how_finely_a_barrel_is_meshed_says_nothing_about_how_it_is_held(rings):
    kinematics, _ = derived(random_pose(np.random.default_rng(rings)), a=barrel(rings, 20, 5), b=wide_tube(64))
    assert (kinematics.joints[0].type, kinematics.joints[0].freedoms) == ("general", 4)
