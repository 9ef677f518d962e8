"""What one freedom of a joint moves, loops and gears included, and what gravity asks of it: what a servo must carry.

The others hold still as far as loops and gears let them: their rates are the least that close them. Twice the kinetic
energy at unit rate is the inertia that the motion reflects to the joint, and the power of gravity its effort there
(Featherstone, Rigid Body Dynamics Algorithms, 2008, section 8.4).
"""

from __future__ import annotations

import numpy as np

from kinform.behaviour import RigidBody
from kinform.exports.model import ExportModel
from kinform.foundation.rounding import SINGLE
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.simulation.mechanism.states import states_at


@dataclass(frozen=True)
class Carried:
    """By one freedom, at the start."""

    inertia: float
    """kg·m² of turns, kg of slides: greater than 0."""
    gravity: float
    """N·m or N that the joint must give to hold against gravity."""


def carried(model: ExportModel, joint: str, freedom: int) -> Carried | None:
    """Of a freedom of the joint of that name; None where loops lock it, or nothing that it moves has a known mass."""
    mechanism = model.mechanism
    slot = next(slot for slot in mechanism.slots if slot.name == joint)
    column = slot.v.start + freedom
    rates = _least_rates(mechanism.closure_at(model.q), mechanism.scale, column)
    if rates is None:
        return None
    zero = np.zeros((1, mechanism.rates))
    moved = states_at(mechanism, model.q[None], rates[None], zero)
    link_of = dict(zip(mechanism.bodies, mechanism.link_of, strict=True))
    inertia = effort = 0.0
    for body in model.system.bodies:
        if not isinstance(body, RigidBody) or body.mass is None:
            continue
        R, p = moved.poses[0, link_of[body.subject], :3, :3], moved.poses[0, link_of[body.subject], :3, 3]
        omega, velocity = np.split(moved.twists[0, link_of[body.subject]], 2)
        speed = velocity + np.cross(omega, R @ (body.centre_of_mass - mechanism.centre) + p)
        spin = R.T @ omega
        inertia += float(spin @ body.inertia @ spin + body.mass * speed @ speed)
        effort -= float(body.mass * model.gravity @ speed)
    return Carried(inertia, effort) if inertia > 0.0 else None


def _least_rates(rows: Array, scale: Array, column: int) -> Array | None:
    """(n,) rates that keep loops and gears closed, 1 at the column, the others least by their scale; None where they
    cannot be closed."""
    others = np.arange(len(scale)) != column
    rates = np.zeros(len(scale))
    rates[column] = 1.0
    if len(rows):
        needed = -rows[:, column]
        found, *_ = np.linalg.lstsq(rows[:, others] * scale[others], needed, rcond=SINGLE)
        rates[others] = found * scale[others]
        if np.linalg.norm(rows @ rates) > SINGLE * np.linalg.norm(needed):
            return None
    return rates
