"""Reads the files of a design: each once, kept inside the folder of the manifest, every fault collected."""

from __future__ import annotations

import os
from pathlib import Path

from kinform.form.meshes.bodies import select_body
from kinform.form.meshes.health import build_mesh
from kinform.form.meshes.obj import read_obj
from kinform.form.meshes.raw import Fault, MeshError, RawMesh
from kinform.form.meshes.stl import read_stl
from kinform.form.problems import Problems, did_you_mean
from kinform.model.assembly import Mesh

__all__ = ["Sources", "read_raw"]

READERS = {".stl": read_stl, ".obj": read_obj}


def read_raw(path: Path) -> RawMesh:
    """Facets of an STL or OBJ file; raises MeshError, or OSError where it cannot be opened."""
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise MeshError([Fault(f"is no mesh that kinform reads ({path.suffix or 'no suffix'})", "export STL or OBJ")])
    return reader(path)


class Sources:
    """Files below the folder of the top manifest; meshes with the same content are one object."""

    def __init__(self, top: Path, problems: Problems, allow_outside: bool):
        self.top = top
        self.problems = problems
        self.files: set[str] = set()
        self._outside = allow_outside
        self._raw: dict[Path, RawMesh | MeshError] = {}
        self._built: dict[tuple[Path, str | None, float, float | None, bool], Mesh | None] = {}
        self._same: dict[tuple[str, str, str | None], Mesh] = {}

    def shown(self, path: Path) -> str:
        """The path as results and messages show it: relative to the top manifest's folder."""
        return Path(os.path.relpath(path, self.top)).as_posix()

    def find(self, stated: str, folder: Path, file: str, line: int, what: str) -> Path | None:
        """The file that a manifest states, relative to its folder; None after noting what is wrong."""
        path = folder / stated
        real = Path(os.path.realpath(path))
        inside = any(real.is_relative_to(os.path.realpath(root)) for root in (self.top, folder))
        if not inside and not self._outside:
            remedy = "move it into the folder of the manifest, or allow this with --allow-outside"
            self.problems.add(f"{what} {stated} lies outside the manifest's folder", file, line, remedy)
            return None
        if not path.is_file():
            near = [p.name for p in path.parent.iterdir() if p.is_file()] if path.parent.is_dir() else []
            remedy = (
                did_you_mean(path.name, near, "the files there") if near else f"there is no folder {path.parent.name}"
            )
            message = f"{what} {stated} " + ("is a folder" if path.is_dir() else "does not exist")
            self.problems.add(message, file, line, remedy)
            return None
        self.files.add(self.shown(path))
        return path

    def mesh(
        self,
        path: Path,
        body: str | None,
        metres: float,
        weld: float | None,
        solid: bool,
        file: str,
        line: int,
    ) -> Mesh | None:
        """The mesh of a file that `find` found; None after noting its faults at the manifest's line."""
        key = (path, body, metres, weld, solid)
        if key not in self._built:
            try:
                raw = self._read(path)
                chosen = raw if body is None else select_body(raw, body)
                built = build_mesh(chosen, metres, weld, path=self.shown(path), body=body, solid=solid)
                self._built[key] = self._same.setdefault((built.digest, built.path, body), built)
            except MeshError as error:
                self._note(error, path, file, line)
                self._built[key] = None
        return self._built[key]

    def _read(self, path: Path) -> RawMesh:
        if path not in self._raw:
            try:
                self._raw[path] = read_raw(path)
            except MeshError as error:
                self._raw[path] = error
            except OSError as error:
                self._raw[path] = MeshError([Fault(f"cannot be read: {error.strerror}", "check its permissions")])
        found = self._raw[path]
        if isinstance(found, MeshError):
            raise found
        return found

    def _note(self, error: MeshError, path: Path, file: str, line: int) -> None:
        for fault in error.faults:
            if fault.line is not None:
                self.problems.add(f"the mesh {fault.message}", self.shown(path), fault.line, fault.remedy)
            else:
                self.problems.add(f"mesh {self.shown(path)} {fault.message}", file, line, fault.remedy)
