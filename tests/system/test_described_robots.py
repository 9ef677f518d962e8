"""Rules that hold a description against its own geometry: each fires on a broken number, and on nothing else."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from tests.support.assemblies import assembly
from tests.support.walkers import Box, Link, Walker

from kinform import form, run
from kinform.consistency import RULES
from kinform.consistency.causes.grouping import by_cause
from kinform.consistency.context import Context
from kinform.consistency.control import apply
from kinform.consistency.outcome import decided
from kinform.design import Design
from kinform.errors import InputError
from kinform.foundation.meshes.hulls import hull_of
from kinform.model.checks import CheckSettings

CODES = ("KF110", "KF121", "KF123", "KF124", "KF130", "KF131", "KF132", "KF415")


def numbers(finding):
    """The numbers of a finding, in the order in which it says them."""
    return [float(text) for text in re.findall(r"(?<![\w.])\d+(?:\.\d+)?(?:e[+-]?\d+)?", finding.message)]


def findings(folder, walker):
    path = folder / "walker.urdf"
    path.write_text(walker.text())
    context = Context(Design(form.load(path)))
    return [f for rule in RULES if rule.code in CODES for f in rule.outcome(context).findings]


def only(folder, walker):
    (finding,) = findings(folder, walker)
    return finding


def test_a_robot_whose_numbers_are_right_gives_nothing(tmp_path):
    assert findings(tmp_path, Walker()) == []


@pytest.mark.parametrize(
    "products",
    [{"ixx": -1e-4}, {"izz": 0.1}],
)
def test_an_inertia_that_no_body_can_have_is_told_in_the_numbers_of_the_file(tmp_path, products):
    walker = Walker()
    walker.links["left_shin"].products |= products
    found = only(tmp_path, walker)
    (key, value), *_ = products.items()
    assert (found.code, found.severity, found.subject, found.line) == ("KF121", "error", ("left_shin",), 5)
    assert f"{key} {value:.6g}" in found.message


def test_an_inertia_in_gram_square_millimetres_is_an_error_that_names_the_unit(tmp_path):
    walker = Walker()
    walker.links["torso"].inertia_factor = 1e9
    found = only(tmp_path, walker)
    assert (found.code, found.severity, found.line) == ("KF123", "error", 2)


def test_an_inertia_a_hundred_times_too_small_is_doubted(tmp_path):
    walker = Walker()
    walker.links["torso"].inertia_factor = 0.01
    assert (only(tmp_path, walker).code, only(tmp_path, walker).severity) == ("KF123", "warning")


@pytest.mark.parametrize(("factor", "severity"), [(40.0, "error"), (15.0, "warning"), (0.004, "warning")])
def test_a_mass_that_takes_an_impossible_density_says_which(tmp_path, factor, severity):
    walker = Walker()
    walker.links["torso"].mass_factor = walker.links["torso"].inertia_factor = factor
    found = only(tmp_path, walker)
    assert (found.code, found.severity, found.subject) == ("KF123", severity, ("torso",))
    assert f"{1000.0 * factor:.3g}" in found.found.replace("40000", "4e+04").replace("15000", "1.5e+04")


def test_a_centre_of_mass_outside_of_the_geometry_is_told_with_its_distance(tmp_path):
    walker = Walker()
    walker.links["torso"].centre_shift = (0.0, 0.0, 0.15)  # the box ends 0.1 m above its centre
    found = only(tmp_path, walker)
    assert (found.code, found.severity) == ("KF124", "warning") and numbers(found)[0] == 50.0


def test_one_within_its_geometry_is_not(tmp_path):
    walker = Walker()
    walker.links["torso"].centre_shift = (0.0, 0.0, 0.09)
    assert [f.code for f in findings(tmp_path, walker)] == []


def test_a_link_a_thousand_times_too_large_is_in_another_unit(tmp_path):
    walker = Walker()
    torso = walker.links["torso"]
    inertial = torso.text("torso").split("<visual>")[0]
    big = [Box(tuple(1000.0 * v for v in box.size), tuple(1000.0 * v for v in box.at)) for box in torso.boxes]
    line = inertial + "".join(box.geometry("visual") for box in big) + "</link>"
    text = walker.text().replace(torso.text("torso"), line)
    (tmp_path / "walker.urdf").write_text(text)
    context = Context(Design(form.load(tmp_path / "walker.urdf")))
    found = [f for rule in RULES if rule.code in CODES for f in rule.outcome(context).findings]
    assert ("KF110", "error") in {(f.code, f.severity) for f in found}
    (scale,) = (f for f in found if f.code == "KF110")
    assert scale.line == 2 and numbers(scale).count(1000.0) == 2


def test_collision_geometry_that_leaves_a_part_bare_is_told(tmp_path):
    walker = Walker()
    walker.links["left_shin"].collision = walker.links["left_shin"].boxes[:1]  # without the foot
    found = only(tmp_path, walker)
    assert (found.code, found.subject) == ("KF130", ("left_shin",))


def test_collision_geometry_far_beyond_the_visual_is_told(tmp_path):
    walker = Walker()
    walker.links["torso"].collision = [Box((0.1, 0.2, 0.4), (0.0, 0.0, 0.2))]
    found = only(tmp_path, walker)
    assert found.code == "KF130" and 200.0 in numbers(found)


def test_a_box_somewhat_larger_than_the_link_is_not(tmp_path):
    walker = Walker()
    walker.links["torso"].collision = [Box((0.12, 0.22, 0.22), (0.0, 0.0, 0.1))]
    assert findings(tmp_path, walker) == []


def test_collision_geometry_in_another_unit_is_an_error(tmp_path):
    walker = Walker()
    walker.links["torso"].collision = [Box((1e-4, 2e-4, 2e-4), (0.0, 0.0, 0.1))]
    found = only(tmp_path, walker)
    assert (found.code, found.severity) == ("KF130", "error")


def test_a_collision_mesh_that_is_not_there_is_an_error_at_its_line_and_one_without_a_name_a_note(tmp_path):
    walker = Walker()
    mesh = '<collision><geometry><mesh filename="meshes/{}"/></geometry></collision>'
    walker.links["torso"].more = mesh.format("gone.stl")
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "stray.stl").write_text("solid s\nendsolid s\n")
    missing, stray = findings(tmp_path, walker)
    assert (missing.code, missing.severity, missing.line) == ("KF131", "error", 2)
    assert "meshes/gone.stl" in missing.message
    assert (stray.code, stray.severity) == ("KF131", "note") and "meshes/stray.stl" in stray.message
    walker.links["left_shin"].more = mesh.format("gone.stl")
    twice, _ = findings(tmp_path, walker)
    assert twice.line == 2 and numbers(twice) == [2.0] and "'left_shin'" in twice.message
    walker.links["left_shin"].more = ""
    (tmp_path / "other.urdf").write_text('<mesh filename="meshes/stray.stl"/>')  # another of the package names it
    assert [f.severity for f in findings(tmp_path, walker)] == ["error"]


def test_a_mesh_by_way_of_a_folder_that_is_not_there_is_named_as_it_is_written(tmp_path):
    """The file that was said not to exist was there."""
    walker = Walker()
    mesh = '<collision><geometry><mesh filename="{}meshes/box.stl"/></geometry></collision>'
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "box.stl").write_text("solid s\nendsolid s\n")
    walker.links["torso"].more = mesh.format("gone/../")
    (found,) = (found for found in findings(tmp_path, walker) if found.severity == "error")
    assert "gone/../meshes/box.stl" in found.message


SDF_TWINS = {
    "nothing": (lambda walker: None, None, 0, None),
    "inertia in g·mm²": (lambda w: setattr(w.links["torso"], "inertia_factor", 1e9), "KF123", 2, "torso"),
    "mass of another unit": (lambda w: setattr(w.links["torso"], "mass_factor", 40.0), "KF123", 2, "torso"),
    "centre outside": (lambda w: setattr(w.links["torso"], "centre_shift", (0.0, 0.0, 0.15)), "KF124", 2, "torso"),
    "no body": (lambda w: w.links["torso"].products.update(izz=0.5), "KF121", 2, "torso"),
    "bare": (lambda w: setattr(w.links["left_shin"], "collision", w.links["left_shin"].boxes[:1]), "KF130", 5,
             "left_shin"),
    "not mirrored": (lambda w: setattr(w.links["right_thigh"], "centre_shift", (0.0, 0.012, 0.0)), "KF132", 4,
                     "right_thigh"),
    "exchanged": (lambda w: w.limits.update(left_hip='lower="1" upper="-1"'), "KF415", 7, "left_hip"),
}  # fmt: skip


@pytest.mark.parametrize("case", SDF_TWINS)
def test_what_an_sdf_states_is_judged_as_that_of_a_urdf(tmp_path, case):
    change, code, line, subject = SDF_TWINS[case]
    walker = Walker()
    change(walker)
    (tmp_path / "walker.sdf").write_text(walker.sdf())
    context = Context(Design(form.load(tmp_path / "walker.sdf")))
    found = [f for rule in RULES if rule.code in CODES for f in rule.outcome(context).findings]
    told = [(f.code, f.line, f.subject[0]) for f in found]
    assert told == ([] if code is None else [(code, line, subject)])
    same = [(f.code, f.subject, f.severity, f.found) for f in findings(tmp_path, walker)]
    assert same == [(f.code, f.subject, f.severity, f.found) for f in found]


def test_a_visual_mesh_that_is_not_there_is_an_error_and_the_rest_is_judged(tmp_path):
    """Without it nothing is said of the mass of its link; where no mesh is there nothing can be said at all."""
    walker = Walker()
    (tmp_path / "box.obj").write_text(box_obj())
    mesh = '<visual><geometry><mesh filename="{}"/></geometry></visual>'
    walker.links["torso"].more = mesh.format("gone.stl") + mesh.format("box.obj")
    walker.links["torso"].inertia_factor = 1e9
    missing = only(tmp_path, walker)
    assert (missing.code, missing.severity, missing.line) == ("KF131", "error", 2)
    assert "gone.stl" in missing.message and "'torso'" in missing.message
    assembly = form.load(tmp_path / "walker.urdf")
    assert len(assembly.function.joints) == 4 and any("gone.stl" in note for note in assembly.notes)
    (tmp_path / "box.obj").unlink()
    with pytest.raises(InputError) as caught:
        form.load(tmp_path / "walker.urdf")
    assert [problem.line for problem in caught.value.problems] == [2, 2]


def box_obj():
    """A cube of 20 mm around the joint of the shin."""
    corners = [(x, y, z) for x in (-0.01, 0.01) for y in (-0.01, 0.01) for z in (-0.01, 0.01)]
    quads = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {a} {b} {c} {d}" for a, b, c, d in quads]
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("limit", "severity"),
    [
        ('lower="1" upper="-1" effort="1" velocity="1"', "error"),
        ('lower="0" upper="0" effort="1" velocity="1"', "warning"),
        ("", "error"),
        ('lower="-1" upper="1" effort="0" velocity="1"', "note"),
        ('lower="-90" upper="90" effort="1" velocity="1"', "warning"),
        ('lower="-30" upper="0" effort="1" velocity="1"', "warning"),
    ],
)
def test_limits_that_cannot_be_used_are_told(tmp_path, limit, severity):
    found = only(tmp_path, Walker(limits={"left_knee": limit}))
    assert (found.code, found.severity, found.subject, found.line) == ("KF415", severity, ("left_knee",), 8)


@pytest.mark.parametrize("limit", ["6.2831853", "12.6", "1e5"])
def test_limits_of_a_turn_or_two_and_those_that_stand_for_none_are_no_degrees(tmp_path, limit):
    stated = f'lower="-{limit}" upper="{limit}" effort="1" velocity="1"'
    assert findings(tmp_path, Walker(limits={"left_knee": stated})) == []


@pytest.mark.parametrize("there", ["collision", ""])
def test_a_description_without_the_geometry_that_is_read_is_not_verified(tmp_path, there):
    walker = Walker()
    path = tmp_path / "walker.urdf"
    bare = re.sub(r"<visual>.*?</visual>", "", walker.text())
    solid = '<collision><geometry><box size="1 1 1"/></geometry></collision></link>' if there else "</link>"
    path.write_text(re.sub(r"<collision>.*?</collision>", "", bare).replace("</link>", solid))
    rule = next(rule for rule in RULES if rule.code == "KF131")
    outcome = rule.outcome(Context(Design(form.load(path))))
    assert (outcome.name, outcome.findings) == ("inconclusive", ())
    assert ("--geometry collision" in outcome.reason) == bool(there)
    path.write_text(walker.text())
    assert rule.outcome(Context(Design(form.load(path)))).name == "passed"


def test_many_of_a_kind_are_one_finding(tmp_path):
    nothing = 'lower="0" upper="0" effort="1" velocity="1"'
    joints = ("left_hip", "left_knee", "right_hip", "right_knee")
    found = only(tmp_path, Walker(limits=dict.fromkeys(joints, nothing)))
    assert sorted(found.subject) == sorted(joints) and 3.0 in numbers(found)


def test_a_side_that_is_not_mirrored_is_told_by_geometry_by_mass_and_by_frame(tmp_path):
    walker = Walker()
    walker.links["right_thigh"].boxes = list(walker.links["left_thigh"].boxes)  # copied, not mirrored
    shape = only(tmp_path, walker)
    assert (shape.code, shape.subject[0]) == ("KF132", "right_thigh")
    walker = Walker()
    walker.links["right_thigh"].inertia_factor = 1.3
    mass = only(tmp_path, walker)
    assert mass.code == "KF132" and mass.line == 4
    walker = Walker()
    walker.hips["right"] = (0.02, -0.13, 0.05)
    frames = [f for f in findings(tmp_path, walker) if f.subject == ("right_thigh", "left_thigh")]
    assert any(20.0 in numbers(found) for found in frames)


def test_geometry_that_is_not_mirrored_as_the_stated_masses_are_is_told_also_where_all_pairs_are_so(tmp_path):
    walker = Walker()
    right = {name: link.text(name) for name, link in walker.links.items() if name.startswith("right")}
    text = walker.text()
    for name, line in right.items():
        copied = Link(list(walker.links[name.replace("right", "left")].boxes)).text(name)
        inertial = re.search("<inertial>.*</inertial>", line)[0]
        text = text.replace(line, re.sub("<inertial>.*</inertial>", inertial, copied))
    (tmp_path / "walker.urdf").write_text(text)
    assert "KF132" in [found.code for found in run(tmp_path / "walker.urdf").findings]


def test_a_part_that_is_moved_to_the_other_side_is_not_taken_for_a_turned_one(tmp_path):
    # symmetric in z: turned about z, its second moments are those of what was only moved
    walker = Walker()
    thigh = [Box((0.2, 0.04, 0.04), (0.0, 0.0, -0.1)), Box((0.05, 0.08, 0.02), (0.05, 0.06, -0.1))]
    walker.links["left_thigh"] = Link(thigh)
    walker.links["right_thigh"] = Link(list(thigh))
    found = only(tmp_path, walker)
    assert (found.code, found.subject[0]) == ("KF132", "right_thigh")


def test_equal_parts_that_are_turned_instead_of_mirrored_pass(tmp_path):
    walker = Walker()
    for name in ("thigh", "shin"):
        turned = [Box(box.size, (-box.at[0], -box.at[1], box.at[2])) for box in walker.links[f"left_{name}"].boxes]
        walker.links[f"right_{name}"].boxes = turned
    assert findings(tmp_path, walker) == []


def test_a_hull_tells_how_far_outside_a_point_is():
    corners = [[x, y, z] for x in (0, 2) for y in (0, 1) for z in (0, 1)]
    hull = hull_of(np.array(corners, dtype=float))
    assert hull.volume == pytest.approx(2.0, rel=1e-12)
    away = hull.outside(np.array([[3.0, 0.5, 0.5], [1.0, 0.5, 0.5]]))
    assert away == pytest.approx([1.0, -0.5], abs=1e-12)


def overlaps(folder, widths):
    walker = Walker()
    for side, sign in (("left", 1.0), ("right", -1.0)):
        low, high = 0.1 - widths, 0.15
        middle = sign * (0.5 * (low + high) - 0.13)
        walker.links[f"{side}_thigh"].boxes[0] = Box((0.05, high - low, 0.20), (0.0, middle, -0.10))
    (folder / "walker.urdf").write_text(walker.text())
    return [f for f in run(folder / "walker.urdf").report.singles if f.code == "KF201"]


def test_links_that_a_joint_joins_may_overlap_a_little_and_not_deeply(tmp_path):
    assert [f.severity for f in overlaps(tmp_path, 0.004)] == ["note"] * 2
    assert [f.severity for f in overlaps(tmp_path, 0.03)] == ["warning"] * 2


def test_of_many_warnings_on_a_description_the_first_are_told_and_the_others_named():
    rule = next(rule for rule in RULES if rule.code == "KF201")
    warnings = [rule.at("warning").finding([f"a{k}", f"b{k}"], f"overlap {k}") for k in range(9)]
    description = CheckSettings(profile="description")

    def told(settings, many):
        found = apply(rule, decided(warnings[:many]), settings).findings
        context = Context(Design(replace(assembly(), check=settings)))
        return by_cause(context, found, lambda *_: ())

    first, members = told(description, 9)
    rest, *single = first
    assert [f.subject for f in single] == [(f"a{k}", f"b{k}") for k in range(3)]
    assert set(rest.subject) == {f"{letter}{k}" for letter in "ab" for k in range(3, 9)} and len(members) == 6
    assert len(told(CheckSettings(profile="design"), 9)[0]) == 9
    assert len(told(description, 6)[0]) == 6


SDF = """<sdf version="1.9"><model name="m">
<link name="base"><inertial><mass>1</mass><inertia><ixx>{ixx}</ixx><iyy>0.002</iyy><izz>0.002</izz></inertia></inertial>
<visual name="v"><geometry><box><size>0.1 0.1 0.1</size></box></geometry></visual></link>
<link name="arm"><pose>0 0 0.1 0 0 0</pose><visual name="v"><geometry><box><size>0.1 0.1 0.1</size></box></geometry>
</visual></link>
<joint name="j" type="revolute"><parent>base</parent><child>arm</child><axis><xyz>0 0 1</xyz>
<limit><lower>{lower}</lower><upper>1</upper></limit></axis></joint>
</model></sdf>"""


@pytest.mark.parametrize(
    ("ixx", "lower", "code"), [(0.002, -1, None), (0.02, -1, "KF121"), (0.002, 2, "KF415")]
)  # fmt: skip
def test_the_numbers_of_an_sdf_are_looked_at_too(tmp_path, ixx, lower, code):
    (tmp_path / "m.sdf").write_text(SDF.format(ixx=ixx, lower=lower))
    context = Context(Design(form.load(tmp_path / "m.sdf")))
    found = [f.code for rule in RULES if rule.code in CODES for f in rule.outcome(context).findings]
    assert found == ([] if code is None else [code])


ARM = """<robot name="arm">
<link name="base"><visual><origin xyz="0 0 -0.05"/><geometry><box size="0.1 0.1 0.06"/></geometry></visual>
<visual><origin xyz="0.02 {wall} 0.02"/><geometry><box size="0.02 0.02 0.2"/></geometry></visual></link>
<link name="arm"><visual><origin xyz="0.1 0 0"/><geometry><box size="0.2 0.02 0.02"/></geometry></visual></link>
<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="{upper}" effort="1" velocity="1"/></joint></robot>
"""


@pytest.mark.parametrize(
    ("wall", "upper", "told"),
    [(0.05, 1.4, "error"), (0.05, 0.8, "warning"), (0.05, 0.5, ""), (0.0201, 1.4, "error")],
)
def test_a_limit_beyond_what_the_parts_allow_is_told_also_where_nothing_holds_the_joint(tmp_path, wall, upper, told):
    """The arm of half width 10 mm meets the edge of the wall, at (30, 40) mm from the axis; or nearly at once, where
    the wall is nearly touched as it is drawn: that forbids one sense, and so does not contradict the joint."""
    path = tmp_path / "arm.urdf"
    path.write_text(ARM.format(wall=wall, upper=upper))
    design = run(path, ranges=True).design
    found = [f for f in design.report.findings if f.code == "KF412"]
    assert [f.severity for f in found] == ([told] if told else [])
    assert all(f.severity != "error" for f in design.report.findings if f not in found)
    if told:
        x, y = 0.03, wall - 0.01
        meeting = np.degrees(np.arctan2(y, x) - np.arcsin(0.01 / np.hypot(x, y)))
        assert float(found[0].found.rstrip("°")) == pytest.approx(meeting, abs=0.1)


def of_sizes(folder, scales):
    """A description whose links are the same mesh, each with a scale of its own, one above the other."""
    (folder / "m.obj").write_text("v 0 0 0\nv 0.1 0 0\nv 0 0.2 0\nv 0 0 0.3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
    links = "".join(
        f'<link name="l{k}"><visual><geometry><mesh filename="m.obj" scale="{s} {s} {s}"/></geometry></visual></link>'
        for k, s in enumerate(scales)
    )
    joints = "".join(
        f'<joint name="j{k}" type="fixed"><parent link="l0"/><child link="l{k}"/><origin xyz="0 0 {0.4 * k}"/></joint>'
        for k in range(1, len(scales))
    )
    path = folder / "sizes.urdf"
    path.write_text(f'<robot name="r">{links}{joints}</robot>')
    (outcome,) = (rule.outcome(Context(Design(form.load(path)))) for rule in RULES if rule.code == "KF110")
    return [(f.severity, f.subject) for f in outcome.findings]


def test_the_same_mesh_in_metres_and_in_millimetres_is_an_error_that_names_it(tmp_path):
    assert of_sizes(tmp_path, [1, 1, 1, 1]) == []
    assert of_sizes(tmp_path, [1, 1, 1000, 1]) == [("error", ("m#3",))]
    assert of_sizes(tmp_path, [1000, 1, 1000, 1000]) == [("error", ("m#2",))]
    assert of_sizes(tmp_path, [0.001, 0.001, 1, 0.001, 0.001]) == [("error", ("m#3",))]


def test_one_part_that_dwarfs_all_others_is_named_and_not_the_whole(tmp_path):
    assert of_sizes(tmp_path, [1, 1, 500, 1]) == [("warning", ("m#3",))]
    assert of_sizes(tmp_path, [500, 500, 500]) == [("warning", ("r",))]
