"""MJCF in MuJoCo, an independent simulator: the same masses, axes and trajectories."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.diagonal import first
from support.export_models import CHAINS, LOOPS, known, model_of, swinging
from support.other_programs import gap, loaded, origin
from support.places import FIXTURES

from kinform.behaviour import RigidBody
from kinform.exports import export
from kinform.exports.exported import ExportError
from kinform.formats.mjcf.writing.writer import MOST_NESTED, _nested
from kinform.foundation.algebra.spatial import to_matrix


def followed(found, folder):
    """Greatest distance from our run over all outputs; prescribed joints are led by our values."""
    mujoco, model, data = loaded(found, folder)
    run = found.simulation
    steps = round((run.time[1] - run.time[0]) / model.opt.timestep)
    worst = gap(found, model, data, mujoco, 0)
    for k in range(1, len(run.time)):
        mujoco.mj_step(model, data, steps)
        mujoco.mj_forward(model, data)
        worst = max(worst, gap(found, model, data, mujoco, k))
    return worst


LED = {"seeker", "nested", "every_joint", "motorised", "controlled"}
"""Laws, integrals and coils are no part of MJCF, and screws are stiff couplings."""


@pytest.mark.parametrize("name", sorted(set(CHAINS) - LED))
def test_open_chains_move_alike(name, tmp_path):
    assert followed(known(name), tmp_path) < 1e-5


def test_servos_and_motors_act_alike(tmp_path):
    """A servo without integral that reaches its limit, and a motor without a coil."""
    from support.devices import Z, device, drive, joint
    from support.export_models import Y, block, design

    from kinform.model.function import Law

    parts = [block("outer", (0, 0.1, 0)), block("inner", (0.05, 0, 0), 0.7)]
    joints = [joint("base", "outer", "revolute", Z, (0, 0, 0)), joint("inner", "outer", "revolute", Y, (0, 0, 0.1))]
    drives = [
        drive("base~outer", "servo", Law("constant", value=30.0), kp=4.0, kd=0.4, limit=0.9),
        drive("inner~outer", "dc_motor", resistance=2.0, constant=0.05, gear=10.0, voltage=6.0),
    ]
    found = design(device(parts, joints, drives=drives, duration=0.6, step=0.02))
    assert not export(found, "mjcf").lost
    assert followed(found, tmp_path) < 1e-5
    assert found.simulation.joint_effort.max() == pytest.approx(0.9) or found.simulation.joint_effort.min() < 0.0


@pytest.mark.parametrize(("name", "numbers"), [("motorised", ["ki = 2"]), ("controlled", ["0.02 H"])])
def test_what_a_servo_or_motor_is_without_is_named(name, numbers):
    lost = export(known(name), "mjcf").lost
    assert all(any(number in text for text in lost) for number in numbers)


def test_a_screw_is_a_stiff_coupling(tmp_path):
    """Its turn and its slide are two joints to MuJoCo, coupled like a loop."""
    assert followed(known("every_joint"), tmp_path) < 1e-3


@pytest.mark.parametrize("name", sorted(set(LOOPS) - {"driven_four_bar"}))
def test_closed_loops_move_alike(name, tmp_path):
    assert followed(known(name), tmp_path) < 1e-5


@pytest.mark.parametrize(
    "name", first(1, ["slider_crank", "bennett", "four_bar", "bricard_rectangular", "watt_six_bar"])
)
def test_loops_from_meshes_move_alike(name, tmp_path, derive_design):
    """Also those that only their proportions let move, and those with two loops."""
    (manifest,) = FIXTURES.glob(f"mechanisms/{name}/{name}.toml")
    found = swinging(derive_design(manifest))
    assert found.simulation.status == "done"
    assert export(found, "mjcf").lost == ()
    assert np.ptp(found.simulation.q_WB, axis=0).max() > 0.02
    assert followed(found, tmp_path) < 1e-5


def test_prescribed_motions_need_the_same_efforts(tmp_path):
    """A law is no part of MJCF: our motion is put in, and MuJoCo says what effort it takes."""
    found = known("seeker")
    mujoco, model, data = loaded(found, tmp_path)
    run = found.simulation
    names = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, k) for k in range(model.njnt)]
    order = [run.joint_names.index(name) for name in names]
    # Joints that the tree runs through backwards have reversed axes and the same values.
    for k in range(len(run.time)):
        q, v = run.joint_position[k], run.joint_velocity[k]
        data.qpos[:], data.qvel[:] = q[order], v[order]
        data.qacc[:] = run.joint_acceleration[k][order]
        data.ctrl[:] = 0.0
        mujoco.mj_inverse(model, data)
        driven = [n for n, name in enumerate(names) if name != "camera~inner"]
        np.testing.assert_allclose(data.qfrc_inverse[driven], run.joint_effort[k][order][driven], atol=1e-7)
        np.testing.assert_allclose(data.qfrc_inverse[names.index("camera~inner")], 0.0, atol=1e-7)


@pytest.mark.parametrize("name", ["gimbal", "every_joint", "four_bar"])
def test_masses_and_inertias_are_equal(name, tmp_path):
    found = known(name)
    mujoco, model, _ = loaded(found, tmp_path)
    exported = model_of(found)
    for body in exported.system.bodies:
        if not isinstance(body, RigidBody):
            continue
        k = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, body.subject)
        assert model.body_mass[k] == pytest.approx(body.mass, abs=1e-9)
        R = to_matrix(model.body_iquat[k])
        np.testing.assert_allclose(R @ np.diag(model.body_inertia[k]) @ R.T, body.inertia, atol=1e-9)
        np.testing.assert_allclose(model.body_ipos[k] + origin(exported, body.subject), body.centre_of_mass, atol=1e-9)


@pytest.mark.parametrize("name", ["gimbal", "passive_seeker", "four_bar"])
def test_axes_stand_where_ours_do(name, tmp_path):
    found = known(name)
    mujoco, model, data = loaded(found, tmp_path)
    mujoco.mj_resetData(model, data)
    mujoco.mj_forward(model, data)
    seen = 0
    for joint in found.kinematics.joints:
        k = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, joint.name)
        if k < 0:
            continue
        seen += 1
        np.testing.assert_allclose(np.cross(data.xaxis[k], joint.axis), 0.0, atol=1e-9)
        np.testing.assert_allclose(np.cross(data.xanchor[k] - joint.point, joint.axis), 0.0, atol=1e-9)
    assert seen >= 2


def test_a_loop_that_only_a_slider_can_close_cuts_a_body_in_halves(tmp_path):
    """Driven hinges stay in the tree of no format; here every joint of the loop is a slider or a cylinder."""
    from support.devices import Z, device, drive, joint
    from support.export_models import SLANT, X, block, design

    parts = [block("one", (0.1, 0, 0)), block("two", (0.1, 0.1, 0), 0.5)]
    joints = [
        joint("base", "one", "prismatic", X, (0, 0, 0)),
        joint("base", "two", "prismatic", SLANT, (0, 0, 0)),
        joint("one", "two", "planar", Z, (0.1, 0.1, 0)),
    ]
    found = design(device(parts, joints, drives=[drive("base~one", "spring", stiffness=300.0, rest=0.02)],
                          gravity=np.array([3.0, -1.0, 0.0]), duration=0.4, step=0.02))  # fmt: skip
    if found.simulation.status != "done":
        pytest.fail(found.simulation.reason)
    text = export(found, "mjcf").files["device.xml"].decode()
    root = ElementTree.fromstring(text)
    masses = [float(node.get("mass")) for node in root.iter("inertial")]
    assert sum(masses) == pytest.approx(1.5, abs=1e-12)
    assert root.find("equality/weld") is not None
    assert followed(found, tmp_path) < 1e-3


def body(name, *children):
    return SimpleNamespace(name=name, children=list(children))


def written(node, depth=1):
    """As a recursion has it."""
    inner = [row for child in node.children for row in written(child, depth + 1)]
    return [(node.name, depth, False), *inner, *([(node.name, depth, True)] if depth > 1 else [])]


@settings(max_examples=30)
@given(st.recursive(st.builds(body, st.integers()), lambda of: st.builds(body, st.integers(), of, of), max_leaves=20))
def test_bodies_begin_and_end_as_they_are_nested(root):
    assert [(one.name, depth, ends) for one, depth, ends in _nested(root)] == written(root)


@pytest.mark.parametrize(("count", "read"), [(MOST_NESTED, True), (MOST_NESTED + 1, False), (5000, False)])
def test_of_more_in_a_row_than_are_read_it_is_told(count, read):
    root = body("world")
    for k in range(count):
        root.children, inner = [body(k)], root.children
        root.children[0].children = inner
    if read:
        assert len(list(_nested(root))) == 2 * count + 1
    else:
        with pytest.raises(ExportError):
            list(_nested(root))
