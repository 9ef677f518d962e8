"""All contact between two parts, and what it costs to part them by each of many joints, asked at once.

A joint's motions are a few twists. Numbers are taken for all joints at all points, column by column: what one joint is
told does not depend on those that are asked with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from kinform.foundation.algebra.vectors import cross, dot, lengths, norm, widest_gap
from kinform.foundation.rounding import SINGLE, SOLVED, TINY
from kinform.frozen import dataclass
from kinform.kinematics.partition.constants import COAXIAL_OFF, PARTED, SAME_AXIS
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch
from kinform.model.function import IntendedJoint
from kinform.model.names import PartName

OPPOSED = 0.03
"""Share of the local speed that a normal may oppose, and still slide on itself. Chosen, not measured."""
SLOW = 1e-4
"""The same as a share of the greatest speed in the contact: near the axis nothing moves. Chosen, not measured."""
OPPOSED_AREA = 0.05
"""Share of the area between two parts that may oppose a joint that parts them: scraps decide nothing. Chosen, not
measured."""
JOURNAL = 40.0
"""Price of parting a journal, a collar or a guide. Prices have no unit: only their order counts (`constants`)."""
LOOSE_JOURNAL = 35.0
"""The same of one with play: a pin turns where it is loose and stays where it is tight. Less than `EITHER` below a
journal, so that it is listed: which side a pin goes with is for its maker to say."""
LOOSE = 2e-3
"""Play of a journal as a share of its radius from which it is loose: a running fit (ISO 286, H7/g6) has as much from
10 mm down."""
FACE_ROUND = 30.0
"""Price of parting a face that goes round the axis, without a journal. Less than a journal: most models end at a flush
face, and what is inside of a servo is its own. With 1 for the journal 155 of 204 bodies of 17 robots came out whole,
with 40 168, on no robot fewer; whichever robot is left out, the others choose 40."""
FLAT_BESIDE = 300.0
"""Price of separating a flat beside the axis, and of breaking contact at points or along lines that no joint may
separate: that holds no more than a flat. With 100 as many joints of rings of bodies are found without any name as with
20000, but one that is asked."""
FLAT_APART = 50.0
"""The same of one that does not touch: the tip of a screw over the face of a motor. Chosen, not measured."""
APART = 0.05
"""Gap of a flat from which it does not touch, as a share of the root of its area. Chosen, not measured."""
JOURNAL_OFF = 0.7
"""Share of its reach by which the middle of a round patch may lie beside the axis that it goes round: half of one."""
FACE_OFF = 0.5
"""Distance from the axis of a joint to the middle of a face that goes round it, as a share of the reach of the face.
Chosen, not measured."""
ROLLING = 1.0
"""Price of parting what touches at points or along lines only: balls, rollers, teeth hold nothing together."""
NUMBERS_AT_ONCE = 8192
"""Joints times points of a contact that are looked at together: their columns stay in the cache."""


PartPair = tuple[PartName, PartName]

ROUND = ("cylinder", "cone", "sphere", "torus", "revolution", "helicoid")
"""Kinds of patches that bear a turn."""
UNKNOWN = ("freeform", "other")
"""Kinds of patches on facets of no known surface."""


@dataclass(frozen=True, eq=False)
class Axes:
    """The axes of joints that turn, or their centres."""

    centres: Array
    """(k, 3) m: a point of each."""
    directions: Array
    """(k, 3) unit; zero of a centre."""
    ball: Flags
    """(k,) whether it is a centre."""

    @staticmethod
    def of(joints: Sequence[IntendedJoint]) -> Axes:
        """Of joints some of which may have none, in whose rows nothing is meant."""
        nothing = np.zeros(3)
        ball = [joint.type == "spherical" or joint.axis is None for joint in joints]
        directions = [
            nothing if centre or joint.axis is None else joint.axis / norm(joint.axis)
            for joint, centre in zip(joints, ball, strict=True)
        ]
        centres = [nothing if joint.point is None else joint.point for joint in joints]
        return Axes(np.array(centres).reshape(-1, 3), np.array(directions).reshape(-1, 3), np.array(ball, dtype=bool))

    def some(self, rows: Ints) -> Axes:
        """Those of these numbers."""
        return Axes(self.centres[rows], self.directions[rows], self.ball[rows])


@dataclass(frozen=True, eq=False)
class Asked:
    """Joints that may part what touches."""

    numbers: tuple[int, ...]
    joints: tuple[IntendedJoint, ...]
    motions: tuple[Array, ...]
    """(k, 6) of each, k > 0, as `parting.joint_twists` has them."""
    first: Array
    """(joints, 6) the first motion of each."""
    more: Flags
    """(joints,) whether it has others."""
    about: Flags
    """(joints,) whether it turns about an axis or a centre that has a place."""
    axes: Axes

    @staticmethod
    def of(joints: Sequence[IntendedJoint], twists: Sequence[Array | None]) -> Asked:
        """Of these joints those that say where their motions are, and have any."""
        some = [(k, motions) for k, motions in enumerate(twists) if motions is not None and len(motions)]
        those = tuple(joints[k] for k, _ in some)
        turns = [bool(motions[:, :3].any()) for _, motions in some]
        return Asked(
            tuple(k for k, _ in some),
            those,
            tuple(motions for _, motions in some),
            np.array([motions[0] for _, motions in some]).reshape(-1, 6),
            np.array([len(motions) > 1 for _, motions in some], dtype=bool),
            np.array([turn and joint.type != "planar" for turn, joint in zip(turns, those, strict=True)], dtype=bool),
            Axes.of(those),
        )


def contact_of_pairs(patches: Sequence[Patch]) -> dict[PartPair, Contact]:
    """All contact of each pair of parts, sorted by their names."""
    between: dict[PartPair, list[Patch]] = {}
    for patch in patches:
        if not (patch.narrow or patch.unknown):
            between.setdefault(patch.parts, []).append(patch)
    return {pair: Contact.of(between[pair]) for pair in sorted(between)}


def near_each(joints: Sequence[IntendedJoint], contacts: Sequence[Contact]) -> Flags:
    """(j, c) whether the axis, or centre, of each of some joints passes through the ball round each contact."""
    out = np.empty((len(joints), len(contacts)), dtype=bool)
    middles = np.array([contact.ball[0] for contact in contacts]).reshape(-1, 3)
    radii = np.array([contact.ball[1] for contact in contacts])
    for row, joint in zip(out, joints, strict=True):
        assert joint.point is not None
        arms = middles - joint.point
        if joint.axis is not None:
            arms -= dot(arms, np.broadcast_to(joint.axis, arms.shape))[:, None] * joint.axis
        np.less_equal(lengths(arms), radii, out=row)
    return out


@dataclass(frozen=True, eq=False)
class Contact:
    """All contact of a pair of parts."""

    patches: tuple[Patch, ...]
    points: Array
    normals: Array
    weights: Array
    start: Ints

    @staticmethod
    def of(patches: Sequence[Patch]) -> Contact:
        return Contact(
            tuple(patches),
            np.concatenate([patch.points for patch in patches]),
            np.concatenate([patch.normals for patch in patches]),
            np.concatenate([patch.weights for patch in patches]),
            np.cumsum([0, *(len(patch.points) for patch in patches)]),
        )

    @property
    def slight(self) -> bool:
        """Whether it is at points or along lines only."""
        return all(patch.kind in ("point", "line") for patch in self.patches)

    @cached_property
    def ball(self) -> tuple[Array, float]:
        """Middle (3,) m and radius (m) of the ball round the box of its points."""
        low, high = self.points.min(axis=0), self.points.max(axis=0)
        return 0.5 * (low + high), 0.5 * norm(high - low)

    def near(self, joint: IntendedJoint) -> bool:
        """Whether the joint's axis, or centre, passes through the ball round the contact."""
        return bool(near_each([joint], [self])[0, 0])

    def costs(self, asked: Asked) -> dict[int, float]:
        """What it costs to part them by each of the joints that may, by number."""
        total = float(self.weights.sum())
        if not asked.numbers or total <= 0.0:
            return {}
        if all(patch.kind not in UNKNOWN for patch in self.patches):  # serrations would not count
            many = len(asked.first) * len(self.points) > NUMBERS_AT_ONCE
            among = np.flatnonzero(~self._surely_opposed(asked.first)) if many else np.arange(len(asked.first))
            opposed = self._opposed(asked.first[among])
            little = np.flatnonzero(self._little(opposed))
            among, opposed = among[little], opposed[little]
        else:
            among, opposed = np.arange(len(asked.first)), self._opposed(asked.first)
        for row in np.flatnonzero(asked.more[among]).tolist():
            opposed[row] |= self._opposed(asked.motions[among[row]][1:]).any(axis=0)
        about = np.flatnonzero(asked.about[among])
        axes = asked.axes.some(among[about])
        serrated = np.zeros_like(opposed)
        serrated[about] = self._serrated(axes)
        may = np.flatnonzero(self._little(opposed & ~serrated)).tolist()
        numbers = [asked.numbers[k] for k in among.tolist()]
        if self.slight:
            return dict.fromkeys([numbers[k] for k in may], ROLLING)
        round_ = dict(zip(about.tolist(), self._round(axes, opposed[about], serrated[about]), strict=True))
        out = {}
        for k in may:
            one = int(among[k])
            if k in round_:
                out[numbers[k]] = round_[k]
            elif asked.joints[one].type == "planar":
                out[numbers[k]] = JOURNAL  # a flat across its normal, wherever it lies
            else:
                out[numbers[k]] = self._guided(asked.joints[one], opposed[k])
        return out

    def journal(self, joint: IntendedJoint) -> bool:
        """Whether any of it goes round the joint's axis, or its centre."""
        axes = Axes.of([joint])
        return bool(self._journals(axes, self._off(axes)).any())

    @cached_property
    def _filled(self) -> list[int]:
        """The patches that have points."""
        return [k for k, patch in enumerate(self.patches) if len(patch.points)]

    @cached_property
    def _first(self) -> Ints:
        """The first points of those."""
        return np.asarray(self.start[self._filled])

    @cached_property
    def _areas(self) -> Array:
        """m² of those."""
        return np.array([float(self.patches[k].weights.sum()) for k in self._filled])

    def _surely_opposed(self, motions: Array) -> Flags:
        """(k,) of which of k motions (k, 6) some of the points tell that they press on, or leave, more than next to
        none of the area, or that it is not `_little`: of thousands of joints most are elsewhere, and do."""
        # One of so many points of a contact is asked about all joints before all are: a fifth has several times that
        # share.
        some = slice(None, None, 5)
        middle, radius = self.ball
        way = motions[:, 3:] + cross(motions[:, :3], np.broadcast_to(middle, (len(motions), 3)))
        # no point of the ball is faster
        fastest = (1.0 + SOLVED) * (lengths(way) + lengths(motions[:, :3]) * radius)
        area = self._pressed(motions, self.points[some], self.normals[some], fastest) @ self.weights[some]
        return np.asarray(area > (1.0 + SINGLE) * OPPOSED_AREA * float(self.weights.sum()))

    def _opposed(self, motions: Array) -> Flags:
        """(k, n) whether each of k motions (k, 6) presses on each point or leaves it."""
        return self._pressed(motions, self.points, self.normals, None)

    @staticmethod
    def _pressed(motions: Array, points: Array, normals: Array, fastest: Array | None) -> Flags:
        """(k, n) the same of points (n, 3) with their normals; `fastest` (k,): what is slow is so beside that, instead
        of beside the fastest of the points."""
        out = np.empty((len(motions), len(points)), dtype=bool)
        (x, y, z), (a, b, c) = (np.ascontiguousarray(rows.T) for rows in (points, normals))
        for some in _blocks(*out.shape):
            p, q, r, u, v, w = motions[some].T[:, :, None]
            forth, side, up = u + (q * z - r * y), v + (r * x - p * z), w + (p * y - q * x)
            pace = np.sqrt(forth * forth + side * side + up * up)
            most = pace.max(axis=1, initial=0.0, keepdims=True) if fastest is None else fastest[some, None]
            bound = OPPOSED * pace + SLOW * most
            np.greater(np.abs(forth * a + up * c + side * b), bound, out=out[some])
        return out

    def _little(self, flags: Flags) -> Flags:
        """(k,) whether the points of each of k rows of flags (k, n) have next to none of the area."""
        area, total = flags @ self.weights, float(self.weights.sum())
        limit = OPPOSED_AREA * total
        for k in np.flatnonzero(np.abs(area - limit) <= SOLVED * total):
            area[k] = self.weights[flags[k]].sum()  # shares that are meant to be equal hang on no order
        return np.asarray(area <= limit)

    def _serrated(self, axes: Axes) -> Flags:
        """(k, n) points on facets of no known surface that go round each axis: serrations of a servo's output, which is
        one mesh with the servo, in what it turns."""
        unknown = np.array([self.patches[k].kind in UNKNOWN for k in self._filled], dtype=bool)
        if not unknown.any() or not len(axes.centres):
            return np.zeros((len(axes.centres), len(self.points)), dtype=bool)
        counts = np.diff([*self._first.tolist(), len(self.points)])
        return np.asarray(np.repeat(unknown & (self._off(axes) < FACE_OFF), counts, axis=1))

    def _off(self, axes: Axes) -> Array:
        """(k, patches that have points) how far the middle of each patch lies beside each axis, or centre, as a share
        of its reach from there."""
        out = np.empty((len(axes.centres), len(self._filled)))
        points = np.ascontiguousarray(self.points.T)
        for some in _blocks(len(out), len(self.points)):
            centres, (p, q, r) = axes.centres[some].T[:, :, None], axes.directions[some].T[:, :, None]
            x, y, z = (column - centre for column, centre in zip(points, centres, strict=True))
            along = x * p + y * q + z * r
            arms = [x - along * p, y - along * q, z - along * r]
            reach = np.sqrt(np.maximum.reduceat(_squares(arms), self._first, axis=1))
            middle = [np.add.reduceat(arm * self.weights, self._first, axis=1) for arm in arms]
            out[some] = np.sqrt(_squares(middle)) / np.maximum(self._areas, TINY) / np.maximum(reach, TINY)
        return out

    def _journals(self, axes: Axes, off: Array) -> Flags:
        """(k, patches that have points) whether each patch goes round each axis, or its centre, which it lies `off`
        by: as it is, or as what it lies on does, a surface of revolution about the axis, or a sphere about the
        centre."""
        patches = [self.patches[k] for k in self._filled]
        turning = np.array([patch.kind in ROUND for patch in patches], dtype=bool)
        if not turning.any():
            return np.zeros(off.shape, dtype=bool)
        x, y, z = np.array([patch.point for patch in patches]).T[:, None] - axes.centres.T[:, :, None]
        p, q, r = axes.directions.T[:, :, None]
        along = x * p + y * q + z * r
        far = np.sqrt(_squares([x - along * p, y - along * q, z - along * r]))
        size = np.array([max(patch.radii, default=0.0) for patch in patches])
        u, v, w = np.array([patch.axis for patch in patches]).T[:, None]
        sphere = np.array([patch.kind == "sphere" for patch in patches], dtype=bool)
        lies = np.where(axes.ball[:, None], sphere, np.abs(u * p + v * q + w * r) > np.cos(SAME_AXIS))
        return np.asarray(turning & ((off < JOURNAL_OFF) | (lies & (far < COAXIAL_OFF * size))))

    def _round(self, axes: Axes, opposed: Flags, serrated: Flags) -> list[float]:
        """The price along a turn about each axis: do patches go round it, or its centre?"""
        if not len(opposed):
            return []
        patches = [self.patches[k] for k in self._filled]
        pressed = np.logical_or.reduceat(opposed, self._first, axis=1)
        counts = ~pressed & (self._areas >= OPPOSED_AREA * float(self.weights.sum()))
        off = self._off(axes)
        journals = counts & self._journals(axes, off)
        journal = journals.any(axis=1)
        firm = (journals & [not _loose(patch) for patch in patches]).any(axis=1)
        apart = ([_apart(patch) for patch in patches] | ~counts).all(axis=1)
        round_it = ((off < FACE_OFF) | ~counts).all(axis=1)
        flat = np.where(apart, FLAT_APART, FLAT_BESIDE)
        price = np.where(journal | round_it, FACE_ROUND, flat)
        price = np.where(journal & round_it, np.where(firm, JOURNAL, LOOSE_JOURNAL), price)
        held = (opposed & serrated).any(axis=1)
        return [float(one) for one in np.where(held, np.maximum(price, PARTED), price)]

    def _guided(self, joint: IntendedJoint, opposed: Flags) -> float:
        """The price along a slide: do faces that run along it stand round it?"""
        assert joint.axis is not None
        axis = joint.axis / norm(joint.axis)
        gap = widest_gap(self.normals[~opposed], axis)
        # rad: normals of a guide leave no wider gap round it than this.
        return JOURNAL if gap < np.radians(181.0) else FLAT_BESIDE


def _squares(columns: Sequence[Array]) -> Array:
    x, y, z = columns
    return np.asarray(x * x + y * y + z * z)


def _blocks(rows: int, wide: int) -> list[slice]:
    """Rows that stay in the cache together."""
    step = max(1, NUMBERS_AT_ONCE // max(wide, 1))
    return [slice(k, k + step) for k in range(0, rows, step)]


def _apart(patch: Patch) -> bool:
    """Whether a flat has a gap that is wide by its own size."""
    return patch.kind == "plane" and patch.gap > patch.chord + APART * patch.area**0.5


def _loose(patch: Patch) -> bool:
    """Whether a journal has play that its facets do not explain."""
    return patch.gap > patch.chord + LOOSE * max(patch.radii, default=0.0)
