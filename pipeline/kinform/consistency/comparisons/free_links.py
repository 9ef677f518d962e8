"""Links that a description leaves free of each other, and whether contact lets them come apart.

A link on a floating joint, or on none, may move in every way. Where it stands on the others or leans on them it does:
there is a motion that opens all of the contact at once. A shaft in its bore, a ball in its cup and a rail in its groove
have none: contact takes freedoms away, both ways.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinform.consistency.context import Context
from kinform.consistency.questions.proofs import pushing
from kinform.foundation.algebra.vectors import cross
from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.words import counted, direction
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.model.descriptions import DescribedLink, Description
from kinform.model.findings import Witness
from kinform.model.names import PartName

OPENS = 1e-3
"""Least speed with which all of a contact must open, for a motion of 1: normals of surfaces that were recovered from
meshes are off by less, and a bore that reaches half round, less one facet of 3000, still opens."""


@dataclass(frozen=True, eq=False)
class HeldLink:
    """A link that the description leaves free, and that contact with another holds."""

    description: Description
    link: DescribedLink
    other: DescribedLink
    patches: tuple[Patch, ...]
    words: str
    """What contact makes of it."""

    free: frozenset[PartName]
    """Parts of the side that is left free."""

    @property
    def witness(self) -> Witness | None:
        """Pushes of its contact that balance each other."""
        return pushing(self.patches, self.free)

    @property
    def place(self) -> Array:
        """(3,) m in the world: the middle of the contact."""
        return np.asarray(np.concatenate([patch.points for patch in self.patches]).mean(axis=0))


def held_links(context: Context) -> Iterator[HeldLink]:
    """All of them, in the order of the descriptions; of links that joints connect with each other, the two that touch
    first."""
    for description in context.assembly.descriptions:
        links = {PartName(part): link for link in description.links for part in link.parts}
        trees = _trees(context, links)
        if len(set(trees.values())) < 2:
            continue
        touching: dict[tuple[int, int], list[Patch]] = {}
        for patch in context.contacts.patches:
            if not patch.unknown and links.keys() >= set(patch.parts):
                ends = sorted({trees[part] for part in patch.parts})
                if len(ends) == 2:
                    touching.setdefault((ends[0], ends[1]), []).append(patch)
        for (_, free), patches in sorted(touching.items()):
            sides = [part for part in patches[0].parts if trees[part] == free]
            loose = frozenset(part for part, tree in trees.items() if tree == free)
            if not _opens(patches, loose):
                one, other = sides[0], next(part for part in patches[0].parts if part not in sides)
                words = _words(context, one, other)
                yield HeldLink(description, links[one], links[other], tuple(patches), words, loose)


def _trees(context: Context, links: dict[PartName, DescribedLink]) -> dict[PartName, int]:
    """For each part of a description's links the number of what joints, groups and assumptions connect: first the one
    at rest, then by their first links."""
    assembly = context.assembly
    number = {part.name: k for k, part in enumerate(assembly.parts)}
    sets = UnionFind(len(number))
    for names in (group.parts for group in assembly.groups):
        for name in names[1:]:
            sets.union(number[names[0]], number[name])
    pairs = [joint.between for joint in context.function.joints if len(joint.between) == 2]
    for first, second in (*pairs, *(assumption.between for assumption in assembly.assumptions)):
        sets.union(number[assembly.parts_of(first)[0]], number[assembly.parts_of(second)[0]])
    rest = [] if assembly.ground is None else [assembly.parts_of(assembly.ground)[0]]
    order = dict.fromkeys(sets.find(number[part]) for part in (*rest, *links))
    place = {root: k for k, root in enumerate(order)}
    return {part: place[sets.find(number[part])] for part in links}


def _opens(patches: list[Patch], free: frozenset[PartName]) -> bool:
    """Whether some motion of the free side opens all of the contact at once."""
    from scipy.optimize import linprog

    points = np.concatenate([patch.points for patch in patches])
    away = np.concatenate([patch.normals * (1.0 if patch.parts[1] in free else -1.0) for patch in patches])
    arms = points - points.mean(axis=0)
    reach = float(np.linalg.norm(arms, axis=1).max()) or 1.0
    rows = np.concatenate([cross(arms, away) / reach, away], axis=1)
    # the least speed with which any of it opens, at most, for components of the motion up to 1
    columns = np.concatenate([-rows, np.ones((len(rows), 1))], axis=1)
    bounds = [(-1.0, 1.0)] * 6 + [(None, 1.0)]
    solved = linprog(np.r_[np.zeros(6), -1.0], A_ub=columns, b_ub=np.zeros(len(rows)), bounds=bounds, method="highs")
    return solved.status != 0 or float(solved.x[6]) > OPENS


def _words(context: Context, one: PartName, other: PartName) -> str:
    """What contact makes of two parts: a joint, or one body."""
    kinematics = context.kinematics
    first, second = (kinematics.body_of(part) for part in (one, other))
    if first is second:
        left_out = (way for way in kinematics.left_out or () if way.parts(one, other))
        way = next(left_out, None)
        about = "" if way is None or way.axis is None else f" about {direction(way.axis)}"
        return "one body" if way is None else f"{way.type}{about}"
    joint = next(iter(kinematics.joints_between(first.name, second.name)), None)
    if joint is None:
        return "held"
    about = "" if joint.axis is None else f" about {direction(joint.axis)}"
    known = "" if joint.status == "determined" else f"{joint.status} "
    return f"{known}{joint.type}{about}, {counted(joint.freedoms, 'freedom')} left"
