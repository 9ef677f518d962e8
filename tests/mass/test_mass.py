"""Mass properties against closed forms, and under motions, scalings and permutations of the input."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinform.mass import compile_mass
from kinform.mass.principal import impossible, principal
from kinform.model.assembly import Assembly, MassOverride, Mesh, MeshHealth, Part, Source
from kinform.model.function import Function
from kinform.model.kinematics import Body, ConstraintMatrix, Kinematics, Misfit, Mobility
from kinform.model.surfaces import MeshSurfaces, Surface
from kinform.model.tolerances import Tolerances

HERE = Source("made.toml", 1)
BOX_FACES = np.array(
    [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7],
     [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]]
)  # fmt: skip


def mesh(vertices, faces, digest="shape", **health):
    facts = {
        "facets": len(faces), "vertices": len(vertices), "watertight": True, "consistent_winding": True,
        "manifold_status": "NoError", "volume": 1.0, "degenerate_facets": 0, "duplicate_facets": 0, "open_edges": 0,
        "overused_edges": 0, "shells": 1, "weld": 0.0,
    }  # fmt: skip
    return Mesh(np.asarray(vertices, float), np.asarray(faces), MeshHealth(**facts | health), "m.stl", None, digest)


def box(x, y, z, at=(0, 0, 0), **health):
    corners = np.array([[i, j, k] for k in (-0.5, 0.5) for j in (-0.5, 0.5) for i in (-0.5, 0.5)])
    return mesh(corners * [x, y, z] + np.asarray(at, float), BOX_FACES, digest=f"box{x}{y}{z}{at}", **health)


def prism(n, radius, height):
    """Right prism over a regular n-gon that is inscribed in a circle."""
    angle = 2 * np.pi * np.arange(n) / n
    ring = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    low = np.column_stack([ring, np.full(n, -height / 2)])
    high = np.column_stack([ring, np.full(n, height / 2)])
    ends = [[0, 0, -height / 2], [0, 0, height / 2]]
    faces = []
    for k in range(n):
        m = (k + 1) % n
        faces += [[k, m, n + m], [k, n + m, n + k], [2 * n, m, k], [2 * n + 1, n + k, n + m]]
    return mesh(np.vstack([low, high, ends]), np.array(faces), digest=f"prism{n}")


def ball(radius, n=24):
    """Latitudes and longitudes on a sphere."""
    points, faces = [[0, 0, radius]], []
    for i in range(1, n):
        t = np.pi * i / n
        for k in range(2 * n):
            f = np.pi * k / n
            points.append([radius * np.sin(t) * np.cos(f), radius * np.sin(t) * np.sin(f), radius * np.cos(t)])
    points.append([0, 0, -radius])
    for k in range(2 * n):
        m = (k + 1) % (2 * n)
        faces.append([0, 1 + k, 1 + m])
        for i in range(n - 2):
            a, b = 1 + 2 * n * i, 1 + 2 * n * (i + 1)
            faces += [[a + k, b + k, b + m], [a + k, b + m, a + m]]
        last = 1 + 2 * n * (n - 2)
        faces.append([last + k, len(points) - 1, last + m])
    return mesh(np.array(points), np.array(faces), digest=f"ball{n}")


def part(shape, name="a", density=1000.0, X_WP=None, **more):
    values = {"solid": True, "material": None, "override": None, "units": "m", "source": HERE} | more
    return Part(name, shape, X_WP=np.eye(4) if X_WP is None else X_WP, density=density, **values)


def compiled(*parts, bodies=None, surfaces=None):
    """Mass report of parts, each its own body unless `bodies` lists names of parts."""
    none = np.zeros(0, dtype=np.int64)
    groups = bodies or [[p.name] for p in parts]
    made = tuple(Body(names[0], tuple(sorted(names)), k == 0) for k, names in enumerate(groups))
    kinematics = Kinematics(
        made, (), ConstraintMatrix((), np.zeros(0), none, np.zeros(1, dtype=np.int64), none, none, np.zeros(3), 1.0),
        Mobility(0, None, 0, 0, 0, 0, np.zeros((0, len(made), 6)), (), ()), Misfit(),
    )  # fmt: skip
    assembly = Assembly(
        "a", "m", tuple(sorted(parts, key=lambda p: p.name)), (), (), None, Tolerances(), False, Function(),
        None, (), HERE, (),
    )  # fmt: skip
    return compile_mass(assembly, kinematics, surfaces)


def only(report):
    (properties,) = report.parts
    return properties


def rotation(seed):
    q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return q * np.sign(np.linalg.det(q))


def pose(R, p):
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = R, p
    return X


@pytest.mark.parametrize("at", [(0, 0, 0), (1, -1, 1), (0.3, 1.7, -0.9)])
def test_a_box_is_exact_to_1e_12_also_a_metre_from_the_origin(at):
    x, y, z = 0.011, 0.023, 0.007
    found = only(compiled(part(box(x, y, z, at), density=7850.0)))
    mass = 7850.0 * x * y * z
    assert found.mass == pytest.approx(mass, rel=1e-12)
    np.testing.assert_allclose(found.centre_of_mass, at, rtol=0, atol=1e-14)
    expected = mass / 12 * np.diag([y * y + z * z, x * x + z * z, x * x + y * y])
    np.testing.assert_allclose(found.inertia, expected, rtol=1e-12, atol=1e-12 * expected.max())
    assert found.mass_bound == 0.0
    assert found.origin == "geometry"


def test_a_tetrahedron_has_its_textbook_inertia():
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    found = only(compiled(part(mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]), density=6.0)))
    assert found.mass == pytest.approx(1.0, rel=1e-14)
    np.testing.assert_allclose(found.centre_of_mass, [0.25] * 3, rtol=1e-14)
    # ∫x² = 1/60 and ∫xy = 1/120 over the unit tetrahedron, about its corner.
    second = 6 * (np.eye(3) / 60 + (1 - np.eye(3)) / 120) - np.full((3, 3), 1 / 16)
    np.testing.assert_allclose(found.inertia, np.trace(second) * np.eye(3) - second, rtol=1e-12)


@pytest.mark.parametrize("n", [12, 32, 96])
def test_a_tessellated_cylinder_is_the_prism_exactly_and_the_cylinder_within_its_bound(n):
    radius, height = 0.01, 0.03
    found = only(compiled(part(prism(n, radius, height))))
    area = n / 2 * radius**2 * math.sin(2 * math.pi / n)
    assert found.volume == pytest.approx(area * height, rel=1e-12)
    axial = 1000 * area * height * radius**2 / 6 * (2 + math.cos(2 * math.pi / n))
    assert found.inertia[2, 2] == pytest.approx(axial, rel=1e-12)
    lacking = 1 - found.volume / (math.pi * radius**2 * height)
    assert lacking < found.mass_bound < 4 * lacking


def test_recovered_surfaces_give_the_same_bound_as_the_turn_across_edges():
    n, radius, height = 24, 0.01, 0.03
    shape = prism(n, radius, height)
    sagitta = radius * (1 - math.cos(math.pi / n))
    side = 2 * n * radius * math.sin(math.pi / n) * height
    wall = Surface(
        "cylinder", np.eye(3)[2], np.zeros(3), radius, 0.0, 1, side, (-0.015, 0.015), 6.28, 0.0, 0.0, 0.0,
        sagitta, np.arange(0),
    )  # fmt: skip
    known = {shape.digest: MeshSurfaces(shape.digest, (wall,), np.zeros(len(shape.faces), dtype=np.int64), 0.0)}
    with_surfaces = only(compiled(part(shape), surfaces=known)).mass_bound
    assert with_surfaces == pytest.approx(sagitta * side / only(compiled(part(shape))).volume, rel=1e-12)
    assert only(compiled(part(shape))).mass_bound == pytest.approx(with_surfaces, rel=1e-9)


def test_a_tessellated_ball_is_a_ball_within_its_bound():
    found = only(compiled(part(ball(0.02))))
    mass = 1000 * 4 / 3 * math.pi * 0.02**3
    assert 0 < 1 - found.mass / mass < found.mass_bound < 0.05
    np.testing.assert_allclose(found.inertia, 0.4 * mass * 0.02**2 * np.eye(3), atol=0.03 * mass * 0.02**2)


def test_a_hole_is_subtracted():
    outer, inner = box(0.02, 0.02, 0.02), box(0.01, 0.01, 0.01, (0.002, 0, 0))
    both = mesh(np.vstack([outer.vertices, inner.vertices]), np.vstack([outer.faces, inner.faces[:, ::-1] + 8]))
    found = only(compiled(part(both)))
    assert found.volume == pytest.approx(8e-6 - 1e-6, rel=1e-12)
    assert found.centre_of_mass[0] == pytest.approx(-0.002 * 1e-6 / 7e-6, rel=1e-9)


@given(
    seed=st.integers(0, 10_000),
    shift=st.tuples(*[st.floats(-2, 2)] * 3),
    scale=st.floats(0.01, 100.0),
)
@settings(max_examples=25, deadline=None)
def test_mass_follows_rotation_translation_and_scale(seed, shift, scale):
    shape = box(0.03, 0.02, 0.05, (0.01, 0.02, -0.03))
    plain = only(compiled(part(shape)))
    R, p = rotation(seed), np.asarray(shift)
    larger = replace(shape, vertices=scale * shape.vertices)
    moved = only(compiled(part(larger, X_WP=pose(R, p))))
    assert moved.mass == pytest.approx(scale**3 * plain.mass, rel=1e-12)
    np.testing.assert_allclose(moved.centre_of_mass, scale * R @ plain.centre_of_mass + p, atol=1e-13 * (scale + 2))
    expected = scale**5 * R @ plain.inertia @ R.T
    np.testing.assert_allclose(moved.inertia, expected, atol=1e-12 * expected.max())
    np.testing.assert_allclose(moved.principal_moments, scale**5 * plain.principal_moments, rtol=1e-10)


def test_order_of_facets_and_names_of_parts_change_nothing():
    shape = ball(0.02, 8)
    order = np.random.default_rng(0).permutation(len(shape.faces))
    other = replace(shape, faces=np.roll(shape.faces[order], 1, axis=1), digest="other")
    a, b = only(compiled(part(shape))), only(compiled(part(other, name="z")))
    assert b.mass == pytest.approx(a.mass, rel=1e-13)
    np.testing.assert_allclose(b.inertia, a.inertia, atol=1e-13 * a.inertia.max())


def test_a_body_is_the_sum_of_its_parts():
    halves = [part(box(0.01, 0.02, 0.03, (x, 1, 1)), name) for x, name in ((0.995, "a"), (1.005, "b"))]
    report = compiled(*halves, bodies=[["a", "b"]])
    whole = only(compiled(part(box(0.02, 0.02, 0.03, (1, 1, 1)))))
    (body,) = report.bodies
    assert report.valid
    assert body.mass == pytest.approx(whole.mass, rel=1e-12)
    np.testing.assert_allclose(body.centre_of_mass, whole.centre_of_mass, atol=1e-14)
    np.testing.assert_allclose(body.inertia, whole.inertia, atol=1e-12 * whole.inertia.max())


@pytest.mark.parametrize(
    "bad",
    [
        part(box(1, 1, 1, watertight=False, open_edges=3)),
        part(box(1, 1, 1, consistent_winding=False)),
        part(box(1, 1, 1), density=None),
        part(box(1, 1, 1), solid=False),
        part(box(1, 1, 0)),
        part(replace(box(1, 1, 1), faces=BOX_FACES[:, ::-1])),
        part(None),
    ],
    ids=["not watertight", "wound inconsistently", "no density", "not solid", "no volume", "inside out", "no mesh"],
)
def test_what_has_no_mass_says_why_and_so_does_its_body(bad):
    good = part(box(1, 1, 2), "b")
    report = compiled(bad, good, bodies=[["a", "b"]])
    found = next(p for p in report.parts if p.name == "a")
    assert found.mass is None
    assert found.reason
    assert np.isnan(found.inertia).all()
    assert report.problems == (("a", found.reason),)
    assert report.bodies[0].mass is None
    assert "a" in report.bodies[0].reason
    assert not report.valid


def test_stated_values_go_before_geometry_and_turn_with_the_part():
    stated = MassOverride(2.0, np.array([0.1, 0, 0]), np.diag([1.0, 2.0, 2.5]))
    R = rotation(3)
    report = compiled(part(box(1, 1, 1), override=stated, X_WP=pose(R, [1, 2, 3])))
    found = only(report)
    assert (found.mass, found.origin, found.mass_bound) == (2.0, "override", 0.0)
    np.testing.assert_allclose(found.centre_of_mass, R @ [0.1, 0, 0] + [1, 2, 3])
    np.testing.assert_allclose(found.inertia, R @ np.diag([1.0, 2.0, 2.5]) @ R.T, atol=1e-15)
    assert report.bodies[0].origin == "override"


@pytest.mark.parametrize(
    ("mass", "inertia", "words"),
    [
        (-1.0, np.eye(3), "not positive"),
        (1.0, np.diag([1.0, 1.0, 3.0]), "triangle"),
        (1.0, np.diag([1.0, 1.0, -1.0]), "negative"),
        (1.0, np.array([[1, 0.5, 0], [0, 1, 0], [0, 0, 1.0]]), "symmetric"),
        (math.nan, np.eye(3), "not a number"),
    ],
)
def test_impossible_stated_values_are_a_problem_and_no_mass(mass, inertia, words):
    report = compiled(part(None, override=MassOverride(mass, np.zeros(3), inertia)))
    assert words in impossible(mass, inertia)
    assert only(report).mass is None
    assert words in report.problems[0][1]


def test_a_point_and_a_thin_rod_are_possible():
    assert impossible(1.0, np.zeros((3, 3))) == ""
    assert impossible(1.0, np.diag([0.0, 1.0, 1.0])) == ""


@given(seed=st.integers(0, 10_000))
@settings(max_examples=25, deadline=None)
def test_principal_axes_diagonalise_are_right_handed_and_signed(seed):
    R = rotation(seed)
    inertia = R @ np.diag([1.0, 1.5, 2.0]) @ R.T
    moments, axes = principal(inertia)
    np.testing.assert_allclose(moments, [1.0, 1.5, 2.0], rtol=1e-12)
    np.testing.assert_allclose(axes.T @ inertia @ axes, np.diag(moments), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    for k in (0, 1):
        largest = np.flatnonzero(np.abs(axes[:, k]) >= np.abs(axes[:, k]).max() - 1e-3)[0]
        assert axes[largest, k] > 0


def test_axes_of_equal_moments_are_those_of_the_world():
    noise = 1e-13 * np.array([[0, 1, 2], [1, 0, 1], [2, 1, 0]])
    np.testing.assert_allclose(principal(np.eye(3) + noise)[1], np.eye(3), atol=1e-12)
    _, axes = principal(np.diag([2.0, 2.0, 1.0]) + noise)
    np.testing.assert_allclose(axes[:, 0], [0, 0, 1], atol=1e-9)
    np.testing.assert_allclose(axes[:, 1], [1, 0, 0], atol=1e-9)
