"""Replacing a results file: all of the new one or none of it, and never a file that is not ours.

The new bytes go to a temporary file in the same folder, are synchronised to disk, and take the place of
the old file in one step. Identical bytes leave the file alone and touch its time, so that Make converges. What a
killed process left behind is removed by the next that writes in the folder: writers hold a lock on their file.

Links are not written through (`kinform.foundation.boundary.way_out` says which): the folder is resolved once, opened
without following links, and everything is done in the folder that was opened.
"""

from __future__ import annotations

import contextlib
import os
import stat
from collections.abc import Iterable
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows: files that are left behind stay
    fcntl = None  # type: ignore[assignment]

from kinform.errors import Problem, ResultsError
from kinform.foundation.boundary import held_folder, way_out
from kinform.foundation.regular_files import no_folder

_PREFIX, _SUFFIX = ".kinform-", ".tmp"
_NO_LINK = getattr(os, "O_NOFOLLOW", 0)


def refuse(path: str | Path, message: str, remedy: str) -> ResultsError:
    """The error that says what is wrong with the file, and what to do."""
    return ResultsError(Problem(message, file=str(path), remedy=remedy))


def refuse_links(
    path: str | Path, inside: Iterable[str | Path] = (), below: Path | None = None, *, folder: bool = False
) -> None:
    """Raise ResultsError where a link is in the way of an output; what else is given is as of `way_out`."""
    link = way_out(path, inside, below, folder=folder)
    if link is None:
        return
    if os.path.islink(path) and not folder:
        raise refuse(path, "this is a link, and outputs are not written through links", "remove it, or name its target")
    raise refuse(path, f"{link} is a link out of the folder", "remove it, or name the folder that it leads to")


def make_folder(folder: Path, below: Path | None = None) -> None:
    """Make a folder, and those above it, where they are missing. Raises as `refuse_links`, and OSError."""
    refuse_links(folder, (), below, folder=True)
    folder.mkdir(parents=True, exist_ok=True)


def check_target(path: str | Path, below: Path | None = None) -> None:
    """Raise ResultsError when a file could not be written there, before hours of work are lost."""
    refuse_links(path, (), below)
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise refuse(path, "this is a folder, not a file", f"name a file in it, such as {Path(path) / 'results.h5'}")
    if not target.parent.is_dir():
        raise refuse(path, *no_folder(Path(path).parent))
    if target.exists() and not target.is_file():
        raise refuse(path, "this is a device or a pipe, not a file", "name a regular file")
    if target.exists() and not _may(target, os.W_OK):
        raise refuse(path, "the file is read-only", "make it writable, or name another file")
    if not _may(target.parent, os.W_OK | os.X_OK):
        raise refuse(path, f"the folder {Path(path).parent} is read-only", "name a file in a writable folder")


def replace_file(path: str | Path, *pieces: bytes, sweeps: bool = True, below: Path | None = None) -> None:
    """Put these pieces, one after the other, at `path` in one step; keep a file that has them already, with a new time.

    `below` is the folder that was named for several files, and in which this one stays, whatever links are there. What
    killed processes left in the folder is removed, unless it has been (`sweeps`): of many files once. Raises
    ResultsError when that is not possible; the old file is then as it was.
    """
    check_target(path, below)
    try:
        with held_folder(os.path.realpath(Path(path).parent)) as folder:
            target = Path(folder) / Path(path).name
            if _holds(target, pieces):
                os.utime(target, follow_symlinks=os.utime not in os.supports_follow_symlinks)
            else:
                _swap(target, pieces, sweeps)
    except OSError as error:
        reason = error.strerror or str(error)
        raise refuse(
            path, f"cannot be written: {reason}", "name a file in a writable folder with enough space"
        ) from error


def _may(path: Path, mode: int) -> bool:
    return os.access(path, mode, effective_ids=os.access in os.supports_effective_ids)


def _holds(target: Path, pieces: tuple[bytes, ...]) -> bool:
    if not target.exists() or target.stat().st_size != sum(map(len, pieces)):
        return False
    with open(os.open(target, os.O_RDONLY | _NO_LINK), "rb") as stream:
        return all(stream.read(len(piece)) == piece for piece in pieces)


def _swap(target: Path, pieces: tuple[bytes, ...], sweeps: bool) -> None:
    if sweeps:
        _sweep(target.parent)
    temporary, handle = _draft(target.parent)
    try:
        with open(handle, "wb") as stream:
            stream.writelines(pieces)
            stream.flush()
            os.fsync(stream.fileno())
            if target.exists():
                os.chmod(temporary, stat.S_IMODE(target.stat().st_mode))
            if fcntl is not None:  # still locked: nobody takes it for left behind
                os.replace(temporary, target)
        if fcntl is None:
            os.replace(temporary, target)
    except BaseException:
        with contextlib.suppress(OSError):
            temporary.unlink()
        raise
    _synchronise(target.parent)


def _draft(folder: Path) -> tuple[Path, int]:
    """A new temporary file, open for writing and locked for as long as it is open."""
    while True:
        path = folder / f"{_PREFIX}{os.urandom(8).hex()}{_SUFFIX}"
        handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666)
        if fcntl is None:
            return path, handle
        with contextlib.suppress(OSError):  # a file system without locks: `_sweep` cannot lock either
            fcntl.flock(handle, fcntl.LOCK_EX)
        if path.exists():
            return path, handle
        os.close(handle)  # swept before it was locked


def _sweep(folder: Path) -> None:
    """Remove temporary files that nobody writes any more: their process was killed."""
    if fcntl is None:
        return
    with contextlib.suppress(OSError):
        for entry in sorted(e for e in os.listdir(folder) if e.startswith(_PREFIX) and e.endswith(_SUFFIX)):
            _remove_unless_locked(folder / entry)


def _remove_unless_locked(path: Path) -> None:
    assert fcntl is not None
    with contextlib.suppress(OSError):
        handle = os.open(path, os.O_RDONLY | _NO_LINK)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            path.unlink()
        finally:
            os.close(handle)


def _synchronise(folder: Path) -> None:
    """Make the renaming durable, where the system can synchronise folders."""
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
