"""Balls and rollers on each other and in bores: rows as the analytic surfaces have them, in any pose and tessellation."""

from __future__ import annotations

import numpy as np
import pytest
from solids import ball, box, derived, random_pose, rod

BLOCK = box(-20, 20, -20, 20, -5, 0)


def tube(segments):
    return rod(10, -20, 20, segments) - rod(5, -21, 21, segments, 2.0)


def cases(n):
    return {
        "ball on a plane": (5, "point", {"a": ball(5, n).translate((0, 0, 5)), "b": BLOCK}),
        "roller on a plane": (4, "line", {"a": rod(5, -15, 15, n, 3.7).rotate((0, 90, 0)).translate((0, 0, 5)), "b": BLOCK}),
        "ball in a bore of its size": (4, "line", {"a": ball(5, n), "b": tube(n)}),
        "ball in a larger bore": (5, "point", {"a": ball(4, n).translate((1, 0, 0)), "b": tube(n)}),
        "crossed rollers": (5, "point", {"a": rod(5, -20, 20, n), "b": rod(3, -20, 20, n, 1.0).rotate((90, 0, 0)).translate((8, 0, 0))}),
        "rollers side by side": (4, "line", {"a": rod(5, -20, 20, n), "b": rod(3, -15, 15, n, 1.0).translate((8, 0, 0))}),
        "two balls": (5, "point", {"a": ball(5, n), "b": ball(4, n, 3.0).translate((9, 0, 0))}),
    }  # fmt: skip


@pytest.mark.parametrize("name", sorted(cases(48)))
@pytest.mark.parametrize(("segments", "swap"), [(48, False), (64, True)])
def test_a_higher_pair_holds_what_it_touches(name, segments, swap):
    freedoms, kind, solids = cases(segments)[name]
    if swap:
        solids = {"a": solids["b"], "b": solids["a"]}
    kinematics, contacts = derived(random_pose(np.random.default_rng(segments)), **solids)
    assert [patch.kind for patch in contacts.patches] == [kind]
    (joint,) = kinematics.joints
    assert joint.type == "general"
    assert joint.freedoms == freedoms


@pytest.mark.parametrize("apart", [0.5, 2.0])
def test_what_does_not_touch_is_no_pair(apart):
    for a, b in (
        (ball(5, 48), ball(4, 48).translate((9 + apart, 0, 0))),
        (rod(5, -20, 20, 48), rod(3, -20, 20, 48).rotate((90, 0, 0)).translate((8 + apart, 0, 0))),
        (ball(4.5 - apart / 2, 48), tube(48)),
    ):
        _, contacts = derived(np.eye(4), a=a, b=b)
        assert not contacts.patches
