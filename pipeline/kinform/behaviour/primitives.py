"""Primitive motions, of which every joint is a chain: one freedom along a screw, and the ball.

Turning, sliding and screwing are one motion, exp([S] q) with S = (ω; v): with ω a unit vector, p on the
axis and h the slide per radian, v = p × ω + h ω; with ω = 0, v is the direction of a slide (Brockett
1984; Murray, Li and Sastry 1994, section 2.3). As ω is a unit vector or zero, [S] obeys

    exp([S] q) = 1 + q E₁ + sin(q) E₂ + (1 − cos q) E₃

with three constant matrices, so that all primitives of a mechanism move in one batch.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross_matrix
from kinform.frozen import dataclass
from kinform.model.arrays import Array


@dataclass(frozen=True, eq=False)
class OneFreedom:
    """Motion along one screw that is fixed in the body on the side of the first."""

    omega: Array
    """(3,) unit axis, or zero for a slide."""
    point: Array
    """(3,) m, on the axis."""
    slide: Array
    """(3,) m a radian along the axis; for a slide its unit direction."""

    @property
    def twist(self) -> Array:
        """(6,) S = (ω; v), v the velocity of the point at the origin."""
        return np.concatenate([self.omega, np.cross(self.point, self.omega) + self.slide])

    @property
    def terms(self) -> Array:
        """(3, 4, 4): E₁, E₂, E₃ of the exponential; E₁ goes with q, E₂ with sin q, E₃ with 1 − cos q."""
        turn = cross_matrix(self.omega)
        out = np.zeros((3, 4, 4))
        out[0, :3, 3] = self.slide
        for k, rotation in ((1, turn), (2, turn @ turn)):
            out[k, :3, :3] = rotation
            out[k, :3, 3] = -rotation @ self.point
        return out

    def reversed(self) -> OneFreedom:
        """The motion of the first side relative to the second, at the same value."""
        return OneFreedom(-self.omega, self.point, -self.slide)


@dataclass(frozen=True, eq=False)
class Ball:
    """All turns about one point: four coordinates (quaternion wxyz), three rates (ω in the first body)."""

    point: Array
    """(3,) m."""


Primitive = OneFreedom | Ball
