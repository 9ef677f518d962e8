"""Reads the files of a design: each once, kept inside the folder of the manifest, every fault collected."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

from kinform.form.meshes.raw import Fault, MeshError, RawMesh, scaled
from kinform.form.problems import Problems
from kinform.form.sources import AS_IT_IS, Reading, is_scene
from kinform.foundation.boundary import OUTSIDE, OUTSIDE_REMEDY, Boundary
from kinform.foundation.name_hints import did_you_mean, first_names, in_quotes
from kinform.foundation.regular_files import AS_A_FILE, listing, not_a_file
from kinform.foundation.units import metres_per
from kinform.frozen import dataclass
from kinform.model.assembly import Assembly, Mesh, Part

MESHES = (".stl", ".obj")
"""Suffixes of mesh files that kinform reads itself."""

OTHER_MESHES = (".dae", ".glb", ".gltf", ".3mf", ".step", ".stp", ".ply", ".off")
"""Suffixes of mesh files that descriptions name besides, and of scenes."""


IN_METRES = (".dae", ".glb", ".gltf", ".step", ".stp")
"""Suffixes of files whose lengths are metres when they are read, whatever unit they are in."""


def no_file(path: Path) -> str:
    """What is wrong with a path at which no file is, as the end of a sentence."""
    return "is a folder" if os.path.isdir(path) else not_a_file(path) or "does not exist"


def is_mesh(path: Path) -> bool:
    """Whether the name is that of a mesh file."""
    return path.suffix.lower() in MESHES + OTHER_MESHES


def _digest(path: Path, boundary: Boundary) -> str | None:
    """SHA-256 (hex) of a file; None where it cannot be read."""
    if not_a_file(path):
        return None
    try:
        with boundary.open(path) as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError:
        return None


def read_raw(path: Path, boundary: Boundary | None = None) -> RawMesh:
    """Facets of a mesh file, which lies wherever it may if no boundary is given; raises MeshError, or OSError where it
    cannot be opened."""
    boundary = boundary or Boundary(path)
    if not boundary.allows(path):
        raise MeshError([Fault(OUTSIDE, OUTSIDE_REMEDY)])
    _check_file(path)
    return _parsed(path, boundary.read(path) if is_mesh(path) else b"")


def _check_file(path: Path) -> None:
    """Raise MeshError where a pipe or a device is in the place of a file."""
    fault = not_a_file(path)
    if fault is not None:
        raise MeshError([Fault(fault, "write the mesh to a file")])


def _parsed(path: Path, data: bytes, reading: Reading = AS_IT_IS) -> RawMesh:
    if data.startswith(b"version https://git-lfs"):
        raise MeshError([Fault("is a pointer of Git LFS, not the mesh", "fetch it: git lfs pull")])
    if not is_mesh(path):
        raise MeshError([Fault(f"is no mesh that kinform reads ({path.suffix or 'no suffix'})", "export STL or OBJ")])
    if path.suffix.lower() == ".stl":
        from kinform.form.meshes.stl import read_stl

        return read_stl(data)
    if path.suffix.lower() in (".ply", ".off"):
        from kinform.form.meshes.by_trimesh import read_by_trimesh

        return read_by_trimesh(data, path.suffix.lower()[1:])
    if path.suffix.lower() == ".dae":
        from kinform.form.scenes.dae import read_dae_mesh

        return read_dae_mesh(data)
    if is_scene(path):
        from kinform.form.scenes.reading import scene_once
        from kinform.form.scenes.scene import whole

        return whole(scene_once(data, path, reading))
    from kinform.form.meshes.obj import read_obj

    return read_obj(data)


@dataclass(frozen=True)
class MeshUse:
    """What a part takes of a mesh file: with the content of the file, everything that decides what comes out."""

    body: str | None
    """One of several bodies, or the whole file."""
    metres: float
    """In one unit of the file."""
    weld: float | None
    """Welding distance (m), if one is stated."""
    solid: bool
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """Along the axes of the file; the shape is mirrored where their product is negative."""


def mesh_use(part: Part, weld: float | None) -> MeshUse:
    """What a part with a mesh took of its file."""
    assert part.mesh is not None
    x, y, z = (float(factor) for factor in part.scale)
    return MeshUse(part.mesh.body, metres_per(part.units), weld, part.solid, (x, y, z))


_Request = tuple[str, str, MeshUse]
"""Path as results show it, SHA-256 (hex) of the file, use: equal requests, equal meshes."""


def earlier_meshes(assembly: Assembly, files: Mapping[str, str]) -> dict[_Request, Mesh]:
    """The meshes of an assembly that the present code read, by what was asked for; `files` are the contents it read."""
    return {
        (part.mesh.path, files[part.mesh.path], mesh_use(part, assembly.tolerances.weld)): part.mesh
        for part in assembly.parts
        if part.mesh is not None and part.mesh.path in files
    }


class DesignFiles:
    """Files that a design may read, named relative to the folder of its top manifest; meshes with the same content are
    one object."""

    def __init__(
        self,
        top: Path,
        problems: Problems,
        boundary: Boundary,
        earlier: Mapping[_Request, Mesh] | None = None,
        reading: Reading = AS_IT_IS,
    ):
        self.top = top
        self.problems = problems
        self.reading = replace(reading, boundary=boundary)
        self.names: set[str] = set()
        self.listed: set[Path] = set()
        """Folders whose list of files was read."""
        self.unsettled = False
        """Something counts that is no file that was read: nothing may be taken for unchanged."""
        self._by_name: dict[str, dict[Path, Path]] | None = None
        self.boundary = boundary
        self._earlier = earlier or {}
        self._data: dict[Path, bytes] = {}
        self._digests: dict[Path, str] = {}
        self._raw: dict[Path, RawMesh | MeshError] = {}
        self._bodies: dict[Path, dict[str, RawMesh]] = {}
        self._shown: dict[Path, str] = {}
        self._meshes: dict[tuple[Path, MeshUse], Mesh | None] = {}
        self._same: dict[tuple[str, str, str | None], Mesh] = {}

    def shown(self, path: Path) -> str:
        """The path as results and messages show it: relative to the top manifest's folder."""
        if path not in self._shown:
            self._shown[path] = Path(os.path.relpath(path, self.top)).as_posix()
        return self._shown[path]

    def find(self, stated: str, folder: Path, file: str, line: int, what: str) -> Path | None:
        """The file that a manifest states, relative to its folder; None after noting what is wrong."""
        path = folder / stated
        if not self.boundary.allows(path):
            self.problems.add_alike(f"{what} {stated}", OUTSIDE, file, line, OUTSIDE_REMEDY)
            return None
        if not self.boundary.is_file(path):
            near = [name for name in self._files_in(path.parent) if is_mesh(Path(name)) or not is_mesh(path)]
            elsewhere = self._elsewhere(path.name) if is_mesh(path) else []
            if self.boundary.is_folder(path):
                meshes = [name for name in self._files_in(path) if is_mesh(Path(name))]
                remedy = f"name a file in it: {first_names(meshes)}" if meshes else "name a file"
            elif not_a_file(path):
                remedy = AS_A_FILE
            elif elsewhere:
                remedy = f"did you mean {' or '.join(in_quotes(self.shown(other)) for other in elsewhere)}?"
            elif near:
                remedy = did_you_mean(path.name, near, "the files there")
            elif missing := self._first_missing(folder, Path(stated).parent):
                remedy = f"there is no folder {missing}"
            else:
                remedy = f"no mesh lies in {_folder_in_words(path.parent, folder)}"
            self.problems.add(f"{what} {stated} {no_file(path)}", file, line, remedy)
            return None
        self.note(path)
        return path

    def _files_in(self, folder: Path) -> list[str]:
        """Names of the files of a folder that may be read, sorted; none where there is no folder."""
        try:
            names = sorted(os.listdir(folder)) if self.boundary.is_folder(folder) else []
        except OSError:
            return []
        return [name for name in names if self.boundary.is_file(folder / name)]

    def _first_missing(self, folder: Path, below: Path) -> str | None:
        """The first of the folders of a path that is not there: of a missing one nothing is the parent. Those outside
        are not asked for."""
        so_far = Path()
        for part in below.parts:
            so_far = so_far / part
            if self.boundary.allows(folder / so_far) and not self.boundary.is_folder(folder / so_far):
                return so_far.name
        return None

    def _elsewhere(self, name: str) -> list[Path]:
        """Meshes of this name, whatever its case, below the folder of the top, else below the design's: two at most."""
        if self._by_name is None:
            from kinform.formats.description.mesh_files import files_below

            self._by_name = {}
            for root in (self.top, Path(self.boundary.folder)):
                for path in filter(self.boundary.allows, files_below(root, MESHES + OTHER_MESHES)):
                    self._by_name.setdefault(path.name.lower(), {})[path.resolve()] = path
        every = list(self._by_name.get(name.lower(), {}).values())
        return ([path for path in every if path.is_relative_to(self.top)] or every)[:2]

    def note(self, path: Path) -> None:
        """Note a file that is read; unless it is a mesh, with its content before it is read."""
        self.names.add(self.shown(path))
        if not is_mesh(path) and path not in self._digests:
            self._keep(path, _digest(path, self.boundary))

    def hash_meshes(self, paths: Sequence[Path]) -> None:
        """Hash mesh files, several at a time; what cannot be read is told when it is asked for."""
        # Mesh files that are hashed at the same time: more gain nothing on one disk. Chosen, not measured.
        with ThreadPoolExecutor(min(8, os.cpu_count() or 1)) as pool:
            for path, digest in zip(paths, pool.map(lambda path: _digest(path, self.boundary), paths), strict=True):
                self._keep(path, digest)

    def _keep(self, path: Path, digest: str | None) -> None:
        if digest is not None:
            self._digests[path] = digest

    def content(self, path: Path) -> str | None:
        """SHA-256 (hex) of a file, if it was read so far."""
        return self._digests.get(path)

    def contents(self) -> dict[str, str]:
        """SHA-256 (hex) of every file that was read, and of the list of each folder that was, with "/" at the end of
        its name; {} where one changed meanwhile, was not read, or is not where its name leads."""
        if self.unsettled:
            return {}
        if any(not is_mesh(path) and _digest(path, self.boundary) != digest for path, digest in self._digests.items()):
            return {}
        if any(".." in path.parts and self._is_elsewhere(path) for path in self._digests):
            return {}
        contents = {self.shown(path): digest for path, digest in self._digests.items()}
        if set(contents) != self.names:
            return {}
        return contents | {self.shown(folder) + "/": listing(folder) for folder in sorted(self.listed)}

    def _is_elsewhere(self, path: Path) -> bool:
        """Whether the path as it is shown leads to another file: a ".." after a link goes up from its target."""
        return os.path.realpath(path) != os.path.realpath(os.path.join(self.top, self.shown(path)))

    def loose(self, path: Path) -> RawMesh | None:
        """The facets of a mesh file that no part is; None where it may not be read. Raises MeshError and OSError."""
        if not self.boundary.allows(path):
            return None
        self.note(path)
        self._mesh_content(path)
        return self._read(path)

    def mesh(self, path: Path, use: MeshUse, file: str, line: int) -> Mesh | None:
        """The mesh of a file that `find` gave; None after noting its faults at the manifest's line."""
        key = (path, use)
        if key not in self._meshes:
            try:
                content = self._mesh_content(path)
                known = None if path.suffix.lower() == ".gltf" else self._earlier.get((self.shown(path), content, use))
                mesh = known or self._build(path, use)
                self._meshes[key] = self._same.setdefault((mesh.digest, mesh.path, use.body), mesh)
            except MeshError as error:
                self._complain(error, path, file, line)
                self._meshes[key] = None
        return self._meshes[key]

    def unit(self, path: Path) -> str | None:
        """The unit of length of a mesh file whose format has one; None where it has none, or cannot be read."""
        if path.suffix.lower() in IN_METRES:
            return "m"
        if path.suffix.lower() != ".3mf":
            return None
        from kinform.form.scenes.reading import scene_once

        try:
            return scene_once(self._bytes(path), path, self.reading).units
        except (MeshError, OSError):
            return None

    def _build(self, path: Path, use: MeshUse) -> Mesh:
        from kinform.form.meshes.bodies import select_body
        from kinform.form.meshes.health import build_mesh

        if use.body is not None and is_scene(path):
            chosen = self._scene_body(path, use.body)
        else:
            raw = self._read(path)
            chosen = raw if use.body is None else select_body(raw, use.body)
        if use.scale != (1.0, 1.0, 1.0):
            chosen = scaled(chosen, use.scale)
        return build_mesh(chosen, use.metres, use.weld, path=self.shown(path), body=use.body, solid=use.solid)

    def _scene_body(self, path: Path, name: str) -> RawMesh:
        """One mesh of a scene, in the frame of its own."""
        from kinform.form.scenes.reading import scene_once
        from kinform.form.scenes.scene import body_names

        if path not in self._bodies:
            scene = scene_once(self._bytes(path), path, self.reading)
            for other in scene.files:
                self.note(other)
            self._bodies[path] = dict(zip(body_names(scene), (raw for _, raw in scene.meshes), strict=True))
        bodies = self._bodies[path]
        if name not in bodies:
            raise MeshError([Fault(f"has no mesh {in_quotes(name)}", did_you_mean(name, bodies, "its meshes"))])
        return bodies[name]

    def _mesh_content(self, path: Path) -> str:
        """SHA-256 (hex) of the file. Where its mesh may be there already the bytes are not kept."""
        if path not in self._digests:
            _check_file(path)
            try:
                if self._earlier:
                    with self.boundary.open(path) as stream:
                        self._digests[path] = hashlib.file_digest(stream, "sha256").hexdigest()
                else:
                    self._digests[path] = hashlib.sha256(self._bytes(path)).hexdigest()
            except OSError as error:
                raise _unreadable(error) from None
        return self._digests[path]

    def _bytes(self, path: Path) -> bytes:
        if path not in self._data:
            _check_file(path)
            self._data[path] = self.boundary.read(path)
            if self._digests.get(path, "") not in ("", hashlib.sha256(self._data[path]).hexdigest()):
                raise MeshError([Fault("changed while it was read", "run again when it is saved")])
        return self._data[path]

    def _read(self, path: Path) -> RawMesh:
        if path not in self._raw:
            try:
                self._raw[path] = _parsed(path, self._bytes(path), self.reading)
            except MeshError as error:
                self._raw[path] = error
            except OSError as error:
                self._raw[path] = _unreadable(error)
            if not is_scene(path):  # whose bodies are asked for one by one
                self._data.pop(path, None)
        raw = self._raw[path]
        if isinstance(raw, MeshError):
            raise raw
        return raw

    def _complain(self, error: MeshError, path: Path, file: str, line: int) -> None:
        for fault in error.faults:
            if fault.line is not None:
                self.problems.add(f"the mesh {fault.message}", self.shown(path), fault.line, fault.remedy)
            else:
                self.problems.add(f"mesh {self.shown(path)} {fault.message}", file, line, fault.remedy)


def _folder_in_words(folder: Path, seen_from: Path) -> str:
    """A folder as it is seen from another."""
    path = os.path.relpath(folder, seen_from)
    return "its folder" if path == "." else path


def _unreadable(error: OSError) -> MeshError:
    return MeshError([Fault(f"cannot be read: {error.strerror}", "check its permissions")])
