"""Where the meshes are that a description names: `package://`, `model://`, `file://`, and paths beside the file."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import tee
from pathlib import Path
from urllib.parse import unquote

from kinform.form.constants import NAME_LENGTH, VALUE_LENGTH
from kinform.foundation.boundary import OUTSIDE, OUTSIDE_REMEDY, Boundary, way_out
from kinform.frozen import dataclass

PACKAGE_LEVELS = 4
"""Folders, from that of a description upwards, in which its package is looked for where nothing names it:
`package/robots/variant/urdf`, and one. Chosen, not measured."""
WORKSPACE_LEVELS = 4
"""Folders below the `src` of a workspace in which packages are looked for: `src/group/repository/package`, and one."""
PACKAGE_BYTES = 64 << 10
"""Of a package.xml, that are searched for its name, which stands near the beginning. Chosen, not measured."""
ENTRIES_MOST = 20_000
"""Files and folders that are looked at for these, at most: about a second. The largest public package tried has 1,453;
what is more is a home folder that holds a description."""
PATH_LENGTH = 4096
"""Characters of a path: what Linux takes."""


_PACKAGE = re.compile(r"(?:package|model)://([^/]*)/?(.*)", re.DOTALL)
_PACKAGE_FILES = ("package.xml", "model.config")
MODELS = "models"
"""Folder beside which worlds of Gazebo stand, and in which their models are."""
SEARCHED = ("ROS_PACKAGE_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "SDF_PATH")
"""Variables that name folders of packages and of models."""
_NAME = re.compile(rb"<name>\s*([^<\s]+)\s*</name>")


@dataclass(frozen=True)
class Found:
    """A file, which may be read if it is there, or the reason why there is none with its remedy."""

    path: Path | None
    stated: str = ""
    fault: str = ""
    """What is wrong with the name that is stated, as the end of a sentence about it."""
    remedy: str = ""


class MeshFiles:
    """Resolves what one description names. `packages` are folders by name, as the user states them; `boundary` says
    what may be read, which without one is the folder of this description, and those packages."""

    runs_xacro = False
    """Whether the package xacro may expand a file by itself, which runs what its expressions say."""

    def __init__(
        self,
        description: Path,
        packages: Mapping[str, Path],
        environment: Mapping[str, str] | None = None,
        boundary: Boundary | None = None,
    ):
        self.folder = description.parent
        self.packages = packages
        self.boundary = boundary or Boundary(description, packages=packages.values())
        self._environment = os.environ if environment is None else environment
        self.home = _home(self.folder, self.boundary)
        """The package of the description."""
        self._there: dict[tuple[Path, str], bool] = {}
        self._looked_for: dict[str, Iterator[Path]] = {}

    def beside(self, description: Path) -> MeshFiles:
        """The same for another description that this one names."""
        return MeshFiles(description, self.packages, self._environment, self.boundary)

    def find(self, stated: str, folder: Path | None = None) -> Found:
        """The file that a description names; `folder` is where plain paths begin, else that of the description."""
        text = unquote(stated.strip()) if "://" in stated else stated.strip()
        text = text.replace("\\", "/")
        long = len(text) > PATH_LENGTH or any(len(os.fsencode(part)) > NAME_LENGTH for part in text.split("/"))
        if long:
            return Found(None, f"{stated[:VALUE_LENGTH]}…", "has a name that no file can have", "shorten it")
        match = _PACKAGE.fullmatch(text)
        if match:
            return self._in_package(match[1], match[2], text)
        if text.startswith("file:"):
            text = re.sub(r"^file:(//)?", "", text)
        elif "://" in text:
            return Found(None, stated, "is not a path in a file system", "name a file")
        return self._inside((folder or self.folder) / text, stated)

    def package(self, name: str) -> Path | None:
        """The folder of a package: the one that is stated, else the first that says of itself that it is one, else the
        first of its name."""
        if name in self.packages and self.packages[name].is_dir():
            return self.packages[name]
        there = [root for root in self._roots(name) if root.is_dir()]
        return next((root for root in there if _is_package(root, self.boundary.allows)), next(iter(there), None))

    def _inside(self, path: Path, stated: str) -> Found:
        """The file of that path, if it lies where the description may read."""
        if self.boundary.allows(path):
            return Found(path)
        return Found(None, stated, OUTSIDE, OUTSIDE_REMEDY)

    def _in_package(self, name: str, rest: str, stated: str) -> Found:
        is_file = self.boundary.is_file
        for root in self._roots(name):
            path = root / rest
            if is_file(path):
                return Found(path)
        parts = rest.split("/")
        for base in self._above(PACKAGE_LEVELS):  # a package that was renamed, or copied without its folder
            for k in (k for k, part in enumerate(parts) if self._has(base, part)):
                path = base.joinpath(*parts[k:])
                if is_file(path):
                    return Found(path)
        known = self.package(name)
        if known is not None:
            return self._inside(known / rest, stated)  # it is not there, which is told as of any other path
        for base in self._above(PACKAGE_LEVELS):
            for k, part in enumerate(parts[:-2]):  # two of its folders stand there, and the file does not
                if self._has(base, part) and self.boundary.is_folder(base.joinpath(*parts[k:-1])):
                    return self._inside(base.joinpath(*parts[k:]), stated)
        remedy = f"add --package {name}=FOLDER, or set ROS_PACKAGE_PATH"
        return Found(None, stated, f"is not found: no folder {name} is known", remedy)

    def _has(self, folder: Path, name: str) -> bool:
        """Whether a folder that may be read has something of that name."""
        if (folder, name) not in self._there:
            self._there[folder, name] = self.boundary.allows(folder) and os.path.lexists(folder / name)
        return self._there[folder, name]

    def _roots(self, name: str) -> Iterator[Path]:
        """As `_new_roots`, which are looked for once."""
        if name not in self._looked_for:
            self._looked_for[name] = self._new_roots(name)
        again, self._looked_for[name] = tee(self._looked_for[name])
        return again

    def _new_roots(self, name: str) -> Iterator[Path]:
        """Folders that may be the package, all of which may be read: as stated, beside the description, then as the
        environment says."""
        if name in ("", ".", ".."):
            yield from (self.folder, self.home)[: 0 if name else 2]
            return
        if name in self.packages:
            yield self.packages[name]
        for above in self._above(None):
            if above.name == name and self._is_own(above):
                yield above
            if self._is_own(above / name):
                yield from (above / name, above / name / "share" / name)  # which is where colcon installs it
            elif self._is_own(above / name / "share" / name):
                yield above / name / "share" / name
            if self._is_own(above / MODELS / name):
                yield above / MODELS / name
        for prefix in _paths(self._environment.get("AMENT_PREFIX_PATH")):
            yield self._granted(prefix / "share" / name)
        for folder in (path for variable in SEARCHED for path in _paths(self._environment.get(variable))):
            for root in (folder / name, folder) if folder.name == name else (folder / name,):
                yield self._granted(root)
        if name in self._around:
            yield self._around[name]

    def _is_own(self, folder: Path) -> bool:
        """Whether it is a folder that may be read; a package of the design's repository may be from now on. Others are
        not looked at."""
        if not self.boundary.allows(folder):
            if not _is_package(folder, self.boundary.holds_package):
                return False
            self.boundary.grant(folder)
        return self.boundary.is_folder(folder)

    def _granted(self, folder: Path) -> Path:
        """A folder that a variable of the user names. It may be read, unless a link in a repository or in the design's
        folder leads out of that: such a link is not the user's."""
        if way_out(folder, (self.boundary.top,), folder=True) is None:
            self.boundary.grant(folder)
        return folder

    def _above(self, levels: int | None) -> list[Path]:
        """The folder of the description and those above it, as far as packages of the design are looked for."""
        return [above for above in _above(self.folder, levels) if above.is_relative_to(self.boundary.top)]

    @cached_property
    def _around(self) -> Mapping[str, Path]:
        """The packages of the workspace of the description, by the names that they give themselves: those below the
        folder `src` that it is in; without one, those beside its own; as far as its repository goes."""
        full, top = self.home.resolve(), Path(self.boundary.top)
        source = next((above for above in full.parents if above.name == "src"), None)
        below, levels = (full.parent, 1) if source is None else (source, WORKSPACE_LEVELS)
        if not below.is_relative_to(top):
            below = top
        found = packages_below(below, levels, self.boundary)
        return {name: folder for name, folder in found.items() if self._is_own(folder)}


