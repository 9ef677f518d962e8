"""Planetary trains and differentials whose ratios the function states: imposed, labelled, and exact by Willis' rule."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.devices import Z, body, device, drive, intended
from support.dynamics import moved
from support.gear_trains import planetary
from support.solids import assembly, part
from support.validators import package

from kinform import stages
from kinform.design import Design
from kinform.exports import export
from kinform.function import as_intended, designers_joints
from kinform.model.function import Coupling, Drive, Function, IntendedJoint, Law, SimulationRequest

SUN, PLANET, RING = 14, 18, 50
APART = 0.016


def hinge(name, first, second, x=0.0):
    point = np.array([x, 0.0, 0.0])
    return IntendedJoint(name, (first, second), "revolute", np.array(Z, float), None, point, None, None, "m.toml", 1)


JOINTS = (hinge("in", "frame", "sun"), hinge("out", "frame", "carrier"), hinge("spin", "carrier", "planet", APART))
TRAIN = Coupling(("in", "out"), 1.0, "m.toml", 9, {"spin": -PLANET / SUN})
"""In the frame of the carrier: in − out = −18/14 · spin."""


@pytest.fixture(scope="module")
def found():
    """Contacts, joints and masses of the meshes; the sun is borne by the frame, so its teeth tie three joints."""
    made = assembly(*(part(name, solid, np.eye(4)) for name, solid in planetary().items()), ground="frame")
    return stages.mass(stages.joints(stages.contacts(Design(replace(made, function=Function(joints=JOINTS))))))


def stated(design, *couplings, drives=(), **request):
    """The design with these couplings and drives, simulated."""
    asked = SimulationRequest(**({"gravity": np.zeros(3), "duration": 0.2, "step": 0.02} | request))
    function = replace(design.assembly.function, couplings=couplings, drives=drives)
    changed = replace(design, assembly=replace(design.assembly, function=function, simulation=asked))
    return moved(changed)


def driven(name, kind, law):
    return Drive(name, kind, law, {}, 1.0, "m.toml", 12)


def values(design, *names):
    """(T,) of each joint by the designer's name and sense."""
    run = as_intended(design.simulation, designers_joints(design.assembly, design.kinematics))
    return [run.joint_position[:, run.joint_names.index(name)] for name in names]


def codes(design):
    return [finding.code for finding in design.report.findings]


def test_without_the_coupling_the_sun_is_refused_by_name(found):
    design = stated(found)
    assert design.simulation.status == "refused"
    assert "planet~sun" in {subject for subject, _ in design.simulation.failures}


def test_the_train_turns_by_willis(found):
    """The ring stands: out = in · 14 / (14 + 50), and spin = −50/18 · out."""
    design = stated(found, TRAIN, drives=(driven("in", "motion", Law("ramp", rate=360.0)),), level="kinematic")
    assert design.simulation.status == "done", design.simulation.reason
    inner, out, spin = values(design, "in", "out", "spin")
    assert inner[-1] == pytest.approx(np.radians(72.0))
    np.testing.assert_allclose(out, inner * SUN / (SUN + RING), atol=1e-9)
    np.testing.assert_allclose(spin, -RING / PLANET * out, atol=1e-9)
    assert any("'planet~sun'" in note for note in design.simulation.assumptions)
    assert "KF411" not in codes(stages.check(design))


def test_effort_is_multiplied_as_energy_asks(found):
    """A torque on the sun against the inertia of all wheels, each by the square of its speed."""
    design = stated(found, TRAIN, drives=(driven("in", "effort", Law("constant", value=1e-4)),))
    run = design.simulation
    assert run.status == "done", run.reason
    bodies = {item.name: item for item in design.mass.bodies}

    def about_z(name):
        item = bodies[name]
        return item.inertia[2, 2] + item.mass * (item.centre_of_mass[:2] @ item.centre_of_mass[:2])

    ratio, own = SUN / (SUN + RING), bodies["planet"].inertia[2, 2]
    planet = (about_z("planet") - own) * ratio**2 + own * (ratio * (1.0 - RING / PLANET)) ** 2
    inertia = about_z("sun") + about_z("carrier") * ratio**2 + planet
    (inner,) = values(design, "in")
    np.testing.assert_allclose(inner, 0.5 * 1e-4 / inertia * run.time**2, rtol=1e-7, atol=1e-12)
    assert run.balance.max() < 1e-9


