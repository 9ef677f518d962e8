"""The numbers of a mesh file, or of the place of a part, are too coarse for the shape of the part.

A part that is drawn far from the origin of its file, or written with few digits, loses its shape: single precision,
in which binary STL stores coordinates, has steps of 0.06 mm at a kilometre. A finding when a step of the largest
coordinate exceeds 1/5000 of the part's diagonal. A part that is placed too far away loses it too: the numbers of places
go in steps of 0.1 mm at 1e12 m. Whatever the parts of such a file touch is then ambiguous, and rules about contacts,
joints and motion are inconclusive. Smaller steps count as an uncertainty of every surface.

Why it matters: rounds turn into polygons and clearances vanish, and what is left looks like a sound mesh of another
part.

What to do: export the part near the origin and state its `position` in the manifest, or export it with more digits: as
OBJ, or as ASCII STL with nine. Place the assembly near the origin of the world.

Example: a hinge of 50 mm in a plant model, exported as binary STL in plant coordinates, 1 km from the origin.
"""

from __future__ import annotations

import numpy as np

from kinform.consistency.context import Context, MeshUse
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import length
from kinform.model.findings import computed


def check(context: Context) -> Findings:
    """Meshes whose files are too coarse for them."""
    for use in context.meshes:
        mesh = use.mesh
        if context.assembly.lost.isdisjoint(use.subject):
            continue
        limit = context.assembly.tolerances.resolved * mesh.diagonal
        coarsest = max(part.step for part in use.parts)
        step = length(coarsest, context.units, 2)
        where, remedy = "", "Export the part near the origin and state its `position`, or export it with more digits."
        if mesh.resolution <= limit:
            where, remedy = ", where it is placed,", "Place the assembly near the origin of the world."
        yield RULE.finding(
            use.subject,
            f"the mesh {use.label} has lost its shape: its coordinates{where} go in steps of {step}, "
            f"and the part is {length(mesh.diagonal, context.units)} across",
            found=f"steps of {step}",
            intended=f"steps of {length(limit, context.units, 2)} at most",
            place=use.parts[0].X_WP[:3, 3],
            declared=use.parts[0].source,
            remedy=remedy,
            witness=computed(
                "coordinate step",
                coarsest / mesh.diagonal,
                context.assembly.tolerances.resolved,
                parts=use.subject[:1],
                step=coarsest,
                largest=_largest(use, coarsest),
            ),
        )


def _largest(use: MeshUse, coarsest: float) -> float:
    """m: the largest coordinate of the mesh in its file, or of its place, whichever has the coarser step."""
    if use.mesh.resolution >= coarsest:
        return float(np.abs(use.mesh.vertices + use.mesh.origin).max(initial=0.0))
    return float(max(np.abs(part.X_WP[:3, 3]).max() for part in use.parts))


RULE = Rule("KF111", "geometry-lost", "error", __doc__, check, needs=("meshes",))
