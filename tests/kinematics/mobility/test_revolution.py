"""Shapes that turn onto themselves, and shapes that do not, however they are placed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold
from support.assemblies import assembly
from support.diagonal import diagonal
from support.solids import ball, block, box, extrusion, part, random_pose, rod

from kinform import surfaces
from kinform.kinematics.mobility.revolution import revolution_of
from kinform.model.tolerances import Tolerances

PIN = rod(3, 0, 20)
HOLE = rod(3, -50, 50)
TURNS = np.linspace(0, 2 * np.pi, 60, endpoint=False)
WHEEL = rod(20, 0, 6) - rod(4, -1, 7)


def flats(count, across, z0, z1):
    """A prism of so many sides, by its width across flats."""
    return rod(across / 2 / np.cos(np.pi / count), z0, z1, count)


CURVE = [(6 + 1.5 * np.sin(z / 5), z) for z in np.linspace(0, 30, 30)]
KNOB = Manifold.revolve(CrossSection([np.array([(0, 0), *CURVE, (0, 30)])]), 40)


ROUND = {
    "pin": PIN,
    "headed pin": PIN + rod(5, 20, 23),
    "tube": rod(8, 0, 10) - HOLE,
    "pin with a point": (PIN + ball(3).translate((0, 0, 20))) - box(-9, 9, -9, 9, -9, -1),
    "ball stud": ball(10) + rod(4, 0, 40),
    "ball with a bore": ball(10) - HOLE,
    "ball with a flat": ball(10) - box(-20, 20, -20, 20, 7, 20),
    "coarse pin": rod(3, 0, 20, 8) + rod(5, 20, 23, 8),
    "hexagon screw": PIN + flats(6, 10, 20, 24),
    "socket head screw": PIN + rod(5, 20, 25) - flats(6, 5, 22, 26),
    "nut": flats(6, 10, 0, 5) - HOLE,
    "coarse nut": flats(6, 10, 0, 5) - rod(3, -1, 6, 8),
}
OTHERS = {
    "block": block(10, 20, 30),
    "block with a bore": block(20, 20, 20) - HOLE,
    "eccentric": rod(10, 0, 5) + rod(4, 5, 20).translate((0.5, 0, 0)),
    "crank disc": rod(20, 0, 5) + rod(3, 5, 15).translate((14, 0, 0)),
    "wheel with lugs": WHEEL + box(19, 22, -2, 2, 0, 6) + box(-22, -19, -2, 2, 0, 6),
    "wheel with a spoke missing": WHEEL - rod(2, -1, 7).translate((12, 0, 0)),
    "shaft with a flat": rod(5, 0, 40) - box(4, 9, -9, 9, 30, 41),
    "shaft with a keyway": rod(5, 0, 40) - box(3, 9, -1, 1, 20, 30),
    "pin with a cross hole": PIN - rod(1, -9, 9).rotate((90, 0, 0)).translate((0, 0, 10)),
    "square head": PIN + box(-5, 5, -5, 5, 20, 24),
    "hexagon bar": flats(6, 10, 0, 30),
    "half a pin": PIN - box(0, 9, -9, 9, -1, 21),
    "half a coarse pin": rod(3, 0, 20, 8) - box(0, 9, -9, 9, -1, 21),
    "ball with a lever": ball(10) + box(-2, 2, -3, 3, 0, 30),
    "cam": extrusion([(r * np.cos(a), r * np.sin(a)) for a in TURNS if (r := 8 + 2 * np.cos(a))], 0, 6),
    "leaf": rod(5, 0, 10) + box(3, 40, -1, 1, 0, 10) - HOLE,
}
POSES = [(0, 1e-3), (None, 1e-3), (1, 1.0)]


def found(solid, pose=(None, 1e-3), name="shape", scatter=0.0):
    """What turns leave the shape as it is, and the pose that it has."""
    seed, scale = pose
    X = np.eye(4) if seed is None else random_pose(np.random.default_rng(seed))
    made = part(name, solid, X, scale)
    noise = scatter * scale * np.random.default_rng(7).normal(size=made.mesh.vertices.shape)
    made = replace(made, mesh=replace(made.mesh, vertices=made.mesh.vertices + noise))
    fitted = {made.mesh.digest: surfaces.recover(made.mesh, Tolerances())}
    return revolution_of([made], fitted), X


@diagonal(name=list(ROUND), pose=POSES)
def test_bare_solids_of_revolution_and_fasteners_turn_about_their_axis(name, pose):
    shape, X = found(ROUND[name], pose)
    assert shape is not None and shape.axis is not None
    assert shape.is_about(X[:3, 2], X[:3, 3], 0.0, 0.0)
    assert not shape.is_about(X[:3, 0], X[:3, 3], 0.0, 0.0)


@diagonal(name=list(OTHERS), pose=POSES)
def test_what_is_seen_to_turn_does_not(name, pose):
    assert found(OTHERS[name], pose)[0] is None


@pytest.mark.parametrize("scatter", [0.0, 0.003])
def test_a_ball_turns_about_every_axis_through_its_centre(scatter):
    shape, X = found(ball(10), (0, 1e-3), scatter=scatter)
    assert shape is not None and shape.axis is None
    assert np.linalg.norm(shape.point - X[:3, 3]) < 1e-5


ROUGH = {"headed pin": ROUND["headed pin"], "hexagon screw": ROUND["hexagon screw"], "ball": ball(10)}


@diagonal(scatter=[0.003, 0.01], name=list(ROUGH))
def test_scattered_vertices_hide_no_revolution(name, scatter):
    assert found(ROUGH[name], scatter=scatter)[0] is not None


@diagonal(scatter=[0.003, 0.01], name=["eccentric", "shaft with a flat", "pin with a cross hole", "wheel with lugs"])
def test_nor_do_they_make_one(name, scatter):
    assert found(OTHERS[name], scatter=scatter)[0] is None


def test_slivers_of_a_chamfer_are_asked_which_way_they_face():
    """Scattered, pieces whose axes nobody knows have 16 % of the area."""
    outline = [(0, 0), (4.5, 0), (5, 0.5), (5, 9.5), (4.5, 10), (0, 10)]
    chamfered = Manifold.revolve(CrossSection([np.array(outline)]), 40)
    assert found(chamfered, scatter=0.01)[0] is not None
    assert found(chamfered - box(4.7, 9, -9, 9, -1, 11), scatter=0.01)[0] is None


def test_a_lobe_of_a_rough_shape_is_seen():
    """An oval of a tenth, all of it scattered: lumps are told from noise by what they have in common."""
    oval = KNOB.scale((1.0, 0.9, 1.0))
    assert found(oval, scatter=0.01)[0] is None


SLOTTED = PIN + rod(5, 20, 23) - box(-9, 9, -0.6, 0.6, 21.8, 24)


@pytest.mark.parametrize(("name", "turns"), [("M6 screw", True), ("spindle", False)])
def test_a_slot_is_the_drive_of_what_is_named_a_screw(name, turns):
    assert (found(SLOTTED, name=name)[0] is not None) == turns


def test_a_name_alone_makes_no_screw():
    assert found(OTHERS["leaf"], name="M6 screw")[0] is None


@pytest.mark.parametrize(
    ("other", "turns"),
    [
        (rod(5, 20, 23) - rod(1, 19, 24), True),
        (flats(6, 10, 20, 25) - HOLE, True),
        ((rod(5, 20, 23)).translate((1, 0, 0)), False),
        (box(-5, 5, -5, 5, 20, 23), False),
    ],
)
def test_parts_that_are_one_body_turn_about_a_common_axis(other, turns):
    X = random_pose(np.random.default_rng(3))
    made = assembly(part("pin", PIN, X), part("other", other, X))
    fitted = {one.mesh.digest: surfaces.recover(one.mesh, made.tolerances) for one in made.parts}
    assert (revolution_of(made.parts, fitted) is not None) == turns


def test_a_part_without_a_mesh_is_not_known_to_be_round():
    made = part("pin", PIN, np.eye(4))
    fitted = {made.mesh.digest: surfaces.recover(made.mesh, Tolerances())}
    assert revolution_of([made, replace(made, mesh=None)], fitted) is None
    assert revolution_of([made], {}) is None
