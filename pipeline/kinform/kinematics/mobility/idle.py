"""Idle turns: of a bolt, a pin, a roller or a ball that only spins.

A freedom is idle when nobody could see it: it turns one body onto itself, a bare solid of revolution, a ball or a
fastener (`revolution`), and no intended joint names it. A door leaf, an eccentric, a wheel with lugs are seen to turn,
and what slides is elsewhere afterwards. Idle turns count as freedoms of the assembly, and not as effective ones.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np

from kinform.foundation.algebra.screws import Frame, rotation, scaled, span, twist_at_origin
from kinform.foundation.algebra.vectors import cross, norm, sine
from kinform.frozen import dataclass
from kinform.kinematics.constants import INTENDED_AXIS
from kinform.kinematics.joints.bodies.stated_joints import pair_between
from kinform.kinematics.joints.pair.evidence import COAXIAL
from kinform.kinematics.joints.pair.touches import TOUCHING
from kinform.kinematics.mobility.revolution import Revolution, revolution_of
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Patch
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Body, Joint
from kinform.model.names import BodyName
from kinform.model.surfaces import MeshSurfaces

IDLE_AXIS = 1e-3
"""Part of a unit turn outside a joint's freedoms that is none. Chosen, not measured."""
IDLE_PLACE = 1e-4
"""Share of the assembly's size by which axes and centres may lie apart. Chosen, not measured."""
INTENDED_PLACE = 1e-2
"""Share of the assembly's size by which the place of an intended joint may be off an idle turn. Chosen, not
measured."""


def idle_turns(
    assembly: Assembly,
    graph: JointGraph,
    patches: Sequence[Patch],
    size: float,
    surfaces: Mapping[str, MeshSurfaces],
) -> dict[BodyName, Array]:
    """(k, 6) independent idle turns (ω; v at the world's origin) of each body whose joints all come from contact.

    `size` of the assembly (m); `surfaces` by the digest of their mesh. The stated ground has none. Where ground is
    assumed, that body may be the pin, which turns in the rest as well as the rest about it.
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

    def turns(body: Body) -> Array:
        joints = around[body.name]
        if not joints or not all(joint.patches and joint.freedoms for joint in joints) or _rolls(joints, patches):
            return np.zeros((0, 6))
        shape = revolution_of([assembly.part(name) for name in body.parts], surfaces)
        if shape is None:
            return np.zeros((0, 6))
        touching = [patches[k] for joint in joints for k in joint.patches]
        return _Held(shape, joints, touching, intended[body.name], assembly.tolerances.alignment, size).turns()

    out = {body.name: turns(body) for body in graph.bodies if not body.ground}
    for body in graph.bodies:
        if body.ground and assembly.ground is None:
            own = [turn for turn in turns(body) if not _all_turn(turn, out, around, size)]
            out[body.name] = np.array(own).reshape(-1, 6)
    return out


def _all_turn(
    turn: Array, idle: Mapping[BodyName, Array], around: Mapping[BodyName, Sequence[Joint]], size: float
) -> bool:
    """Whether all bodies other than ground that have joints turn about this axis idly: then that ground does as well
    is nothing new."""
    frame = Frame(np.zeros(3), size)
    unit = scaled(turn[:, None], frame)[:, 0]
    unit = unit / norm(unit)
    spaces = [span(scaled(turns.T, frame)) for name, turns in idle.items() if around[name]]
    return all(norm(unit - space @ (space.T @ unit)) < INTENDED_AXIS for space in spaces)


def _rolls(joints: Sequence[Joint], patches: Sequence[Patch]) -> bool:
    """Whether points and lines on one other body are all that a body touches: it is there to roll on it, and turns
    where it goes elsewhere."""
    return len(joints) == 1 and all(patches[k].kind in TOUCHING for k in joints[0].patches)


@dataclass(frozen=True, eq=False)
class _Held:
    """A body that turns onto itself, as its neighbours hold it."""

    shape: Revolution
    joints: Sequence[Joint]
    """All of its joints."""
    patches: Sequence[Patch]
    """The contacts that carry them."""
    intended: Sequence[IntendedJoint]
    """Those that name this body."""
    alignment: float
    """rad by which axes that mate may differ."""
    size: float
    """m: of the assembly."""

    def turns(self) -> Array:
        """(k, 6) independent idle turns: about axes of the shape, where each joint of the body has the turn among its
        freedoms, and no intended joint means it."""
        frame = Frame.of(np.concatenate([patch.points for patch in self.patches]))
        spaces = [span(scaled(joint.twists.T, frame)) for joint in self.joints]
        leaf = len(self.joints) == 1
        found = []
        for axis, point in self._lines():
            twist = rotation(axis, point, frame)
            free = all(norm(twist - space @ (space.T @ twist)) < IDLE_AXIS for space in spaces)
            if free and not any(_names(wanted, axis, point, leaf, self.size) for wanted in self.intended):
                found.append(twist)
        return _independent(found, frame)

    def _lines(self) -> list[tuple[Array, Array]]:
        """Axes of the shape, as it was fitted and as its contacts have it: their fits and clearances move them."""
        contacts = [(p.axis, p.point, p.misalignment, abs(p.gap) + p.offset) for p in self.patches if p.kind in COAXIAL]
        if self.shape.axis is None:
            centres = [p.point for p in self.patches if p.kind == "sphere"] or [self.shape.point]
            own = [(axis, centre) for centre in centres for axis in np.eye(3)]
        else:
            own = [(self.shape.axis, self.shape.point)]
        return own + [
            (axis, point)
            for axis, point, tilt, off in contacts
            if self.shape.is_about(axis, point, self.alignment + tilt, IDLE_PLACE * self.size + off)
        ]


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
