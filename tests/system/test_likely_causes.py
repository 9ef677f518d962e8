"""Likely causes that rules name: generated descriptions with one mistake each, and twins that have none."""

from __future__ import annotations

import itertools
import math
import re

import numpy as np
import pytest
from manifold3d import Manifold
from tests.support.solids import save

from kinform import form, run
from kinform.consistency import RULES
from kinform.consistency.context import Context
from kinform.design import Design

SEEDS = range(6)


def found(path, *codes):
    """What these rules find in a description before anything is derived."""
    context = Context(Design(form.load(path)))
    return [f for rule in RULES if rule.code in codes for f in rule.outcome(context).findings]


def ran(path, *codes):
    """What these rules find in a description after a run with ranges."""
    return [f for f in run(path, ranges=True).report.findings if f.code in codes]


def written(folder, text, name="robot.urdf"):
    path = folder / name
    path.write_text(text)
    return path


def six(tensor):
    keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    where = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    return " ".join(f'{key}="{tensor[k]:.9g}"' for key, k in zip(keys, where, strict=True))


def of_box(mass, sides):
    square = np.square(sides)
    return mass / 12.0 * np.diag(square.sum() - square)


def inertial(mass, centre, tensor, rpy=(0.0, 0.0, 0.0)):
    at = f'<origin xyz="{" ".join(map(str, centre))}" rpy="{" ".join(map(str, rpy))}"/>'
    return f'<inertial>{at}<mass value="{mass:.9g}"/><inertia {six(tensor)}/></inertial>'


def box(sides, centre=(0.0, 0.0, 0.0), tag="visual"):
    size, at = (" ".join(f"{v:.9g}" for v in values) for values in (sides, centre))
    return f'<{tag}><origin xyz="{at}"/><geometry><box size="{size}"/></geometry></{tag}>'


def joint(name, kind, parent, child, at=(0.0, 0.0, 0.0), axis="0 0 1", limits=None, more=""):
    limit = "" if limits is None else f'<limit lower="{limits[0]}" upper="{limits[1]}" effort="1" velocity="1"/>'
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{" ".join(map(str, at))}"/><axis xyz="{axis}"/>{limit}{more}</joint>\n'
    )


# coupled ranges


def gripper(kind, leader, follower, ratio, offset):
    links = "".join(f'<link name="{name}">{box((0.01, 0.02, 0.03))}</link>\n' for name in ("rail", "left", "right"))
    mimic = f'<mimic joint="a" multiplier="{ratio}" offset="{offset}"/>'
    joints = joint("a", kind, "rail", "left", (-0.1, 0.0, 0.0), limits=leader)
    joints += joint("b", kind, "rail", "right", (0.1, 0.0, 0.0), limits=follower, more="\n" + mimic)
    return f'<robot name="gripper">\n{links}{joints}</robot>\n'


def hinges(leader, follower, ratio, offset):
    """The same in MJCF, in degrees."""
    bodies = "".join(
        f'<body name="{name}"><joint name="{name}" range="{low} {high}"/><geom type="box" size=".01 .01 .01"/></body>'
        for name, (low, high) in (("a", np.degrees(leader)), ("b", np.degrees(follower)))
    )
    equal = f'<equality><joint joint1="b" joint2="a" polycoef="{offset} {ratio} 0 0 0"/></equality>'
    return f"<mujoco><worldbody>{bodies}</worldbody>{equal}</mujoco>"


def mapped(leader, ratio, offset):
    return sorted(ratio * end + offset for end in leader)


