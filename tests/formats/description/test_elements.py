"""Descriptions with numbers that are none, with the largest double for "no bound", and couplings of no joints."""

from __future__ import annotations

import pytest

from kinform.errors import InputError
from kinform.form import load

URDF = """<robot name="r">
<link name="a"><visual><geometry><box size="1 1 1"/></geometry></visual></link>
<link name="b"><visual><geometry><box size="1 1 1"/></geometry></visual></link>
<joint name="j" type="{type}"><parent link="a"/><child link="b"/><origin xyz="0 0 {z}"/><axis xyz="0 0 {axis}"/>
<limit lower="-{limit}" upper="{limit}" effort="{limit}" velocity="{limit}"/></joint>
</robot>
"""
PLAIN = {"type": "revolute", "z": "2", "axis": "1", "limit": "1.5"}


def loaded(tmp_path, **changed):
    (tmp_path / "r.urdf").write_text(URDF.format(**PLAIN | changed))
    return load(tmp_path / "r.urdf")


def test_the_largest_double_bounds_nothing(tmp_path):
    function = loaded(tmp_path, limit="1.7976931348623157e+308").function
    assert function.joints[0].range is None
    assert function.requirements == ()
    assert len(loaded(tmp_path).function.requirements) == 2


@pytest.mark.parametrize("changed", [{"z": "1e160"}, {"axis": "1e308"}, {"axis": "-1e19"}])
def test_places_beyond_all_places_are_told_with_their_line(tmp_path, changed, recwarn):
    with pytest.raises(InputError) as caught:
        loaded(tmp_path, **changed)
    assert 4 in [problem.line for problem in caught.value.problems]
    assert not list(recwarn)


def test_an_equality_of_a_joint_without_name(tmp_path):
    body = '<body name="{0}"><joint name="{0}" type="hinge"/><geom type="box" size="1 1 1"/></body>'
    (tmp_path / "m.xml").write_text(
        f'<mujoco model="m"><worldbody>{body.format("h")}</worldbody>\n'
        '<equality><joint joint2="h" polycoef="0 1 0 0 0"/></equality></mujoco>'
    )
    with pytest.raises(InputError):
        load(tmp_path / "m.xml")
