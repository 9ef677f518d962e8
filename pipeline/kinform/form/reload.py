"""An assembly whose manifests are as they were: only meshes are looked at again, and nothing of the manifests is parsed.

Whatever is not as plain as that is left to `kinform.form.readers.assembly`, which also finds the words for what is wrong.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from kinform.form.files import MESHES, Sources, earlier_meshes
from kinform.form.problems import Problems
from kinform.foundation.units import metres_per
from kinform.model.assembly import Assembly, Part

__all__ = ["reload_meshes"]


def reload_meshes(
    path: Path, earlier: Assembly, files: Mapping[str, str], *, allow_outside: bool = False
) -> tuple[Assembly, dict[str, str]] | None:
    """The assembly of the manifest at `path`, and the SHA-256 (hex) of every file, where all but mesh files have the
    content that they had; else None.

    `earlier` is what the present code read of the manifest when its files had the contents `files`.
    """
    if path.name not in files or set(files) != set(earlier.files):
        return None
    problems = Problems()
    sources = Sources(path.parent, problems, allow_outside, earlier_meshes(earlier, files))
    meshes = []
    for name, content in files.items():
        found = sources.find(name, path.parent, path.name, 1, "the file")
        if found is None or (found.suffix.lower() not in MESHES and sources.content(found) != content):
            return None
        if found.suffix.lower() in MESHES:
            meshes.append(found)
    sources.look_at(meshes)
    parts = []
    for part in earlier.parts:
        again = _with_mesh(part, path.parent, sources, earlier.tolerances.weld)
        if again is None or len(problems):
            return None
        parts.append(again)
    contents = sources.contents()
    return (replace(earlier, parts=tuple(parts)), contents) if contents else None


def _with_mesh(part: Part, top: Path, sources: Sources, weld: float | None) -> Part | None:
    """The part with its mesh as the file is now; None where that is no mesh any more."""
    known = part.mesh
    if known is None:
        return part
    metres = metres_per(part.units)
    mesh = sources.mesh(top / known.path, known.body, metres, weld, part.solid, part.source.file, 1)
    if mesh is None:
        return None
    return part if mesh is known else replace(part, mesh=mesh)
