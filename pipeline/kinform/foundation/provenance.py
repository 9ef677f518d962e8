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
from collections.abc import Iterator
from pathlib import Path

from kinform.foundation.boundary import repository_of
from kinform.foundation.user_folders import PrivateFolder, examined, is_foreign

FULL = 4096 * 65
"""Bytes of a file of digests: 4096 lines. So there are at most 131072 digests in 8.5 MB, and one is found in 0.3 ms.
A choice."""
_DIGEST = re.compile(r"[0-9a-f]{64}")
_KEY_BYTES = 32
"""Of the key of `signed`: as many as SHA-256 has."""


def record(digest: str) -> None:
    """Remember that the file with this SHA-256 (hex) was written by this user's kinform; call it before the file gets
    its name, so that no file stands there unrecorded."""
    with contextlib.suppress(OSError, ValueError), _opened(make=True) as folder:
        if _DIGEST.fullmatch(digest) and not _holds(folder, digest[0], digest):
            _append(folder, digest)


def is_recorded(digest: str, file: str | Path) -> bool:
    """Whether this user's kinform wrote the file with this SHA-256 (hex), which stands at `file`."""
    try:
        if not _DIGEST.fullmatch(digest) or _in_reach(_place(), file):
            return False
        with _opened() as folder:
            if _holds(folder, digest[0], digest):
                return True
            if not _holds(folder, f"{digest[0]}.old", digest):
                return False
    except (OSError, ValueError):
        return False
    record(digest)
    return True


def fault(file: str | Path) -> str:
    """Why it cannot be known who wrote the file, as in "/home/me/.local/state/kinform is not writable"; "" where
    it can."""
    try:
        place = _place()
        with _opened(make=True):
            if _in_reach(place, file):
                return f"{place} lies in a repository, a package or the working folder"
            if not os.access(place, os.W_OK | os.X_OK):
                return f"{place} is not writable"
    except (OSError, ValueError) as error:
        words = getattr(error, "strerror", None) or str(error)
        of = getattr(error, "filename", None)
        return f"{of} {words}" if of and words.startswith(("is ", "belongs ")) else f"{of}: {words}" if of else words
    return ""


def signed(text: str, file: str | Path) -> str:
    """A code (hex) for a text in a file that is written bit by bit: only this user's kinform can make it, with a key
    that stands in its folder. "" where that cannot be used."""
    try:
        with _opened(make=True) as folder:
            if _in_reach(_place(), file):
                return ""
            return hmac.new(_key(folder), text.encode("utf-8", "surrogatepass"), hashlib.sha256).hexdigest()
    except (OSError, ValueError):
        return ""


def is_signed(text: str, code: object, file: str | Path) -> bool:
    """Whether `signed` gave this code for the text."""
    made = signed(text, file)
    return bool(made) and isinstance(code, str) and hmac.compare_digest(made.encode(), code.encode("utf-8", "replace"))


def _place() -> Path:
    """Where the folder is, or would be. Raises OSError."""
    named = os.environ.get("XDG_STATE_HOME", "")
    state = named if os.path.isabs(named) else os.path.join(os.path.expanduser("~"), ".local", "state")
    if not os.path.isabs(state):
        raise OSError("the user has no home folder")
    return Path(state) / "kinform"


@contextlib.contextmanager
def _opened(*, make: bool = False) -> Iterator[PrivateFolder]:
    """The folder. Raises OSError."""
    place = _place()
    if is_foreign(place):  # before it is made: a link of strangers may say where
        raise OSError(f"{place} lies in a repository, a package or the working folder")
    folder = examined(place, make=make)
    try:
        yield folder
    finally:
        folder.close()


def _in_reach(folder: Path, file: str | Path) -> bool:
    """Whether strangers may have written the folder: it lies in a repository, a package or the working folder, or in
    the repository of the file."""
    inside = os.path.realpath(folder)
    roots = {repository_of(os.path.dirname(os.path.realpath(file))), repository_of(os.curdir)} - {None}
    return is_foreign(folder) or any(inside.startswith(os.path.join(str(root), "")) for root in roots)


def _content(folder: PrivateFolder, name: str, most: int) -> bytes:
    """The first so many bytes of a file; none where it is not there."""
    try:
        with os.fdopen(folder.open(name, os.O_RDONLY), "rb") as stream:
            return stream.read(most)
    except FileNotFoundError:
        return b""


def _holds(folder: PrivateFolder, name: str, digest: str) -> bool:
    # several may append to a file that is just full
    return f"{digest}\n".encode() in _content(folder, name, 2 * FULL)


def _append(folder: PrivateFolder, digest: str) -> None:
    name = digest[0]
    with os.fdopen(folder.open(name, os.O_WRONLY | os.O_APPEND | os.O_CREAT), "ab", buffering=0) as stream:
        stream.write(f"{digest}\n".encode())
        full = os.fstat(stream.fileno()).st_size >= FULL
    if full:
        _turn_over(folder, name)


def _turn_over(folder: PrivateFolder, name: str) -> None:
    """Let a full file be the old one, once; who writes into it meanwhile writes into the old one."""
    with folder.locked():
        if len(_content(folder, name, FULL)) >= FULL:
            folder.rename(name, f"{name}.old")


def _key(folder: PrivateFolder) -> bytes:
    """The key of `signed`, made where there is none. Raises OSError."""
    key = _content(folder, "key", _KEY_BYTES)
    if len(key) < _KEY_BYTES:
        draft = f"key.{os.urandom(8).hex()}"
        with os.fdopen(folder.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL), "wb") as stream:
            stream.write(os.urandom(_KEY_BYTES))
        folder.rename(draft, "key")
        key = _content(folder, "key", _KEY_BYTES)
    return key
