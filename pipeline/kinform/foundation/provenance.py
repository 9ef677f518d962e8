"""Files that this user's kinform wrote, known again by their SHA-256.

A digest inside a file shows that the file is whole, not who wrote it: anyone can compute one. So the digests of files
that later runs rely on are kept where only the user writes: in `kinform` below `$XDG_STATE_HOME` (where that is an
absolute path) or `~/.local/state`. That folder must belong to the user and be closed to all others (mode 0700), and it
must not lie in a repository, a package or the working folder (`user_folders.is_foreign`), nor in the repository of the
file that is asked about: whoever can change the file could change its record too.

The digests stand in 16 files by their first hexadecimal digit, one a line. A line is appended in one write, so that
processes need no lock, and is found wherever it stands, so that half a line of a killed process harms no other. A file
that is full becomes the old one of its digit and replaces the one before; a digest that is found there is written
again. So what is used stays, and what is not used for long is forgotten.

Nothing here raises an error: where the folder cannot be used, nothing is recorded, and nothing is known.
"""

from __future__ import annotations

import contextlib
import hashlib
import hmac
import os
import re
import stat
from pathlib import Path

from kinform.foundation.boundary import repository_of
from kinform.foundation.user_folders import is_foreign

try:
    import fcntl
except ImportError:  # Windows: of two processes that find a file full at once, one loses what the other has written
    fcntl = None  # type: ignore[assignment]

FULL = 4096 * 65
"""Bytes of a file of digests: 4096 lines. So there are at most 131072 digests in 8.5 MB, and one is found in 0.3 ms.
A choice."""
_DIGEST = re.compile(r"[0-9a-f]{64}")
_KEY_BYTES = 32
"""Of the key of `signed`: as many as SHA-256 has."""


class _UnusableError(Exception):
    """Why the folder cannot be used."""


def record(digest: str) -> None:
    """Remember that the file with this SHA-256 (hex) was written by this user's kinform; call it before the file gets
    its name, so that no file stands there unrecorded."""
    with contextlib.suppress(OSError, ValueError, _UnusableError):
        folder = _folder(create=True)
        if _DIGEST.fullmatch(digest) and not _holds(folder / digest[0], digest):
            _append(folder, digest)


def is_recorded(digest: str, file: str | Path) -> bool:
    """Whether this user's kinform wrote the file with this SHA-256 (hex), which stands at `file`."""
    try:
        folder = _folder()
        if not _DIGEST.fullmatch(digest) or _in_reach(folder, file):
            return False
        if _holds(folder / digest[0], digest):
            return True
        if not _holds(folder / f"{digest[0]}.old", digest):
            return False
    except (OSError, ValueError, _UnusableError):
        return False
    record(digest)
    return True


def fault(file: str | Path) -> str:
    """Why it cannot be known who wrote the file, as in "/home/me/.local/state/kinform is not writable"; "" where
    it can."""
    try:
        folder = _folder(create=True)
        if _in_reach(folder, file):
            return f"{folder} lies in a repository, a package or the working folder"
        if not os.access(folder, os.W_OK | os.X_OK):
            return f"{folder} is not writable"
    except _UnusableError as error:
        return str(error)
    except (OSError, ValueError) as error:
        place = f"{error.filename}: " if isinstance(error, OSError) and error.filename else ""
        return f"{place}{getattr(error, 'strerror', None) or error}"
    return ""


def signed(text: str, file: str | Path) -> str:
    """A code (hex) for a text in a file that is written bit by bit: only this user's kinform can make it, with a key
    that stands in its folder. "" where that cannot be used."""
    try:
        folder = _folder(create=True)
        if _in_reach(folder, file):
            return ""
        return hmac.new(_key(folder), text.encode("utf-8", "surrogatepass"), hashlib.sha256).hexdigest()
    except (OSError, ValueError, _UnusableError):
        return ""


def is_signed(text: str, code: object, file: str | Path) -> bool:
    """Whether `signed` gave this code for the text."""
    made = signed(text, file)
    return bool(made) and isinstance(code, str) and hmac.compare_digest(made.encode(), code.encode("utf-8", "replace"))


