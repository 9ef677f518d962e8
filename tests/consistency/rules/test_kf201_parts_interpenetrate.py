"""In a description links may overlap a little where a joint joins them, or what is fixed to them (KF201)."""

from __future__ import annotations

import pytest
from support.solids import box, rod, save

from kinform import stages

LINK = '<link name="{0}"><visual><geometry><mesh filename="{0}.stl"/></geometry></visual></link>'
JOINT = """<joint name="{0}" type="{1}"><parent link="{2}"/><child link="{3}"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>"""
ARM = box(-60, 10, -10, 10, 0, 5)
FOOT = box(-6, 6, -6, 60, 3.9, 9)
SHIN = box(-6, 6, 40, 60, 9, 20)


def severities(folder, joints):
    """Of the overlap of the arm and the foot, by 1.1 mm."""
    for name, solid in {"arm": ARM, "foot": FOOT, "shin": SHIN, "tool": rod(2, 20, 30).translate((0, 50, 0))}.items():
        save(solid, folder / f"{name}.stl", 1e-3)
    links = "".join(LINK.format(name) for name in ("arm", "foot", "shin", "tool"))
    path = folder / "robot.urdf"
    path.write_text(f'<robot name="r">{links}{"".join(JOINT.format(*joint) for joint in joints)}</robot>')
    design = stages.mass(stages.joints(stages.contacts(stages.import_(path))))
    report = stages.check(stages.simulate(design, ranges=False)).report
    return [f.severity for f in report.singles if f.code == "KF201" and set(f.subject) == {"arm.stl", "foot.stl"}]


@pytest.mark.parametrize(
    ("joints", "severity"),
    [
        ([("knee", "revolute", "arm", "foot"), ("weld", "fixed", "foot", "shin")], "note"),
        ([("knee", "revolute", "arm", "shin"), ("weld", "fixed", "shin", "foot")], "note"),
        ([("knee", "revolute", "arm", "shin"), ("ankle", "revolute", "shin", "foot")], "warning"),
    ],
    ids=["joined", "what is fixed to it is", "with another between"],
)
def test_a_joint_of_what_is_fixed_to_a_link_is_a_joint_of_the_link(tmp_path, joints, severity):
    assert severities(tmp_path, [*joints, ("grip", "revolute", "shin", "tool")]) == [severity]
