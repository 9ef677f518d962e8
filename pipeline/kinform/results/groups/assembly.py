"""`/assembly`: parts, meshes, poses, groups, assumptions, tolerances, and under it function and request."""

from __future__ import annotations

from collections.abc import Sequence

import h5py
import numpy as np

from kinform.design import Design
from kinform.frozen import dataclass
from kinform.model.arrays import freeze
from kinform.model.assembly import Assembly, Mesh, Part
from kinform.model.tolerances import Tolerances
from kinform.results.groups.checks import CHECK
from kinform.results.groups.function import FUNCTION, REQUEST
from kinform.results.held import HeldGroup
from kinform.results.layout import Layout, Ragged, Row, Rows, Subgroup, Table, Texts
from kinform.results.records import columns_of, defaults, hint, hints
from kinform.results.table import (
    FACETS,
    integer,
    read_array,
    read_rows,
    read_texts,
    write_array,
    write_rows,
    write_texts,
)


@dataclass(frozen=True)
class _Meshes:
    meshes: tuple[Mesh, ...]


class _Parts:
    """Parts with the number of their mesh, their poses and stated masses; and the meshes, each once."""

    dataset, fields = "parts", ("parts",)
    columns = columns_of(hint(Part), frozenset({"mesh", "X_WP", "override"}))
    columns = (columns[0], integer("mesh", optional=True), *columns[1:])
    overrides = Table("overrides", field="override", owner="part")
    meshes = Layout(
        _Meshes,
        Table(
            "meshes",
            Ragged("vertices", width=3),
            Ragged("faces", width=3, dtype=FACETS),
            first=("digest", "path", "body", "health", "origin", "resolution"),
        ),
    )

    def write(self, group: h5py.Group, cls: type, records: Sequence[Assembly]) -> None:
        parts = records[0].parts
        distinct: dict[tuple[object, ...], Mesh] = {}
        for part in parts:
            if part.mesh is not None:
                distinct.setdefault(_identity(part.mesh), part.mesh)
        place = {key: k for k, key in enumerate(distinct)}
        numbers = [None if part.mesh is None else place[_identity(part.mesh)] for part in parts]
        of_parts = {column.field: [getattr(part, column.field) for part in parts] for column in self.columns}
        of_parts["mesh"] = numbers
        write_rows(group, "parts", self.columns, list(of_parts.values()))
        poses = np.array([part.X_WP for part in parts]).reshape(-1, 4, 4)
        write_array(group, "X_WP", poses, hints(Part)["X_WP"].unit or "")
        self.overrides.write(group, Part, parts)
        self.meshes.write(group, _Meshes(tuple(distinct.values())))

    def read(self, group: HeldGroup, cls: type, rows: Rows) -> None:
        meshes = self.meshes.read(group).meshes
        parts = read_rows(group, "parts", self.columns, defaults(Part))
        self.overrides.read(group, Part, parts)
        for row, pose in zip(parts, read_array(group, "X_WP"), strict=True):
            row["mesh"] = None if row["mesh"] is None else meshes[row["mesh"]]
            row["X_WP"] = freeze(pose.copy())
        rows[0]["parts"] = tuple(Part(**row) for row in parts)


def _identity(mesh: Mesh) -> tuple[object, ...]:
    return (mesh.digest, mesh.path, mesh.body, mesh.health, mesh.origin.tobytes(), mesh.resolution, mesh.colour)


HEADER = Row("header", "name", "units", "ground", "infer_fasteners", "source")
LAYOUT = Layout(
    Assembly,
    HEADER,
    Table("tolerances"),
    _Parts(),
    Table("groups", Table("group_overrides", field="override", owner="group")),
    Table("assumptions"),
    Table("subassemblies"),
    Texts("files"),
    Texts("notes"),
    Table(
        "descriptions",
        Table(
            "described_links",
            Table("stated_masses", field="stated", owner="link"),
            Table("collision_coverage", field="coverage", owner="link"),
            field="links",
            owner="description",
        ),
        Table("described_joints", field="joints", owner="description"),
        Table("loose_meshes", field="meshes", owner="description"),
        Table("start_overlaps", field="overlaps", owner="description", if_any=True),
        if_any=True,
    ),
    Subgroup("function", FUNCTION),
    Subgroup("check", CHECK),
    Subgroup("simulation", REQUEST),
)
GIST = Layout(Assembly, HEADER, Texts("files"), Texts("notes"), Subgroup("function", FUNCTION))


def write(group: h5py.Group, design: Design) -> None:
    """Write everything the manifest and the meshes gave, so that no later stage needs them, and the hashes of their
    files."""
    LAYOUT.write(group, design.assembly)
    files = design.fingerprints.files
    if files:
        write_texts(group, "contents", [f"{content} {name}" for name, content in sorted(files.items())])


def read(group: HeldGroup) -> Assembly:
    """The assembly that `write` wrote; parts of one mesh share it."""
    assembly: Assembly = LAYOUT.read(group)
    return assembly


def read_header(group: HeldGroup) -> Assembly:
    """The assembly without parts and groups: its name, source, function, files and notes."""
    return Assembly(
        **GIST.read_fields(group),
        parts=(),
        groups=(),
        assumptions=(),
        tolerances=Tolerances(),
        simulation=None,
        subassemblies=(),
    )


def read_files(group: HeldGroup) -> tuple[str, ...]:
    """The files that were read, relative to the manifest."""
    return read_texts(group, "files")


def read_contents(group: HeldGroup) -> dict[str, str]:
    """SHA-256 (hex) of the content of each file, by its name; empty where the file does not say."""
    lines = read_texts(group, "contents") if "contents" in group else ()
    return {name: content for content, name in (line.split(" ", 1) for line in lines)}
