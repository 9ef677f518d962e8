"""Contact between bodies that a function with all joints moves by others: it holds nothing, and is told.

A base, a bar that turns on it and a tip that turns on the bar; what the tip and the base have in common differs.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from support.assemblies import HERE, assembly
from support.diagonal import diagonal
from support.solids import box, part, random_pose, rod
from support.touching import touching as touching_of

from kinform import consistency, kinematics
from kinform.design import Design
from kinform.model.assembly import Assumption
from kinform.model.function import Function, IntendedJoint

FIRST, SECOND, FOOT = (40.0, 0.0, 0.0), (80.0, 0.0, 0.0), (110.0, 0.0, 0.0)


def bar(x0, x1, z0):
    ends = rod(5, z0, z0 + 4, 48).translate((x0, 0, 0)) + rod(5, z0, z0 + 4, 48).translate((x1, 0, 0))
    return box(x0, x1, -5, 5, z0, z0 + 4) + ends


def pin(at, z0):
    """A pin that holds a bar which begins at z0."""
    return (rod(2, z0 - 1, z0 + 4, 32) + rod(4, z0 + 4, z0 + 5, 32)).translate(at)


def bore(at):
    return rod(2.01, -20, 40, 32).translate(at)


BASE = bar(0, 40, 0) + pin(FIRST, 4)
BAR = bar(40, 80, 4) - bore(FIRST) + pin(SECOND, 8)
TIP = bar(80, 120, 8) - bore(SECOND)
LEDGE = box(0, 125, -5, 5, -6, -2) + box(0, 10, -5, 5, -2, 1)
"""Below the bars, from the base on."""


def chain(base, tip, bar=BAR, second=SECOND):
    joints = (("turn", "base", "bar", FIRST), ("swing", "bar", "tip", second))
    return {"base": BASE + base, "bar": bar, "tip": tip}, joints


DESIGNS = {
    "clear": chain(LEDGE, TIP),
    # a post on the base in a bore of the tip: nothing moves in fact
    "journal": chain(LEDGE + rod(2, -3, 12, 32).translate(FOOT), TIP - bore(FOOT)),
    # the tip's foot on the ledge, as it swings
    "foot": chain(LEDGE, TIP + box(107, 113, -3, 3, -2, 8)),
    # the tip's foot beside a wall of the base
    "wall": chain(LEDGE + box(113, 118, -4, 4, -3, 7), TIP + box(107, 113, -3, 3, -1, 8)),
    # both on one pin of the base
    "one pin": chain(
        rod(2, -1, 13, 32).translate(FIRST), bar(40, 80, 8) - bore(FIRST), bar(40, 80, 4) - bore(FIRST), second=FIRST
    ),
}
DESIGNS["one pin"][0]["base"] = bar(0, 40, 0) + rod(2, -1, 13, 32).translate(FIRST)


def derived(name, X=None, scale=1e-3, backwards=False, assume=()):
    """The design with its kinematics."""
    X = np.eye(4) if X is None else X
    solids, joints = DESIGNS[name]
    order = list(reversed(solids)) if backwards else list(solids)
    stated = tuple(
        IntendedJoint(
            joint, (a, b), "revolute", X[:3, 2], None, X[:3, :3] @ (scale * np.array(at)) + X[:3, 3], None, None,
            HERE.file, None,
        )
        for joint, a, b, at in joints
    )  # fmt: skip
    made = assembly(*(part(one, solids[one], X, scale) for one in order), assume=assume)
    made = replace(made, function=Function(joints=stated, complete=("",)))
    found, touching = touching_of(made)
    return Design(made, found, touching, kinematics.derive(made, found, touching))


def told(design):
    return {(f.code, f.severity) for f in consistency.check(design).findings if f.code in ("KF406", "KF407")}


POSES = [(None, 1e-3, False), (0, 1e-3, True), (1, 1.0, False)]


def at(seed, scale, backwards):
    X = np.eye(4) if seed is None else random_pose(np.random.default_rng(seed))
    return {"X": X, "scale": scale, "backwards": backwards}


@diagonal(
    stated=[
        ("journal", "cylindrical", {("KF406", "error")}),
        ("foot", "planar", {("KF407", "warning")}),
        ("wall", "planar", {("KF407", "warning")}),
    ],
    pose=POSES,
)
def test_contact_beside_the_stated_joints_holds_nothing_and_is_reported(stated, pose):
    name, type_, findings = stated
    design = derived(name, **at(*pose))
    assert [joint.type for joint in design.kinematics.joints] == ["revolute", "revolute"]
    assert design.kinematics.mobility.instantaneous == 2
    (aside,) = design.kinematics.asides
    assert (aside.bodies, aside.type, aside.status) == (("base", "tip"), type_, "determined")
    assert told(design) == findings


@diagonal(name=["clear", "one pin"], pose=POSES)
def test_a_joint_that_lies_where_the_motion_is_says_nothing_new(name, pose):
    design = derived(name, **at(*pose))
    assert design.kinematics.mobility.instantaneous == 2
    assert design.kinematics.asides == ()
    assert told(design) == set()


def test_the_post_of_one_pin_does_touch_both():
    design = derived("one pin")
    assert ("base", "tip") in {patch.parts for patch in design.contacts.patches}


def test_assumed_joints_are_not_ignored():
    rest = {"axis": np.array([0.0, 0.0, 1.0]), "point": 1e-3 * np.array(FOOT), "pitch": None}
    free = Assumption(("base", "tip"), type="cylindrical", ignore=False, reason="so it is", source=HERE, **rest)
    design = derived("journal", assume=(free,))
    assert design.kinematics.asides == ()
    assert "base~tip" in {joint.name for joint in design.kinematics.joints}
