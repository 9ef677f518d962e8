"""A closed mesh cannot be used as a solid by the boolean engine.

Why it matters: overlaps with other parts are then estimated from the facets and not measured as
volumes. Contacts and joints do not depend on it.

What to do: look for facets that touch or cross the part itself, and export again.

Example: two cubes in one file that share an edge: the edge has four facets.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule


def check(context: Context) -> Findings:
    """Closed, consistently wound meshes whose manifold status is not "NoError"."""
    for use in context.closed_meshes:
        if use.mesh.health.manifold_status != "NoError":
            yield RULE.finding(
                use.subject,
                f"the mesh {use.label} is closed but not a valid solid: "
                f"manifold status {use.mesh.health.manifold_status}",
                found=use.mesh.health.manifold_status,
                intended="NoError",
                declared=use.parts[0].source,
                remedy="Remove facets that cross or touch others of the same part, and export the mesh again.",
            )


RULE = Rule("KF104", "mesh-not-manifold", "warning", __doc__, check, needs=("closed meshes",))
