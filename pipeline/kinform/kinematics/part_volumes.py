"""How large parts are, also those that enclose nothing: to say which part of a body is its largest."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from kinform.kinematics import constants
from kinform.model.assembly import Assembly
from kinform.model.names import PartName


def volumes(assembly: Assembly) -> dict[PartName, float]:
    """m³ of every part with a mesh; that of its box where the mesh is open. Equal but for the rounding of files, they
    are equal, and so are their sums, in whatever order."""
    out = {}
    for part in assembly.parts:
        if part.mesh is not None:
            own = part.mesh.health.volume
            out[part.name] = abs(own) if own else float(np.prod(np.subtract(*part.mesh.placed_box(part.X_WP)[::-1])))
    return levelled(out)


def levelled(sizes: Mapping[PartName, float]) -> dict[PartName, float]:
    """The sizes, those that are less than another by no more than files round are as large as that: whole numbers of a
    unit, a power of two, so small that nothing is lost and so large that no sum is rounded."""
    unit = math.ldexp(1.0, math.frexp(max(sum(sizes.values()), 1e-300))[1] - constants.SIZE_BITS)
    out: dict[PartName, float] = {}
    greatest = 0.0
    for name, size in sorted(sizes.items(), key=lambda item: (-item[1], item[0])):
        if size < (1.0 - constants.AS_LARGE) * greatest or not out:
            greatest = size
        out[name] = round(greatest / unit) * unit
    return {name: out[name] for name in sizes}
