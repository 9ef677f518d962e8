"""The range of a joint is where geometry says that parts meet, and mating surfaces stop nothing."""

from __future__ import annotations

from dataclasses import replace
from math import acos, asin, atan2, degrees, hypot, pi, radians

import numpy as np
import pytest
import random_assemblies
from random_assemblies.case import Wear
from support.diagonal import diagonal, first
from support.places import FIXTURES
from support.slots import lever_between_pegs
from support.solids import assembly, box, part, random_pose, rod

from kinform import collisions, contacts, kinematics, stages, surfaces
from kinform.collisions.driving import candidates
from kinform.collisions.pair import distance_bounds
from kinform.collisions.pair.advancement import STEPS_TOUCHED
from kinform.collisions.pair.states import States
from kinform.consistency import check
from kinform.model.assembly import Group, Source
from kinform.model.function import Function, IntendedJoint, Law, SimulationRequest


def found(X=None, scale=1e-3, **solids):
    """Ranges of the joints of solids (mm), all under one pose."""
    X = np.eye(4) if X is None else X
    made = assembly(*(part(name, solid, X, scale) for name, solid in solids.items()), ground=None)
    known = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, known)
    derived = kinematics.derive(made, known, touching)
    return collisions.ranges(made, known, touching, derived), derived


def turned_lever(angle):
    """The lever between pegs from another pose (degrees)."""
    solids = lever_between_pegs()
    return {"base": solids["base"], "lever": solids["lever"].rotate((0, 0, angle))}


def values(item, joint, axis=(0, 0, 1.0)):
    return np.array([end.value for end in ends(joint, np.array(axis), item)])


@pytest.fixture
def other_steps(monkeypatch):
    monkeypatch.setattr("kinform.collisions.pair.advancement.RESOLUTION", 9e-3)
    monkeypatch.setattr(candidates, "WINDOW_TURN", 0.31)
    monkeypatch.setattr(candidates, "MODEL_MOST", 0.0)
    monkeypatch.setattr(distance_bounds, "SHORT_STEP", 0.003)
    monkeypatch.setattr(distance_bounds, "STEPS_MOST", 7)


@pytest.mark.parametrize("angle", first(2, [3.3, -7.1, 0.0]))
def test_where_a_joint_stops_does_not_hang_on_the_steps_by_which_it_is_found(angle, request):
    """Neither on where it begins, nor on how long steps are, nor on which facets are looked at."""
    (item,), derived = found(**lever_between_pegs())
    at = values(item, derived.joints[0])
    request.getfixturevalue("other_steps")
    (item,), derived = found(**turned_lever(angle))
    assert values(item, derived.joints[0]) + radians(angle) == pytest.approx(at, abs=1e-8)


@pytest.mark.parametrize("reach", first(1, [-12.3, 1.7, 0.0]))
def test_where_a_slide_stops_does_not_hang_on_where_it_begins(reach, request):
    rail = box(-60, 60, -15, 15, -5, 0) + box(-60, 60, -15, -10, -1, 10) + box(-60, 60, 10, 15, -1, 10)
    rail += box(50, 55, -11, 11, -1, 10) + rod(3, -1, 10, 40).translate((-51, 0, 0))
    request.getfixturevalue("other_steps")
    (item,), derived = found(rail=rail, slider=box(-10, 25, -10, 10, 0, 8).translate((reach, 0, 0)))
    expected = np.array([-0.038, 0.025]) - 1e-3 * reach
    assert values(item, derived.joints[0], (1.0, 0, 0)) == pytest.approx(expected, abs=3e-9)


def ends(joint, axis, item):
    """(lower, upper) about `axis`, whatever the sign of the joint's own."""
    lower, upper = item.lower, item.upper
    return (
        (lower, upper)
        if joint.axis @ axis > 0
        else (replace(upper, value=-upper.value), replace(lower, value=-lower.value))
    )


