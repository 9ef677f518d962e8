"""Makes the mechanism in joint coordinates out of a port model."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from kinform.behaviour.components import RigidBody, System
from kinform.behaviour.joints import JointGeometry
from kinform.behaviour.primitives import Ball, OneFreedom, Primitive
from kinform.foundation.rounding import SINGLE
from kinform.model.arrays import Array
from kinform.simulation.mechanism.mechanism import BallLink, Mechanism, Slot
from kinform.simulation.mechanism.topology import Topology, arrange


@dataclass
class _Links:
    """Links and rates as they are made."""

    slots: tuple[Slot, ...]
    length: float
    parent: list[int] = field(default_factory=lambda: [-1])
    screws: list[tuple[int, int, OneFreedom]] = field(default_factory=list)
    balls: list[BallLink] = field(default_factory=list)
    columns: dict[int, tuple[Array, int, int, float]] = field(default_factory=dict)

    def grow(self, slot: Slot, chain: tuple[Primitive, ...], parent: int, forward: bool) -> int:
        """Add the joint's primitives to link `parent`, from its first body or from its second."""
        steps = list(zip(chain, slot.kind.uses, strict=True))
        for primitive, use in steps if forward else reversed(steps):
            link = len(self.parent)
            self.parent.append(parent)
            q, v = slot.q.start + use, slot.v.start + use
            if isinstance(primitive, Ball):
                self._ball(primitive, link, q, v, parent, forward)
            else:
                self._screw(primitive if forward else primitive.reversed(), link, q, v, parent)
            parent = link
        return parent

    def _screw(self, primitive: OneFreedom, link: int, q: int, v: int, parent: int) -> None:
        self.screws.append((link, q, primitive))
        scale = 1.0 if primitive.omega.any() else self.length
        self.columns[v] = (primitive.twist, parent, link, scale)

    def _ball(self, ball: Ball, link: int, q: int, v: int, parent: int, forward: bool) -> None:
        """ω is in the axes of the joint's first body: `parent`, or the new link when reversed."""
        self.balls.append(BallLink(link, q, v, ball.point, forward))
        sign = 1.0 if forward else -1.0
        for k, axis in enumerate(np.eye(3)):
            twist = sign * np.concatenate([axis, np.cross(ball.point, axis)])
            self.columns[v + k] = (twist, parent if forward else link, link, 1.0)


def assemble(system: System) -> tuple[Mechanism, tuple[str, ...]]:
    """The mechanism, and the bodies that nothing connects with the ground."""
    bodies, joints = system.bodies, system.joints
    index = {body.name: k for k, body in enumerate(bodies)}
    pairs = [(index[system.body_at(j.name, "a").name], index[system.body_at(j.name, "b").name]) for j in joints]
    rigid = [joint.kind.rates == 0 for joint in joints]
    topology = arrange(len(bodies), pairs, rigid, index[system.ground.name])
    slots = _slots(system)
    centre, length = _extent(system)
    chains = [
        joint.kind.chain(_moved(joint.geometry, centre)) if topology.node_of[pair[0]] >= 0 else ()
        for joint, pair in zip(joints, pairs, strict=True)
    ]
    links = _Links(slots, length)
    link_of_node = {0: 0}
    for step in topology.carried:
        link_of_node[step.node] = links.grow(
            slots[step.joint], chains[step.joint], link_of_node[step.parent], step.forward
        )
    closures = []
    for joint in topology.closing:
        first, second = (link_of_node[topology.node_of[body]] for body in pairs[joint])
        closures.append((links.grow(slots[joint], chains[joint], first, True), second))
    mechanism = _finish(system, links, topology, link_of_node, closures, centre, length)
    return mechanism, tuple(bodies[k].subject for k in topology.adrift)


def _slots(system: System) -> tuple[Slot, ...]:
    slots, q, v = [], 0, 0
    for joint in system.joints:
        more_q, more_v = len(joint.kind.coordinates), joint.kind.rates
        slots.append(Slot(joint.subject, joint.kind, slice(q, q + more_q), slice(v, v + more_v)))
        q, v = q + more_q, v + more_v
    return tuple(slots)


