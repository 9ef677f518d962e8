"""Efficiency of a screw in its nut, from meshes to the requirement, against the formula of textbooks."""

from __future__ import annotations

import math
import re

import pytest
from generators.threads import Thread, threaded
from manifold3d import Manifold
from support.solids import save

from kinform import stages

THREADS = {
    "acme": Thread(6.0, 8.0, 4.0, 1, 14.5),
    "left": Thread(6.0, 8.0, -4.0, 1, 14.5),
    "square": Thread(8.0, 10.5, 6.0, 1, 1.0),
    "vee": Thread(7.0, 8.2, 4.0, 1, 30.0),
    "two starts": Thread(10.0, 12.0, 12.0, 2, 15.0),
    "small": Thread(2.2, 2.9, 1.5, 1, 15.0),
    "steep": Thread(9.0, 12.0, 40.0, 4, 20.0),
}
MANIFEST = """schema = 1
[assembly]
name = "press"
units = "mm"
ground = "nut"
[[part]]
name = "screw"
mesh = "screw.stl"
material = "steel"
[[part]]
name = "nut"
mesh = "nut.stl"
material = "steel"
[function]
mobility = 1
[[function.joint]]
name = "thread"
between = ["nut", "screw"]
type = "screw"
axis = [0, 0, 1]
point = [0, 0, 0]
pitch = LEAD
[[function.drive]]
joint = "thread"
kind = "friction"
coefficient = MU
[[function.drive]]
joint = "thread"
kind = "effort"
law = {type = "constant", value = 0}
[[function.load]]
part = "screw"
force = [0, 0, -1000]
point = [0, 0, 0]
[[function.require]]
name = "efficiency"
kind = "efficiency"
joint = "thread"
minimum = 0.999
[simulation]
gravity = [0, 0, 0]
level = "dynamic"
duration = 0.02
step = 0.01
"""


def efficiency(radius, lead, lean, friction):
    """Of raising a load: Shigley's Mechanical Engineering Design, chapter 8."""
    slope = abs(lead) / (2 * math.pi * radius)
    rubs = friction * math.sqrt(1.0 + (math.tan(lean) / math.sqrt(1.0 + slope * slope)) ** 2)
    return max(slope * (1.0 - rubs * slope) / (slope + rubs), 0.0)


def pair(thread, gap, segments):
    """The screw, the nut about it, and the least and the greatest radius of flanks that face each other (mm)."""
    lean = math.radians(thread.lean)
    play = 2 * gap * (1 - math.sin(lean)) / math.cos(lean)
    hollow = Thread(thread.root + gap, thread.crest + gap, thread.lead, thread.starts, thread.lean, play)
    half = 1.1 * abs(thread.lead) / thread.starts + 0.1 * thread.crest
    tool = threaded(hollow, -half - 1.0, half + 1.0, segments[1], 7.0).manifold
    nut = Manifold.cylinder(2 * half, 1.6 * thread.crest, 1.6 * thread.crest, 6, True) - tool
    return threaded(thread, -half - 1.0, half + 2.0, segments[0]).manifold, nut


def found(tmp_path, thread, friction, gap=0.05, segments=(24, 20)):
    """The efficiency that is found, as a share."""
    for name, solid in zip(("screw", "nut"), pair(thread, gap, segments), strict=True):
        save(solid, tmp_path / f"{name}.stl")
    manifest = tmp_path / "press.toml"
    manifest.write_text(MANIFEST.replace("LEAD", str(thread.lead)).replace("MU", str(friction)))
    design = stages.joints(stages.contacts(stages.import_(manifest)))
    design = stages.check(stages.simulate(stages.mass(design)))
    (low,) = [finding for finding in design.report.findings if finding.code == "KF434"]
    return 0.01 * float(re.match(r"[\d.e-]+", low.found)[0])


def pytest_generate_tests(metafunc):
    if "friction" not in metafunc.fixturenames:
        return
    often = {("acme", 0.12, (24, 20)), ("square", 0.05, (24, 20)), ("vee", 0.2, (24, 20)), ("left", 0.12, (48, 64))}
    every = [(n, mu, s) for n in THREADS for mu in (0.05, 0.12, 0.2) for s in ((24, 20), (48, 64))]
    rows = [pytest.param(*row, marks=() if row in often else (pytest.mark.sweep,)) for row in every]
    metafunc.parametrize(("name", "friction", "segments"), rows)


def test_flanks_alone_carry_along_the_axis(tmp_path, name, friction, segments):
    thread = THREADS[name]
    gap = min(0.05, 0.01 * thread.crest)
    middle = 0.5 * (thread.root + gap + thread.crest)
    wanted = efficiency(middle, thread.lead, math.radians(thread.lean), friction)
    assert found(tmp_path, thread, friction, gap, segments) == pytest.approx(wanted, rel=0.01)
