"""The mobility of some parts among themselves."""

from __future__ import annotations

from support.four_bar import four_bar

from kinform.consistency.questions.subassembly_mobility import mobility_within
from kinform.kinematics import derive


def test_mobility_within_a_part_of_the_whole():
    found = derive(four_bar()[0], {}, four_bar()[1])
    assert mobility_within(found, ["base", "crank"]) == 1
    assert mobility_within(found, ["crank", "link", "rocker"]) == 2
