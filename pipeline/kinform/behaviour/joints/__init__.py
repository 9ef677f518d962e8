"""Kinds of joints, one a file: coordinates and motion. `general` joints have neither and are not here."""

from __future__ import annotations

from kinform.behaviour.joints.cylindrical import CYLINDRICAL
from kinform.behaviour.joints.fixed import FIXED
from kinform.behaviour.joints.kind import JointGeometry, JointKind
from kinform.behaviour.joints.planar import PLANAR
from kinform.behaviour.joints.prismatic import PRISMATIC
from kinform.behaviour.joints.revolute import REVOLUTE
from kinform.behaviour.joints.screw import SCREW
from kinform.behaviour.joints.spherical import SPHERICAL
from kinform.behaviour.joints.universal import UNIVERSAL

__all__ = ["KINDS", "JointGeometry", "JointKind"]

KINDS: dict[str, JointKind] = {
    kind.name: kind for kind in (FIXED, REVOLUTE, PRISMATIC, CYLINDRICAL, SPHERICAL, PLANAR, SCREW, UNIVERSAL)
}
