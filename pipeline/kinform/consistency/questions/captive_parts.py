"""Captive parts with clearance: parts between two others that touch only one of them or neither, above all rolling
elements.

Faces that fit touch within the contact tolerance, points and lines within a small share of it: a ball above a table has
no contact. Nor has a ball between two races with clearance on either side, by that count; but it cannot leave, and its
clearance is less than that of parts that fit. Whether such a part carries a load is not known.

A part is captive between two sides where facets of it face facets of either, on opposite sides of it, within the
contact tolerance of the pair, and it or the other part is round there. Flat faces that fit are in contact, and edges
and corners that come near are not meant to carry: a loose plate that hovers askew is reported as loose. What a part
touches may keep it from the other side, or hold it in a bore as a pin: then it belongs to that, and is near the other
from one side only, as the ball above the table. Parts of one group are one; pairs that an assumption keeps apart are no
candidates.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from functools import cached_property
from itertools import combinations

import numpy as np

from kinform.foundation.algebra.screws import Frame, rows
from kinform.foundation.algebra.vectors import dot
from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.meshes.facing_facets import Facing, facing
from kinform.foundation.words import quoted
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.kinematics import Kinematics
from kinform.model.names import PartName

CAPTIVE_FACES = -0.93
"""Greatest cosine between the normals of two facets that face each other, 21°, as of freeform faces that rest on each
other: rounds in coarse meshes have no facets that oppose each other better."""
CAPTIVE_BESIDE = -0.7
"""The same of facets that tell whether one of the two bends there, 45°: the neighbours of a facet of a coarse roller. A
face that stands askew, with an edge near, has one direction within that."""
CAPTIVE_REACH = 1.02
"""Times the contact tolerance that such a part may keep from its sides, as for faces that fit: clearances of exactly
that are common, and rounding must not decide."""
CAPTIVE_BENDS = math.radians(1.0)
"""rad: a face whose facets differ by more is round there; less is rounding of flat ones. Chosen, not measured."""
CAPTIVE_DIGITS = 2
"""Decimals of the coordinates of directions that are distinct: half a degree."""
CAPTIVE_OPPOSED = -0.5
"""Greatest cosine between the directions in which a part has its two sides for it to be between them. A wedge wider
than 60° pushes out what is in it; tapered rollers have 4° to 30°."""
CAPTIVE_HELD = 0.5
"""Cosine from which on a contact keeps a part from going towards the other side: it hangs on what it touches then. The
pockets of cages hold rollers by up to 0.2."""
CAPTIVE_OPPOSES = 0.35
"""Speed, of that of a unit motion of two bodies, at which a part between them is pressed and may hold it: 21°, by which
the facets of a roller that face its race may lean, while the race slides past."""
CAPTIVE_BORE = -0.5
"""Least cosine of the normals of one round contact down to which it does not go round a part: 120°, as half a bore and
less lets the part out. Chosen, not measured."""


_BORES = ("cylinder", "cone", "helicoid")
"""Kinds of contact that go round a part."""


@dataclass(frozen=True, eq=False)
class CaptivePart:
    """A part, or a group of them by its name, between two others with play."""

    name: str
    sides: tuple[str, str]
    """The two, sorted."""
    gaps: tuple[float | None, float | None]
    """m from either; None where it touches."""
    normals: Array
    """(k, 3) out of it, where it faces the first and the second is on the other side."""
    places: Array
    """(k, 3) m: corners of these facets."""

    def words(self) -> str:
        """What is known and what is not, as a sentence without its end."""
        away = [
            (f"{1e3 * gap:.2g} mm", side) for gap, side in zip(self.gaps, self.sides, strict=True) if gap is not None
        ]
        if len(away) == 2:
            (near, first), (other, second) = away
            between = quoted(self.sides) if near == other else f"{quoted([first])} and {other} from {quoted([second])}"
            return (
                f"{quoted([self.name])} keeps {near} from {between}, nearer than the contact tolerance, and touches "
                "neither: whether it carries them is not known"
            )
        ((near, side),) = away
        touched = next(one for one, gap in zip(self.sides, self.gaps, strict=True) if gap is None)
        return (
            f"{quoted([self.name])} touches {quoted([touched])} and keeps {near} from {quoted([side])}, nearer than "
            f"the contact tolerance: whether it carries {quoted([side])} is not known"
        )


@dataclass(frozen=True, eq=False)
class _Faced:
    """Where one part faces another."""

    normals: Array
    """(k, 3) out of the one, distinct."""
    facets: Array
    """(n, 3, 3) m: of the one."""
    number: Ints
    """(n,) which of the normals that of each facet is."""
    gap: float
    """m: the least."""


class CaptiveParts:
    """Those of an assembly; what is asked once is known."""

    def __init__(self, assembly: Assembly, contacts: Contacts):
        self._assembly, self._contacts = assembly, contacts
        self._facing: dict[tuple[str, str], _Faced] = {}
        self._in_bores: set[tuple[str, str]] = set()
        """Units that go round each other."""

    @cached_property
    def units(self) -> dict[str, str]:
        """Each part's group, or the part itself: those that groups share parts of are one, by the first name."""
        names = [str(part.name) for part in self._assembly.parts]
        index = {name: k for k, name in enumerate(names)}
        sets = UnionFind(len(names))
        called: dict[int, list[str]] = defaultdict(list)
        for group in self._assembly.groups:
            for part in group.parts[1:]:
                sets.union(index[group.parts[0]], index[part])
        for group in self._assembly.groups:
            called[sets.find(index[group.parts[0]])].append(str(group.name))
        return {name: min(called.get(sets.find(k), [names[sets.find(k)]])) for name, k in index.items()}

    @cached_property
    def named(self) -> frozenset[str]:
        """Those that the function's joints name, and that which is said to be the ground: none of these is loose."""
        asked = [name for joint in self._assembly.function.joints for name in joint.between]
        asked += [self._assembly.ground] if self._assembly.ground is not None else []
        return frozenset(self.units[part] for name in asked for part in self._assembly.parts_of(name))

    @cached_property
    def _near(self) -> dict[str, dict[str, list[tuple[PartName, PartName]]]]:
        """Of each unit the pairs of parts, its own first, that may come near another unit."""
        out: dict[str, dict[str, list[tuple[PartName, PartName]]]] = defaultdict(lambda: defaultdict(list))
        for first, second in self._contacts.candidates:
            for part, other in ((first, second), (second, first)):
                if self.units[part] != self.units[other]:
                    out[self.units[part]][self.units[other]].append((part, other))
        return out

    @cached_property
    def _touched(self) -> dict[str, dict[str, list[Array]]]:
        """Of each unit the normals (n, 3), out of it, of its contacts with another; none of overlaps."""
        out: dict[str, dict[str, list[Array]]] = defaultdict(lambda: defaultdict(list))
        for patch in self._contacts.patches:
            first, second = (self.units[part] for part in patch.parts)
            out[first][second].append(patch.normals)
            out[second][first].append(-patch.normals)
            if patch.kind in _BORES and float((patch.normals @ patch.normals.T).min(initial=1.0)) <= CAPTIVE_BORE:
                self._in_bores |= {(first, second), (second, first)}
        for overlap in (*self._contacts.interferences, *self._contacts.possible_overlaps):
            first, second = (self.units[part] for part in overlap.parts)
            out[first][second].extend([])
            out[second][first].extend([])
        return out

    def between(self, of: Mapping[str, int], known: Mapping[str, int] | None = None) -> Iterator[CaptivePart]:
        """All that are between two units that are not of one kind, in the order of their names; `of`: the kind of each
        unit, and none of those that do not count. What touches one that does not count is held by that. Of units that
        are `known` to belong together by one number nothing is asked."""
        for name, around in self._loose(of):
            for sides in combinations(around, 2):
                if known is None or len({known[unit] for unit in (name, *sides)}) > 1:
                    yield from self._between(name, sides, of)

    def may_join(self, of: Mapping[str, int]) -> Iterator[list[int]]:
        """Kinds that parts may be between, by boxes alone: all that `between` finds are among them."""
        for _, around in self._loose(of):
            yield [of[unit] for unit in around]

    def _loose(self, of: Mapping[str, int]) -> Iterator[tuple[str, list[str]]]:
        """Units that nothing holds but what counts, in the order of their names, with what is near them and counts, if
        that is of several kinds."""
        for name in sorted(self._near.keys() - self.named):
            around = sorted(unit for unit in self._near[name] if unit in of)
            if len({of[unit] for unit in around}) > 1 and all(unit in of for unit in self._touched[name]):
                yield name, around

    def _between(self, name: str, sides: tuple[str, str], of: Mapping[str, int]) -> Iterator[CaptivePart]:
        (first, second), touched = sides, self._touched[name]
        if of[first] == of[second] or (first in touched and second in touched):
            return
        if not self._in_bores.isdisjoint({(name, first), (name, second)}):
            return
        # of the one that it touches more is near, and mostly the other is not
        if not all(len(self._faced(name, side).facets) for side in sorted(sides, key=touched.__contains__)):
            return
        one, other = self._faced(name, first), self._faced(name, second)
        opposed = one.normals @ other.normals.T <= CAPTIVE_OPPOSED
        opposed &= ~self._held(name, one.normals, second, of)[:, None] & ~self._held(name, other.normals, first, of)
        if opposed.any():
            there = opposed.any(axis=1).take(one.number)
            yield CaptivePart(
                name, sides, (None if first in touched else one.gap, None if second in touched else other.gap),
                one.normals.take(one.number[there], axis=0).repeat(3, axis=0), one.facets[there].reshape(-1, 3),
            )  # fmt: skip

    def _held(self, name: str, towards: Array, by: str, of: Mapping[str, int]) -> Flags:
        """(n,) whether contact of a unit with any of the kind of another keeps it from going towards directions
        (n, 3)."""
        normals = [some for unit, every in self._touched[name].items() if of[unit] == of[by] for some in every]
        if not normals:
            return np.zeros(len(towards), bool)
        return np.asarray((towards @ np.concatenate(normals).T >= CAPTIVE_HELD).any(axis=1))

    def _faced(self, name: str, other: str) -> _Faced:
        """Where a unit faces another one within the contact tolerance, and either is round."""
        key = (name, other)
        if key not in self._facing:
            pairs = self._near[name][other]
            found = [self._facets(*pair) for pair in pairs]
            mine, others = (
                np.concatenate(rows) for rows in zip(*((one.normals, one.others) for one in found), strict=True)
            )
            faces = (dot(mine, others) <= CAPTIVE_FACES) & (_bend(mine) or _bend(others))
            gap = np.concatenate([one.gaps for one in found])[faces].min(initial=math.inf)
            corners = np.concatenate(
                [self._corners(part)[one.facets] for (part, _), one in zip(pairs, found, strict=True)]
            )
            normals, number = np.unique(mine[faces].round(CAPTIVE_DIGITS), axis=0, return_inverse=True)
            self._facing[key] = _Faced(normals, corners[faces], number.ravel(), float(gap))
        return self._facing[key]

    def _facets(self, part: PartName, other: PartName) -> Facing:
        tolerance = self._contacts.tolerance[min(part, other), max(part, other)]
        return facing(self._corners(part), self._corners(other), CAPTIVE_REACH * tolerance, CAPTIVE_BESIDE)

    def _corners(self, name: PartName) -> Array:
        """(F, 3, 3) m: the facets of a part as it is placed."""
        part = self._assembly.part(name)
        assert part.mesh is not None
        vertices = part.mesh.vertices @ part.X_WP[:3, :3].T + part.X_WP[:3, 3]
        return np.asarray(vertices.take(part.mesh.faces, axis=0))


