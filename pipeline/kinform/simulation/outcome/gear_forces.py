"""What gears pass on between their shafts, and the force between teeth that does it.

Teeth push along one of two lines of action through the pitch point, whichever makes the effort that is passed on; of
involutes these lines stand still in the body that bears both wheels (Litvin & Fuentes, Gear Geometry and Applied
Theory, 2004, chapter 10). The force is taken in the middle of the width, without friction.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.behaviour.components import Gear, System
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.mechanism.losses import multipliers
from kinform.simulation.mechanism.states import States


@dataclass(frozen=True, eq=False)
class Transmitted:
    """T times, G gears in the order of the system."""

    efforts: Array
    """(T, G, 2) N·m or N that the gear gives the shafts at a and b."""
    forces: Array
    """(T, G) N between the teeth; nan where they are not known."""
    wrenches: Array
    """(T, B, 6) of all teeth on the bodies in the order of the system, about the mechanism's centre."""
    sides: Ints
    """(T, G) which side of the teeth pushes where the shaft at a gets a positive effort: 0 the flank, 1 the back of the
    teeth, which pushes where it gets a negative one; −1 where it is not known."""


def toothed(system: System) -> Flags:
    """(G,) which gears know where their teeth push."""
    return np.array([_sides(system, gear) is not None for gear in system.gears], dtype=np.bool_)


def on_shafts(dynamics: Dynamics, gears: Transmitted) -> Array:
    """(T, n) what the rates get from gears of which nobody knows where their teeth push: they act in the joints,
    between the two bodies of each, as drives do."""
    mechanism, system = dynamics.mechanism, dynamics.system
    first = {slot.name: slot.v.start for slot in mechanism.slots}
    out = np.zeros((len(gears.efforts), mechanism.rates))
    for k in np.flatnonzero(~toothed(system)):
        at = first[system.joint_at(system.gears[k].name, "a").subject]
        out += gears.efforts[:, k, 0, None] / mechanism.gear_v[k, at] * mechanism.gear_v[k]
    return out


def _sides(system: System, gear: Gear) -> tuple[str, str, str] | None:
    """Names of the body that bears both joints, of the other at a and of the other at b."""
    if gear.pitch_point is None or gear.flank is None or gear.back is None:
        return None
    pairs = []
    for port in ("a", "b"):
        joint = system.joint_at(gear.name, port)
        pairs.append([system.body_at(joint.name, end).name for end in ("a", "b")])
    shared = [name for name in pairs[0] if name in pairs[1]]
    if len(shared) != 1:
        return None
    first, second = (next(name for name in pair if name != shared[0]) for pair in pairs)
    return shared[0], first, second


def transmitted(
    dynamics: Dynamics, states: States, sign: Array, rest: Array, flanks: Sequence[int] | None = None
) -> Transmitted:
    """From what the shafts (T, n) get beside the efforts of drives: that is what gears give them.

    `sign` (n,): −1 where the mechanism counts a rate's twist of the joint's first body relative to its second.
    `flanks` (G,): let these sides of the teeth push, and pull; else those that push.
    """
    mechanism, system = dynamics.mechanism, dynamics.system
    slots = {slot.name: slot for slot in mechanism.slots}
    index = {body.name: k for k, body in enumerate(system.bodies)}
    times, count = len(rest), len(system.gears)
    efforts, forces = np.zeros((times, count, 2)), np.full((times, count), np.nan)
    wrenches = np.zeros((times, len(index), 6))
    pushing = np.full((times, count), -1, dtype=np.int64)
    factors = multipliers(mechanism, rest)
    for k, gear in enumerate(system.gears):
        joints = [system.joint_at(gear.name, port) for port in ("a", "b")]
        columns = [slots[joint.subject].v.start for joint in joints]
        efforts[:, k] = factors[:, k, None] * mechanism.gear_v[k, columns]
        sides = _sides(system, gear)
        if sides is None:
            continue
        carrier, first, second = sides
        X = states.poses[:, mechanism.link_of[index[carrier]]]
        assert gear.pitch_point is not None
        point = X[:, :3, :3] @ (gear.pitch_point - mechanism.centre) + X[:, :3, 3]
        # how fast the first side moves at the pitch point when the value at a grows by one a second
        sense = 1.0 if system.body_at(joints[0].name, "b").name == first else -1.0
        twist = sense * sign[columns[0]] * states.screws[:, columns[0]]
        speed = twist[:, 3:] + np.cross(twist[:, :3], point)
        total = np.zeros((times, 6))
        between_teeth = np.zeros(times)
        for side, normal in enumerate((gear.flank, gear.back)):
            along = X[:, :3, :3] @ np.asarray(normal)
            lever = np.einsum("tk,tk->t", along, speed)
            force = np.where(np.abs(lever) > 0.0, -efforts[:, k, 0] / np.where(lever != 0.0, lever, 1.0), 0.0)
            pushing[lever < 0.0, k] = side
            if flanks is None:
                force = np.maximum(force, 0.0)
            elif flanks[k] != side:
                continue
            total += force[:, None] * np.concatenate([np.cross(point, along), along], axis=1)
            between_teeth += force
        forces[:, k] = between_teeth
        wrenches[:, index[second]] += total
        wrenches[:, index[first]] -= total
    return Transmitted(efforts, forces, wrenches, pushing)
