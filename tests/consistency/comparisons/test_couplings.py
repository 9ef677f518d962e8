"""Stated couplings are held against the ratio that the teeth give, by the designer's signs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.gear_trains import cam_and_follower, gear_pair
from support.places import FIXTURES
from support.solids import assembly, part

from kinform import contacts, kinematics, stages, surfaces
from kinform.consistency import check, verdict
from kinform.design import Design
from kinform.model.function import Coupling, Drive, Function, IntendedJoint, Law, Requirement, SimulationRequest

Z = np.array([0.0, 0.0, 1.0])


def designed(solids):
    made = assembly(*(part(name, solid, np.eye(4)) for name, solid in solids.items()), ground=None)
    found = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, found)
    return Design(made, surfaces=found, contacts=touching, kinematics=kinematics.derive(made, found, touching))


@pytest.fixture(scope="module")
def gears():
    return designed(gear_pair(20, 30, 0.1, 10, idler=24))


@pytest.fixture(scope="module")
def cam():
    return designed(cam_and_follower()[0])


def hinge(name, first, second, axis=Z, x=0.0):
    return IntendedJoint(name, (first, second), "revolute", axis, None, np.array([x, 0, 0]), None, None, "m.toml", 5)


def stated(design, joints, ratio, names=("a", "b")):
    function = Function(joints=joints, couplings=(Coupling(names, ratio, "m.toml", 9),))
    return check(replace(design, assembly=replace(design.assembly, function=function)))


def outcome(report, code):
    return next(rule.outcome for rule in report.rules if rule.code == code)


AXES = (hinge("a", "housing", "gear0"), hinge("b", "housing", "gear1"))


@pytest.mark.parametrize(("ratio", "code"), [(-1.2, None), (-1.1995, None), (1.2, "KF411"), (-1.19, "KF411")])
def test_the_ratio_of_two_gears(gears, ratio, code):
    report = stated(gears, AXES, ratio)
    assert [f.code for f in report.findings if f.code in ("KF411", "KF903")] == ([code] if code else [])
    assert outcome(report, "KF411") == ("failed" if code else "passed")
    assert outcome(report, "KF903") == "passed"
    assert all(f.subject != ("gear0~gear1",) for f in report.findings if f.code == "KF407")
    if code:
        (finding,) = (f for f in report.findings if f.code == code)
        assert finding.found is not None
        assert finding.found == "ratio -1.2"
        assert finding.intended == f"ratio {ratio:g}"
        assert verdict(report) == 1


def test_the_designer_may_turn_axes_and_sides_round(gears):
    first, second = AXES
    for changed, sign in (
        ((replace(first, axis=-Z), second), 1.0),
        ((replace(first, between=first.between[::-1]), second), 1.0),
        ((replace(first, axis=-Z), replace(second, between=second.between[::-1])), -1.0),
    ):
        assert outcome(stated(gears, changed, sign * 1.2), "KF411") == "passed"
        assert outcome(stated(gears, changed, -sign * 1.2), "KF411") == "failed"


def test_the_ratio_goes_through_an_idler(gears):
    joints = (hinge("a", "housing", "gear0"), hinge("b", "housing", "gear2"))
    assert outcome(stated(gears, joints, 1.5), "KF411") == "passed"
    assert outcome(stated(gears, joints, 1 / 1.5, ("b", "a")), "KF411") == "passed"
    assert outcome(stated(gears, joints, -1.5), "KF411") == "failed"


def test_a_cam_has_no_ratio_to_compare(cam):
    slide = IntendedJoint("b", ("frame", "follower"), "prismatic", np.eye(3)[1], None, None, None, None, "m.toml", 6)
    report = stated(cam, (hinge("a", "frame", "cam"), slide), 100.0)
    assert outcome(report, "KF411") == "skipped"
    assert outcome(report, "KF903") == "inconclusive"
    assert verdict(report) != 0


@pytest.mark.parametrize(("units", "metres"), [("mm", 1e-3), ("in", 0.0254), ("m", 1.0)])
def test_a_ratio_is_told_as_the_manifest_has_it(gears, cam, units, metres):
    slide = IntendedJoint("b", ("frame", "follower"), "prismatic", np.eye(3)[1], None, None, None, None, "m.toml", 6)
    # 0.5 of the unit a degree
    cam = replace(cam, assembly=replace(cam.assembly, units=units))
    report = stated(cam, (hinge("a", "frame", "cam"), slide), 0.5 * metres / np.radians(1.0), ("b", "a"))
    (finding,) = (f for f in report.findings if f.code == "KF903")
    assert finding.intended == f"ratio 0.5 {units}/°"
    report = stated(cam, (hinge("a", "frame", "cam"), slide), np.radians(2.0) / metres)
    (finding,) = (f for f in report.findings if f.code == "KF903")
    assert finding.intended == f"ratio 2 °/{units}"


GRAVITY = 9.81
RADIUS = 0.5 * 18 * 3e-3


@pytest.fixture(scope="module")
def rack(derive_design):
    """A rack that hangs on its pinion, and what it weighs."""
    found = derive_design(FIXTURES / "mechanisms" / "rack_and_pinion" / "rack_and_pinion.toml")
    (mass,) = (body.mass for body in found.mass.bodies if body.name == "rack")
    request = SimulationRequest(gravity=np.array([-GRAVITY, 0.0, 0.0]), duration=0.2, step=0.01)
    still = Drive("pinion_bearing", "motion", Law("constant"), {}, 1e-3, "m.toml", 1)
    function = replace(found.assembly.function, drives=(still,))
    return stages.simulate(
        replace(found, assembly=replace(found.assembly, simulation=request, function=function))
    ), mass * GRAVITY


@pytest.mark.parametrize("share", [0.99, 1.01])
@pytest.mark.parametrize(
    ("kind", "code"),
    [("hold", "KF424"), ("torque", "KF425")],
)
def test_the_pinion_holds_what_hangs_on_its_rack(rack, share, kind, code):
    design, weight = rack
    wanted = Requirement("it holds", kind, {"joint": "pinion_bearing", "limit": share * weight * RADIUS}, "m.toml", 1)
    function = replace(design.assembly.function, requirements=(wanted,))
    report = check(replace(design, assembly=replace(design.assembly, function=function)))
    assert outcome(report, code) == ("passed" if share > 1.0 else "failed")


@pytest.mark.parametrize("share", [0.99, 1.01])
def test_the_bearing_carries_the_force_of_the_teeth(rack, share):
    """The teeth push along the rack with its weight, and as much aside as the pressure angle has it; the pinion's own
    weight acts along the rack too."""
    design, weight = rack
    (own,) = (body.mass * GRAVITY for body in design.mass.bodies if body.name == "pinion")
    force = np.hypot(weight + own, weight * np.tan(np.radians(20.0)))
    wanted = Requirement("bearing", "reaction", {"joint": "pinion_bearing", "force": share * force}, "m.toml", 1)
    function = replace(design.assembly.function, requirements=(wanted,))
    report = check(replace(design, assembly=replace(design.assembly, function=function)))
    assert outcome(report, "KF427") == ("passed" if share > 1.0 else "failed")
