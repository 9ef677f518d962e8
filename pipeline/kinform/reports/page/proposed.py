"""Joints that may be meant, of a design without function: each as a motion of what it would part, and as TOML."""

from __future__ import annotations

import numpy as np

from kinform.design import Design
from kinform.form.without_manifest import joint_lines, reach
from kinform.foundation.algebra.displacements import displacement
from kinform.foundation.algebra.spatial import quaternions
from kinform.frozen import dataclass
from kinform.kinematics import stated_proposals
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Body
from kinform.reports.page.constants import SHOWN_TURN, SIDE_FRAMES
from kinform.reports.page.movements import Movement

MOST_PROPOSED_PARTS = 400
"""Joints are proposed on the page of assemblies of so many parts at most: beyond, looking takes longer than drawing."""


@dataclass(frozen=True, eq=False)
class ProposedJoint:
    """A joint that may be meant."""

    name: str
    text: str
    """Type, and what it would move."""
    toml: str
    """Its table in a manifest."""
    movement: Movement


def proposed(design: Design, bodies: tuple[Body, ...]) -> list[ProposedJoint]:
    """Joints that may be meant where no function is stated, the largest moved share first. None of assemblies of more
    than `MOST_PROPOSED_PARTS` parts, and none that would tear a body apart."""
    function, many = design.assembly.function, len(design.assembly.parts)
    if design.contacts is None or function.joints or function.complete or many > MOST_PROPOSED_PARTS:
        return []
    out = []
    for joint, one in stated_proposals(design.assembly, design.surfaces, design.contacts):
        moving = one.sides[1]
        moved = tuple(body.name for body in bodies if set(body.parts) <= set(moving))
        if sum(len(body.parts) for body in bodies if body.name in moved) == len(moving):
            toml = "\n".join(joint_lines(joint, design.assembly.units, reach(design.assembly))) + "\n"
            out.append(ProposedJoint(joint.name, f"{joint.type}, {one.words}", toml, _turned(joint, moved)))
    return out


def _turned(joint: IntendedJoint, moved: tuple[str, ...]) -> Movement:
    """The bodies turned about the joint's axis to both sides; about one of its axes of a ball."""
    assert joint.point is not None
    axis = np.array([0.0, 0.0, 1.0]) if joint.axis is None else joint.axis
    screw = np.concatenate([axis, np.cross(joint.point, axis)])
    shares = np.linspace(-1.0, 1.0, 2 * SIDE_FRAMES + 1)
    poses = np.array([displacement(share * SHOWN_TURN * screw) for share in shares])
    turns = np.repeat(quaternions(poses[:, :3, :3])[:, None], len(moved), axis=1)
    return Movement(
        kind="proposal",
        name=f"Proposed: {joint.name} (turn)",
        note="a joint that may be meant" if joint.axis is not None else "a ball that may be meant, about z",
        time=shares,
        bodies=moved,
        places=np.repeat(poses[:, None, :3, 3], len(moved), axis=1),
        turns=turns,
        joint=joint.name,
        ends=(-SHOWN_TURN, SHOWN_TURN),
    )
