"""Races of bearings: grooves round an axis, whose strips between two meridians lie on a cylinder across it."""

from __future__ import annotations

import numpy as np
import pytest
from random_assemblies.lathe import turned
from support.diagonal import diagonal
from support.solids import part, random_pose

from kinform import surfaces
from kinform.model.tolerances import Tolerances


def race(radius, tube, rings, segments, half, *, outside):
    """A ring whose groove, of this tube, is deepest at the radius; `rings` in the profile, to `half` rad either way."""
    angles = np.linspace(-half, half, rings)
    sense = 1.0 if outside else -1.0
    arc = [(radius - sense * tube * (1.0 - np.cos(a)), tube * np.sin(a)) for a in angles]
    lip, wide, far = arc[0][0], 2.0 * tube, radius + sense * 2.0 * tube
    if outside:
        return turned([(lip, -wide), (far, -wide), (far, wide), (lip, wide), *arc[::-1]], segments)
    return turned([(far, -wide), (lip, -wide), *arc, (lip, wide), (far, wide)], segments)


@diagonal(
    6,
    tube=[1.0, 2.5],
    profile=[(7, 0.9), (11, 1.0), (16, 1.2)],
    segments=[24, 48, 98, 24],
    outside=[True, False, False],
)
def test_a_race_is_one_torus(tube, profile, segments, outside):
    rings, half = profile
    rng = np.random.default_rng(segments + rings)
    X = random_pose(rng)
    mesh = part("race", race(12.0, tube, rings, segments, half, outside=outside), X).mesh
    found = surfaces.recover(mesh, Tolerances()).surfaces
    assert sorted(s.kind for s in found) == ["cylinder", "cylinder", "plane", "plane", "torus"]
    (torus,) = (s for s in found if s.kind == "torus")
    assert torus.minor_radius == pytest.approx(tube * 1e-3, rel=1e-6)
    assert torus.radius == pytest.approx((12.0 - tube if outside else 12.0 + tube) * 1e-3, rel=1e-6)
    assert abs(torus.axis @ X[:3, 2]) == pytest.approx(1.0, abs=1e-9)
    assert torus.side == -1
