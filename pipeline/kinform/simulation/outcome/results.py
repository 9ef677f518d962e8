"""What results keep of a run: poses and joint values, and of a dynamic run energy, reactions, drives and doubts."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from kinform.behaviour.components import System
from kinform.foundation.algebra.spatial import quaternions, rotation_vector
from kinform.foundation.rounding import ARITHMETIC, SINGLE, SOLVED
from kinform.mechanism.rank import counted
from kinform.model.arrays import Array, Ints
from kinform.model.simulation import Simulation, SimulationLevel
from kinform.simulation.constants import CHUNK
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.mechanism.loop_systems import loop_values
from kinform.simulation.mechanism.mechanism import Mechanism
from kinform.simulation.mechanism.states import States, states_at
from kinform.simulation.outcome.balances import imbalance
from kinform.simulation.outcome.drives import drive_fields
from kinform.simulation.outcome.reactions import Reactions, reactions
from kinform.simulation.record import Record
from kinform.simulation.settings import SolverSettings


def while_in_mesh(mechanism: Mechanism, system: System, record: Record) -> Record:
    """The record up to where the last teeth of a gear let go: from there on nothing couples its shafts."""
    slots = {slot.name: slot for slot in mechanism.slots}
    for gear in system.gears:
        joint = system.joint_at(gear.name, "a").subject
        value = record.q[:, slots[joint].q.start]
        beyond = np.flatnonzero((value < gear.lower) | (value > gear.upper))
        if len(beyond):
            end = int(beyond[0])
            limit = gear.lower if value[end] < gear.lower else gear.upper
            why = (
                f"before t = {record.time[end]:.4g} s the last teeth of {gear.subject} let go of each other: "
                f"{joint} passes {limit:.5g} (rad or m)"
            )
            record = record.until(end, why)
    return record


def publish_dynamic(
    dynamics: Dynamics, record: Record, level: SimulationLevel, notes: tuple[str, ...], settings: SolverSettings
) -> tuple[Simulation, States]:
    """The results with energy, reactions, their balance, and what the drives did; and the states of the links."""
    run, states = publish(dynamics.mechanism, record, level, notes, settings.free)
    kinetic, potential = dynamics.energy(record.q, record.v, states)
    effort = dynamics.on_bodies(record.effort, record.acceleration)
    wrenches = reactions(dynamics, states, record.time, effort, settings.free)
    balance = imbalance(dynamics, states, record.time, wrenches, effort)
    energy = np.column_stack([kinetic, potential, record.work])
    whole = replace(
        run,
        assumptions=(
            *run.assumptions,
            *_notes_of_gaps(run.residual),
            *_notes_of_energy(run.time, energy),
            *_notes_of_sliding(dynamics, record),
        ),
        energy=energy,
        F_A=-wrenches.on_second,
        F_B=wrenches.on_second,
        undetermined=wrenches.undetermined,
        **_gear_fields(dynamics, wrenches),
        **_friction_fields(dynamics, record),
        balance=balance.greatest,
        balance_bodies=balance.bodies,
        balance_shafts=_in_columns(dynamics.mechanism, balance.shafts),
        **drive_fields(dynamics, record),
    )
    return whole, states


def _gear_fields(dynamics: Dynamics, wrenches: Reactions) -> dict[str, Any]:
    """What gears do, as fields of the results."""
    if wrenches.gears is None:
        return {}
    names = tuple(gear.subject for gear in dynamics.system.gears)
    return {"gear_names": names, "gear_effort": wrenches.gears.efforts, "gear_force": wrenches.gears.forces}


def _friction_fields(dynamics: Dynamics, record: Record) -> dict[str, Any]:
    """What frictions do, as fields of the results."""
    if record.friction is None:
        return {}
    return {
        "friction_joints": tuple(one.joint for one in dynamics.actuation.frictions),
        "friction_effort": record.friction.effort,
        "friction_limit": record.friction.limit,
        "friction_sticks": record.friction.sticking,
    }


def _notes_of_gaps(residual: Array) -> tuple[str, ...]:
    """What is to be said of redundant loops that the geometry does not let close exactly."""
    widest = float(residual.max(initial=0.0))
    if not widest > SOLVED:
        return ()
    return (
        f"redundant loops open by up to {widest:.2g} (m or rad) as they move: the geometry fits no better, "
        "and the play that it needs is taken to be there",
    )


def _notes_of_energy(times: Array, energy: Array) -> tuple[str, ...]:
    """What is to be said of an energy balance that is worse than every sound run's."""
    total = energy @ np.array([1.0, 1.0, -1.0])
    exchanged = float(np.ptp(energy, axis=0).max(initial=0.0)) if len(energy) else 0.0
    # Where bodies exchange energy only among each other, all that can be seen is that the sum of it stays.
    # Drift of the energy over the kinetic energy up to which it is rounding of sums: ten times that of sound runs.
    least = ARITHMETIC + 1e-8 * float(np.abs(energy[:, 0]).max(initial=0.0))
    # Drift of the energy over the energy exchanged up to which a run is trusted: runs at the default tolerances stay a
    # hundred times below.
    wrong = np.flatnonzero(np.abs(total - total[:1]) > 1e-5 * exchanged + least)
    if not len(wrong) or exchanged == 0.0:
        return ()
    share = float(np.abs(total - total[0]).max()) / exchanged
    return (
        f"from t = {times[wrong[0]]:.4g} s on the energy balance is off, at the end by {share:.2g} of the energy "
        "exchanged: the trajectory is not to be trusted from there on",
    )


