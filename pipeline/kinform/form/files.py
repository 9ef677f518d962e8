"""Reads the files of a design: each once, kept inside the folder of the manifest, every fault collected."""

from __future__ import annotations

import contextlib
import hashlib
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from kinform.form.meshes.raw import Fault, MeshError, RawMesh
from kinform.form.problems import Problems, did_you_mean
from kinform.foundation.units import metres_per
from kinform.model.assembly import Assembly, Mesh

__all__ = ["MESHES", "Sources", "content", "earlier_meshes", "read_raw"]

MESHES = (".stl", ".obj")
"""Suffixes of mesh files."""


def content(data: bytes) -> str:
    """SHA-256 (hex) of the content of a file."""
    return hashlib.sha256(data).hexdigest()


def _content_of(path: Path) -> str:
    with open(path, "rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _content_or_none(path: Path) -> str | None:
    try:
        return _content_of(path)
    except OSError:
        return None


def read_raw(path: Path) -> RawMesh:
    """Facets of an STL or OBJ file; raises MeshError, or OSError where it cannot be opened."""
    return _parsed(path, b"" if path.suffix.lower() not in MESHES else path.read_bytes())


def _parsed(path: Path, data: bytes) -> RawMesh:
    if path.suffix.lower() not in MESHES:
        raise MeshError([Fault(f"is no mesh that kinform reads ({path.suffix or 'no suffix'})", "export STL or OBJ")])
    if path.suffix.lower() == ".stl":
        from kinform.form.meshes.stl import read_stl

        return read_stl(data)
    from kinform.form.meshes.obj import read_obj

    return read_obj(data)


@dataclass(frozen=True)
class _Request:
    """Everything that decides what a mesh comes out as: equal requests, equal meshes."""

    path: str
    """As results show it."""
    content: str
    """SHA-256 (hex) of the file."""
    body: str | None
    metres: float
    weld: float | None
    solid: bool


def earlier_meshes(assembly: Assembly, files: Mapping[str, str]) -> dict[_Request, Mesh]:
    """The meshes of an assembly that the present code read, by what was asked for; `files` are the contents it read."""
    weld = assembly.tolerances.weld
    return {
        _Request(
            part.mesh.path, files[part.mesh.path], part.mesh.body, metres_per(part.units), weld, part.solid
        ): part.mesh
        for part in assembly.parts
        if part.mesh is not None and part.mesh.path in files
    }


class Sources:
    """Files below the folder of the top manifest; meshes with the same content are one object."""

    def __init__(
        self, top: Path, problems: Problems, allow_outside: bool, earlier: Mapping[_Request, Mesh] | None = None
    ):
        self.top = top
        self.problems = problems
        self.files: set[str] = set()
        self._outside = allow_outside
        self._earlier = earlier or {}
        self._texts: dict[Path, str] = {}
        self._data: dict[Path, bytes] = {}
        self._digests: dict[Path, str] = {}
        self._raw: dict[Path, RawMesh | MeshError] = {}
        self._real: dict[Path, str] = {}
        self._built: dict[tuple[Path, str | None, float, float | None, bool], Mesh | None] = {}
        self._same: dict[tuple[str, str, str | None], Mesh] = {}

    def shown(self, path: Path) -> str:
        """The path as results and messages show it: relative to the top manifest's folder."""
        return Path(os.path.relpath(path, self.top)).as_posix()

    def find(self, stated: str, folder: Path, file: str, line: int, what: str) -> Path | None:
        """The file that a manifest states, relative to its folder; None after noting what is wrong."""
        path = folder / stated
        if not self._outside and not any(self._inside(path, root) for root in {self.top, folder}):
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
        self.text(path)
        return path

    def _inside(self, path: Path, root: Path) -> bool:
        """Whether the file, wherever links lead, lies in the folder."""
        if root not in self._real:
            self._real[root] = os.path.join(os.path.realpath(root), "")
        return os.path.realpath(path).startswith(self._real[root])

    def text(self, path: Path) -> None:
        """Note a file that is read, with its content before it is read."""
        self.files.add(self.shown(path))
        if path.suffix.lower() not in MESHES and path not in self._texts:
            with contextlib.suppress(OSError):
                self._texts[path] = content(path.read_bytes())

    def contents(self) -> dict[str, str]:
        """SHA-256 (hex) of every file that was read; {} where one changed meanwhile, or was not read."""
        found = {self.shown(path): digest for path, digest in self._digests.items()}
        for path, digest in self._texts.items():
            try:
                if content(path.read_bytes()) != digest:
                    return {}
            except OSError:
                return {}
            found[self.shown(path)] = digest
        return found if set(found) == self.files else {}

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
                request = _Request(self.shown(path), self._content(path), body, metres, weld, solid)
                built = self._earlier.get(request) or self._build(path, body, metres, weld, solid)
                self._built[key] = self._same.setdefault((built.digest, built.path, body), built)
            except MeshError as error:
                self._note(error, path, file, line)
                self._built[key] = None
        return self._built[key]

    def _build(self, path: Path, body: str | None, metres: float, weld: float | None, solid: bool) -> Mesh:
        from kinform.form.meshes.bodies import select_body
        from kinform.form.meshes.health import build_mesh

        raw = self._read(path)
        chosen = raw if body is None else select_body(raw, body)
        return build_mesh(chosen, metres, weld, path=self.shown(path), body=body, solid=solid)

    def look_at(self, paths: Sequence[Path]) -> None:
        """Hash mesh files, several at a time; what cannot be read is told when it is asked for."""
        with ThreadPoolExecutor(min(8, os.cpu_count() or 1)) as pool:
            for path, found in zip(paths, pool.map(_content_or_none, paths), strict=True):
                if found is not None:
                    self._digests[path] = found

    def content(self, path: Path) -> str | None:
        """SHA-256 (hex) of a file that `find` found and that is no mesh; None where it cannot be read."""
        return self._texts.get(path)

    def _content(self, path: Path) -> str:
        """SHA-256 (hex) of the file. Where its mesh may be known already the bytes are not kept."""
        if path not in self._digests:
            try:
                if self._earlier:
                    self._digests[path] = _content_of(path)
                else:
                    self._digests[path] = content(self._bytes(path))
            except OSError as error:
                raise MeshError([Fault(f"cannot be read: {error.strerror}", "check its permissions")]) from None
        return self._digests[path]

    def _bytes(self, path: Path) -> bytes:
        if path not in self._data:
            self._data[path] = path.read_bytes()
            if self._digests.get(path, "") not in ("", content(self._data[path])):
                raise MeshError([Fault("changed while it was read", "run again when it is saved")])
        return self._data[path]

    def _read(self, path: Path) -> RawMesh:
        if path not in self._raw:
            try:
                self._raw[path] = _parsed(path, self._bytes(path))
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
