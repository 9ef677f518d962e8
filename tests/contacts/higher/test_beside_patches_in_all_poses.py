"""What pins hold beside patches is the same in all poses and sizes, however the facets are listed, and whichever part
comes first; and however near the axis they are, or short the wall that holds them."""

from __future__ import annotations

import hashlib
from dataclasses import replace

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold
from support.diagonal import first
from support.solids import assembly, box, part, random_pose, rod

from kinform import contacts, kinematics, surfaces


def along_x(solid):
    return solid.rotate((0, 90, 0))


def half_let_in(tilt, play, radius=1.6):
    """A pin half let into a plate, in a slot of the plate on it, whose walls touch it where both begin."""
    pin = along_x(Manifold.cylinder(20, radius, radius, 48, True)).rotate((0, 0, tilt)).translate((0, 0, 3))
    wide = 2 * (radius + play)
    hub = Manifold.cube((40, 40, 6), True).translate((0, 0, 6)) - Manifold.cube((22, wide, wide), True).translate(
        (0, 0, 3)
    )
    return Manifold.cube((40, 40, 6), True) + pin, hub


def tongue(eccentric, length):
    """A small pin on the end of a shaft, near the axis, in a slot at the end of its bore."""
    shaft = rod(6, 0, length + 10, 56, 3.0) + rod(0.5, -3, 1, 32).translate((eccentric, 0, 0))
    return shaft, box(-12, 12, -12, 12, -6, length) - rod(6, -1, length + 20, 64) - box(-3, 3, -0.5, 0.5, -4, 1)


def tube(wall, half):
    """A cross pin, long beside the wall of the tube whose slots hold it."""
    shaft = rod(6, -25, 25, 56, 3.0) + rod(1, -half, half, 24, 5.0).rotate((-90, 0, 0))
    return shaft, rod(6 + wall, -20, 20, 64) - rod(6, -30, 30, 64) - box(-1, 1, -13, 13, -9, 9)


def against_a_wall(height):
    """A cross pin against one wall."""
    shaft = rod(6, -25, 25, 56, 3.0) + rod(1, 4, height, 24, 5.0).rotate((-90, 0, 0))
    block = box(-12, 12, -12, height + 1, -12, 12) - rod(6, -13, 13, 64)
    return shaft, block - box(-1, 9, 0, height + 2, -9, 9)


def relisted(made, rng):
    """The part with its vertices and facets in another order."""
    mesh, order = made.mesh, rng.permutation(len(made.mesh.vertices))
    faces = np.argsort(order)[mesh.faces][rng.permutation(len(mesh.faces))]
    faces = np.stack([np.roll(face, k) for face, k in zip(faces, rng.integers(0, 3, len(faces)), strict=True)])
    digest = hashlib.sha256(mesh.vertices[order].tobytes() + faces.tobytes()).hexdigest()
    return replace(made, mesh=replace(mesh, vertices=mesh.vertices[order], faces=faces, digest=digest))


def answer(solids, X, scale, rng=None):
    """Type, status and freedoms of the joint of two solids, its axis in their frame, and the kinds of its contact."""
    parts = [part(name, solid, X, scale) for name, solid in zip("ab", solids, strict=True)]
    if rng is not None:
        parts = [relisted(made, rng) for made in parts]
    made = assembly(*parts)
    found = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, found)
    (joint,) = kinematics.derive(made, found, touching).joints
    axis = None if joint.axis is None else np.abs(joint.axis @ X[:3, :3])
    return (joint.type, joint.status, joint.freedoms), sorted(patch.kind for patch in touching.patches), axis


def answers(solids, seed):
    """The answer as drawn, and others that must be the same, with how near to it axes have to be (rad). Facets of a
    leaning pin know its axis to a quarter of a degree, and are others where it is tessellated more finely. Sizes,
    poses and orders change together."""
    rng = np.random.default_rng(seed)
    yield answer(solids, np.eye(4), 1e-3), 0.0
    yield answer(solids[::-1], random_pose(rng, 3e-4), 1e-5, rng), 1e-6
    yield answer(solids, random_pose(rng, 90.0), 3.0), 1e-6
    yield answer([solid.refine(2) for solid in solids], random_pose(rng), 1e-2), 5e-3