def _notes_of_sliding(dynamics: Dynamics, record: Record) -> tuple[str, ...]:
    """What is to be said of surfaces with friction along one direction that slid along others too."""
    slots, scale = {slot.name: slot for slot in dynamics.mechanism.slots}, dynamics.mechanism.scale
    out = {}
    for one in dynamics.actuation.frictions:
        slot = slots[one.joint]
        if one.lost is not None or slot.kind.name not in ("planar", "cylindrical"):
            continue
        paces = np.abs(record.v[:, slot.v] / scale[slot.v]).max(axis=0, initial=0.0)
        others = np.delete(paces, one.v - slot.v.start)
        if others.max() > SINGLE * paces.max() > 0.0:
            out[one.joint] = (
                f"friction in {one.joint} opposes one of its freedoms alone, and it moved along others too: a surface "
                "opposes the way in which it slides, so it is too great along the one, and missing along the others"
            )
    return tuple(out.values())


def publish(
    mechanism: Mechanism, record: Record, level: SimulationLevel, assumptions: tuple[str, ...], free: float
) -> tuple[Simulation, States]:
    """The record as results keep it, without energy and reactions, and the states of the links.

    `free` decides the rank of the loops. Balls: the position is a quaternion wxyz; velocity and effort
    have a zero before their three numbers.
    """
    states = states_at(mechanism, record.q, record.v, np.nan_to_num(record.acceleration))
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
        joint_velocity=_in_columns(mechanism, record.v),
        joint_effort=_in_columns(mechanism, record.effort),
        energy=np.full((len(record.time), 3), np.nan),
        residual=_residuals(mechanism, record.q, states),
        rank=_ranks(mechanism, states, free),
        assumptions=(*assumptions, *record.notes),
        dampings=record.dampings,
        joint_acceleration=_in_columns(mechanism, record.acceleration),
        balance=np.full(len(record.time), np.nan),
    )
    return simulation, states


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


def _in_columns(mechanism: Mechanism, v: Array) -> Array:
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


def _ranks(mechanism: Mechanism, states: States, free: float) -> Ints:
    """(T,) rank of the loops: their `counted` singular values."""
    out = np.zeros(len(states.poses), dtype=np.int64)
    if not mechanism.closed or not mechanism.rates:
        return out
    for first in range(0, len(out), CHUNK):
        times = slice(first, first + CHUNK)
        out[times] = counted(loop_values(mechanism, states.screws[times]), free)
    return out
