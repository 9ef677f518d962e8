"""A run as it was computed, and as results keep it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.model.simulation import Simulation
from kinform.simulation.closure import rank_of
from kinform.simulation.mechanism import Mechanism
from kinform.simulation.spatial import quaternions

__all__ = ["Record", "Sample", "blank", "publish"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Sample:
    """One output time: positions (nq,), rates (n,), efforts (n,), and kinetic energy, potential, work (J)."""

    time: float
    q: Array
    v: Array
    effort: Array
    energy: tuple[float, float, float]


@dataclass(frozen=True)
class Record:
    """Samples in order; `stopped` says why the run ended early, "" when it did not."""

    samples: tuple[Sample, ...]
    stopped: str
    notes: tuple[str, ...] = ()
    """What is to be known of the run, in sentences."""


def blank(status: str, reason: str, failures: tuple[tuple[str, str], ...] = ()) -> Simulation:
    """A simulation in which nothing ran."""
    none = np.zeros((0, 0))
    return Simulation(
        status=status,
        reason=reason,
        level="",
        time=np.zeros(0),
        body_names=(),
        p_WB=np.zeros((0, 0, 3)),
        q_WB=np.zeros((0, 0, 4)),
        joint_names=(),
        joint_types=(),
        joint_offset=np.zeros(1, dtype=np.int64),
        joint_position=none,
        joint_velocity=none,
        joint_effort=none,
        energy=np.zeros((0, 3)),
        residual=np.zeros(0),
        rank=np.zeros(0, dtype=np.int64),
        assumptions=(),
        failures=failures,
    )


def publish(mechanism: Mechanism, record: Record, level: str, assumptions: tuple[str, ...], free: float) -> Simulation:
    """The record as results keep it; `free` decides the rank of the loops.

    Balls: the position is a quaternion wxyz; velocity and effort have a zero before their three numbers.
    """
    samples = record.samples
    poses = np.array([mechanism.poses(sample.q)[mechanism.link_of] for sample in samples])
    poses = poses.reshape(-1, len(mechanism.bodies), 4, 4)
    R = poses[..., :3, :3]
    p = poses[..., :3, 3] + mechanism.centre - R @ mechanism.centre
    offsets = [slot.q.start for slot in mechanism.slots]
    offsets.append(mechanism.slots[-1].q.stop if mechanism.slots else 0)
    return Simulation(
        status="stopped" if record.stopped else "done",
        reason=record.stopped,
        level=level,
        time=np.array([sample.time for sample in samples]),
        body_names=mechanism.bodies,
        p_WB=p,
        q_WB=_continuous(quaternions(R.reshape(-1, 3, 3)).reshape(*R.shape[:2], 4)),
        joint_names=tuple(slot.name for slot in mechanism.slots),
        joint_types=tuple(slot.kind.name for slot in mechanism.slots),
        joint_offset=np.array(offsets, dtype=np.int64),
        joint_position=_positions(mechanism, np.array([sample.q for sample in samples])),
        joint_velocity=_spread(mechanism, np.array([sample.v for sample in samples])),
        joint_effort=_spread(mechanism, np.array([sample.effort for sample in samples])),
        energy=np.array([sample.energy for sample in samples]).reshape(-1, 3),
        residual=np.array([_residual(mechanism, sample.q) for sample in samples]),
        rank=np.array([_rank(mechanism, sample.q, free) for sample in samples], dtype=np.int64),
        assumptions=(*assumptions, *record.notes),
    )


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


def _spread(mechanism: Mechanism, v: Array) -> Array:
    """Rates or efforts (T, n) in the columns of positions; a ball's have a zero first."""
    width = mechanism.slots[-1].q.stop if mechanism.slots else 0
    out = np.zeros((len(v), width))
    for slot in mechanism.slots:
        first = slot.q.start + (1 if slot.has_ball else 0)
        out[:, first : slot.q.stop] = v[:, slot.v]
    return out


def _residual(mechanism: Mechanism, q: Array) -> float:
    """Largest gap of a loop (rad or m)."""
    gap = np.abs(mechanism.gap(mechanism.poses(q), q))
    loops = gap[: 6 * len(mechanism.closures)].reshape(-1, 6)
    loops[:, 3:] *= mechanism.length
    return float(gap.max(initial=0.0))


def _rank(mechanism: Mechanism, q: Array, free: float) -> int:
    return rank_of(mechanism.closure(mechanism.screws(mechanism.poses(q))), mechanism.scale, free)
