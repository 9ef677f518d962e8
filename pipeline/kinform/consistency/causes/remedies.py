"""Where parts should be, in the words, the frame and the unit of the file that places them."""

from __future__ import annotations

import math

import numpy as np

from kinform.consistency.causes.movable import Movable
from kinform.consistency.context import Context
from kinform.foundation.units import METRES_PER_UNIT
from kinform.foundation.words import length_unit, number, quoted
from kinform.model.arrays import Array
from kinform.model.assembly import Part
from kinform.model.descriptions import DescribedJoint, DescribedLink, Description

STEP = 1e-4
"""Share of a vector's length to which its numbers are rounded: what facets in single precision tell."""


def rounded(vector: Array) -> Array:
    """The vector with as many decimals as are known of it."""
    size = float(np.linalg.norm(vector))
    if size == 0.0:
        return vector
    digits = -math.floor(math.log10(STEP * size))
    return np.asarray(np.round(vector, digits) + 0.0)


def pose_in_file(part: Part) -> Array:
    """(4, 4) of the frame of the mesh file in the world."""
    X = part.X_WP.copy()
    if part.mesh is not None:
        X[:3, 3] -= X[:3, :3] @ part.mesh.origin
    return X


def numbers(values: Array, scale: float = 1.0) -> list[str]:
    """As a file has them: six significant digits, of lengths no more than their rounding leaves."""
    return [number(float(np.round(value * scale, 9)), 6) for value in values]


def vector_words(shift: Array, units: str) -> str:
    """ "(0, 0, -0.8) mm": in the unit in which lengths of the assembly are shown."""
    unit = length_unit(float(np.abs(shift).max()), units)
    return f"({', '.join(numbers(rounded(shift), 1.0 / METRES_PER_UNIT[unit]))}) {unit}"


def placing(context: Context, moved: Movable, motion: Array) -> str:
    """How to place parts that a motion (4, 4; world) puts right: with the numbers of the file that places them."""
    for description in context.assembly.descriptions:
        link = next((link for link in description.links if link.name == moved.name), None)
        if link is not None:
            told = _of_link(context, description, link, moved, motion)
            if told is not None:
                return told
    vector = vector_words(motion[:3, 3], context.units)
    name = min(moved.parts)
    part = context.assembly.part(name)
    manifest = context.assembly.source.file
    placed = part.source.file == manifest and manifest.endswith(".toml") and "/" not in name
    if placed and len(moved.parts) == 1 and not context.assembly.descriptions:
        position = (motion @ pose_in_file(part))[:3, 3]
        size = float(np.linalg.norm(motion[:3, 3]))
        digits = -math.floor(math.log10(STEP * size))
        values = numbers(np.round(position, digits), 1.0 / METRES_PER_UNIT[context.units])
        return f"Move '{name}' by {vector}: `position = [{', '.join(values)}]`."
    what = f"'{name}'" if len(moved.parts) == 1 else f"the parts {quoted(sorted(moved.parts))}"
    return f"Move {what} by {vector}, in the axes of the file."


def _of_link(
    context: Context, description: Description, link: DescribedLink, moved: Movable, motion: Array
) -> str | None:
    """The same for a link of a description, whose meshes or whose joint is in the wrong place."""
    if moved.branch:
        joint = next((joint for joint in description.joints if joint.between[1] == link.name), None)
        parent = None if joint is None else _link(description, joint.between[0])
        if joint is None or parent is None:
            return None
        return _origin(
            description, f"joint '{joint.name}'", np.linalg.inv(pose_of(parent)) @ motion @ pose_of(link), joint
        )
    if moved.parts != frozenset(link.parts):
        return None
    places = [np.linalg.inv(pose_of(link)) @ motion @ pose_in_file(context.assembly.part(name)) for name in link.parts]
    if len(places) == 1:
        what = (
            f"<visual> and <collision> of link '{link.name}'"
            if description.format == "urdf"
            else f"the mesh of '{link.name}'"
        )
        return _origin(description, what, places[0], None)
    vector = np.linalg.inv(pose_of(link))[:3, :3] @ motion[:3, 3]
    return (
        f"Move each mesh of link '{link.name}' by ({', '.join(numbers(rounded(vector)))}) m in the frame of the link."
    )


def _origin(description: Description, what: str, X: Array, joint: DescribedJoint | None) -> str:
    """The place of something in its frame, as the format writes it."""
    xyz, rpy = " ".join(numbers(X[:3, 3])), " ".join(numbers(_rpy(X[:3, :3])))
    if description.format == "urdf":
        return f'In {what} write <origin xyz="{xyz}" rpy="{rpy}"/>.'
    if description.format == "sdf" and joint is None:
        return f"In {what} write <pose>{xyz} {rpy}</pose>."
    return f"Place {what} at ({', '.join(xyz.split())}) m, roll, pitch and yaw ({', '.join(rpy.split())}) rad."


def pose_of(link: DescribedLink) -> Array:
    """(4, 4) of the frame of a link in the world."""
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = link.rotation, link.position
    return X


def _link(description: Description, name: str) -> DescribedLink | None:
    return next((link for link in description.links if link.name == name), None)


def _rpy(R: Array) -> Array:
    """Roll, pitch and yaw (rad): R = Rz Ry Rx."""
    pitch = math.asin(min(1.0, max(-1.0, -float(R[2, 0]))))
    if abs(float(R[2, 0])) > 1.0 - 1e-9:
        return np.array([math.atan2(-float(R[1, 2]), float(R[1, 1])), pitch, 0.0])
    return np.array([math.atan2(float(R[2, 1]), float(R[2, 2])), pitch, math.atan2(float(R[1, 0]), float(R[0, 0]))])