def _bend(normals: Array) -> bool:
    """Whether facets with these normals (k, 3) are not all of one plane."""
    return len(normals) > 0 and float((normals @ normals[0]).min()) < math.cos(CAPTIVE_BENDS)


def may_carry(
    parts: CaptiveParts, kinematics: Kinematics, first: str, second: str, named: AbstractSet[str]
) -> CaptivePart | None:
    """A part with play by which two bodies may be connected that are not by contact: directly, or by way of bodies that
    are neither named nor ground and of others with play. None where it is sure that they are not."""
    of = _of_bodies(parts, kinematics, (first, second), named)
    number = {body: k for k, body in enumerate(sorted({*of.values()}))}
    if first not in number or second not in number:
        return None
    touching = UnionFind(len(number))
    for joint in kinematics.joints_among(number.keys()):
        if {*joint.bodies} != {first, second}:
            touching.union(*(number[name] for name in joint.bodies))
    kinds = {unit: touching.find(number[body]) for unit, body in of.items()}
    ends = [touching.find(number[name]) for name in (first, second)]
    near = UnionFind(len(number))
    for some in parts.may_join(kinds):
        for other in some[1:]:
            near.union(some[0], other)
    if near.find(ends[0]) != near.find(ends[1]):
        return None
    found = UnionFind(len(number))
    for one in parts.between(kinds):
        found.union(*(kinds[side] for side in one.sides))
        if found.find(ends[0]) == found.find(ends[1]):
            return one
    return None