def packages_below(folder: Path, levels: int, boundary: Boundary) -> dict[str, Path]:
    """The packages in a folder, and so many levels of folders below it, by the names that they give themselves; of
    several of one name the nearest, then the first by name. Linked folders are packages, or not entered."""
    out: dict[str, Path] = {}
    for entries, deeper in _level_by_level(folder, levels):
        for entry in entries:
            if entry.name.startswith(".") or not _is(entry.is_dir):
                continue
            name = package_name(Path(entry.path), boundary)
            if name is not None:
                out.setdefault(name, Path(entry.path))
            elif not entry.is_symlink():
                deeper.append(Path(entry.path))
    return out


def package_name(folder: Path, boundary: Boundary) -> str | None:
    """The name that a package gives itself; None where the folder is none, or lies where nothing may be read."""
    file = folder / _PACKAGE_FILES[0]
    try:
        with boundary.open(file, of_package=True) as stream:
            stated = _NAME.search(stream.read(PACKAGE_BYTES))
    except OSError:
        return None
    return None if stated is None else stated[1].decode("utf-8", "replace")


def _is_package(folder: Path, is_inside: Callable[[Path], bool]) -> bool:
    """Whether a folder holds what makes it a package. Files that are not inside are not asked for."""
    return any(is_inside(file) and file.is_file() for file in (folder / name for name in _PACKAGE_FILES))