def coupling(seed):
    """Kind, range of the leader, ratio and offset: all signs and both units."""
    rng = np.random.default_rng(seed)
    kind = ("revolute", "prismatic")[seed % 2]
    size = 1.0 if kind == "revolute" else 0.04
    leader = sorted((size * rng.uniform(-1.0, 0.2), size * rng.uniform(0.3, 1.0)))
    return kind, leader, rng.uniform(0.3, 3.0) * (-1.0) ** (seed // 2), size * (0.0, 0.4, -0.3)[seed % 3]


@pytest.mark.parametrize("seed", SEEDS)
def test_coupled_ranges_that_agree_give_nothing(tmp_path, seed):
    kind, leader, ratio, offset = coupling(seed)
    low, high = mapped(leader, ratio, offset)
    for follower in ((low, high), (low - 0.1, high + 0.2)):
        assert found(written(tmp_path, gripper(kind, leader, follower, ratio, offset)), "KF418") == []
    if kind == "revolute":
        assert found(written(tmp_path, hinges(leader, (low, high), ratio, offset), "a.xml"), "KF418") == []


@pytest.mark.parametrize("seed", SEEDS)
def test_a_follower_that_stops_its_leader_is_a_warning_with_the_range_to_paste(tmp_path, seed):
    kind, leader, ratio, offset = coupling(seed)
    low, high = mapped(leader, ratio, offset)
    middle = 0.5 * (low + high)
    (finding,) = found(written(tmp_path, gripper(kind, leader, (low, middle), ratio, offset)), "KF418")
    assert (finding.severity, finding.subject, finding.line) == ("warning", ("b", "a"), 7)
    assert f'lower="{low:.6g}" upper="{high:.6g}"' in finding.remedy
    if kind == "revolute":
        (same,) = found(written(tmp_path, hinges(leader, (low, middle), ratio, offset), "a.xml"), "KF418")
        assert f'range="{math.degrees(low):.6g} {math.degrees(high):.6g}"' in same.remedy


@pytest.mark.parametrize("seed", SEEDS)
def test_coupled_ranges_that_share_one_end_or_nothing_are_an_error(tmp_path, seed):
    kind, leader, ratio, offset = coupling(seed)
    low, high = mapped(leader, ratio, offset)
    for follower in ((high, high + (high - low)), (high + 0.1, high + 0.2)):
        (finding,) = found(written(tmp_path, gripper(kind, leader, follower, ratio, offset)), "KF418")
        assert finding.severity == "error" and finding.witness.kind == "textual"


def test_a_mimic_with_the_wrong_sign_is_told_its_ratio(tmp_path):
    (finding,) = found(written(tmp_path, gripper("prismatic", (0.0, 0.03), (0.0, 0.03), -1, 0)), "KF418")
    assert finding.severity == "error" and "round to 1," in finding.remedy


# masses


TIP = inertial(1.0, (0, 0, 0), of_box(1.0, (0.1, 0.1, 0.1)))


def arm(middle, fixed="", tip=TIP):
    links = f'<link name="base">{tip}{box((0.1, 0.1, 0.1))}</link>\n<link name="middle">{middle}</link>\n'
    links += f'<link name="cover">{fixed}</link>\n<link name="tip">{tip}{box((0.1, 0.1, 0.1))}</link>\n'
    joints = joint("a", "revolute", "base", "middle", limits=(-1, 1)) + joint("f", "fixed", "middle", "cover")
    return f'<robot name="arm">\n{links}{joints}{joint("b", "revolute", "middle", "tip", limits=(-1, 1))}</robot>\n'


NO_MASS = inertial(0.0, (0, 0, 0), np.zeros((3, 3)))


@pytest.mark.parametrize(("stated", "shape"), list(itertools.product(("", NO_MASS), (True, False))))
def test_a_moving_link_without_mass_is_named_at_its_line(tmp_path, stated, shape):
    middle = stated + (box((0.1, 0.2, 0.3)) if shape else "")
    (finding,) = found(written(tmp_path, arm(middle)), "KF125", "KF121", "KF123")
    expected = ("KF125", "warning" if shape else "note", ("middle",), 3)
    assert (finding.code, finding.severity, finding.subject, finding.line) == expected


def test_masses_of_fixed_links_count_and_descriptions_without_masses_are_left_alone(tmp_path):
    seen = box((0.1, 0.2, 0.3))
    assert found(written(tmp_path, arm(seen, fixed=inertial(1.0, (0, 0, 0), np.eye(3)))), "KF125") == []
    assert found(written(tmp_path, arm(seen, tip="")), "KF125") == []


# inertias of solids


def dumbbell(seed, how):
    """A link of two boxes in random poses of its frame, with an inertia that is right, or wrong in one way."""
    rng = np.random.default_rng(seed)
    sides = rng.uniform(0.01, 0.03, (2, 3)) * 10.0 ** (seed % 3 - 1)
    apart = rng.uniform(2.0, 4.0, (2, 1)) * [[1], [-1]] * np.array([1.0, 0.3, -0.6])
    centres = sides.max() * (apart + rng.choice([-1.0, 1.0], 3) * rng.uniform(4.0, 6.0, 3))
    masses = 1000.0 * sides.prod(axis=1)
    mass, centre = masses.sum(), masses @ centres / masses.sum()
    own = sum(of_box(m, s) for m, s in zip(masses, sides, strict=True))
    arms = centres - centre
    tensor = own + sum(m * (d @ d * np.eye(3) - np.outer(d, d)) for m, d in zip(masses, arms, strict=True))
    about = tensor + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    stated = {"right": tensor, "summed": own, "frame": about, "mass": 0.1 * tensor, "dense": 0.7 * tensor}[how]
    shapes = "".join(box(s, c) for s, c in zip(sides, centres, strict=True))
    return arm(inertial(mass, [f"{v:.9g}" for v in centre], stated) + shapes), tensor


@pytest.mark.parametrize("seed", SEEDS)
def test_inertias_that_solids_have_give_nothing(tmp_path, seed):
    for how in ("right", "dense"):
        assert found(written(tmp_path, dumbbell(seed, how)[0]), "KF123") == []


@pytest.mark.parametrize(("seed", "how"), list(itertools.product(SEEDS, ("summed", "frame", "mass"))))
def test_an_inertia_that_a_solid_cannot_have_is_named_with_its_cause_and_the_right_one(tmp_path, seed, how):
    text, tensor = dumbbell(seed, how)
    (finding,) = found(written(tmp_path, text), "KF123")
    assert (finding.severity, finding.subject, finding.line) == ("warning", ("middle",), 3)
    words = {"summed": "parallel axis", "frame": "frame of the link", "mass": "different densities"}
    assert words[how] in finding.message
    pasted = [float(text) for text in re.findall(r'="([^"]+)"', finding.remedy)]
    assert pasted[:3] == pytest.approx(np.diag(tensor), rel=1e-4)


def test_an_inertia_of_zero_about_one_axis_is_named(tmp_path):
    thin = inertial(1.0, (0, 0, 0), np.diag([0.0, 0.01, 0.01]))
    (finding,) = found(written(tmp_path, arm(thin + box((0.1, 0.3, 0.3)))), "KF123")
    assert finding.subject == ("middle",)


# degrees and radians


def hinge(compiler, *ranges):
    bodies = "".join(
        f'\n<body name="b{k}" pos="{k} 0 0"><joint name="j{k}" range="{low} {high}"/>'
        '<geom type="box" size=".1 .1 .1"/></body>'
        for k, (low, high) in enumerate(ranges)
    )
    return f"<mujoco>{compiler}<worldbody>{bodies}</worldbody></mujoco>"


@pytest.mark.parametrize("end", [0.5, 1.2, 3.14])
def test_limits_in_radians_that_are_read_as_degrees_are_asked_about(tmp_path, end):
    (finding,) = found(written(tmp_path, hinge("", (-60, 60), (-end, end)), "a.xml"), "KF415")
    assert (finding.severity, finding.subject, finding.line) == ("warning", ("j1",), 3)
    assert f'range="-{math.degrees(end):.4g} {math.degrees(end):.4g}"' in finding.remedy
    every = found(written(tmp_path, hinge("", (-1, 1), (-end, end)), "a.xml"), "KF415")
    assert len(every) == 2 and all('angle="radian"' in f.remedy for f in every)


def test_limits_that_are_degrees_or_radians_as_stated_give_nothing(tmp_path):
    assert found(written(tmp_path, hinge("", (-60, 60), (-5, 5)), "a.xml"), "KF415") == []
    radian = '<compiler angle="radian"/>'
    assert found(written(tmp_path, hinge(radian, (-1.0, 1.0), (-1.2, 1.2)), "a.xml"), "KF415") == []


# signs of axes


def door(side, limits, gap=0.03, sign=1):
    """A door along x about z, with a wall on the one side of it."""
    frame = box((0.3, 0.02, 0.2), (0.2, side * (0.02 + gap), 0.0)) + box((0.02, 0.02, 0.2), (-0.05, 0.0, 0.0))
    links = f'<link name="frame">{frame}</link>\n<link name="door">{box((0.3, 0.02, 0.2), (0.2, 0.0, 0.0))}</link>\n'
    hung = joint("hinge", "revolute", "frame", "door", axis=f"0 0 {sign}", limits=limits)
    return f'<robot name="door">\n{links}{hung}</robot>\n'


@pytest.mark.parametrize(("side", "sign"), list(itertools.product((1, -1), (1, -1))))
def test_a_door_that_opens_into_its_wall_is_asked_about_the_sign_of_its_axis(tmp_path, side, sign):
    wrong = (0, 1.5) if side * sign > 0 else (-1.5, 0)
    (finding,) = ran(written(tmp_path, door(side, wrong, sign=sign)), "KF412")
    assert f'lower="{-wrong[1]:g}" upper="{-wrong[0]:g}"'.replace("-0", "0") in finding.remedy
    assert finding.line == 4
    right = tuple(sorted(-end for end in wrong))
    assert ran(written(tmp_path, door(side, right, sign=sign)), "KF412") == []


def test_a_door_between_two_walls_is_not_asked_about_its_axis(tmp_path):
    text = door(1, (0, 1.5)).replace("</link>", box((0.3, 0.02, 0.2), (0.2, -0.05, 0.0)) + "</link>", 1)
    (finding,) = ran(written(tmp_path, text), "KF412")
    assert "axis" not in finding.message


# loops that a tree leaves open


def bar(length, pins=(), holes=()):
    """A link of 6 mm along x with pins below it and holes, at places along it."""
    plate = Manifold.cube((length + 20.0, 16.0, 6.0)).translate((-10.0, -8.0, 0.0))
    for x in holes:
        plate -= Manifold.cylinder(8.0, 3.0, circular_segments=48).translate((x, 0.0, -1.0))
    for x in pins:
        plate += Manifold.cylinder(6.0, 3.0, circular_segments=48).translate((x, 0.0, -6.0))
    return plate


def parallelogram(folder, crank, base, angle, closed=True):
    """A four-bar without its fourth joint; or an open chain, whose coupler has no bore for the rocker's pin."""
    ground, lever = bar(base, holes=(0.0, base)), bar(crank, pins=(0.0,), holes=(crank,))
    coupler = bar(base, pins=(0.0, base) if closed else (0.0,))
    for name, solid in {"g": ground, "cr": lever, "ro": lever, "co": coupler}.items():
        save(solid, folder / f"{name}.stl")
    names = {"ground": "g", "crank": "cr", "rocker": "ro", "coupler": "co"}
    scaled = 'scale="0.001 0.001 0.001"'
    links = "".join(
        f'<link name="{name}"><visual><geometry><mesh filename="{file}.stl" {scaled}/></geometry></visual></link>\n'
        for name, file in names.items()
    )

    def turn(name, parent, child, x, z, by):
        at = f'<origin xyz="{x / 1000.0} 0 {z / 1000.0}" rpy="0 0 {by}"/>'
        ends = f'<parent link="{parent}"/><child link="{child}"/>'
        return f'<joint name="{name}" type="continuous">{ends}{at}<axis xyz="0 0 1"/></joint>\n'

    joints = turn("a", "ground", "crank", 0.0, 6.0, angle) + turn("b", "crank", "coupler", crank, 6.0, -angle)
    joints += turn("d", "ground", "rocker", base, 6.0, angle)
    return written(folder, f'<robot name="linkage">\n{links}{joints}</robot>\n')


@pytest.mark.parametrize(("crank", "base", "angle"), [(40.0, 100.0, 1.0), (25.0, 60.0, -0.7)])
def test_the_joint_that_closes_a_loop_is_named_with_both_counts(tmp_path, crank, base, angle):
    (finding,) = ran(parallelogram(tmp_path, crank, base, angle), "KF419", "KF406")
    assert (finding.code, finding.severity, set(finding.subject)) == ("KF419", "warning", {"coupler", "rocker"})
    assert "3 freedoms" in finding.found and finding.found.split(",")[1].startswith(" 1 with the revolute")
    at = np.array([base + crank * math.cos(angle), crank * math.sin(angle)]) / 1000.0
    assert finding.place[:2] == pytest.approx(at, abs=1e-5)
    local = re.search(r"at (\S+) (\S+) (\S+) m", finding.remedy)
    assert [float(v) for v in local.groups()[:2]] == pytest.approx([crank / 1000.0, 0.0], abs=1e-5)


def test_an_open_chain_has_no_open_loop(tmp_path):
    assert ran(parallelogram(tmp_path, 40.0, 100.0, 1.0, closed=False), "KF419") == []


# collision geometry at the start


def folded(fold, tall=0.06, joint_kind="revolute"):
    """An arm of three links whose third lies over the first, by an elbow that is turned by `fold`."""
    seen = box((0.01, 0.01, 0.01))
    base = seen + box((0.08, 0.08, tall), (0.0, 0.0, 0.5 * tall), "collision")
    middle = seen + box((0.02, 0.02, 0.01), (0.05, 0.0, 0.0), "collision")
    tip = seen + box((0.08, 0.02, 0.012), (0.05, 0.0, 0.0), "collision")
    links = "".join(f'<link name="{n}">{b}</link>\n' for n, b in (("base", base), ("mid", middle), ("tip", tip)))
    elbow = joint("elbow", joint_kind, "mid", "tip", (0.1, 0.0, 0.01), limits=(-1, 1))
    elbow = elbow.replace('"/><axis', f'" rpy="0 0 {fold}"/><axis')
    shoulder = joint("a", "revolute", "base", "mid", (0, 0, 0.04), limits=(-1, 1))
    return f'<robot name="arm">\n{links}{shoulder}{elbow}</robot>'


def test_collision_geometry_that_overlaps_at_the_start_is_named_with_its_depth(tmp_path):
    (finding,) = found(written(tmp_path, folded(math.pi)), "KF133")
    assert (finding.severity, finding.subject, finding.line) == ("warning", ("base", "tip"), 4)
    # the forearm goes from 0.044 m up, the base to 0.06 m
    assert finding.found.startswith("16 mm")


@pytest.mark.parametrize(("fold", "tall", "kind"), [(0.0, 0.06, "revolute"), (math.pi, 0.04, "revolute")])
def test_collision_geometry_that_is_apart_or_of_neighbours_gives_nothing(tmp_path, fold, tall, kind):
    assert found(written(tmp_path, folded(fold, tall, kind)), "KF133") == []


def test_links_that_are_one_body_or_excluded_are_left_out(tmp_path):
    # the tip fixed to its neighbour is a neighbour of the base
    assert found(written(tmp_path, folded(math.pi, joint_kind="fixed")), "KF133") == []
    seen = '<geom type="sphere" size=".001" contype="0" conaffinity="0"/>'
    bodies = (
        f'<body name="a">{seen}<geom type="box" size=".1 .1 .1"/>'
        f'<body name="b" pos="0 0 .3"><joint range="-60 60"/>{seen}'
        f'<geom type="box" size=".05 .05 .05"/><body name="c" pos="0 0 -.3"><joint range="-60 60"/>{seen}'
        '<geom type="box" size=".05 .05 .05"/></body></body></body>'
    )
    for more, count in (("", 1), ('<contact><exclude body2="c" body1="a"/></contact>', 0)):
        text = f"<mujoco><worldbody>{bodies}</worldbody>{more}</mujoco>"
        assert len(found(written(tmp_path, text, "a.xml"), "KF133")) == count


# bores without a pin


def knuckles(folder, radius, lengths, pose=None, pin=None, stated="", gap=0.0, name="hinge.toml"):
    """Two leaves with knuckles along y in turn, the first and third of leaf_a, and a pin where its radius is given."""
    leaves, start = {"leaf_a": Manifold(), "leaf_b": Manifold()}, 0.0
    for k, long in enumerate(lengths):
        barrel = Manifold.cylinder(long, 2.2 * radius, circular_segments=64)
        side = 1.0 if k % 2 == 0 else -1.0
        plate = Manifold.cube((6.0 * radius, radius, long)).translate(
            (0.0 if side > 0.0 else -6.0 * radius, radius, 0.0)
        )
        bore = Manifold.cylinder(long + 2.0, radius, circular_segments=64).translate((0.0, 0.0, -1.0))
        leaves[("leaf_a", "leaf_b")[k % 2]] += ((barrel + plate) - bore).translate((0.0, 0.0, start))
        start += long + gap
    parts = dict(leaves)
    if pin is not None:
        parts["pin"] = Manifold.cylinder(start, pin, circular_segments=64)
    turned = np.eye(4)[:3] if pose is None else pose[:3]
    text = 'schema = 1\n[assembly]\nname = "hinge"\nunits = "mm"\nground = "leaf_a"\n'
    for part, solid in parts.items():
        save(solid.transform(turned), folder / f"{part}.stl")
        text += f'[[part]]\nname = "{part}"\nmesh = "{part}.stl"\ndensity = 1000.0\n'
    return written(folder, text + stated, name)


def posed(seed):
    rng = np.random.default_rng(seed)
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    X = np.eye(4)
    X[:3, :3] = q * np.sign(np.linalg.det(q))
    X[:3, 3] = rng.uniform(-50.0, 50.0, 3)
    return X


@pytest.mark.parametrize(
    ("seed", "radius", "lengths"), [(0, 2.5, (20, 20, 20)), (1, 4.0, (10, 30, 12)), (2, 1.0, (6,) * 5)]
)
def test_a_hinge_without_its_pin_lacks_it(tmp_path, seed, radius, lengths):
    (finding,) = ran(knuckles(tmp_path, radius, lengths, posed(seed)), "KF211")
    assert (finding.severity, finding.subject) == ("warning", ("leaf_a", "leaf_b"))
    assert finding.found == f"{len(lengths)} aligned bores of {2 * radius:g} mm, no pin"


@pytest.mark.parametrize("pin", [2.5, 2.2, 2.7])
def test_a_hinge_with_its_pin_lacks_none(tmp_path, pin):
    assert ran(knuckles(tmp_path, 2.5, (20, 20, 20), posed(3), pin=pin), "KF211") == []


@pytest.mark.parametrize(("gap", "code"), [(0.0, "KF414"), (2.0, "KF401")])
def test_a_stated_joint_without_its_pin_names_the_bores(tmp_path, gap, code):
    stated = (
        '[[function.joint]]\nname = "turn"\nbetween = ["leaf_a", "leaf_b"]\ntype = "revolute"\naxis = [0, 0, 1]\n'
        "point = [0, 0, 0]\n"
    )
    (finding,) = ran(knuckles(tmp_path, 2.5, (20, 20, 20), gap=gap, stated=stated), "KF211", "KF401", "KF414")
    assert finding.code == code and "3 aligned bores of 5 mm, no pin" in finding.message
    assert finding.remedy.startswith("Add a pin: 5 mm")


def test_holes_of_one_body_or_of_one_part_are_left_alone(tmp_path):
    group = '[[group]]\nname = "g"\nparts = ["leaf_a", "leaf_b"]\n'
    assert ran(knuckles(tmp_path, 2.5, (20, 20, 20), stated=group), "KF211") == []
    apart = knuckles(tmp_path, 2.5, (20, 20, 20), gap=40.0)
    assert ran(apart, "KF211") == []


def test_a_stack_of_plates_with_holes_on_several_lines_is_a_note(tmp_path):
    plate = Manifold.cube((60.0, 40.0, 5.0))
    for x, y in ((10.0, 10.0), (50.0, 30.0)):
        plate -= Manifold.cylinder(9.0, 2.0, circular_segments=48).translate((x, y, -1.0))
    text = 'schema = 1\n[assembly]\nname = "stack"\nunits = "mm"\n'
    for k in range(3):
        save(plate.translate((0.0, 0.0, 5.0 * k)), tmp_path / f"p{k}.stl")
        text += f'[[part]]\nname = "p{k}"\nmesh = "p{k}.stl"\ndensity = 1000.0\n'
    (finding,) = ran(written(tmp_path, text, "stack.toml"), "KF211")
    assert finding.severity == "note" and finding.found == "2 times 3 aligned bores of 4 mm, nothing in them"


def test_two_plates_with_holes_that_line_up_are_a_note(tmp_path):
    (finding,) = ran(knuckles(tmp_path, 2.5, (6, 6)), "KF211")
    assert finding.severity == "note" and "2 aligned bores of 5 mm" in finding.found