def test_a_wrong_ratio_is_not_silent(found):
    """Fewer teeth on the planet, or the wrong sense: a finding, or a note with the number where contact is unsure."""
    for ratio in (PLANET / SUN, -1.0):
        design = stages.check(stated(found, replace(TRAIN, others={"spin": ratio}), level="kinematic"))
        found_wrong = [f for f in design.report.findings if f.code in ("KF411", "KF903") and "spin" in f.subject]
        assert len(found_wrong) == 1


def test_teeth_that_are_counted_keep_their_ratio(found):
    """The ring's teeth give spin and out their ratio: what is stated for them is compared, and not imposed."""
    ring = Coupling(("spin", "out"), -2.0, "m.toml", 10)
    design = stated(found, TRAIN, ring, drives=(driven("in", "motion", Law("ramp", rate=360.0)),), level="kinematic")
    out, spin = values(design, "out", "spin")
    np.testing.assert_allclose(spin, -RING / PLANET * out, atol=1e-9)
    assert "KF411" in codes(stages.check(design))


@pytest.fixture(scope="module")
def differential():
    """Two half shafts and a crown about x, without meshes: 2 · crown = left + right."""
    parts = [body(name, 1.0, (x, 0, 0), (inertia,) * 3) for name, x, inertia in PARTS]
    wanted = [intended(name, "base", name, "revolute", (1, 0, 0), (0, 0, 0)) for name, _, _ in PARTS]
    return parts, wanted


PARTS = (("crown", 0.0, 0.4), ("left", -0.3, 0.1), ("right", 0.3, 0.2))
HALVES = Coupling(("crown", "left"), 0.5, "device.toml", 1, {"right": 0.5})


def test_a_differential_shares_torque_equally(differential):
    """Lagrange: with free values a (left) and b (right) and a torque T on the crown, T/2 acts on each."""
    parts, wanted = differential
    drives = [drive("crown", "effort", Law("constant", value=3.0))]
    made = device(
        parts, [], intended=wanted, couplings=[HALVES], drives=drives, level="dynamic", duration=0.5, step=0.05,
        gravity=np.zeros(3),
    )  # fmt: skip
    design = moved(stages.mass(stages.joints(stages.contacts(Design(made[0])))))
    run = design.simulation
    assert run.status == "done", run.reason
    assert design.kinematics.mobility.effective == 2
    crown, left, right = 0.4, 0.1, 0.2
    tensor = 0.25 * crown * np.ones((2, 2)) + np.diag([left, right])
    rates = np.linalg.solve(tensor, [1.5, 1.5])
    a, b = values(design, "left", "right")
    np.testing.assert_allclose(a, 0.5 * rates[0] * run.time**2, rtol=1e-8, atol=1e-12)
    np.testing.assert_allclose(b, 0.5 * rates[1] * run.time**2, rtol=1e-8, atol=1e-12)


def test_mujoco_carries_the_differential(differential):
    """A fixed tendon of constant length: the same motion within the softness of its constraint."""
    mujoco = package("mujoco")
    parts, wanted = differential
    drives = [drive("left", "effort", Law("constant", value=1.0))]
    made = device(
        parts, [], intended=wanted, couplings=[HALVES], drives=drives, level="dynamic", duration=0.5, step=0.05,
        gravity=np.zeros(3),
    )  # fmt: skip
    design = moved(stages.mass(stages.joints(stages.contacts(Design(made[0])))))
    model = mujoco.MjModel.from_xml_string(export(design, "mjcf").files["device.xml"].decode())
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    while data.time < 0.5 - 1e-9:
        mujoco.mj_step(model, data)
    ends = dict(zip(design.simulation.joint_names, design.simulation.joint_position[-1], strict=True))
    for name, value in ends.items():
        assert data.joint(name).qpos[0] == pytest.approx(value, rel=0.01, abs=1e-4)


@pytest.mark.parametrize("format", ["urdf", "sdf"])
def test_formats_without_sums_say_so(differential, format):
    parts, wanted = differential
    made = device(parts, [], intended=wanted, couplings=[HALVES], duration=0.1, step=0.05, gravity=np.zeros(3))
    design = moved(stages.mass(stages.joints(stages.contacts(Design(made[0])))))
    assert export(design, format).lost
