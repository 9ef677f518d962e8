"""What a design may read and write: the one place that decides it, and opens what it decided.

The design's folder is the nearest folder above the input with a `package.xml` or the root of its repository (a `.git`
there), else the input's own. Files outside are not read, links resolved, and not asked for either: a message about one
does not tell whether it exists. The `.git` of a repository counts as outside, for it holds credentials and hooks.

A path is resolved once. What it resolves to is opened folder by folder without following links, so that a link that
is put there meanwhile is an error and no way out.
"""

from __future__ import annotations

import contextlib
import errno
import os
import stat
from collections.abc import Iterable, Iterator
from functools import cached_property
from io import BufferedReader

Path = str | os.PathLike[str]

OUTSIDE = "lies outside the design's folder"
"""What is wrong with a path, as the end of a sentence about it."""
OUTSIDE_REMEDY = "move it into the folder of the design, or allow this with --allow-outside"

_PACKAGE, _REPOSITORY = "package.xml", ".git"
_BY_FOLDER = os.open in os.supports_dir_fd
"""Whether files can be opened relative to an open folder: not on Windows, where the resolved path is opened."""
_HANDLES = "/proc/self/fd"
"""Where Linux has paths of what is open."""
_STEP = getattr(os, "O_PATH", os.O_RDONLY) | getattr(os, "O_DIRECTORY", 0) | getattr(os, "O_NOFOLLOW", 0)
"""How folders on the way are opened: without the right to list them, where the system allows that."""
_READ = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
"""How files are opened: opening a pipe does not wait for its writer."""


class OutsideError(OSError):
    """A file outside the design's folder was asked for."""

    def __init__(self, path: Path):
        super().__init__(errno.EACCES, OUTSIDE, os.fspath(path))


def design_folder(source: Path) -> str:
    """The design's folder of an input, links resolved."""
    own = _real(os.path.dirname(os.path.abspath(source)))
    return next((folder for folder in _upwards(own) if _is_marked(folder)), own)


def leads_out(source: Path) -> bool:
    """Whether an input is a link that leads out of its design's folder."""
    return not _holds(design_folder(source), _real(source))


def repository_of(folder: Path) -> str | None:
    """The root of the repository that a folder is in, links resolved; None where it is in none."""
    return next((above for above in _upwards(_real(folder)) if os.path.lexists(_join(above, _REPOSITORY))), None)


class Boundary:
    """The folders that one design may read."""

    def __init__(self, source: Path, *, allow_outside: bool = False, packages: Iterable[Path] = ()):
        """`source` is the input, which may be read wherever a link of its name leads. `packages` are folders that the
        user names. With `allow_outside` all may be read."""
        self._everything = allow_outside
        self.folder = design_folder(source)
        """The design's folder, links resolved."""
        self._source = _real(source)
        self._roots = [self.folder]
        self._parents: dict[str, str] = {}
        for folder in packages:
            self.grant(folder)

    @cached_property
    def top(self) -> str:
        """The highest folder in which packages of the design are looked for: its repository, which may hold several,
        else the design's folder; the root of the file system where all may be read."""
        if self._everything:
            return os.path.abspath(os.sep)
        return repository_of(self.folder) or self.folder

    def grant(self, folder: Path) -> None:
        """Also allow what lies in a folder that the user names: by an option, or by a variable of ROS."""
        real = _real(folder)
        if real not in self._roots:
            self._roots.append(real)

    def holds_package(self, folder: Path) -> bool:
        """Whether a folder lies where packages of the design do: in its repository."""
        return self._everything or _holds(self.top, _real(folder))

    def allows(self, path: Path) -> bool:
        """Whether a path, links resolved, lies where the design may read. Nothing outside is asked for."""
        return self._everything or self._root_of(self._resolved(path)) is not None

    def is_file(self, path: Path) -> bool:
        """Whether it is a file that may be read. Folders outside that the path passes are not asked for."""
        return self.allows(path) and os.path.isfile(_real(path))

    def is_folder(self, path: Path) -> bool:
        """As `is_file`, of a folder."""
        return self.allows(path) and os.path.isdir(_real(path))

    def open(self, path: Path, *, of_package: bool = False) -> BufferedReader:
        """A file, open for reading. Raises OutsideError, and OSError where it cannot be opened or is no file.
        `of_package`: it says what a package of the design's repository is."""
        real = _real(path)
        if self._everything:
            return _as_file(os.open(real, _READ), path)
        root = self._root_of(real)
        if root is None and of_package and _holds(self.top, real):
            root = self.top
        if root is None:
            raise OutsideError(path)
        return _as_file(_open_below(root, real), path)

    def read(self, path: Path) -> bytes:
        """The content of a file. Raises as `open`."""
        with self.open(path) as stream:
            return stream.read()

    def _root_of(self, real: str) -> str | None:
        if real == self._source:
            return os.path.dirname(real)
        return next((root for root in self._roots if _holds(root, real)), None)

    def _resolved(self, path: Path) -> str:
        """As `os.path.realpath`; the folders of a thousand meshes are resolved once."""
        whole = os.fspath(path)
        folder, name = os.path.split(whole if ".." in whole else os.path.abspath(whole))
        if name in ("", ".", "..") or os.path.islink(path):
            return _real(path)
        if folder not in self._parents:
            self._parents[folder] = _real(folder)
        return _join(self._parents[folder], name)


