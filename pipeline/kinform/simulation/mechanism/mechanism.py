"""The mechanism in joint coordinates: a tree of primitive motions, and pairs of links that must coincide.

Everything is in world axes about `centre`. Link 0 is the ground; each primitive motion of a joint makes
a link. A joint that closes a loop grows a branch without mass from its first body, whose last link must
coincide with the second body: its coordinates are unknowns like all others, so that closure is one
condition for every kind of joint (product of exponentials; Park, Bobrow and Ploen 1995).

Positions q hold four numbers for a ball, rates v three; otherwise they agree.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property

import numpy as np

from kinform.behaviour.joints import JointKind
from kinform.behaviour.primitives import OneFreedom
from kinform.foundation.algebra.displacements import UNMOVED
from kinform.foundation.algebra.spatial import along_motion, multiply, rotation_vector, to_matrix
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints

LENGTHS_ROUNDED = 1e-13
"""Share of the mechanism's length by which lengths that are exact in double precision may be off: a few hundred
roundings, as poses are products of many factors."""
AT_LIMIT, AT_LIMIT_SHARE = 0.05, 0.1
"""Margin of the loops for what is not led, and its share of that for all rates, below which a run that cannot go on
has come to the end of what the loops let be led. Runs end at margins of a hundredth and less. A choice."""


@dataclass(frozen=True)
class Slot:
    """Where the coordinates of one joint are."""

    name: str
    kind: JointKind
    q: slice
    v: slice

    @property
    def has_ball(self) -> bool:
        """Whether its positions are a quaternion."""
        return bool(self.q.stop - self.q.start > self.v.stop - self.v.start)


@dataclass(frozen=True, eq=False)
class BallLink:
    """A link that turns about a point."""

    link: int
    q: int
    v: int
    point: Array
    forward: bool


@dataclass(frozen=True, eq=False)
class Mechanism:
    """Constants of the mechanism; n rates, L links."""

    centre: Array
    """(3,) m."""
    length: float
    """m: what makes metres comparable with radians."""
    bodies: tuple[str, ...]
    link_of: Ints
    """(B,) link of each body; 0 for ground and for bodies that nothing connects."""
    slots: tuple[Slot, ...]
    """Joints in order."""
    parent: Ints
    """(L,) link nearer to the ground; parents come first."""
    screw_link: Ints
    """(P,) links that move along a screw."""
    screw_q: Ints
    screw_terms: Array
    """(P, 3, 4, 4): E₁, E₂, E₃ of the exponential."""
    screw_primitives: tuple[OneFreedom, ...]
    """(P,) the same, from the parent's side to the link's."""
    balls: tuple[BallLink, ...]
    column: Array
    """(n, 6) twist of each rate at the zero pose."""
    column_frame: Ints
    """(n,) link that carries the twist along."""
    column_link: Ints
    """(n,) link that the rate moves first."""
    moves: Array
    """(L, n) 1 where the rate moves the link."""
    scale: Array
    """(n,) 1 for turns, `length` for slides: a rate of one moves points about one length."""
    closures: Ints
    """(C, 2) links that must coincide."""
    gear_v: Array
    """(G, n) rows of couplings on rates."""
    gear_q: Array
    """(G, nq) the same on positions."""
    uncertain: float = 0.0
    """rad, and shares of `length`: by how much loops may be off, as far as geometry is known; 0: it is exact."""

    @property
    def rates(self) -> int:
        """Number of rates n."""
        return len(self.column)

    @property
    def start(self) -> Array:
        """Positions at the pose of the meshes."""
        q = np.zeros(self.gear_q.shape[1])
        for slot in self.slots:
            if slot.has_ball:
                q[slot.q.start] = 1.0
        return q

    @property
    def narrow(self) -> float:
        """The margin (smallest singular value or pivot of the loops over the largest) below which what is known of
        lengths does not tell whether branches of the motion meet, or part just before."""
        # Margin of a corner over the root of the difference in lengths that makes it, as a share of the mechanism's
        # length: at most.
        return 2.0 * float(np.sqrt(max(self.uncertain, LENGTHS_ROUNDED)))

    def folds(self, q: Array, rank: int) -> bool:
        """Whether branches of the motion meet at positions q (nq,), or part just before, as far as is known of lengths:
        there the loops are singular for all rates, those that are led included. At the end of a driven joint's reach
        only the others are."""
        values = np.linalg.svd(self.closure_at(q) * self.scale, compute_uv=False)
        return bool(rank) and bool(values[rank - 1] < self.narrow * values[0])

    def at_limit(self, q: Array, led: Ints, rank: int) -> bool:
        """Whether the rates that are led (k,) have come as far as the loops let them at positions q (nq,): the loops
        are singular for the other rates, and not for all."""
        if not rank or not len(led):
            return False
        rows = self.closure_at(q) * self.scale
        others, every = (np.linalg.svd(block, compute_uv=False) for block in (np.delete(rows, led, axis=1), rows))
        if len(others) < rank:
            return False
        tight, whole = others[rank - 1] / others[0], every[rank - 1] / every[0]
        return bool(tight < AT_LIMIT and tight < AT_LIMIT_SHARE * whole)

    def limit(self, led: Ints) -> str:
        """That these rates can be led no further, in words."""
        names = " and ".join(self.joints_of(led))
        return f"the motion comes to a limit position, beyond which the loops do not let {names} go"

    def doubt(self) -> str:
        """That the motion has come to where its branches are not told apart, in words."""
        off = max(self.uncertain, LENGTHS_ROUNDED) * self.length
        return (
            "the loops come to a singular pose, and which of the branches that meet there they go on in is not known: "
            f"lengths are known to {1e3 * off:.2g} mm, and smaller differences decide it (drive a second joint, or "
            "keep the motion away from this pose)"
        )

    @property
    def closed(self) -> bool:
        """Whether there is anything to close."""
        return len(self.closures) + len(self.gear_v) > 0

    def poses(self, q: Array) -> Array:
        """(L, 4, 4) displacement of each link from the zero pose."""
        values = q[self.screw_q]
        factors = np.empty((len(values), 1, 3))
        factors[:, 0, 0], factors[:, 0, 1], factors[:, 0, 2] = values, np.sin(values), 1.0 - np.cos(values)
        motions = UNMOVED + (factors @ self.screw_terms.reshape(-1, 3, 16)).reshape(-1, 4, 4)
        own: list[Array] = [UNMOVED] * len(self.parent)
        for link, motion in zip(self.screw_link, motions, strict=True):
            own[link] = motion
        for ball in self.balls:
            own[ball.link] = _ball_motion(ball, q)
        X = np.empty((len(self.parent), 4, 4))
        X[0] = UNMOVED
        for link in range(1, len(self.parent)):
            np.matmul(X[self.parent[link]], own[link], out=X[link])
        return X

    def screws(self, X: Array) -> Array:
        """(n, 6) twist of each rate at the poses X."""
        return along_motion(X[self.column_frame], self.column)

    def twists(self, screws: Array, v: Array) -> Array:
        """(L, 6) twist of each link."""
        return np.asarray((self.moves * v) @ screws)

    def advance(self, q: Array, step: Array) -> Array:
        """Positions after the displacement `step` (n,), a rate times a time."""
        out = q.copy()
        positions, rates = self._plain
        out[positions] += step[rates]
        for slot in self._balls:
            out[slot.q] = _turned(q[slot.q], step[slot.v])
        return out

    @cached_property
    def _balls(self) -> tuple[Slot, ...]:
        return tuple(slot for slot in self.slots if slot.has_ball)

    @cached_property
    def _plain(self) -> tuple[Ints, Ints]:
        """Positions that are no ball's, and the rate of each."""
        slots = [slot for slot in self.slots if not slot.has_ball]
        both = [(q, v) for s in slots for q, v in zip(_range(s.q), _range(s.v), strict=True)]
        positions, rates = np.array(both, dtype=np.int64).reshape(-1, 2).T
        return positions, rates

    def gap(self, X: Array, q: Array) -> Array:
        """(6C + G,) what keeps the loops from closing: rotation (rad), displacement over `length`."""
        if len(self.closures) == 0:
            return np.asarray(self.gear_q @ q)
        ends, targets = X[self.closures[:, 0]], X[self.closures[:, 1]]
        R = targets[:, :3, :3] @ ends[:, :3, :3].transpose(0, 2, 1)
        p = targets[:, :3, 3] - (R @ ends[:, :3, 3, None])[..., 0]
        loops = np.concatenate([rotation_vector(R), p / self.length], axis=1)
        return np.concatenate([loops.ravel(), self.gear_q @ q])

    def closure(self, screws: Array) -> Array:
        """(…, 6C + G, n) derivative of the gap by the rates, about the centre, at screws (…, n, 6)."""
        if len(self.closures) == 0:
            return np.broadcast_to(self.gear_v, (*screws.shape[:-2], *self.gear_v.shape))
        difference = self.moves[self.closures[:, 1]] - self.moves[self.closures[:, 0]]
        rows = difference[:, None, :] * self.loop_screws(screws).swapaxes(-1, -2)[..., None, :, :]
        rows = rows.reshape(*screws.shape[:-2], -1, self.rates)
        gears = np.broadcast_to(self.gear_v, (*screws.shape[:-2], *self.gear_v.shape))
        return np.concatenate([rows, gears], axis=-2)

    def loop_screws(self, screws: Array) -> Array:
        """(…, n, 6) what the rates at these screws do to loops that they are in: displacements over `length`."""
        return np.asarray(screws / self._row_scale)

    def closure_at(self, q: Array) -> Array:
        """(6C + G, n) derivative of the gap by the rates at positions (nq,)."""
        return self.closure(self.screws(self.poses(q)))

    def joints_of(self, rates: Iterable[int]) -> tuple[str, ...]:
        """Names of the joints that have any of these rates, in order."""
        wanted = set(rates)
        return tuple(slot.name for slot in self.slots if not wanted.isdisjoint(range(slot.v.start, slot.v.stop)))

    def closure_bias(self, accelerations: Array) -> Array:
        """(6C + G,) what the loops gain in acceleration from the links' (L, 6) at rates held fixed."""
        loops = (accelerations[self.closures[:, 1]] - accelerations[self.closures[:, 0]]) / self._row_scale
        return np.concatenate([loops.ravel(), np.zeros(len(self.gear_v))])

    @property
    def _row_scale(self) -> Array:
        return np.array([1.0, 1.0, 1.0, self.length, self.length, self.length])


def _range(slots: slice) -> range:
    return range(slots.start, slots.stop)


def _ball_motion(ball: BallLink, q: Array) -> Array:
    R = to_matrix(q[ball.q : ball.q + 4])
    X = np.eye(4)
    X[:3, :3] = R if ball.forward else R.T
    X[:3, 3] = ball.point - X[:3, :3] @ ball.point
    return X


def _turned(q: Array, step: Array) -> Array:
    """Quaternion after a turn by the rotation vector `step` in the axes of the first body."""
    angle = float(np.linalg.norm(step))
    half = 0.5 * step * np.sinc(0.5 * angle / np.pi)
    turned = multiply(np.concatenate([[np.cos(0.5 * angle)], half]), q)
    return np.asarray(turned / np.linalg.norm(turned))
