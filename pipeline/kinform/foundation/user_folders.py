"""Folders of this user's own that keep files between runs, and files in them that nobody else can have written.

A folder counts when it belongs to this user, no group and no other user may enter it, and it is not below a working
folder, repository or package: those contain what strangers made. Files are opened below the folder that was examined,
never through a link, so that nobody can exchange one for another in between.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import os
import stat
import sys
from collections.abc import Iterator
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

_SUM = hashlib.sha256().digest_size
"""Bytes before the content of a file, which show that it is whole."""

_CAREFULLY = sum(getattr(os, name, 0) for name in ("O_NOFOLLOW", "O_NONBLOCK", "O_BINARY"))
"""How files are opened: no link is followed, a pipe is not waited for, and bytes are as they are."""

_MARKS = (".git", "package.xml")
"""What makes a folder the root of a design: of a repository, or of a package of ROS."""


def cache_folder() -> Path | None:
    """The folder for caches: `kinform` in XDG_CACHE_HOME where that is absolute, else in the user's `.cache`.

    None where the user has no home, or it is a folder of strangers (`is_foreign`).
    """
    named = os.environ.get("XDG_CACHE_HOME", "")
    if os.path.isabs(named):
        folder = Path(named)
    elif sys.platform == "win32" and os.path.isabs(os.environ.get("LOCALAPPDATA", "")):
        folder = Path(os.environ["LOCALAPPDATA"])
    else:
        home = os.environ.get("HOME", "")
        folder = Path(home if os.path.isabs(home) else stated_home() or "") / ".cache"
    return None if not folder.is_absolute() or is_foreign(folder) else folder / "kinform"


def is_foreign(folder: Path) -> bool:
    """Whether a folder is the working folder, a repository or a package, or lies below one of these.

    The home that the system's list of users states, and what is above it, is nobody else's, also where it is the
    working folder or under version control.
    """
    try:
        places = {os.path.realpath(folder), os.path.abspath(folder)}  # a link of strangers may lead out of their folder
        working = os.path.realpath(os.curdir)
    except OSError:
        return True
    own = stated_home() or os.sep
    homes = [Path(os.path.realpath(own)), Path(os.path.abspath(own))]
    return any(_is_marked(Path(place), homes, working) for place in places)


def _is_marked(place: Path, homes: list[Path], working: str) -> bool:
    """Whether the folder, or one above it, is the working folder, a repository or a package, up to the user's home."""
    for each in (place, *place.parents):
        if any(home.is_relative_to(each) for home in homes):
            return False
        if str(each) == working or any(os.path.lexists(each / mark) for mark in _MARKS):
            return True
    return False


def foreign_home() -> bool:
    """Whether the home that the environment names is a folder of strangers: in CI it is at times the checkout."""
    return is_foreign(Path(os.path.expanduser("~")))


def stated_home() -> str | None:
    """The user's home as the system states it, whatever the environment says; None where it states none."""
    try:
        import pwd

        return pwd.getpwuid(os.getuid()).pw_dir
    except (ImportError, KeyError):  # Windows; a user without a name, as in containers
        return None if hasattr(os, "getuid") else os.path.expanduser("~")


