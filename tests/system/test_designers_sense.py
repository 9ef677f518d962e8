"""Names of the function come with values in the designer's order and sense, wherever they are shown.

A lever on a pin turns between two posts: by 70° against the clock seen from +z, by 40° with it. The same joint is
stated with its bodies in either order, about either sense of its axis, and with names of parts that sort either way.
"""

from __future__ import annotations

import csv
import io
import itertools
import re
import shutil

import numpy as np
import pytest
from rich.console import Console
from support.places import FIXTURES
from support.solids import box, rod, save

from kinform import stages
from kinform.api import Results
from kinform.exports import export
from kinform.reports import summary
from kinform.reports.page import facts
from kinform.reports.page.agreement import rows
from kinform.reports.page.scene import Scene
from kinform.reports.values.topics import joint_evidence
from kinform_cli.views import topics

UP, DOWN, TURNED = 70.0, -40.0, 30.0
"""° about +z, of the lever in the frame: where the posts end the turn, and at the end of the run."""
BESIDE = np.degrees(np.arcsin((10 + 2) / 40))
"""° between the middle of the lever, 20 wide, and that of a post of radius 2 at 40, where they touch."""
STATED = [*itertools.product([("base", "lever"), ("post", "arm")], [False, True], [False, True])]


def solids():
    """The frame with its posts, and the lever."""
    frame = rod(50, -5, 0, 32) + rod(5, 0, 10, 32) + rod(8, 10, 13, 32)
    for angle in np.radians([UP + BESIDE, DOWN - BESIDE]):
        frame += rod(2, 0, 10, 96).translate((40 * np.cos(angle), 40 * np.sin(angle), 0))
    return frame, box(-10, 50, -10, 10, 0, 10) - rod(5, -1, 11, 32)


def judged(folder, names, swapped, down, low=-90.0, high=90.0):
    """The sign of the designer's values against the turn about +z, and the design with findings; ° about +z between
    which the joint is to turn."""
    for name, solid in zip(names, solids(), strict=True):
        save(solid, folder / f"{name}.stl")
    first, second = names[::-1] if swapped else names
    sign = -1 if swapped != down else 1
    wanted = sorted([sign * low, sign * high])
    parts = "".join(f'[[part]]\nname = "{name}"\nmesh = "{name}.stl"\ndensity = 1000\n' for name in names)
    (folder / "lever.toml").write_text(f"""schema = 1
[assembly]
name = "lever"
units = "mm"
ground = "{names[0]}"
{parts}
[[function.joint]]
name = "swing"
between = ["{first}", "{second}"]
type = "revolute"
axis = [0, 0, {-1 if down else 1}]
point = [0, 0, 0]
range = {wanted}
[[function.drive]]
joint = "swing"
kind = "motion"
law = {{type = "ramp", rate = {sign * TURNED}}}
[simulation]
step = 0.1
""")
    design = stages.joints(stages.contacts(stages.import_(folder / "lever.toml")))
    return sign, stages.check(stages.simulate(stages.mass(design), ranges=True))


@pytest.fixture(scope="module", params=STATED, ids=str)
def stated(tmp_path_factory, request):
    """The sign and the design of one statement."""
    return judged(tmp_path_factory.mktemp("lever"), *request.param)


def ends_of(sign):
    """° in the designer's sense."""
    return sorted([sign * UP, sign * DOWN])


def close(range_, sign):
    """Whether both ends (rad) are where the posts are."""
    return np.degrees([range_["lower"], range_["upper"]]) == pytest.approx(ends_of(sign), abs=0.05)


