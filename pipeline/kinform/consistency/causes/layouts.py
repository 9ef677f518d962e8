"""Parts that were never put together: all at their own origins, or laid out beside each other.

Both are facts about places, sizes and contacts, and no rule has to be asked again: in an assembly whose parts are not
in their places nothing that contacts say means anything.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Literal

import numpy as np

from kinform.consistency.causes.remedies import pose_in_file
from kinform.consistency.context import Context
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.assembly import Part

LEAST = 3
"""Parts from which this is said: of two, one may be displaced. A choice."""
OVERLAPPING = 0.5
"""Share of all pairs that overlap, from which parts are not placed: an assembly has few pairs that touch at all.
Chosen, not measured."""
SHARED = 0.2
"""Share of the smaller part that is inside the other, in the middle of all pairs that overlap: a press fit or a part
that is drawn too large has far less. Chosen, not measured."""
LEVEL = 2e-3
"""Share of the largest part by which the lowest points of parts on one plate differ. Chosen, not measured."""
SEEN = 400
"""Parts of which pairs are gone through. Of more, nothing is said."""


@dataclass(frozen=True)
class Layout:
    """What is said of all meshed parts."""

    kind: Literal["unplaced", "laid out"]
    parts: tuple[str, ...]
    message: str
    found: str
    remedy: str


def layout(context: Context) -> Layout | None:
    """How the parts lie, where they are not assembled."""
    parts = [part for part in context.assembly.parts if part.mesh is not None and len(part.mesh.vertices)]
    if not LEAST <= len(parts) <= SEEN or context.design.contacts is None:
        return None
    if context.assembly.descriptions:  # joints place the links
        return _unplaced(context, parts)
    return _unplaced(context, parts) or _laid_out(context, parts)


def _unplaced(context: Context, parts: Sequence[Part]) -> Layout | None:
    """All in one pose, about its origin, and inside each other."""
    poses = [pose_in_file(part) for part in parts]
    size = context.assembly.largest
    if not all(np.allclose(X, poses[0], rtol=0.0, atol=1e-6 * max(size, 1.0)) for X in poses):
        return None
    overlaps = [one for one in context.contacts.interferences if not one.mated]
    pairs = len(parts) * (len(parts) - 1) // 2
    if len(overlaps) < OVERLAPPING * pairs:
        return None
    origin = poses[0][:3, 3]
    for part in parts:
        assert part.mesh is not None
        low, high = part.mesh.placed_box(part.X_WP)
        margin = LEVEL * size
        if (origin < low - margin).any() or (origin > high + margin).any():
            return None
    volumes = {part.name: abs(part.mesh.health.volume) for part in parts if part.mesh is not None}
    shares = sorted(
        one.volume / least
        for one in overlaps
        if one.volume == one.volume and (least := min(volumes[name] for name in one.parts)) > 0.0
    )
    if not shares or shares[len(shares) // 2] < SHARED:
        return None
    names = tuple(str(part.name) for part in parts)
    return Layout(
        "unplaced",
        names,
        f"all {len(parts)} parts stand at the origins of their own files, about the same point, and {len(overlaps)} of "
        f"{pairs} pairs are inside each other: the parts are not placed",
        f"{len(parts)} parts at one origin, {len(overlaps)} of {pairs} pairs inside each other",
        "Export the parts in the frame of the assembly, read the assembly file instead, or give each part its "
        "`position` and rotation in a manifest: `kinform init` writes one.",
    )


def _laid_out(context: Context, parts: Sequence[Part]) -> Layout | None:
    """None touches another, and no box is over another."""
    contacts = context.contacts
    meshed = {part.name for part in parts}
    joined = [group for group in context.assembly.groups if len(meshed & set(group.parts)) > 1]
    touch = [patch for patch in contacts.patches if meshed.issuperset(patch.parts)]
    if joined or touch or contacts.interferences or contacts.possible_overlaps or context.assembly.assumptions:
        return None
    names = tuple(str(part.name) for part in parts)
    boxes = np.array([part.mesh.placed_box(part.X_WP) for part in parts if part.mesh is not None])
    for axis in (2, 1, 0):
        lows, size = boxes[:, 0, axis], context.assembly.largest
        if np.ptp(lows) > LEVEL * size or not _beside(np.delete(boxes, axis, axis=2)):
            continue
        return Layout(
            "laid out",
            names,
            f"none of the {len(parts)} parts touches another, and all stand side by side on one plane: a print plate, "
            "not an assembly",
            f"{len(parts)} parts side by side on one plane, none touches another",
            "Read the assembly, not the print plate; or give each part its `position` and rotation in a manifest.",
        )
    if context.function.joints:  # each of them says how far its sides are apart
        return None
    return Layout(
        "laid out",
        names,
        f"none of the {len(parts)} parts touches another",
        f"none of {len(parts)} parts touches another",
        "Read the assembly as it is put together, add what is missing between the parts, or raise "
        "`tolerances.contact`.",
    )


def _beside(boxes: Array) -> bool:
    """Whether no two of the rectangles (n, 2, 2) have a point inside both."""
    for one, other in itertools.combinations(boxes, 2):
        if (np.minimum(one[1], other[1]) - np.maximum(one[0], other[0]) > 0.0).all():
            return False
    return True
