"""The freedoms of an assembly as motions to look at: one a driving joint, with every loop kept closed.

Each has one joint that drives it while the other drivers rest: those that the mobility names, or, where it names none,
columns of its basis chosen by pivoted QR. Bodies move by products of exponentials of the joints' twists; loops are
closed by Gauss–Newton steps with the driver held. What does not close is not shown further.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property, reduce

import numpy as np

from kinform.foundation.algebra.displacements import carry, displacement, exponentials, inverse
from kinform.foundation.graphs.graph import forest
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.model.kinematics import Freedom, Joint, Kinematics
from kinform.reports.page.constants import SHOWN_TURN, SIDE_FRAMES

FINEST_TURN = math.radians(3.0)
"""rad, of one step: the eye sees larger ones as jumps."""
FULL_TURN = 2.0 * math.pi
"""rad: no turn is shown further."""
SHOWN_SLIDE = 0.14
"""Greatest slide of such a driver as a share of the assembly's size; a choice."""
FOLLOWER_TURN = 1.4
"""No joint turns further than this times SHOWN_TURN at the rates of the start."""
LARGE_SHARE = 0.25
"""Share of the way that assemblies go whose motion is shown at first order only."""
CLOSED = 1e-5
"""rad, and share of the size, by which a loop may miss."""
CLOSED_WELL = 1e-8
"""At this gap no further step is taken: a thousandth of what may be missed."""
MOST_CLOSING_STEPS = 8
"""Gauss–Newton steps; from a neighbouring pose three or four are usual."""
SLOPE_RANK = 1e-7
"""Singular values of the slopes below this share of the greatest count as zero: the slopes of loops that are nearly
closed are known to about the square root of what they miss."""
FREEDOM_RANK = 1e-7
"""Pivots of joint rates below this share of the greatest count as zero."""
LEAST_MOVE = 1e-6
"""Share of the size by which a body moves that is said to move."""
LEAST_RATE_ERROR = 1e-9
"""A coordinate whose rate differs from ±1 by less is the driver's; rates are exact up to rounding."""
MOST_COORDINATES = 240
"""Assemblies with loops and more joint coordinates than this are shown at first order only: closing them is slow."""
MOST_FREEDOMS = 60
"""Freedoms that are shown."""


@dataclass(frozen=True, eq=False)
class Showing:
    """One freedom, moved to and fro."""

    driver: str | None
    """Joint that drives it; None where only a body is known to move."""
    turns: bool
    bodies: tuple[str, ...]
    """What moves."""
    poses: Array
    """(F, B, 4, 4) motion of each body from where the meshes are, in the world."""
    shares: Array
    """(F,) of the way, from −1 through 0, the pose of the meshes, to 1."""
    note: str
    """How far it can be trusted; empty where the loops stay closed."""
    ends: tuple[float, float] = (0.0, 0.0)
    """Values of the driver at −1 and 1 (rad or m)."""


@dataclass(frozen=True)
class Span:
    """Values of a joint (rad or m) between which it is shown; None: kinform chooses."""

    lower: float | None = None
    upper: float | None = None


def freedom_motions(kinematics: Kinematics, size: float, spans: Mapping[str, Span] | None = None) -> list[Showing]:
    """Each freedom of the assembly of this size (m) as a motion; `spans` of joints by name."""
    freedoms = kinematics.mobility.freedoms
    if not len(freedoms):
        return []
    linkage = _Linkage(kinematics, size, spans or {})
    rates = linkage.rates(freedoms)
    led = [found for freedom in kinematics.mobility.named if (found := linkage.led(freedom)) is not None]
    if led:
        out = [linkage.shown(own, driver) for own, driver in led[:MOST_FREEDOMS]]
        return out + _loose(kinematics, freedoms, len(led), rates, size)[: MOST_FREEDOMS - len(out)]
    drivers, mixes = _drivers(rates, linkage.turning, size)
    out = [linkage.shown(mix @ rates, driver) for driver, mix in list(zip(drivers, mixes, strict=True))[:MOST_FREEDOMS]]
    return out + _loose(kinematics, freedoms, len(drivers), rates, size)[: MOST_FREEDOMS - len(out)]


