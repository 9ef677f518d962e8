"""`mimic` of a robot description against the gears of its meshes: the ratio, and its sign by the axes."""

from __future__ import annotations

import pytest
from support.gear_trains import gear_pair
from support.solids import save

import kinform

RATIO = -20 / 30
"""Turn of the second wheel for one of the first."""

LINK = """<link name="{name}"><visual><geometry><mesh filename="{name}.stl" scale="{scale} {scale} {scale}"/></geometry>
</visual></link>"""
ROBOT = """<robot name="gears">{links}
<joint name="drive" type="continuous"><parent link="housing"/><child link="gear0"/><axis xyz="0 0 1"/></joint>
<joint name="driven" type="continuous"><parent link="housing"/><child link="gear1"/><origin xyz="{apart} 0 0"/>
<axis xyz="{axis}"/><mimic joint="drive" multiplier="{ratio}"/></joint></robot>"""


@pytest.fixture(scope="module")
def gears(tmp_path_factory):
    """A folder with the meshes, in mm; the second wheel about its own axis."""
    folder = tmp_path_factory.mktemp("gears")
    for name, solid in gear_pair(20, 30).items():
        save(solid.translate((-25, 0, 0)) if name == "gear1" else solid, folder / f"{name}.stl")
    return folder


@pytest.mark.parametrize(
    ("ratio", "axis", "scale", "wrong"),
    [
        (-RATIO, "0 0 -1", 1e-3, False),
        (1.01 * RATIO, "0 0 1", 1e-3, True),
        pytest.param(RATIO, "0 0 1", 1e-3, False, marks=pytest.mark.sweep),
        pytest.param(RATIO, "0 0 1", 0.1, False, marks=pytest.mark.sweep),
        pytest.param(-RATIO, "0 0 1", 1e-3, True, marks=pytest.mark.sweep),
    ],
)
def test_the_ratio_of_mimic_is_that_of_the_teeth(gears, ratio, axis, scale, wrong):
    links = "".join(LINK.format(name=name, scale=scale) for name in ("housing", "gear0", "gear1"))
    robot = gears / "robot.urdf"
    robot.write_text(ROBOT.format(links=links, apart=25 * scale, axis=axis, ratio=repr(ratio)))
    done = kinform.run(robot, ranges=False)
    found = [(f.code, f.found) for f in done.findings if f.code in ("KF411", "KF903")]
    assert [code for code, _ in found] == (["KF411"] if wrong else []), found
    # contact of teeth still constrains nothing where all joints are stated
    assert done.design.kinematics.mobility.effective == 2