class PrivateFolder:
    """A folder of this user alone, with the files in it by their names."""

    def __init__(self, folder: Path, handle: int | None):
        self._folder, self._handle = folder, handle

    def names(self) -> list[str]:
        """Names of what is in the folder."""
        return os.listdir(self._folder if self._handle is None else self._handle)

    def read(self, name: str) -> bytes | None:
        """The content of a file that this user wrote, whole; None where it is missing, another's or damaged."""
        try:
            with os.fdopen(self.open(name, os.O_RDONLY), "rb") as stream:
                if not _is_own(os.fstat(stream.fileno()), forbidden=0o022):
                    return None
                data = stream.read()
        except OSError:
            return None
        content = data[_SUM:]
        return content if data[:_SUM] == hashlib.sha256(content).digest() else None

    def write(self, name: str, content: bytes) -> bool:
        """Put a file there, whole or not at all; False where that cannot be done."""
        passing = f"{name}.{os.getpid()}.{os.urandom(4).hex()}"
        try:
            handle = self.open(passing, os.O_WRONLY | os.O_CREAT | os.O_EXCL)
        except OSError:
            return False
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(hashlib.sha256(content).digest())
                stream.write(content)
            self.rename(passing, name)
        except OSError:
            with contextlib.suppress(OSError):
                os.unlink(self._place(passing), dir_fd=self._handle)
            return False
        return True

    def open(self, name: str, flags: int) -> int:
        """A file of this user, open; never a link, and nothing that would wait. Raises OSError."""
        handle = os.open(
            self._place(name), flags | _CAREFULLY | getattr(os, "O_CLOEXEC", 0), 0o600, dir_fd=self._handle
        )
        facts = os.fstat(handle)
        if not stat.S_ISREG(facts.st_mode) or not _is_own(facts, forbidden=0):
            os.close(handle)
            raise OSError(errno.EACCES, "is no file of the user", name)
        return handle

    def rename(self, name: str, other: str) -> None:
        """Let a file take the place of another. Raises OSError."""
        os.replace(self._place(name), self._place(other), src_dir_fd=self._handle, dst_dir_fd=self._handle)

    @contextlib.contextmanager
    def locked(self) -> Iterator[None]:
        """While one process has the folder to itself; raises OSError where another has. On Windows all do."""
        handle = None if self._handle is None else os.open(os.curdir, os.O_RDONLY, dir_fd=self._handle)
        try:
            if fcntl is not None and handle is not None:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            yield
        finally:
            if handle is not None:
                os.close(handle)

    def close(self) -> None:
        """Give the handle back."""
        if self._handle is not None:
            os.close(self._handle)

    def _place(self, name: str) -> str:
        return name if self._handle is not None else str(self._folder / name)


@contextlib.contextmanager
def private_folder(top: Path | None, *inner: str, make: bool = False) -> Iterator[PrivateFolder | None]:
    """The folder at `top` or below it, each step of it this user's alone; None where it is not, or is not there.

    `make` makes what is missing. The rights of what exists are never changed: it may be another's.
    """
    opened = None
    if top is not None:
        with contextlib.suppress(OSError):
            opened = examined(top, *inner, make=make)
    try:
        yield opened
    finally:
        if opened is not None:
            opened.close()


def examined(top: Path, *inner: str, make: bool = False) -> PrivateFolder:
    """As `private_folder`, to be closed. Raises OSError, which says of which folder what is wrong."""
    if make:
        top.parent.mkdir(parents=True, exist_ok=True)
    place, handle = top.parent, _opened(str(top.parent), None, follow=True)
    try:
        for step in (top.name, *inner):
            place = place / step
            name = str(place) if handle is None else step
            if make:
                with contextlib.suppress(FileExistsError):
                    os.mkdir(name, 0o700, dir_fd=handle)
            try:
                below = _opened(name, handle, follow=False)
            except OSError as error:
                words = "is not a folder" if error.errno in (errno.ELOOP, errno.ENOTDIR) else error.strerror
                raise OSError(error.errno, words, str(place)) from None
            if handle is not None:
                os.close(handle)
            handle = below
            facts = os.stat(place) if handle is None else os.fstat(handle)
            if not _is_own(facts, forbidden=0):
                raise OSError(errno.EACCES, "belongs to another user", str(place))
            if not _is_own(facts, forbidden=0o077):
                raise OSError(errno.EACCES, "is open to other users (chmod 700)", str(place))
    except OSError:
        if handle is not None:
            os.close(handle)
        raise
    return PrivateFolder(place, handle)


def _opened(name: str, above: int | None, *, follow: bool) -> int | None:
    """A handle of the folder; None on systems that open no folders. Raises OSError, unless `follow` also for a link."""
    if os.open not in os.supports_dir_fd:
        if not follow and (os.path.islink(name) or not os.path.isdir(name)):
            raise NotADirectoryError(errno.ENOTDIR, "is not a folder", name)
        return None
    flags = os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC | (0 if follow else os.O_NOFOLLOW)
    return os.open(name, flags, dir_fd=above)


def _is_own(facts: os.stat_result, *, forbidden: int) -> bool:
    """Whether what the facts are about belongs to this user, and gives others none of the forbidden rights."""
    if not hasattr(os, "getuid"):
        return True
    return facts.st_uid == os.geteuid() and not stat.S_IMODE(facts.st_mode) & forbidden
