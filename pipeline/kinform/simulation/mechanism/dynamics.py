"""The mechanism with its masses, gravity and what acts on it, and the kernel that solves it."""

from __future__ import annotations

import numpy as np

from kinform.behaviour.components import RigidBody, System
from kinform.foundation.rounding import ARITHMETIC, SINGLE, TINY
from kinform.mechanism.rank import factor
from kinform.model.arrays import Array, Ints
from kinform.simulation.kernel import equations, layout, masses, motion, pivoting
from kinform.simulation.kernel.calls import plainly
from kinform.simulation.kernel.layout import Nums, Row, Work
from kinform.simulation.kernel.tables import Tables
from kinform.simulation.mechanism.actuation import Actuation
from kinform.simulation.mechanism.kernel_tables import tabulate
from kinform.simulation.mechanism.mechanism import Mechanism
from kinform.simulation.mechanism.states import States


class Dynamics:
    """Constants of one mode of a run: which joints are led, and the rank of the loops for the others."""

    def __init__(self, mechanism: Mechanism, system: System, gravity: Array, actuation: Actuation, rank: int):
        """`rank`: of the loops for the rates that are not prescribed."""
        self.mechanism, self.system, self.gravity, self.actuation = mechanism, system, gravity, actuation
        self.rank = rank
        self.tables: Tables = tabulate(mechanism, system, gravity, actuation, rank)
        link_of = dict(zip(mechanism.bodies, mechanism.link_of, strict=True))
        bodies = [b for b in system.bodies if isinstance(b, RigidBody) and link_of[b.subject] > 0]
        self.body_links = np.array([link_of[b.subject] for b in bodies], dtype=np.int64)
        self.body_index = np.array([mechanism.bodies.index(b.subject) for b in bodies], dtype=np.int64)
        self.mass = np.array([b.mass for b in bodies], dtype=np.float64)
        self.com = np.array([b.centre_of_mass for b in bodies]).reshape(-1, 3) - mechanism.centre
        self.inertia = np.array([b.inertia for b in bodies]).reshape(-1, 3, 3)

    def place(self, q: Array, v: Array) -> None:
        """Bring the kernel's links to these positions and rates, and choose which rows to keep there."""
        plainly(_place, self.tables, self.tables.pack(q, v), self.rank)

    def project(self, t: float, q: Array, v: Array, closed: float) -> tuple[Array, Array]:
        """Positions and rates nearest, by the mass matrix, on closed loops; prescribed joints on their laws."""
        tables = self.tables
        y = tables.pack(q, v)
        plainly(equations.project, tables, t, y, closed, False)
        return tables.unpack(y)

    def mass_matrix(self, q: Array) -> Array:
        """(n, n) at positions (nq,)."""
        tables = self.tables
        plainly(_weigh, tables, tables.pack(q, np.zeros(self.mechanism.rates)))
        lower = np.tril(tables.work[layout.MASS])
        full = lower + np.tril(lower, -1).T
        inverse = np.argsort(tables.v_order)
        return full[np.ix_(inverse, inverse)]

    def on_bodies(self, effort: Array, acceleration: Array) -> Array:
        """(…, n) of the efforts (…, n) on the shafts what the bodies get, at accelerations (…, n): all but what turns
        rotors."""
        armature = self.actuation.armature
        return effort - armature * acceleration if armature.any() else effort

    def weightless(self, q: Array) -> tuple[str, ...]:
        """Joints that take part in free motions without mass: their acceleration is undetermined."""
        mechanism, free = self.mechanism, self.actuation.free
        scale = mechanism.scale[free]
        null = factor(mechanism.closure_at(q)[:, free], scale, self.rank).null
        if not null.shape[1]:
            return ()
        inner = null.T @ self.mass_matrix(q)[np.ix_(free, free)] @ null
        values, vectors = np.linalg.eigh(inner)
        # motions without mass, and the joints that take part in them, but for rounding
        empty = null @ vectors[:, values <= ARITHMETIC * max(float(values.max()), TINY)]
        moving = free[np.abs(empty / scale[:, None]).max(axis=1, initial=0.0) > SINGLE]
        return mechanism.joints_of(moving)

    def energy(self, q: Array, v: Array, states: States) -> tuple[Array, Array]:
        """(T,) kinetic, and potential energy relative to the pose of the meshes with springs (J), at positions (T, nq)
        and rates (T, n)."""
        X, V = states.poses[:, self.body_links], states.twists[:, self.body_links]
        R, p = X[..., :3, :3], X[..., :3, 3]
        com = (R @ self.com[:, :, None])[..., 0] + p
        spin = V[..., :3]
        speed = V[..., 3:] + np.cross(spin, com)
        local = (R.swapaxes(-1, -2) @ spin[..., None])[..., 0]
        turning = np.einsum("tbi,bij,tbj->t", local, self.inertia, local)
        kinetic = 0.5 * (turning + (speed**2).sum(axis=2) @ self.mass)
        if self.actuation.armature.any():
            kinetic = kinetic + 0.5 * v**2 @ self.actuation.armature
        height = -((com - self.com) @ self.gravity) @ self.mass
        return kinetic, height + self.actuation.stored(q, states.poses)


def _place(ints: Ints, nums: Nums, work: Work, y: Row, rank: int) -> None:
    """Poses of the links at y, and the rows of the loops that are kept there."""
    motion.place_links(ints, nums, work, y)
    if rank:
        pivoting.choose_pivots(ints, nums, work)
    pivoting.choose_method(ints, nums)


def _weigh(ints: Ints, nums: Nums, work: Work, y: Row) -> None:
    """The mass matrix at y."""
    motion.place_links(ints, nums, work, y)
    masses.inertias(ints, nums, work)
    masses.mass_matrix(ints, nums, work, False)
