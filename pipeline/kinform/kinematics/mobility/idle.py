"""Idle turns: a bolt, pin or roller that only spins.

A freedom is idle when it moves a single body, all of whose contact surfaces slide on themselves, and no intended joint
names it. Only turns about an axis of revolution qualify: a block that slides on a table leaves its place, a bolt that
spins does not. They count as freedoms of the assembly, and not as effective ones.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.screws import Frame, rotation, scaled, span, twist_at_origin
from kinform.foundation.algebra.vectors import cross, dot, norm, sine, widest_gap
from kinform.frozen import dataclass
from kinform.kinematics.constants import INTENDED_AXIS
from kinform.kinematics.joints.bodies.stated_joints import pair_between
from kinform.kinematics.joints.pair.evidence import COAXIAL
from kinform.kinematics.joints.pair.touches import TOUCHING
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Patch
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Joint
from kinform.model.names import BodyName, PartName
from kinform.model.surfaces import MeshSurfaces

IDLE_AXIS = 1e-3
"""Sine between axes, and part of a unit turn outside a joint's freedoms, that is none. Chosen, not measured."""
IDLE_PLACE = 1e-4
"""Share of the assembly's size by which axes and centres may lie apart. Chosen, not measured."""
INTENDED_PLACE = 1e-2
"""Share of the assembly's size by which the place of an intended joint may be off an idle turn. Chosen, not
measured."""


def touching_balls(
    assembly: Assembly, surfaces: Mapping[str, MeshSurfaces], patches: Sequence[Patch]
) -> dict[tuple[int, PartName], Array]:
    """Centres (3,) of the spheres that touch at points or along lines, by patch and part."""
    parts = {part.name: part for part in assembly.parts}
    out = {}
    for k, patch in enumerate(patches):
        if patch.kind not in TOUCHING:
            continue
        for name, number in zip(patch.parts, patch.surfaces, strict=True):
            mesh, X_WP = parts[name].mesh, parts[name].X_WP
            fitted = None if mesh is None or number < 0 else surfaces.get(mesh.digest)
            surface = None if fitted is None else fitted.surfaces[number]
            if surface is not None and surface.kind == "sphere":
                out[k, name] = X_WP[:3, :3] @ surface.point + X_WP[:3, 3]
    return out


def idle_turns(
    assembly: Assembly,
    graph: JointGraph,
    patches: Sequence[Patch],
    size: float,
    balls: Mapping[tuple[int, PartName], Array],
) -> dict[BodyName, Array]:
    """(k, 6) independent idle turns (ω; v at the world's origin) of each body whose joints all come from contact.

    `size` of the assembly (m); `balls`: what `touching_balls` gives.
    """
    of_part = {part: body.name for body in graph.bodies for part in body.parts}
    intended: dict[BodyName, list[IntendedJoint]] = defaultdict(list)
    for wanted in assembly.function.joints:
        # a bush or a pin may be between the two that a joint names
        for name in pair_between(assembly, of_part, wanted.between) or ():
            intended[name].append(wanted)
    around: dict[BodyName, list[Joint]] = defaultdict(list)
    for joint in graph.joints:
        for name in joint.bodies:
            around[name].append(joint)
    out: dict[BodyName, Array] = {}
    for body in graph.bodies:
        joints = around[body.name]
        indices = [k for j in joints for k in j.patches]
        if any(not j.patches for j in joints):
            continue
        centres = {}
        if len(joints) > 1:
            # a ball between others rolls; what lies on one other body only is there to move on it
            centres = {n: balls[k, p] for n, k in enumerate(indices) for p in body.parts if (k, p) in balls}
        held = _Held(body.ground, joints, [patches[k] for k in indices], intended[body.name], size, centres)
        out[body.name] = _idle_turns(held)
    return out


@dataclass(frozen=True, eq=False)
class _Held:
    """A body as its neighbours hold it."""

    ground: bool
    joints: Sequence[Joint]
    """All of its joints."""
    patches: Sequence[Patch]
    """The contacts that carry them."""
    intended: Sequence[IntendedJoint]
    """Those that name this body."""
    size: float
    """m: of the assembly."""
    balls: Mapping[int, Array]
    """By position in `patches`, the centre (3,) of the body's own surface where that is a sphere that touches at points
    or along a line."""


