"""Efficiency, self-locking and holding with friction, against the formulas of handbooks."""

from __future__ import annotations

import numpy as np
import pytest
from support.nuts import MASS, G, arm, nut

import kinform

ZERO = "[[0, 0, 0], [0, 0, 0], [0, 0, 0]]"
ROUND = "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]"


def _requirement(kind, **values):
    lines = "\n".join(f"{key} = {value}" for key, value in values.items())
    return f'[[function.require]]\nname = "wanted"\nkind = "{kind}"\n{lines}\n'


def _part(name, mass=1.0):
    return f'[[part]]\nname = "{name}"\nmass = {mass}\ncentre_of_mass = [0, 0, 0]\ninertia = {ZERO}\n'


SCREW = """
schema = 1
[assembly]
name = "jack"
units = "mm"
ground = "frame"
[[part]]
name = "frame"
PARTS
[function]
[[function.joint]]
name = "spin"
between = ["frame", "screw"]
type = "revolute"
axis = [0, 0, 1]
point = [0, 0, 0]
[[function.joint]]
name = "thread"
between = ["screw", "nut"]
type = "screw"
axis = [0, 0, 1]
point = [0, 0, 0]
pitch = 8
[[function.joint]]
name = "lift"
between = ["frame", "nut"]
type = "prismatic"
axis = [0, 0, 1]
[[function.drive]]
joint = "thread"
kind = "friction"
coefficient = MU
radius = 15
[[function.drive]]
joint = "spin"
kind = "friction"
coefficient = 0.08
thrust_radius = 20
[[function.load]]
part = "nut"
force = [0, 0, -6400]
[simulation]
gravity = [0, 0, 0]
level = "kinematic"
"""


def _asked(tmp_path, text):
    path = tmp_path / "device.toml"
    path.write_text(text)
    outcome = kinform.run(path)
    findings = {f.code: f for f in outcome.report.findings}
    rules = {rule.code: rule for rule in outcome.report.rules}
    return findings, rules


def _jack(tmp_path, kind, mu=0.08, **values):
    text = SCREW.replace("PARTS", _part("screw") + _part("nut")).replace("MU", str(mu))
    return _asked(tmp_path, text + _requirement(kind, joint='"spin"', **values))


def test_a_power_screw_has_the_efficiency_of_the_handbook(tmp_path):
    """Shigley's Mechanical Engineering Design, example 8-1: a double square thread of 32 mm and 4 mm pitch lifts 6.4 kN
    with 26.18 N·m, an efficiency of 0.311."""
    torque = 6400.0 * 0.015 * (8.0 + np.pi * 0.08 * 30.0) / (np.pi * 30.0 - 0.08 * 8.0) + 6400.0 * 0.08 * 0.02
    assert abs(torque - 26.18) < 0.01
    exact = 6400.0 * 0.008 / (2.0 * np.pi * torque)
    assert abs(exact - 0.311) < 5e-4
    assert "KF434" not in _jack(tmp_path, "efficiency", minimum=exact - 1e-9)[0]
    findings, _ = _jack(tmp_path, "efficiency", minimum=exact + 1e-9)
    assert float(findings["KF434"].found.rstrip(" %")) == pytest.approx(100.0 * exact, rel=1e-3)
    assert findings["KF434"].subject == ("wanted",)


def test_the_same_screw_locks_itself_and_a_slippery_one_does_not(tmp_path):
    assert _jack(tmp_path, "self_locking")[1]["KF435"].outcome == "passed"
    # without its collar's share it would come down: tan of the lead angle less than the rest of the friction
    slope, ring = 8.0 / (np.pi * 30.0), 0.08 * 20.0 / 15.0
    least = (slope - ring) / (1.0 + slope * ring)
    assert least < 0.0  # the collar alone holds it
    text = SCREW.replace("PARTS", _part("screw") + _part("nut")).replace("coefficient = 0.08", "coefficient = 0.0")
    for mu, holds in ((slope * (1.0 + 1e-9), True), (slope * (1.0 - 1e-9), False)):
        asked = text.replace("MU", repr(float(mu))) + _requirement("self_locking", joint='"spin"')
        findings, rules = _asked(tmp_path, asked)
        assert (rules["KF435"].outcome == "passed") == holds
        assert ("KF435" in findings) != holds


def test_lowering_takes_the_torque_of_the_handbook_where_it_does_not_lock(tmp_path):
    slope, mu, force = 8.0 / (np.pi * 30.0), 0.03, 6400.0
    exact = force * 0.015 * (slope - mu) / (1.0 + mu * slope)
    text = SCREW.replace("PARTS", _part("screw") + _part("nut")).replace("coefficient = 0.08", "coefficient = 0.0")
    text = text.replace("MU", str(mu))
    for limit, fits in ((exact * (1.0 + 1e-9), True), (exact * (1.0 - 1e-9), False)):
        findings, _ = _asked(tmp_path, text + _requirement("hold", joint='"spin"', limit=repr(float(limit))))
        assert ("KF424" in findings) != fits


TRAIN = """
schema = 1
[assembly]
name = "train"
units = "mm"
ground = "frame"
[[part]]
name = "frame"
PARTS
[function]
JOINTS
[[function.coupling]]
joints = ["motor", "middle"]
ratio = 5
efficiency = 0.9
[[function.coupling]]
joints = ["middle", "drum"]
ratio = -20
efficiency = FIRST
BACK
[[function.load]]
part = "reel"
torque = [0, 0, 3]
[simulation]
gravity = [0, 0, 0]
level = "kinematic"
"""


