"""An assembly whose manifests are as they were: only meshes are looked at again, and no manifest is parsed.

Whatever is not as plain as that is left to `kinform.form.readers.assembly`, which also finds the words for what is
wrong.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from kinform.form.files import DesignFiles, earlier_meshes, is_mesh, mesh_use
from kinform.form.problems import Problems
from kinform.form.sources import is_scene
from kinform.foundation.boundary import Boundary
from kinform.model.assembly import Assembly, Part


def reload_meshes(
    path: Path, earlier: Assembly, contents: Mapping[str, str], *, allow_outside: bool = False
) -> tuple[Assembly, dict[str, str]] | None:
    """The assembly of the manifest at `path`, and the SHA-256 (hex) of every file, where all but mesh files have the
    content that they had; else None.

    `earlier` is what the present code read of the manifest when its files had these `contents`.
    """
    if earlier.descriptions or path.name not in contents or set(contents) != set(earlier.files):
        return None  # of a description, meshes count that are no parts
    problems = Problems()
    files = DesignFiles(
        path.parent, problems, Boundary(path, allow_outside=allow_outside), earlier_meshes(earlier, contents)
    )
    meshes = []
    for name, content in contents.items():
        file = files.find(name, path.parent, path.name, 1, "the file")
        if file is None or (not is_mesh(file) and files.content(file) != content):
            return None
        if is_mesh(file):
            meshes.append(file)
    files.hash_meshes(meshes)
    if any(is_scene(file) and files.content(file) != contents[files.shown(file)] for file in meshes):
        return None  # names and poses may be others too
    parts = []
    for part in earlier.parts:
        reloaded = _with_mesh(part, path.parent, files, earlier.tolerances.weld)
        if reloaded is None or len(problems):
            return None
        parts.append(reloaded)
    now = files.contents()
    return (replace(earlier, parts=tuple(parts)), now) if now else None


def _with_mesh(part: Part, top: Path, files: DesignFiles, weld: float | None) -> Part | None:
    """The part with its mesh as the file is now; None where that is no mesh any more."""
    if part.mesh is None:
        return part
    mesh = files.mesh(top / part.mesh.path, mesh_use(part, weld), part.source.file, 1)
    if mesh is None:
        return None
    if mesh is part.mesh:
        return part
    return replace(part, mesh=mesh) if np.array_equal(mesh.origin, part.mesh.origin) else None
