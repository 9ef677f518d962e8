"""Numbers that several packages of the kinematics share."""

from __future__ import annotations

SAME_DIRECTION = 1e-3
"""Unit directions that differ by less (sine) are one, and a screw that advances less a radian, over the size, is a
turn. A milliradian is a third of the default alignment tolerance. Chosen, not measured."""
INTENDED_AXIS = 0.02
"""Sine by which the axis of an intended joint, and share by which its motion, may be off what contact leaves: a degree,
or a fiftieth of the size. KF403 and KF404 compare axes more finely."""
