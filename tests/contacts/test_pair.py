"""Whatever two surfaces meet, at whatever poses, sizes and scatter: no stage raises, and none warns."""

from __future__ import annotations

import dataclasses
import math
import warnings

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from manifold3d import CrossSection, Manifold
from scipy.spatial.transform import Rotation
from support.assemblies import assembly
from support.solids import ball, block, part, rod

from kinform import contacts, kinematics, surfaces
from kinform.contacts.higher.rounds import meeting
from kinform.foundation.meshes.surface_table import SurfaceTable
from kinform.model.surfaces import KINDS


def cone(segments):
    return Manifold.cylinder(10, 5, 2, segments)


def torus(segments):
    turn = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    return Manifold.revolve(CrossSection([np.stack([6 + 2 * np.cos(turn), 2 * np.sin(turn)], axis=1)]), segments)


def bored(segments):
    return block(16, 16, 10) - rod(5, -6, 6, segments)


def socket(segments):
    return block(16, 16, 8).translate((0, 0, -4)) - ball(5, segments)


def lobed(segments):
    turn = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    radius = 5 + 0.5 * np.cos(3 * turn)
    return Manifold.extrude(CrossSection([np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=1)]), 8)


SOLIDS = {
    "block": lambda n: block(10, 8, 6), "rod": lambda n: rod(5, -6, 6, n), "ball": lambda n: ball(5, n),
    "cone": cone, "torus": torus, "bored": bored, "socket": socket, "lobed": lobed,
}  # fmt: skip
KIND = st.sampled_from(sorted(SOLIDS))
FACETS = st.sampled_from([3, 5, 8, 12, 13, 24])
NUMBER = st.floats(-1, 1, allow_nan=False)
TURN = st.one_of(
    st.just((0.0, 0.0, 0.0)),
    st.just((0.0, math.pi / 2, 0.0)),
    st.just((0.0, 1e-9, 0.0)),
    st.tuples(NUMBER, NUMBER, NUMBER),
)


def scattered(made, sigma, seed):
    away = np.random.default_rng(seed).normal(size=made.mesh.vertices.shape)
    mesh = dataclasses.replace(made.mesh, vertices=made.mesh.vertices + sigma * away, digest=f"{made.name}{seed}")
    return dataclasses.replace(made, mesh=mesh)


@settings(max_examples=12, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    kinds=st.tuples(KIND, KIND),
    facets=st.tuples(FACETS, FACETS),
    turn=TURN,
    direction=st.tuples(NUMBER, NUMBER, NUMBER),
    away=st.sampled_from([0.0, 0.0, 5.0, 10.0, 10.2]),
    size=st.sampled_from([1e-6, 1e-3, 1.0]),
    ratio=st.sampled_from([1.0, 1.0, 0.98, 0.3]),
    scatter=st.sampled_from([0.0, 0.0, 1e-4, 1e-2, 0.3]),
)
def test_no_pair_of_solids_raises_or_warns(kinds, facets, turn, direction, away, size, ratio, scatter):
    X = np.eye(4)
    X[:3, :3] = Rotation.from_rotvec(turn).as_matrix()
    length = float(np.linalg.norm(direction))
    X[:3, 3] = size * away * (np.array(direction) / length if length > 1e-6 else np.array([1.0, 0.0, 0.0]))
    a = part("a", SOLIDS[kinds[0]](facets[0]), np.eye(4), size)
    b = part("b", SOLIDS[kinds[1]](facets[1]).scale((ratio, ratio, ratio)), X, size)
    if scatter:
        a, b = (scattered(made, scatter * size, k) for k, made in enumerate((a, b)))
    made = assembly(a, b)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = {one.mesh.digest: surfaces.recover(one.mesh, made.tolerances) for one in made.parts}
        kinematics.derive(made, found, contacts.find(made, found))


ROUND = st.sampled_from(["plane", "cylinder", "sphere", "torus"])
VAGUE = st.sampled_from([0.0, 1e-6, 0.5, math.pi / 2])


@settings(max_examples=100, deadline=None)
@given(
    kinds=st.tuples(ROUND, ROUND), turn=TURN, place=st.tuples(NUMBER, NUMBER, NUMBER), vague=st.tuples(VAGUE, VAGUE),
    side=st.sampled_from([1.0, -1.0]),
)  # fmt: skip
def test_no_pair_of_rounds_raises_however_badly_their_axes_are_known(kinds, turn, place, vague, side):
    from kinform.contacts.higher.points_and_lines import parallel_within
    from kinform.contacts.search.pair_view import NearSurfaces, SurfacePair
    from kinform.model.tolerances import Tolerances

    def row(kind, axis, point, uncertainty, side):
        numbers = {name: np.array([0.3]) for name in ("radii", "minor_radii", "half_angles", "pitches")}
        rest = {name: np.zeros(1) for name in ("point_uncertainty", "slacks", "chords", "residuals", "rims", "areas")}
        table = SurfaceTable(
            kinds=np.array([KINDS.index(kind)]), axes=axis[None], points=point[None], sides=np.array([side]),
            axis_uncertainty=np.array([uncertainty]), extents=np.array([[-1.0, 1.0]]), **numbers, **rest,
        )  # fmt: skip
        columns = {field.name: getattr(table, field.name) for field in dataclasses.fields(SurfaceTable)}
        return NearSurfaces(**columns, ids=np.zeros(1, int), lows=-np.ones((1, 3)), highs=np.ones((1, 3)), facets=())

    z = np.array([0.0, 0.0, 1.0])
    first = row(kinds[0], z, np.zeros(3), vague[0], 1.0)
    second = row(kinds[1], Rotation.from_rotvec(turn).apply(z), np.array(place), vague[1], side)
    pair = SurfacePair(first, second, 0, 0)
    met = meeting(pair, parallel_within(pair, Tolerances()), 0.5)
    assert met is None or (np.isfinite(met.points).all() and np.isfinite(met.gaps).all())
