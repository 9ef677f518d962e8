"""An axis, and its place, are known no better than the pin and the bore agree (KF403, KF404)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.assemblies import assembly, intended
from support.diagonal import diagonal
from support.solids import box, part, random_pose, rod

from kinform import contacts, kinematics, surfaces
from kinform.consistency.comparisons.intended_joints import compare_joints

CLEARANCE = 0.35
FRAME = box(-14, 14, -14, 14, -10, -3) - rod(6 + CLEARANCE, -11, -2, 128) + box(-14, 14, 8, 14, -10, 6)
FRAME += box(-14, 14, -14, 14, 0, 6)


def wheel(tilt, off):
    """A wheel whose pin, which ends at a square face, lies askew (degrees) and off the middle (mm) of its bore."""
    pin = (rod(6, -30, 10, 96) + rod(25, -28, -18, 96)).rotate((tilt, 0, 0)).translate((off, 0, 0))
    return pin - box(-40, 40, -40, 40, 0, 40)


def compared(frame, moving, direction, point, scale, names=("frame", "wheel")):
    """The comparison of a revolute joint along a direction through a point (mm)."""
    X = random_pose(np.random.default_rng(3), 100 * scale)
    parts = [part(name, solid, X, scale) for name, solid in zip(names, (frame, moving), strict=True)]
    joint = intended("turn", *names, "revolute", X[:3, :3] @ np.asarray(direction, float))
    joint = replace(joint, point=X[:3, :3] @ np.asarray(point, float) * scale + X[:3, 3])
    made = assembly(*parts, ground=names[0], joints=(joint,))
    found = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, found)
    (one,) = compare_joints(made, touching, kinematics.derive(made, found, touching), [joint])
    return made, one


def faults(made, one):
    """Whether the axis is elsewhere for sure: in direction, in place."""
    assert one.right_type
    return (
        one.angle > made.tolerances.angle_limit() + one.angle_slack,
        one.offset > one.position_limit + one.position_slack,
    )


@diagonal(3, tilt=[0.22, 0.26, 0.5], scale=[1e-4, 1e-3, 1.0], names=[("frame", "wheel"), ("z", "wheel")])
def test_a_pin_askew_in_its_clearance_does_not_contradict_the_axis_of_its_bore(tilt, scale, names):
    assert faults(*compared(FRAME, wheel(tilt, 0.0), (0, 0, 1), (0, 0, 0), scale, names)) == (False, False)


@diagonal(3, off=[0.1, 0.3, -0.34], scale=[1e-4, 1e-3, 1.0])
def test_a_pin_off_the_middle_of_its_bore_is_at_neither_for_sure(off, scale):
    for point in ((0, 0, 0), (off, 0, 0)):
        assert faults(*compared(FRAME, wheel(0.0, off), (0, 0, 1), point, scale)) == (False, False)


@pytest.mark.parametrize(("tilt", "off"), [(1.0, 0.0), (0.0, 1.0)])
def test_beyond_what_pin_and_bore_agree_to_it_is_elsewhere(tilt, off):
    direction = (0, np.sin(np.radians(tilt)), np.cos(np.radians(tilt)))
    made, one = compared(FRAME, wheel(0.0, 0.0), direction, (off, 0, 0), 1e-3)
    assert faults(made, one) == (tilt > 0.0, off > 0.0)
