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
    "bounds the wrong way round": ('kind = "mass"\nminimum = 2\nmaximum = 1', "minimum, 2, is above", 2),
    "fit the wrong way round": ('kind = "fit"\nbetween = ["a", "b"]\nminimum = 0.2\nmaximum = -0.1', "is above", 3),
    "no bounds": ('kind = "inertia"\naxis = [0, 0, 1]', "neither minimum nor maximum", 0),
    "point and direction": (
        POINT + "direction = [1, 0, 0]\nregion = {type = 'poses', " + ORIGIN + "}", "either a point or a direction", 0,
    ),
    "neither point nor direction": ('kind = "reach"\npart = "b"\n' + CONE, "either a point or a direction", 0),
    "cone of points": (POINT + CONE, "region of directions", 4),
    "box of directions": (
        DIRECTION + "region = {type = 'box', lower = [0, 0, 0], upper = [1, 1, 1]}", "region of points", 4,
    ),
    "box inside out": (POINT + "region = {type = 'box', lower = [0, 2, 0], upper = [1, 1, 1]}", "lower corner", 4),
    "no poses": (POINT + "region = {type = 'poses', points = []}", "list no points", 4),
    "poses that would not be looked at": (
        POINT + "region = {type = 'poses', directions = [[1, 0, 0]], " + ORIGIN + "}", "list directions", 4,
    ),
    "tolerance that says nothing": (DIRECTION + "tolerance = 1\n" + CONE, "says nothing", 4),
    "reaction without limit": ('kind = "reaction"\njoint = "j"', "neither force nor torque", 0),
    "curve of other lengths": (
        'kind = "torque_speed"\njoint = "j"\nspeeds = [0, 1]\nefforts = [2, 1, 0]', "2 speeds and 3 efforts", 4,
    ),
    "curve that begins late": (
        'kind = "torque_speed"\njoint = "j"\nspeeds = [1, 2]\nefforts = [2, 1]', "ascend from 0", 3,
    ),
    "curve that grows": (
        'kind = "torque_speed"\njoint = "j"\nspeeds = [0, 2]\nefforts = [1, 2]', "grow with speed", 4,
    ),
    "balance without axis": (
        'kind = "balance"\nof = "b"\naxis = [0, 0, 1]\nlimit = 1', "neither a joint nor axis and point", 0,
    ),
    "balance with two axes": (
        'kind = "balance"\nof = "b"\njoint = "j"\naxis = [0, 0, 1]\npoint = [0, 0, 0]\nlimit = 1', "too", 3,
    ),
    "fit of a part with itself": ('kind = "fit"\nbetween = ["a", "a"]\nminimum = 0', 'both sides are "a"', 2),
    "clear of a part with itself": ('kind = "clear"\nbetween = ["a", "a"]', 'both sides are "a"', 2),
}  # fmt: skip
"""By what is wrong: the requirement, what is told, and the line after `name` of its key, 0 for the table."""


@pytest.mark.parametrize("case", WRONG)
def test_a_requirement_that_makes_no_sense_is_refused(tmp_path, case):
    text, told, after = WRONG[case]
    (tmp_path / "m.toml").write_text(HEAD + text + "\n")
    with pytest.raises(InputError) as caught:
        load(tmp_path / "m.toml")
    (problem,) = caught.value.problems
    assert told in problem.message
    assert '"r"' in problem.message
    assert problem.line == (15 if after == 0 else 16 + after)
    assert problem.remedy
