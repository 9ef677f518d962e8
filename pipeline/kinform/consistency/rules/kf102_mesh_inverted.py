"""The mesh is closed but inside out, or a shell of it is: its facets face into the material.

Why it matters: outside and inside are exchanged. Bores are read as shafts and the part mates with
nothing, and its volume and mass come out negative.

What to do: flip the normals of the whole mesh ("reverse", "flip", "recalculate outside" in mesh
programs) and export again. A mesh that was mirrored by a negative scale is inside out too.

Example: a cube of 10 mm with a signed volume of -1000 mm³.
"""

from __future__ import annotations

from dataclasses import replace

from kinform.consistency.context import Context, MeshUse
from kinform.consistency.questions.mesh_faults import inverted_facet
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.units import METRES_PER_UNIT
from kinform.foundation.words import volume
from kinform.model.findings import Witness, computed


def check(context: Context) -> Findings:
    """Closed meshes of negative volume, and those with shells of negative volume that are no cavities."""
    for use, faults in zip(context.meshes, context.shell_faults, strict=True):
        health = use.mesh.health
        if faults.inverted:
            face = "faces" if faults.inverted == 1 else "face"
            yield RULE.finding(
                use.subject,
                f"{faults.inverted} of the {health.shells} shells of the mesh {use.label} {face} the other way",
                found=f"{faults.inverted} of {health.shells} shells inside out",
                intended="facet normals out of the material in all shells",
                declared=use.parts[0].source,
                remedy="Flip the facets of the shells that are inside out and export the mesh again.",
                witness=inverted_facet(use.mesh, use.subject[0]),
            )
        elif use in context.closed_meshes and health.volume < 0.0:
            yield RULE.finding(
                use.subject,
                f"the mesh {use.label} is inside out: its volume is {volume(health.volume, context.units)}",
                found=volume(health.volume, context.units),
                intended="a positive volume: facet normals out of the material",
                declared=use.parts[0].source,
                remedy="Flip the facets of the whole mesh and export it again.",
                witness=_witness(use, context),
            )


def _witness(use: MeshUse, context: Context) -> Witness | None:
    """The volume of the file: the mesh has been turned. Of descriptions a scale may have turned it before."""
    described = {name for d in context.assembly.descriptions for link in d.links for name in link.parts}
    if use.mesh.body is not None or not described.isdisjoint(use.subject):
        return None
    metres = METRES_PER_UNIT.get(use.parts[0].units)
    if metres is None:
        return None
    witness = computed("volume of a file", -use.mesh.health.volume, 0.0, metres=metres)
    return None if witness is None else replace(witness, source_file=use.mesh.path)


RULE = Rule("KF102", "mesh-inverted", "error", __doc__, check, needs=("closed meshes",))
