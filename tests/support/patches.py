"""Contact patches with known geometry, sampled analytically, for tests of the kinematics."""

from __future__ import annotations

import numpy as np

from kinform.model.contacts import Patch

Z = np.array([0.0, 0.0, 1.0])


def patch(
    points, normals, kind, *, parts=("a", "b"), axis=Z, point=(0, 0, 0), area=1e-4, gap=0.0, radii=(0.0, 0.0),
    uncertainty=(1e-9, 1e-12), one_sided=False, misalignment=0.0, offset=0.0, chord=0.0,
):  # fmt: skip
    points = np.asarray(points, float)
    return Patch(
        parts=parts,
        surfaces=(0, 0),
        kind=kind,
        one_sided=one_sided,
        points=points,
        normals=np.broadcast_to(np.asarray(normals, float), points.shape).copy(),
        gaps=np.full(len(points), gap),
        weights=np.full(len(points), area / len(points)),
        area=area,
        gap=gap,
        axis=np.asarray(axis, float),
        point=np.asarray(point, float),
        radii=radii,
        misalignment=misalignment,
        offset=offset,
        uncertainty=uncertainty,
        chord=chord,
        fit="touch",
    )


def frame_of(axis):
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    u = np.cross(np.eye(3)[int(np.argmin(np.abs(axis)))], axis)
    u /= np.linalg.norm(u)
    return u, np.cross(axis, u), axis


def cylinder(radius=0.005, length=0.02, axis=Z, point=(0, 0, 0), arc=(0.0, 2 * np.pi), outward=1, **keys):
    """Shaft of a in a bore of b (outward=+1), or the reverse (−1)."""
    u, v, w = frame_of(axis)
    angle = np.linspace(*arc, 24, endpoint=False) + 0.1
    height = np.linspace(-length / 2, length / 2, 5)
    t, h = (x.ravel() for x in np.meshgrid(angle, height))
    n = np.outer(np.cos(t), u) + np.outer(np.sin(t), v)
    points = np.asarray(point, float) + radius * n + np.outer(h, w)
    keys.setdefault("area", radius * (arc[1] - arc[0]) * length)
    return patch(
        points,
        outward * n,
        "cylinder",
        axis=w,
        point=point,
        radii=(radius, radius + keys.get("gap", 0.0)),
        **keys,
    )


def plane(centre=(0, 0, 0), normal=Z, size=(0.02, 0.03), spin=0.0, **keys):
    """Rectangle with its normal out of a."""
    u, v, w = frame_of(normal)
    c, s = np.cos(spin), np.sin(spin)
    u, v = c * u + s * v, c * v - s * u
    x, y = (g.ravel() for g in np.meshgrid(np.linspace(-0.5, 0.5, 6), np.linspace(-0.5, 0.5, 6)))
    points = np.asarray(centre, float) + np.outer(x * size[0], u) + np.outer(y * size[1], v)
    keys.setdefault("area", size[0] * size[1])
    return patch(points, w, "plane", axis=w, point=centre, **keys)


def ring(centre=(0, 0, 0), normal=Z, inner=0.005, outer=0.008, **keys):
    """Annulus with its normal out of a."""
    u, v, w = frame_of(normal)
    t, r = (g.ravel() for g in np.meshgrid(np.linspace(0, 2 * np.pi, 24, endpoint=False), np.linspace(inner, outer, 3)))
    points = np.asarray(centre, float) + np.outer(r * np.cos(t), u) + np.outer(r * np.sin(t), v)
    keys.setdefault("area", np.pi * (outer**2 - inner**2))
    return patch(points, w, "plane", axis=w, point=centre, **keys)


def sphere(radius=0.008, centre=(0, 0, 0), cap=1.0, axis=Z, **keys):
    """Ball of a in a socket of b; `cap` is the lowest z over radius that is covered, from −1."""
    u, v, w = frame_of(axis)
    k = np.arange(200) + 0.5
    z = 1 - 2 * k / 200
    t = np.pi * (1 + 5**0.5) * k
    s = np.sqrt(1 - z * z)
    n = np.outer(s * np.cos(t), u) + np.outer(s * np.sin(t), v) + np.outer(z, w)
    n = n[z <= cap]
    keys.setdefault("area", 2 * np.pi * radius**2 * (1 + cap))
    return patch(
        np.asarray(centre, float) + radius * n,
        n,
        "sphere",
        axis=np.zeros(3),
        point=centre,
        radii=(radius,) * 2,
        **keys,
    )


def cone(radius=0.005, half_angle=0.2, length=0.01, **keys):
    """Cone about z of a in b, apex below."""
    apex = -radius / np.tan(half_angle)
    t, h = (g.ravel() for g in np.meshgrid(np.linspace(0, 2 * np.pi, 24, endpoint=False), np.linspace(0, length, 5)))
    r = radius + h * np.tan(half_angle)
    radial = np.stack([np.cos(t), np.sin(t), 0 * t], 1)
    n = np.cos(half_angle) * radial - np.sin(half_angle) * Z
    points = r[:, None] * radial + h[:, None] * Z
    keys.setdefault("area", 2 * np.pi * radius * length)
    return patch(points, n, "cone", axis=Z, point=(0, 0, apex), radii=(half_angle,) * 2, **keys)