def _folder(*, create: bool = False) -> Path:
    """The folder, which may not be there yet. Raises _UnusableError and OSError."""
    named = os.environ.get("XDG_STATE_HOME", "")
    state = named if os.path.isabs(named) else os.path.join(os.path.expanduser("~"), ".local", "state")
    if not os.path.isabs(state):
        raise _UnusableError("the user has no home folder")
    folder = Path(state) / "kinform"
    if is_foreign(folder):  # before it is made: a link of strangers may say where
        raise _UnusableError(f"{folder} lies in a repository, a package or the working folder")
    if create and not folder.exists():
        folder.parent.mkdir(parents=True, exist_ok=True)
        folder.mkdir(mode=0o700, exist_ok=True)
    try:
        status = os.lstat(folder)
    except FileNotFoundError:
        return folder
    if not stat.S_ISDIR(status.st_mode):
        raise _UnusableError(f"{folder} is not a folder")
    if hasattr(os, "geteuid"):
        if status.st_uid != os.geteuid():
            raise _UnusableError(f"{folder} belongs to another user")
        if stat.S_IMODE(status.st_mode) & 0o077:
            raise _UnusableError(f"{folder} is open to other users (chmod 700)")
    return folder


def _in_reach(folder: Path, file: str | Path) -> bool:
    """Whether strangers may have written the folder: it lies in a repository, a package or the working folder, or in
    the repository of the file."""
    inside = os.path.realpath(folder)
    roots = {repository_of(os.path.dirname(os.path.realpath(file))), repository_of(os.curdir)} - {None}
    return is_foreign(folder) or any(inside.startswith(os.path.join(str(root), "")) for root in roots)


def _open(path: Path, flags: int) -> int:
    """A regular file of the user, open; never a link, and nothing that would wait. Raises OSError."""
    more = (getattr(os, name, 0) for name in ("O_NOFOLLOW", "O_NONBLOCK", "O_CLOEXEC", "O_BINARY"))
    for flag in more:
        flags |= flag
    handle = os.open(path, flags, 0o600)
    status = os.fstat(handle)
    if not stat.S_ISREG(status.st_mode) or (hasattr(os, "geteuid") and status.st_uid != os.geteuid()):
        os.close(handle)
        raise OSError("is no file of the user")
    return handle


def _content(path: Path, most: int) -> bytes:
    """The first so many bytes of a file; none where it is not there."""
    try:
        with os.fdopen(_open(path, os.O_RDONLY), "rb") as stream:
            return stream.read(most)
    except FileNotFoundError:
        return b""


def _holds(path: Path, digest: str) -> bool:
    return f"{digest}\n".encode() in _content(path, 2 * FULL)  # several may append to a file that is just full


def _append(folder: Path, digest: str) -> None:
    path = folder / digest[0]
    handle = _open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT)
    try:
        os.write(handle, f"{digest}\n".encode())
        full = os.fstat(handle).st_size >= FULL
    finally:
        os.close(handle)
    if full:
        _turn_over(folder, path)


def _turn_over(folder: Path, path: Path) -> None:
    """Let a full file be the old one, once; who writes into it meanwhile writes into the old one."""
    handle = None if fcntl is None else os.open(folder, os.O_RDONLY)
    try:
        if fcntl is not None and handle is not None:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if path.stat().st_size >= FULL:
            path.replace(path.with_name(f"{path.name}.old"))
    finally:
        if handle is not None:
            os.close(handle)


def _key(folder: Path) -> bytes:
    """The key of `signed`, made where there is none. Raises OSError."""
    path = folder / "key"
    key = _content(path, _KEY_BYTES)
    if len(key) < _KEY_BYTES:
        draft = folder / f"key.{os.urandom(8).hex()}"
        with os.fdopen(_open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL), "wb") as stream:
            stream.write(os.urandom(_KEY_BYTES))
        draft.replace(path)
        key = _content(path, _KEY_BYTES)
    return key