def assert_same(solids, seed, wanted):
    (first, _), *others = answers(solids, seed)
    assert first[0] == wanted
    for other, near in others:
        assert other[:2] == first[:2]
        if first[2] is not None:
            assert other[2] == pytest.approx(first[2], abs=near)


@pytest.mark.parametrize("lean", first(1, [(0.25, 0.0), (1.33, 0.01), (0.0, 0.0), (0.05, 0.01), (2.8, 0.0)]))
def test_a_pin_half_let_into_its_plate(lean):
    """Where it leans, and no line of it lies on the walls of its slot, its facets were held against whatever directions
    lie across the plate by the axes of the world: prismatic in some poses, along up to 11° beside the slot, and planar
    in others."""
    assert_same(half_let_in(*lean), 1, ("prismatic", "ambiguous", 1))


@pytest.mark.parametrize("seed", first(1, [10, 11, 12]))
def test_a_line_above_the_middle_of_the_plate_holds_nothing(seed):
    """Its lever is nothing but rounding, beside a way that is none: one of twenty was taken to hold a turn."""
    rng = np.random.default_rng(seed)
    for _ in range(8):
        solids = half_let_in(0.0, rng.choice([0.0, 0.005, 0.01]), 1.0 + 0.8 * rng.random())
        kind, touching, _ = answer(solids, random_pose(rng, 0.0), 10.0 ** rng.uniform(-5, 1))
        assert (kind, touching) == (("prismatic", "ambiguous", 1), ["line", "line", "plane"])


@pytest.mark.parametrize("sizes", first(1, [(0.5, 100), (2.0, 30), (0.8, 100)]))
def test_a_pin_near_the_axis(sizes):
    """Levers were compared with the length of the bore: the shaft was cylindrical, and determined."""
    assert_same(tongue(*sizes), 2, ("prismatic", "ambiguous", 1))


@pytest.mark.parametrize("sizes", first(1, [(1.39, 43.7), (0.87, 53.6), (2.31, 59.1)]))
def test_a_long_pin_in_a_thin_wall(sizes):
    """Samples along the pin missed the wall: the shaft was cylindrical, and determined."""
    assert_same(tube(*sizes), 3, ("prismatic", "ambiguous", 1))


@pytest.mark.parametrize("height", first(1, [40.0, 9.0, 11.0, 20.0]))
def test_a_pin_at_one_wall_holds_nothing_however_long_it_is(height):
    """Its roundness does not oppose a slide along the wall, in neither sense."""
    assert_same(against_a_wall(height), 4, ("cylindrical", "determined", 2))


def in_a_helix(pitch):
    """A cross pin with some play in a slot of the bore that winds about it."""
    wide = 2.3 / np.sin(np.arctan2(pitch / (2 * np.pi), 8.5))
    outline = CrossSection([np.array([[0, -wide / 2], [13, -wide / 2], [13, wide / 2], [0, wide / 2]])])
    turn = 360 * 18 / pitch
    slot = Manifold.extrude(outline, 18, 48, turn).translate((0, 0, -9)).rotate((0, 0, -turn / 2))
    shaft = rod(6, -25, 25, 56, 3.0) + along_x(rod(1, 4, 11, 24, 5.0))
    return shaft, box(-12, 12, -12, 12, -12, 12) - rod(6, -13, 13, 64) - slot


@pytest.mark.parametrize("pitch", first(1, [60, 90]))
def test_a_pin_in_a_helical_slot_does_not_leave_the_shaft_free(pitch):
    """Its facets were left out as strays, being few, and as far from it as play and bend make them: the shaft was
    cylindrical, and determined; then as what blocks it, though they hold it in both senses."""
    assert_same(in_a_helix(pitch), 5, ("fixed", "ambiguous", 0))


def test_an_eccentric_of_no_more_than_the_play_holds_nothing():
    shaft = rod(5.9, 0, 40, 56, 3.0) + rod(0.5, -3, 1, 32).translate((0.08, 0, 0))
    block = box(-12, 12, -12, 12, -6, 30) - rod(6, -1, 50, 64) - box(-3, 3, -0.5, 0.5, -4, 1)
    assert answer((shaft, block), np.eye(4), 1e-3)[:2] == (("cylindrical", "determined", 2), ["cylinder"])
