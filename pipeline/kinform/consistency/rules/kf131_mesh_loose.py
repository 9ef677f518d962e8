"""A robot description names a mesh that is not there, or leaves meshes beside its own unnamed.

A mesh that is not there is an error, told once a file. The link stands without it: stated masses, sides and collision
geometry are not compared there, and a joint may be found not held for want of what is missing. Where none of the meshes
is there, nothing can be judged, and the reading ends. A description of which no link has the geometry that is read is
judged by nothing: then the rule is inconclusive. Mesh files in the folders of the description's meshes that
neither it nor another text of its package names are one note.

Why it matters: a simulator refuses the description, and a planner that cannot load a collision mesh sees no obstacle
there. A file that nobody names is forgotten, or misspelt where it was meant.

What to do: correct the file name, or add the file; remove what nobody uses. The remedy names a file of the same folder
that nobody names and whose name is like it.

Example: `arm_collision.stl` was renamed to `arm_coll.stl`, and the URDF was not.
"""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from pathlib import PurePosixPath

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, settled
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, quoted
from kinform.model.assembly import Source
from kinform.model.descriptions import Description, LooseMesh
from kinform.model.findings import Finding


def check(context: Context) -> Outcome:
    """The loose meshes of every description."""
    findings: list[Finding] = []
    for description in context.assembly.descriptions:
        missing: dict[str, list[LooseMesh]] = {}
        for mesh in description.meshes:
            if mesh.missing:
                missing.setdefault(mesh.path, []).append(mesh)
        unnamed = [mesh.path for mesh in description.meshes if not mesh.missing]
        findings += (_missing(uses, unnamed) for uses in missing.values())
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
    bare = [description for description in context.assembly.descriptions if _is_bare(context, description)]
    return settled(findings, "; ".join(map(_nothing, bare)))


def _is_bare(context: Context, description: Description) -> bool:
    """Whether none of its links has geometry, as it was read."""
    solid = {part.name for part in context.assembly.parts if part.mesh is not None}
    return bool(description.links) and all(solid.isdisjoint(link.parts) for link in description.links)


def _nothing(description: Description) -> str:
    """Why such a description is judged by nothing."""
    kinds = {
        "visual": sum(x.visuals for x in description.links),
        "collision": sum(x.collisions for x in description.links),
    }
    there = [f"; it has {kind} geometry (--geometry {kind})" for kind, many in kinds.items() if many]
    return f"no link of {description.file} has geometry to compare with{''.join(there[:1])}"


def _missing(uses: Sequence[LooseMesh], unnamed: Sequence[str]) -> Finding:
    """One finding of a file, however often it is named; `unnamed` are files that it may be."""
    mesh, many = uses[0], len(uses) > 1
    links = quoted(dict.fromkeys(use.link for use in uses))
    left_out = any(use.left_out for use in uses)
    lost = "it is judged without it" if left_out else "it has no such collision geometry"
    of = f"link {links}"
    if many:
        of = f"{links}, named {len(uses)} times,"
        lost = "they are judged without it" if left_out else "they have no such collision geometry"
    return RULE.finding(
        [mesh.path],
        f"the mesh {mesh.path} of {of} does not exist: {lost}",
        found="no file",
        intended="a mesh",
        declared=Source(mesh.file, mesh.line),
        remedy=f"Correct the file name{_meant(mesh.path, unnamed)}, or add the file.",
    )


def _meant(path: str, unnamed: Sequence[str]) -> str:
    """ ": `arm_coll.stl` is there, and nothing names it": the file of the same folder that is most like it."""
    wanted = PurePosixPath(path)
    beside = {file.stem: file.name for file in map(PurePosixPath, unnamed) if file.parent == wanted.parent}
    close = difflib.get_close_matches(wanted.stem, beside, n=1)
    return f": `{beside[close[0]]}` is there, and nothing names it" if close else ""


RULE = Rule("KF131", "mesh-loose", "error", __doc__, check, needs=("descriptions",), also=("note",))