@pytest.mark.parametrize("seed", [None, 3])
def test_a_lever_goes_from_peg_to_peg(seed):
    X = np.eye(4) if seed is None else random_pose(np.random.default_rng(seed))
    (item,), derived = found(X, **lever_between_pegs())
    (joint,) = derived.joints
    assert joint.type == "revolute"
    lower, upper = ends(joint, X[:3, 2], item)
    assert degrees(upper.value) == pytest.approx(degrees(atan2(12, 32) - asin(4 / hypot(32, 12))), abs=0.01)
    assert degrees(lower.value) == pytest.approx(-degrees(atan2(16, 24) - asin(4 / hypot(24, 16))), abs=0.01)
    assert upper.parts == lower.parts == ("base", "lever")
    place = np.linalg.inv(X) @ np.append(upper.place, 1.0)
    assert place[:2] == pytest.approx([0.032, 0.012], abs=2e-4)


@pytest.mark.parametrize(("scale", "segments"), [(1e-3, 64), (1e-3, 96), (2e-2, 64), (2e-4, 80)])
def test_a_pin_meets_a_wall_at_the_same_angle_whatever_the_size_and_the_facets(scale, segments):
    plate = box(-50, 62, -50, 50, -5, 0) + rod(5, -1, 11, segments) + rod(8, 10, 13, segments)
    wall = box(12, 60, 15, 20, 12, 20) + box(55, 60, 15, 20, -1, 20)
    lever = box(-8, 40, -4, 4, 0, 10) + rod(9, 0, 10, segments) - rod(5.02, -1, 11, segments, 3.0)
    lever += rod(3, 9, 16, segments).translate((25, 0, 0))
    (item,), derived = found(scale=scale, base=plate + wall, lever=lever)
    _, upper = ends(derived.joints[0], np.array([0, 0, 1.0]), item)
    assert degrees(upper.value) == pytest.approx(degrees(asin(12 / 25)), abs=0.02)


def test_what_only_scrapes_is_passed_and_the_stop_behind_it_is_where_it_is():
    rail = box(-60, 60, -15, 15, -5, 0) + box(-60, 60, -15, -10, -1, 10) + box(-60, 60, 10, 15, -1, 10)
    bump = box(40, 42, -5, 5, -1, 0.04)
    (item,), _ = found(rail=rail + bump + box(50, 55, -11, 11, -1, 10), slider=box(-10, 25, -10, 10, 0, 8))
    assert item.upper.value == pytest.approx(0.025, abs=2e-6)
    bump = box(40, 42, -5, 5, -1, 0.4)
    (item,), _ = found(rail=rail + bump + box(50, 55, -11, 11, -1, 10), slider=box(-10, 25, -10, 10, 0, 8))
    assert item.upper.value == pytest.approx(0.015, abs=2e-6)


@diagonal(thick=[1.0, 0.2, 0.05, 0.02], scale=[1e-3, 1.0])
def test_a_fin_stops_at_a_wall_however_thin_it_is(thick, scale):
    slider = box(-10, 10, -12, 12, -12, 12) - box(-20, 20, -4, 4, -4, 4) + box(-1, 1, -2, 20, 12, 20)
    walls = [box(*sorted((side * 40, side * (40 - thick))), 10, 30, 14, 30) for side in (-1, 1)]
    solids = {"rail": box(-100, 100, -4, 4, -4, 4), "back": walls[0], "front": walls[1], "slider": slider}
    made = assembly(
        *(part(name, solid, np.eye(4), scale) for name, solid in solids.items()),
        ground="rail", groups=(("frame", ("back", "front", "rail")),),
    )  # fmt: skip
    made = replace(made, tolerances=replace(made.tolerances, contact=0.2 * scale))
    known = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, known)
    derived = kinematics.derive(made, known, touching)
    (item,) = collisions.ranges(made, known, touching, derived)
    assert item.upper.value / scale == pytest.approx(39.0 - thick, abs=1e-3)
    assert item.lower.value / scale == pytest.approx(thick - 39.0, abs=1e-3)
    assert (item.lower.parts, item.upper.parts) == (("back", "slider"), ("front", "slider"))


