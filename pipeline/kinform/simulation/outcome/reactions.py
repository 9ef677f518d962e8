"""Wrenches in the joints, from motion already whole: Newton and Euler for every body, backwards.

A tree of joints carries what its bodies need; joints left over close loops, and their wrenches λ are
unknown (`loop_wrenches`). Where redundancy leaves λ a choice, taken is the one with the least Σ(|f|² + |τ|²/L²)
over all joints, about their points, which does not depend on which joints were left over (Haug, Computer Aided
Kinematics and Dynamics, 1989, section 6.6, for the reactions; the choice is that of the pseudoinverse).
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import field, replace

import numpy as np

from kinform.foundation.algebra.spatial import cross_force
from kinform.frozen import dataclass
from kinform.mechanism.rank import rank_of
from kinform.model.arrays import Array, Flags
from kinform.simulation.constants import CHUNK
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.mechanism.states import States
from kinform.simulation.mechanism.topology import arrange
from kinform.simulation.outcome.gear_forces import Transmitted, toothed, transmitted
from kinform.simulation.outcome.loop_wrenches import Shares, about, add_loops


@dataclass(frozen=True, eq=False)
class Reactions:
    """T times, J joints in the order of the system; world axes, about `points`."""

    on_second: Array
    """(T, J, 6) wrench (τ; f) on the second body of each joint; on the first it is the opposite."""
    points: Array
    """(T, J, 3) m, about the mechanism's centre: each joint's point as its first body carries it."""
    undetermined: Flags
    """(J, 6)."""
    gears: Transmitted | None = None
    """What gears pass on; None without any."""
    stresses: Array = field(default_factory=lambda: np.zeros((0, 0, 6)))
    """(z, J, 6) wrenches that balance each other at the first time: what redundancy leaves open, torques of at most
    about the mechanism's length, forces of at most about 1."""


def reactions(
    dynamics: Dynamics, states: States, times: Array, effort: Array, free: float, network: Network | None = None,
    flanks: Sequence[int] | None = None,
) -> Reactions:  # fmt: skip
    """Wrenches of all joints for the efforts (T, n) on their shafts; `free` decides the rank of the loops. `network`:
    that of the dynamics, where it is known already. `flanks`: as `gear_forces.transmitted` has them."""
    network = Network(dynamics) if network is None else network
    needed = network.spread(needs(dynamics, states, times))
    points = joint_points(dynamics, states)
    wrenches = _in_chunks(network, dynamics, states, needed, points, effort, free)
    if not len(network.gears):
        return wrenches
    gears = transmitted(dynamics, states, network.sign, along_rates(network, states, wrenches) - effort, flanks)
    teeth = toothed(dynamics.system)
    if teeth.any():
        shafts = copy.copy(network)
        shafts.gears = network.gears[~teeth]
        wrenches = _in_chunks(shafts, dynamics, states, needed - gears.wrenches, points, effort, free)
    return replace(wrenches, gears=gears)


def along_rates(network: Network, states: States, wrenches: Reactions) -> Array:
    """(T, n) what the joints transmit along their rates."""
    about = wrenches.on_second[:, network.owner].copy()
    about[..., :3] += np.cross(wrenches.points[:, network.owner], about[..., 3:])
    return np.asarray(np.einsum("tnk,tnk->tn", states.screws * network.sign[:, None], about))


def _in_chunks(
    network: Network, dynamics: Dynamics, states: States, needed: Array, points: Array, effort: Array, free: float
) -> Reactions:
    """The wrenches for what the bodies need; shafts pass efforts on by the gears of the network."""
    parts = []
    rank = _rank(dynamics, states, network.gears, free) if network.closing else 0
    for first in range(0, len(effort), CHUNK):
        times = slice(first, first + CHUNK)
        parts.append(_solve(network, states.screws[times], needed[times], points[times], effort[times], rank))
    if not parts:
        none = np.zeros((0, len(network.first), 6))
        return Reactions(none, points, np.zeros(none.shape[1:], dtype=np.bool_))
    wrenches = np.concatenate([wrench for wrench, _, _ in parts])
    loose = np.any([loose for _, loose, _ in parts], axis=0)
    return Reactions(wrenches, points, loose, stresses=parts[0][2])


