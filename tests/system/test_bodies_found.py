"""What each command says of bodies that follow from the stated joints, and of joints that are taken as stated."""

from __future__ import annotations

import json

import pytest
from kinematics.partition.test_bodies import stack
from support.solids import save

from kinform_cli.main import main

JOINT = """
[function]
complete = true
[[function.joint]]
name = "turn"
between = ["base", "low"]
type = "revolute"
axis = [0, 0, 1]
point = [0, 0, 0]
range = [-30, 30]
[[function.drive]]
joint = "turn"
kind = "motion"
law = {type = "ramp", rate = 20}
[[function.require]]
name = "the cover stays"
kind = "retained"
part = "cover"
directions = []
[[function.require]]
name = "the arm stays"
kind = "retained"
part = "high"
directions = []
[simulation]
duration = 1.0
step = 0.1
"""


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    """An arm of plates and bolts that only its pivot guides."""
    folder = tmp_path_factory.mktemp("arm")
    lines = ['schema = 1\n[assembly]\nname = "arm"\nunits = "mm"\nground = "base"']
    for name, solid in stack(lift=2.0).items():
        save(solid, folder / f"{name}.stl")
        lines.append(f'[[part]]\nname = "{name}"\nmesh = "{name}.stl"\nmaterial = "aluminium"')
    (folder / "arm.toml").write_text("\n".join(lines) + JOINT)
    main(["run", str(folder / "arm.toml"), "-o", str(folder / "arm.h5"), "-q"])
    return folder / "arm.h5"


def shown(arm, capsys, *words):
    capsys.readouterr()
    assert main(["show", str(arm), *words]) == 0
    return capsys.readouterr().out


def test_bodies_and_the_joint_say_that_they_follow_from_what_is_stated(arm, capsys):
    bodies = json.loads(shown(arm, capsys, "bodies", "--format", "json"))["bodies"]
    assert {frozenset(body["parts"]) for body in bodies} == {
        frozenset({"base", "cover"}), frozenset({"low", "high", "bolt_1", "bolt_2"}),
    }  # fmt: skip
    joints = json.loads(shown(arm, capsys, "joints", "--format", "json"))["joints"]
    assert {joint["status"] for joint in joints} == {"stated"}


def test_what_comes_apart_are_bodies_and_no_parts_of_them(arm, capsys):
    """Contact that no stated joint moves holds: a cover that lies on the base does not leave it."""
    values = json.loads(shown(arm, capsys, "joints", "--format", "json"))
    names = {body for joint in values["joints"] for body in joint["bodies"]}
    assert names.issuperset(body for one in values["separations"] for body in one["bodies"])


def test_a_joint_that_is_taken_as_stated_is_not_asked_to_be_stated(arm, capsys):
    found = {one["code"]: one for one in json.loads(shown(arm, capsys, "findings", "--format", "json"))["findings"]}
    assert found["KF414"]["subject"] == ["turn"]
    assert not {"KF416", "KF401"} & found.keys()
