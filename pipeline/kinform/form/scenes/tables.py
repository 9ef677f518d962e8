"""A scene as the tables of a manifest: a part for each mesh where it stands, named as the file does."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from kinform.form.meshes.raw import MeshError
from kinform.form.readers.places import Places
from kinform.form.scenes.reading import scene_once
from kinform.form.scenes.scene import EXPORT, Scene, ScenePart, body_names, parts_of
from kinform.form.sources import Source, SourceTables
from kinform.foundation.algebra.spatial import quaternions
from kinform.foundation.name_hints import first_names, in_quotes
from kinform.foundation.regular_files import not_a_file
from kinform.foundation.units import metres_per


def tables(source: Source) -> SourceTables | None:
    """The tables of a CAD or scene file; every problem is noted."""
    fault = not_a_file(source.path)
    if fault is not None:
        source.problems.add(fault, source.file, None, "write the scene to a file")
        return None
    try:
        scene = scene_once(source.boundary.read(source.path), source.path, source.reading)
        parts = parts_of(scene)
    except OSError as error:
        source.problems.add(f"cannot be read: {error.strerror}", source.file, None, "check its permissions")
        return None
    except MeshError as error:
        for told in error.faults:
            source.problems.add(told.message, source.file, told.line, told.remedy)
        return None
    if not parts:
        source.problems.add("has no part: no mesh of triangles stands in its scene", source.file, None, EXPORT)
        return None
    unit = scene.units or source.units
    if unit is None:
        suffix = source.path.suffix.lower()[1:].upper()
        message = f"is {suffix}, which has no unit of length"
        source.problems.add(message, source.file, None, "add --units mm; or name it in a manifest: from, and units")
        return None
    said = source.units or scene.shown or unit
    raw = {
        "schema": 1,
        "assembly": {"name": source.path.stem.replace("/", "_"), "units": said},
        "part": _part_tables(parts, scene, source, unit, said),
    }
    notes = tuple(f"{source.file}: {note}" for note in (*scene.notes, *_renamed(parts)))
    return SourceTables(raw, Places({(): (source.file, 1)}), notes, scene.files, described=False)


def _part_tables(parts: list[ScenePart], scene: Scene, source: Source, unit: str, said: str) -> list[dict[str, Any]]:
    """Parts whose meshes are in `unit`, in a manifest in `said`."""
    bodies = body_names(scene)
    path = Path(os.path.relpath(os.path.realpath(source.path), os.path.realpath(source.folder))).as_posix()
    lengths = metres_per(unit) / metres_per(said)
    out = []
    for part in parts:
        table: dict[str, Any] = {"name": part.name, "mesh": path, "body": bodies[part.mesh]}
        if unit != said:
            table["units"] = unit
        if part.scale != (1.0, 1.0, 1.0):
            table["scale"] = list(part.scale)
        if part.X[:3, 3].any():
            table["position"] = [float(v) * lengths for v in part.X[:3, 3]]
        if not np.array_equal(part.X[:3, :3], np.eye(3)):
            table["quaternion"] = [float(v) for v in quaternions(part.X[None, :3, :3])[0]]
        out.append(table)
    return out


def _renamed(parts: list[ScenePart]) -> list[str]:
    """A note of the parts that have other names than in the file."""
    changed = [f"{in_quotes(part.original)} is {in_quotes(part.name)}" for part in parts if part.name != part.original]
    return (
        [f"names that are repeated, missing, or have a slash were changed: {first_names(changed)}"] if changed else []
    )
