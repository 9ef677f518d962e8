"""What springs, gas springs and bushings between two links do: wrenches and stored energy at many times at once.

The same laws as in the kernel (`kernel.forces.between`), which solves with them. A bushing's torque is the gradient of
the energy in its rotation vector θ, by the inverse of the left Jacobian of the rotations (Bullo and Murray 1995), so
that turns of any size, up to half a turn, store what they take.
"""

from __future__ import annotations

import numpy as np

from kinform.behaviour.components import Bushing, Elastic, GasSpring, SpringDamper
from kinform.foundation.algebra.spatial import rotation_vector
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.simulation.kernel import layout

WIDTH = 27
"""Numbers of each in the kernel's table."""


@dataclass(frozen=True, eq=False)
class Between:
    """Something elastic between points of two links, about the mechanism's centre."""

    first: int
    second: int
    point: Array
    other: Array
    law: Elastic

    @property
    def kind(self) -> int:
        """As the kernel calls it."""
        if isinstance(self.law, Bushing):
            return layout.CUSHION
        return layout.GAS if isinstance(self.law, GasSpring) else layout.STRAIGHT_SPRING

    @property
    def numbers(self) -> list[float]:
        """(WIDTH,) as the kernel takes them."""
        law = self.law
        if isinstance(law, Bushing):
            of_axes = np.concatenate([law.stiffness, law.torsion, law.damping, law.torsion_damping, law.axes.T.ravel()])
            return [*self.point, *self.other, *of_axes]
        if isinstance(law, GasSpring):
            along = [law.force, law.damping, law.extended, law.column, law.exponent]
        else:
            along = [law.stiffness, law.damping, law.rest]
        out = [*self.point, *self.other, *along]
        return out + [0.0] * (WIDTH - len(out))

    def ends(self, X: Array) -> tuple[Array, Array]:
        """(T, 3) of both points at poses (T, L, 4, 4) of the links."""
        first, second = (
            X[:, link, :3, :3] @ point + X[:, link, :3, 3]
            for link, point in ((self.first, self.point), (self.second, self.other))
        )
        return first, second

    def energy(self, X: Array) -> Array:
        """(T,) J stored."""
        law, (first, second) = self.law, self.ends(X)
        if isinstance(law, Bushing):
            shift, turn = self._displaced(X, second - first)
            return np.asarray(0.5 * (shift**2 @ law.stiffness + turn**2 @ law.torsion))
        length = np.linalg.norm(second - first, axis=1)
        if isinstance(law, SpringDamper):
            return np.asarray(0.5 * law.stiffness * (length - law.rest) ** 2)
        left = law.left(length) / law.column
        if law.exponent == 1.0:
            return np.asarray(-law.force * law.column * np.log(left))
        return np.asarray(law.force * law.column * (left ** (1.0 - law.exponent) - 1.0) / (law.exponent - 1.0))

    def wrench(self, X: Array, V: Array) -> tuple[Array, Array, Array, Array]:
        """(T, 3) force on the first link at the first point, torque on it; the point on which the opposite of both acts
        on the second, and the first point. `V` (T, L, 6) twists."""
        law, (first, second) = self.law, self.ends(X)
        V_a, V_b = V[:, self.first], V[:, self.second]
        if isinstance(law, Bushing):
            axes = X[:, self.first, :3, :3] @ law.axes
            shift, turn = self._displaced(X, second - first)
            speed = V_b[:, 3:] - V_a[:, 3:] + np.cross(V_b[:, :3] - V_a[:, :3], second)
            force = shift * law.stiffness + _in(axes, speed) * law.damping
            torque = _gradient(turn, turn * law.torsion) + _in(axes, V_b[:, :3] - V_a[:, :3]) * law.torsion_damping
            return _out(axes, force), _out(axes, torque), second, second
        line = second - first
        length = np.linalg.norm(line, axis=1, keepdims=True)
        along = line / np.where(length > 0.0, length, 1.0)
        ends = (V_b[:, 3:] + np.cross(V_b[:, :3], second)) - (V_a[:, 3:] + np.cross(V_a[:, :3], first))
        pull = law.pull(length) + law.damping * (ends * along).sum(axis=1, keepdims=True)
        return pull * along, np.zeros_like(along), second, first

    def _displaced(self, X: Array, line: Array) -> tuple[Array, Array]:
        """(T, 3) shift and (T, 3) rotation vector of the second link, in the axes that the first carries."""
        assert isinstance(self.law, Bushing)
        axes = X[:, self.first, :3, :3] @ self.law.axes
        other = X[:, self.second, :3, :3] @ self.law.axes
        return _in(axes, line), rotation_vector(axes.swapaxes(1, 2) @ other)


def _in(axes: Array, vectors: Array) -> Array:
    return np.asarray(np.einsum("tji,tj->ti", axes, vectors))


def _out(axes: Array, vectors: Array) -> Array:
    return np.asarray(np.einsum("tij,tj->ti", axes, vectors))


def _gradient(turn: Array, slope: Array) -> Array:
    """(T, 3) torque of an energy whose derivative by the rotation vectors `turn` (T, 3) is `slope`."""
    angle = np.linalg.norm(turn, axis=1, keepdims=True)
    safe = np.where(angle > layout.NEAR_STRAIGHT, angle, 1.0)
    share = np.where(angle > layout.NEAR_STRAIGHT, (1.0 - 0.5 * safe / np.tan(0.5 * safe)) / safe**2, 1.0 / 12.0)
    once = np.cross(turn, slope)
    return np.asarray(slope + 0.5 * once + share * np.cross(turn, once))