def needs(dynamics: Dynamics, states: States, times: Array) -> Array:
    """(T, B, 6) wrench about the centre that the joints must give each body with mass: momentum's rate
    less gravity, loads and springs between bodies."""
    links = dynamics.body_links
    X, V, A = states.poses[:, links], states.twists[:, links], states.accelerations[:, links].copy()
    R, p = X[..., :3, :3], X[..., :3, 3]
    com = (R @ dynamics.com[:, :, None])[..., 0] + p
    A[..., 3:] -= dynamics.gravity
    tensor = R @ dynamics.inertia @ R.swapaxes(-1, -2)

    def momentum(twist: Array) -> Array:
        linear = dynamics.mass[:, None] * (twist[..., 3:] + np.cross(twist[..., :3], com))
        return np.concatenate([(tensor @ twist[..., :3, None])[..., 0] + np.cross(com, linear), linear], axis=-1)

    carried = cross_force(V.reshape(-1, 6), momentum(V).reshape(-1, 6)).reshape(V.shape)
    return np.asarray(momentum(A) + carried - applied(dynamics, states, times))


def applied(dynamics: Dynamics, states: States, times: Array) -> Array:
    """(T, B, 6) wrench about the centre of loads and springs between bodies on each body with mass."""
    out = np.zeros((len(states.poses), len(dynamics.body_links), 6))
    # What acts on a link of several bodies acts on one of them: fixed joints pass it on.
    first = {int(link): k for k, link in reversed(list(enumerate(dynamics.body_links)))}
    actuation, system = dynamics.actuation, dynamics.system
    subjects = [dynamics.mechanism.bodies[k] for k in dynamics.body_index]

    def push(body: str, link: int, point: Array, force: Array, torque: Array) -> None:
        if link in first:
            k = subjects.index(body) if body in subjects else first[link]
            out[:, k] += np.concatenate([torque + np.cross(point, force), force], axis=1)

    for load, component in zip(actuation.loads, system.loads, strict=True):
        X = states.poses[:, load.link]
        R = X[:, :3, :3] if load.turning else np.broadcast_to(np.eye(3), (len(X), 3, 3))
        body = system.body_at(component.name, "frame").subject
        factor = np.array([load.signal.value(float(t)) for t in times])[:, None]
        place = X[:, :3, :3] @ load.point + X[:, :3, 3]
        push(body, load.link, place, factor * (R @ load.force), factor * (R @ load.torque))
    for spring, between in zip(actuation.springs, system.springs, strict=True):
        force, torque, at, on = spring.wrench(states.poses, states.twists)
        names = [system.body_at(between.name, port).subject for port in ("a", "b")]
        push(names[0], spring.first, on, force, torque)
        push(names[1], spring.second, at, -force, -torque)
    return out


def joint_points(dynamics: Dynamics, states: States) -> Array:
    """(T, J, 3) points of the joints as their first bodies carry them, about the centre."""
    mechanism, system = dynamics.mechanism, dynamics.system
    link_of = dict(zip(mechanism.bodies, mechanism.link_of, strict=True))
    out = np.zeros((len(states.poses), len(system.joints), 3))
    for k, joint in enumerate(system.joints):
        X = states.poses[:, link_of[system.body_at(joint.name, "a").subject]]
        point = joint.geometry.point
        at = np.zeros(3) if point is None or not np.all(np.isfinite(point)) else point
        out[:, k] = X[:, :3, :3] @ (at - mechanism.centre) + X[:, :3, 3]
    return out