def test_json_has_the_range_the_axis_and_the_order_of_the_designer_beside_its_own(stated):
    sign, design = stated
    (joint,) = summary(design, "joints")["joints"]
    (intended,) = design.assembly.function.joints
    assert joint["intended_name"] == "swing"
    assert joint["intended_bodies"] == list(intended.between)
    assert joint["intended_axis"] == pytest.approx(intended.axis, abs=1e-6)
    assert close(joint["intended_range"], sign)
    own = 1 if joint["bodies"][0] == design.assembly.ground else -1
    assert close(joint["range"], own) and joint["axis"] == pytest.approx((0, 0, 1), abs=1e-6)
    (answer,) = summary(design, "joints")["intended"]
    assert (answer["found_axis"], answer["found_range"]) == (joint["intended_axis"], joint["intended_range"])
    alone = joint_evidence(design, joint["name"])["joint"]
    assert alone["intended_range"] == joint["intended_range"] and alone["range"] == joint["range"]


def test_json_of_the_run_has_positions_and_ranges_in_the_designers_sense(stated):
    sign, design = stated
    told = summary(design, "simulation")
    (course,), (reach,) = told["joints"], told["ranges"]
    assert np.degrees(course["intended_position"]["end"]) == pytest.approx(sign * TURNED)
    assert reach["intended_name"] == "swing"
    assert close({side: reach[f"intended_{side}"]["value"] for side in ("lower", "upper")}, sign)


def test_tables_and_python_have_positions_rates_and_ranges_in_the_designers_sense(stated):
    sign, design = stated
    header, *table = csv.reader(io.StringIO(export(design, "csv").files["joints.csv"].decode()))
    last = dict(zip(header, map(float, table[-1]), strict=True))
    run = Results(design).motion
    assert run.joint_names == ("swing",)
    for position, rate in (
        (last["swing.position"], last["swing.velocity"]),
        (run.joint_position[-1, 0], run.joint_velocity[-1, 0]),
    ):
        assert np.degrees([position, rate]) == pytest.approx([sign * TURNED, sign * TURNED])
    (item,) = run.ranges
    assert close({"lower": item.lower.value, "upper": item.upper.value}, sign)


def printed(design, topic, name=None):
    console = Console(width=200, record=True, file=io.StringIO())
    console.print(topics.render(design, topic, "a.h5") if name is None else topics.render_joint(design, name))
    return console.export_text()


def test_lines_with_the_designers_name_have_the_designers_range(stated):
    sign, design = stated
    own = str(design.kinematics.joints[0].name)
    for text in (printed(design, "joints"), printed(design, "joints", own), printed(design, "simulation")):
        told = [re.findall(r"-?[\d.]+(?=°)", line) for line in text.splitlines() if "swing" in line]
        ranges = [list(map(float, numbers)) for numbers in told if len(numbers) == 2]
        assert ends_of(sign) in [pytest.approx(ends, abs=0.05) for ends in ranges], told
        assert ends_of(-sign) not in [pytest.approx(ends, abs=0.05) for ends in ranges], told


def test_the_page_has_the_range_about_the_designers_axis(stated):
    sign, design = stated
    (row,) = (row for row in rows(design) if row.name == "swing")
    axis = "-z" if design.assembly.function.joints[0].axis[2] < 0 else "z"
    low, high = (f"{end:g}°" for end in ends_of(sign))
    assert f"about {axis} " in row.behaviour and f"about {axis} " in row.function
    assert f"range {low} to {high}" in row.behaviour
    (joint,) = facts.joints(design)
    assert f"about {axis} " in joint.sentence
    assert f"lower: {low}" in dict(joint.facts)["range"] and f"upper: {high}" in dict(joint.facts)["range"]
    assert dict(joint.facts)["between"] == " and ".join(design.assembly.function.joints[0].between)


def shown_at(design, finding, focus):
    """° about +z by which the lever stands in the picture of a finding, and in the movement that the page opens."""
    scene = Scene(design)
    movement = scene.movements[focus.movement]
    assert movement.kind == "freedom"
    turned = movement.at(focus.time)
    lever = next(name for name in ("lever", "arm") if name in {str(part.name) for part in design.assembly.parts})
    return np.degrees(np.arctan2(turned[lever][1, 0], turned[lever][0, 0]))


