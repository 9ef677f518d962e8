"""A sleeve on a square bar that leans: a solid of meshes slides by g (sin α − μ cos α), or stays where it is."""

from __future__ import annotations

import math

import pytest
from manifold3d import Manifold
from support.solids import box, save

import kinform

G, LEAN = 9.81, 20.0

MANIFEST = """
schema = 1
[assembly]
name = "slope"
units = "mm"
ground = "bar"
[[part]]
name = "bar"
mesh = "bar.stl"
density = 7800
rpy = [0, 20, 0]
[[part]]
name = "sleeve"
mesh = "sleeve.stl"
density = 7800
rpy = [0, 20, 0]
[function]
[[function.joint]]
name = "slide"
between = ["bar", "sleeve"]
type = "prismatic"
axis = [0.9396926208, 0, -0.3420201433]
[[function.drive]]
joint = "slide"
kind = "friction"
coefficient = MU
[simulation]
duration = 0.3
step = 0.1
"""


@pytest.fixture(scope="module")
def slope(tmp_path_factory):
    folder = tmp_path_factory.mktemp("slope")
    bar = box(-200, 200, -10, 10, -10, 10)
    save(bar, folder / "bar.stl")
    sleeve: Manifold = box(-30, 30, -30, 30, -30, 30) - box(-40, 40, -10, 10, -10, 10)
    save(sleeve, folder / "sleeve.stl")
    return folder


@pytest.mark.parametrize("share", [0.5, 0.9, 1.001])
def test_a_sleeve_slides_as_a_point_would_though_its_bar_is_longer(slope, share):
    """Its guide goes along with it: wherever it is, no moment presses it."""
    slip = math.tan(math.radians(LEAN))
    manifest = slope / f"slope{share}.toml"
    manifest.write_text(MANIFEST.replace("MU", repr(share * slip)))
    run = kinform.run(manifest).simulation
    assert run.status == "done"
    pull = G * math.sin(math.radians(LEAN)) * (1.0 - share)
    expected = 0.5 * max(pull, 0.0) * 0.3**2
    assert abs(float(run.joint_position[-1, 0])) == pytest.approx(expected, rel=1e-5, abs=0.0)