def files_below(folder: Path, suffixes: Sequence[str]) -> list[Path]:
    """Files with these suffixes in a folder and those below it, sorted. Linked folders are not entered."""
    out: list[Path] = []
    for entries, deeper in _level_by_level(folder):
        for entry in entries:
            if entry.is_dir(follow_symlinks=False):
                deeper.append(Path(entry.path))
            elif entry.name.lower().endswith(tuple(suffixes)) and _is(entry.is_file):
                out.append(Path(entry.path))
    return sorted(out)


def _level_by_level(folder: Path, levels: int | None = None) -> Iterator[tuple[list[os.DirEntry[str]], list[Path]]]:
    """What a folder holds, by name, and a list for those of its folders that are to be entered, which follow when all
    of its level have been; until so many entries were looked at that it is no package and no workspace."""
    level, looked_at = [folder], 0
    while level and (levels is None or levels > 0):
        levels = None if levels is None else levels - 1
        deeper: list[Path] = []
        for above in level:
            try:
                entries = sorted(os.scandir(above), key=lambda entry: entry.name)
            except OSError:
                continue
            looked_at += len(entries)
            if looked_at > ENTRIES_MOST:
                return
            yield entries, deeper
        level = deeper


def _is(asked: Callable[[], bool]) -> bool:
    """Whether an entry is what is asked, or a link to such a thing; a link to itself is nothing."""
    try:
        return asked()
    except OSError:
        return False


def _paths(text: str | None) -> list[Path]:
    return [Path(item) for item in (text or "").split(os.pathsep) if item]


def _above(folder: Path, levels: int | None) -> Sequence[Path]:
    """The folder and those above it; the given number of them."""
    full = folder.resolve()
    return [full, *full.parents][:levels]


def _home(folder: Path, boundary: Boundary) -> Path:
    """The nearest folder above with the file of a package; else the one above the description's, if it may be read."""
    full = folder.resolve()
    for above in [full, *full.parents][:PACKAGE_LEVELS]:
        if _is_package(above, boundary.allows):
            return above
    return full.parent if boundary.allows(full.parent) else full