def _drivers(rates: Array, turning: Array, size: float) -> tuple[list[int], Array]:
    """Coordinates that can drive, and the mixes of freedoms (d, m) in which one of them moves alone at rate 1."""
    if not rates.shape[1]:
        return [], np.zeros((0, len(rates)))
    from scipy.linalg import qr

    weighted = rates * np.where(turning, 1.0, 1.0 / size)
    _, triangle, order = qr(weighted, mode="economic", pivoting=True)
    diagonal = np.abs(np.diag(triangle))
    rank = int(np.count_nonzero(diagonal > FREEDOM_RANK * max(float(diagonal.max(initial=0.0)), 1e-300)))
    chosen = np.sort(order[:rank])
    return [int(k) for k in chosen], np.asarray(np.linalg.pinv(rates[:, chosen]), dtype=np.float64)


def _loose(kinematics: Kinematics, freedoms: Array, driven: int, rates: Array, size: float) -> list[Showing]:
    """Freedoms in which no joint moves: bodies that nothing connects to ground, as a slide or a turn."""
    if driven >= len(freedoms):
        return []
    still = np.linalg.svd(rates.T)[2][driven:] if rates.shape[1] else np.eye(len(freedoms))
    shown = []
    for mix in still:
        twists = np.einsum("m,mbi->bi", mix, freedoms)
        extent = max(float(np.abs(twists[:, 3:]).max()) / size, float(np.abs(twists[:, :3]).max()), 1e-300)
        shares = np.linspace(-1.0, 1.0, 2 * SIDE_FRAMES + 1)
        poses = np.array([[displacement(t * SHOWN_SLIDE * s / extent) for t in twists] for s in shares])
        turns = bool(np.abs(twists[:, :3]).max() * size > np.abs(twists[:, 3:]).max())
        note = "no joint connects what moves to ground"
        shown.append(Showing(None, turns, _moving(kinematics, poses, size), poses, shares, note))
    return shown


def _moving(kinematics: Kinematics, poses: Array, size: float) -> tuple[str, ...]:
    far = np.abs(poses - np.eye(4)).max(axis=(0, 2, 3)) > LEAST_MOVE * max(size, 1e-300)
    return tuple(body.name for body, moves in zip(kinematics.bodies, far, strict=True) if moves)


