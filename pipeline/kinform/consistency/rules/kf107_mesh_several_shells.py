"""The mesh of one part consists of several shells that do not touch.

Why it matters: kinform moves a part as one rigid body. Shells that are separate pieces in reality (a
motor with its rotor) need parts of their own to move. A closed cavity inside a solid is a shell too.
Shells that overlap, or lie in each other and face the same way, are a warning: what two of them fill counts
twice in volume and mass, and the bound of the mass holds it.

What to do: nothing if the pieces are one body or a cavity. Otherwise export them as separate parts. Join
shells that overlap in CAD; the facets of a cavity face into it.

Example: a bearing exported with rings and balls in one file.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import volume


def check(context: Context) -> Findings:
    """Meshes of more than one shell."""
    for use, faults in zip(context.meshes, context.shell_faults, strict=True):
        shells = use.mesh.health.shells
        if faults.overlapping:
            lie = "lies in others or crosses them" if faults.overlapping == 1 else "lie in others or cross them"
            yield RULE.at("warning").finding(
                use.subject,
                f"{faults.overlapping} of the {shells} shells of the mesh {use.label} {lie}: what two of them fill "
                f"counts twice, and up to {volume(faults.doubtful, context.units)} of its volume are in doubt",
                found=f"{shells} shells, {faults.overlapping} in others",
                intended="shells that share no space",
                declared=use.parts[0].source,
                remedy="Join the shells to one solid and export it again; the facets of cavities face into them.",
            )
        elif shells > 1:
            yield RULE.finding(
                use.subject,
                f"the mesh {use.label} consists of {shells} shells that move as one body",
                found=f"{shells} shells",
                intended="one shell, or pieces that move as one",
                declared=use.parts[0].source,
                remedy="Export pieces that move on their own as separate parts.",
            )


RULE = Rule("KF107", "mesh-several-shells", "note", __doc__, check, needs=("meshes",), also=("warning",))
