"""The mesh of a solid part is open: some edges do not belong to exactly two facets.

Why it matters: an open mesh encloses no volume, so the part has no mass, its overlap with other parts
cannot be measured, and facets may be missing where another part touches.

What to do: close the holes in the CAD program and export again, or repair the mesh. If the part is
meant to be incomplete, state `solid = false` for it: it then takes part in contacts but has no mass.

Example: a bracket exported with one face hidden has 24 edges with a facet on one side only.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.questions.mesh_faults import misused_edge
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import counted, listed


def check(context: Context) -> Findings:
    """Solid parts with edges that are not shared by exactly two facets."""
    for use in context.meshes:
        health = use.mesh.health
        if health.watertight or not use.solid:
            continue
        causes = []
        if health.open_edges:
            causes.append(f"{counted(health.open_edges, 'edge')} with only one facet")
        if health.overused_edges:
            causes.append(f"{counted(health.overused_edges, 'edge')} with more than two facets")
        if health.duplicate_facets:
            causes.append(counted(health.duplicate_facets, "duplicate facet"))
        yield RULE.finding(
            [part.name for part in use.parts if part.solid],
            f"the mesh {use.label} is not watertight" + (f": {listed(causes)}" if causes else ""),
            found=listed(causes) or None,
            intended="a closed surface, every edge with two facets",
            declared=next(part.source for part in use.parts if part.solid),
            remedy="Close the mesh and export it again, or state `solid = false` for a part that is "
            "meant to be incomplete.",
            witness=misused_edge(use.mesh, use.subject[0]),
        )


RULE = Rule("KF101", "mesh-not-watertight", "error", __doc__, check, needs=("solid meshes",))
