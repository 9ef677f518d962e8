"""A mesh holds the same facet more than once.

Why it matters: duplicated facets count twice in areas and volumes, and make edges with more than two
facets.

What to do: remove duplicates in a mesh program, or export again. Often a body was exported twice.

Example: an STL made by concatenating two exports of the same part.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import counted


def check(context: Context) -> Findings:
    """Meshes with duplicate facets."""
    for use in context.meshes:
        if use.mesh.health.duplicate_facets > 0:
            yield RULE.finding(
                use.subject,
                f"the mesh {use.label} holds {counted(use.mesh.health.duplicate_facets, 'facet')} more than once",
                found=counted(use.mesh.health.duplicate_facets, "duplicate facet"),
                intended="every facet once",
                declared=use.parts[0].source,
                remedy="Remove the duplicates and export the mesh again.",
            )


RULE = Rule("KF106", "mesh-facets-duplicate", "warning", __doc__, check, needs=("meshes",))
