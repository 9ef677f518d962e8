"""Cylinders and cones whose neighbours lean away from them by less than a smooth edge may turn."""

from __future__ import annotations

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold
from support.assemblies import assembly
from support.diagonal import diagonal
from support.solids import part

from kinform import surfaces


def recovered(solid):
    made = part("a", solid, np.eye(4))
    return surfaces.recover(made.mesh, assembly(made).tolerances).surfaces


def kinds(solid):
    return sorted(surface.kind for surface in recovered(solid))


def turned(outline, segments):
    return Manifold.revolve(CrossSection([np.array(outline, float)]), segments)


@diagonal(5, ratio=[0.3, 0.58, 0.62, 0.66, 0.7, 0.74, 0.9], half=[45, 59, 60, 75, 85], segments=[24, 96])
def test_a_frustum_is_a_cone_between_planes_however_long_it_is(segments, half, ratio):
    lean = np.radians(half)
    low, high = 30.0 * ratio, 30.0
    solid = Manifold.cylinder((high - low) * np.cos(lean), low * np.sin(lean), high * np.sin(lean), segments)
    found = recovered(solid)
    assert sorted(surface.kind for surface in found) == ["cone", "plane", "plane"]
    cone = next(surface for surface in found if surface.kind == "cone")
    assert cone.half_angle == pytest.approx(lean, abs=1e-6)


@diagonal(
    sizes=[(1, 2), (2, 4), (2, 8), (2, 30), (3, 2), (3, 4), (3, 15)], half=[15, 20, 25, 30, 31, 45], segments=[24, 64]
)
def test_a_pin_with_a_chamfer_is_a_cylinder_and_a_cone(segments, half, sizes):
    chamfer, length = sizes
    top = 10 - chamfer * np.tan(np.radians(half))
    outline = [(0, 0), (10, 0), (10, length), (top, length + chamfer), (0, length + chamfer)]
    found = recovered(turned(outline, segments))
    assert sorted(surface.kind for surface in found) == ["cone", "cylinder", "plane", "plane"]
    cylinder = next(surface for surface in found if surface.kind == "cylinder")
    assert cylinder.radius == pytest.approx(10e-3, rel=1e-9)


@diagonal(half=[45, 59, 60, 65, 70], thick=[3, 6, 12])
def test_a_countersunk_hole_has_its_cone(half, thick):
    deep = 3 / np.tan(np.radians(half))
    outline = [(3, 0), (15, 0), (15, thick), (6, thick), (3, thick - deep)]
    if deep > thick - 0.2:
        outline = outline[:3] + [(6, thick), (6 - 0.5 * thick * np.tan(np.radians(half)), 0.5 * thick)]
        outline[0] = (outline[-1][0], 0)
    assert kinds(turned(outline, 24)) == ["cone", "cylinder", "cylinder", "plane", "plane"]
