"""The integrals of a solid without symmetry; and shells of one mesh: what they weigh together, and what is said where
they cannot be the faces of one solid."""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.solids import ball, block

import kinform
from kinform.api import Assembly
from kinform.mass.solids import integrate_solid

DENSITY = 1000.0


@pytest.mark.parametrize("place", [(0.0, 0.0, 0.0), (100.0, -50.0, 7.0)])
def test_the_integrals_of_a_corner_are_its_closed_forms(place):
    """x, y, z ≥ 0 and x + y + z ≤ 1: ∫x = 1/24, ∫x² = 1/60, ∫xy = 1/120."""
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) + place
    found = integrate_solid(vertices, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))
    assert found.volume == pytest.approx(1 / 6, rel=1e-9)
    np.testing.assert_allclose(found.centroid, np.array(place) + 0.25, rtol=1e-12)
    about_corner = np.eye(3) / 24 - np.full((3, 3), 1 / 120)
    c = np.full(3, 0.25)
    np.testing.assert_allclose(found.inertia, about_corner - (c @ c * np.eye(3) - np.outer(c, c)) / 6, atol=1e-9)


def shell(solid, at=(0.0, 0.0, 0.0), inward=False):
    mesh = solid.to_mesh64()
    faces = np.asarray(mesh.tri_verts, dtype=np.int64)
    return np.asarray(mesh.vert_properties)[:, :3] + np.asarray(at), faces[:, ::-1] if inward else faces


def together(*shells):
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in shells)])
    faces = [faces + start for (_, faces), start in zip(shells, starts, strict=False)]
    return np.concatenate([vertices for vertices, _ in shells]), np.concatenate(faces)


def judged(mesh):
    """Mass (kg) of a part of 1 kg/m³ times a thousand, its bound, and the findings about its mesh."""
    results = kinform.run(Assembly.from_meshes({"part": mesh}, units="m", density=DENSITY))
    findings = {f.code: f.severity for f in results.findings if f.code in ("KF101", "KF102", "KF103", "KF107")}
    mass = results.mass["part"]
    return None if mass.mass is None else mass.mass / DENSITY, mass.mass_bound, findings


CUBE, CORE, GRAIN = block(1, 1, 1), block(0.4, 0.4, 0.4), block(0.2, 0.2, 0.2)
SOUND = {
    "a cavity": (together(shell(CUBE), shell(CORE, inward=True)), 0.936),
    "a core in a cavity": (together(shell(CUBE), shell(CORE, inward=True), shell(GRAIN)), 0.944),
    "two pieces": (together(shell(CUBE), shell(CUBE, (3.0, 0.1, 0.2))), 2.0),
    "pieces flush on each other": (together(shell(CUBE), shell(CORE, (0.7, 0.01, 0.02))), 1.064),
    "a thin wall": (together(shell(CUBE), shell(block(0.9999, 0.9999, 0.9999), inward=True)), 1.0 - 0.9999**3),
}
TWICE = {
    "crossing": (together(shell(CUBE), shell(CUBE, (0.5, 0.1, 0.0))), 2.0 - 0.5 * 0.9),
    "inside": (together(shell(CUBE), shell(CORE)), 1.0),
    "meant as a cavity": (together(shell(CUBE), shell(CORE)), 0.936),
    "half out": (together(shell(ball(1.0)), shell(CORE, (1.0, 0.0, 0.0))), None),
}
INVERTED = {
    "a piece": together(shell(CUBE), shell(CORE, (3.0, 0.1, 0.2), inward=True)),
    "a piece as large as the rest": together(shell(CUBE), shell(CUBE, (3.0, 0.1, 0.2), inward=True)),
    "one with a collar about it": together(shell(block(0.2, 0.2, 3.0), inward=True), shell(CUBE)),
    "the largest": together(shell(CUBE, inward=True), shell(CORE, (3.0, 0.1, 0.2))),
}


@pytest.mark.parametrize("case", SOUND)
def test_shells_that_bound_one_solid_weigh_what_it_does(case):
    mesh, volume = SOUND[case]
    mass, bound, findings = judged(mesh)
    assert mass == pytest.approx(volume, rel=1e-9)
    assert bound < 1e-6
    assert findings == {"KF107": "note"}


@pytest.mark.parametrize("case", TWICE)
def test_what_shells_share_is_within_the_bound_of_the_mass_and_said(case):
    mesh, volume = TWICE[case]
    mass, bound, findings = judged(mesh)
    assert findings == {"KF107": "warning"}
    if volume is not None:
        assert abs(mass - volume) <= bound * mass * (1.0 + 1e-9)


@pytest.mark.parametrize("case", INVERTED)
def test_a_shell_that_is_inside_out_is_an_error_and_leaves_no_mass(case):
    mass, _, findings = judged(INVERTED[case])
    assert mass is None
    assert findings == {"KF102": "error", "KF107": "note"}
