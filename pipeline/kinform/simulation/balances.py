"""Checks the reactions: Newton and Euler of every body about its own centre of mass, and every shaft.

Written apart from what found the reactions, in the bodies' own terms: mass times acceleration, rate of
change of the spin in the body's axes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinform.simulation.dynamics import Dynamics
from kinform.simulation.reactions import Network, Reactions, applied
from kinform.simulation.states import States

__all__ = ["imbalance"]

Array = NDArray[np.float64]


def imbalance(dynamics: Dynamics, states: States, found: Reactions, effort: Array) -> Array:
    """(T,) greatest error of a force, or of a torque over the length, over the greatest wrench then."""
    mechanism, system, length = dynamics.mechanism, dynamics.system, dynamics.mechanism.length
    bodies = [mechanism.bodies[k] for k in dynamics.body_index]
    wrench, points = found.on_second, found.points
    sizes = np.concatenate([np.abs(wrench[..., :3]).max(axis=2) / length, np.abs(wrench[..., 3:]).max(axis=2)], axis=1)
    external = applied(dynamics, states)
    weights = np.abs(dynamics.mass * np.linalg.norm(dynamics.gravity)).max(initial=0.0)
    scale = np.maximum(sizes.max(axis=1, initial=0.0), weights)
    scale = np.maximum(scale, np.abs(external[..., 3:]).max(axis=(1, 2), initial=0.0))
    error = np.zeros(len(effort))
    for k, (body, link) in enumerate(zip(bodies, dynamics.body_links, strict=True)):
        X, V, A = states.poses[:, link], states.twists[:, link], states.accelerations[:, link]
        R, spin, turn = X[:, :3, :3], V[:, :3], A[:, :3]
        com = R @ dynamics.com[k] + X[:, :3, 3]
        speed = V[:, 3:] + np.cross(spin, com)
        rise = A[:, 3:] + np.cross(turn, com) + np.cross(spin, speed)
        force = external[:, k, 3:] + dynamics.mass[k] * (dynamics.gravity - rise)
        torque = external[:, k, :3] - np.cross(com, external[:, k, 3:])
        own, faster = ((R.transpose(0, 2, 1) @ w[..., None])[..., 0] for w in (spin, turn))
        inertia = dynamics.inertia[k]
        euler = faster @ inertia.T + np.cross(own, own @ inertia.T)
        torque = torque - (R @ euler[..., None])[..., 0]
        for j, joint in enumerate(system.joints):
            for port, sign in (("a", -1.0), ("b", 1.0)):
                if system.body_at(joint.name, port).subject == body:
                    force = force + sign * wrench[:, j, 3:]
                    torque = torque + sign * (wrench[:, j, :3] + np.cross(points[:, j] - com, wrench[:, j, 3:]))
        error = np.maximum(error, np.maximum(np.abs(force).max(axis=1), np.abs(torque).max(axis=1) / length))
    if not len(mechanism.gear_v):
        network = Network(dynamics)
        about = wrench[:, network.owner].copy()
        about[..., :3] += np.cross(points[:, network.owner], about[..., 3:])
        along = np.einsum("tnk,tnk->tn", states.screws * network.sign[:, None], about)
        shafts = (along - effort) / np.where(mechanism.scale == length, 1.0, length)
        # A slide's effort is a force, a turn's a torque: its own screw has the unit.
        slides = ~states.screws[..., :3].any(axis=(0, 2)) if len(effort) else np.zeros(0, dtype=bool)
        shafts = np.where(slides, along - effort, shafts)
        error = np.maximum(error, np.abs(shafts).max(axis=1, initial=0.0))
    return np.asarray(error / np.where(scale > 0.0, scale, 1.0))
