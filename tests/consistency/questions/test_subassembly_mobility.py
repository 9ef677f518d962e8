"""The mobility of some parts among themselves."""

from __future__ import annotations

from support.four_bar import four_bar

from kinform.consistency.questions.subassembly_mobility import inner_mobility
from kinform.design import Design
from kinform.kinematics import derive


def test_mobility_within_a_part_of_the_whole():
    model, touching = four_bar()
    design = Design(model, contacts=touching, kinematics=derive(model, {}, touching))
    assert inner_mobility(design, ["base", "crank"]).effective == 1
    assert inner_mobility(design, ["crank", "link", "rocker"]).effective == 2
