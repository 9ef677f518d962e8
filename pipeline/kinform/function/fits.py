"""The clearance by which two groups of parts fit, from the patches where they mate.

Of coaxial and concentric surfaces it is the difference of radii. Planes that face each other, a key in its slot,
are taken in pairs: what one side opens the other closes, and their sum is the clearance.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

import numpy as np

from kinform.model.arrays import Array
from kinform.model.contacts import Contacts, Patch
from kinform.requirements.evidence import FitClearance, FitKind

OPPOSED = -math.cos(math.radians(1.0))
"""Cosine of normals below which two planes face away from each other."""


ROUND = ("cylinder", "sphere", "cone")


def clearances(contacts: Contacts, first: Collection[str], second: Collection[str]) -> tuple[FitClearance, ...]:
    """All fits between parts of the two groups; of round surfaces where there are any, else of planes."""
    mates = [p for p in contacts.patches if _between(p, first, second) and not p.one_sided and len(p.points)]
    rounds = [p for p in mates if p.kind in ROUND]
    if rounds:
        return tuple(map(_radial, rounds))
    planes = [p for p in mates if p.kind == "plane"]
    out, paired = [], set()
    for i, a in enumerate(planes):
        for j in range(i + 1, len(planes)):
            b = planes[j]
            if float(_out(a, first) @ _out(b, first)) < OPPOSED:
                middle = 0.5 * (a.points.mean(axis=0) + b.points.mean(axis=0))
                out.append(_planes("both sides", (a, b), middle))
                paired |= {i, j}
    for i, a in enumerate(planes):
        if i not in paired:
            out.append(_planes("gap", (a,), a.points.mean(axis=0)))
    return tuple(out)


def _radial(patch: Patch) -> FitClearance:
    numbers = {} if patch.kind == "cone" else {"axis": patch.axis, "point": patch.point, "radii": np.array(patch.radii)}
    return FitClearance("radial", patch.gap, patch.uncertainty[1], patch.points.mean(axis=0), patch.parts, numbers)


def _planes(kind: FitKind, patches: Sequence[Patch], place: Array) -> FitClearance:
    lows = [float(patch.axis @ patch.point) for patch in patches]
    numbers = {
        "axes": np.array([patch.axis for patch in patches]),
        "heights": np.array([(low, low + patch.gap) for low, patch in zip(lows, patches, strict=True)]),
    }
    error = sum(patch.uncertainty[1] for patch in patches)
    parts = tuple(name for patch in patches for name in patch.parts)
    return FitClearance(kind, sum(patch.gap for patch in patches), error, place, parts, numbers)


def _between(patch: Patch, first: Collection[str], second: Collection[str]) -> bool:
    a, b = patch.parts
    return (a in first and b in second) or (b in first and a in second)


def _out(patch: Patch, first: Collection[str]) -> Array:
    """Normal out of the first group."""
    return patch.axis if patch.parts[0] in first else -patch.axis
