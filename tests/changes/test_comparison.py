"""What changed in behaviour, of behaviours written by hand and of fixtures that were edited."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest
from markdown_it import MarkdownIt

from kinform.changes import Snapshot, Tolerance, compare, render
from kinform.changes.behaviours import Axis, BodyMass, JointState

HINGE = JointState(
    "door~frame", ("door", "frame"), "revolute", "determined", 1, Axis((0.0, 0.0, 1.0), (0.1, 0.0, 0.5)),
    None, None, None,
    math.radians(-90.0), math.radians(30.0), "found",
)  # fmt: skip
SLIDE = JointState(
    "drawer~frame", ("drawer", "frame"), "prismatic", "determined", 1, Axis((1.0, 0.0, 0.0), None), None, None, None,
    -0.1, 0.2, "found",
)  # fmt: skip
DESK = Snapshot(
    assembly="desk",
    bodies=(("door", ("door",)), ("drawer", ("drawer", "knob")), ("frame", ("frame",))),
    ground="frame",
    joints=(HINGE, SLIDE),
    mobility=(("instantaneous", 2), ("finite", 2), ("effective", 2), ("idle", 0), ("redundant", 0),
              ("blocked_mobility", 2)),
    masses=(
        BodyMass("door", 1.5, (0.0, 0.2, 0.0), (1e-3, 2e-3, 2.5e-3)),
        BodyMass("drawer", 0.4, (0.1, 0.0, 0.0), (1e-4, 2e-4, 2.5e-4)),
        BodyMass("frame", None, None, None),
    ),
    interferences=((("door", "frame"), 1e-4),),
    simulation=("done", "dynamic"),
    findings=(("KF304", ("door",), "note", 1),),
    ranges=("door~frame", "drawer~frame"),
)  # fmt: skip


def with_joint(joint, **fields):
    joints = tuple(replace(j, **fields) if j is joint else j for j in DESK.joints)
    return replace(DESK, joints=joints)


def told(after, before=DESK, *tolerances):
    found = compare(before, after, Tolerance.of(tolerances))
    return [(change.kind, change.subject[0]) for change in found.changes]


def test_a_behaviour_is_the_same_as_itself():
    found = compare(DESK, DESK)
    assert (found.changes, found.missing, found.code) == ((), (), 0)


CASES = {
    "type": (with_joint(HINGE, type="cylindrical", freedoms=2),
             [("joint-type", "door~frame")]),
    "status": (with_joint(HINGE, status="blocked"), [("joint-status", "door~frame")]),
    "axis beside": (
        with_joint(HINGE, axis=Axis((0.0, 0.0, 1.0), (0.1003, 0.0, 0.9))),
        [("axis-moved", "door~frame")],
    ),
    "axis tilted about its point": (
        with_joint(HINGE, axis=Axis((math.sin(0.01), 0.0, math.cos(0.01)), (0.1, 0.0, 0.5))),
        [("axis-tilted", "door~frame")],
    ),
    "upper end": (with_joint(HINGE, range_upper=math.radians(26.0)),
                  [("range", "door~frame")]),
    "lower end of a slide": (with_joint(SLIDE, range_lower=-0.098),
                             [("range", "drawer~frame")]),
    "free": (
        with_joint(HINGE, range_upper=math.inf),
        [("range", "door~frame")],
    ),
    "gone": (replace(DESK, joints=(HINGE,)), [("joint-gone", "drawer~frame")]),
    "mobility": (
        replace(DESK, mobility=(("effective", 1), *DESK.mobility[3:])),
        [("mobility", "effective")],
    ),
    "heavier": (
        replace(DESK, masses=(replace(DESK.masses[0], mass=1.512), *DESK.masses[1:])),
        [("mass", "door")],
    ),
    "weight unknown": (
        replace(DESK, masses=(replace(DESK.masses[0], mass=None), *DESK.masses[1:])),
        [("mass", "door")],
    ),
    "centre": (
        replace(DESK, masses=(replace(DESK.masses[0], centre_of_mass=(0.0, 0.2, 0.001)), *DESK.masses[1:])),
        [("centre-of-mass", "door")],
    ),
    "inertia": (
        replace(DESK, masses=(replace(DESK.masses[0], principal_moments=(1e-3, 2e-3, 2e-3)), *DESK.masses[1:])),
        [("inertia", "door")],
    ),
    "collision": (
        replace(DESK, interferences=((("door", "drawer"), 2e-3), *DESK.interferences)),
        [("interference-new", "door")],
    ),
    "perhaps no collision": (
        replace(DESK, interferences=(), possible_overlaps=(("door", "frame"),)),
        [("interference-gone", "door")],
    ),
    "no collision": (replace(DESK, interferences=()), [("interference-gone", "door")]),
    "deeper": (replace(DESK, interferences=((("door", "frame"), 3e-4),)),
               [("interference", "door")]),
    "refused": (replace(DESK, simulation=("refused", "")),
                [("simulation", "simulation")]),
    "findings": (
        replace(DESK, findings=(("KF402", ("hinge",), "error", 1),)),
        [
            ("finding-gone", "KF304"),
            ("finding-new", "KF402"),
        ],
    ),
    "ground": (replace(DESK, ground="door"), [("ground", "door")]),
}  # fmt: skip


AMOUNTS = {
    "type": (1.0, "freedoms"), "axis beside": (3e-4, "m"), "axis tilted about its point": (0.01, "rad"),
    "upper end": (-math.radians(4.0), "rad"), "lower end of a slide": (2e-3, "m"), "free": (None, None),
    "mobility": (-1.0, "freedoms"), "heavier": (0.012, "kg"), "weight unknown": (None, None), "centre": (1e-3, "m"),
    "collision": (2e-3, "m"), "no collision": (-1e-4, "m"), "deeper": (2e-4, "m"),
}  # fmt: skip
"""By case how much has changed, and its unit."""


@pytest.mark.parametrize("case", CASES)
def test_a_change_is_told(case):
    after, expected = CASES[case]
    assert told(after) == expected
    if case in AMOUNTS:
        (change,) = compare(DESK, after).changes
        amount, unit = AMOUNTS[case]
        assert (change.amount, change.unit) == (amount if amount is None else pytest.approx(amount), unit)
    assert compare(DESK, after).code == 1
    assert compare(after, DESK).code == 1


def test_an_axis_that_points_the_other_way_has_not_moved_and_turns_the_range_round():
    other = Axis((0.0, 0.0, -1.0), (0.1, 0.0, -7.0))
    assert told(with_joint(HINGE, axis=other, range_lower=-HINGE.range_upper, range_upper=-HINGE.range_lower)) == []
    found = compare(DESK, with_joint(HINGE, axis=other)).changes
    assert [(change.kind, change.amount) for change in found] == [("range", pytest.approx(math.radians(60)))] * 2


@pytest.mark.parametrize("side", ["lower", "upper"])
def test_an_end_that_is_no_longer_known_is_told(side):
    after = with_joint(HINGE, **{f"range_{side}": None})
    assert [(kind, name) for kind, name in told(after)] == [("range", "door~frame")]
    assert compare(after, DESK).code == 1


def test_ranges_that_only_one_side_computed_are_no_change_and_not_verified():
    unranged = tuple(
        replace(joint, range_lower=None, range_upper=None, range_status="unknown") for joint in DESK.joints
    )
    found = compare(DESK, replace(DESK, joints=unranged, ranges=None))
    assert (found.changes, found.missing, found.code) == ((), (("ranges", "not computed after"),), 2)
    found = compare(replace(DESK, joints=unranged, ranges=None), DESK)
    assert (found.changes, found.missing, found.new, found.code) == ((), (), ("ranges",), 0)
    assert json.loads(render(found, "json"))["new"] == ["ranges"]
    found = compare(replace(DESK, joints=unranged, ranges=None), replace(DESK, joints=unranged))
    assert (found.changes, found.missing, found.new, found.code) == ((), (), (), 0)


def test_lengths_are_told_in_the_units_of_the_assembly():
    moved = with_joint(HINGE, axis=Axis((0.0, 0.0, 1.0), (0.1254, 0.0, 0.5)))
    (change,) = compare(DESK, replace(moved, units="in")).changes
    assert change.after == "(4.937, 0, 19.685) in"
    assert (change.amount, change.place) == (pytest.approx(0.0254), (0.1254, 0.0, 0.5))


def test_a_body_that_takes_in_another_has_fixed_their_joint():
    after = replace(
        DESK, bodies=(("door", ("door", "frame")), ("drawer", ("drawer", "knob"))), ground="door",
        joints=(replace(SLIDE, name="door~drawer", bodies=("door", "drawer")),), masses=DESK.masses[:2],
    )  # fmt: skip
    found = told(after)
    assert ("joint-type", "door~frame") in found
    assert not any(subject in ("drawer~frame", "door~drawer") and kind == "joint-gone" for kind, subject in found)


def test_a_body_with_a_new_name_keeps_its_joints_and_its_mass():
    renamed = replace(
        DESK, bodies=(*DESK.bodies[:1], ("bolt", ("bolt", "drawer", "knob")), DESK.bodies[2]),
        joints=(HINGE, replace(SLIDE, name="bolt~frame", bodies=("bolt", "frame"))),
        masses=(DESK.masses[0], replace(DESK.masses[1], name="bolt"), DESK.masses[2]),
    )  # fmt: skip
    assert told(renamed) == [
        ("body-renamed", "bolt"),
        ("body-parts", "bolt"),
    ]


def test_bodies_in_the_other_order_turn_the_range_round():
    turned = replace(
        HINGE,
        name="frame~gate",
        bodies=("frame", "gate"),
        range_lower=-HINGE.range_upper,
        range_upper=-HINGE.range_lower,
    )
    after = replace(
        DESK, bodies=(DESK.bodies[1], DESK.bodies[2], ("gate", ("door",))), joints=(SLIDE, turned),
        masses=(*DESK.masses[1:], replace(DESK.masses[0], name="gate")),
    )  # fmt: skip
    assert told(after) == [("body-renamed", "gate")]


@pytest.mark.parametrize(
    ("after", "tolerance"),
    [
        (CASES["axis beside"][0], "0.31mm"),
        (CASES["axis tilted about its point"][0], "0.58 deg"),
        (CASES["upper end"][0], "4.1°"),
        (CASES["heavier"][0], "12.1 g"),
        (CASES["heavier"][0], "1%"),
        (CASES["deeper"][0], "0.21mm"),
    ],
)
def test_within_the_tolerance_nothing_changed(after, tolerance):
    assert told(after, DESK, tolerance) == []


@pytest.mark.parametrize("text", ["", "mm", "1", "-1mm", "1 parsec", "nan mm", "1e999mm"])
def test_a_tolerance_that_is_none_is_refused(text):
    with pytest.raises(ValueError):  # noqa: PT011
        Tolerance.of([text])


def test_what_only_one_side_knows_is_not_verified():
    found = compare(DESK, replace(DESK, findings=None))
    assert (found.code, found.missing) == (2, (("findings", "not computed after"),))
    assert compare(replace(DESK, masses=None), replace(DESK, masses=None)).code == 0
    empty = Snapshot("x", None, None, None, None, None, None, None, None)
    assert compare(empty, empty).code == 2


def test_the_formats_tell_the_same():
    found = compare(DESK, CASES["axis beside"][0], Tolerance.of(["0.1mm"]))
    assert render(found, "full").splitlines() == [
        "door~frame: axis moved by 0.3 mm",
        "  (100, 0, 500) mm → (100.3, 0, 900) mm",
        "1 change of behaviour beyond 0.1 mm, 0.001°, 1e-06 g, 0.0001 %",
    ]
    (change,) = json.loads(render(found, "json"))["changes"]
    assert (change["kind"], change["unit"]) == ("axis-moved", "m")
    assert change["amount"] == pytest.approx(3e-4)
    tokens = MarkdownIt("commonmark").enable("table").parse(render(found, "md"))
    assert [t.content for t in tokens if t.type == "inline"][-4:-2] == ["`door~frame`", "axis moved by 0.3 mm"]


def test_names_survive_in_every_format():
    name = "[m6] <b> a|b\n::error::"
    after = replace(DESK, findings=(*DESK.findings, ("KF401", (name,), "error", 1)))
    found = compare(DESK, after)
    assert json.loads(render(found, "json"))["changes"][0]["subject"][1] == name
    assert "[m6] <b> a|b\\n\\x3a:error::" in render(found, "full")
    tokens = MarkdownIt("commonmark").enable("table").parse(render(found, "md"))
    spans = [c.content for t in tokens for c in t.children or () if c.type == "code_inline"]
    assert "[m6] <b> a|b\\n\\x3a:error::" in spans


def test_a_part_with_another_name_and_the_same_mesh_is_renamed_and_nothing_else():
    before = replace(DESK, shapes=(("door", "a"), ("drawer", "b"), ("frame", "c"), ("knob", "d")))
    hinge = replace(
        HINGE,
        name="frame~gate",
        bodies=("frame", "gate"),
        range_lower=-HINGE.range_upper,
        range_upper=-HINGE.range_lower,
    )
    gate = replace(
        before, bodies=(DESK.bodies[1], DESK.bodies[2], ("gate", ("gate",))),
        shapes=(*before.shapes[1:], ("gate", "a")),
        joints=(SLIDE, hinge),
        masses=(*DESK.masses[1:], replace(DESK.masses[0], name="gate")), ranges=("drawer~frame", "frame~gate"),
        interferences=((("frame", "gate"), 1e-4),), findings=(("KF304", ("gate",), "note", 1),),
    )  # fmt: skip
    assert told(gate, before) == [("part-renamed", "gate")]
    # another mesh is another part
    other = replace(gate, shapes=(*before.shapes[1:], ("gate", "z")))
    assert {"body-gone", "body-new", "joint-gone", "joint-new"} <= {kind for kind, _ in told(other, before)}
