"""Patches too slight to decide: slivers of rounds, shallow overlaps of small flats, and edges that dip into each other.

A tooth's flank that happens to lie near another, a facet or two of a fillet, a corner that dips into a face, the end of
a rod that meets the mouth of its bore and is drawn a little into it: each has normals and an area, and would hold
something if it were believed. They may confirm a joint that the rest of the contact
gives; where the answer hangs on them it is ambiguous (`certainty`). How much arc and area a surface needs is in
this module, with the robots that chose it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from kinform.foundation.algebra.vectors import widest_gap
from kinform.foundation.rounding import TINY
from kinform.kinematics.joints.pair.evidence import Evidence, Item, Line
from kinform.kinematics.joints.pair.hypotheses import coaxial_lines
from kinform.kinematics.joints.pair.one_sided import opposes_one_way
from kinform.kinematics.joints.pair.suspects import AtRest, Suspect, suspect
from kinform.kinematics.joints.pair.touches import HIGHER, TOUCHING
from kinform.model.arrays import Array, Flags

SLIVER_ARC = math.radians(30.0)
"""rad: rounds that cover less about their axis, ..."""
SLIVER_SHARE = 0.01
"""... with less than this share of the contact area, decide nothing. So do planes that only facets rest on."""
SLIVER_ARC_ONE_SIDED = math.radians(90.0)
"""rad: the same, whatever the share, where only facets of no known surface run on the round: flanks of teeth. Below the
share, whatever the arc. Chosen, not measured."""
DIP = 0.1
"""Share of the contact tolerance from which on a flat that overlaps dips into the other part, ... Chosen, not
measured."""
DIP_SHARE = 0.05
"""... and share of the area below which it then decides nothing, ..."""
FACED = -0.99
"""... unless another such flat faces it: cosine of their normals. Chosen, not measured."""
STEP_WIDTH = 5.0
"""Width of each of the two faces of a step that two edges make (`scraps._width`: of rings π times their width), over
the overlap at the other, up to which the step is there by the overlap alone. It is π to the rounding of the mesh."""
STEP_CORNER = 0.5
"""Largest cosine between the normals of the two faces of a step. Chosen, not measured."""


def slivers(pair: AtRest) -> Iterator[Suspect]:
    """Scraps, with points, lines and facets of no known surface."""
    slight = _scraps(pair.evidence, pair.tolerances.alignment)
    if not pair.touching and slight.any():
        yield suspect(slight | [patch.kind in HIGHER for patch in pair.patches], "sliver")


def is_scrap(pair: AtRest, of: Suspect, free: Array, freed: Array) -> Array | None:
    """What is free without scraps; None of the flat of a shaft, which holds a turn both ways, however small it is."""
    items = [pair.evidence.items[k] for k in of.items]
    flats = all(item.patch.kind == "plane" and not item.interferes and not item.patch.narrow for item in items)
    both_ways = freed.shape[1] == 1 and not opposes_one_way(pair.evidence, freed[:, 0], of.items)
    return None if flats and both_ways else free


def flanks(pair: AtRest) -> Iterator[Suspect]:
    """Points and lines of contact beside faces, where they hold all but one of what these leave.

    Teeth and cams drive bodies that something else bears. Where the bodies bear on each other by faces, as planes do,
    and the flanks hold nearly all of what these leave, one of the two is drawn where it is not.
    """
    of = np.array([patch.kind in TOUCHING for patch in pair.patches])
    if pair.touching and pair.count < 2 and of.any() and not of.all():
        yield suspect(of, "flank")


def _scraps(evidence: Evidence, alignment: float) -> Flags:
    """(items,): which patches are too slight to decide. Surfaces about one axis count together.

    `alignment` (rad): within this axes are one.
    """
    items, share = evidence.items, evidence.areas / evidence.areas.sum()
    dips = [k for k, item in enumerate(items) if _dips(item, evidence.contact) and share[k] < DIP_SHARE]
    slight = np.zeros(len(items), dtype=bool)
    planes = np.array([item.normals[0] if item.patch.kind == "plane" else np.zeros(3) for item in items])
    for k, item in enumerate(items):
        if item.patch.kind != "plane":
            continue
        cosines = planes @ item.normals[0]
        one_way = float(share[cosines > -FACED].sum())
        alone = one_way < SLIVER_SHARE and not (cosines < FACED).any()
        # the two flanks of a pressed key face each other
        dips_alone = k in dips and not (cosines[dips] < FACED).any()
        slight[k] = alone or dips_alone or (item.patch.one_sided and share[k] < SLIVER_SHARE)
    for line in coaxial_lines(evidence, alignment):
        members = list(line.items)
        little = float(share[members].sum()) < SLIVER_SHARE
        if all(items[k].patch.one_sided for k in members):
            slight[members] = little or _arc(items, line) < SLIVER_ARC_ONE_SIDED
        else:
            slight[members] = little and _arc(items, line) < SLIVER_ARC
    return slight | _narrow(evidence) | _steps(items)


def _narrow(evidence: Evidence) -> Flags:
    """(items,): which patches are of faces that may not touch at all, as far as their outlines tell."""
    return np.array([item.patch.narrow for item in evidence.items], dtype=bool)


def _dips(item: Item, contact: float) -> bool:
    """Is it a plane that overlaps the other part deeper than a press would?"""
    return item.patch.kind == "plane" and item.interferes and -item.patch.gap > DIP * contact


def _steps(items: Sequence[Item]) -> Flags:
    """(items,): which patches are the faces of a step that is there only because two edges are drawn into each other.

    Two edges that meet make a step of two faces as soon as they overlap, each as wide as the other is deep.
    """
    flags = np.zeros(len(items), dtype=bool)
    deep = [k for k, item in enumerate(items) if item.patch.gap < 0.0]
    wide = {k: _width(items[k]) for k in deep} if len(deep) > 1 else {}
    for k, j in combinations(wide, 2):
        first, second = items[k].patch, items[j].patch
        if wide[k] > -STEP_WIDTH * second.gap or wide[j] > -STEP_WIDTH * first.gap:
            continue
        if first.parts == second.parts and _are_across(items[k], items[j]):
            flags[[k, j]] = True
    return flags


def _width(item: Item) -> float:
    """m: the area of the patch over twice the greatest distance of a sample from the middle, in whatever pose.

    That is the width of a long strip, π times that of a ring, 0.7 of a square's.
    """
    return item.patch.area / max(2.0 * float(np.sqrt(((item.points - item.middle) ** 2).sum(axis=1).max())), TINY)


def _are_across(first: Item, second: Item) -> bool:
    """Are the normals of the one about perpendicular to those of the other?"""
    return float(np.abs(first.normals @ second.normals.T).max()) < STEP_CORNER


def _arc(items: Sequence[Item], line: Line) -> float:
    """rad: angle about the line that the normals of its patches cover, all together."""
    return sum(2.0 * np.pi - widest_gap(items[k].normals, line.axis) for k in line.items)
