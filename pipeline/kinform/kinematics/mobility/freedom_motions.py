"""The freedoms of an assembly as motions over a distance: each driven by one coordinate of one joint.

The drivers are those that the mobility names, or, where it names none, columns of its basis that pivoted QR chooses.
Along a motion the loops are closed again and again with the driver held (`mechanism.closing`); the drivers of other
freedoms rest. Freedoms in which no joint moves are twists of bodies that nothing connects with ground.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.displacements import displacement
from kinform.foundation.rounding import SINGLE, SOLVED, TINY
from kinform.frozen import dataclass
from kinform.mechanism.closing import close
from kinform.mechanism.constants import FREE
from kinform.mechanism.joint_graph import JointGraph
from kinform.mechanism.linkage import Coordinate, Linkage, linkage
from kinform.model.arrays import Array, Flags
from kinform.model.kinematics import Freedom, Kinematics

LEAST_MOVE = SINGLE
"""Share of the size by which a body moves that is said to move."""


@dataclass(frozen=True, eq=False)
class DrivenFreedom:
    """One freedom, in the linkage of all joints that move with it and of the loops that these are in."""

    linkage: Linkage
    driver: int
    """Coordinate that drives it."""
    rates: Array
    """(n,) of the coordinates, at a rate of 1 (rad/s or m/s) of the driving joint."""
    drivers: Flags
    """(n,) coordinates that drive any of the freedoms."""

    @property
    def coordinate(self) -> Coordinate:
        """That drives it."""
        return self.linkage.coordinates[self.driver]

    @property
    def fastest_turn(self) -> float:
        """Greatest rate of an angle (rad for 1 rad or m of the driver)."""
        return float(np.abs(self.rates[self.linkage.turns]).max(initial=0.0))

    def by(self, joint: str) -> DrivenFreedom | None:
        """The same freedom driven by another joint of one coordinate; None where that rests in it."""
        at = [k for k, one in enumerate(self.linkage.coordinates) if one.joint == joint]
        if len(at) != 1 or self.rates[at[0]] == 0.0:
            return None
        k = at[0]
        drivers = self.drivers.copy()
        drivers[self.driver], drivers[k] = False, True
        return DrivenFreedom(self.linkage, k, self.rates * (self.linkage.coordinates[k].unit / self.rates[k]), drivers)

    def at_first_order(self, values: Array) -> Array:
        """(S, n) coordinates at values (S,) of the driver, loops left open."""
        return values[:, None] * self.rates

    def followed(self, values: Array) -> Array:
        """Coordinates (S′, n) at the first S′ of the values (S,) of the driver, up to which all loops close; the first
        value is 0, and each is a small step from the one before."""
        q = [np.zeros(len(self.rates))]
        for step in np.diff(values):
            closed = self._closed(q[-1] + step * self.rates)
            if closed is None:
                break
            q.append(closed)
        return np.array(q)

    def _closed(self, q: Array) -> Array | None:
        """The closed configuration near q (n,), with the driver where it is there. The drivers of other freedoms rest;
        where branches meet, and no motion has them at rest, they follow."""
        if not self.linkage.looped:
            return q
        closed = close(self.linkage.system, q[None], self.drivers).one()
        if closed is None:
            closed = close(self.linkage.system, q[None], np.arange(len(q)) == self.driver).one()
        return closed


@dataclass(frozen=True, eq=False)
class _Rates:
    """Joint rates (m, n) of freedoms; columns count the twists of the graph's joints in order."""

    graph: JointGraph
    start: tuple[int, ...]
    """First column of each joint, and their number."""

    @staticmethod
    def of(graph: JointGraph) -> _Rates:
        return _Rates(graph, tuple(np.cumsum([0, *map(len, graph.spaces)]).tolist()))

    def from_twists(self, freedoms: Array) -> Array:
        """(m, n) rates of body twists (m, B, 6)."""
        out = np.zeros((len(freedoms), self.start[-1]))
        for (a, b), space, first in zip(self.graph.edges, self.graph.spaces, self.start, strict=False):
            if len(space):
                out[:, first : first + len(space)] = (freedoms[:, b] - freedoms[:, a]) @ np.linalg.pinv(space)
        return out

    def named(self, freedom: Freedom) -> tuple[Array, int] | None:
        """Rates (n,) of a named freedom, and the column that drives it; None without a driver."""
        number = {joint.name: k for k, joint in enumerate(self.graph.joints)}
        rates, driver = np.zeros(self.start[-1]), None
        for name, place, rate in freedom.drives:
            if name not in number:
                return None
            at = self.start[number[name]] + place
            rates[at] = rate
            if driver is None and name == freedom.driver and abs(abs(rate) - 1.0) < SOLVED:
                driver = at
        return None if driver is None else (rates, driver)

    def chosen(self, rates: Array, size: float) -> list[tuple[Array, int]]:
        """Rates (n,) in which one column moves alone at rate 1, of those that can drive the freedoms (m, n)."""
        if not rates.shape[1]:
            return []
        from scipy.linalg import qr

        screws = np.concatenate(self.graph.spaces)
        turning = np.linalg.norm(screws[:, :3], axis=1) > 0.0
        _, triangle, order = qr(rates * np.where(turning, 1.0, 1.0 / size), mode="economic", pivoting=True)
        diagonal = np.abs(np.diag(triangle))
        rank = int(np.count_nonzero(diagonal > FREE * max(float(diagonal.max(initial=0.0)), TINY)))
        columns = np.sort(order[:rank])
        mixes = np.asarray(np.linalg.pinv(rates[:, columns]), dtype=np.float64)
        return [(mix @ rates, int(column)) for mix, column in zip(mixes, columns, strict=True)]

    def driven(self, rates: Array, driver: int, drivers: Sequence[int], size: float) -> DrivenFreedom:
        """The freedom of these rates (n,), with all loops that they run through; columns of its driver, and of all."""
        owner = np.repeat(np.arange(len(self.graph.joints)), np.diff(self.start))
        moving = set(owner[rates != 0.0].tolist())
        joints = sorted({k for block in self.graph.blocks if moving & set(block) for k in block})
        made = linkage(self.graph, joints, size)
        columns = np.concatenate([np.arange(self.start[k], self.start[k + 1]) for k in joints])
        at = int(np.flatnonzero(columns == driver)[0])
        of_coordinates = made.rates * rates[columns]
        rates = of_coordinates * made.coordinates[at].unit / of_coordinates[at]
        return DrivenFreedom(made, at, rates, np.isin(columns, drivers))