def _idle_turns(held: _Held) -> Array:
    """(k, 6) independent idle turns of one body.

    Tried are the axes of its surfaces of revolution. A turn counts where each joint of the body has it among its
    freedoms, each patch turns onto itself, and no intended joint means it.
    """
    if not held.joints or not held.patches or held.ground:
        return np.zeros((0, 6))
    patches = [
        replace(p, kind="sphere", point=held.balls[k]) if k in held.balls else p for k, p in enumerate(held.patches)
    ]
    lines = [
        (axis, point)
        for axis, point in _candidates(patches, held.size)
        if all(_turns_about(patch, axis, point, held.size) for patch in patches)
    ]
    if not lines or any(not joint.freedoms for joint in held.joints):
        return np.zeros((0, 6))
    frame = Frame.of(np.concatenate([p.points for p in held.patches]))
    spaces = [span(scaled(joint.twists.T, frame)) for joint in held.joints]
    leaf = len(held.joints) == 1
    turns = []
    for axis, point in lines:
        twist = rotation(axis, point, frame)
        if (
            all(norm(twist - free @ (free.T @ twist)) < IDLE_AXIS for free in spaces)
            and all(_goes_all_round(patch, axis, point) for patch in patches if patch.kind == "plane")
            and not any(_names(wanted, axis, point, leaf, held.size) for wanted in held.intended)
        ):
            turns.append(twist)
    return _independent(turns, frame)


def _independent(twists: Sequence[Array], frame: Frame) -> Array:
    """The first of the turns that are independent, of rate 1."""
    if not twists:
        return np.zeros((0, 6))
    kept: list[Array] = [twists[0]]
    for twist in twists[1:]:
        if span(np.array([*kept, twist]).T).shape[1] > len(kept):
            kept.append(twist)
    turns = twist_at_origin(np.array(kept).reshape(-1, 6).T, frame).T
    unit: Array = turns / np.linalg.norm(turns[:, :3], axis=1)[:, None]
    return unit


def _candidates(patches: Sequence[Patch], size: float) -> list[tuple[Array, Array]]:
    """Axes of revolution: of coaxial patches, through two centres, and three at a single centre."""
    lines = [(p.axis, p.point) for p in patches if p.kind in COAXIAL]
    centres = [p.point for p in patches if p.kind == "sphere"]
    for k, a in enumerate(centres):
        for b in centres[:k]:
            far = norm(b - a)
            if far > IDLE_PLACE * size:
                lines.append(((b - a) / far, a))
    if centres and not lines:
        lines = [(e, centres[0]) for e in np.eye(3)]
    return lines


def _turns_about(patch: Patch, axis: Array, point: Array, size: float) -> bool:
    """Does the surface of the patch turn onto itself about the axis?"""
    if patch.kind == "plane":
        return sine(patch.axis, axis) <= IDLE_AXIS
    if patch.kind != "sphere" and (patch.kind not in COAXIAL or sine(patch.axis, axis) >= IDLE_AXIS):
        return False
    return norm(cross(patch.point - point, axis)) <= abs(patch.gap) + IDLE_PLACE * size


def _goes_all_round(patch: Patch, axis: Array, point: Array) -> bool:
    """Does a patch of a plane across the axis turn onto itself, as bounded as it is?"""
    # the middle of what turns onto itself is on the axis, whatever the attitude; and it goes all round
    arm = patch.points - point
    arm = arm - np.outer(arm @ axis, axis)
    reach = float(patch.weights @ np.sqrt(dot(arm, arm)))
    # Distance of the middle of a face from an axis, over that of its points, beyond which it does not turn onto itself.
    if norm(patch.weights @ arm) > 0.2 * reach:
        return False
    # Nor does it where a wider angle about the axis is without any of it.
    return widest_gap(arm, axis) < math.radians(60.0)


def _names(wanted: IntendedJoint, axis: Array, point: Array, leaf: bool, size: float) -> bool:
    """Does the intended joint name this turn? A turn about its own axis, or any turn of a body that
    has no other joint."""
    if wanted.type == "fixed":
        return False
    if leaf:
        return True
    if wanted.type not in ("revolute", "cylindrical", "screw") or wanted.axis is None or wanted.point is None:
        return False
    parallel = sine(wanted.axis, axis) < INTENDED_AXIS
    return parallel and norm(cross(wanted.point - point, axis)) < INTENDED_PLACE * size
