"""Neighbouring facets of a mesh disagree about which side is outside.

Why it matters: where the normals point the wrong way, surfaces do not mate and contacts are lost, and
the volume is wrong by twice what the flipped facets enclose.

What to do: unify the normals of the mesh and export again.

Example: a plate of which one face was flipped by hand.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.questions.mesh_faults import misused_edge
from kinform.consistency.rule import Findings, Rule


def check(context: Context) -> Findings:
    """Meshes with facets in opposite senses; edges with more than two facets have no sense of their own."""
    for use in context.meshes:
        if not use.mesh.health.consistent_winding and use.mesh.health.overused_edges == 0:
            yield RULE.finding(
                use.subject,
                f"the facets of the mesh {use.label} do not all face the same way",
                found="facets that face both ways",
                intended="every edge run through once in each direction",
                declared=use.parts[0].source,
                remedy="Unify the normals of the mesh and export it again.",
                witness=misused_edge(use.mesh, use.subject[0], directed=True),
            )


RULE = Rule("KF103", "mesh-winding-inconsistent", "error", __doc__, check, needs=("meshes",))
