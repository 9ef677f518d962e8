"""A joint is of the wrong type where a step proves it; what blocks at the hub of an actuator is an attachment."""

from __future__ import annotations

import numpy as np
import pytest
from support.diagonal import diagonal
from support.solids import box, rod, save

from kinform import stages

LINK = '<link name="{0}"><visual><geometry><mesh filename="{0}.stl"/></geometry></visual></link>'
URDF = """<robot name="r">{links}
<joint name="output" type="{type}"><parent link="{parent}"/><child link="{child}"/><axis xyz="{axis}"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>
"""
ARM = box(-11, 11, -8, 52, 3.05, 7)
MOTOR = box(-12, 12, -12, 28, -26, 0) + rod(10, -1, 3, 96)
SQUARE = box(-12, 12, -12, 28, -26, 0) + box(-9, 9, -9, 9, -1, 3)


def around(solid, count, radius, phase=20.0):
    """Copies of a solid round the axis."""
    out = solid.translate((radius, 0, 0)).rotate((0, 0, phase))
    for k in range(1, count):
        out += solid.translate((radius, 0, 0)).rotate((0, 0, phase + 360.0 * k / count))
    return out


def bolted(motor, count, radius):
    pins, holes = rod(1.2, -1.5, 4, 48), rod(1.25, -2, 4, 48)
    return motor - around(holes, count, radius), ARM + around(pins, count, radius)


FLAT = rod(4, 2, 7, 64) - box(2.8, 9, -9, 9, 1, 8)
LUG = box(38, 46, -4, 4, 0, 8)
HUBS = {
    "four bolts": bolted(MOTOR, 4, 7),
    "two bolts": bolted(MOTOR, 2, 7),
    "bolts in a square output": bolted(SQUARE, 3, 6),
    "flat": (MOTOR + FLAT, ARM - (rod(4.05, 2, 8, 64) - box(2.85, 9, -9, 9, 1, 9))),
    "square": (MOTOR + box(-3, 3, -3, 3, 2, 7), ARM - box(-3.05, 3.05, -3.05, 3.05, 2, 8)),
}


def described(folder, solids, *, scale=1.0, kind="revolute", axis="0 0 1", turned=False):
    """The report on a description of two links."""
    names = ("motor", "arm")
    for name, solid in zip(names, solids, strict=True):
        save(solid, folder / f"{name}.stl", scale * 1e-3)
    parent, child = names[::-1] if turned else names
    links = "\n".join(map(LINK.format, names))
    path = folder / "robot.urdf"
    path.write_text(URDF.format(links=links, type=kind, parent=parent, child=child, axis=axis))
    return report_of(path)


def report_of(path):
    design = stages.mass(stages.joints(stages.contacts(stages.import_(path))))
    return stages.check(stages.simulate(design, ranges=False)).report


def found(report):
    """Findings of the rule, and its outcome."""
    (outcome,) = (rule.outcome for rule in report.rules if rule.code == "KF402")
    return [finding for finding in report.findings if finding.code == "KF402"], outcome


@diagonal(len(HUBS), name=list(HUBS), scale=[1.0, 0.1, 20.0], turned=[False, True])
def test_what_is_fastened_to_the_output_of_an_actuator_is_no_error(tmp_path, name, scale, turned):
    findings, outcome = found(described(tmp_path, HUBS[name], scale=scale, turned=turned))
    # one that the joints stage cannot decide is not compared at all
    assert {finding.severity for finding in findings} <= {"note"}
    assert outcome == "passed"  # doubts of descriptions leave nothing undecided


def test_the_note_is_there_where_contact_is_decided(tmp_path):
    (note,), _ = found(described(tmp_path, HUBS["four bolts"]))
    assert (note.severity, note.witness) == ("note", None)


@pytest.mark.parametrize("scale", [1.0, 0.1])
def test_what_blocks_beside_the_hub_is_an_error(tmp_path, scale):
    motor = box(-12, 60, -12, 12, -26, 0) + rod(10, -1, 3, 96) + LUG
    arm = box(-11, 60, -11, 11, 3.05, 7) - box(37.95, 46.05, -4.05, 4.05, 2, 9)
    (error,), outcome = found(described(tmp_path, (motor, arm), scale=scale))
    assert (error.severity, outcome) == ("error", "failed")
    assert error.witness.kind == "geometric"
    assert error.witness.parts_back == error.witness.parts_ahead == ("arm.stl", "motor.stl")
    assert error.witness.twist == pytest.approx([0, 0, 1, 0, 0, 0])
    assert error.witness.step[0] < 0.0 < error.witness.step[1]
    assert np.hypot(*error.witness.place_ahead[:2]) > 0.03 * scale


CORNER = box(-20, 0, -20, 60, -20, 40) + box(-20, 60, -20, 0, -20, 40) + box(-20, 60, -20, 60, -20, 0)
BLOCK = box(0, 30, 0, 25, 0, 20)


CHANNEL = box(-40, 0, 0, 80, -10, 30) + box(20, 60, 0, 80, -10, 30) + box(-40, 60, 0, 80, -10, 0)
SLIDER = box(0.05, 19.95, 10, 60, 0, 25)


@pytest.mark.parametrize(
    ("solids", "kind", "axis", "severities"),
    [
        ((CHANNEL, SLIDER), "revolute", "0 0 1", ["error"]),
        ((CHANNEL, SLIDER), "prismatic", "0 1 0", []),
        ((CORNER, BLOCK), "prismatic", "1 0 0", []),
        ((CORNER, BLOCK), "prismatic", "1 1 0", []),
        ((CORNER, BLOCK), "prismatic", "1 -1 0", ["error"]),
        ((CORNER, BLOCK), "prismatic", "1 0.5 -0.2", ["error"]),
        ((CORNER, BLOCK), "revolute", "0 0 1", ["error"]),
    ],
    ids=[
        "turned into both walls",
        "along them",
        "out of a corner",
        "out of it askew",
        "into either wall of a corner",
        "into a wall or the floor",
        "turned into walls",
    ],
)
def test_a_motion_into_walls_both_ways_is_an_error_and_one_away_from_them_is_none(
    tmp_path, solids, kind, axis, severities
):
    findings, _ = found(described(tmp_path, solids, kind=kind, axis=axis))
    assert [finding.severity for finding in findings] == severities
    assert all(finding.witness.kind == "geometric" for finding in findings)


MANIFEST = """schema = 1
[assembly]
name = "g"
units = "mm"
ground = "base"
[[part]]
name = "base"
mesh = "base.stl"
[[part]]
name = "shaft"
mesh = "shaft.stl"
[[group]]
name = "all"
parts = ["base", "shaft"]
[[function.joint]]
name = "turn"
between = ["base", "shaft"]
type = "revolute"
axis = [0, 0, 1]
point = [0, 0, 0]
"""


def test_a_group_of_both_sides_contradicts_by_what_it_says(tmp_path):
    save(rod(12, 0, 30, 64) - rod(6.05, -1, 31, 64), tmp_path / "base.stl")
    save(rod(6, -5, 35, 64), tmp_path / "shaft.stl")
    (tmp_path / "m.toml").write_text(MANIFEST)
    (error,), _ = found(report_of(tmp_path / "m.toml"))
    assert error.severity == "error"
    assert (error.witness.kind, error.witness.source_file, error.witness.source_line) == ("textual", "m.toml", 12)
