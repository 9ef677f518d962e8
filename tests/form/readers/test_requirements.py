"""Requirements that contradict themselves, or ask for nothing, are refused at the line of their key."""

from __future__ import annotations

import pytest
from support.manifests import stated_joint

from kinform.errors import InputError
from kinform.form import load

HEAD = (
    """schema = 1
[assembly]
name = "x"
units = "mm"
[[part]]
name = "a"
[[part]]
name = "b"
"""
    + stated_joint("j", ("a", "b"), "revolute")
    + """[[function.require]]
name = "r"
"""
)
POINT, DIRECTION = (f'kind = "reach"\npart = "b"\n{key}\n' for key in ("point = [0, 0, 0]", "direction = [1, 0, 0]"))
CONE = "region = {type = 'cone', axis = [1, 0, 0], half_angle = 5}"
ORIGIN = "points = [[0, 0, 0]]"
WRONG = {
    "bounds the wrong way round": ('kind = "mass"\nminimum = 2\nmaximum = 1', 2),
    "fit the wrong way round": ('kind = "fit"\nbetween = ["a", "b"]\nminimum = 0.2\nmaximum = -0.1', 3),
    "no bounds": ('kind = "inertia"\naxis = [0, 0, 1]', 0),
    "point and direction": (
        POINT + "direction = [1, 0, 0]\nregion = {type = 'poses', " + ORIGIN + "}", 0,
    ),
    "neither point nor direction": ('kind = "reach"\npart = "b"\n' + CONE, 0),
    "cone of points": (POINT + CONE, 4),
    "box of directions": (
        DIRECTION + "region = {type = 'box', lower = [0, 0, 0], upper = [1, 1, 1]}", 4,
    ),
    "box inside out": (POINT + "region = {type = 'box', lower = [0, 2, 0], upper = [1, 1, 1]}", 4),
    "no poses": (POINT + "region = {type = 'poses', points = []}", 4),
    "poses that would not be looked at": (
        POINT + "region = {type = 'poses', directions = [[1, 0, 0]], " + ORIGIN + "}", 4,
    ),
    "tolerance that says nothing": (DIRECTION + "tolerance = 1\n" + CONE, 4),
    "reaction without limit": ('kind = "reaction"\njoint = "j"', 0),
    "curve of other lengths": (
        'kind = "torque_speed"\njoint = "j"\nspeeds = [0, 1]\nefforts = [2, 1, 0]', 4,
    ),
    "curve that begins late": (
        'kind = "torque_speed"\njoint = "j"\nspeeds = [1, 2]\nefforts = [2, 1]', 3,
    ),
    "curve that grows": (
        'kind = "torque_speed"\njoint = "j"\nspeeds = [0, 2]\nefforts = [1, 2]', 4,
    ),
    "balance without axis": (
        'kind = "balance"\nof = "b"\naxis = [0, 0, 1]\nlimit = 1', 0,
    ),
    "balance with two axes": (
        'kind = "balance"\nof = "b"\njoint = "j"\naxis = [0, 0, 1]\npoint = [0, 0, 0]\nlimit = 1', 3,
    ),
    "fit of a part with itself": ('kind = "fit"\nbetween = ["a", "a"]\nminimum = 0', 2),
    "clear of a part with itself": ('kind = "clear"\nbetween = ["a", "a"]', 2),
}  # fmt: skip
"""By what is wrong: the requirement, and the line after `name` of its key, 0 for the table."""


@pytest.mark.parametrize("case", WRONG)
def test_a_requirement_that_makes_no_sense_is_refused(tmp_path, case):
    text, after = WRONG[case]
    (tmp_path / "m.toml").write_text(HEAD + text + "\n")
    with pytest.raises(InputError) as caught:
        load(tmp_path / "m.toml")
    (problem,) = caught.value.problems
    assert '"r"' in problem.message
    assert problem.line == (15 if after == 0 else 16 + after)
    assert problem.remedy
