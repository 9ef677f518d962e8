"""Bodies that touch in a way that is not known are not said to miss each other (KF401)."""

from __future__ import annotations

import pytest
from support.solids import box, save

from kinform import stages

URDF = """<robot name="r">
<link name="base"><visual><geometry><mesh filename="base.stl"/></geometry></visual></link>
<link name="mast"><visual><geometry><mesh filename="mast.stl"/></geometry></visual></link>
<joint name="lift" type="prismatic"><parent link="base"/><child link="mast"/><axis xyz="0 0 1"/>
<limit lower="-0.05" upper="0" effort="1" velocity="1"/></joint></robot>
"""
BASE = box(-40, 40, -40, 40, 0, 53) - box(-21, 21, -21, 21, 3, 60)


@pytest.mark.parametrize("scale", [0.1, 1.0, 10.0])
@pytest.mark.parametrize(("gap", "missing"), [(0.0, False), (4.0, True)])
def test_a_mast_that_is_drawn_out_to_the_rim_of_its_well_may_touch_it(tmp_path, gap, missing, scale):
    for name, solid in (("base", BASE), ("mast", box(-21, 21, -21, 21, 53 + gap, 106))):
        save(solid, tmp_path / f"{name}.stl", scale * 1e-3)
    path = tmp_path / "robot.urdf"
    path.write_text(URDF)
    design = stages.mass(stages.joints(stages.contacts(stages.import_(path))))
    report = stages.check(stages.simulate(design, ranges=False)).report
    assert [f.code for f in report.findings if f.code == "KF401"] == ["KF401"] * missing
    assert "inconclusive" not in {rule.outcome for rule in report.rules}
    assert report.answers == (("no contact" if missing else "undecided", 1),)
