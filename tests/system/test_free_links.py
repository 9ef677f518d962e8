"""Links that a description leaves free: what contact holds is told (KF417), what it only carries is not."""

from __future__ import annotations

import pytest
from tests.support.robots import ring

from kinform import form, stages
from kinform.consistency import RULES
from kinform.consistency.context import Context
from kinform.design import Design

(RULE,) = (rule for rule in RULES if rule.code == "KF417")
TURNED = ['xyz="0 0 0" rpy="0 0 0"', 'xyz="0.3 -0.2 0.1" rpy="0.4 -0.7 2"']
"""Poses of all of it in the root link."""
PIN = '<geometry><cylinder radius="0.01" length="0.06"/></geometry>'
CUBE = '<geometry><box size="0.04 0.04 0.04"/></geometry>'


def derived(path):
    return stages.joints(stages.contacts(Design(form.load(path))))


def found(path):
    return RULE.outcome(Context(derived(path))).findings


def urdf(folder, shape, at, kind="floating", placed=TURNED[0], ground="ring.obj", more=""):
    (folder / "ring.obj").write_text(ring(0.01, 0.03, 0.06))
    (folder / "angle.obj").write_text(ANGLE)
    path = folder / "r.urdf"
    path.write_text(
        f'<robot name="r">\n<link name="root"/>\n<link name="base"><visual><geometry><mesh filename="{ground}"/>'
        f'</geometry></visual></link>\n<link name="pin"><visual><origin xyz="{at}"/>{shape}</visual></link>\n'
        f'<joint name="set" type="fixed"><parent link="root"/><child link="base"/><origin {placed}/></joint>\n'
        f'<joint name="j" type="{kind}"><parent link="base"/><child link="pin"/><axis xyz="0 0 1"/></joint>\n'
        f"{more}</robot>\n"
    )
    return path


ANGLE = """v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nv 0 0 -0.01\nv 0.1 0 -0.01\nv 0.1 0.1 -0.01\nv 0 0.1 -0.01
v 0 0 0.1\nv 0 0.1 0.1\nv -0.01 0 -0.01\nv -0.01 0.1 -0.01\nv -0.01 0 0.1\nv -0.01 0.1 0.1
f 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 1 4 10 9\nf 9 10 14 13\nf 11 13 14 12\nf 5 11 12 8
f 1 9 13 11 5\nf 4 8 12 14 10
"""
"""A floor, and a wall on one side of it."""


@pytest.mark.parametrize("placed", TURNED)
def test_a_pin_in_a_bore_is_not_free(tmp_path, placed):
    (one,) = found(urdf(tmp_path, PIN, "0 0 0.03", placed=placed))
    assert (one.severity, one.subject, one.line) == ("error", ("pin", "base"), 4)
    assert one.place is not None


@pytest.mark.parametrize("kind", ["continuous", "planar", "fixed"])
def test_a_link_on_any_other_joint_is_not_looked_at(tmp_path, kind):
    assert not found(urdf(tmp_path, PIN, "0 0 0.03", kind))


@pytest.mark.parametrize("placed", TURNED)
@pytest.mark.parametrize(
    ("shape", "at", "ground"),
    [
        pytest.param(CUBE, "0 0 0.08", "ring.obj", id="on a face"),
        pytest.param(CUBE, "0.02 0.05 0.02", "angle.obj", id="on a floor, against a wall"),
        pytest.param(PIN, "0.1 0 0.03", "ring.obj", id="beside it"),
    ],
)
def test_a_link_that_can_be_lifted_off_is_free(tmp_path, shape, at, ground, placed):
    path = urdf(tmp_path, shape, at, placed=placed, ground=ground)
    assert not found(path)
    assert ground == "ring.obj" or len(derived(path).contacts.patches) == 2


def test_a_link_that_carries_others_is_told_once(tmp_path):
    more = '<link name="cap"/>\n<joint name="k" type="fixed"><parent link="pin"/><child link="cap"/></joint>\n'
    assert len(found(urdf(tmp_path, PIN, "0 0 0.03", more=more))) == 1


BODY = '<body name="pin" pos="0 0 0.03">{joint}<geom name="pin" type="cylinder" size="0.01 0.03"/></body>'
MJCF = """<mujoco><asset><mesh name="ring" file="ring.obj"/></asset>
<worldbody>
<body name="base"><geom type="mesh" mesh="ring"/></body>
{body}
</worldbody>
{more}
</mujoco>
"""


@pytest.mark.parametrize(
    ("joint", "more", "count"),
    [
        ("<freejoint/>", "", 1),
        ('<joint type="free"/>', "", 1),
        ("<freejoint/>", '<equality><weld body1="base" body2="pin"/></equality>', 0),
        ('<joint type="hinge"/>', "", 0),
    ],
)
def test_a_body_with_a_free_joint_is_told_unless_an_equality_holds_it(tmp_path, joint, more, count):
    (tmp_path / "ring.obj").write_text(ring(0.01, 0.03, 0.06))
    path = tmp_path / "r.xml"
    path.write_text(MJCF.format(body=BODY.format(joint=joint), more=more))
    assert [f.severity for f in found(path)] == ["warning"] * count


def test_links_of_an_sdf_that_no_joint_names_are_told(tmp_path):
    (tmp_path / "ring.obj").write_text(ring(0.01, 0.03, 0.06))
    path = tmp_path / "r.sdf"
    joint = (
        '<joint name="j" type="revolute"><parent>base</parent><child>pin</child><axis><xyz>0 0 1</xyz></axis></joint>'
    )
    text = (
        '<sdf version="1.9"><model name="m"><link name="base"><visual name="v"><geometry><mesh><uri>ring.obj</uri>'
        '</mesh></geometry></visual></link><link name="pin"><pose>0 0 0.03 0 0 0</pose><visual name="w"><geometry>'
        "<cylinder><radius>0.01</radius><length>0.06</length></cylinder></geometry></visual></link>{}</model></sdf>"
    )
    path.write_text(text.format(""))
    assert [f.severity for f in found(path)] == ["warning"]
    path.write_text(text.format(joint))
    assert not found(path)
