"""How large parts are, also those that enclose nothing: to say which part of a body is its largest."""

from __future__ import annotations

import numpy as np

from kinform.foundation.tied_sizes import tied_sizes
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
    return tied_sizes(out)
