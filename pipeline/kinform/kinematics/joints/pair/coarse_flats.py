"""Flats that may be those of a coarse mesh: of a prism or of a cylinder, which does not hold a turn as a prism does."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinform.foundation.rounding import SINGLE
from kinform.kinematics.joints.pair.constants import ALONG_AXIS
from kinform.kinematics.joints.pair.suspects import AtRest, Suspect, suspect
from kinform.model.arrays import Array


def torn_flats(pair: AtRest) -> Iterator[Suspect]:
    """Flats on flats that may be those of a coarse cylinder."""
    flats = np.array([patch.kind == "plane" and patch.sides > 0 for patch in pair.patches])
    if flats.any():
        sides = max(patch.sides for patch, flat in zip(pair.patches, flats, strict=True) if flat)
        words = f"{sides} flats on flats hold it that may be those of a prism, or of a cylinder in a coarse mesh"
        yield suspect(flats, "drop", words)


def flats_of_rings(pair: AtRest) -> Iterator[Suspect]:
    """Planes that lie where the flats of a coarse cylinder beside them do."""
    flats = np.zeros(len(pair.patches), dtype=bool)
    for ring in (patch for patch in pair.patches if patch.sides and patch.kind == "cylinder"):
        radius, least = max(ring.radii), max(ring.radii) * np.cos(np.pi / ring.sides) - ring.chord
        for k, patch in enumerate(pair.patches):
            if patch.kind == "plane" and abs(float(patch.axis @ ring.axis)) < ALONG_AXIS:
                flats[k] |= bool(least <= abs(float((patch.point - ring.point) @ patch.axis)) <= radius + ring.chord)
    if flats.any():
        area = 1e6 * sum(item.area for item in pair.evidence.chosen(flats))
        words = f"{area:.3g} mm² of flats hold it that may be those of the cylinder beside them, in a coarse mesh"
        yield suspect(flats, "drop", words)


def prisms(pair: AtRest) -> Iterator[Suspect]:
    """Flats that are taken for a coarse cylinder, and may be those of a prism."""
    rings = np.array([patch.sides > 0 and patch.kind == "cylinder" for patch in pair.patches])
    if rings.any():
        patch = max((patch for patch, ring in zip(pair.patches, rings, strict=True) if ring), key=lambda p: p.area)
        across = f"{2e3 * max(patch.radii):.3g} mm across their corners"
        yield suspect(rings, "prism", f"the {patch.sides} flats of {across} are a cylinder in a coarse mesh")


def without_turns(pair: AtRest, of: Suspect, free: Array, freed: Array) -> Array | None:
    """What a prism leaves of the freedoms: it does not turn."""
    _, turns, mixed = np.linalg.svd(free[:3], full_matrices=True)
    turning = int(np.count_nonzero(turns > SINGLE))
    return np.asarray(free @ mixed[turning:].T) if turning else None