class _Linkage:
    """Bodies on a spanning tree of joints, each joint a chain of its twists."""

    def __init__(self, kinematics: Kinematics, size: float, spans: Mapping[str, Span]):
        self.kinematics = kinematics
        self.size = size
        self.spans = spans
        number = {body.name: k for k, body in enumerate(kinematics.bodies)}
        self.joints: list[Joint] = [j for j in kinematics.joints if len(j.twists) == j.freedoms]
        self.edges = [(number[j.bodies[0]], number[j.bodies[1]]) for j in self.joints]
        ground = next((k for k, body in enumerate(kinematics.bodies) if body.ground), 0)
        self.tree = forest(len(number), self.edges, ground)
        used = set(self.tree.edge)
        self.chords = [k for k in range(len(self.edges)) if k not in used]
        self.start = np.concatenate([[0], np.cumsum([j.freedoms for j in self.joints])]).astype(int)
        twists = [j.twists for j in self.joints]
        self.screws = np.concatenate([np.zeros((0, 6)), *twists])
        self.turning = np.linalg.norm(self.screws[:, :3], axis=1) > 1e-12
        self.speed = np.where(self.turning, np.linalg.norm(self.screws[:, :3], axis=1), 1.0)
        self.units = self.screws / self.speed[:, None]
        self.owner = np.repeat(np.arange(len(self.joints)), [j.freedoms for j in self.joints])

    def rates(self, freedoms: Array) -> Array:
        """(m, n) joint rates of body twists (m, B, 6)."""
        out = np.zeros((len(freedoms), len(self.screws)))
        for k, (a, b) in enumerate(self.edges):
            span = slice(self.start[k], self.start[k + 1])
            if span.stop > span.start:
                out[:, span] = (freedoms[:, b] - freedoms[:, a]) @ np.linalg.pinv(self.screws[span])
        return out

    def led(self, freedom: Freedom) -> tuple[Array, int] | None:
        """Joint rates (n,) of a named freedom, and the coordinate that drives it; None without a driver."""
        number = {joint.name: k for k, joint in enumerate(self.joints)}
        rates, driver = np.zeros(len(self.screws)), None
        for name, coordinate, rate in freedom.drives:
            if name not in number:
                return None
            at = int(self.start[number[name]]) + coordinate
            rates[at] = rate
            if name == freedom.driver and abs(abs(rate) - 1.0) < LEAST_RATE_ERROR:
                driver = at if driver is None else driver
        return None if driver is None else (rates, driver)

    def shown(self, rates: Array, driver: int) -> Showing:
        """The motion that the driver leads, as far to both sides as its span says and the loops close."""
        rates = rates / rates[driver]
        joint = self.joints[self.owner[driver]]
        turns = bool(self.turning[driver])
        span = self.spans.get(joint.name, Span())
        poses, shares, note, ends = [], [], "", []
        for sign, end in ((-1.0, span.lower), (1.0, span.upper)):
            reach = self._reach(rates, turns, end)
            many = max(SIDE_FRAMES, int(np.ceil(reach / FINEST_TURN))) if turns else SIDE_FRAMES
            steps = np.linspace(0.0, 1.0, many + 1)
            followed, why = self._followed(rates, driver, sign * reach * steps)
            note = note or why
            poses.append(followed)
            shares.append(sign * steps)
            ends.append(sign * reach)
        every = np.concatenate([poses[0][:0:-1], poses[1]])
        return Showing(
            joint.name, turns, _moving(self.kinematics, every, self.size), every,
            np.concatenate([shares[0][:0:-1], shares[1]]), note, (ends[0], ends[1]),
        )  # fmt: skip

    def _reach(self, rates: Array, turns: bool, end: float | None) -> float:
        """How far the driver goes to one side (rad or m, positive)."""
        if end is not None:
            return float(min(abs(end), FULL_TURN if turns else self.size))
        reach = float(SHOWN_TURN if turns else SHOWN_SLIDE * self.size)
        return float(
            min(
                reach,
                FOLLOWER_TURN * SHOWN_TURN / max(float(np.abs(rates[self.turning]).max(initial=0.0)), 1e-300),
            )
        )

    def _followed(self, rates: Array, driver: int, steps: Array) -> tuple[Array, str]:
        """Poses (S, B, 4, 4) at the driver's steps; the last closed pose again where loops do not close."""
        large = bool(self.chords) and len(self.screws) > MOST_COORDINATES
        q, poses, note = np.zeros(len(self.screws)), [self.poses(np.zeros(len(self.screws)))], ""
        for before, now in zip(steps[:-1], steps[1:], strict=True):
            if note:
                poses.append(poses[-1])
                continue
            q = q + (now - before) * rates
            if large:
                q = LARGE_SHARE * now * rates
            elif self.chords:
                closed = self._closed(q, driver)
                if closed is None:
                    note = "the loops do not close any further"
                    poses.append(poses[-1])
                    continue
                q = closed
            poses.append(self.poses(q))
        return np.array(poses), "at first order: the loops are too many to be closed" if large else note

    def poses(self, q: Array) -> Array:
        """(B, 4, 4) motion of each body at joint coordinates q."""
        return self._moved(self._across(self._steps(q)))

    def _steps(self, q: Array) -> list[Array]:
        """(4, 4) of each coordinate, from where the meshes are."""
        out, moving = [np.eye(4)] * len(q), np.flatnonzero(q)
        if len(moving):
            angles = np.where(self.turning, self.speed * q, q)
            for i, step in zip(moving, exponentials(self.units[moving], angles[None, moving])[0], strict=True):
                out[i] = step
        return out

    def _across(self, steps: list[Array]) -> Array:
        """(J, 4, 4) of each joint: its second body in the first, from where the meshes are."""
        spans = zip(self.start, self.start[1:], strict=False)
        made = [reduce(np.matmul, steps[first:last]) if last > first else np.eye(4) for first, last in spans]
        return np.array(made).reshape(-1, 4, 4)

    def _moved(self, across: Array) -> Array:
        """(B, 4, 4) motion of each body, from that of each joint."""
        out = np.broadcast_to(np.eye(4), (len(self.tree.parent), 4, 4)).copy()
        steps = np.concatenate([across, inverse(across)])
        for nodes, before, own in self._levels:
            out[nodes] = out[before] @ steps[own]
        return out

    @cached_property
    def _levels(self) -> list[tuple[Ints, Ints, Ints]]:
        """Bodies as far from the root as each other, those before them, and the numbers of the joints between, of those
        that lead back more by as many as there are."""
        tree = self.tree
        depth: dict[int, int] = {}
        levels: dict[int, list[tuple[int, int, int]]] = {}
        for node in tree.order:
            k = tree.edge[node]
            depth[node] = 0 if k < 0 else depth[tree.parent[node]] + 1
            if k >= 0:
                own = k if self.edges[k][1] == node else len(self.edges) + k
                levels.setdefault(depth[node], []).append((node, tree.parent[node], own))
        every = [np.array(level) for _, level in sorted(levels.items())]
        return [(level[:, 0], level[:, 1], level[:, 2]) for level in every]

    def _missing(self, across: Array, poses: Array) -> Array:
        """(6 chords,) by how much the loops are open: turns (rad), then distances over the size."""
        out, back = [], inverse(poses)
        for k in self.chords:
            a, b = self.edges[k]
            gap = poses[a] @ across[k] @ back[b]
            turn = 0.5 * (gap[:3, :3] - gap[:3, :3].T)
            out += [turn[2, 1], turn[0, 2], turn[1, 0], *(gap[:3, 3] / self.size)]
        return np.array(out)

    def _slopes(self, steps: list[Array], poses: Array) -> Array:
        """(6 chords, n) of `_missing` by the coordinates, where loops are nearly closed: a coordinate turns what comes
        after it on its way about its screw, carried to where that is now."""
        carried = np.empty((len(steps), 4, 4))
        for k, (a, _) in enumerate(self.edges):
            before = poses[a]
            for i in range(self.start[k], self.start[k + 1]):
                carried[i] = before
                before = before @ steps[i] if self.start[k + 1] - i > 1 else before
        screws = carry(carried, self.screws)
        out = np.zeros((len(self.chords), 6, len(steps)))
        for row, k in zip(out, self.chords, strict=True):
            for end, sign in zip(self.edges[k], (1.0, -1.0), strict=True):
                node = end
                while (edge := self.tree.edge[node]) >= 0:
                    forward = 1.0 if self.edges[edge][1] == node else -1.0
                    span = slice(self.start[edge], self.start[edge + 1])
                    row[:, span] += sign * forward * screws[span].T
                    node = self.tree.parent[node]
            span = slice(self.start[k], self.start[k + 1])
            row[:, span] += screws[span].T
        out[:, 3:] /= self.size
        return out.reshape(-1, len(steps))

    def _closed(self, q: Array, driver: int) -> Array | None:
        """The nearest closed configuration with the driver where it is."""
        free = np.array([i for i in range(len(q)) if i != driver])
        unit = np.where(self.turning, 1.0, self.size)
        for left in range(MOST_CLOSING_STEPS, -1, -1):
            steps = self._steps(q)
            across = self._across(steps)
            poses = self._moved(across)
            missing = self._missing(across, poses)
            most = float(np.abs(missing).max())
            if not left or most < CLOSED_WELL:
                break
            slope = self._slopes(steps, poses)[:, free] * unit[free]
            step = np.linalg.lstsq(slope, -missing, rcond=SLOPE_RANK)[0]
            q = q.copy()
            q[free] += step * unit[free]
        return q if most < CLOSED else None
