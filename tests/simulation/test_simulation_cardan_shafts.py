"""Two universal joints in a row, against the closed form of their angles and the balance of their power."""

import numpy as np
import pytest

from kinform.behaviour import Model, Ramp
from kinform.simulation import Course, simulate_system

BEND, LENGTH, SPEED = 0.5, 0.4, 10.0
INPUT, LATERAL = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
MIDDLE = np.array([np.cos(BEND), 0.0, np.sin(BEND)])


def shaft(phase):
    """Input and output are parallel; `phase` is how far the yokes of the middle shaft are turned against each other,
    beyond a right angle from where they lie in one plane."""
    second = np.cos(phase) * LATERAL + np.sin(phase) * np.cross(MIDDLE, LATERAL)
    far, across = LENGTH * MIDDLE, np.cross(INPUT, second)
    model = Model()
    model.ground("frame")
    model.body("in", 1.0, (-0.1, 0, 0), (2e-3, 1e-3, 1e-3))
    around = np.outer(MIDDLE, MIDDLE)
    model.body("middle", 0.5, far / 2, 5e-4 * around + 4e-3 * (np.eye(3) - around))
    model.body("out", 1.0, far + 0.1 * INPUT, (2e-3, 1e-3, 1e-3))
    model.joint("bearing", "frame", "in", axis=INPUT, point=(0, 0, 0))
    model.joint("first", "in", "middle", "universal", axis=LATERAL, axis2=np.cross(MIDDLE, LATERAL), point=(0, 0, 0))
    model.joint("second", "middle", "out", "universal", axis=second, axis2=across, point=far)
    model.joint("sleeve", "frame", "out", "cylindrical", axis=INPUT, point=far)
    model.motion("drive", "bearing", Ramp(0.0, SPEED))
    return model, second, far


def turned(axis, vectors):
    """(T,) angles about `axis` from the first of the vectors, unwound."""
    return np.unwrap(np.arctan2(np.cross(vectors[0], vectors) @ axis, vectors @ vectors[0]))


@pytest.mark.parametrize("phase", [0.0, 0.3, np.pi / 2])
def test_the_output_turns_as_the_yokes_say(phase):
    model, second, _ = shaft(phase)
    run = simulate_system(model.system("cardan"), Course(1.0, 0.005, (0, 0, 0)))
    assert run.status == "done"
    angle = SPEED * run.time
    yoke = np.column_stack([0 * angle, np.cos(angle), np.sin(angle)])
    cross = np.cross(MIDDLE, yoke)
    middle = turned(MIDDLE, cross / np.linalg.norm(cross, axis=1)[:, None])[:, None]
    carried = np.cos(middle) * second + np.sin(middle) * np.cross(MIDDLE, second)
    pin = np.cross(INPUT, carried)
    wanted = turned(INPUT, pin / np.linalg.norm(pin, axis=1)[:, None])
    column = run.joint_offset[run.joint_names.index("sleeve")]
    np.testing.assert_allclose(run.joint_position[:, column], wanted, atol=1e-11)
    np.testing.assert_allclose(run.joint_position[:, column + 1], 0.0, atol=1e-12)
    if phase == np.pi / 2:
        np.testing.assert_allclose(wanted, angle, atol=1e-12)
    # Where the middle shaft neither speeds up nor slows down there are no wrenches at all: no measure of their errors.
    assert run.balance.max() < 1e-9


def test_the_drive_gives_what_inertia_and_brake_take():
    model, _, far = shaft(0.3)
    model.load("brake", "out", far, torque=-0.7 * INPUT)
    run = simulate_system(model.system("cardan"), Course(0.5, 0.001, (0, 0, 0)))
    columns = [run.joint_offset[run.joint_names.index(name)] for name in ("bearing", "sleeve")]
    kinetic = np.gradient(run.energy[:, 0], run.time, edge_order=2)
    wanted = (kinetic + 0.7 * run.joint_velocity[:, columns[1]]) / SPEED
    np.testing.assert_allclose(run.joint_effort[3:-3, columns[0]], wanted[3:-3], rtol=1e-4, atol=1e-4)
