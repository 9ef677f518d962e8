"""Groups of bodies that leave the rest as one, by a translation that opens contact, slides along it, or both.

A contact that can open in the assembly is one-sided, as its rows say. One that cannot is held in both senses, but for
the translations along it: a pin that runs in a second bore leaves along that bore, whatever else contact holds there.
So only contact that neither opens nor slides keeps bodies together for good. A group is closed under what it pushes:
where a contact neither opens nor slides along the direction, the other body moves along.

A turn that opens contact leaves only where it opens all contact at once: a door leaves its jamb and stays on its pin.
All of this is of first order. How far a group comes along its direction is a question to the meshes.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence

import numpy as np

from kinform.foundation.algebra.vectors import norm
from kinform.foundation.graphs.graph import UnionFind
from kinform.frozen import dataclass
from kinform.kinematics.constants import SAME_DIRECTION
from kinform.kinematics.screws.canonical_basis import directions
from kinform.kinematics.screws.wording import direction_words
from kinform.kinematics.separation.cone import opens_at_once, rows_beside, split_directions, unit_rows
from kinform.kinematics.separation.constants import CONE_HELD
from kinform.kinematics.separation.contact_rows import Cone
from kinform.kinematics.separation.links import Link, common_frame, rows_in_frame
from kinform.kinematics.separation.releases import certainly_held, leaving_of_each, release_of
from kinform.model.arrays import Array
from kinform.model.kinematics import Release, Separation
from kinform.model.names import BodyName

MOST_TOGETHER = 8
"""Sets of bodies, each kept together by contact that does not open, up to which those are told that leave together.
Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class LeavingGroups:
    """What leaves, with all else at rest."""

    separations: tuple[Separation, ...]
    """By breaking contact."""
    slides: tuple[Separation, ...]
    """Along contact that stays; whether the slide has an end is not known."""
    missing: int
    """Sets of bodies with contact that opens, which move only with too many others, or while others move too."""


@dataclass(frozen=True, eq=False)
class _Side:
    """A link as one of its ends sees it."""

    link: Link
    other: int
    sign: float
    """1 where this end is the second body of the link."""
    cone: Cone | None
    """Of a link that can open; None: it is held, but for translations along it."""
    slides: Array
    """(k, 3) unit directions in which this end leaves the other."""
    extreme: bool
    """Whether these are all extreme ones."""


_Group = tuple[int, ...]
"""Sets of bodies, sorted."""


def leaving_groups(names: Sequence[BodyName], ground: int, links: Sequence[Link], opened: set[int]) -> LeavingGroups:
    """The groups of bodies that leave the ground, where the links `opened` can open, and no other can."""
    together, still = UnionFind(len(names)), UnionFind(len(names))
    for k, link in enumerate(links):
        if k not in opened:
            still.union(*link.ends)
            if not link.straight.shape[1]:
                together.union(*link.ends)
    members: dict[int, list[int]] = defaultdict(list)
    for n in range(len(names)):
        members[together.find(n)].append(n)
    return _Leaving(
        names, members, {start: still.find(bodies[0]) for start, bodies in members.items()},
        together.find(ground), _sides(links, opened, together),
    ).found()  # fmt: skip


def _sides(links: Sequence[Link], opened: set[int], together: UnionFind) -> dict[int, list[_Side]]:
    out: dict[int, list[_Side]] = defaultdict(list)
    for k, link in enumerate(links):
        first, second = (together.find(end) for end in link.ends)
        if first == second:
            continue
        cone, ways = (link.cone, link.slides) if k in opened else (None, ())
        if ways is None:
            assert cone is not None
            (leaving,) = leaving_of_each([cone], turns=False)
            ways = tuple(way for way in leaving.releases if way.kind == "slide")
        slides = np.array([way.direction for way in ways]).reshape(-1, 3)
        extreme = all(way.extreme for way in ways)
        out[first].append(_Side(link, second, -1.0, cone, -slides, extreme))
        out[second].append(_Side(link, first, 1.0, cone, slides, extreme))
    return out


