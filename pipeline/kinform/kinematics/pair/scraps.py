"""Patches too slight to decide: slivers of rounds, and shallow overlaps of small flats.

A tooth's flank that happens to lie near another, a facet or two of a fillet, a corner that dips into a face: each has
normals and an area, and would hold something if it were believed. They may confirm a joint that the rest of the contact
gives; where the answer hangs on them it is ambiguous (`certainty`). How much arc and area a surface needs is in
`kinematics.constants`, with the robots that chose it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.vectors import widest_gap
from kinform.kinematics import constants
from kinform.kinematics.pair.evidence import Evidence, Item, Line
from kinform.kinematics.pair.hypotheses import coaxial_lines
from kinform.model.arrays import Flags


def scraps(evidence: Evidence, alignment: float) -> Flags:
    """(items,): which patches are too slight to decide. Surfaces about one axis count together.

    `alignment` (rad): within this axes are one.
    """
    items, share = evidence.items, evidence.areas / evidence.areas.sum()
    dips = [k for k, item in enumerate(items) if _dips(item, evidence.contact) and share[k] < constants.DIP_SHARE]
    slight = np.zeros(len(items), dtype=bool)
    planes = np.array([item.normals[0] if item.patch.kind == "plane" else np.zeros(3) for item in items])
    for k, item in enumerate(items):
        if item.patch.kind != "plane":
            continue
        cosines = planes @ item.normals[0]
        one_way = float(share[cosines > -constants.FACED].sum())
        alone = one_way < constants.SLIVER_SHARE and not (cosines < constants.FACED).any()
        # the two flanks of a pressed key face each other
        dips_alone = k in dips and not (cosines[dips] < constants.FACED).any()
        slight[k] = alone or dips_alone or (item.patch.one_sided and share[k] < constants.SLIVER_SHARE)
    for line in coaxial_lines(evidence, alignment):
        members = list(line.items)
        little = float(share[members].sum()) < constants.SLIVER_SHARE
        if all(items[k].patch.one_sided for k in members):
            slight[members] = little or _arc(items, line) < constants.SLIVER_ARC_ONE_SIDED
        else:
            slight[members] = little and _arc(items, line) < constants.SLIVER_ARC
    return slight | narrow(evidence)


def narrow(evidence: Evidence) -> Flags:
    """(items,): which patches are of faces that may not touch at all, as far as their outlines tell."""
    return np.array([item.patch.narrow for item in evidence.items], dtype=bool)


def _dips(item: Item, contact: float) -> bool:
    """Is it a plane that overlaps the other part deeper than a press would?"""
    return item.patch.kind == "plane" and item.interferes and -item.patch.gap > constants.DIP * contact


def _arc(items: Sequence[Item], line: Line) -> float:
    """rad: angle about the line that the normals of its patches cover, all together."""
    return sum(2.0 * np.pi - widest_gap(items[k].normals, line.axis) for k in line.items)
