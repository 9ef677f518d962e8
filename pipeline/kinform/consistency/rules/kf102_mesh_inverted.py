"""The mesh is closed but inside out: its facets face into the material.

Why it matters: outside and inside are exchanged. Bores are read as shafts and the part mates with
nothing, and its volume and mass come out negative.

What to do: flip the normals of the whole mesh ("reverse", "flip", "recalculate outside" in mesh
programs) and export again. A mesh that was mirrored by a negative scale is inside out too.

Example: a cube of 10 mm with a signed volume of -1000 mm³.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import volume


def check(context: Context) -> Findings:
    """Closed meshes of negative volume."""
    for use in context.closed_meshes:
        if use.mesh.health.volume < 0.0:
            yield RULE.finding(
                use.subject,
                f"the mesh {use.label} is inside out: its volume is {volume(use.mesh.health.volume, context.units)}",
                found=volume(use.mesh.health.volume, context.units),
                intended="a positive volume: facet normals out of the material",
                declared=use.parts[0].source,
                remedy="Flip the facets of the whole mesh and export it again.",
            )


RULE = Rule("KF102", "mesh-inverted", "error", __doc__, check, needs=("closed meshes",))