def _train(tmp_path, kind, first=0.8, back="", joint="motor", **values):
    joints = "".join(
        f'[[function.joint]]\nname = "{name}"\nbetween = ["frame", "{body}"]\ntype = "revolute"\n'
        f"axis = [0, 0, 1]\npoint = [{x}, 0, 0]\n"
        for name, body, x in (("motor", "rotor", 0), ("middle", "wheel", 50), ("drum", "reel", 150))
    )
    parts = "".join(_part(name).replace(ZERO, ROUND) for name in ("rotor", "wheel", "reel"))
    text = TRAIN.replace("PARTS", parts).replace("JOINTS", joints).replace("FIRST", str(first)).replace("BACK", back)
    return _asked(tmp_path, text + _requirement(kind, joint=f'"{joint}"', **values))


def test_efficiencies_of_a_train_multiply(tmp_path):
    assert "KF434" not in _train(tmp_path, "efficiency", minimum=0.72 - 1e-9)[0]
    findings, _ = _train(tmp_path, "efficiency", minimum=0.72 + 1e-9)
    assert float(findings["KF434"].found.rstrip(" %")) == pytest.approx(72.0)


@pytest.mark.slow
def test_a_worm_in_a_train_locks_it(tmp_path):
    """Teeth that rub alike both ways lock below one half; what is stated of the way back counts where it is."""
    for first, back, locks in ((0.8, "", False), (0.49, "", True), (0.51, "", False)):
        _, rules = _train(tmp_path, "self_locking", first, back)
        assert (rules["KF435"].outcome == "passed") == locks
    assert _train(tmp_path, "self_locking", 0.8, "efficiency_back = 0")[1]["KF435"].outcome == "passed"
    assert "KF435" in _train(tmp_path, "self_locking", 0.4, "efficiency_back = 0.1")[0]


def test_less_torque_holds_what_gears_hold_too(tmp_path):
    """3 N·m over 100, less what both pairs of teeth hold: η′ = 2 - 1/η of each."""
    exact = 0.03 * (2.0 - 1.0 / 0.9) * (2.0 - 1.0 / 0.8)
    for limit, fits in ((exact * (1.0 + 1e-9), True), (exact * (1.0 - 1e-9), False)):
        findings, _ = _train(tmp_path, "hold", limit=repr(float(limit)))
        assert ("KF424" in findings) != fits


LEVER = """
schema = 1
[assembly]
name = "lever"
units = "m"
ground = "frame"
[[part]]
name = "frame"
[[part]]
name = "arm"
mass = 2.0
centre_of_mass = [0.3, 0, 0]
inertia = [[0, 0, 0], [0, 0, 0], [0, 0, 0]]
[function]
[[function.joint]]
name = "hinge"
between = ["arm", "frame"]
type = "revolute"
axis = [0, 1, 0]
point = [0, 0, 0]
[[function.drive]]
joint = "hinge"
kind = "friction"
coefficient = 0.05
static = 0.1
radius = 0.02
effort = 0.3
static_effort = 0.4
"""


@pytest.mark.parametrize("pose", [0.0, 60.0, 120.0])
def test_a_lever_is_held_with_the_help_of_its_journal_and_its_seal(tmp_path, pose):
    weight = 2.0 * 9.81
    exact = weight * 0.3 * abs(np.cos(np.radians(pose))) - 0.1 * 0.02 * weight - 0.4
    at = f"[{{hinge = {pose}}}]"
    for limit, fits in ((exact * (1.0 + 1e-9), True), (exact * (1.0 - 1e-9), False)):
        text = LEVER + _requirement("hold", joint='"hinge"', limit=repr(float(limit)), poses=at)
        assert ("KF424" in _asked(tmp_path, text)[0]) != fits


def test_a_lever_at_which_nothing_pulls_shows_nothing(tmp_path):
    text = LEVER + '[simulation]\ngravity = [0, 0, 0]\nlevel = "kinematic"\n'
    for kind, values in (("self_locking", {}), ("efficiency", {"minimum": 0.5})):
        assert "KF902" in _asked(tmp_path, text + _requirement(kind, joint='"hinge"', **values))[0]


def test_what_has_no_friction_cannot_lock_and_says_so(tmp_path):
    text = LEVER.split("[[function.drive]]")[0] + _requirement("self_locking", joint='"hinge"')
    assert "KF902" in _asked(tmp_path, text)[0]


def test_a_journal_whose_load_the_nut_and_its_guide_share_leaves_friction_open(tmp_path):
    text = SCREW.replace("PARTS", _part("screw") + _part("nut")).replace("MU", "0.1")
    text = text.replace("thrust_radius = 20", "thrust_radius = 20\nradius = 10")
    findings, _ = _asked(tmp_path, text + _requirement("self_locking", joint='"spin"'))
    assert "KF902" in findings


@pytest.mark.parametrize("fits", [True, False])
def test_a_nut_on_a_screw_at_rest_is_held_and_driven_at_the_torques_of_the_handbook(tmp_path, fits):
    aside = 1.0 + (1e-6 if fits else -1e-6)
    holds = MASS * G * arm(0.1, -1) * aside
    text = nut(static=0.1) + _requirement("hold", joint='"thread"', limit=repr(holds))
    assert ("KF424" in _asked(tmp_path, text)[0]) != fits
    share = arm(0.0, 1) / arm(0.08, 1) / aside
    text = nut(static=0.1) + _requirement("efficiency", joint='"thread"', minimum=repr(share))
    assert ("KF434" in _asked(tmp_path, text)[0]) != fits