def way_out(path: Path, inside: Iterable[Path] = (), below: Path | None = None, *, folder: bool = False) -> str | None:
    """The link on the way to an output that leads where nothing may be written; None where there is none.

    A file that is written is never a link itself. A folder on its way that is a link in a repository, or in one of the
    folders `inside`, which are those of designs, leads to somewhere in it. Links in the folder `below`, which was named
    for several outputs, lead to somewhere in that. Other links are the user's own. `folder`: the output is a folder.
    """
    limits = [_real(folder) for folder in inside]
    whole = os.path.join(os.getcwd(), path)
    drive, rest = os.path.splitdrive(whole)
    here = drive + os.sep
    names = [name for name in rest.replace(os.altsep or os.sep, os.sep).split(os.sep) if name not in ("", ".")]
    own = None if below is None else _real(below)
    for k, name in enumerate(names):
        if name == "..":
            here = os.path.dirname(here)
            continue
        there = _join(here, name)
        if not os.path.islink(there):
            here = there
            continue
        real = _real(there)
        bounds = [limit for limit in (repository_of(here), *limits) if limit is not None and _is_below(limit, here)]
        bounds += [own] if own is not None and _is_below(own, here) else []
        last = k == len(names) - 1 and not folder
        if last or not all(_holds(bound, real) for bound in bounds):
            return there
        here = real
    return None


@contextlib.contextmanager
def held_folder(real: str) -> Iterator[str]:
    """A path of a folder whose links are resolved, which stays that folder whatever takes its place; opened without
    following links. Where the system has no such path (`/proc`), that of the folder itself. Raises OSError."""
    if not _BY_FOLDER or not os.path.isdir(_HANDLES):
        yield real
        return
    top = os.path.abspath(os.sep)
    handle = _open_folders(top, _names(top, real))
    try:
        yield _join(_HANDLES, str(handle))
    finally:
        os.close(handle)


def _open_below(root: str, real: str) -> int:
    """A file for reading, by a path below a folder, all of whose links are resolved."""
    if not _BY_FOLDER:
        return os.open(real, _READ)
    names = _names(root, real)
    if not names:
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), real)
    folder = _open_folders(root, names[:-1])
    try:
        return os.open(names[-1], _READ, dir_fd=folder)
    finally:
        os.close(folder)


def _open_folders(root: str, names: Iterable[str]) -> int:
    here = os.open(root, _STEP)
    for name in names:
        try:
            there = os.open(name, _STEP, dir_fd=here)
        finally:
            os.close(here)
        here = there
    return here


def _as_file(handle: int, path: Path) -> BufferedReader:
    """A descriptor as a stream; OSError where it is of no file."""
    try:
        mode = os.fstat(handle).st_mode
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), os.fspath(path))
        if not stat.S_ISREG(mode):
            raise OSError(errno.EINVAL, "is not a file", os.fspath(path))
        return os.fdopen(handle, "rb")
    except BaseException:
        os.close(handle)
        raise


def _holds(root: str, real: str) -> bool:
    """Whether a path lies in a folder, and not in the `.git` of it; both with links resolved."""
    return _is_below(root, real) and not any(name.lower() == _REPOSITORY for name in _names(root, real))


def _is_below(root: str, real: str) -> bool:
    return real == root or real.startswith(_join(root, ""))


def _names(root: str, real: str) -> list[str]:
    return [name for name in real[len(root) :].split(os.sep) if name]


def _is_marked(folder: str) -> bool:
    return any(os.path.lexists(_join(folder, name)) for name in (_PACKAGE, _REPOSITORY))  # links are not followed


def _upwards(folder: str) -> Iterator[str]:
    """The folder and those above it."""
    while True:
        yield folder
        above = os.path.dirname(folder)
        if above == folder:
            return
        folder = above


def _real(path: Path) -> str:
    """Where a path leads; a name that no file can have leads nowhere, and stays as it is."""
    try:
        return os.path.realpath(path)
    except ValueError:
        return os.path.abspath(path)


_join = os.path.join