class Network:
    """Bodies joined by all joints, fixed ones too: a tree, and joints left over."""

    def __init__(self, dynamics: Dynamics):
        """What the tree of joints says once for all times: which bodies each joint carries, and which loops pass it."""
        mechanism, system = dynamics.mechanism, dynamics.system
        index = {body.name: k for k, body in enumerate(system.bodies)}
        ends = [[index[system.body_at(j.name, port).name] for j in system.joints] for port in ("a", "b")]
        self.first, self.second = (np.array(side, dtype=np.int64) for side in ends)
        pairs = [(int(a), int(b)) for a, b in zip(self.first, self.second, strict=True)]
        tree = arrange(len(index), pairs, [False] * len(pairs), index[system.ground.name])
        self.closing = list(tree.closing)
        self._bodies = dynamics.body_index, len(index)
        self._node_of = tree.node_of
        nodes = len(tree.carried) + 1
        below = np.eye(nodes)
        for step in reversed(tree.carried):
            below[step.parent] += below[step.node]
        self.by_needs = np.zeros((len(pairs), len(index)))
        """(J, B) wrench on the second body of each joint from what each body needs."""
        node = np.array(tree.node_of)
        for step in tree.carried:
            sign = 1.0 if step.forward else -1.0
            self.by_needs[step.joint] = np.where(node >= 0, sign * below[step.node][node], 0.0)
        self.by_loops = np.zeros((len(pairs), len(self.closing)))
        """(J, C) and from the wrenches on the second bodies of the joints left over."""
        for column, joint in enumerate(self.closing):
            self.by_loops[:, column] = self.by_needs[:, self.first[joint]] - self.by_needs[:, self.second[joint]]
            self.by_loops[joint, column] = 1.0
        self.length, self.scale, self.gears = mechanism.length, mechanism.scale, mechanism.gear_v
        links = mechanism.link_of
        self.owner = np.zeros(mechanism.rates, dtype=np.int64)
        """(n,) joint of each rate."""
        self.sign = np.ones(mechanism.rates)
        """(n,) −1 where the mechanism counts a rate's twist of the first body relative to the second."""
        for k, slot in enumerate(mechanism.slots):
            self.owner[slot.v] = k
            a, b = links[self.first[k]], links[self.second[k]]
            for v in range(slot.v.start, slot.v.stop):
                if mechanism.moves[a, v] > mechanism.moves[b, v]:
                    self.sign[v] = -1.0

    def shares(self) -> Shares:
        """What the wrenches of the joints left over do to all joints."""
        closing = np.array(self.closing, dtype=np.int64)
        return Shares(self.by_loops, closing, self.owner, self.gears, self.length, self.scale)

    def spread(self, needed: Array) -> Array:
        """(T, B, 6) over all bodies, from those with mass."""
        out = np.zeros((len(needed), self._bodies[1], 6))
        out[:, self._bodies[0]] = needed
        return out


def _rank(dynamics: Dynamics, states: States, gears: Array, free: float) -> int:
    """Rank of the loops and these gears for all rates, fixed joints left over included, decided once."""
    mechanism = dynamics.mechanism
    rows = mechanism.closure(states.screws[0])
    rows = np.concatenate([rows[: len(rows) - len(mechanism.gear_v)], gears])
    return rank_of(rows, mechanism.scale, free)


def _solve(
    network: Network, screws: Array, needed: Array, points: Array, effort: Array, rank: int
) -> tuple[Array, Flags, Array]:
    """(T, J, 6) wrenches on the second bodies about the joints' points, (J, 6) what is not determined, and (z, J, 6)
    what could be added at the first time."""
    carried = np.einsum("jb,tbk->tjk", network.by_needs, needed)
    if not network.closing:
        none = np.zeros((len(network.first), 6), dtype=np.bool_)
        return about(carried, points), none, np.zeros((0, *none.shape))
    return add_loops(carried, network.shares(), screws * network.sign[:, None], points, effort, rank)