def may_hold(
    parts: CaptiveParts,
    kinematics: Kinematics,
    bodies: Sequence[str],
    named: AbstractSet[str],
    motions: tuple[Array, Frame] | None,
) -> CaptivePart | None:
    """A part with play between two of these bodies that are connected by contact, the first two and loose ones beside
    them: it may hold some of the motions of the second relative to the first, scaled columns (6, k), orthonormal; None:
    any. None where it is sure that there is no such part."""
    of = _of_bodies(parts, kinematics, bodies, named)
    number = {body: k for k, body in enumerate(sorted({*of.values()}))}
    for one in parts.between({unit: number[body] for unit, body in of.items()}):
        between = {of[side] for side in one.sides}
        if between <= {*bodies} and (motions is None or between != {*bodies[:2]} or _opposes(one, *motions)):
            return one
    return None


def _opposes(one: CaptivePart, motions: Array, frame: Frame) -> bool:
    """Whether some of these motions (6, k) bring the two sides of a part nearer to each other where it is."""
    speeds = rows(one.places, one.normals, frame) @ motions
    return bool((np.linalg.norm(speeds, axis=1) >= CAPTIVE_OPPOSES).any())


def _of_bodies(
    parts: CaptiveParts, kinematics: Kinematics, bodies: Sequence[str], named: AbstractSet[str]
) -> dict[str, str]:
    """The body of each unit of these bodies, and of those that are neither named nor ground."""
    asked = [one for one in kinematics.bodies if one.name in bodies or not (one.ground or one.name in named)]
    return {parts.units[part]: str(body.name) for body in asked for part in body.parts}
