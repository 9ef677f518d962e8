"""What a description says word for word, beside the tables that are made of it: `Description`, in the frame F.

The tables leave out what a manifest cannot say, such as limits that are not ascending or geometry of the other kind;
rules ask about these, and an export writes back what was not touched.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field

import numpy as np

from kinform.formats.description.robot import Link, Robot, RobotJoint, Shape, Stated
from kinform.frozen import dataclass
from kinform.model.descriptions import DescribedJoint, DescribedLink, Description, StatedMass


@dataclass(frozen=True, eq=False)
class Facts:
    """A description, and by link the shapes of the geometry that is not read as parts."""

    description: Description
    others: Mapping[str, tuple[Shape, ...]]
    alike: frozenset[str]
    """Links whose geometry of both kinds is the same."""
    absent: Mapping[str, tuple[Shape, ...]] = field(default_factory=dict)
    """By link the shapes that would be parts, and whose meshes are not there."""


def facts_of(
    robot: Robot, file: str, geometry: str, parts: Mapping[str, Sequence[str]], absent: Mapping[str, tuple[Shape, ...]]
) -> Facts:
    """The facts of a robot; `geometry` is what its parts are, `parts` are their names by link, and `absent` the shapes
    of links without files."""
    other = "collision" if geometry == "visual" else "visual"
    offsets = {ratio.joints[0]: ratio.offset for ratio in robot.ratios}
    description = Description(
        file=file,
        prefix="",
        format=robot.format,
        text=robot.text,
        links=tuple(_link(link, tuple(parts.get(link.name, ()))) for link in robot.links),
        joints=tuple(_joint(joint, offsets.get(joint.name, 0.0)) for joint in robot.joints if not joint.closure),
    )
    alike = frozenset(
        link.name for link in robot.links if set(map(_key, link.visual)) == set(map(_key, link.collision))
    )
    return Facts(description, {link.name: link.shapes(other) for link in robot.links}, alike, absent)


def _key(shape: Shape) -> tuple[object, ...]:
    return shape.geometry, shape.scale, shape.metres, shape.X_FG.tobytes()


def _link(link: Link, parts: tuple[str, ...]) -> DescribedLink:
    return DescribedLink(
        link.name, link.at.file, link.at.line, link.X_FL[:3, :3].copy(), link.X_FL[:3, 3].copy(), parts,
        len(link.visual), len(link.collision), None if link.stated is None else _stated(link.stated),
    )  # fmt: skip


def _stated(stated: Stated) -> StatedMass:
    return StatedMass(stated.mass, None if stated.six is None else np.array(stated.six), stated.at.line)


def _joint(joint: RobotJoint, offset: float) -> DescribedJoint:
    limits = joint.limits
    return DescribedJoint(
        joint.name, joint.at.file, joint.at.line, limits.kind if limits else joint.type, joint.between,
        joint.axis, joint.point, limits is not None and limits.needed,
        limits.bounds if limits else None, limits.effort if limits else None, limits.speed if limits else None,
        limits is not None and limits.degrees, offset,
    )  # fmt: skip
