"""A robot description names a mesh that is not there, or leaves meshes beside its own unnamed.

A visual mesh that is not there is wrong input and ends the reading; a mesh of the other kind (collision) that is not
there is an error here. Mesh files in the folders of the description's meshes that neither it nor another text of its
package names are one note.

Why it matters: a planner that cannot load a collision mesh sees no obstacle there. A file that nobody names is
forgotten, or misspelt where it was meant.

What to do: correct the file name, or add the file; remove what nobody uses.

Example: `arm_collision.stl` was renamed to `arm_coll.stl`, and the URDF was not.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, quoted
from kinform.model.assembly import Source
from kinform.model.findings import Finding


def check(context: Context) -> Outcome:
    """The loose meshes of every description."""
    findings: list[Finding] = []
    for description in context.assembly.descriptions:
        for mesh in description.meshes:
            if mesh.missing:
                findings.append(
                    RULE.finding(
                        [mesh.path],
                        f"the mesh {mesh.path} does not exist: the link has no such collision geometry",
                        found="no file",
                        intended="a mesh",
                        declared=Source(mesh.file, mesh.line),
                        remedy="Correct the file name, or add the file.",
                    )
                )
        unnamed = [mesh.path for mesh in description.meshes if not mesh.missing]
        if unnamed:
            findings.append(
                RULE.at("note").finding(
                    [description.file],
                    f"{counted(len(unnamed), 'mesh file')} beside those of {description.file} "
                    f"{'is' if len(unnamed) == 1 else 'are'} named by no file of its package: {quoted(unnamed)}",
                    found=counted(len(unnamed), "file"),
                    intended="files that are used",
                    declared=Source(description.file, 1),
                    remedy="Remove them, or name them where they were meant.",
                )
            )
    return decided(findings)


RULE = Rule("KF131", "mesh-loose", "error", __doc__, check, needs=("descriptions",))
