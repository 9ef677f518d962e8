"""Friction in the mechanism's coordinates: what the wrench in a joint brakes, as `behaviour.shafts.Friction` says it.

The grip of a wrench is a sum of lengths of linear maps of it: convex, doubled by a wrench twice as large, and the same
for the opposite wrench. `solver.friction_forces` rests on that.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from kinform.behaviour.components import JointComponent, System
from kinform.behaviour.rubbing import is_round
from kinform.behaviour.shafts import Friction
from kinform.foundation.algebra.vectors import cross_matrix
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.simulation import DriveKind
from kinform.simulation.mechanism.mechanism import Mechanism


@dataclass(frozen=True)
class Lost:
    """Where the effort y is to be found that the friction of a gear follows from."""

    gear: int = -1
    """Among the gears of the system: what it gives one of its shafts."""
    side: int = 0
    """That shaft: 0 at a, 1 at b."""
    motor: int = -1
    """Or among the actors: less what the motor, rotor included, passes on to its joint."""
    brush: int = -1
    """The friction of the motor's rotor among the frictions; −1: it has none."""


@dataclass(frozen=True, eq=False)
class Rubbing:
    """The friction on one rate."""

    friction: Friction
    joint: str
    number: int
    """Of the joint among those of the system."""
    link: int
    """That carries the joint's axis: its first body's."""
    axis: Array
    """(3,) unit, at the zero pose."""
    q: int
    v: int
    slide: int
    """The position along the axis; −1 where the joint does not slide."""
    actor: int = -1
    """Of the effort that stands for it, among the actors."""
    lost: Lost | None = None
    """Of what a gear loses (`mechanism.losses`), whose grip is |y|; None: a wrench in the joint presses."""
    lean: float = 0.0
    """Of these: how much more it is for y along the rate, and less against it, as a share of |y|."""
    called: DriveKind = "friction"
    """What it is in results: also gear_loss and rotor."""
    thread: bool = False
    """Whether it is that of a thread, on whose flanks only what the thread itself passes on presses: drives turn the
    nut beside it."""

    @property
    def loaded(self) -> bool:
        """Whether it follows from the wrenches in the joints."""
        one = self.friction
        if self.lost is not None:
            return self.lost.gear >= 0
        return bool(one.radial or one.axial or one.torsion)

    def grip(self, wrenches: Array, R: Array, q: Array) -> Array:
        """(k,) m·N or N of wrenches (k, 6) in world axes about the joint's point, at the rotation (3, 3) of the link
        and positions (nq,)."""
        return np.asarray(np.linalg.norm(self.maps(R, q) @ wrenches.T, axis=1).sum(axis=0))

    def maps(self, R: Array, q: Array) -> Array:
        """(b, 3, 6) linear maps of a wrench as `grip` has it: the grip is the sum of the lengths of what they give."""
        of_torque, of_force = self._maps
        if self.friction.riding and self.slide >= 0:
            of_force = of_force - of_torque @ cross_matrix(q[self.slide] * self.axis)
        return np.concatenate([of_torque @ R.T, of_force @ R.T], axis=2)

    @cached_property
    def _maps(self) -> tuple[Array, Array]:
        """(b, 3, 3) maps of the torque and of the force about the joint's point, in axes of the link."""
        one, axis = self.friction, self.axis
        none = np.zeros((3, 3))
        pairs: list[tuple[Array, Array]] = []
        if one.axial or one.torsion:
            along = np.outer((1.0, 0.0, 0.0), axis)
            pairs.append((one.torsion * along, one.axial * along))
        if one.radial:
            across = np.eye(3) - np.outer(axis, axis)
            span = one.upper - one.lower
            if span > 0.0:
                # both ends: near + far = f⊥ and axis × (lower · near + upper · far) = τ⊥
                tilt = -cross_matrix(axis) / span
                ends = [(-tilt, across + one.lower / span * across), (tilt, -one.lower / span * across)]
            else:
                ends = [(none, across)]
            for end in ends:
                for sides in self._sides():
                    pairs.append((one.radial * sides @ end[0], one.radial * sides @ end[1]))
        of_torque = np.array([pair[0] for pair in pairs]).reshape(-1, 3, 3)
        of_force = np.array([pair[1] for pair in pairs]).reshape(-1, 3, 3) - of_torque @ cross_matrix(one.offset)
        return of_torque, of_force

    def _sides(self) -> list[Array]:
        """(3, 3) maps of a force across the axis to what presses: on what is round, or on pairs of faces."""
        one = self.friction
        if is_round(one.faces_u, one.faces_v):
            return [np.eye(3)]
        return [np.outer((1.0, 0.0, 0.0), face) for face in (one.faces_u, one.faces_v)]

    def limit(self, grip: float, *, at_rest: bool) -> float:
        """N·m or N of the grip: what it takes at most at rest, or what there is in motion."""
        one = self.friction
        return grip * one.static + one.static_effort if at_rest else grip * one.kinetic + one.effort


def rubbing_of(mechanism: Mechanism, system: System, joint: JointComponent, friction: Friction) -> Rubbing:
    """The friction on the shaft of a joint."""
    (slot,) = (slot for slot in mechanism.slots if slot.name == joint.subject)
    link_of = dict(zip(mechanism.bodies, mechanism.link_of, strict=True))
    link = int(link_of[system.body_at(joint.name, "a").subject])
    axis = np.zeros(3) if joint.geometry.axis is None else np.asarray(joint.geometry.axis)
    slide = slot.q.start + {"prismatic": 0, "cylindrical": 1}.get(joint.kind.name, -1 - slot.q.start)
    q, v = slot.q.start + friction.freedom, slot.v.start + friction.freedom
    thread = joint.kind.name == "screw"
    return Rubbing(friction, joint.subject, system.joints.index(joint), link, axis, q, v, slide, thread=thread)