def _extent(system: System) -> tuple[Array, float]:
    """Centre and half diagonal (m) of the box of joints and centres of mass. Where that is a point but for rounding, as
    of a ram in its bore, the greatest radius of gyration, or 1 m where there is none."""
    points = [j.geometry.point for j in system.joints if j.geometry.point is not None]
    points += [c.centre_of_mass for c in system.bodies if hasattr(c, "centre_of_mass")]
    points = [point for point in points if np.all(np.isfinite(point))]
    if not points:
        return np.zeros(3), 1.0
    low, high = np.min(points, axis=0), np.max(points, axis=0)
    length = 0.5 * float(np.linalg.norm(high - low))
    gyration = max((_gyration(body) for body in system.bodies if isinstance(body, RigidBody)), default=0.0)
    # joints and centres of mass at one place, but for what fits of axes differ by
    if length <= SINGLE * gyration:
        length = gyration
    return 0.5 * (low + high), length if length > 0.0 else 1.0


def _gyration(body: RigidBody) -> float:
    """Radius of gyration (m); 0 where it is not known."""
    if body.mass is None or not 0.0 < body.mass < math.inf or not np.all(np.isfinite(body.inertia)):
        return 0.0
    return math.sqrt(abs(float(np.trace(body.inertia))) / (2.0 * body.mass))


def _moved(geometry: JointGeometry, centre: Array) -> JointGeometry:
    """The geometry as seen from the centre."""
    point = None if geometry.point is None else geometry.point - centre
    return JointGeometry(geometry.axis, point, geometry.axis2, geometry.pitch)


def _finish(
    system: System,
    links: _Links,
    topology: Topology,
    link_of_node: dict[int, int],
    closures: list[tuple[int, int]],
    centre: Array,
    length: float,
) -> Mechanism:
    """Lists as arrays; rates of joints that nothing connects move nothing."""
    slots = links.slots
    nq, n = (slots[-1].q.stop, slots[-1].v.stop) if slots else (0, 0)
    idle = (np.zeros(6), 0, 0, 1.0)
    columns = [links.columns.get(k, idle) for k in range(n)]
    first_moved = np.array([column[2] for column in columns], dtype=np.int64)
    moves = np.zeros((len(links.parent), n))
    for link in range(1, len(links.parent)):
        moves[link] = moves[links.parent[link]]
        moves[link, first_moved == link] = 1.0
    scale = np.array([column[3] for column in columns])
    gear_q, gear_v = _gears(system, slots, scale, nq, n)
    return Mechanism(
        centre=centre,
        length=length,
        bodies=tuple(body.subject for body in system.bodies),
        link_of=np.array([link_of_node.get(node, 0) for node in topology.node_of], dtype=np.int64),
        slots=slots,
        parent=np.array(links.parent, dtype=np.int64),
        screw_link=np.array([link for link, _, _ in links.screws], dtype=np.int64),
        screw_q=np.array([q for _, q, _ in links.screws], dtype=np.int64),
        screw_terms=np.array([primitive.terms for _, _, primitive in links.screws]).reshape(-1, 3, 4, 4),
        screw_primitives=tuple(primitive for _, _, primitive in links.screws),
        balls=tuple(links.balls),
        column=np.array([column[0] for column in columns]).reshape(-1, 6),
        column_frame=np.array([column[1] for column in columns], dtype=np.int64),
        column_link=first_moved,
        moves=moves,
        scale=scale,
        closures=np.array(closures, dtype=np.int64).reshape(-1, 2),
        gear_v=gear_v,
        gear_q=gear_q,
    )


def _gears(system: System, slots: tuple[Slot, ...], scale: Array, nq: int, n: int) -> tuple[Array, Array]:
    """Rows value(a) − ratio · value(b) − …, over the scale of a."""
    slot_of = {slot.name: slot for slot in slots}
    on_q, on_v = np.zeros((len(system.gears), nq)), np.zeros((len(system.gears), n))
    for row, gear in enumerate(system.gears):
        slots_of = [(slot_of[system.joint_at(gear.name, port).subject], factor) for port, factor in gear.terms]
        unit = 1.0 / scale[slots_of[0][0].v.start]
        for slot, factor in slots_of:
            on_q[row, slot.q.start] += factor * unit
            on_v[row, slot.v.start] += factor * unit
    return on_q, on_v
