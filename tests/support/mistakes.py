"""Designs that are wrong, or not decided, each in its way: one for each rule that looks at a single joint."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform.kinematics.joints.pair.joint import twists_of
from kinform.model.checks import Ignore
from kinform.model.contacts import Interference
from kinform.model.function import Coupling, Drive, Law, Load, Requirement
from kinform.model.kinematics import Blocker, Membership, UndeclaredJoint


def with_function(design, function):
    return replace(design, assembly=replace(design.assembly, function=function))


def changed_function(design, **changes):
    return with_function(design, replace(design.assembly.function, **changes))


def changed_joint(design, **changes):
    kinematics = design.kinematics
    return replace(design, kinematics=replace(kinematics, joints=(replace(kinematics.joints[0], **changes),)))


def as_planar(design):
    """The derived joint slides on a plane across its axis, too."""
    joint = design.kinematics.joints[0]
    twists = twists_of("planar", joint.axis, joint.point)
    return changed_joint(design, type="planar", freedoms=3, twists=twists)


def changed_intent(design, **changes):
    stated = replace(design.assembly.function.joints[0], **changes)
    return changed_function(design, joints=(stated,))


def changed_mesh(design, **health):
    first, *rest = design.assembly.parts
    mesh = replace(first.mesh, health=replace(first.mesh.health, **health))
    return replace(design, assembly=replace(design.assembly, parts=(replace(first, mesh=mesh), *rest)))


def overlapping(design, mated):
    return replace(design, contacts=replace(design.contacts, interferences=(_overlap(mated),)))


def perhaps_overlapping(design):
    return replace(design, contacts=replace(design.contacts, possible_overlaps=(_overlap(mated=False),)))


def _overlap(mated):
    return Interference(("block", "shaft"), 1e-9, 5e-3, np.zeros(3), mated, "manifold")


def tilted(axis, degrees):
    across = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    across /= np.linalg.norm(across)
    return np.cos(np.radians(degrees)) * axis + np.sin(np.radians(degrees)) * across


def drive(joint, kind="motion"):
    return Drive(joint, kind, Law("constant"), {}, 1e-3, "m.toml", 30)


def blocked(design):
    blocker = Blocker(("block", "shaft"), 0, 1e-6, 0.05, np.zeros(3), 0.0, "rotation about (0, 0, 1)")
    axis = design.kinematics.joints[0].axis
    slide = np.concatenate([np.zeros(3), axis])[None]  # collars forbid it in both senses
    return changed_joint(
        design, status="blocked", blockers=(blocker,), reason="1 of 4 patches left out", type="prismatic", twists=slide
    )


WRONG = {
    "KF101": lambda d: changed_mesh(d, watertight=False, open_edges=3),
    "KF102": lambda d: changed_mesh(d, volume=-1e-6),
    "KF103": lambda d: changed_mesh(d, consistent_winding=False),
    "KF104": lambda d: changed_mesh(d, manifold_status="NotManifold"),
    "KF105": lambda d: changed_mesh(d, degenerate_facets=2),
    "KF106": lambda d: changed_mesh(d, duplicate_facets=2),
    "KF107": lambda d: changed_mesh(d, shells=2),
    "KF201": lambda d: overlapping(d, mated=False),
    "KF202": lambda d: overlapping(d, mated=True),
    "KF204": blocked,
    "KF205": lambda d: changed_joint(d, status="inferred", evidence=("rim",)),
    "KF206": lambda d: replace(
        d, kinematics=replace(d.kinematics, misaligned=((d.kinematics.joints[0].name, 0.01, 0.0),))
    ),
    "KF208": lambda d: replace(
        d, kinematics=replace(d.kinematics, membership=(Membership("shaft", "shaft", "cut", 1.0, "block", True),))
    ),
    "KF210": perhaps_overlapping,
    "KF301": lambda d: changed_function(d, mobility=2),
    "KF402": lambda d: changed_intent(d, type="prismatic", point=None),
    "KF403": lambda d: changed_intent(d, axis=tilted(d.assembly.function.joints[0].axis, 0.5)),
    "KF404": lambda d: changed_intent(d, point=d.assembly.function.joints[0].point + np.array([0.002, 0.001, -0.003])),
    "KF414": lambda d: as_planar(d),
    "KF416": lambda d: replace(
        d,
        kinematics=replace(
            d.kinematics,
            membership=(Membership("shaft", "block", "held", 1.0, "", False),),
            left_out=(
                UndeclaredJoint("block", "revolute", np.array([0.0, 0, 1]), np.zeros(3), ("block",), ("shaft",), ""),
            ),
        ),
    ),
    "KF409": lambda d: changed_function(d, drives=(drive("wing"),)),
}


UNDECIDED = {
    "KF901": lambda d: changed_joint(d, status="ambiguous", reason="singular value 0.001"),
    "KF902": lambda d: changed_function(
        d, requirements=(Requirement("weak", "torque", {"joint": "swing", "limit": 1.0}, "m.toml", 40),)
    ),
    "KF903": lambda d: changed_function(d, couplings=(Coupling(("swing", "swing"), 2.0, "m.toml", 40),)),
    "KF904": lambda d: replace(changed_intent(d, range=(-1.0, 1.0)), simulation=replace(d.simulation, ranges=None)),
    "KF905": lambda d: changed_function(
        d, loads=(Load("shaft", np.array([0.0, 0.0, 1.0]), None, None, "world", "m.toml", 40),)
    ),
}


def ignore(code, subject=None, reason="it is meant"):
    return Ignore(code, subject, reason, "m.toml", 33)
