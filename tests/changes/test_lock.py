"""A lock accepts the behaviour that it was made of, and nothing else; people can read it."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest
from support.diagonal import first
from support.places import FIXTURES

from kinform.changes import Tolerance, compare, read_lock, snapshot, with_lock, write_lock
from kinform.consistency import verdict
from kinform.errors import InputError


@pytest.fixture(scope="module")
def four_bar(derive_design):
    return derive_design(FIXTURES / "mechanisms" / "four_bar" / "four_bar.toml")


@pytest.mark.parametrize(
    "manifest", first(1, ["pairs/spherical_captive/spherical_captive.toml", "mechanisms/four_bar/four_bar.toml"])
)
@pytest.mark.parametrize("tolerances", [[], ["1um", "0.001deg", "0.001%"], ["1mm", "2deg", "10%"]], ids=str)
def test_a_lock_accepts_what_it_was_made_of_and_its_bytes_are_stable(manifest, tolerances, derive_design):
    behaviour = snapshot(derive_design(FIXTURES / manifest))
    text = write_lock(behaviour, Tolerance.of(tolerances)) if tolerances else write_lock(behaviour)
    lock = read_lock(text, "b.json")
    assert compare(lock.behaviour, behaviour, lock.tolerance).changes == ()
    assert write_lock(lock.behaviour, lock.tolerance) == text


def test_a_lock_is_json_with_a_line_a_body_and_a_joint(four_bar):
    text = write_lock(snapshot(four_bar))
    found = json.loads(text)
    assert found["schema"] == "kinform/behaviour-lock/1"
    names = [joint["name"] for joint in found["joints"]]
    assert names == [joint.name for joint in four_bar.kinematics.joints]
    for name in names:
        assert sum(f'"name": "{name}"' in line for line in text.splitlines()) == 1
    (crank,) = [body for body in found["bodies"] if "crank" in body["parts"]]
    mass = next(body.mass for body in four_bar.mass.bodies if body.name == crank["name"])
    assert crank["mass_g"] == pytest.approx(1e3 * mass, rel=5e-4)
    assert len(str(crank["mass_g"])) <= 7


@pytest.mark.parametrize("kind", ["mass", "axis", "type", "pair"])
def test_what_differs_from_the_lock_is_an_error_of_the_gate(kind, four_bar):
    locked = snapshot(four_bar)
    joint = locked.joints[0]
    edited = {
        "mass": replace(locked, masses=tuple(replace(b, mass=b.mass * 1.1) for b in locked.masses)),
        "axis": replace(
            locked, joints=(replace(joint, axis=replace(joint.axis, point=(0.0, 0.9, 0.0))), *locked.joints[1:])
        ),
        "type": replace(locked, joints=(replace(joint, type="spherical", freedoms=3), *locked.joints[1:])),
        "pair": replace(locked, interferences=((("a", "b"), 1e-3),)),
    }[kind]  # fmt: skip
    report = with_lock(four_bar.report, four_bar, read_lock(write_lock(edited), "b.json"))
    found = [finding for finding in report.findings if finding.code == "KF450"]
    assert found
    assert all(finding.severity == "error" and finding.file == "b.json" for finding in found)
    assert verdict(report) == 1
    assert next(rule.outcome for rule in report.rules if rule.code == "KF450") == "failed"


def test_the_same_behaviour_passes_and_an_unknown_one_is_not_verified(four_bar):
    lock = read_lock(write_lock(snapshot(four_bar)), "b.json")
    report = with_lock(four_bar.report, four_bar, lock)
    assert report.findings == four_bar.report.findings
    assert next(rule.outcome for rule in report.rules if rule.code == "KF450") == "passed"
    bare = with_lock(four_bar.report, replace(four_bar, mass=None), lock)
    assert next(rule.outcome for rule in bare.rules if rule.code == "KF450") == "inconclusive"


def test_unbounded_ranges_survive(four_bar):
    behaviour = snapshot(four_bar)
    joint = replace(behaviour.joints[0], range_lower=-math.inf, range_upper=math.inf, range_status="unbounded")
    other = replace(behaviour.joints[1], range_lower=-0.25, range_upper=0.5, range_status="found")
    behaviour = replace(behaviour, joints=(joint, other, *behaviour.joints[2:]))
    lock = read_lock(write_lock(behaviour), "b.json")
    assert compare(lock.behaviour, behaviour, lock.tolerance).changes == ()
    assert lock.behaviour.joints[0].range_upper == math.inf


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"schema": "kinform/behaviour-lock/9"}', '{"schema": "kinform/behaviour-lock/1"}']
)
def test_what_is_no_lock_is_refused_by_name(text):
    with pytest.raises(InputError) as caught:
        read_lock(text, "b.json")
    assert [problem.file for problem in caught.value.problems] == ["b.json"]


@pytest.mark.parametrize(
    "edit",
    [
        lambda lock: lock["tolerances"].update(length_mm=math.nan),
        lambda lock: lock["tolerances"].update(length_mm=-0.1),
        lambda lock: lock["tolerances"].update(mass_percent=-1),
        lambda lock: lock["mobility"].update(effective="one"),
        lambda lock: lock["mobility"].update(effective=1.5),
        lambda lock: lock["joints"][0].update(axis=[0, 0, 0]),
        lambda lock: lock["bodies"][0].pop("mass_g"),
    ],
)
def test_a_lock_edited_into_one_that_would_pass_anything_is_refused(four_bar, edit):
    lock = json.loads(write_lock(snapshot(four_bar)))
    edit(lock)
    with pytest.raises(InputError):
        read_lock(json.dumps(lock), "b.json")


def test_a_joint_whose_axis_was_taken_out_of_the_lock_differs(four_bar):
    lock = json.loads(write_lock(snapshot(four_bar)))
    del lock["joints"][0]["axis"]
    report = with_lock(four_bar.report, four_bar, read_lock(json.dumps(lock), "b.json"))
    (found,) = (finding for finding in report.findings if finding.code == "KF450")
    assert found.subject == (lock["joints"][0]["name"],)
    assert found.severity == "error"
