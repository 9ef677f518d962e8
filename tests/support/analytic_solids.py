"""Extrusions and revolutions whose surfaces are known by construction: contacts tested without recovery."""

from __future__ import annotations

import hashlib
import itertools
import math

import numpy as np
from manifold3d import triangulate

from kinform.model.assembly import Assembly, Assumption, Group, Mesh, MeshHealth, Part, Source
from kinform.model.function import Function
from kinform.model.names import PartName
from kinform.model.surfaces import MeshSurfaces, Surface
from kinform.model.tolerances import Tolerances

SOURCE = Source("test.toml", 1)
MM = 1e-3


def surface(kind, faces, areas, *, axis=(0, 0, 0), point=(0, 0, 0), radius=0.0, half_angle=0.0, side=1,
            extent=(0.0, 0.0), chord=0.0, uncertainty=1e-9):  # fmt: skip
    """A surface with the given geometry; area from its facets."""
    return Surface(
        kind=kind,
        axis=np.array(axis, dtype=float),
        point=np.array(point, dtype=float),
        radius=radius,
        half_angle=half_angle,
        side=side,
        area=float(areas[faces].sum()),
        extent=extent,
        sweep=0.0,
        residual=1e-9,
        axis_uncertainty=uncertainty,
        point_uncertainty=uncertainty,
        chord=chord,
        faces=np.array(faces, dtype=np.int64),
    )


class Shape:
    """A mesh (m) under construction, with the surface of each facet."""

    def __init__(self):
        self.vertices, self.faces, self.labels, self.specs = [], [], [], []

    def spec(self, **values):
        self.specs.append(values)
        return len(self.specs) - 1

    def add(self, triangles, label):
        for triangle in triangles:
            start = len(self.vertices)
            self.vertices += [np.asarray(corner, dtype=float) for corner in triangle]
            self.faces.append([start, start + 1, start + 2])
            self.labels.append(label)

    def build(self):
        """(Mesh, MeshSurfaces), welded."""
        points = np.array(self.vertices)
        _, first, inverse = np.unique(
            np.round(points / 1e-9).astype(np.int64), axis=0, return_index=True, return_inverse=True
        )
        vertices, faces = points[first], inverse.ravel()[np.array(self.faces)]
        corners = vertices[faces]
        cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        areas = 0.5 * np.linalg.norm(cross, axis=1)
        volume = float(np.einsum("ij,ij->i", corners[:, 0], cross).sum() / 6.0)
        labels = np.array(self.labels, dtype=np.int64)
        digest = hashlib.sha256(vertices.tobytes() + faces.tobytes()).hexdigest()
        health = MeshHealth(len(faces), len(vertices), True, True, "NoError", volume, 0, 0, 0, 0, 1, 1e-9)
        surfaces = tuple(
            surface(faces=np.nonzero(labels == k)[0], areas=areas, **spec) for k, spec in enumerate(self.specs)
        )
        mesh = Mesh(vertices, faces.astype(np.int64), health, "test.stl", None, digest)
        return mesh, MeshSurfaces(digest, surfaces, labels, 0.0)


def circle(radius, count, phase=0.0, centre=(0.0, 0.0)):
    """(count, 2) counter-clockwise."""
    angles = phase + 2.0 * math.pi * np.arange(count) / count
    return np.array(centre) + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def round_loop(radius, count, phase=0.0, centre=(0.0, 0.0)):
    """A loop that is one cylinder."""
    return circle(radius, count, phase, centre), [("round", tuple(centre), radius)] * count


def flat_loop(points):
    """A loop of flat walls."""
    return np.asarray(points, dtype=float), [("flat", k) for k in range(len(points))]


