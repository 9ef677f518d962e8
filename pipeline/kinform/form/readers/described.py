"""What a robot description says word for word, placed in the design, and looked at beside the files that it names.

Geometry of the other kind (collision, where the parts are the visual one) is read here, measured and not kept.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from pydantic import TypeAdapter

from kinform.form.files import DesignFiles, is_mesh
from kinform.form.manifest.parts import ShapeTable
from kinform.form.meshes.primitives import primitive
from kinform.form.meshes.raw import MeshError
from kinform.form.readers.open_manifest import Scope
from kinform.formats.description.coverage import coverage_of
from kinform.formats.description.facts import Facts
from kinform.formats.description.mesh_files import MeshFiles, files_below
from kinform.formats.description.robot import Shape, Solid
from kinform.formats.description.start_overlaps import CollisionPiece, excluded_pairs, start_overlaps
from kinform.formats.description.tables import shape_table
from kinform.model.arrays import Array
from kinform.model.assembly import Part
from kinform.model.descriptions import Coverage, DescribedJoint, DescribedLink, Description, LooseMesh, StartOverlap

SIBLINGS_MOST = 300
"""Files of a package that are looked through for the names of meshes, at most: a package has a few dozen. Chosen, not
measured."""
SIBLING_BYTES = 4 << 20
"""Of each of these files, at most: texts that name meshes have some 10 kB, and data the rest. Chosen, not measured."""


_TEXTS = (".urdf", ".xacro", ".xml", ".sdf", ".mjcf", ".toml", ".launch", ".py", ".gazebo", ".world")
"""Suffixes of files that may name the meshes of a package."""

_SHAPES: TypeAdapter[ShapeTable] = TypeAdapter(ShapeTable)


def describe(scope: Scope, parts: Sequence[Part], files: DesignFiles) -> Description:
    """The description of a scope that has facts, with its names and poses in the design."""
    assert scope.facts is not None
    return _Describer(scope, scope.facts, parts, files).description()


class _Describer:
    def __init__(self, scope: Scope, facts: Facts, parts: Sequence[Part], files: DesignFiles):
        self.scope, self.facts, self.files = scope, facts, files
        self.parts = {str(part.name): part for part in parts}
        self.missing: dict[tuple[str, int], LooseMesh] = {}
        self._pieces: dict[tuple[str, int], CollisionPiece | None] = {}

    def description(self) -> Description:
        """All of it."""
        given, prefix = self.facts.description, self.scope.prefix
        for name, shapes in self.facts.absent.items():
            for shape in shapes:
                self._note_missing(shape, name, left_out=True)
        links = tuple(self._link(link) for link in given.links)
        joints = tuple(self._joint(joint) for joint in given.joints)
        loose = (*sorted(self.missing.values(), key=lambda mesh: (mesh.line, mesh.path)), *self._unreferenced())
        if loose:
            self.files.unsettled = True
        return replace(given, prefix=prefix, links=links, joints=joints, meshes=loose, overlaps=self._overlaps())

    def _link(self, link: DescribedLink) -> DescribedLink:
        X, prefix = self.scope.X_WF, self.scope.prefix
        return replace(
            link,
            name=prefix + link.name,
            rotation=X[:3, :3] @ link.rotation,
            position=X[:3, :3] @ link.position + X[:3, 3],
            parts=tuple(prefix + name for name in link.parts),
            coverage=self._coverage(link),
        )

    def _joint(self, joint: DescribedJoint) -> DescribedJoint:
        X, prefix = self.scope.X_WF, self.scope.prefix
        return replace(
            joint,
            name=prefix + joint.name,
            between=(prefix + joint.between[0], prefix + joint.between[1]),
            axis=None if joint.axis is None else X[:3, :3] @ joint.axis,
            point=None if joint.point is None else X[:3, :3] @ joint.point + X[:3, 3],
        )

    def _coverage(self, link: DescribedLink) -> Coverage | None:
        """Of the link's visual by its collision geometry; None where there is nothing to compare."""
        others = self.facts.others.get(link.name, ())
        if link.name in self.facts.alike:
            return None
        placed = [(shape, points) for shape in others if (points := self._points(link.name, shape)) is not None]
        whole = len(placed) == len(others) and link.name not in self.facts.absent
        if self.files.reading.geometry != "visual" or not whole:
            return None
        visual = []
        for name in link.parts:
            part = self.parts.get(self.scope.prefix + name)
            if part is not None and part.mesh is not None and len(part.mesh.vertices):
                local = np.linalg.inv(self.scope.X_WF) @ part.X_WP
                visual.append((part.mesh.vertices @ local[:3, :3].T + local[:3, 3], part.mesh.faces))
        return coverage_of(visual, [points for _, points in placed]) if placed else None

    def _overlaps(self) -> tuple[StartOverlap, ...]:
        """Of the collision geometry of links, in the world."""
        given = self.facts.description
        if self.files.reading.geometry != "visual":
            return ()
        pieces = {
            link.name: [p for s in self.facts.others.get(link.name, ()) if (p := self._piece(link.name, s)) is not None]
            for link in given.links
        }
        alike = self.facts.alike
        excluded = excluded_pairs(given.text)
        X, prefix = self.scope.X_WF, self.scope.prefix
        return tuple(
            replace(
                overlap,
                links=(prefix + overlap.links[0], prefix + overlap.links[1]),
                place=X[:3, :3] @ overlap.place + X[:3, 3],
            )
            for overlap in start_overlaps(pieces, given.joints)
            if not alike.issuperset(overlap.links) and frozenset(overlap.links) not in excluded
        )

    def _points(self, link: str, shape: Shape) -> Array | None:
        """Vertices (n, 3) m of a shape of a link in the frame of the description; None where they cannot be had."""
        piece = self._piece(link, shape)
        return None if piece is None else piece.points

    def _piece(self, link: str, shape: Shape) -> CollisionPiece | None:
        key = (link, id(shape))
        if key not in self._pieces:
            self._pieces[key] = self._read_piece(link, shape)
        return self._pieces[key]

    def _read_piece(self, link: str, shape: Shape) -> CollisionPiece | None:
        X, line = shape.X_FG, shape.at.line
        if isinstance(shape.geometry, Solid):
            solid = primitive(_SHAPES.validate_python(shape_table(shape.geometry, 1.0)), 1.0)
            return CollisionPiece(solid.vertices @ X[:3, :3].T + X[:3, 3], solid.faces, line)
        if not shape.geometry.is_file():
            self._note_missing(shape, link, left_out=False)
            return None
        try:
            raw = self.files.loose(shape.geometry)
        except (MeshError, OSError):
            return None
        if raw is None or not len(raw.vertices):
            return None
        scale = shape.metres * np.array(shape.scale)
        faces = raw.faces if scale.prod() > 0.0 else raw.faces[:, ::-1]
        return CollisionPiece((raw.vertices * scale) @ X[:3, :3].T + X[:3, 3], np.asarray(faces), line)

    def _note_missing(self, shape: Shape, link: str, *, left_out: bool) -> None:
        missing, at = Path(str(shape.geometry)), shape.at
        path = self.files.shown(missing)
        if (self.files.top / path).is_file():  # by way of a folder that is not there
            below = missing.is_relative_to(self.files.top)
            path = (missing.relative_to(self.files.top) if below else missing).as_posix()
        loose = LooseMesh(path, at.file, at.line, True, self.scope.prefix + link, left_out)
        self.missing.setdefault((path, at.line), loose)

    def _unreferenced(self) -> Iterable[LooseMesh]:
        """Mesh files in the folders of the description's own meshes that neither it nor a file beside it names."""
        used = {os.path.realpath(self.files.top / part.mesh.path) for part in self.parts.values() if part.mesh}
        other = [shape.geometry for shapes in self.facts.others.values() for shape in shapes]
        used |= {os.path.realpath(path) for path in other if isinstance(path, Path)}
        mine = [os.path.realpath(path) for path in self._own_meshes()]
        folders = sorted({folder for path in mine if os.path.isdir(folder := os.path.dirname(path))})
        there = [os.path.join(folder, name) for folder in folders for name in sorted(os.listdir(folder))]
        self.files.listed.update(map(Path, folders))
        strange = [path for path in there if is_mesh(Path(path)) and path not in used]
        self.files.unsettled |= bool(strange)
        texts = list(self._texts()) if strange else []
        given = self.facts.description
        for path in strange:
            stem = os.path.splitext(os.path.basename(path))[0].encode()
            if not any(stem in text for text in texts):
                yield LooseMesh(self.files.shown(Path(path)), given.file, 1, False)

    def _own_meshes(self) -> Iterable[Path]:
        for link in self.facts.description.links:
            for name in link.parts:
                part = self.parts.get(self.scope.prefix + name)
                if part is not None and part.mesh is not None and part.mesh.path:
                    yield self.files.top / part.mesh.path
        for shapes in self.facts.others.values():
            yield from (shape.geometry for shape in shapes if isinstance(shape.geometry, Path))

    def _texts(self) -> Iterable[bytes]:
        """What may name the meshes: the description, and the texts of its package."""
        yield self.facts.description.text.encode()
        path = self.files.top / self.facts.description.file
        boundary = self.files.boundary
        for other in files_below(MeshFiles(path, {}, boundary=boundary).home, _TEXTS)[:SIBLINGS_MOST]:
            if boundary.allows(other) and other.stat().st_size <= SIBLING_BYTES:
                yield boundary.read(other)