@pytest.mark.parametrize(
    ("stops", "expected"), [((-50, 50), (-0.040, 0.025)), ((-50, None), (-0.040, None)), ((None, None), (None, None))]
)
def test_a_slider_goes_from_stop_to_stop(stops, expected):
    rail = box(-60, 60, -15, 15, -5, 0) + box(-60, 60, -15, -10, -1, 10) + box(-60, 60, 10, 15, -1, 10)
    for stop, sign in zip(stops, (-1, 1), strict=True):
        if stop is not None:
            rail += box(*sorted((stop, stop + 5 * sign)), -11, 11, -1, 10)
    (item,), derived = found(rail=rail, slider=box(-10, 25, -10, 10, 0, 8))
    (joint,) = derived.joints
    assert joint.type == "prismatic"
    for end, value in zip((item.lower, item.upper), expected, strict=True):
        assert end.status == ("unbounded" if value is None else "found")
        assert end.value == (None if value is None else pytest.approx(value, abs=2e-6))
    assert item.status == ("unbounded" if expected == (None, None) else "found")
    if expected[1] is None:
        assert item.upper.leaves == pytest.approx(0.070, abs=1e-6)


def moved(seeker, **changes):
    """The design with something else in its function or run, simulated; its ranges, which do not hang on that, kept."""
    design = replace(seeker, assembly=replace(seeker.assembly, **changes))
    design = stages.simulate(design, level="kinematic", ranges=False)
    return replace(design, simulation=replace(design.simulation, ranges=seeker.simulation.ranges))


