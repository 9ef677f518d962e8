"""A mesh holds the same facet more than once.

A copy that is wound as its facet is taken once. So is one that is wound against it, as for its back, where the others
make a closed mesh then; elsewhere both are kept.

Why it matters: copies that are kept count in areas and volumes, and make edges with more than two facets. And who wrote
a body twice may not know that it is there twice.

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
