"""Threads on any tessellation: one helicoid each, with axis, pitch and hand."""

from __future__ import annotations

import numpy as np
import pytest
from generators.threads import Thread, threaded
from manifold3d import CrossSection, Manifold
from scipy.spatial.transform import Rotation
from support.diagonal import diagonal, first
from support.meshes import kinds, of_manifold
from support.solids import block

from kinform.model.tolerances import Tolerances
from kinform.surfaces import recover
from kinform.surfaces.recovery import _Start
from kinform.surfaces.swept.threads import WIDE, _advances, _distances, _level, _Screw, _with_helices


def posed(seed):
    pose = np.eye(4)
    pose[:3, :3] = Rotation.random(random_state=seed).as_matrix()
    pose[:3, 3] = 0.02 * np.arange(1, 4)
    return pose


def found_on(solid, pose, **keys):
    return recover(of_manifold(solid, pose=pose, scale=1e-3, **keys), Tolerances())


def the_helicoid(found):
    (screw,) = (s for s in found.surfaces if s.kind == "helicoid")
    return screw


def assert_is(screw, lead, pose, angle=1e-9, relative=1e-9):
    assert screw.pitch == pytest.approx(1e-3 * lead, rel=relative)
    assert np.linalg.norm(np.cross(screw.axis, pose[:3, 2])) < angle
    assert np.linalg.norm(np.cross(screw.point - pose[:3, 3], pose[:3, 2])) < max(1e-2 * angle, 1e-11)


@diagonal(4, thread=[(10.0, 1), (-4.0, 1), (8.0, 2), (-12.0, 3), (4.0, 1), (1.0, 1)], segments=[12, 24, 64])
def test_a_screw_has_one_helicoid_with_its_pitch_and_hand(thread, segments):
    lead, starts = thread
    depth = abs(lead) / starts / 2
    pose = posed(segments)
    solid = threaded(Thread(10.0 - depth, 10.0, lead, starts), -12.0, 12.0, segments).manifold
    assert_is(the_helicoid(found_on(solid, pose)), lead, pose)


@pytest.mark.parametrize("lean, root", [(0.0, 8.0), (15.0, 8.0), (30.0, 8.5)])
def test_a_nut_has_one_helicoid_that_faces_the_axis(lean, root):
    tool = threaded(Thread(root, 10.0, 4.0, 1, lean), -9.0, 9.0, 20, 7.0).manifold
    pose = posed(3)
    found = found_on(block(40.0, 40.0, 16.0) - tool, pose)
    screw = the_helicoid(found)
    assert screw.side == -1 or lean == 0.0
    assert_is(screw, 4.0, pose)


def test_flanks_belong_to_the_thread_and_ends_do_not():
    found = found_on(threaded(Thread(8.0, 10.0, 4.0), -12.0, 12.0, 24).manifold, posed(1))
    assert kinds(found) == {"helicoid": 1, "cylinder": 2, "plane": 2}


@pytest.mark.parametrize("seed", first(1, [1, 2]))
def test_single_precision_is_no_matter(seed):
    pose = posed(seed)
    solid = threaded(Thread(8.0, 10.0, -4.0), -12.0, 12.0, 32).manifold
    screw = the_helicoid(found_on(solid, pose, rounding=True))
    assert_is(screw, -4.0, pose, angle=1e-6, relative=1e-6)
    assert np.linalg.norm(np.cross(screw.axis, pose[:3, 2])) <= screw.axis_uncertainty


def test_a_thread_on_a_stem_beside_a_head():
    bolt = threaded(Thread(4.1, 5.0, 1.5, 1, 30.0), -20.0, 0.0, 24).manifold
    bolt += Manifold.cylinder(6.0, 8.0, 8.0, 6).translate((0, 0, -0.01))
    pose = posed(4)
    assert_is(the_helicoid(found_on(bolt, pose)), 1.5, pose, angle=1e-7, relative=1e-7)


@pytest.mark.parametrize("shape", ["fluted", "knurled", "cone"])
def test_what_is_no_thread_has_no_helicoid(shape):
    angle = np.linspace(0, 2 * np.pi, 96, endpoint=False)
    if shape == "cone":
        solid = Manifold.cylinder(20.0, 8.0, 12.0, 48)
    else:
        radius = 10.0 + (0.8 if shape == "fluted" else 0.1) * np.cos(12 * angle)
        outline = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
        solid = Manifold.extrude(CrossSection([outline]), 20.0)
    assert "helicoid" not in kinds(found_on(solid, posed(5)))


@pytest.mark.parametrize("lead, segments", [(1.5, 32), (-4.0, 12), (10.0, 24)])
def test_no_line_that_suggests_an_advance_is_left_out(lead, segments):
    pose = posed(6)
    start = _Start.of(
        of_manifold(threaded(Thread(9.0, 10.0, lead), 0.0, 0.6 * abs(lead), segments).manifold, pose=pose, scale=1e-3),
        Tolerances(),
    )
    draw, about = np.random.default_rng(segments), []
    for far in np.repeat(np.geomspace(1e-6, 1.0, 13), 12):
        axis = pose[:3, 2] + far * draw.normal(size=3)
        place = (pose[:3, 3] - start.centre) / start.span + far * draw.normal(size=3)
        about.append((axis / np.linalg.norm(axis), place))
    work, scale, edges = start.work, start.scale, np.arange(len(start.work.a))
    kept = {id(line): level for line, level in _with_helices(work, edges, about, scale)}
    suggests = set()
    for line in about:
        level = edges[_level(work, edges, _distances(work, [line])[0], WIDE[0], scale)]
        if id(line) in kept:
            assert kept[id(line)].tolist() == level.tolist()
        if _advances(work, level, _Screw(*line, 0.0), scale):
            suggests.add(id(line))
    assert 12 <= len(suggests)
    assert suggests <= kept.keys()
    assert len(kept) < len(about)
