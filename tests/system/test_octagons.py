"""An octagon in an octagonal hole: a coarse shaft or a prism. The function chooses, and the other reading is kept."""

from __future__ import annotations

import pytest
from support.copies import derived
from support.solids import box, rod, save

MANIFEST = """schema = 1
[assembly]
name = "octagon"
units = "mm"
[[part]]
name = "block"
mesh = "block.stl"
[[part]]
name = "shaft"
mesh = "shaft.stl"
"""
STATED = """[[function.joint]]
name = "turn"
between = ["block", "shaft"]
"""
ABOUT_Z = """axis = [0, 0, 1]
point = [0, 0, 0]
"""


def octagon(folder, stated):
    """A spool of eight sides between collars in its matching hole."""
    collars = rod(8.0, 12, 15, 8) + rod(8.0, -15, -12, 8)
    save(rod(5.0, -12, 12, 8) + collars, folder / "shaft.stl")
    save(box(-10, 10, -10, 10, -11.98, 11.98) - rod(5.02, -13, 13, 8), folder / "block.stl")
    (folder / "octagon.toml").write_text(MANIFEST + stated, encoding="utf-8")
    (joint,) = derived(folder / "octagon.toml").kinematics.joints
    return joint


@pytest.mark.parametrize(
    ("stated", "type_", "status"),
    [
        ("", "revolute", "ambiguous"),
        (STATED + 'type = "revolute"\n' + ABOUT_Z, "revolute", "inferred"),
        (STATED + 'type = "fixed"\n', "fixed", "inferred"),
        (STATED + 'type = "cylindrical"\n' + ABOUT_Z, "revolute", "ambiguous"),
    ],
)
def test_the_function_chooses_what_contact_admits_and_nothing_else(tmp_path, stated, type_, status):
    joint = octagon(tmp_path, stated)
    assert (joint.type, joint.status) == (type_, status)
    assert {reading.type for reading in joint.readings} | {joint.type} == {"revolute", "fixed"}
    assert ("function" in joint.evidence) == (status == "inferred")
