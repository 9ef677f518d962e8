"""Whether the freedoms of every stated joint are there."""

from __future__ import annotations

from functools import cache

import numpy as np
from support.assemblies import assembly, contacts, intended, part
from support.patches import Z, cylinder, ring

from kinform.design import Design
from kinform.kinematics import derive, intended_answers

X, Y = np.array([1.0, 0, 0]), np.array([0, 1.0, 0])


def design(model, *patches):
    touching = contacts(*patches)
    return Design(model, contacts=touching, kinematics=derive(model, {}, touching))


def hinge():
    return cylinder(), ring((0, 0, 0.01)), ring((0, 0, -0.01), normal=-Z)


@cache
def two_parts():
    return assembly(part("a"), part("b"), ground="a")


def test_every_intended_joint_is_answered():
    wanted = [
        intended("spin", "a", "b", "revolute"),
        intended("slip", "a", "b", "cylindrical"),
        intended("weld", "a", "b", "fixed", axis=None),
    ]
    made = design(assembly(part("a"), part("b"), ground="a", joints=wanted), *hinge())
    found = {item.joint.name: item for item in intended_answers(made)}
    assert {name: item.free for name, item in found.items()} == {"spin": True, "slip": False, "weld": False}
    turn, slide = found["slip"].motions
    assert (turn.answer.free_in_assembly, slide.answer.free_in_assembly) == (True, False)
    assert {made.contacts.patches[b.patch].kind for b in slide.answer.blocked_by} == {"plane"}