@pytest.fixture
def seeker(derive_design):
    return derive_design(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml")


REACH = acos(-40 / hypot(11, 50))
"""Where a corner of the pitch motor meets the back of the housing, seen from the yaw axis."""


def test_the_gimbal_goes_until_its_motor_meets_the_back_of_the_housing(seeker):
    yaw, pitch = seeker.simulation.ranges
    assert degrees(yaw.upper.value) == pytest.approx(degrees(REACH - pi / 2 - atan2(11, 50)), abs=0.05)
    assert degrees(yaw.lower.value) == pytest.approx(-degrees(REACH + pi / 2 - atan2(11, 50)), abs=0.05)
    assert yaw.upper.parts == ("housing", "pitch_motor/stator")
    assert pitch.status == "unbounded"
    assert seeker.simulation.collisions == ()


def test_the_twin_whose_arm_is_too_long_is_stopped_by_the_arm(derive_design):
    design = derive_design(FIXTURES / "seeker" / "4_gimbal" / "gimbal_hits_housing" / "seeker.toml")
    yaw, pitch = design.simulation.ranges
    assert degrees(yaw.lower.value) == pytest.approx(-degrees(atan2(54, 14) - acos(40 / hypot(14, 54))), abs=0.05)
    assert yaw.lower.parts == ("housing", "outer_gimbal")
    assert degrees(yaw.upper.value) == pytest.approx(degrees(REACH - pi / 2 - atan2(11, 50)), abs=0.05)
    assert pitch.status == "unbounded"
    found = design.report.findings
    assert [f.code for f in found if f.code in ("KF412", "KF505", "KF904")] == ["KF412"]
    assert [f.code for f in found].count("KF423") == 1


def test_a_range_that_the_housing_cuts_short_and_a_run_into_it_are_findings(seeker):
    function = seeker.assembly.function
    yaw = next(joint for joint in function.joints if joint.name == "yaw")
    others = tuple(joint for joint in function.joints if joint is not yaw)

    def asked(limit):
        joints = (replace(yaw, range=(-limit, limit)), *others)
        drives = tuple(
            replace(d, law=Law("sine", amplitude=degrees(limit), frequency=0.5)) if d.joint == "yaw" else d
            for d in function.drives
        )
        design = moved(seeker, function=replace(function, joints=joints, drives=drives))
        return design, {f.code: f for f in check(design).findings}

    design, codes = asked(45 * pi / 180)
    assert {"KF412", "KF505"} <= set(codes)
    assert "KF904" not in codes
    met = design.simulation.collisions[0]
    stop = REACH - pi / 2 - atan2(11, 50)
    assert met.time == pytest.approx(asin(stop / (45 * pi / 180)) / pi, abs=1e-3)
    assert met.parts == ("housing", "pitch_motor/stator")
    assert 0.0 < met.depth < 0.01
    assert not {"KF412", "KF505", "KF904"} & set(asked(38 * pi / 180)[1])


FREE = ["revolute_collars", "revolute_cone", "prismatic_spline", "prismatic_dovetail", "screw_right",
        "revolute_fork", "prismatic_hexagon", "prismatic_drawer"]  # fmt: skip


@pytest.mark.parametrize(("frequency", "speed"), [(50.0, None), (None, 2 * pi / 0.02)])
def test_what_happens_between_output_times_is_not_missed(seeker, frequency, speed):
    """At each output time the yaw is where it began: after a whole oscillation, or a whole turn."""
    function = seeker.assembly.function
    sine = Law("sine", amplitude=60.0, frequency=frequency or 0.0)
    law = sine if speed is None else Law("ramp", rate=degrees(speed))
    drives = tuple(replace(d, law=law) for d in function.drives if d.joint == "yaw")
    request = replace(seeker.assembly.simulation or SimulationRequest(), duration=0.04, step=0.02)
    design = moved(seeker, function=replace(function, drives=drives), simulation=request)
    assert abs(np.sin(design.simulation.joint_position[:, 0])).max() < 1e-9
    met = design.simulation.collisions[0]
    stop = REACH - pi / 2 - atan2(11, 50)
    first = asin(stop / (pi / 3)) / (2 * pi * frequency) if speed is None else stop / speed
    assert met.parts == ("housing", "pitch_motor/stator")
    assert met.time == pytest.approx(first, rel=0.01)


def test_a_motion_too_fast_for_its_output_times_leaves_collisions_unknown(seeker):
    function = seeker.assembly.function
    drives = tuple(replace(d, law=Law("ramp", rate=360.0 * 1e6)) for d in function.drives if d.joint == "yaw")
    request = replace(seeker.assembly.simulation or SimulationRequest(), duration=0.04, step=0.02)
    design = moved(seeker, function=replace(function, drives=drives), simulation=request)
    assert not design.simulation.collisions
    unknown = {item[:2]: item[2] for item in design.simulation.uncollided}
    assert ("housing", "pitch_motor/stator") in unknown


@pytest.mark.parametrize("name", first(5, FREE))
def test_mating_surfaces_stop_nothing(derive_design, name):
    design = derive_design(FIXTURES / "pairs" / name / f"{name}.toml")
    assert [item.status for item in design.simulation.ranges] == ["unbounded"]


def test_a_slider_crank_turns_freely_and_its_slider_goes_by_twice_the_crank(derive_design):
    design = derive_design(FIXTURES / "mechanisms" / "slider_crank" / "slider_crank.toml")
    known = {item.joint: item for item in design.simulation.ranges}
    slide = known["frame~slider_unit"]
    assert slide.upper.value - slide.lower.value == pytest.approx(0.050, abs=2e-6)
    assert slide.upper.parts == ()
    assert known["crank_unit~frame"].status == "unbounded"


def loose_pins(extra=None):
    """A crank of 20 mm, a coupler of 70 mm and a slider on y = 0; `extra` is added to the frame. The pin
    between coupler and slider is loose in both."""
    c, s = 20.0 * np.cos(0.9), 20.0 * np.sin(0.9)
    x = c + np.sqrt(70.0**2 - s**2)
    tilt = np.degrees(np.arctan2(-s, x - c))
    frame = box(-30, 130, -14, 14, -12, -8) + rod(5, -9, 4) + rod(8, 4, 6)
    frame += box(40, 130, -14, -8, -9, 4) + box(40, 130, 8, 14, -9, 4)
    frame += box(40, 130, -14, -5, 4, 7) + box(40, 130, 5, 14, 4, 7) + box(40, 130, -14, 14, -9, -4)
    crank = box(0, 20, -4, 4, 0, 4) + rod(8, -8, 4) + rod(6, 0, 4).translate((20, 0, 0))
    crank = (crank - rod(5, -9, 5)).rotate((0, 0, np.degrees(0.9)))
    crank += (rod(3, 3, 12) + rod(5, 12, 14)).translate((c, s, 0))
    coupler = box(0, 70, -4, 4, 8, 12) + rod(6, 8, 12) + rod(6, 8, 12).translate((70, 0, 0))
    crank += rod(5, 3, 8).translate((c, s, 0))
    coupler -= rod(3, 7, 13) + rod(3, 7, 13).translate((70, 0, 0))
    coupler = coupler.rotate((0, 0, tilt)).translate((c, s, 0))
    slider = (box(-10, 10, -8, 8, -4, 4) + box(-10, 10, -5, 5, 3, 8) - rod(3, -5, 9)).translate((x, 0, 0))
    pin = (rod(3, -3.5, 12) + rod(5, 12, 14)).translate((x, 0, 0))
    return {"frame": frame if extra is None else frame + extra, "crank": crank, "coupler": coupler, "slider": slider,
            "pin": pin}, x  # fmt: skip


def test_a_pin_that_spins_on_itself_leaves_the_ranges_of_its_loop_known():
    solids, _ = loose_pins()
    items, kin = found(**solids)
    assert kin.mobility.idle_bodies == ("pin",)
    known = {item.joint: item for item in items}
    slide = known["frame~slider"]
    assert (slide.lower.status, slide.upper.status) == ("found", "found")
    assert slide.upper.value - slide.lower.value == pytest.approx(0.040, abs=2e-6)
    assert known["crank~frame"].status == "unbounded"
    spinning = [j.name for j in kin.joints if "pin" in j.bodies and j.type == "revolute"]
    assert spinning and {known[name].status for name in spinning} == {"unbounded"}


def test_a_loop_with_a_loose_pin_stops_where_its_slider_meets_a_stop():
    solids, x = loose_pins(box(96, 110, -9, 9, -5, 3))
    items, kin = found(**solids)
    known = {j.name: (i, j) for i, j in zip(items, kin.joints, strict=True)}
    item, joint = known["frame~slider"]
    _, upper = ends(joint, np.array([1.0, 0, 0]), item)
    assert upper.value == pytest.approx((86.0 - x) / 1000, abs=1e-6)
    assert upper.parts == ("frame", "slider")
    stop = acos((20.0**2 + 86.0**2 - 70.0**2) / (2 * 20.0 * 86.0))
    item, joint = known["crank~frame"]
    turned = sorted(abs(end.value) for end in (item.lower, item.upper))
    assert turned == pytest.approx([0.9 - stop, 2 * pi - stop - 0.9], abs=1e-4)


def hinge_with_a_pin(groups=()):
    """Two leaves on a loose pin with heads, whose hinge states a range, as it is judged."""
    leaf = rod(10, 0, 10, 32) + box(0, 60, -4, 4, 0, 10) - rod(5, -1, 11, 32)
    pin = rod(5, -1, 21, 32) + rod(8, -4, 0, 32) + rod(8, 20, 24, 32)
    other, X = leaf.rotate((0, 0, 180)).translate((0, 0, 10)), np.eye(4)
    made = assembly(part("a", leaf, X), part("b", other, X), part("pin", pin, X))
    z, zero = np.array([0.0, 0.0, 1.0]), np.zeros(3)
    hinge = IntendedJoint("hinge", ("a", "b"), "revolute", z, None, zero, None, (-1.0, 1.0), "m.toml", 1)
    made = replace(made, ground="a", function=Function(joints=(hinge,)), groups=groups)
    design = stages.mass(stages.joints(stages.contacts(stages.import_assembly(made))))
    return {f.code: f for f in check(stages.simulate(design, ranges=True)).findings}


def test_a_hinge_on_a_loose_pin_has_a_range_once_the_pin_is_fastened():
    assert hinge_with_a_pin()["KF904"].subject == ("hinge",)
    fastened = hinge_with_a_pin((Group("leaf", ("a", "pin"), Source("m.toml", 1)),))
    assert not {"KF401", "KF402", "KF412", "KF904"} & set(fastened)


@pytest.mark.parametrize(
    ("seed", "family", "known"), [(1392, None, True), pytest.param(74, "revolute", False, marks=pytest.mark.sweep)]
)
def test_what_is_told_ahead_of_parts_in_touch_changes_nothing(seed, family, known, tmp_path, monkeypatch):
    """A clevis of coarse facets that scrape on each other on the way, and a hinge whose parts overlap as they are
    drawn."""
    path = random_assemblies.case(seed, family, wear=Wear(coarse=True)).write(tmp_path)
    design = stages.joints(stages.contacts(stages.import_(path)))
    asked, expect = [], States.expect
    monkeypatch.setattr(States, "expect", lambda self, places, least: (asked.append(1), expect(self, places, least)))
    told = []
    for steps in (STEPS_TOUCHED, 10**9):
        monkeypatch.setattr("kinform.collisions.pair.advancement.STEPS_TOUCHED", steps)
        asked.clear()
        (item,) = collisions.ranges(design.assembly, design.surfaces, design.contacts, design.kinematics)
        assert (item.lower.status == "found") == known
        assert bool(asked) == (steps < 10**9)
        told.append([(end.status, end.value, end.parts, end.reason) for end in (item.lower, item.upper)])
    assert told[0] == told[1]


def test_what_spins_between_parts_that_do_not_move_spins_freely(derive_design):
    """Bolts and dowels hold a flange: no joint of their loops moves but by their own spin."""
    design = derive_design(FIXTURES / "mechanisms" / "dowelled_flange" / "dowelled_flange.toml")
    found = {item.joint: item for item in design.simulation.ranges}
    spinning = [f"base~dowel_{k}" for k in (1, 2)] + [f"bolt_{k}~flange" for k in (1, 2, 3, 4)]
    assert [found[name].status for name in spinning] == ["unbounded"] * 6


@diagonal(overlap=[0.0, 0.05], backwards=[False, True])
def test_the_range_of_a_door_that_is_drawn_shut_begins_there(overlap, backwards):
    """Also where the leaf is drawn a little into its jamb: the end, and `at_stop`, are to the same side."""
    lugs = box(-8, 8, -8, 8, -16, -6) + box(-8, 8, -8, 8, 6, 16) + box(-8, 8, 8, 14, -16, 16)
    frame = lugs + box(-2, 4, -40, -8, 6, 16) - rod(4.05, -17, 17, 48) + box(-2 - overlap, 4, -40, -30, -8, 16)
    leaf = rod(7, -5.95, 5.95, 48) + rod(4, -15, 15, 48) + box(-6, -2, -60, -5, -4, 4)
    names = ("z", "leaf") if backwards else ("frame", "leaf")
    (item,), derived = found(random_pose(np.random.default_rng(2), 0.1), **dict(zip(names, (frame, leaf), strict=True)))
    (joint,) = derived.joints
    (sense,) = {stop.sense for stop in joint.at_stop}
    here, away = (item.upper, item.lower) if sense > 0 else (item.lower, item.upper)
    assert (here.status, away.status) == ("found", "found")
    assert abs(here.value) < radians(0.02)
    assert -sense * away.value > radians(90)