def box_loop(x0, y0, x1, y1):
    """A rectangle."""
    return flat_loop([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def extrusion(outer, holes=(), z0=0.0, z1=1.0, uncertainty=1e-9):
    """Solid between two planes: loops (points in m, keys), all given counter-clockwise."""
    shape = Shape()
    loops = [(outer[0], outer[1], 1)] + [(p[::-1], k[::-1][1:] + k[::-1][:1], -1) for p, k in holes]
    flat = [points for points, _, _ in loops]
    all_points = np.concatenate(flat)
    caps = triangulate([p / MM for p in flat])
    for z, sign in ((z0, -1), (z1, 1)):
        label = shape.spec(kind="plane", axis=(0, 0, sign), point=(0, 0, z), uncertainty=uncertainty)
        corners = np.concatenate([all_points, np.full((len(all_points), 1), z)], axis=1)[caps]
        shape.add(corners if sign > 0 else corners[:, ::-1], label)
    for points, keys, side in loops:
        known = {}
        for k, key in enumerate(keys):
            p, q = points[k], points[(k + 1) % len(points)]
            if key not in known:
                known[key] = _wall(shape, key, p, q, side, z0, z1, uncertainty)
            a, b = (*p, z0), (*q, z0)
            c, d = (*q, z1), (*p, z1)
            shape.add([(a, b, c), (a, c, d)], known[key])
    return shape.build()


def _wall(shape, key, p, q, side, z0, z1, uncertainty):
    along = np.subtract(q, p)
    if key[0] == "flat":
        normal = np.array([along[1], -along[0], 0.0]) / np.linalg.norm(along)
        return shape.spec(kind="plane", axis=normal, point=(*p, z0), uncertainty=uncertainty)
    _, centre, radius = key
    chord = radius - math.sqrt(radius**2 - 0.25 * float(along @ along))
    half = 0.5 * (z1 - z0)
    return shape.spec(kind="cylinder", axis=(0, 0, 1), point=(*centre, z0 + half), radius=radius, side=side,
                      extent=(-half, half), chord=chord, uncertainty=uncertainty)  # fmt: skip


def revolution(profile, count, phase=0.0, arcs=None, uncertainty=1e-9):
    """Solid of revolution about z: profile (r, z) in m, counter-clockwise in the (r, z) half-plane.

    `arcs`: {segment index: (key, centre height, radius)} for segments of a sphere.
    """
    shape, arcs, known = Shape(), arcs or {}, {}
    profile = [np.array(p, dtype=float) for p in profile]
    angles = phase + 2.0 * math.pi * np.arange(count + 1) / count
    for k, p in enumerate(profile):
        q = profile[(k + 1) % len(profile)]
        if p[0] == 0.0 and q[0] == 0.0:
            continue
        key = arcs[k][0] if k in arcs else k
        if key not in known:
            known[key] = _turned(shape, p, q, arcs.get(k), count, uncertainty)
        for one, two in itertools.pairwise(angles):
            two = angles[0] if two == angles[-1] else two
            ring = [(r * math.cos(t), r * math.sin(t), z) for r, z in (p, q) for t in (one, two)]
            a, b, c, d = ring[0], ring[1], ring[3], ring[2]
            shape.add([t for t, r in (((a, b, c), p[0]), ((a, c, d), q[0])) if r > 0.0], known[key])
    return shape.build()


def _turned(shape, p, q, arc, count, uncertainty):
    along = q - p
    outward = np.array([along[1], -along[0]]) / np.linalg.norm(along)
    step = 1.0 - math.cos(math.pi / count)
    if arc is not None:
        _, height, radius = arc
        side = 1 if outward @ (0.5 * (p + q) - np.array([0.0, height])) > 0 else -1
        span = np.linalg.norm(along)
        chord = radius * step + radius - math.sqrt(radius**2 - 0.25 * span**2)
        return shape.spec(kind="sphere", point=(0, 0, height), radius=radius, side=side, chord=chord,
                          uncertainty=uncertainty)  # fmt: skip
    side = 1 if outward[0] > 0 else -1
    if abs(along[1]) < 1e-12:
        return shape.spec(kind="plane", axis=(0, 0, np.sign(outward[1])), point=(0, 0, p[1]),
                          uncertainty=uncertainty)  # fmt: skip
    if abs(along[0]) < 1e-12:
        half = 0.5 * abs(along[1])
        return shape.spec(kind="cylinder", axis=(0, 0, 1), point=(0, 0, 0.5 * (p[1] + q[1])), radius=p[0],
                          side=side, extent=(-half, half), chord=p[0] * step,
                          uncertainty=uncertainty)  # fmt: skip
    slope = along[0] / along[1]
    apex = p[1] - p[0] / slope
    opening = math.copysign(1.0, slope)
    heights = sorted(abs(z - apex) for z in (p[1], q[1]))
    angle = math.atan(abs(slope))
    return shape.spec(kind="cone", axis=(0, 0, opening), point=(0, 0, apex), half_angle=angle, side=side,
                      extent=tuple(heights), chord=max(p[0], q[0]) * step * math.cos(angle),
                      uncertainty=uncertainty)  # fmt: skip


def pose(rotation=None, translation=(0, 0, 0)):
    """(4, 4)."""
    X = np.eye(4)
    X[:3, :3] = np.eye(3) if rotation is None else rotation
    X[:3, 3] = translation
    return X


def turned(axis, degrees):
    """Rotation matrix about an axis through the origin."""
    a = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    k = np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
    t = math.radians(degrees)
    return np.eye(3) + math.sin(t) * k + (1 - math.cos(t)) * k @ k


def assembly(parts, *, groups=(), ignore=(), tolerances=None):
    """(Assembly, surfaces) of {name: (mesh and surfaces, pose)}."""
    listed, surfaces = [], {}
    for name in sorted(parts):
        (mesh, own), X_WP = parts[name]
        surfaces[mesh.digest] = own
        listed.append(Part(PartName(name), mesh, X_WP, True, None, None, None, "m", SOURCE))
    return (
        Assembly(
            name="test",
            units="m",
            parts=tuple(listed),
            groups=tuple(Group(n, tuple(PartName(p) for p in members), SOURCE) for n, members in groups),
            assumptions=tuple(Assumption(pair, None, True, None, None, None, "said so", SOURCE) for pair in ignore),
            ground=None,
            tolerances=tolerances or Tolerances(),
            infer_fasteners=False,
            function=Function(),
            simulation=None,
            subassemblies=(),
            source=SOURCE,
            files=(),
        ),
        surfaces,
    )
