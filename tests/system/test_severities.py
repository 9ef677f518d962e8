"""How grave a finding is follows from its consequence, at every size and in every unit alike."""

from __future__ import annotations

import numpy as np
import pytest
from support.solids import box, rod, save

from kinform import stages

SIZE_ALONE = "KF110"
"""The one rule that knows absolute size."""
SIZES = [(1.0, "mm"), (1e-3, "mm"), (1e3, "mm"), (1.0, "in"), (1.0, "um")]


def judged(path, **options):
    """(code, severity) of all findings but those about size."""
    design = stages.joints(stages.contacts(stages.import_(path)))
    report = stages.check(stages.simulate(stages.mass(design), **options)).report
    return {(finding.code, finding.severity) for finding in report.findings if finding.code != SIZE_ALONE}


def log(folder, depth, scale, units):
    """A log that lies on a block, and goes into it."""
    save(box(-30, 30, -20, 20, -10, 0), folder / "block.stl", scale)
    save(rod(5, -20, 20, 64).rotate((0, 90, 0)).translate((0, 0, 5 - depth)), folder / "log.stl", scale)
    parts = "".join(f'[[part]]\nname = "{name}"\nmesh = "{name}.stl"\n' for name in ("block", "log"))
    (folder / "m.toml").write_text(f'schema = 1\n[assembly]\nname = "m"\nunits = "{units}"\nground = "block"\n{parts}')
    return folder / "m.toml"


@pytest.mark.parametrize(("depth", "severity"), [(0.2, "note"), (2.0, "error")])
@pytest.mark.parametrize(("scale", "units"), SIZES)
def test_an_overlap_within_the_tolerance_of_contact_is_a_note(tmp_path, depth, severity, scale, units):
    found = judged(log(tmp_path, depth, scale, units))
    assert ("KF201", severity) in found
    if severity == "note":
        assert not {code for code, grave in found if grave == "error"}, found


def solids(scale, folder):
    frame = rod(50, -5, 0, 32) + rod(5, 0, 10, 32) + rod(8, 10, 13, 32)
    for angle in np.radians([70.0 + 17.46, -40.0 - 17.46]):
        frame += rod(2, 0, 10, 32).translate((40 * np.cos(angle), 40 * np.sin(angle), 0))
    save(frame, folder / "frame.stl", scale)
    save(box(-10, 50, -10, 10, 0, 10) - rod(5, -1, 11, 32), folder / "lever.stl", scale)


RANGES = [((-0.6, 1.3), "warning"), ((-0.6, 1.9), "error"), ((-0.8, 1.1), "warning"), ((-1.5, 1.1), "error")]
"""rad, stated of a lever that goes from −0.70 to 1.22: one end is 4 % or 28 % short, or 5 % or 31 %."""


def stated(folder, range_, down, scale, described):
    solids(scale, folder)
    sign, low, high = (-1, -range_[1], -range_[0]) if down else (1, *range_)
    if described:
        visual = '<visual><geometry><mesh filename="{0}.stl" scale="0.001 0.001 0.001"/></geometry></visual>'
        (folder / "m.urdf").write_text(
            f'<robot name="r"><link name="frame">{visual.format("frame")}</link>'
            f'<link name="lever">{visual.format("lever")}</link><joint name="swing" type="revolute">'
            f'<parent link="frame"/><child link="lever"/><axis xyz="0 0 {sign}"/>'
            f'<limit lower="{low}" upper="{high}" effort="1" velocity="1"/></joint></robot>'
        )
        return folder / "m.urdf"
    parts = "".join(f'[[part]]\nname = "{name}"\nmesh = "{name}.stl"\n' for name in ("frame", "lever"))
    low, high = np.degrees([low, high])
    joint = (
        f'[[function.joint]]\nname = "swing"\nbetween = ["frame", "lever"]\ntype = "revolute"\n'
        f"axis = [0, 0, {sign}]\npoint = [0, 0, 0]\nrange = [{low}, {high}]\n"
    )
    head = 'schema = 1\n[assembly]\nname = "m"\nunits = "mm"\nground = "frame"\n'
    (folder / "m.toml").write_text(head + parts + joint)
    return folder / "m.toml"


@pytest.mark.parametrize("down", [False, True])
@pytest.mark.parametrize(("range_", "severity"), RANGES)
def test_a_range_of_a_description_is_an_error_where_more_than_a_tenth_is_blocked(tmp_path, range_, severity, down):
    assert ("KF412", severity) in judged(stated(tmp_path, range_, down, 1.0, described=True), ranges=True)


@pytest.mark.parametrize("described", [False, True])
@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_ranges_are_as_grave_at_every_size(tmp_path, described, scale):
    for (range_, severity), down in zip(RANGES[:2], (True, False), strict=True):
        found = judged(stated(tmp_path, range_, down, scale, described), ranges=True)
        assert ("KF412", severity if described else "error") in found
