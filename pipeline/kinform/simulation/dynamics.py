"""Newton and Euler in joint coordinates: mass matrix, bias, accelerations, efforts, energy.

Composite rigid bodies for the mass matrix and recursive Newton–Euler for the bias (Featherstone, Rigid
Body Dynamics Algorithms, 2008, chapters 5 and 6), with the recursions written as products with the
matrix of what moves what, all in world axes about the mechanism's centre. Loops and prescribed joints
are constraints on the accelerations; free motions are the null space of the loops at a fixed rank.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.behaviour.components import RigidBody, System
from kinform.simulation.actuation import Actuation
from kinform.simulation.closure import factor
from kinform.simulation.mechanism import Mechanism
from kinform.simulation.spatial import cross_force, cross_motion, skew

__all__ = ["Dynamics", "Motion", "SingularMassError"]

Array = NDArray[np.float64]
Index = NDArray[np.int64]


class SingularMassError(ArithmeticError):
    """A free motion moves no mass: its acceleration is undetermined."""


@dataclass(frozen=True, eq=False)
class Motion:
    """What follows from positions and rates at one time."""

    acceleration: Array
    """(n,) of the rates."""
    effort: Array
    """(n,) by all drives (N·m, N); what a prescribed motion needs included."""
    power: float
    """W that drives, dampers and loads put in; springs store instead."""
    margin: float
    """How far the loops are from a singular pose: see `Factor.margin`."""


class Dynamics:
    """The mechanism with its masses, gravity and what acts on it."""

    def __init__(self, mechanism: Mechanism, system: System, gravity: Array, actuation: Actuation, rank: int):
        """`rank`: of the loops for the rates that are not prescribed."""
        self.mechanism, self.gravity, self.actuation = mechanism, gravity, actuation
        link_of = dict(zip(mechanism.bodies, mechanism.link_of, strict=True))
        bodies = [b for b in system.bodies if isinstance(b, RigidBody) and link_of[b.subject] > 0]
        self._links = np.array([link_of[b.subject] for b in bodies], dtype=np.int64)
        self._mass = np.array([b.mass for b in bodies], dtype=np.float64)
        self._com = np.array([b.centre_of_mass for b in bodies]).reshape(-1, 3) - mechanism.centre
        self._inertia = np.array([b.inertia for b in bodies]).reshape(-1, 3, 3)
        self._lumped = np.zeros((len(bodies), 6, 6))
        self._lumped[:, 3:, 3:] = self._mass[:, None, None] * np.eye(3)
        self._rank = rank
        self._order = self._ancestry()

    def _ancestry(self) -> Array:
        """(n, n) 1 where rate j moves the link of rate i and comes before it (or is it)."""
        moves = self.mechanism.moves[self.mechanism.column_link]
        both = (moves > 0.0) & (moves.T > 0.0)
        later = np.arange(len(moves))[None, :] > np.arange(len(moves))[:, None]
        return np.where(both & later, 0.0, moves)

    def _spatial(self, X: Array) -> tuple[Array, Array]:
        """(B, 6, 6) inertia about the centre, and (B, 3) centres of mass."""
        R, p = X[self._links, :3, :3], X[self._links, :3, 3]
        com = (R @ self._com[:, :, None])[..., 0] + p
        hat = skew(com)
        first = self._mass[:, None, None] * hat
        out = self._lumped.copy()
        out[:, :3, :3] = R @ self._inertia @ R.transpose(0, 2, 1) - first @ hat
        out[:, :3, 3:] = first
        out[:, 3:, :3] = -first
        return out, com

    def mass_matrix(self, X: Array, screws: Array) -> Array:
        """(n, n) at the poses X."""
        inertia, _ = self._spatial(X)
        return self._mass_matrix(inertia, screws)

    def _mass_matrix(self, inertia: Array, screws: Array) -> Array:
        moved = self.mechanism.moves[self._links]
        composite = (moved.T @ inertia.reshape(-1, 36)).reshape(-1, 6, 6)
        momenta = (composite @ screws[:, :, None])[..., 0]
        half = self._order * (momenta @ screws.T)
        full = half + half.T
        full.flat[:: len(full) + 1] *= 0.5
        return np.asarray(full)

    def motion(self, t: float, q: Array, v: Array) -> Motion:
        """Accelerations, efforts and power. Raises SingularMassError."""
        mechanism, acts = self.mechanism, self.actuation
        X = mechanism.poses(q)
        screws = mechanism.screws(X)
        V = mechanism.twists(screws, v)
        carried = cross_motion(V[mechanism.column_link], screws * v[:, None])
        A = mechanism.moves @ carried
        inertia, _ = self._spatial(X)
        M = self._mass_matrix(inertia, screws)
        load, load_power = acts.loads(X, V)
        bias = self._bias(inertia, V, A, screws) - (screws * (mechanism.moves.T @ load)).sum(axis=1)
        given, stored = acts.efforts(t, q, v)
        force = given + stored - bias
        acceleration, needed, margin = self._accelerate(t, M, force, screws, A)
        power = float((given + needed) @ v) + load_power
        return Motion(acceleration, given + stored + needed, power, margin)

    def _bias(self, inertia: Array, V: Array, A: Array, screws: Array) -> Array:
        """(n,) efforts that hold the present rates against inertia and gravity."""
        twist, acceleration = V[self._links], A[self._links].copy()
        acceleration[:, 3:] -= self.gravity
        momentum = (inertia @ twist[:, :, None])[..., 0]
        wrench = (inertia @ acceleration[:, :, None])[..., 0] + cross_force(twist, momentum)
        return np.asarray((screws * (self.mechanism.moves[self._links].T @ wrench)).sum(axis=1))

    def _accelerate(self, t: float, M: Array, force: Array, screws: Array, A: Array) -> tuple[Array, Array, float]:
        """Accelerations of all rates, the efforts (n,) that the prescribed ones need, and the margin."""
        mechanism, led, free = self.mechanism, self.actuation.led, self.actuation.free
        acceleration, needed = np.zeros(len(M)), np.zeros(len(M))
        if not mechanism.closed and not len(led):
            return _solve(M, force), needed, 1.0
        acceleration[led] = self.actuation.led_accelerations(t)
        rest = force[free] - M[np.ix_(free, led)] @ acceleration[led]
        inner = M[np.ix_(free, free)]
        if not mechanism.closed:
            acceleration[free] = _solve(inner, rest)
            needed[led] = M[led] @ acceleration - force[led]
            return acceleration, needed, 1.0
        rows = mechanism.closure(screws)
        loops = factor(rows[:, free], mechanism.scale[free], self._rank)
        target = -mechanism.closure_bias(A) - rows[:, led] @ acceleration[led]
        particular = loops.solve(target)
        null = loops.null
        if null.shape[1]:
            rates = _solve(null.T @ inner @ null, null.T @ (rest - inner @ particular))
            particular = particular + null @ rates
        acceleration[free] = particular
        if len(led):
            multipliers = loops.multipliers(M[free] @ acceleration - force[free])
            needed[led] = M[led] @ acceleration - force[led] - rows[:, led].T @ multipliers
        return acceleration, needed, loops.margin

    def project(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Positions and rates nearest, by the mass matrix, on closed loops; prescribed joints stay."""
        mechanism, free = self.mechanism, self.actuation.free
        for _ in range(4):
            X = mechanism.poses(q)
            gap = mechanism.gap(X, q)
            screws = mechanism.screws(X)
            loops = factor(mechanism.closure(screws)[:, free], mechanism.scale[free], self._rank)
            inner = self.mass_matrix(X, screws)[np.ix_(free, free)]
            if float(np.abs(gap).max(initial=0.0)) < 1e-13:
                break
            step = np.zeros(mechanism.rates)
            step[free] = _nearest(inner, loops.null, loops.solve(-gap))
            q = mechanism.advance(q, step)
        v = v.copy()
        opening = mechanism.closure(screws) @ v
        v[free] += _nearest(inner, loops.null, loops.solve(-opening))
        return q, v

    def energy(self, q: Array, v: Array) -> tuple[float, float]:
        """Kinetic energy, and potential energy relative to the pose of the meshes with springs (J)."""
        mechanism = self.mechanism
        X = mechanism.poses(q)
        inertia, com = self._spatial(X)
        V = mechanism.twists(mechanism.screws(X), v)[self._links]
        kinetic = 0.5 * float(np.einsum("bi,bij,bj->", V, inertia, V))
        height = -float(self._mass @ ((com - self._com) @ self.gravity))
        return kinetic, height + self.actuation.stored(q)

    def weightless(self, q: Array) -> tuple[str, ...]:
        """Joints that take part in free motions without mass: their acceleration is undetermined."""
        mechanism, free = self.mechanism, self.actuation.free
        X = mechanism.poses(q)
        screws = mechanism.screws(X)
        scale = mechanism.scale[free]
        null = factor(mechanism.closure(screws)[:, free], scale, self._rank).null
        if not null.shape[1]:
            return ()
        inner = null.T @ self.mass_matrix(X, screws)[np.ix_(free, free)] @ null
        values, vectors = np.linalg.eigh(inner)
        empty = null @ vectors[:, values <= 1e-13 * max(float(values.max()), 1e-300)]
        moving = free[np.abs(empty / scale[:, None]).max(axis=1, initial=0.0) > 1e-6]
        return tuple(s.name for s in mechanism.slots if np.any((moving >= s.v.start) & (moving < s.v.stop)))


def _solve(matrix: Array, right: Array) -> Array:
    """Solution of a positive definite system."""
    if len(matrix) == 0:
        return np.zeros(0)
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError as error:
        raise SingularMassError(str(error)) from error


def _nearest(inner: Array, null: Array, step: Array) -> Array:
    """The step of least mass-weighted size among those that close the loops alike."""
    if not null.shape[1]:
        return step
    return step - null @ _solve(null.T @ inner @ null, null.T @ (inner @ step))
