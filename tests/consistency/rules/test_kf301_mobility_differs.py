"""Stated mobilities that count idle freedoms, or not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.assemblies import assembly, intended
from support.diagonal import diagonal
from support.solids import block, box, part, random_pose, rod
from support.touching import touching as touching_of

from kinform.consistency import check
from kinform.design import Design
from kinform.kinematics import derive
from kinform.model.assembly import Subassembly

POSES = [(0, 1e-3), (None, 1e-3), (1, 1.0)]


def outcome(solids, mobility, pose=(None, 1e-3), joints=(), code="KF301"):
    """The outcome of the rule for solids of which the first is ground, under one pose, with joints (name, between,
    type) about its z axis. Of KF302 they are the sub-assembly "inner", which states the mobility."""
    seed, scale = pose
    X = np.eye(4) if seed is None else random_pose(np.random.default_rng(seed))
    inner = "inner/" if code == "KF302" else ""
    parts = [part(inner + name, solid, X, scale) for name, solid in solids.items()]
    stated = None if inner else mobility
    wanted = [intended(name, *(inner + b for b in between), kind, X[:3, 2], X[:3, 3]) for name, between, kind in joints]
    made = assembly(*parts, ground=parts[0].name, joints=wanted, mobility=stated)
    if inner:
        made = replace(made, subassemblies=(Subassembly("inner", "inner.toml", mobility, made.source),))
    found, touching = touching_of(made)
    report = check(Design(made, found, touching, derive(made, found, touching)))
    (rule,) = (rule for rule in report.rules if rule.code == code)
    return rule.outcome


def hinge():
    """Two leaves with three knuckles about a headed pin."""
    fixed = box(-40, -9, -1, 1, 0, 30)
    for low in (0, 20):
        fixed += rod(6, low, low + 10) + box(-10, -3, -1, 1, low, low + 10)
    moving = box(9, 40, -1, 1, 0, 30) + rod(6, 10, 20) + box(3, 10, -1, 1, 10, 20)
    shank = rod(2, 0, 30)
    pin = shank + rod(4, -2, 0) + rod(4, 30, 32)
    return {"fixed": fixed - shank, "moving": moving - shank, "pin": pin}


AXLE = box(-30, 30, -30, 30, -20, -8) + rod(4, -5, 8) + rod(8, -8, 0) + rod(8, 6, 8)
WHEEL = rod(20, 0, 6) - rod(4, -1, 7)
RIVET = rod(3, 0, 10, 48) + rod(5, -2, 0, 48) + rod(5, 4, 6, 48) + rod(5, 10, 12, 48)


def plates():
    """Two plates on two rivets: only these move."""
    rivets = {f"rivet{k}": RIVET.translate((20.0 * k, 0, 0)) for k in range(2)}
    holes = sum(rivets.values(), start=RIVET)
    low, high = box(-15, 35, -10, 10, 0, 4), box(-15, 35, -10, 10, 6, 10)
    return {"low": low - holes, "high": high - holes, **rivets}


@pytest.mark.parametrize("code", ["KF301", "KF302"])
@diagonal(pose=POSES, mobility=[1, 2, 0, 3])
def test_a_hinge_has_one_freedom_or_two_with_its_pin(pose, mobility, code):
    right = mobility in (1, 2)
    assert outcome(hinge(), mobility, pose, code=code) == ("passed" if right else "failed")


@pytest.mark.parametrize("code", ["KF301", "KF302"])
@pytest.mark.parametrize(("mobility", "right"), [(0, True), (1, True), (2, False)])
def test_a_smooth_wheel_has_one_freedom_or_none(mobility, right, code):
    found = outcome({"base": AXLE, "wheel": WHEEL}, mobility, code=code)
    assert found == ("passed" if right else "failed")


@pytest.mark.parametrize(("mobility", "right"), [(0, False), (1, True), (2, False)])
def test_a_wheel_with_a_crank_pin_has_one(mobility, right):
    crank = WHEEL + rod(3, 5, 15).translate((14, 0, 0))
    assert outcome({"base": AXLE, "wheel": crank}, mobility) == ("passed" if right else "failed")


@pytest.mark.parametrize(("mobility", "right"), [(0, False), (1, True)])
def test_a_wheel_whose_turn_is_stated_has_one(mobility, right):
    found = outcome({"base": AXLE, "wheel": WHEEL}, mobility, joints=[("spin", ("base", "wheel"), "revolute")])
    assert found == ("passed" if right else "failed")


@pytest.mark.parametrize(("mobility", "right"), [(0, False), (1, True), (2, True), (3, False)])
def test_a_ram_slides_and_may_spin(mobility, right):
    barrel = block(30, 30, 60) - rod(8, -99, 99)
    assert outcome({"barrel": barrel, "ram": rod(8, -20, 90)}, mobility) == ("passed" if right else "failed")


@pytest.mark.parametrize("code", ["KF301", "KF302"])
def test_idle_freedoms_do_not_stand_for_a_joint_that_does_not_move(code):
    """Rivets spin, and nothing tells that their spins were not meant, until a joint is stated."""
    stuck = [("swing", ("low", "high"), "revolute")]
    assert outcome(plates(), 1, joints=stuck, code=code) == "failed"
    assert outcome(plates(), 1, code=code) == outcome(plates(), 0, code=code) == "passed"
