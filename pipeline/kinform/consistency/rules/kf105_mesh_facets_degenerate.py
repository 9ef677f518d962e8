"""A mesh has facets without area; they were removed.

Why it matters: it rarely does. Many of them hint at a unit or rounding problem in the export.

What to do: nothing, unless there are many: then export with more digits or as binary STL.

Example: three facets whose corners were rounded to the same point.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import counted, length


def check(context: Context) -> Findings:
    """Meshes with facets that collapsed when vertices were welded."""
    for use in context.meshes:
        if use.mesh.health.degenerate_facets > 0:
            yield RULE.finding(
                use.subject,
                f"{counted(use.mesh.health.degenerate_facets, 'facet')} of the mesh {use.label} "
                f"without area {'was' if use.mesh.health.degenerate_facets == 1 else 'were'} removed "
                f"(vertices within {length(use.mesh.health.weld, context.units, 2)} are one)",
                found=counted(use.mesh.health.degenerate_facets, "facet"),
                intended="facets with an area",
                declared=use.parts[0].source,
                remedy="Nothing, unless there are many: then export the mesh with more digits.",
            )


RULE = Rule("KF105", "mesh-facets-degenerate", "note", __doc__, check, needs=("meshes",))
