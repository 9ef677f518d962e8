"""Checks the reactions: at the frame of every body what joints, loads and springs give is Newton's and Euler's rate of
its momentum, and on every shaft what the joint transmits along it is what acts there.

Written apart from what found the reactions, in the bodies' own terms: mass times acceleration about the centre of mass,
rate of change of the spin in the body's axes. What gears without
teeth pass on among shafts is whatever their ratios allow.
"""

from __future__ import annotations

import numpy as np

from kinform.behaviour.components import System
from kinform.foundation.algebra.vectors import cross
from kinform.foundation.rounding import ARITHMETIC, SINGLE
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.mechanism.states import States
from kinform.simulation.outcome.gear_forces import toothed
from kinform.simulation.outcome.reactions import Network, Reactions, along_rates, applied


@dataclass(frozen=True, eq=False)
class Balance:
    """Errors of forces, and of torques over the length, as shares of the greatest wrench then."""

    bodies: Array
    """(T, B) of the node at the frame of each body; zero for those that rest."""
    shafts: Array
    """(T, n) of the node on the shaft of each rate."""

    @property
    def greatest(self) -> Array:
        """(T,) of all."""
        both = np.concatenate([self.bodies, np.abs(self.shafts)], axis=1)
        return np.asarray(both.max(axis=1, initial=0.0))


def imbalance(dynamics: Dynamics, states: States, times: Array, reactions: Reactions, effort: Array) -> Balance:
    """How far the nodes are from balance at the efforts (T, n) on their shafts."""
    mechanism, length = dynamics.mechanism, dynamics.mechanism.length
    bodies = [mechanism.bodies[k] for k in dynamics.body_index]
    wrench, points = reactions.on_second, reactions.points
    with np.errstate(over="ignore"):  # of a run that overflows
        couples = np.abs(wrench[..., :3]).max(axis=2) / length
    sizes = np.concatenate([couples, np.abs(wrench[..., 3:]).max(axis=2)], axis=1)
    external = applied(dynamics, states, times)
    if reactions.gears is not None:
        external = external + reactions.gears.wrenches[:, dynamics.body_index]
    weights = np.abs(dynamics.mass * np.linalg.norm(dynamics.gravity)).max(initial=0.0)
    scale = np.maximum(sizes.max(axis=1, initial=0.0), weights)
    scale = np.maximum(scale, np.abs(external[..., 3:]).max(axis=(1, 2), initial=0.0))
    # Where all wrenches pass zero at once, only rounding is left to be compared with rounding.
    scale = np.maximum(scale, SINGLE * scale.max(initial=0.0))
    errors = np.zeros((len(effort), len(mechanism.bodies)))
    held = _held(dynamics.system)
    for k, (body, link) in enumerate(zip(bodies, dynamics.body_links, strict=True)):
        X, V, A = states.poses[:, link], states.twists[:, link], states.accelerations[:, link]
        R, spin, turn = X[:, :3, :3], V[:, :3], A[:, :3]
        com = R @ dynamics.com[k] + X[:, :3, 3]
        speed = V[:, 3:] + cross(spin, com)
        rise = A[:, 3:] + cross(turn, com) + cross(spin, speed)
        force = external[:, k, 3:] + dynamics.mass[k] * (dynamics.gravity - rise)
        torque = external[:, k, :3] - cross(com, external[:, k, 3:])
        omega, alpha = ((R.transpose(0, 2, 1) @ w[..., None])[..., 0] for w in (spin, turn))
        inertia = dynamics.inertia[k]
        euler = alpha @ inertia.T + cross(omega, omega @ inertia.T)
        torque = torque - (R @ euler[..., None])[..., 0]
        for j, sign in held.get(body, ()):
            force = force + sign * wrench[:, j, 3:]
            torque = torque + sign * (wrench[:, j, :3] + cross(points[:, j] - com, wrench[:, j, 3:]))
        errors[:, dynamics.body_index[k]] = np.maximum(np.abs(force).max(axis=1), np.abs(torque).max(axis=1) / length)
    least = np.where(scale > 0.0, scale, 1.0)[:, None]
    return Balance(errors / least, _shafts(dynamics, states, reactions, effort) / least)


def _held(system: System) -> dict[str, list[tuple[int, float]]]:
    """Joints at each body, in order: which, and the sign of its wrench on the second body there."""
    out: dict[str, list[tuple[int, float]]] = {}
    for j, joint in enumerate(system.joints):
        for port, sign in (("a", -1.0), ("b", 1.0)):
            out.setdefault(system.body_at(joint.name, port).subject, []).append((j, sign))
    return out


def _shafts(dynamics: Dynamics, states: States, reactions: Reactions, effort: Array) -> Array:
    """(T, n) N, torques over the length: what the joints transmit along their rates less what acts on their shafts."""
    mechanism, length = dynamics.mechanism, dynamics.mechanism.length
    network = Network(dynamics)
    rest = along_rates(network, states, reactions) - effort
    shafts = mechanism.gear_v[~toothed(dynamics.system)]
    if len(shafts):
        _, values, rows = np.linalg.svd(shafts)
        passed = rows[: int(np.count_nonzero(values > ARITHMETIC * values[0]))]
        rest = rest - (rest @ passed.T) @ passed
    # A slide's effort is a force, a turn's a torque: its own screw has the unit.
    slides = ~states.screws[..., :3].any(axis=(0, 2)) if len(effort) else np.zeros(mechanism.rates, dtype=bool)
    return np.asarray(np.where(slides, rest, rest / length))
