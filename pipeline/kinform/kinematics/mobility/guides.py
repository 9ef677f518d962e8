"""Guides of slides and screws: which patches a joint runs along, and at which of its values the last of them ends."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts, Patch
from kinform.model.kinematics import Joint
from kinform.model.surfaces import MeshSurfaces


def joint_twist(joint: Joint) -> Array:
    """(6,) twist of a joint's value: |ω| 1 for turns, |v| 1 for slides, in the sense of its axis."""
    axis, point = joint.axis, joint.point
    assert axis is not None
    if joint.type == "prismatic":
        return np.concatenate([np.zeros(3), axis])
    assert point is not None
    pitch = joint.pitch or 0.0
    return np.concatenate([axis, cross(point, axis) + pitch / (2.0 * math.pi) * axis])


def preserved(patch: Patch, twists: Array) -> bool:
    """Whether the relative motions `twists` (k, 6) leave the two sides of a patch in contact."""
    for twist in twists:
        velocity = twist[3:] + cross(np.broadcast_to(twist[:3], patch.points.shape), patch.points)
        fastest = float(np.linalg.norm(velocity, axis=1).max(initial=0.0))
        # A patch mates along a motion whose velocity is within this share of tangential to it.
        if np.any(np.abs(np.einsum("ij,ij->i", velocity, patch.normals)) > 0.03 * fastest):
            return False
    return True


def guide(
    assembly: Assembly,
    surfaces: Mapping[str, MeshSurfaces],
    contacts: Contacts | None,
    joint: Joint,
    second: Collection[str],
) -> tuple[float, float]:
    """Values (rad or m) at which the last of the patches along which a joint slides is left; ±inf without patches.
    `second`: names of the parts of its second body."""
    if contacts is None or joint.axis is None:
        return -math.inf, math.inf
    rate = 1.0 if joint.type == "prismatic" else (joint.pitch or 0.0) / (2.0 * math.pi)
    guides = [patch for k in joint.patches if preserved(patch := contacts.patches[k], joint_twist(joint)[None])]
    span = overlap_along(assembly, surfaces, guides, joint.axis, second)
    if span is None or rate == 0.0:
        return -math.inf, math.inf
    pair = (span[0] / rate, span[1] / rate)
    return min(pair), max(pair)


def overlap_along(
    assembly: Assembly,
    surfaces: Mapping[str, MeshSurfaces],
    patches: Iterable[Patch],
    axis: Array,
    second: Collection[str],
) -> tuple[float, float] | None:
    """Slides (m) along `axis` of the parts `second` at which they have left the last of these patches; None where the
    surfaces of none are known."""
    ends = []
    for patch in patches:
        sides = zip(patch.parts, patch.surfaces, strict=True)
        a, b = (span_along(assembly, surfaces, name, surface, axis) for name, surface in sides)
        if a is None or b is None:
            continue
        if patch.parts[1] not in second:
            a, b = b, a
        ends.append((a[0] - b[1], a[1] - b[0]))
    return (min(e[0] for e in ends), max(e[1] for e in ends)) if ends else None


def span_along(
    assembly: Assembly, surfaces: Mapping[str, MeshSurfaces], name: str, surface: int, axis: Array
) -> tuple[float, float] | None:
    """Lowest and highest place (m) along `axis` of a surface of a part; None where the surface is not known."""
    part = assembly.part(name)
    known = None if part.mesh is None else surfaces.get(part.mesh.digest)
    if part.mesh is None or known is None or surface < 0:
        return None
    corners = part.mesh.vertices[np.unique(part.mesh.faces[known.labels == surface])]
    if not len(corners):
        return None
    heights = (corners @ part.X_WP[:3, :3].T + part.X_WP[:3, 3]) @ axis
    return float(heights.min()), float(heights.max())
