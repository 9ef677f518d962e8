"""The mesh of one part consists of several shells that do not touch.

Why it matters: kinform moves a part as one rigid body. Shells that are separate pieces in reality (a
motor with its rotor) need parts of their own to move. A closed cavity inside a solid is a shell too.

What to do: nothing if the pieces are one body or a cavity. Otherwise export them as separate parts.

Example: a bearing exported with rings and balls in one file.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule


def check(context: Context) -> Findings:
    """Meshes of more than one shell."""
    for use in context.meshes:
        if use.mesh.health.shells > 1:
            yield RULE.finding(
                use.subject,
                f"the mesh {use.label} consists of {use.mesh.health.shells} shells that move as one body",
                found=f"{use.mesh.health.shells} shells",
                intended="one shell, or pieces that move as one",
                declared=use.parts[0].source,
                remedy="Export pieces that move on their own as separate parts.",
            )


RULE = Rule("KF107", "mesh-several-shells", "note", __doc__, check, needs=("meshes",))
