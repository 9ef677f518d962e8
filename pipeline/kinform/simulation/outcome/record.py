"""A run as it was computed, and as results keep it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.algebra.spatial import quaternions, rotation_vector
from kinform.model.arrays import Array
from kinform.model.simulation import Simulation
from kinform.simulation.mechanism.mechanism import Mechanism
from kinform.simulation.mechanism.states import States, states_at

__all__ = ["Record", "closure_rows", "publish", "spread"]


@dataclass(frozen=True, eq=False)
class Record:
    """T output times in order; `stopped` says why the run ended early, "" when it did not."""

    time: Array
    """(T,) s."""
    q: Array
    """(T, nq)."""
    v: Array
    """(T, n)."""
    acceleration: Array
    """(T, n); nan where unknown."""
    effort: Array
    """(T, n) by all drives and springs on shafts, what a prescribed motion needs included; nan where unknown."""
    needed: Array
    """(T, n) of that what prescribed motions and end stops need."""
    extra: Array
    """(T, states) of controllers and motors."""
    work: Array
    """(T,) J that drives, dampers and loads put in so far; nan where unknown."""
    stopped: str
    notes: tuple[str, ...] = ()
    """What is to be known of the run, in sentences."""


def publish(
    mechanism: Mechanism, record: Record, level: str, assumptions: tuple[str, ...], free: float
) -> tuple[Simulation, States]:
    """The record as results keep it, without energy and reactions, and the states of the links.

    `free` decides the rank of the loops. Balls: the position is a quaternion wxyz; velocity and effort
    have a zero before their three numbers.
    """
    known = np.nan_to_num(record.acceleration)
    states = states_at(mechanism, record.q, record.v, known)
    poses = states.poses[:, mechanism.link_of]
    R = poses[..., :3, :3]
    p = poses[..., :3, 3] + mechanism.centre - R @ mechanism.centre
    offsets = [slot.q.start for slot in mechanism.slots]
    offsets.append(mechanism.slots[-1].q.stop if mechanism.slots else 0)
    simulation = Simulation(
        status="stopped" if record.stopped else "done",
        reason=record.stopped,
        level=level,
        time=record.time,
        body_names=mechanism.bodies,
        p_WB=p,
        q_WB=_continuous(quaternions(R.reshape(-1, 3, 3)).reshape(*R.shape[:2], 4)),
        joint_names=tuple(slot.name for slot in mechanism.slots),
        joint_types=tuple(slot.kind.name for slot in mechanism.slots),
        joint_offset=np.array(offsets, dtype=np.int64),
        joint_position=_positions(mechanism, record.q),
        joint_velocity=spread(mechanism, record.v),
        joint_effort=spread(mechanism, record.effort),
        energy=np.full((len(record.time), 3), np.nan),
        residual=_residuals(mechanism, record.q, states),
        rank=_ranks(mechanism, states, free),
        assumptions=(*assumptions, *record.notes),
    )
    accelerations = spread(mechanism, record.acceleration)
    return replace(simulation, joint_acceleration=accelerations, balance=np.full(len(record.time), np.nan)), states


def _continuous(q: Array) -> Array:
    """Quaternions (T, B, 4) with the sign that is nearer to the one before."""
    turned = np.einsum("tbi,tbi->tb", q[1:], q[:-1]) < 0.0
    signs = np.cumprod(np.where(turned, -1.0, 1.0), axis=0)
    out = q.copy()
    out[1:] *= signs[..., None]
    return out


def _positions(mechanism: Mechanism, q: Array) -> Array:
    """Positions (T, nq) with unit quaternions of continuous sign."""
    out = q.reshape(len(q), -1).copy()
    for slot in mechanism.slots:
        if slot.has_ball:
            unit = out[:, slot.q] / np.linalg.norm(out[:, slot.q], axis=1, keepdims=True)
            out[:, slot.q] = _continuous(unit[:, None, :])[:, 0]
    return out


def spread(mechanism: Mechanism, v: Array) -> Array:
    """Rates or efforts (T, n) in the columns of positions; a ball's have a zero first."""
    width = mechanism.slots[-1].q.stop if mechanism.slots else 0
    out = np.zeros((len(v), width))
    for slot in mechanism.slots:
        first = slot.q.start + (1 if slot.has_ball else 0)
        out[:, first : slot.q.stop] = v[:, slot.v]
    return out


def _residuals(mechanism: Mechanism, q: Array, states: States) -> Array:
    """(T,) largest gap of a loop (rad or m)."""
    out = np.abs(q @ mechanism.gear_q.T).max(axis=1, initial=0.0)
    for a, b in mechanism.closures:
        ends, targets = states.poses[:, a], states.poses[:, b]
        R = targets[:, :3, :3] @ ends[:, :3, :3].transpose(0, 2, 1)
        p = targets[:, :3, 3] - (R @ ends[:, :3, 3, None])[..., 0]
        gap = np.concatenate([rotation_vector(R), p], axis=1)
        out = np.maximum(out, np.abs(gap).max(axis=1))
    return np.asarray(out)


def closure_rows(mechanism: Mechanism, states: States) -> Array:
    """(T, 6C + G, n) derivative of the gaps by the rates."""
    count, n = states.screws.shape[:2]
    scale = np.array([1.0, 1.0, 1.0, mechanism.length, mechanism.length, mechanism.length])
    difference = mechanism.moves[mechanism.closures[:, 1]] - mechanism.moves[mechanism.closures[:, 0]]
    rows = np.einsum("cn,tnk->tckn", difference, states.screws / scale).reshape(count, -1, n)
    gears = np.broadcast_to(mechanism.gear_v, (count, *mechanism.gear_v.shape))
    return np.concatenate([rows, gears], axis=1)


def _ranks(mechanism: Mechanism, states: States, free: float) -> NDArray[np.int64]:
    """(T,) rank of the loops: singular values above `free` times the largest."""
    out = np.zeros(len(states.poses), dtype=np.int64)
    if not mechanism.closed or not mechanism.rates:
        return out
    for first in range(0, len(out), 256):
        some = States(*(getattr(states, name)[first : first + 256] for name in States.__dataclass_fields__))
        values = np.linalg.svd(closure_rows(mechanism, some) * mechanism.scale, compute_uv=False)
        out[first : first + 256] = np.count_nonzero(values > free * values[:, :1], axis=1)
    return out
