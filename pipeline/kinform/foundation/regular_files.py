"""Checks that a path is a regular file: opening a pipe waits for its writer, and reading a device may never end."""

from __future__ import annotations

import hashlib
import os
import shlex
import stat
from pathlib import Path

AS_A_FILE = "write what comes through it to a file, and name that file"
"""The remedy in messages about a pipe or a device."""


def no_folder(folder: Path) -> tuple[str, str]:
    """(what is wrong, what to do) where a file cannot be written because its folder is none."""
    blocking = next((p for p in (folder, *folder.parents) if p.exists() and not p.is_dir()), None)
    if blocking is not None:
        return f"{blocking} is a file, not a folder", "name a file in a folder"
    return f"the folder {folder} does not exist", f"create it: mkdir -p {shlex.quote(str(folder))}"


def not_a_file(path: str | Path) -> str | None:
    """What is wrong with what stands in the place of a file, as the end of a sentence about it; None for files and
    folders, and where nothing is, of which opening tells. It is not opened: that alone may wait, or let another program
    go on."""
    try:
        mode = os.stat(path).st_mode
    except (OSError, ValueError):
        return None
    if stat.S_ISREG(mode) or stat.S_ISDIR(mode):
        return None
    if stat.S_ISFIFO(mode):
        return "is a pipe, not a file"
    return f"is a {'socket' if stat.S_ISSOCK(mode) else 'device'}, not a file"


def listing(folder: str | os.PathLike[str]) -> str:
    """SHA-256 (hex) of the names in a folder. Raises OSError where it cannot be listed."""
    return hashlib.sha256("\0".join(sorted(os.listdir(folder))).encode("utf-8", "surrogateescape")).hexdigest()
