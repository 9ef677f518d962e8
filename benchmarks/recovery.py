"""How well cylinders are recovered, over many random ones: `python benchmarks/recovery.py [TRIALS]`.

Prints, for vertices in double precision, the worst errors of axis and radius, and for single precision a
metre away from the origin, how often the error lies within the uncertainty that the surface states.
"""

from __future__ import annotations

import sys

import numpy as np
from scipy.spatial.transform import Rotation

from kinform.model.assembly import Mesh, MeshHealth
from kinform.model.tolerances import Tolerances
from kinform.surfaces import recover


def cylinder(rng):
    """(vertices, faces, axis, point on the axis, radius) of a closed cylinder or of a half shell's outside."""
    segments = int(rng.integers(12, 257))
    radius = 10 ** rng.uniform(-3, -0.5)
    height = radius * 10 ** rng.uniform(-0.5, 1)
    angle = 2 * np.pi * (np.arange(segments) + rng.uniform()) / segments
    ring = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    low = np.column_stack([ring, np.zeros(segments)])
    vertices = np.concatenate([low, low + [0, 0, height]])
    here, following = np.arange(segments), (np.arange(segments) + 1) % segments
    fan = np.arange(1, segments - 1)
    first = np.zeros_like(fan)
    faces = np.concatenate(
        [
            np.column_stack([here, following, segments + following]),
            np.column_stack([here, segments + following, segments + here]),
            np.column_stack([first, fan + 1, fan]),
            np.column_stack([first + segments, fan + segments, fan + segments + 1]),
        ]
    )
    turn = Rotation.random(random_state=int(rng.integers(2**31))).as_matrix()
    return vertices @ turn.T, faces, turn[:, 2], radius


def as_mesh(vertices, faces, resolution=0.0):
    health = MeshHealth(len(faces), len(vertices), True, True, "NoError", 1.0, 0, 0, 0, 0, 1, 1e-7)
    return Mesh(vertices, faces, health, "random", None, "random", resolution=resolution)


def found(vertices, faces, resolution=0.0):
    """The largest cylinder of the mesh, whose coordinates go in steps of `resolution` (m)."""
    surfaces = recover(as_mesh(vertices, faces, resolution), Tolerances()).surfaces
    return next((s for s in surfaces if s.kind == "cylinder"), None)


def tilt(surface, axis):
    return float(np.arctan2(np.linalg.norm(np.cross(surface.axis, axis)), abs(surface.axis @ axis)))


def aside(surface, axis, point):
    """Distance of the true axis from the surface's point."""
    offset = point - surface.point
    return float(np.linalg.norm(offset - (offset @ axis) * axis))


def main(trials: int) -> None:
    rng = np.random.default_rng(20260101)
    worst_axis = worst_radius = 0.0
    missed = inside = 0
    for _ in range(trials):
        vertices, faces, axis, radius = cylinder(rng)
        exact = found(vertices, faces)
        if exact is None:
            missed += 1
        else:
            worst_axis = max(worst_axis, tilt(exact, axis))
            worst_radius = max(worst_radius, abs(exact.radius / radius - 1))
        offset = rng.normal(size=3)
        offset /= np.linalg.norm(offset)
        stored = (vertices + offset).astype(np.float32).astype(np.float64)
        rounded = found(stored, faces, float(np.finfo(np.float32).eps * np.abs(stored).max()))
        if rounded is not None:
            inside += (
                tilt(rounded, axis) <= rounded.axis_uncertainty
                and aside(rounded, axis, offset) <= rounded.point_uncertainty
            )
    print(f"{trials} cylinders of 12 to 256 segments, radius 1 to 316 mm, no cylinder found in {missed}")
    print(f"double precision: axis within {worst_axis:.1e} rad, radius within {worst_radius:.1e}")
    print(f"single precision, 1 m away: axis and place within the stated uncertainty in {100 * inside / trials:.2f} %")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000)