@dataclass(frozen=True, eq=False)
class _Leaving:
    names: Sequence[BodyName]
    members: dict[int, list[int]]
    """Bodies of each set that contact keeps together for good."""
    kept: dict[int, int]
    """Of each set the larger one that contact which does not open keeps together, sliding or not."""
    rest: int
    """The set of the ground."""
    sides: dict[int, list[_Side]]

    def found(self) -> LeavingGroups:
        """All groups."""
        starts = [start for start in sorted(self.sides) if start != self.rest]
        opens = {start for start in starts if any(side.cone is not None for side in self.sides[start])}
        groups = list(dict.fromkeys(group for start in starts for group in self._groups(start, start in opens)))
        borders = [self._border(group) for group in groups]
        loose = [k for k, border in enumerate(borders) if any(side.cone is not None for side in border)]
        ways = dict(zip(loose, _ways([borders[k] for k in loose]), strict=True))
        separations: dict[tuple[BodyName, ...], Separation] = {}
        slides: dict[tuple[BodyName, ...], Separation] = {}
        leave: set[int] = set()
        turn: set[int] = set()
        for k, (group, border) in enumerate(zip(groups, borders, strict=True)):
            bodies = tuple(sorted(self.names[n] for g in group for n in self.members[g]))
            releases = ways.get(k)
            if releases:
                broken = {side.link.name for side in border if side.cone is not None}
                separations.setdefault(bodies, Separation(bodies, tuple(sorted(broken)), releases))
                leave.update(self.kept[g] for g in group)
            elif releases is None:
                turn.update(self.kept[g] for g in group)
            along = _translations(border)
            if along.shape[1]:
                slides.setdefault(bodies, Separation(bodies, (), _both_senses(along)))
        held = {self.kept[start] for start in opens} - leave - turn - {self.kept[self.rest]}
        return LeavingGroups(
            tuple(separations[key] for key in sorted(separations)),
            tuple(slides[key] for key in sorted(slides)),
            len(held),
        )

    def _groups(self, start: int, opens: bool) -> Iterator[_Group]:
        """Groups with `start` that may leave: the smallest that slides off along a direction in which a contact of
        its own opens, itself where there is none, and what moves along the lines of its contacts."""
        slides = [slide for side in self.sides[start] for slide in side.slides]
        lines = [side.link.straight[:, 0] for side in self.sides[start] if side.link.straight.shape[1] == 1]
        pushed = [group for slide in _distinct(slides) if (group := self._push(start, slide)) is not None]
        if opens:
            yield min(pushed, key=len, default=(start,))
        along = _translations(self.sides[start])
        if along.shape[1]:
            yield (start,)
        for line in _distinct(lines):
            for direction in (line, -line):
                group = self._push(start, direction)
                if group is not None:
                    yield group

    def _push(self, start: int, direction: Array) -> _Group | None:
        """All that moves when `start` slides along the direction; None where the rest is in the way, or too many
        move."""
        group, queue, kept = {start}, [start], {self.kept[start]}
        while queue:
            for side in self.sides[queue.pop()]:
                if side.other in group or not _in_the_way(side, direction):
                    continue
                kept.add(self.kept[side.other])
                if side.other == self.rest or len(kept) > MOST_TOGETHER:
                    return None
                group.add(side.other)
                queue.append(side.other)
        return tuple(sorted(group))

    def _border(self, group: _Group) -> list[_Side]:
        inside = set(group)
        return [side for g in group for side in self.sides[g] if side.other not in inside]


def _in_the_way(side: _Side, direction: Array) -> bool:
    if side.cone is None:
        along = side.link.straight
        return norm(direction - along @ (along.T @ direction)) > CONE_HELD
    held = side.cone.fixed[:, 3:] @ direction
    if any(abs(speed) > CONE_HELD for speed in held.tolist()):
        return True
    speeds = side.cone.rows[:, 3:] @ direction
    return bool(speeds.min() < -CONE_HELD if side.sign > 0.0 else speeds.max() > CONE_HELD)


def _distinct(ways: Sequence[Array]) -> list[Array]:
    """Unit directions without those that are there before; both senses of a line are two."""
    out: list[Array] = []
    for way in ways:
        if all(norm(way - other) > SAME_DIRECTION for other in out):
            out.append(way)
    return out


def _translations(border: Sequence[_Side]) -> Array:
    """(3, k) perpendicular unit directions in which a group slides along all its contacts; none where it has none."""
    if not border or any(not side.link.straight.shape[1] for side in border):
        return np.zeros((3, 0))
    values, vectors = np.linalg.eigh(np.sum([side.link.across for side in border], axis=0))
    return directions(vectors[:, values <= CONE_HELD**2 * len(border)])


def _both_senses(along: Array) -> tuple[Release, ...]:
    """The slides along perpendicular directions (3, k), forward and backward."""
    ways = [way + 0.0 for line in along.T for way in (line, -line)]
    return tuple(
        Release(
            "slide", np.concatenate([np.zeros(3), way]), way, None, along.shape[1] == 1,
            f"slide along {direction_words(way)}",
        )
        for way in ways
    )  # fmt: skip


def _ways(borders: Sequence[Sequence[_Side]]) -> list[tuple[Release, ...] | None]:
    """How each of the groups, as one body, leaves what it touches, breaking contact: () where it does not; None where
    it only turns, and some contact stays."""
    alone = [len(border) == 1 and len(border[0].slides) > 0 for border in borders]
    cones = [_cone_beside(border) for border, known in zip(borders, alone, strict=True) if not known]
    held = certainly_held(cones)
    leaving = iter(leaving_of_each([cone for cone, sure in zip(cones, held, strict=True) if not sure], turns=False))
    asked = iter(zip(cones, held, strict=True))
    out: list[tuple[Release, ...] | None] = []
    for border, known in zip(borders, alone, strict=True):
        if known:
            out.append(_ways_of(border[0]))
            continue
        cone, sure = next(asked)
        ways = () if sure else next(leaving).releases
        turns = bool(ways) and all(way.kind != "slide" for way in ways)
        out.append(None if turns and (len(cone.fixed) or not opens_at_once(cone.rows)) else ways)
    return out


def _ways_of(side: _Side) -> tuple[Release, ...]:
    """How a body leaves by the one contact that it has: that is known."""
    assert side.cone is not None
    slides = side.slides + 0.0
    order = np.lexsort(np.round(slides, 6).T)[::-1]
    return tuple(
        release_of(np.concatenate([np.zeros(3), slide]), side.cone.frame, extreme=side.extreme)
        for slide in slides[order]
    )


def _cone_beside(border: Sequence[_Side]) -> Cone:
    """The cone that all contacts of a group leave it."""
    cones = [(side.sign, side.cone) for side in border if side.cone is not None]
    frame = cones[0][1].frame if len(cones) == 1 else common_frame([cone.frame for _, cone in cones])
    fixed = [rows_in_frame(cone.fixed, cone.frame, frame) for _, cone in cones]
    fixed += [side.link.held_in(frame) for side in border if side.cone is None]
    rows = [sign * rows_in_frame(cone.rows, cone.frame, frame) for sign, cone in cones]
    held = split_directions(unit_rows(np.concatenate(fixed)))[0].T
    return Cone(held, rows_beside(unit_rows(np.concatenate(rows)), held), frame)
