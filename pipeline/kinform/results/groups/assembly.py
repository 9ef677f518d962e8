"""`/assembly`: parts, meshes, poses, groups, assumptions, tolerances, and under it function and request."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import h5py
import numpy as np

from kinform.model.arrays import freeze
from kinform.model.assembly import (
    Assembly,
    Assumption,
    Group,
    MassOverride,
    Mesh,
    MeshHealth,
    Part,
    Source,
    Subassembly,
)
from kinform.model.checks import CheckSettings
from kinform.model.tolerances import Tolerances
from kinform.results.groups import checks as _checks
from kinform.results.groups import function as _function
from kinform.results.table import (
    FACETS,
    flag,
    integer,
    matrix,
    pair,
    read_array,
    read_ragged,
    read_rows,
    read_texts,
    real,
    text,
    texts,
    vector,
    write_array,
    write_ragged,
    write_rows,
    write_texts,
)

__all__ = ["read", "read_header", "write"]

_SOURCE = (text("source_file"), integer("source_line", optional=True))
_HEADER = (text("name"), text("units"), text("ground"), flag("infer_fasteners"), *_SOURCE)
_PARTS = (
    text("name"), integer("mesh", optional=True), flag("solid"), text("material"),
    real("density", "kg/m³"), text("units"), *_SOURCE,
)  # fmt: skip
_OVERRIDES = (
    integer("part"), real("mass", "kg"), vector("centre_of_mass", "m"), matrix("inertia", "kg·m²"),
)  # fmt: skip
_HEALTH = (
    integer("facets"), integer("vertices"), flag("watertight"), flag("consistent_winding"),
    text("manifold_status"), real("volume", "m³"), integer("degenerate_facets"),
    integer("duplicate_facets"), integer("open_edges"), integer("overused_edges"), integer("shells"),
    real("weld", "m"),
)  # fmt: skip
_MESHES = (text("digest"), text("path"), text("body"), *_HEALTH)
_GROUPS = (text("name"), texts("parts"), *_SOURCE)
_ASSUMPTIONS = (
    pair("between", text, ("between_a", "between_b")), text("type"), flag("ignore"), vector("axis", "1"),
    vector("point", "m"), real("pitch", "m"), text("reason"), *_SOURCE,
)  # fmt: skip
_SUBASSEMBLIES = (text("name"), text("file"), integer("mobility", optional=True), *_SOURCE)
_UNITS_OF_TOLERANCES = {
    "contact": "m", "weld": "m", "alignment": "rad", "smooth_edge": "rad", "coplanar": "rad", "contact_cap": "m",
}  # fmt: skip
_TOLERANCES = tuple(real(f.name, _UNITS_OF_TOLERANCES.get(f.name, "1")) for f in fields(Tolerances))


def write(group: h5py.Group, assembly: Assembly) -> None:
    """Write everything the manifest and the meshes gave, so that no later stage needs them."""
    write_rows(group, "header", _HEADER, [_row(assembly)])
    write_rows(group, "tolerances", _TOLERANCES, [vars(assembly.tolerances)])
    meshes = _distinct(assembly)
    index = {id(mesh): i for i, mesh in enumerate(meshes)}
    owner = {_identity(mesh): i for i, mesh in enumerate(meshes)}
    rows = []
    for part in assembly.parts:
        mesh = part.mesh
        number = None if mesh is None else index.get(id(mesh), owner[_identity(mesh)])
        rows.append(_row(part) | {"mesh": number})
    write_rows(group, "parts", _PARTS, rows)
    _write_poses(group, assembly)
    write_rows(group, "meshes", _MESHES, [vars(mesh) | vars(mesh.health) for mesh in meshes])
    write_ragged(group, "vertices", [mesh.vertices for mesh in meshes], "m", width=3)
    write_ragged(group, "faces", [mesh.faces for mesh in meshes], "1", width=3, dtype=FACETS)
    write_rows(group, "groups", _GROUPS, map(_row, assembly.groups))
    write_rows(group, "assumptions", _ASSUMPTIONS, map(_row, assembly.assumptions))
    write_rows(group, "subassemblies", _SUBASSEMBLIES, map(_row, assembly.subassemblies))
    write_texts(group, "files", assembly.files)
    write_texts(group, "notes", assembly.notes)
    _function.write(group.create_group("function"), assembly.function)
    _checks.write(group.create_group("check"), assembly.check)
    if assembly.simulation is not None:
        _function.write_request(group.create_group("simulation"), assembly.simulation)


def read(group: h5py.Group) -> Assembly:
    """The assembly that `write` wrote; parts of one mesh share it."""
    (header,) = read_rows(group, "header", _HEADER)
    (tolerances,) = read_rows(group, "tolerances", _TOLERANCES)
    request = group.get("simulation")
    return Assembly(
        **_with_source(header),
        parts=_read_parts(group),
        groups=tuple(Group(**_with_source(row)) for row in read_rows(group, "groups", _GROUPS)),
        assumptions=tuple(Assumption(**_with_source(row)) for row in read_rows(group, "assumptions", _ASSUMPTIONS)),
        tolerances=Tolerances(**tolerances),
        function=_function.read(group["function"]),
        simulation=None if request is None else _function.read_request(request),
        subassemblies=tuple(
            Subassembly(**_with_source(row)) for row in read_rows(group, "subassemblies", _SUBASSEMBLIES)
        ),
        files=read_texts(group, "files"),
        notes=read_texts(group, "notes"),
        check=_checks.read(group["check"]) if "check" in group else CheckSettings(),
    )


def read_header(group: h5py.Group) -> Assembly:
    """The assembly without parts and groups: its name, source, function, files and notes."""
    (header,) = read_rows(group, "header", _HEADER)
    return Assembly(
        **_with_source(header),
        parts=(),
        groups=(),
        assumptions=(),
        tolerances=Tolerances(),
        function=_function.read(group["function"]),
        simulation=None,
        subassemblies=(),
        files=read_texts(group, "files"),
        notes=read_texts(group, "notes"),
    )


def _row(record: Any) -> dict[str, Any]:
    source: Source = record.source
    row: dict[str, Any] = vars(record) | {"source_file": source.file, "source_line": source.line}
    return row


def _with_source(row: Mapping[str, Any]) -> dict[str, Any]:
    rest = {key: value for key, value in row.items() if key not in ("source_file", "source_line")}
    return rest | {"source": Source(row["source_file"], row["source_line"])}


def _identity(mesh: Mesh) -> tuple[object, ...]:
    return (mesh.digest, mesh.path, mesh.body, mesh.health)


def _distinct(assembly: Assembly) -> list[Mesh]:
    """The meshes, each once, in the order of the parts that use them first."""
    found: dict[tuple[object, ...], Mesh] = {}
    for part in assembly.parts:
        if part.mesh is not None:
            found.setdefault(_identity(part.mesh), part.mesh)
    return list(found.values())


def _write_poses(group: h5py.Group, assembly: Assembly) -> None:
    poses = [part.X_WP for part in assembly.parts]
    write_array(group, "X_WP", np.array(poses).reshape(-1, 4, 4), "1 (rotation), m (last column)")
    overrides = [
        vars(part.override) | {"part": i} for i, part in enumerate(assembly.parts) if part.override is not None
    ]
    write_rows(group, "overrides", _OVERRIDES, overrides)


def _read_meshes(group: h5py.Group) -> list[Mesh]:
    names = [column.field for column in _HEALTH]
    meshes = []
    rows = read_rows(group, "meshes", _MESHES)
    shapes = zip(read_ragged(group, "vertices"), read_ragged(group, "faces"), strict=True)
    for row, (vertices, faces) in zip(rows, shapes, strict=True):
        health = MeshHealth(**{name: row.pop(name) for name in names})
        meshes.append(Mesh(vertices=vertices, faces=faces, health=health, **row))
    return meshes


def _read_parts(group: h5py.Group) -> tuple[Part, ...]:
    meshes = _read_meshes(group)
    overrides = {row.pop("part"): MassOverride(**row) for row in read_rows(group, "overrides", _OVERRIDES)}
    poses = read_array(group, "X_WP")
    parts = []
    for i, row in enumerate(map(_with_source, read_rows(group, "parts", _PARTS))):
        number = row.pop("mesh")
        mesh = None if number is None else meshes[number]
        pose = freeze(poses[i].copy())
        parts.append(Part(**row, mesh=mesh, X_WP=pose, override=overrides.get(i)))
    return tuple(parts)