def driven_freedoms(kinematics: Kinematics, size: float, most: int) -> tuple[list[DrivenFreedom], list[Array]]:
    """Freedoms of the assembly of this size (m) with their drivers, `most` at most; then twists (B, 6; ω, v at the
    world's origin) of the bodies in what is left, in which no joint moves."""
    freedoms = kinematics.mobility.freedoms
    if not len(freedoms):
        return [], []
    graph = JointGraph(kinematics.bodies, kinematics.joints)
    of = _Rates.of(graph)
    rates = of.from_twists(freedoms)
    led = [found for freedom in kinematics.mobility.named if (found := of.named(freedom)) is not None]
    led = led or of.chosen(rates, size)
    drivers = [driver for _, driver in led]
    return [of.driven(*one, drivers, size) for one in led[:most]], _loose(freedoms, rates, len(led))


def _loose(freedoms: Array, rates: Array, driven: int) -> list[Array]:
    """Twists (B, 6) in which no joint moves, beside so many freedoms that joints drive."""
    if driven >= len(freedoms):
        return []
    still = np.linalg.svd(rates.T)[2][driven:] if rates.shape[1] else np.eye(len(freedoms))
    return [np.einsum("m,mbi->bi", mix, freedoms) for mix in still]


def turns(twists: Array, size: float) -> bool:
    """Whether bodies of twists (B, 6) rather turn than slide, at this size (m)."""
    return bool(np.abs(twists[:, :3]).max() * size > np.abs(twists[:, 3:]).max())


def displaced(twists: Array, shares: Array, slide: float, size: float) -> Array:
    """(F, B, 4, 4) poses of bodies along their twists (B, 6), at shares (F,) of the way on which the farthest moves by
    `slide` (m, and rad)."""
    extent = max(float(np.abs(twists[:, 3:]).max()) / size, float(np.abs(twists[:, :3]).max()), TINY)
    return np.array([displacement(share * slide / extent * twists) for share in shares])


def moving(kinematics: Kinematics, poses: Array, size: float) -> tuple[str, ...]:
    """Bodies that move in any of the poses (F, B, 4, 4)."""
    far = np.abs(poses - np.eye(4)).max(axis=(0, 2, 3)) > LEAST_MOVE * max(size, TINY)
    return tuple(body.name for body, moves in zip(kinematics.bodies, far, strict=True) if moves)


def looped(kinematics: Kinematics) -> tuple[bool, int]:
    """Whether there are loops, and how many coordinates all joints have."""
    graph = JointGraph(kinematics.bodies, kinematics.joints)
    return bool(graph.loops), sum(map(len, graph.spaces))