def test_a_finding_opens_the_page_at_the_end_that_it_is_about(stated):
    sign, design = stated
    found = [(k, one) for k, one in enumerate(design.report.findings) if one.code == "KF412"]
    assert len(found) == 2
    poses = {}
    for k, finding in found:
        value = float(finding.found.rstrip("°"))
        focus = Scene(design).focuses[k]
        poses[value] = shown_at(design, finding, focus)
        assert poses[value] == pytest.approx(sign * value, abs=0.05)
        angle = np.radians(poses[value])
        beside = np.array([np.cos(angle), np.sin(angle)])
        assert abs(focus.place[:2] @ [-beside[1], beside[0]]) == pytest.approx(0.01, abs=1e-4)
    assert sorted(poses) == pytest.approx(ends_of(sign), abs=0.05)


@pytest.mark.parametrize(("kind", "swapped"), [("crank", True), ("rail", False)])
def test_a_slide_is_shown_where_its_linkage_turns_back_or_its_guide_ends(tmp_path, kind, swapped):
    """The slider of a crank, which the crank drives, and a carriage of 40 mm on a rail of 200 mm, that go 39.0085 mm
    and 120 mm towards -x; the slider's other end is at 10.9915 mm."""
    if kind == "crank":
        for file in (FIXTURES / "mechanisms" / "slider_crank").iterdir():
            shutil.copy(file, tmp_path)
        path = tmp_path / "slider_crank.toml"
        text, ends, slider = path.read_text().partition("[[function.drive]]")[0], (-39.0085, 10.9915), "slider_unit"
        axis, sides = "axis = [1, 0, 0]", '["frame", "slider_unit"]'
    else:
        save(box(-100, 100, -30, 30, -20, 0) + box(-100, 100, 20, 30, 0, 20) + box(-100, 100, -30, -20, 0, 20),
             tmp_path / "rail.stl")  # fmt: skip
        save(box(-20, 20, -20, 20, 0, 20), tmp_path / "carriage.stl")
        path, ends, slider = tmp_path / "rail.toml", (-120.0, 120.0), "carriage"
        axis, sides = "axis = [1, 0, 0]", '["rail", "carriage"]'
        text = 'schema = 1\n[assembly]\nname = "rail"\nunits = "mm"\nground = "rail"\n'
        text += "".join(f'[[part]]\nname = "{name}"\nmesh = "{name}.stl"\n' for name in ("rail", "carriage"))
        text += f'[[function.joint]]\nname = "guide"\nbetween = {sides}\ntype = "prismatic"\n{axis}\n'
    sign = 1
    if swapped:
        sign, (one, other) = -1, sides[1:-1].split(", ")
        text = text.replace(sides, f"[{other}, {one}]")
    path.write_text(text.replace(axis, f"{axis}\nrange = [-200, 200]"))
    design = stages.joints(stages.contacts(stages.import_(path)))
    design = stages.check(stages.simulate(stages.mass(design), ranges=True))
    scene, shown = Scene(design), []
    for k, finding in enumerate(design.report.findings):
        if finding.code == "KF412":
            focus = scene.focuses[k]
            shown.append(1e3 * scene.movements[focus.movement].at(focus.time)[slider][0, 3])
            assert float(finding.found.removesuffix(" mm")) == pytest.approx(sign * shown[-1], abs=0.05)
    assert sorted(shown) == pytest.approx(ends, abs=0.05)


@pytest.mark.parametrize(("low", "high", "end"), [(-30, 90, UP), (-60, 60, DOWN)])
@pytest.mark.parametrize("swapped", [False, True])
def test_one_end_that_is_short_is_the_one_that_is_shown(tmp_path, low, high, end, swapped):
    _, design = judged(tmp_path, ("base", "lever"), swapped, False, low, high)
    ((k, finding),) = ((k, one) for k, one in enumerate(design.report.findings) if one.code == "KF412")
    assert shown_at(design, finding, Scene(design).focuses[k]) == pytest.approx(end, abs=0.05)
