"""Copies of a mesh in other poses."""

from __future__ import annotations

import hashlib
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.meshes import of_manifold
from support.solids import block, centred_rod

from kinform.model.tolerances import Tolerances
from kinform.surfaces import recover, rigid_copies, surfaces_of_copy


def bracket(**keys):
    solid = (
        block(0.05, 0.03, 0.01)
        - centred_rod(0.006, 0.02, 40).translate((0.012, 0.004, 0))
        + centred_rod(0.004, 0.03, 32).translate((-0.015, -0.005, 0.01))
    )
    return named(of_manifold(solid, **keys))


def named(mesh):
    return replace(mesh, digest=hashlib.sha256(mesh.vertices.tobytes() + mesh.faces.tobytes()).hexdigest())


def pose(seed):
    X = np.eye(4)
    X[:3, :3] = Rotation.random(random_state=seed).as_matrix()
    X[:3, 3] = np.random.default_rng(seed).normal(size=3)
    return X


def by_digest(*meshes):
    return {mesh.digest: mesh for mesh in meshes}


@pytest.mark.parametrize("rounding", [False, True])
def test_what_is_moved_is_what_would_be_found(rounding):
    first, second = bracket(rounding=rounding), bracket(pose=pose(4), rounding=rounding)
    meshes = by_digest(first, second)
    ((digest, copy),) = rigid_copies(meshes).items()
    assert copy.of == min(meshes) != digest
    given = surfaces_of_copy(recover(meshes[copy.of], Tolerances()), digest, copy)
    found = recover(meshes[digest], Tolerances())
    assert given.digest == digest
    assert len(given.surfaces) == len(found.surfaces)
    for one in given.surfaces:
        (other,) = (s for s in found.surfaces if np.array_equal(s.faces, one.faces))
        assert one.kind == other.kind
        assert np.linalg.norm(one.axis - other.axis) <= one.axis_uncertainty + other.axis_uncertainty + 1e-9
        assert one.extent == pytest.approx(other.extent, abs=1e-6)
        assert one.radius == pytest.approx(other.radius, abs=1e-6)
        assert (given.labels[one.faces] == given.labels[one.faces[0]]).all()


def test_the_mirror_image_and_another_size_are_no_copies():
    first = bracket()
    mirror = named(replace(first, vertices=first.vertices * [-1.0, 1.0, 1.0]))
    larger = named(replace(first, vertices=first.vertices * 1.001))
    bent = first.vertices.copy()
    bent[0] += 1e-5
    assert rigid_copies(by_digest(first, mirror, larger, named(replace(first, vertices=bent)))) == {}


def test_all_copies_are_of_the_lowest_digest():
    meshes = by_digest(*(bracket(pose=pose(seed)) for seed in range(5)))
    copies = rigid_copies(meshes)
    assert len(copies) == 4
    assert {copy.of for copy in copies.values()} == {min(meshes)}


def test_symmetric_shapes_are_copies_too():
    cube = named(of_manifold(block(0.01, 0.01, 0.01)))
    turned = named(of_manifold(block(0.01, 0.01, 0.01), pose=pose(2)))
    assert len(rigid_copies(by_digest(cube, turned))) == 1


def test_copies_are_found_by_the_rounding_of_their_files():
    """Where a mesh lies far from the origin of its file, its frame is moved there, and its coordinates are small."""
    step, origin = 2.0**-20, np.array([8.0, 0.0, 0.0])
    first = replace(bracket(), origin=origin)
    moved = first.vertices @ pose(6)[:3, :3].T
    rounded = named(replace(first, vertices=np.round(moved / step) * step))
    assert len(rigid_copies(by_digest(first, rounded))) == 1
    near = [replace(mesh, origin=np.zeros(3)) for mesh in (first, rounded)]
    assert rigid_copies(by_digest(*near)) == {}
    bent = rounded.vertices.copy()
    bent[3] += 4.0 * step
    assert rigid_copies(by_digest(first, named(replace(rounded, vertices=bent)))) == {}


def test_what_coarse_numbers_still_tell_apart_are_no_copies():
    """A radius is better known than one vertex: shafts that differ by a step of their files are two shafts."""
    rods = [named(of_manifold(centred_rod(radius, 0.02, 40))) for radius in (5.0e-3, 5.01e-3)]
    assert rigid_copies(by_digest(*(replace(rod, resolution=1e-5) for rod in rods))) == {}


def test_a_copy_is_one_of_the_first_shape_that_it_fits():
    """Of many shapes, some hardly larger than others, as if each were asked about alone."""
    shapes = [replace(bracket(), vertices=bracket().vertices * (1.0 + 4e-7 * k)) for k in range(12)]
    turns = [pose(seed)[:3, :3] for seed in range(3)]
    meshes = by_digest(*(named(replace(one, vertices=one.vertices @ turn.T)) for one in shapes for turn in turns))
    wanted, originals = {}, []
    for digest in sorted(meshes):
        fits = [other for other in originals if rigid_copies({k: meshes[k] for k in (other, digest)})]
        if fits:
            wanted[digest] = fits[0]
        else:
            originals.append(digest)
    assert {digest: copy.of for digest, copy in rigid_copies(meshes).items()} == wanted
    assert 3 < len(originals) < len(meshes) - 3
