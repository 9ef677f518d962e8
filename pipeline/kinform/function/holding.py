"""The static effort that holds a joint in a pose: gravity, loads and springs by virtual work.

The joint is moved a little, the other drives stand still, loops stay closed: the work of gravity, of loads and of
springs along this motion is what the joint must bear (d'Alembert's principle; the Jacobian transpose). Joints that
close no loop are taken to be held, each by itself. No friction.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from kinform.foundation.algebra.subspaces import null_space
from kinform.foundation.algebra.vectors import cross
from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.function.configurations import Chain
from kinform.mechanism.closing import close
from kinform.mechanism.constants import FREE
from kinform.model.arrays import Array

POSE_STEPS = 20
"""Steps in which joints are brought to a pose, so that loops are followed and not jumped: 9° each of half a
turn. Chosen, not measured."""


Force = Callable[[str, Array], tuple[Array, Array] | None]
"""Force (3,) N and torque (3,) N·m about the world's origin on a body that is displaced by (4, 4); None: unknown."""


def configuration_at(chain: Chain, values: Mapping[str, float]) -> Array | str:
    """Coordinates (n,) with these joint values (rad or m, kinform's sign), the others where loops put them."""
    q = np.zeros(len(chain.coordinates))
    held = np.zeros(len(q), dtype=np.bool_)
    for name, value in values.items():
        columns = [k for k, c in enumerate(chain.coordinates) if c.joint == name]
        if len(columns) != 1:
            return f"joint '{name}' is not in the mechanism, or has several freedoms"
        q[columns[0]], held[columns[0]] = chain.coordinates[columns[0]].unit * value, True
    if not chain.looped:
        return q
    target, pose = q, np.zeros(len(q))
    for share in np.linspace(1.0 / POSE_STEPS, 1.0, POSE_STEPS):
        pose[held] = share * target[held]
        closed = close(chain.system, pose[None], held).one()
        if closed is None:
            return "the loops cannot be closed in this pose"
        pose = closed
    return pose


def held_motion(chain: Chain, q: Array, joint: str, drives: Sequence[str]) -> tuple[Array, Array, int] | str:
    """Rates (n,) of all coordinates as that of a joint is 1 in the pose q (n,), the rows (m, n) of what holds the rest,
    and the joint's column; or why it does not move. `drives`: joints with drives."""
    columns = [k for k, c in enumerate(chain.coordinates) if c.joint == joint]
    if len(columns) != 1:
        return f"joint '{joint}' is not in the mechanism"
    own = columns[0]
    rows = [chain.system.equations(q[None]).jacobian[0]]
    single = [k for k, c in enumerate(chain.coordinates) if sum(c.joint == o.joint for o in chain.coordinates) == 1]
    alone = {chain.coordinates[k].joint for k in single} & _open_ended(chain)
    held = [k for k in single if k != own and chain.coordinates[k].joint in (set(drives) | alone)]
    unit = np.eye(len(q))
    rows += [unit[held], unit[[own]]]
    matrix = np.concatenate(rows)
    aim = np.zeros(len(matrix))
    aim[-1] = 1.0
    motion = np.linalg.lstsq(matrix, aim, rcond=SOLVED)[0]
    if float(np.abs(matrix @ motion - aim).max()) > SINGLE:
        return f"joint '{joint}' cannot move while the other drives stand still: it shares the load with them"
    return motion, matrix, own


def body_motions(chain: Chain, q: Array, rates: Array) -> Array:
    """(N, 6) twists (ω; v at the world's origin) of the bodies of a chain."""
    columns = chain.system.equations(q[None]).columns[0]
    out = (chain.system.reach * rates) @ columns
    out[:, 3:] = out[:, 3:] * chain.frame.length - cross(out[:, :3], np.broadcast_to(chain.frame.centre, (len(out), 3)))
    return np.asarray(out)


def holding_effort(
    chain: Chain, q: Array, joint: str, drives: Sequence[str], springs: Mapping[str, float], force: Force
) -> float | str:
    """Effort (N·m or N) of the joint that holds the pose q (n,); a sentence where it is not determined.

    `drives`: joints with drives; `springs`: effort that springs give on joints in this pose.
    """
    held = held_motion(chain, q, joint, drives)
    if isinstance(held, str):
        return held
    motion, matrix, own = held
    state = chain.system.equations(q[None])
    power = _powers(chain, q, state.columns[0], springs, force)
    work = _work(power, motion)
    if isinstance(work, str):
        return work
    for loose in null_space(matrix, FREE):
        left = _work(power, loose)
        if isinstance(left, str):
            return left
        if abs(left) > SINGLE * max(abs(work), SOLVED):
            return "gravity moves more than the drives hold: which joint holds the rest is not stated"
    return -work * chain.coordinates[own].unit


def _open_ended(chain: Chain) -> set[str]:
    """Joints that close no loop."""
    members: dict[int, str] = {int(j): c.joint for j, c in zip(chain.system.joint, chain.coordinates, strict=True)}
    looped = (np.abs(chain.system.loops).max(axis=0, initial=0.0) > 0.0) | chain.system.ties.any(axis=0)
    return {members[int(j)] for j, closes in zip(chain.system.joint, looped, strict=True) if not closes}


def _powers(
    chain: Chain, q: Array, columns: Array, springs: Mapping[str, float], force: Force
) -> Callable[[Array], tuple[float, list[str]]]:
    """Rates (n,) → power of all forces, and bodies that move with unknown ones."""
    poses = chain.linkage.world(chain.system.bodies(q[None])[0])
    wrenches = [force(name, poses[k]) for k, name in enumerate(chain.bodies)]
    length, centre = chain.frame.length, chain.frame.centre

    def power(rates: Array) -> tuple[float, list[str]]:
        total, unknown = 0.0, []
        for k, wrench in enumerate(wrenches):
            twist = (chain.system.reach[k] * rates) @ columns
            omega, v = twist[:3], twist[3:] * length
            if max(np.abs(twist[:3]).max(), np.abs(twist[3:]).max()) < SOLVED:
                continue
            if wrench is None:
                unknown.append(chain.bodies[k])
                continue
            at_origin = v - cross(omega, centre)
            total += float(wrench[0] @ at_origin + wrench[1] @ omega)
        for rate, coordinate in zip(rates, chain.coordinates, strict=True):
            total += springs.get(coordinate.joint, 0.0) * rate / coordinate.unit
        return total, unknown

    return power


def _work(power: Callable[[Array], tuple[float, list[str]]], rates: Array) -> float | str:
    total, unknown = power(rates)
    return f"the mass of '{unknown[0]}' is not known" if unknown else total
